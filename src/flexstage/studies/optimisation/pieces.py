"""Measures as the least or largest of smooth pieces: an optimiser sees every actuator, hinge and stack, not only the worst one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np

from flexstage.analysis.judge import Bench, measured_on
from flexstage.analysis.requirements import Measure, Subject
from flexstage.analysis.workspace.buckling import buckling
from flexstage.analysis.workspace.gauging import gauge_swing, half_ranges
from flexstage.analysis.workspace.load import load_share
from flexstage.analysis.workspace.stroke import utilisation
from flexstage.base.finding import refuse
from flexstage.base.number import Array, magnitude


class Extreme(Enum):
    """Which of its pieces a measure is."""

    LEAST = "least"
    LARGEST = "largest"

    def of(self, values: Array) -> Array:
        """The measure (...) from its pieces (..., m)."""
        return np.min(values, axis=-1) if self is Extreme.LEAST else np.max(values, axis=-1)


@dataclass(frozen=True, eq=False)
class Pieces:
    """Values (..., m) in SI, of which the measure is the extreme."""

    values: Array
    extreme: Extreme


def pieces(bench: Bench, asked: Measure) -> Pieces:
    """The pieces of one measure on a bench; a smooth measure has one. Raises `DesignError` for what the stage does not have.

    >>> from flexstage.analysis.requirements import measure
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.judge import bench_of
    >>> stage = double_triangle()
    >>> found = pieces(bench_of(stage), measure(stage, "safety", "here"))
    >>> found.values.shape, round(float(found.extreme.of(found.values)), 3)
    ((21,), 2.597)
    """
    if asked.subject in _PIECES:
        extreme, work = _PIECES[asked.subject]
        return Pieces(work(bench, asked), extreme)
    value = measured_on(bench, asked)
    if isinstance(value, str):
        raise refuse(asked.key, value, "Ask for what this stage has")
    return Pieces(value[..., None], Extreme.LEAST)


def _strokes(bench: Bench, asked: Measure) -> Array:
    """How far each actuator lets the platform go, either way."""
    mapping = bench.correction(asked.point)
    gain = mapping.values[..., mapping.columns.index(asked.name)]
    able = np.abs(gain) > 1e-12 * np.max(np.abs(mapping.values), axis=(-2, -1), keepdims=False)[..., None]
    safe = np.where(able, gain, 1.0)
    ends = bench.limits.low / safe, bench.limits.high / safe
    both = np.concatenate(np.broadcast_arrays(-np.minimum(*ends), np.maximum(*ends)), axis=-1)
    return np.where(np.concatenate([able, able], axis=-1), both, np.inf)


def _corner(bench: Bench, _: Measure) -> Array:
    return utilisation(bench.lost.correction, bench.limits, bench.box()).ratio


def _safety(bench: Bench, _: Measure) -> Array:
    return bench.stress.safety


def _buckling(bench: Bench, _: Measure) -> Array:
    return buckling(bench.mechanism, bench.model, bench.limits.from_zero).least[..., None]


def _losses(bench: Bench, _: Measure) -> Array:
    return magnitude(np.diagonal(bench.lost.loss.values, axis1=-2, axis2=-1))


def _crosstalk(bench: Bench, _: Measure) -> Array:
    values = bench.lost.loss.values
    return magnitude(values[..., ~np.eye(values.shape[-1], dtype=bool)])


def _swings(bench: Bench, _: Measure) -> Array:
    return gauge_swing(bench.kinematics, bench.box()) / half_ranges(bench.assembly)


def _load(bench: Bench, _: Measure) -> Array:
    share = load_share(bench.mechanism, bench.model)
    return share.use(bench.limits.from_zero)


_PIECES: Mapping[Subject, tuple[Extreme, Callable[[Bench, Measure], Array]]] = {
    Subject.STROKE: (Extreme.LEAST, _strokes),
    Subject.CORNER: (Extreme.LARGEST, _corner),
    Subject.SAFETY: (Extreme.LEAST, _safety),
    Subject.BUCKLING: (Extreme.LEAST, _buckling),
    Subject.LOSS: (Extreme.LARGEST, _losses),
    Subject.CROSSTALK: (Extreme.LARGEST, _crosstalk),
    Subject.GAUGE_RANGE: (Extreme.LARGEST, _swings),
    Subject.LOAD: (Extreme.LARGEST, _load),
}
