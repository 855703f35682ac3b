"""What a loop does over time as motions of a viewer: steps and trajectories, the platform's true pose beside what was wanted."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.base.number import Array
from flexstage.control.show.figures.time import magnification
from flexstage.control.study.runs import Run
from flexstage.control.study.study import LoopStudy
from flexstage.show.display import display_unit_of, to_typography
from flexstage.show.viewer.data import StageData
from flexstage.show.viewer.motions import Curve, Group, Motion, Response

_INSTANTS = 300
_MOST = 12
"""Runs that are played."""
_SETTLED = 3.0
"""How many settling times of a step are played."""


def response_motions(found: LoopStudy, still: StageData) -> tuple[Motion, ...]:
    """The first runs of a loop as motions of a stage: the platform goes where it truly went, all else follows ideally."""
    axes = {each.name: each.twists for each in still.motions if each.group is Group.AXIS}
    return tuple(motion for number, run in enumerate(found.runs[:_MOST], start=1) for motion in _played(number, run, axes))


def _played(number: int, run: Run, axes: dict[str, Array]) -> Iterator[Motion]:
    seen = run.simulated
    names = [channel.name.rpartition(".")[2] for channel in seen.coordinates]
    if not axes.keys() >= set(names):
        return
    times = np.linspace(0.0, _until(run), _INSTANTS)
    wanted, error = (_sampled(seen.times, values, times) for values in (seen.reference, seen.true_error))
    true = wanted - error
    basis = np.stack([axes[name] / _UNIT for name in names])
    far = int(np.argmax(np.sum((true * _scale(true)) ** 2, axis=1)))
    moved = [index for index, channel in enumerate(seen.coordinates) if channel.name in run.course.moved]
    curves = [_curve("time", "s", times)]
    for index in moved:
        unit, name = seen.coordinates[index].unit, names[index]
        curves += [_curve(f"{name} wanted", unit, wanted[:, index]), _curve(name, unit, true[:, index])]
        curves += [_curve(f"error of {name}", unit, error[:, index])]
    factor = 1.0 if run.figures is not None else magnification(float(np.max(np.ptp(wanted[:, moved], axis=0))), error[:, moved])
    label = f"step {run.course.name}" if run.figures is not None else _followed(run.course.name, factor)
    told = Response(basis, wanted - factor * error, tuple(curves))
    yield Motion(Group.RESPONSE, f"{number} {run.course.name}", label, np.einsum("n,nbk->bk", true[far], basis), response=told)


def _followed(name: str, factor: float) -> str:
    """The name of a trajectory that is played, and how many times too large its error is, so that it is seen."""
    return name if factor == 1.0 else f"{name}, its error {factor:g} times"


_UNIT = 1e-6
"""What the viewer's ideal motions of the platform are of, m or rad."""


def _until(run: Run) -> float:
    """The end of what is played [s]: of a step some settling times, else all of it."""
    last = float(run.simulated.times[-1])
    if run.figures is None:
        return last
    settled = float(run.figures.settling[run.index])
    return min(last, _SETTLED * settled) if np.isfinite(settled) and settled > 0.0 else last


def _sampled(times: Array, values: Array, wanted: Array) -> Array:
    return np.stack([np.interp(wanted, times, column) for column in values.T], axis=-1)


def _scale(values: Array) -> Array:
    """One over the largest of each column, so that metres and radians count alike; nought where nothing moves."""
    most = np.max(np.abs(values), axis=0)
    return np.where(most > 0.0, 1.0 / np.where(most > 0.0, most, 1.0), 0.0)


def _curve(name: str, unit: str, values: Array) -> Curve:
    form = display_unit_of(unit, float(np.max(np.abs(values), initial=0.0)))
    return Curve(name, to_typography(form.unit), values * form.factor)
