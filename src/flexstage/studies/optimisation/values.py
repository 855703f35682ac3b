"""Measures of designs, and their exact derivatives with respect to all variables by complex step, for several designs in one batch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexstage.analysis.assessment.judge import bench_of
from flexstage.analysis.assessment.measures import Extreme, Measure, frequency, platform_frequency
from flexstage.analysis.bench import StageResults
from flexstage.base.finding import DesignError
from flexstage.base.number import Array, Table
from flexstage.mechanism.checks import require_valid
from flexstage.mechanism.mechanism import Mechanism
from flexstage.studies.optimisation.search.spectrum import Modes, Spectrum, spectra
from flexstage.studies.sweeps.definition import Study

_STEP = 1e-20
_APART = 1e-3
_SPECTRAL = (frequency, platform_frequency)


@dataclass(frozen=True, eq=False)
class Scalars:
    """Pieces of a measure at one design: `values` (m,) in SI, and `gradient` (m, n) with respect to fractions of the ranges.

    A measure that is a minimum or maximum of several values has one piece for each value.
    """

    values: Array
    gradient: Array
    extreme: Extreme

    @property
    def value(self) -> float:
        """Value of the measure."""
        return float(self.extreme.of(self.values))

    @property
    def slope(self) -> Array:
        """The gradient (n,) of the piece that determines the measure."""
        return self.gradient[int(np.argmin(self.values) if self.extreme is Extreme.LEAST else np.argmax(self.values))]


@dataclass(frozen=True, eq=False)
class NumberedFrequency:
    """The frequency with number `count` in a spectrum."""

    spectrum: Spectrum
    count: int

    @property
    def value(self) -> float:
        """Value of the measure [Hz]."""
        return float(self.spectrum.frequencies[self.count - 1])

    @property
    def slope(self) -> Array:
        """The gradient (n,) of the frequency; for repeated modes, the gradient of the mean of their frequencies."""
        own = self.spectrum.frequencies
        near = np.abs(own - own[self.count - 1]) <= 1e-6 * own[self.count - 1]
        return np.mean(np.diagonal(self.spectrum.slopes, axis1=1, axis2=2)[:, near], axis=1)


@dataclass(frozen=True, eq=False)
class Point:
    """A design and its measures in the requested sequence. `shares` (n,) are the variables as fractions of their ranges, 0 to 1."""

    shares: Array
    found: tuple[Scalars | NumberedFrequency, ...]

    @property
    def values(self) -> Array:
        """The measures (r,) in SI."""
        return np.array([each.value for each in self.found])

    @property
    def gradient(self) -> Array:
        """Derivatives (r, n) of the measures with respect to fractions of the ranges."""
        return np.array([each.slope for each in self.found])


@dataclass(frozen=True, eq=False)
class Values:
    """Evaluator of the `measures` of a study's designs.

    Derivatives are exact: analytical for eigenvalues, otherwise by a complex step through the formulas of the models. Only the derivatives
    of `map_error` and `opening` are central differences, because corners and outlines are computed in real numbers. Their step is a
    thousandth of the range; for this step, the errors due to rounding and to curvature are similar.
    """

    study: Study
    measures: tuple[Measure, ...]

    @cached_property
    def _bare(self) -> Study:
        """The study without the tags of its design, which would slow down every change."""
        return replace(self.study, design=replace(self.study.design, tags=Table({})))

    @cached_property
    def _command(self) -> Mapping[str, float]:
        """The required strokes as a box, the same for all designs."""
        return bench_of(self.study.design).command

    @cached_property
    def _modes(self) -> tuple[Modes, ...]:
        """The required spectra: of the platform, of all bodies, or both; each up to the highest requested number."""
        highest = dict[bool, int]()
        for each in self.measures:
            if each.kind in _SPECTRAL:
                platform = each.kind is platform_frequency
                highest[platform] = max(highest.get(platform, 0), int(each.name))
        return tuple(Modes(count, platform) for platform, count in highest.items())

    def __call__(self, shares: Array) -> list[Point | str]:
        """Compute points with derivatives for designs at fractions (s, n) of the ranges. For a failed design, return the reason."""
        return self._evaluate(shares, slopes=True)

    def evaluate(self, shares: Array) -> list[Point | str]:
        """Compute measures without derivatives for designs at fractions (s, n) of the ranges; for a failed design, return the reason."""
        return self._evaluate(shares, slopes=False)

    def _evaluate(self, shares: Array, *, slopes: bool) -> list[Point | str]:
        """Evaluate all at once; after a failure, halves, until the failing designs are isolated."""
        try:
            found = self._batch(shares, slopes=slopes)
        except (DesignError, np.linalg.LinAlgError) as error:
            if len(shares) == 1:
                return [str(error)]
            half = len(shares) // 2
            return [*self._evaluate(shares[:half], slopes=slopes), *self._evaluate(shares[half:], slopes=slopes)]
        return [point if _finite(point) else "a measure has no finite value" for point in found]

    def _design(self, shares: Array) -> Mechanism:
        columns = [each.at(shares[:, number]) for number, each in enumerate(self.study.variables)]
        return self._bare.mechanism_for(np.stack(columns, axis=-1))

    def _batch(self, shares: Array, *, slopes: bool) -> list[Point]:
        designs, variables = shares.shape
        each = variables if slopes else 1
        rows = np.repeat(shares, each, axis=0)
        if slopes:
            rows = rows + 1j * _STEP * np.tile(np.eye(variables), (designs, 1))
        with np.errstate(all="ignore"):
            stepped = self._design(rows)
            require_valid(replace(stepped, formulas={}))  # formulas have just been computed
            bench = StageResults(stepped, self._command)
            modes = spectra(bench.model, self._modes, (designs, variables if slopes else 0)) if self._modes else []
            columns = dict[tuple[str, str], Sequence[Scalars | NumberedFrequency]]()
            for key, measure in {(one.key, one.point): one for one in self.measures}.items():  # an objective may be a limit, too
                if measure.kind in _SPECTRAL:
                    columns[key] = [self._nth_frequency(own, measure) for own in modes]
                elif not measure.kind.analytic:
                    columns[key] = self._central_differences(measure, shares, slopes=slopes)
                else:
                    columns[key] = _scalars(measure.kind.pieces(bench, measure), _extreme(measure), (designs, each), slopes=slopes)
        return [Point(shares[design], tuple(columns[one.key, one.point][design] for one in self.measures)) for design in range(designs)]

    def _nth_frequency(self, own: tuple[Spectrum, ...], measure: Measure) -> NumberedFrequency:
        platform = measure.kind is platform_frequency
        return NumberedFrequency(own[[modes.platform for modes in self._modes].index(platform)], int(measure.name))

    def _central_differences(self, measure: Measure, shares: Array, *, slopes: bool) -> list[Scalars]:
        designs, variables = shares.shape
        moves = np.zeros((1, variables))
        if slopes:
            moves = _APART * np.concatenate([moves, np.eye(variables), -np.eye(variables)])
        rows = (shares[:, None] + moves[None]).reshape(-1, variables)
        found = measure.kind.pieces(bench_of(self._design(rows)), measure)
        values = np.broadcast_to(found, (len(rows), found.shape[-1])).reshape(designs, len(moves), -1)
        ahead, back = values[:, 1 : variables + 1], values[:, variables + 1 :]
        gradient = (ahead - back) / (2.0 * _APART) if slopes else np.zeros((designs, 0, values.shape[-1]))
        return [Scalars(own[0], change.T, _extreme(measure)) for own, change in zip(values, gradient, strict=True)]


def values_of(study: Study, shares: Array) -> Array:
    """Convert fractions of the ranges to values (d,) of the variables.

    A value is rounded to a multiple of the variable's step if the change is at most 1e-6 of the range.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> values_of(leaf_study()[0], np.array([0.5000000001])).round(12).tolist()
    [0.0013]
    """
    found = []
    for each, share in zip(study.variables, shares, strict=True):
        value = float(np.real(each.at(np.asarray(share))))
        near = value if each.step is None else round(value / each.step) * each.step
        found.append(near if abs(near - value) <= 1e-6 * (each.high - each.low) else value)
    return np.array(found)


def _extreme(measure: Measure) -> Extreme:
    """The extreme of a measure's pieces."""
    return measure.kind.extreme or Extreme.LEAST


def _scalars(values: Array, extreme: Extreme, shape: tuple[int, int], *, slopes: bool) -> list[Scalars]:
    """Pieces (s n, m) of stepped designs, design by design."""
    designs, each = shape
    spread = np.broadcast_to(values, (designs * each, values.shape[-1])).reshape(designs, each, -1)
    keep = np.isfinite(spread).all(axis=(0, 1)) | ~np.isinf(np.real(spread)).all(axis=(0, 1))  # not a piece if infinite everywhere
    spread = spread[..., keep]
    return [Scalars(np.real(own[0]), np.imag(own).T / _STEP if slopes else np.zeros((own.shape[-1], 0)), extreme) for own in spread]


def _finite(point: Point) -> bool:
    return bool(np.all(np.isfinite(point.values)) and np.all(np.isfinite(point.gradient)))
