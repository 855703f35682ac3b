"""Checks for quantities that a model does not determine: free internal modes (zero stiffness), and forces of locked DOFs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array, first_design
from flexstage.models.linear.model import Channel, LinearModel
from flexstage.spatial.frame import COMPONENTS, FORCES

_SEEN = 1e-9
_TENTH = 0.1
_METRE = np.array([1.0, 1.0, 1.0, _TENTH, _TENTH, _TENTH])
"""Rotations are compared with translations over 0.1 m."""
_ALLOWED = "Compute modes, responses or loops instead, or add a spring along this motion"
_ADVICE = "Add stiffness in that degree of freedom to a link of these bodies, or lock it"


def require_known(model: LinearModel, outputs: Iterable[str]) -> None:
    """Raise `DesignError` for outputs that are forces of locked DOFs: elastic deformations do not determine these forces.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> require_known(lumped(parallelogram()), ["B/pzt.fx"])
    """
    unknown = set(model.unknown)
    require(
        Finding(name, "unknown force, because the link locks this degree of freedom", "Specify a stiffness for this degree of freedom")
        for name in outputs
        if name in unknown
    )


def require_still(model: LinearModel, outputs: Iterable[str]) -> None:
    """Raise `DesignError` for gauges that measure a free internal mode, because its static displacement is undetermined.

    Twists of the bodies that move in a free internal mode are permitted outputs.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> require_still(lumped(parallelogram()), ["S"])
    """
    visible = _idle_seen(model)
    number = {channel.name: index for index, channel in enumerate(model.outputs)}
    require(
        Finding(name, f"this gauge measures a free internal mode (zero stiffness): {_names(model)}", f"{_ADVICE}, or move the gauge")
        for name in outputs
        if number[name] in visible and name.rpartition(".")[2] not in (*COMPONENTS, *FORCES)
    )


def require_unmoved(model: LinearModel, inputs: Iterable[str]) -> None:
    """Raise `DesignError` for wrenches that drive a free internal mode, because no static response exists.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> require_unmoved(lumped(parallelogram()), ["B", "corner.fx"])
    """
    driving, names = _driving(model), tuple(inputs)
    require(
        Finding(name, f"drives a free internal mode (zero stiffness): {_names(model)}", f"{_ADVICE}, or load another body")
        for name in names
        if name in driving
    )
    require(
        Finding(name, "drives a motion without stiffness, so that static stiffness and strokes are undefined", _ALLOWED)
        for name, drives in zip(names, floats(model, names), strict=True)
        if drives
    )


def floats(model: LinearModel, inputs: tuple[str, ...]) -> list[bool]:
    """Return, for each input, whether the input drives a platform motion that has no stiffness.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> floats(lumped(parallelogram()), ("B",))
    [False]
    """
    if model.floating is None:
        return [False] * len(inputs)
    force = np.abs(model.input_matrix)
    work = np.abs(model.floating.T @ model.input_matrix)
    most = np.abs(model.floating).T @ force
    return np.any(work > _SEEN * most, axis=0)[model.input_index(inputs)].tolist()


def require_held(model: LinearModel, outputs: Iterable[str], inputs: Iterable[str]) -> None:
    """Raise `DesignError` for wrenches that drive a free internal mode, if an output measures this mode, as its displacement is unbounded.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> require_held(lumped(parallelogram()), ["S"], ["corner.fx"])
    """
    visible, driving = _idle_seen(model), _driving(model)
    number = {channel.name: index for index, channel in enumerate(model.outputs)}
    watched = {motion for name in outputs for motion in visible.get(number[name], ())}
    require(
        Finding(name, f"drives a free internal mode (zero stiffness) that affects an output: {_names(model)}", _ADVICE)
        for name in inputs
        if watched & driving.get(name, set())
    )


def require_balanced(model: LinearModel, where: str, load: Array, rows: list[int] | None = None) -> None:
    """Raise `DesignError` for a static load that drives a free internal mode: no equilibrium exists.

    If `rows` are the outputs for the twist of a body, `load` is a wrench (6,) on this body. Without `rows`, `load` is the acceleration of
    gravity (6,).

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> require_balanced(lumped(parallelogram()), "gravity", np.array([0.0, 0.0, -9.8, 0.0, 0.0, 0.0]))
    """
    if model.floating is not None:
        force = model.base_inertia @ load if rows is None else model.output[rows].mT @ load
        if np.any(np.abs(model.floating.T @ force) > _SEEN * (np.abs(model.floating).T @ np.abs(force))):
            raise refuse(
                where,
                "drives a motion without stiffness, so that no equilibrium exists",
                "Change the direction of gravity, or add a spring",
            )
    if model.idle_output is None or model.idle_inertia is None:
        return
    load = np.real(first_design(load, 1))
    if rows is None:
        works = np.real(first_design(model.idle_inertia, 2))
        least = np.linalg.norm(works, axis=1) * np.linalg.norm(load)
    else:
        motions = np.real(first_design(model.idle_output, 2))
        works = motions[rows].T
        # relative to the largest output of the motion: bodies outside it see only rounding
        least = _TENTH * np.max(np.abs(motions), axis=0) * np.linalg.norm(load / _METRE)
    if np.any(np.abs(works @ load) > _SEEN * least):
        raise refuse(where, f"drives a free internal mode (zero stiffness), so that no equilibrium exists: {_names(model)}", _ADVICE)


def _idle_seen(model: LinearModel) -> dict[int, set[int]]:
    """Free internal modes that each output sees, by number."""
    if model.idle_output is None:
        return {}
    first = np.abs(np.real(first_design(model.idle_output, 2)))
    visible = first > _SEEN * np.max(first, axis=0, initial=0.0)
    return {int(row): set(np.flatnonzero(visible[row]).tolist()) for row in np.flatnonzero(visible.any(axis=1))}


def _driving(model: LinearModel) -> dict[str, set[int]]:
    """Free internal modes that a wrench drives, by its name: it does work on the twists that see them."""
    return dict(_pairs(model.outputs, _idle_seen(model)))


def _pairs(outputs: tuple[Channel, ...], visible: dict[int, set[int]]) -> Iterator[tuple[str, set[int]]]:
    for row, motions in visible.items():
        owner, _, component = outputs[row].name.rpartition(".")
        if component in COMPONENTS:
            yield f"{owner}.{FORCES[COMPONENTS.index(component)]}", motions


def _names(model: LinearModel) -> str:
    return ", ".join(dict.fromkeys(name.rpartition(".")[0] for name in model.idle))
