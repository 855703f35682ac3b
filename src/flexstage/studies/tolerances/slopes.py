"""Exact derivatives of responses with respect to deviations. A minimum of several equal values has no derivative."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.assessment.judge import bench_of
from flexstage.analysis.assessment.measures import Measure, frequency, platform_frequency
from flexstage.analysis.assessment.sensitivities import project
from flexstage.analysis.bench import StageResults
from flexstage.base.number import Array
from flexstage.models.linear.eigen import Eigen
from flexstage.studies.tolerances.definition import Tolerance

_STEP = 1e-20
_CHUNK = 24
_NEAR = 1e-3
_DIRECTIONS = 8
_EVEN = 0.01
_GAP = 1e-6


@dataclass(frozen=True, eq=False)
class Slopes:
    """Values (r,) of the nominal design, derivatives (r, d) with respect to the deviations in SI, and the mask of `smooth` (r,) responses.

    A response that is not smooth (the lowest of two equal frequencies, the largest of three equal losses) changes in the same direction for
    any deviation. The derivatives of such a response are those of one of the equal values or, for frequencies, of the mean.
    """

    values: Array
    gradient: Array
    smooth: Array


def slopes(study: Tolerance) -> Slopes:
    """Compute the derivatives of all columns of a study.

    Derivatives of frequencies are computed from the modes, all other derivatives by complex step. For a mass-normalised mode phi with the
    eigenvalue lambda, d lambda = phi^T (dK - lambda dM) phi, with the stiffness matrix K and the mass matrix M. Smoothness is tested in
    eight random directions, with steps of plus and minus a thousandth of the scatter. A response is smooth if its two changes are opposite
    and agree with the derivative.

    >>> from flexstage.studies.tolerances.example import leaf_study
    >>> found = slopes(leaf_study())
    >>> found.gradient.shape, bool(found.smooth.all())
    ((2, 2), True)
    """
    size = np.array([each.deviation for each in study.deviations])
    columns = tuple(study.columns.values())
    bench = bench_of(study.design)
    values = _numbers(study, np.zeros((1, len(size))))[0]
    gradient = np.zeros((len(columns), len(size)))
    modes = {row: _mode(bench, each) for row, each in enumerate(columns) if each.kind in (frequency, platform_frequency)}
    for start in range(0, len(size), _CHUNK):
        chosen = np.arange(start, min(start + _CHUNK, len(size)))
        step = np.zeros((len(chosen), len(size)), dtype=complex)
        step[np.arange(len(chosen)), chosen] = 1j * _STEP
        gradient[:, chosen] = _derivatives(study, step, modes)
    return Slopes(values, gradient, _smooth(study, values, gradient, size))


def _numbers(study: Tolerance, values: Array) -> Array:
    """All columns (n, r) as real numbers; NaN without a value."""
    found = study.evaluate(study.mechanism_for(values))
    rows = [np.full(len(values), np.nan) if isinstance(each, str) else np.broadcast_to(np.real(each), len(values)) for each in found]
    return np.stack(rows, axis=-1)


def _mode(bench: StageResults, measure: Measure) -> tuple[float, Eigen]:
    """The requested frequency, and its equal modes."""
    modes = bench.modes
    index = int(measure.name) - 1
    place = modes.platform[index] if measure.kind is platform_frequency else index
    value = modes.frequencies[place]
    group = np.flatnonzero(np.abs(modes.frequencies - value) <= _GAP * value)
    return float(value), Eigen((2.0 * np.pi * modes.frequencies[group]) ** 2, modes.shapes[:, group])


def _derivatives(study: Tolerance, step: Array, modes: dict[int, tuple[float, Eigen]]) -> Array:
    """Derivatives (r, p) by the deviations of some steps."""
    bench = bench_of(study.mechanism_for(step))
    others = [None if row in modes else each for row, each in enumerate(study.columns.values())]
    found = np.zeros((len(others), len(step)))
    for row, value in enumerate(study.measure_on(bench, tuple(others))):
        if value is not None and not isinstance(value, str):
            found[row] = np.imag(np.broadcast_to(value, len(step))) / _STEP
    for row, (value, group) in modes.items():
        change = project(bench.model.stiffness, group.shapes) - group.values.mean() * project(bench.model.inertia, group.shapes)
        mean = np.linalg.trace(change) / len(group.values)
        found[row] = mean / (8.0 * np.pi**2 * value)
    return found


def _smooth(study: Tolerance, values: Array, gradient: Array, size: Array) -> Array:
    """Responses with opposite changes in opposite directions, equal to their derivatives."""
    way = np.random.default_rng(study.plan.seed).standard_normal((_DIRECTIONS, len(size))) * size * _NEAR
    there = _numbers(study, np.concatenate([way, -way])) - values
    odd, even = 0.5 * (there[:_DIRECTIONS] - there[_DIRECTIONS:]), 0.5 * (there[:_DIRECTIONS] + there[_DIRECTIONS:])
    predicted = way @ gradient.T
    scale = np.sqrt(np.mean(odd**2, axis=0))
    noise = 1e-10 * np.abs(values) + 1e-300
    wrong = np.sqrt(np.mean(even**2 + (odd - predicted) ** 2, axis=0))
    return np.isfinite(wrong) & (wrong <= _EVEN * scale + noise)
