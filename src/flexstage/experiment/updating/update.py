"""Model updating: parameters that make the model agree with a test, their identifiability, and the updated design file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Annotated, Any, ClassVar

import numpy as np
import scipy

from flexstage.analysis.loaded.load_effect import load_effect
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.processes.threads import one_thread
from flexstage.base.record import INNER, VIEW, Graded, Heading, Layout, Mark, UnitIn
from flexstage.base.units.quantity import RATIO
from flexstage.experiment.comparison import Compared, compare, shared_sensors
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.updating.fit import Fitted, Problem, gauss_newton
from flexstage.experiment.updating.free import DEFAULT, Free, Prior, free
from flexstage.experiment.updating.gains import Gains, measured_gains
from flexstage.experiment.updating.rows import (
    Design,
    ModeRow,
    follow_modes,
    frequency_slopes,
    gain_slopes,
    mode_rows,
    same_pairs,
    start_design,
    static_gains,
)
from flexstage.mechanism.addresses.address import get
from flexstage.mechanism.mechanism import Mechanism

_IDENTIFIED, _HARDLY = 0.1, 0.2
_NO_EFFECT = 1e-6
_ROUNDS = 5
_ALONE = 0.9
_IMPROBABLE = 0.01
_FAR = 3.0
_CONTRADICTING = 10.0


class Identifiability(Enum):
    """Identifiability of a parameter, by the fraction of the prior variance that remains after the test."""

    WELL = "identified"
    """At most 10 % of the prior variance remains."""
    WEAKLY = "weakly identified"
    """At most 20 % of the prior variance remains."""
    NOT = "not identifiable"
    """More than 20 % of the prior variance remains: the value depends strongly on the prior."""
    WITHHELD = "withheld"
    """Model and test differ too much for conclusions on single parameters."""


_GRADES = dict(zip(Identifiability, (Mark.PASS, Mark.WARN, Mark.FAIL, Mark.FAIL), strict=True))
_DATUM = Heading(digits=6)
_REMAINING = Heading("remaining variance", digits=2, unit="%")


@dataclass(frozen=True)
class Residual:
    """Frequency [Hz] or static gain: measured value with relative standard deviation, and the model's values before and after the update.

    The standard deviation is relative to `scale`: the measured frequency, or the largest measured gain of the same actuator.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Theory and test",
        "name measured before after deviation misfit_before misfit_after",
        notes=(
            "Misfits: measured value minus theory, in standard deviations.",
            "Errors are relative to the measured frequency, or to the largest measured gain of the actuator.",
        ),
    )

    name: Annotated[str, Heading("datum")]
    unit: str
    measured: Annotated[float, UnitIn("unit"), _DATUM]
    deviation: Annotated[float, RATIO, Heading("error", digits=2, unit="%")]
    before: Annotated[float, UnitIn("unit"), _DATUM]
    after: Annotated[float, UnitIn("unit"), _DATUM]
    scale: Annotated[float, INNER]

    @property
    def misfit_before(self) -> Annotated[float, VIEW, Heading(digits=3)]:
        """Measured value minus value of the initial model, in standard deviations."""
        return (self.measured - self.before) / (self.scale * self.deviation)

    @property
    def misfit_after(self) -> Annotated[float, VIEW, Heading(digits=3, mark=Graded(2.0, 3.0))]:
        """Measured value minus value of the updated model, in standard deviations."""
        return (self.measured - self.after) / (self.scale * self.deviation)


@dataclass(frozen=True)
class UpdatedNumber:
    """Values of an updated parameter before and after the update, in SI units, and standard deviations of its logarithm.

    `change` is relative. `prior_variance_left` is the fraction of the prior variance that remains; `identifiability` and `verdict` follow
    from this fraction.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Parameters after the test",
        "address before after change prior_deviation deviation prior_variance_left identifiability",
        notes=("Remaining variance: fraction of the prior variance. Identified: at most 10 %; weakly identified: at most 20 %.",),
    )

    address: Annotated[str, Heading("parameter")]
    unit: str
    before: Annotated[float, UnitIn("unit")]
    after: Annotated[float, UnitIn("unit")]
    prior_deviation: Annotated[float, RATIO, Heading("prior +-", digits=2, unit="%")]
    deviation: Annotated[float, RATIO, Heading("after +-", digits=2, unit="%")]
    identifiability: Annotated[Identifiability, Heading("identifiability", mark=_GRADES.__getitem__)]
    verdict: str

    @property
    def change(self) -> Annotated[float, VIEW, RATIO, Heading(digits=3, unit="%")]:
        """Relative change: value after the update divided by value before, minus one."""
        return self.after / self.before - 1.0

    @property
    def interval(self) -> Annotated[tuple[float, float], VIEW]:
        """95 % interval of the value, SI."""
        low, high = sorted(self.after * float(np.exp(sign * NORMAL_95 * self.deviation)) for sign in (-1.0, 1.0))
        return low, high

    @property
    def prior_variance_left(self) -> Annotated[float, VIEW, RATIO, _REMAINING]:
        """Fraction of the prior variance that remains."""
        return (self.deviation / self.prior_deviation) ** 2


@dataclass(frozen=True)
class Combination:
    """Linear combination of parameters (in prior standard deviations); the update multiplies its variance by 1/(1 + singular_value^2)."""

    TABLE: ClassVar[Layout] = Layout(
        "Identifiable combinations",
        "combination singular_value prior_variance_left",
        notes=(
            "Unit: prior standard deviations. If the singular value is 1, the test halves the variance; if far below 1, it has no effect.",
        ),
    )

    singular_value: Annotated[float, Heading(digits=3)]
    direction: Mapping[str, float]

    @property
    def combination(self) -> str:
        """Text for tables that lists the parameters whose components exceed 0.05 in magnitude."""
        return ", ".join(f"{part:+.2f} {name}" for name, part in self.direction.items() if abs(part) > 0.05)

    @property
    def prior_variance_left(self) -> Annotated[float, VIEW, RATIO, _REMAINING]:
        """Fraction of the prior variance that remains."""
        return 1.0 / (1.0 + self.singular_value**2)


@dataclass(frozen=True, eq=False)
class Updated(InNotebook):
    """Result of an update: parameters before and after the update, in SI, with standard deviations of their logarithms.

    A small standard deviation of a logarithm equals the relative standard deviation of the value. `addresses` (P,) are the full addresses
    of the P parameters. `prior` (P,) are prior standard deviations and `covariance` (P, P) is the posterior covariance of the logarithms.
    The columns of `directions` (P, P) are combinations of parameters, in units of prior standard deviations, best identified first. For a
    combination with the singular value s in `singular` (P,), the fraction 1/(1 + s^2) of the prior variance remains. `chi_square` is the
    sum of squared residuals of data and priors after the update; `freedoms` is the number of data. `chi_square_before` is the sum of
    squared residuals of the data before the update. `mechanism` is the updated description. `data_warnings` lists the reasons why results
    may be unreliable.
    """

    addresses: Annotated[tuple[str, ...], INNER]
    units: Annotated[tuple[str, ...], INNER]
    before: Array
    after: Array
    prior: Array
    covariance: Array
    singular: Array
    directions: Array
    residuals: tuple[Residual, ...]
    chi_square_before: float
    chi_square: float
    steps: int
    assumed: Prior
    mechanism: Mechanism
    compared: Compared
    data_warnings: tuple[str, ...]
    provenance: str

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the assumed errors, and longer statements on identifiability."""
        known = self.assumed
        gains = "" if known.gain_error is None else f", gains {100.0 * known.gain_error:.3g} %"
        errors = f"Assumed errors: theoretical frequencies {100.0 * known.model_error:.3g} %{gains}; +- is one standard deviation."
        return errors, *(f"{each.address}: {each.verdict}." for each in self.parameters if each.verdict != each.identifiability.value)

    @property
    def parameters(self) -> Annotated[tuple[UpdatedNumber, ...], VIEW]:
        """List of updated parameters."""
        values = (column.tolist() for column in (self.before, self.after, self.prior, self.deviations))
        columns: tuple[Iterable[Any], ...] = (self.addresses, self.units, *values, self.identifiability, self.verdicts)
        return tuple(UpdatedNumber(*row) for row in zip(*columns, strict=True))

    @property
    def combinations(self) -> Annotated[tuple[Combination, ...], VIEW]:
        """Combinations of the parameters, best identified first."""
        columns = zip(self.singular, self.directions.T, strict=True)
        return tuple(Combination(float(size), dict(zip(self.addresses, column.tolist(), strict=True))) for size, column in columns)

    @property
    def deviations(self) -> Array:
        """Posterior standard deviations (P,) of the logarithms."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def changes(self) -> Array:
        """Relative changes (P,): values after the update divided by values before, minus one."""
        return self.after / self.before - 1.0

    @property
    def correlations(self) -> Annotated[Matrix, VIEW]:
        """Posterior correlations (P, P)."""
        values = self.covariance / np.outer(self.deviations, self.deviations)
        return Matrix(values, self.addresses, self.addresses, "1")

    @property
    def remaining_variance(self) -> Array:
        """Fraction (P,) of each parameter's prior variance that remains after the test."""
        return np.diag(self.covariance) / self.prior**2

    @property
    def identifiability(self) -> tuple[Identifiability, ...]:
        """Identifiability of each parameter; withheld for identifiable parameters if chi-squared exceeds ten times the number of data."""
        grades = Identifiability
        known = (
            grades.WELL if share <= _IDENTIFIED else grades.WEAKLY if share <= _HARDLY else grades.NOT for share in self.remaining_variance
        )
        return tuple(grades.WITHHELD if self.is_withheld and each is not grades.NOT else each for each in known)

    @property
    def is_withheld(self) -> bool:
        """Whether model and test differ more than plausible values of the parameters could explain."""
        return self.chi_square > _CONTRADICTING * max(1, self.freedoms)

    @property
    def data(self) -> str:
        """Compared data: `frequencies`, or `frequencies and static gains`."""
        return "frequencies" if self.assumed.gain_error is None else "frequencies and static gains"

    @property
    def verdicts(self) -> tuple[str, ...]:
        """Statement on the identifiability of each parameter; `not identifiable from frequencies` is a valid result."""
        return tuple(self._verdict(index, each) for index, each in enumerate(self.identifiability))

    @property
    def freedoms(self) -> Annotated[int, VIEW]:
        """Number of data, the degrees of freedom of chi-squared."""
        return len(self.residuals)

    @property
    def probability(self) -> Annotated[float, VIEW]:
        """Probability of this or a larger value of chi-squared, if standard deviations, priors and model are correct."""
        return float(scipy.special.chdtrc(self.freedoms, self.chi_square))

    def _verdict(self, index: int, grade: Identifiability) -> str:
        if grade is Identifiability.WITHHELD:
            return f"withheld: chi-square {self.chi_square:.2g} with {self.freedoms} data"
        if grade is not Identifiability.NOT:
            return grade.value
        row = np.where(np.arange(len(self.addresses)) == index, 0.0, self.correlations.values[index])
        other = int(np.argmax(np.abs(row)))
        rest = f"; only in combination with {self.addresses[other]}" if abs(row[other]) > _ALONE else ""
        return f"{grade.value} from {self.data}{rest}"


@check_arguments
@one_thread
def update(mechanism: Mechanism, experiment: Identified, names: Sequence[str], known: Prior = DEFAULT) -> Updated:
    """Update the parameters at the addresses `names` so that the lumped model agrees best with a test; `known` are the assumed errors.

    The method is Bayesian least squares in the logarithms x = ln(p/p0) of the parameters p relative to their initial values p0 (Tarantola
    2005, ch. 3; Friswell & Mottershead 1995, ch. 8). Gauss-Newton steps, with exact derivatives by complex step, minimise the sum of ((d -
    g(x))/sigma)^2 over all data d plus the sum of (x/sigma_p)^2 over all parameters. Here g(x) are the model's values, sigma the standard
    deviations of the data, and sigma_p the prior standard deviations of the parameters. The posterior covariance is (J^T W J + S^-1)^-1
    with the derivatives J of g, the weights W = diag(1/sigma^2) and the prior covariance S = diag(sigma_p^2).

    The data d are the logarithms of the modes' frequencies, paired as in `compare` with `loaded=False`; for repeated modes, the square
    root of their mean squared frequency is used. The standard deviations sigma of the data include the identified standard deviations and
    the model error. With a `gain_error`, static gains are also data. Intervals are valid if frequencies are nearly linear in the logarithms
    x within the intervals.

    Raises `DesignError` for parameters that are unknown, ambiguous, zero or without effect, for fewer data than parameters, for a record
    without the stage's gauges, and if the iteration does not converge.
    """
    freed = free(mechanism, names, known)
    model = start_design(freed.mechanism, ()).model
    gains = None
    if known.gain_error is not None:
        noise = measured_gains(mechanism, model, experiment, shared_sensors(model, experiment))
        gains = replace(noise, deviations=noise.errors(known.gain_error))
    compared = compare(freed.mechanism, experiment, loaded=False)
    rows = mode_rows(freed.mechanism, compared, experiment)
    require(_too_few_data(experiment, rows, freed, gains))
    here, first, steps = np.zeros(len(freed.names)), None, 0
    for _ in range(_ROUNDS):
        data = _Data(freed, known, rows, gains)
        found = gauss_newton(data.problem, here, start_design(freed.multiply(here * freed.deviations), rows))
        steps += found.steps
        if first is None:
            first = found
            require(_without_effect(found.slopes, freed, gains))
        compared = compare(found.state.mechanism, experiment, loaded=False)
        again = mode_rows(found.state.mechanism, compared, experiment)
        if same_pairs(rows, found.state, again):
            return _as_result(data, found, compared, steps)
        rows, here = again, found.parameters
        require(_too_few_data(experiment, rows, freed, gains))
    what = f"no convergence: the pairing of modes by shape still changes after {_ROUNDS} rounds"
    raise refuse("update", what, "Specify narrower priors, or start with a design nearer to the test (flexstage compare shows the pairs)")


@dataclass(frozen=True, eq=False)
class _Data:
    """Data with their weights, and the least-squares problem for free numbers.

    The deviations of `gains` include the `gain_error`; `gains` is absent without a comparison of gains.
    """

    freed: Free
    known: Prior
    rows: tuple[ModeRow, ...]
    gains: Gains | None

    @property
    def frequency_error(self) -> Array:
        """Relative standard deviations (rows,) of frequencies, of test and model."""
        return np.hypot(np.array([row.deviation for row in self.rows]), self.known.model_error)

    @property
    def problem(self) -> Problem[Design]:
        freed = self.freed
        return Problem(
            state=lambda place, before: follow_modes(before, freed.multiply(place * freed.deviations)),
            residuals=self.misfit,
            slopes=self.slopes,
        )

    def misfit(self, design: Design) -> Array:
        measured = np.array([row.frequency for row in self.rows])
        parts = [np.log(measured / design.frequencies) / self.frequency_error]
        if self.gains is not None:
            parts.append(((self.gains.values - static_gains(design, self.gains)) / self.gains.deviations).ravel())
        return np.concatenate(parts)

    def slopes(self, design: Design) -> Array:
        """Model slopes, weighted, by prior standard deviations (n, P)."""
        names = self.freed.names
        values = self.freed.deviations * np.array([get(design.mechanism, name) for name in names])
        parts = [frequency_slopes(design, names) * values / self.frequency_error[:, None]]
        if self.gains is not None:
            weighted = gain_slopes(design, names, self.gains) * values / self.gains.deviations[..., None]
            parts.append(weighted.reshape(-1, len(names)))
        return np.concatenate(parts)

    def residuals(self, before: Design, after: Design) -> Iterator[Residual]:
        both = zip(self.rows, self.frequency_error, before.frequencies, after.frequencies, strict=True)
        for row, error, first, last in both:
            yield Residual(row.name, "Hz", row.frequency, float(error), float(first), float(last), row.frequency)
        if self.gains is None:
            return
        first, last = static_gains(before, self.gains), static_gains(after, self.gains)
        scale = self.gains.scale
        errors = self.gains.deviations / scale
        for (row, column), value in np.ndenumerate(self.gains.values):
            name = f"gain {self.gains.outputs[row]}/{self.gains.inputs[column]}"
            numbers = (float(value), float(errors[row, column]), float(first[row, column]), float(last[row, column]))
            yield Residual(name, self.gains.units[row][column], *numbers, float(scale[column]))


def _as_result(data: _Data, found: Fitted[Design], compared: Compared, steps: int) -> Updated:
    freed = data.freed
    count = len(freed.names)
    _, singular, directions = np.linalg.svd(np.concatenate([found.slopes, np.zeros((count, count))]), full_matrices=False)
    whitened = (directions.T / (1.0 + singular**2)) @ directions
    before = follow_modes(found.state, freed.mechanism)
    residuals = tuple(data.residuals(before, found.state))
    start = data.misfit(before)
    return Updated(
        addresses=freed.names,
        units=freed.units,
        before=freed.values,
        after=freed.values * np.exp(found.parameters * freed.deviations),
        prior=freed.deviations,
        covariance=whitened * np.outer(freed.deviations, freed.deviations),
        singular=singular,
        directions=directions.T,
        residuals=residuals,
        chi_square_before=float(start @ start),
        chi_square=found.cost,
        steps=steps,
        assumed=data.known,
        mechanism=found.state.mechanism,
        compared=compared,
        data_warnings=(*compared.data_warnings, *_warnings(data, found, compared)),
        provenance=compared.provenance,
    )


def _warnings(data: _Data, found: Fitted[Design], compared: Compared) -> Iterator[str]:
    """Warnings for unreliable results, in addition to those of the comparison."""
    freed, errors, loaded = data.freed, data.known, load_effect(found.state.mechanism)
    if loaded is not None and loaded.model is not None:
        yield (
            f"the update uses the unloaded stage, but {loaded.cause} change {loaded.figure} by {100.0 * loaded.change:+.3g} %: the updated "
            "values include this change."
        )
    if scipy.special.chdtrc(len(found.residuals), found.cost) < _IMPROBABLE:
        yield (
            f"chi-square is {found.cost:.3g} with {len(found.residuals)} data: model and test differ by more than the assumed "
            f"errors, and the intervals are too narrow. Specify a model error above {100.0 * errors.model_error:.2g} %, or free other "
            "parameters that may be wrong."
        )
    for name, moved, prior in zip(freed.names, found.parameters, freed.deviations, strict=True):
        if abs(moved) > _FAR:
            yield f"{name} changed by {abs(moved):.2g} prior standard deviations of {100.0 * prior:.2g} %: another parameter may be wrong."
    for group in compared.repeated:
        if 0 < group.seen < len(group.numbers):
            yield f"repeated modes {' and '.join(map(str, group.numbers))}: the test shows {group.seen}; the measured mean represents all."


def _too_few_data(experiment: Identified, rows: tuple[ModeRow, ...], freed: Free, gains: Gains | None) -> Iterator[Finding]:
    where = experiment.responses.source or "record"
    count = len(rows) + (0 if gains is None else gains.values.size)
    if not rows:
        what = f"none of the {len(experiment.frequencies)} identified modes matches a platform mode"
        yield Finding(where, what, "Check names and signs of gauges and the band (flexstage compare lists all modes)")
    elif count < len(freed.names):
        seen = ", ".join(row.name for row in rows)
        what = f"too few data for {len(freed.names)} free parameters (got {count}: {seen}; repeated modes count once)"
        yield Finding(where, what, "Free fewer parameters, or also compare static gains" if gains is None else "Free fewer parameters")


def _without_effect(slopes: Array, freed: Free, gains: Gains | None) -> Iterator[Finding]:
    """Parameters whose prior deviation changes no datum by a millionth of the datum's deviation."""
    data = "compared frequencies" if gains is None else "compared frequencies and gains"
    for name, size in zip(freed.names, np.max(np.abs(slopes), axis=0), strict=True):
        if size < _NO_EFFECT:
            yield Finding(name, f"it has no effect on the {data}", "Remove it from the free parameters: the test has no information on it")
