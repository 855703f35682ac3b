"""Loop responses as motions in the viewer: steps and trajectories, with true pose and reference."""

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
"""Maximum number of motions."""
_SETTLED = 3.0
"""Length of a step motion in settling times."""


def response_motions(found: LoopStudy, still: StageData) -> tuple[Motion, ...]:
    """Convert up to 12 simulations to stage motions: the platform has its true pose, other bodies follow the ideal kinematics."""
    axes = {each.name: each.twists for each in still.motions if each.group is Group.AXIS}
    return tuple(motion for number, run in enumerate(found.runs[:_MOST], start=1) for motion in _played(number, run, axes))


def _played(number: int, run: Run, axes: dict[str, Array]) -> Iterator[Motion]:
    seen = run.simulated
    names = [channel.name.rpartition(".")[2] for channel in seen.coordinates]
    if not axes.keys() >= set(names):
        return
    times = np.linspace(0.0, _until(run), _INSTANTS)
    wanted, error = (
        np.stack([np.interp(times, seen.times, column) for column in values.T], axis=-1) for values in (seen.reference, seen.true_error)
    )
    true = wanted - error
    basis = np.stack([axes[name] / _UNIT for name in names])
    far = int(np.argmax(np.sum((true * _scale(true)) ** 2, axis=1)))
    moved = [index for index, channel in enumerate(seen.coordinates) if channel.name in run.course.moved]
    curves = [_curve("time", "s", times)]
    for index in moved:
        name = names[index]
        drawn = {f"reference of {name}": wanted, name: true, f"error of {name}": error}
        curves += [_curve(label, seen.coordinates[index].unit, values[:, index]) for label, values in drawn.items()]
    factor = 1.0 if run.figures is not None else magnification(np.max(np.ptp(wanted[:, moved], axis=0)), error[:, moved])
    label = f"{'' if run.figures is None else 'step '}{run.course.name}"
    label += "" if factor == 1.0 else f", error magnified {factor:g} times"
    told = Response(basis, wanted - factor * error, tuple(curves))
    yield Motion(Group.RESPONSE, f"{number} {run.course.name}", label, np.einsum("n,nbk->bk", true[far], basis), response=told)


_UNIT = 1e-6
"""Unit of the viewer's ideal platform motions, m or rad."""


def _until(run: Run) -> float:
    """End time of a motion [s]: some settling times of a step, else the whole run."""
    last = float(run.simulated.times[-1])
    if run.figures is None:
        return last
    settled = run.figures.settling[run.index]
    return min(last, _SETTLED * settled) if np.isfinite(settled) and settled > 0.0 else last


def _scale(values: Array) -> Array:
    """Reciprocal of the largest value of each column, for equal weight of metres and radians; zero without motion."""
    most = np.max(np.abs(values), axis=0)
    return np.where(most > 0.0, 1.0 / np.where(most > 0.0, most, 1.0), 0.0)


def _curve(name: str, unit: str, values: Array) -> Curve:
    form = display_unit_of(unit, np.max(np.abs(values), initial=0.0))
    return Curve(name, to_typography(form.unit), values * form.factor)
