"""Model updating: the numbers that make theory agree with a test, how well it tells them, and a design file that states them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Any, ClassVar

import numpy as np
import scipy

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

_TOLD, _HARDLY = 0.1, 0.2
_NO_EFFECT = 1e-6
_ROUNDS = 5
_ALONE = 0.9
_IMPROBABLE = 0.01
_FAR = 3.0
_CONTRADICTING = 10.0


class Told(Enum):
    """How well a test tells a number: by the share of its prior variance that is left."""

    WELL = "identified"
    """At most 10 %."""
    WEAKLY = "weakly identified"
    """At most 20 %."""
    NOT = "not identifiable"
    """More: the value is the prior's as much as the test's."""
    WITHHELD = "withheld"
    """Theory and test are so far apart that the test tells nothing of single numbers."""


_GRADES = {Told.WELL: Mark.PASS, Told.WEAKLY: Mark.WARN, Told.NOT: Mark.FAIL, Told.WITHHELD: Mark.FAIL}
_DATUM = Heading(digits=6)
_REMAINING = Heading("remaining variance", digits=2, unit="%")


@dataclass(frozen=True)
class Residual:
    """One datum [Hz, or of gains reading per input]: measured, by theory before and after, with its relative standard deviation.

    That of a gain is relative to the largest gain of its actuator, `scale`.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Theory and test",
        "name measured before after deviation misfit_before misfit_after",
        notes=("Misfits: measured less theory, in standard deviations.",),
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
        """Measured less theory before, in standard deviations."""
        return (self.measured - self.before) / (self.scale * self.deviation)

    @property
    def misfit_after(self) -> Annotated[float, VIEW, Heading(digits=3, mark=Graded(2.0, 3.0))]:
        """Measured less theory after, in standard deviations."""
        return (self.measured - self.after) / (self.scale * self.deviation)


@dataclass(frozen=True)
class UpdatedNumber:
    """One number before and after, in SI; `change` is relative, deviations are of the logarithm.

    `prior_variance_left` is the share that the test leaves; `told` and `verdict` say how well it tells the number.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Numbers after the test",
        "address before after change prior_deviation deviation prior_variance_left told",
        notes=("Remaining variance: of the prior's. Identified: at most 10 %; weakly identified: at most 20 %.",),
    )

    address: Annotated[str, Heading("number")]
    unit: str
    before: Annotated[float, UnitIn("unit")]
    after: Annotated[float, UnitIn("unit")]
    prior_deviation: Annotated[float, RATIO, Heading("prior +-", digits=2, unit="%")]
    deviation: Annotated[float, RATIO, Heading("after +-", digits=2, unit="%")]
    told: Annotated[Told, Heading("identifiability", mark=_GRADES.__getitem__)]
    verdict: str

    @property
    def change(self) -> Annotated[float, VIEW, RATIO, Heading(digits=3, unit="%")]:
        """Value after over value before, less one."""
        return self.after / self.before - 1.0

    @property
    def interval(self) -> Annotated[tuple[float, float], VIEW]:
        """95 % interval of the value, SI."""
        low, high = sorted(self.after * float(np.exp(sign * NORMAL_95 * self.deviation)) for sign in (-1.0, 1.0))
        return low, high

    @property
    def prior_variance_left(self) -> Annotated[float, VIEW, RATIO, _REMAINING]:
        """Share of the prior's variance."""
        return (self.deviation / self.prior_deviation) ** 2


@dataclass(frozen=True)
class Combination:
    """A combination of numbers, in prior standard deviations: 1/(1 + s^2) of its prior variance is left at a singular value s."""

    TABLE: ClassVar[Layout] = Layout(
        "Identifiable combinations",
        "combination singular_value prior_variance_left",
        notes=("In prior standard deviations. A singular value of 1 halves the prior variance; far below 1, it stays as it was.",),
    )

    singular_value: Annotated[float, Heading(digits=3)]
    direction: Mapping[str, float]

    @property
    def combination(self) -> str:
        """Its parts of more than 0.05, for tables."""
        return ", ".join(f"{part:+.2f} {name}" for name, part in self.direction.items() if abs(part) > 0.05)

    @property
    def prior_variance_left(self) -> Annotated[float, VIEW, RATIO, _REMAINING]:
        """Share of the prior's variance."""
        return 1.0 / (1.0 + self.singular_value**2)


@dataclass(frozen=True, eq=False)
class Updated(InNotebook):
    """Numbers before and after a test, SI, with the standard deviations of their logarithms (relative ones, where small).

    `addresses` (P) are full; `prior` (P,) and `covariance` (P, P) are of logarithms. `singular` (P,) and the columns of
    `directions` (P, P) are combinations of parameters, in prior standard deviations, by how well the data tell them: 1/(1 + s^2) of the
    prior variance is left. `chi_square` counts data and priors at the result, over `freedoms` data; `chi_square_before` the data alone.
    `mechanism` is the description after. `warnings` say what not to rely on.
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
        """The errors assumed, and verdicts that need more than a word, for tables."""
        known = self.assumed
        gains = "" if known.gain_error is None else f", gains {100.0 * known.gain_error:.3g} %"
        errors = f"Assumed errors: frequencies of theory {100.0 * known.model_error:.3g} %{gains}; +- is one standard deviation."
        return errors, *(f"{each.address}: {each.verdict}." for each in self.parameters if each.verdict != each.told.value)

    @property
    def parameters(self) -> Annotated[tuple[UpdatedNumber, ...], VIEW]:
        """The numbers one by one."""
        values = (column.tolist() for column in (self.before, self.after, self.prior, self.deviations))
        columns: tuple[Iterable[Any], ...] = (self.addresses, self.units, *values, self.told, self.verdicts)
        return tuple(UpdatedNumber(*row) for row in zip(*columns, strict=True))

    @property
    def combinations(self) -> Annotated[tuple[Combination, ...], VIEW]:
        """Combinations of the numbers, best told first."""
        columns = zip(self.singular, self.directions.T, strict=True)
        return tuple(Combination(float(size), dict(zip(self.addresses, column.tolist(), strict=True))) for size, column in columns)

    @property
    def deviations(self) -> Array:
        """Posterior standard deviations (P,) of the logarithms."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def changes(self) -> Array:
        """Values after over values before less one (P,)."""
        return self.after / self.before - 1.0

    @property
    def correlations(self) -> Annotated[Matrix, VIEW]:
        """Posterior correlations (P, P)."""
        values = self.covariance / np.outer(self.deviations, self.deviations)
        return Matrix(values, self.addresses, self.addresses, "1")

    @property
    def remaining_variance(self) -> Array:
        """Share (P,) of each prior variance that is left."""
        return np.diag(self.covariance) / self.prior**2

    @property
    def told(self) -> tuple[Told, ...]:
        """How well the test tells each number; withheld where data miss theory by more than three deviations on average."""
        known = (Told.WELL if share <= _TOLD else Told.WEAKLY if share <= _HARDLY else Told.NOT for share in self.remaining_variance)
        return tuple(Told.WITHHELD if self.is_withheld and told is not Told.NOT else told for told in known)

    @property
    def is_withheld(self) -> bool:
        """Whether theory and test contradict each other beyond what any of the numbers may be."""
        return self.chi_square > _CONTRADICTING * max(1, self.freedoms)

    @property
    def data(self) -> str:
        """What was compared: `frequencies`, or `frequencies and static gains`."""
        return "frequencies" if self.assumed.gain_error is None else "frequencies and static gains"

    @property
    def verdicts(self) -> tuple[str, ...]:
        """How well the test tells each number, in words: `not identifiable from frequencies` is a correct answer."""
        return tuple(self._verdict(index, told) for index, told in enumerate(self.told))

    @property
    def freedoms(self) -> Annotated[int, VIEW]:
        """Number of data."""
        return len(self.residuals)

    @property
    def probability(self) -> Annotated[float, VIEW]:
        """Probability that chi-square is this large or larger, if deviations, priors and theory hold."""
        return float(scipy.special.chdtrc(self.freedoms, self.chi_square))

    def _verdict(self, index: int, told: Told) -> str:
        if told is Told.WITHHELD:
            return f"withheld: chi-square {self.chi_square:.2g} with {self.freedoms} data"
        if told is not Told.NOT:
            return told.value
        row = np.where(np.arange(len(self.addresses)) == index, 0.0, self.correlations.values[index])
        other = int(np.argmax(np.abs(row)))
        rest = f"; only together with {self.addresses[other]}" if abs(row[other]) > _ALONE else ""
        return f"{told.value} from {self.data}{rest}"


@check_arguments
@one_thread
def update(mechanism: Mechanism, experiment: Identified, names: Sequence[str], known: Prior = DEFAULT) -> Updated:
    """The values of the numbers at `names` that make the lumped model agree best with a test, given what is known before.

    Bayesian least squares in the logarithms x = ln(p/p0) (Tarantola 2005, ch. 3; Friswell & Mottershead 1995, ch. 8): minimise
    sum ((d - g(x))/sigma)^2 + sum (x/sigma_p)^2 by Gauss-Newton, derivatives exact by complex step; posterior covariance
    (J^T W J + S^-1)^-1 at the result. Data are ln f of the modes paired as `compare` pairs them, repeated ones by their mean eigenvalue,
    with the identified deviations and the model error; with a `gain_error` also the static gains. Intervals hold where frequencies
    change about linearly over them.

    Raises `DesignError` for unknown, ambiguous and nought numbers, those without effect, fewer data than numbers, a record without the
    stage's gauges, and where no end is found.
    """
    freed = free(mechanism, names, known)
    model = start_design(freed.mechanism, ()).model
    gains = None
    if known.gain_error is not None:
        gains = measured_gains(mechanism, model, experiment, shared_sensors(model, experiment))
    compared = compare(freed.mechanism, experiment)
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
        compared = compare(found.state.mechanism, experiment)
        again = mode_rows(found.state.mechanism, compared, experiment)
        if same_pairs(rows, found.state, again):
            return _as_result(data, found, compared, steps)
        rows, here = again, found.parameters
        require(_too_few_data(experiment, rows, freed, gains))
    what = f"the pairing of modes by shape still changes after {_ROUNDS} rounds"
    raise refuse("update", what, "State narrower priors, or begin with a design nearer to the test (flexstage compare shows the pairs)")


@dataclass(frozen=True, eq=False)
class _Data:
    """The data with their weights, and the problem they make of free numbers; `gains` is absent where they are not compared."""

    freed: Free
    known: Prior
    rows: tuple[ModeRow, ...]
    gains: Gains | None

    @property
    def frequency_error(self) -> Array:
        """Relative standard deviations (rows,) of frequencies: of the test and of theory."""
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
            parts.append(((self.gains.values - static_gains(design, self.gains)) / self._gain_errors(self.gains)).ravel())
        return np.concatenate(parts)

    def slopes(self, design: Design) -> Array:
        """Of theory, weighted, by prior standard deviations (n, P)."""
        names = self.freed.names
        values = self.freed.deviations * np.array([get(design.mechanism, name) for name in names])
        parts = [frequency_slopes(design, names) * values / self.frequency_error[:, None]]
        if self.gains is not None:
            weighted = gain_slopes(design, names, self.gains) * values / self._gain_errors(self.gains)[..., None]
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
        errors = self._gain_errors(self.gains) / scale
        for (row, column), value in np.ndenumerate(self.gains.values):
            name = f"gain {self.gains.outputs[row]}/{self.gains.inputs[column]}"
            numbers = (float(value), float(errors[row, column]), float(first[row, column]), float(last[row, column]))
            yield Residual(name, self.gains.units[row][column], *numbers, float(scale[column]))

    def _gain_errors(self, gains: Gains) -> Array:
        return gains.errors(self.known.gain_error or 0.0)


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
    """What not to rely on, besides what the comparison says."""
    freed, errors = data.freed, data.known
    if scipy.special.chdtrc(len(found.residuals), found.cost) < _IMPROBABLE:
        yield (
            f"chi-square is {found.cost:.3g} with {len(found.residuals)} data: theory and test differ by more than the stated "
            f"errors, and the intervals are too narrow: state a larger model error than {100.0 * errors.model_error:.2g} %, or free "
            "what else may be off."
        )
    for name, moved, prior in zip(freed.names, found.parameters, freed.deviations, strict=True):
        if abs(moved) > _FAR:
            yield f"{name} moved by {abs(moved):.2g} of its prior standard deviations of {100.0 * prior:.2g} %: something else may be off."
    for group in compared.repeated:
        if 0 < group.seen < len(group.numbers):
            yield f"the repeated modes {' and '.join(map(str, group.numbers))} are compared by the {group.seen} of them seen."


def _too_few_data(experiment: Identified, rows: tuple[ModeRow, ...], freed: Free, gains: Gains | None) -> list[Finding]:
    where = experiment.responses.source or "record"
    count = len(rows) + (0 if gains is None else gains.values.size)
    if not rows:
        what = f"none of the {len(experiment.frequencies)} modes found in it is like a mode of the platform"
        return [Finding(where, what, "Check names and signs of gauges and the band (flexstage compare shows both sides)")]
    if count >= len(freed.names):
        return []
    seen = ", ".join(row.name for row in rows)
    what = f"it gives {count} data ({seen}; repeated modes count once) for {len(freed.names)} free numbers"
    return [Finding(where, what, "Free fewer numbers, or compare static gains too" if gains is None else "Free fewer numbers")]


def _without_effect(slopes: Array, freed: Free, gains: Gains | None) -> list[Finding]:
    """Numbers whose prior deviation moves no datum by a millionth of the datum's deviation."""
    strength = np.max(np.abs(slopes), axis=0)
    data = "frequencies compared" if gains is None else "frequencies and gains compared"
    return [
        Finding(name, f"it has no effect on the {data}", "Take it out of the free numbers: the test tells nothing of it")
        for name, size in zip(freed.names, strength, strict=True)
        if size < _NO_EFFECT
    ]
