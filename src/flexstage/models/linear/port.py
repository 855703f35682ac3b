"""Ports: selection of inputs and outputs of a linear model by name, including wrenches on any body and ground motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.number import Array, join
from flexstage.mechanism.mechanism import GROUND
from flexstage.models.linear.model import Channel, LinearModel
from flexstage.models.linear.undetermined import require_held, require_known
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS


@dataclass(frozen=True, eq=False)
class Ports:
    """Selected inputs u and outputs y: M z'' + D z' + K z = `force` u - `inertial` u'', y = `output` z + `feedthrough` u.

    - Shapes: `force` and `inertial` (..., n, m), `output` (..., p, n), `feedthrough` (..., p, m).
    - With ground motion as input, z is relative to the ground, but y is absolute. For inputs that impose no motion, `inertial` is zero.
    - `lost` (..., n, m): imaginary part of the force with structural damping (see `LinearModel.loss_matrix`).
    - `loss` (..., p): for an output that is a link force, the loss factor of this link; for all other outputs, zero.
    """

    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    force: Array
    inertial: Array
    output: Array
    feedthrough: Array
    lost: Array | float = 0.0
    loss: Array | float = 0.0


def ports(model: LinearModel, outputs: str | Iterable[str], inputs: str | Iterable[str]) -> Ports:
    """Select outputs and inputs by name.

    A name is a channel (`platform.x`, `S1`, `B4/pivot.mz`) or a group: `platform` means its six components. Inputs can be:

    - the model inputs (strokes; wrenches on platform and points);
    - wrench components on any body whose twist is an output (`B1/tip.fx`, at the reference point of the body, stage axes);
    - absolute ground motion (m, rad) at the platform's reference point, `ground.x` to `ground.rz`.

    Raises `DesignError` for all unknown names, with the most similar known names for each unknown name.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> [channel.name for channel in ports(model, ["S"], ["B", "B/tip.fz", "ground.x"]).inputs]
    ['B', 'B/tip.fz', 'ground.x']
    """
    known = {channel.name: number for number, channel in enumerate(model.outputs)}
    rows = _expand_groups(outputs, tuple(known), "output")
    sources = {channel.name: number for number, channel in enumerate(model.inputs)}
    columns = _expand_groups(inputs, (*sources, *_further_inputs(model)), "input")
    named = {"outputs": rows, "inputs": columns}
    require(Finding(kind, "names missing", "Specify at least one name") for kind, names in named.items() if not names)
    picked = [known[name] for name in rows]
    require_known(model, rows)
    require_held(model, rows, columns)
    parts = [_column(model, name, known, sources) for name in columns]
    return Ports(
        inputs=tuple(part[0] for part in parts),
        outputs=tuple(model.outputs[number] for number in picked),
        force=join([part[1] for part in parts], axis=-1),
        inertial=join([part[2] for part in parts], axis=-1),
        output=model.output[..., picked, :],
        feedthrough=join([part[3] for part in parts], axis=-1)[..., picked, :],
        lost=join([_loss_rows(model, name, sources) for name in columns], axis=-1),
        loss=np.stack(np.broadcast_arrays(*(_loss(model, name) for name in rows)), axis=-1),
    )


def input_names(model: LinearModel) -> tuple[str, ...]:
    """List all names that `ports` accepts as inputs, without groups.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> input_names(model)[0], input_names(model)[-1]
    ('B', 'ground.rz')
    """
    own = tuple(channel.name for channel in model.inputs)
    return (*own, *(name for name in _further_inputs(model) if name not in own))


def _further_inputs(model: LinearModel) -> tuple[str, ...]:
    bodies = dict.fromkeys(name.rpartition(".")[0] for name in _twists(model))
    wrenches = [f"{body}.{component}" for body in bodies for component in FORCES]
    return (*wrenches, *(f"{GROUND}.{component}" for component in COMPONENTS))


def _twists(model: LinearModel) -> list[str]:
    """Outputs that are components of a body or point twist."""
    names = [channel.name for channel in model.outputs if channel.name.rpartition(".")[2] in COMPONENTS]
    return [name for name in names if name.rpartition(".")[0]]


def _expand_groups(names: str | Iterable[str], known: tuple[str, ...], kind: str) -> list[str]:
    """Expand groups; raises for all unknown names together."""
    result: list[str] = []
    findings: list[Finding] = []
    members: dict[str, list[str]] = {}
    for name in known:
        members.setdefault(name.rpartition(".")[0], []).append(name)
    for name in (names,) if isinstance(names, str) else names:
        if name in known:
            result.append(name)
        elif name in members and name:
            result += dict.fromkeys(members[name])
        else:
            findings.append(Finding(name, f"unknown {kind}", suggest_nearest(name, [*known, *filter(None, members)])))
    require(findings)
    return result


def _column(model: LinearModel, name: str, by_name: dict[str, int], sources: dict[str, int]) -> tuple[Channel, Array, Array, Array]:
    """Channel, force, inertial force and feed-through of one input, matrices of one column."""
    if name in sources:
        number = [sources[name]]
        force = model.input_matrix[..., number]
        inertial = np.zeros_like(force) if model.inertial is None else model.inertial[..., number]
        return model.inputs[number[0]], force, inertial, model.feedthrough[..., number]
    owner, _, component = name.rpartition(".")
    if owner == GROUND:
        axis = COMPONENTS.index(component)
        inertial = model.base_inertia[..., [axis]]
        return Channel(name, TWIST_UNITS[axis]), np.zeros_like(inertial), inertial, model.rigid_output[..., [axis]]
    axis = FORCES.index(component)
    row = model.output[..., [by_name[f"{owner}.{COMPONENTS[axis]}"]], :]
    force = row.mT
    return Channel(name, WRENCH_UNITS[axis]), force, np.zeros_like(force), np.zeros((len(model.outputs), 1))


def _loss_rows(model: LinearModel, name: str, sources: dict[str, int]) -> Array:
    return model.loss_matrix[..., [sources[name]]] if name in sources else np.zeros((len(model.coordinates), 1))


def _loss(model: LinearModel, output: str) -> Array:
    owner, _, component = output.rpartition(".")
    force = component in FORCES and owner in model.stiffness
    return np.asarray(model.stiffness[owner].loss_factor if force else 0.0)
