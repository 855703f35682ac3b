"""Summary of samples: distributions, yield of each requirement and of all together, variance contributions, crosstalk."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import scipy

from flexstage.analysis.assessment.requirements import Requirement, Sense, Verdict
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Called, Graded, Heading, Layout, UnitIn
from flexstage.base.units.quantity import RATIO, SHARE
from flexstage.spatial.frame import COMPONENTS
from flexstage.studies.sweeps.definition import RequestedMeasure
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.tolerances.crosstalk import HELD, OPEN
from flexstage.studies.tolerances.definition import Tolerance
from flexstage.studies.tolerances.slopes import Slopes

PERCENTILES = (1, 5, 50, 95, 99)
CONFIDENCE = 0.95
_ROUGH = 0.1
_ERRORS = 4.0
ROUNDING = 1e-12
"""Relative range of values that counts as rounding errors of one value."""


@dataclass(frozen=True, eq=False)
class Spread:
    """Distributions of r responses over the samples with values. `nominal` contains the values of the nominal design.

    `percentiles` (5, r) are the percentiles 1, 5, 50, 95 and 99. `linear` (r,) is the standard deviation by first-order propagation,
    sqrt(sum (dy/dx s)^2), with the sum over all variables x with the standard deviation s. `trusted` (r,) is true if the response is
    smooth, and the standard deviation of the sample agrees with `linear` within 10 % or four standard errors. `by_slope` (m, r) are the
    fractions of the variance due to the m entries of `[scatter]`, from derivatives. `by_sample` (m, r) are the variances in the samples
    with the scatter of one entry only, divided by the sum of these variances over all entries. `by_slope` and `by_sample` are NaN for a
    constant response.
    """

    names: tuple[str, ...]
    nominal: Array
    mean: Array
    deviation: Array
    percentiles: Array
    linear: Array
    trusted: Array
    by_slope: Array
    by_sample: Array


@dataclass(frozen=True)
class ResponseSpread(RequestedMeasure):
    """Distribution of a response [SI] over the samples with values.

    `linear_deviation` is the standard deviation by first-order propagation; it is valid if `linear` is true. `share_by_derivatives` and
    `share_by_copies` are the fractions of the variance due to each entry of `[scatter]`. The first is computed from derivatives, the second
    from samples in which only one entry deviates. `derivatives` contains the derivative with respect to every variable.
    """

    nominal: float
    mean: float
    deviation: float
    percentiles: Mapping[str, float]
    linear_deviation: float
    linear: bool
    share_by_derivatives: Mapping[str, float]
    share_by_copies: Mapping[str, float]
    derivatives: Mapping[str, float]


@dataclass(frozen=True)
class Yield:
    """Yield of one requirement, or of all together: `kept` of `copies` samples comply. Failed samples do not meet a requirement.

    `low` to `high` is the 95 % interval of Clopper and Pearson, which is exact for random samples.
    """

    kept: int
    copies: int
    low: Annotated[float, INNER]
    high: Annotated[float, INNER]

    @property
    def share(self) -> Annotated[float, VIEW, SHARE, Heading("yield", mark=Graded(1.0, 0.9))]:
        """Fraction of the samples that comply."""
        return self.kept / self.copies

    @property
    def interval(self) -> Annotated[tuple[float, float], VIEW, RATIO, Heading("95 % interval", unit="%")]:
        """Ends of the 95 % interval of the yield."""
        return self.low, self.high


@dataclass(frozen=True, eq=False)
class Line:
    """A requirement of the specification, its column, its nominal value and its yield."""

    TABLE: ClassVar[Layout] = Layout("Yield", "column wanted nominal kept.share kept.interval")

    requirement: Annotated[Requirement, INNER]
    column: Annotated[str, Called("line")]
    nominal: Annotated[float, UnitIn("unit")]
    kept: Annotated[Yield, Called("yield")]

    @property
    def unit(self) -> str:
        """SI unit of the requirement's value."""
        return self.requirement.quantity.si

    @property
    def wanted(self) -> Annotated[str, VIEW, Heading("required")]:
        """The required range."""
        return self.requirement.text

    @property
    def margin(self) -> Annotated[float, VIEW]:
        """Distance of the nominal value to the limit [SI], positive if the requirement is met."""
        spare = self.nominal - self.requirement.limit
        return spare if self.requirement.sense is Sense.AT_LEAST else -spare


@dataclass(frozen=True, eq=False)
class Yields:
    """The yield of all requirements of the specification together, and the yield of each."""

    together: Annotated[Yield, Called("all")]
    lines: tuple[Line, ...]


@dataclass(frozen=True, eq=False)
class Crosstalk:
    """Statistics of the pose error per unit of command (6, f) over the samples: rows are motions, columns are commands.

    The commanded motion is subtracted from the pose. `kind` is `open` (the nominal mapping R_a commands the strokes) or `held` (a
    controller regulates the pose that the nominal mapping R_s^-1 measures). `nominal` and `mean` are signed. `deviation` is the standard
    deviation. `usual` is the 95th percentile of the absolute errors, and `worst` is their maximum. All statistics are in SI units.
    """

    kind: str
    point: str
    coordinates: Annotated[tuple[str, ...], Called("columns")]
    nominal: Annotated[Array, VIEW]
    mean: Annotated[Array, VIEW]
    deviation: Annotated[Array, VIEW]
    usual: Annotated[Array, VIEW]
    worst: Annotated[Array, VIEW]

    @property
    def rows(self) -> Annotated[tuple[str, ...], VIEW]:
        """The axes of motion."""
        return COMPONENTS


@dataclass(frozen=True, eq=False)
class Summary:
    """Summary of a sample. `together` is the yield of all requirements together, absent without a specification."""

    copies: int
    failed: int
    spread: Spread
    lines: tuple[Line, ...]
    together: Yield | None
    crosstalk: tuple[Crosstalk, ...]


def summary(study: Tolerance, results: Results, slope: Slopes) -> Summary:
    """Compute distributions, yields, contributions and crosstalk of a study's samples.

    >>> from flexstage.studies.tolerances.example import leaf_study
    >>> from flexstage.studies.tolerances.slopes import slopes
    >>> from flexstage.studies.sweeps.execution.evaluate import piece
    >>> study = leaf_study()
    >>> found = piece(study, 0, study.plan.designs)
    >>> count = study.plan.designs
    >>> results = Results(np.arange(count), found.variables, found.responses, {}, ((), ()), ((), ()), count, {}, "")
    >>> [line.kept.kept for line in summary(study, results, slopes(study)).lines]
    [64]
    """
    values = results.responses[results.designs < study.copies]
    sound = np.all(np.isfinite(values), axis=1)
    lines = tuple(_line(study, values, slope, number) for number in range(len(study.lines)))
    passed = [Verdict(line.requirement, values[:, _column(study, line.column)]).passed for line in lines]
    return Summary(
        copies=len(values),
        failed=int(np.sum(~sound)),
        spread=_spread(study, results, slope, values[sound]),
        lines=lines,
        together=binomial(np.all(passed, axis=0)) if passed else None,
        crosstalk=tuple(_crosstalk(study, values[sound], slope, kind) for kind in _kinds(study)),
    )


def binomial(passed: Array) -> Yield:
    """Compute the yield from a mask of passed samples, with the interval of Clopper and Pearson (Biometrika 26 (1934) 404).

    >>> found = binomial(np.array([True] * 9 + [False]))
    >>> found.share, round(found.low, 4), round(found.high, 4)
    (0.9, 0.555, 0.9975)
    """
    kept, count, tail = int(np.sum(passed)), len(passed), 0.5 * (1.0 - CONFIDENCE)
    low = float(scipy.special.betaincinv(kept, count - kept + 1, tail)) if kept else 0.0
    return Yield(kept, count, low, float(scipy.special.betaincinv(kept + 1, count - kept, 1.0 - tail)) if kept < count else 1.0)


def _column(study: Tolerance, name: str) -> int:
    return list(study.columns).index(name)


def _line(study: Tolerance, values: Array, slope: Slopes, number: int) -> Line:
    name, requirement = study.lines[number]
    column = _column(study, name)
    return Line(requirement, name, float(slope.values[column]), binomial(Verdict(requirement, values[:, column]).passed))


def _spread(study: Tolerance, results: Results, slope: Slopes, values: Array) -> Spread:
    size = np.array([each.deviation for each in study.deviations])
    parts = (slope.gradient * size) ** 2
    linear = np.sqrt(np.sum(parts, axis=1))
    constant = np.ptp(values, axis=0) <= ROUNDING * np.max(np.abs(values), axis=0) if len(values) else np.zeros(len(linear), dtype=bool)
    deviation = np.where(constant, 0.0, np.std(values, axis=0, ddof=1)) if len(values) > 1 else np.full(len(linear), np.nan)
    allowed = max(_ROUGH, _ERRORS / np.sqrt(2.0 * max(len(values), 1)))
    by_slope = np.stack([np.bincount(study.owners, each) for each in parts], axis=-1)
    alone = np.where(constant, 0.0, squares_alone(study, results, centre=None))
    percentiles = np.percentile(values, PERCENTILES, axis=0) if len(values) else np.full((len(PERCENTILES), len(linear)), np.nan)
    return Spread(
        names=tuple(study.columns),
        nominal=slope.values,
        mean=np.mean(values, axis=0) if len(values) else np.full(len(linear), np.nan),
        deviation=deviation,
        percentiles=percentiles,
        linear=linear,
        trusted=slope.smooth & (np.abs(linear - deviation) <= allowed * np.maximum(deviation, 1e-300)),
        by_slope=_ratio(by_slope, np.where(slope.smooth, linear**2, 0.0)),
        by_sample=_ratio(alone, np.sum(alone, axis=0)),
    )


def _ratio(parts: Array, whole: Array) -> Array:
    return np.divide(parts, whole, out=np.full(parts.shape, np.nan), where=np.isfinite(whole) & (whole > 0.0))


def squares_alone(study: Tolerance, results: Results, centre: Array | None) -> Array:
    """Compute the variances (m, r) of r responses in the samples with the scatter of one entry only.

    If `centre` is specified, compute mean squares about it instead. If the study has only one entry, the whole sample is used.
    """
    count, alone = study.copies, getattr(study.plan, "alone", 0)
    rows = []
    for number in range(len(study.scatters)):
        low, high = (count + number * alone, count + (number + 1) * alone) if alone else (0, count)
        values = results.responses[(results.designs >= low) & (results.designs < high)]
        values = values[np.all(np.isfinite(values), axis=1)]
        middle = values.mean(axis=0) if centre is None and len(values) else centre
        rows.append(np.mean((values - middle) ** 2, axis=0) if len(values) > 1 else np.full(results.responses.shape[1], np.nan))
    return np.stack(rows)


def _kinds(study: Tolerance) -> tuple[str, ...]:
    if study.commanded is None:
        return ()
    return (OPEN,) if study.commanded.sensing is None else (OPEN, HELD)


def _crosstalk(study: Tolerance, values: Array, slope: Slopes, kind: str) -> Crosstalk:
    commanded = study.commanded
    coordinates = COMPONENTS if kind == HELD or commanded is None else commanded.coordinates
    names = list(study.columns)
    places = [[names.index(f"{kind}.{row}.{column}") for column in coordinates] for row in COMPONENTS]
    own = np.array([[float(row == column) for column in coordinates] for row in COMPONENTS])
    errors = values[:, np.array(places)] - own
    empty = np.full(own.shape, np.nan)
    found = len(errors) > 0
    return Crosstalk(
        kind=kind,
        point=commanded.point if commanded is not None else "",
        coordinates=tuple(coordinates),
        nominal=slope.values[np.array(places)] - own,
        mean=errors.mean(axis=0) if found else empty,
        deviation=errors.std(axis=0, ddof=1) if len(errors) > 1 else empty,
        usual=np.percentile(np.abs(errors), 95, axis=0) if found else empty,
        worst=np.abs(errors).max(axis=0) if found else empty,
    )
