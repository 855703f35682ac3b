"""A study: its initial design, its variables and its responses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from enum import Enum
from typing import Annotated

import numpy as np

from flexstage.analysis.assessment.judge import measure_all
from flexstage.analysis.assessment.measures import MEASURES, Measure
from flexstage.analysis.assessment.requirements import Requirement, Verdict
from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number
from flexstage.base.record import INNER, VIEW, Called
from flexstage.base.storage.digest import digest
from flexstage.base.units.quantity import Quantity
from flexstage.base.version import __version__
from flexstage.mechanism.mechanism import Mechanism
from flexstage.studies.sweeps.numbers import Numbers
from flexstage.studies.sweeps.plan import Plan, shares
from flexstage.studies.sweeps.variable import Variable, apply_columns


@dataclass(frozen=True)
class RequestedMeasure:
    """A requested measure of a study, with its name in the file."""

    name: str
    measure: Annotated[Measure, INNER]

    @property
    def key(self) -> Annotated[str, VIEW, Called("measure")]:
        """The measure's key, as in `[requirements]`."""
        return self.measure.key

    @property
    def point(self) -> Annotated[str, VIEW]:
        """The point at which the measure is evaluated."""
        return self.measure.point

    @property
    def unit(self) -> Annotated[str, VIEW]:
        """The SI unit of the measure."""
        return self.measure.quantity.si


@dataclass(frozen=True, eq=False)
class Study:
    """The contents of a study's file: nominal `design`, `variables`, `responses` by name, `limits` on measures, and the sampling `plan`.

    `text` is the text of the file, stored with the results.
    """

    name: str
    design: Mechanism
    variables: tuple[Variable, ...]
    responses: Mapping[str, Measure]
    limits: tuple[Requirement, ...]
    plan: Plan
    text: str = ""

    @property
    def names(self) -> tuple[tuple[str, str], ...]:
        """List the location in the file and the name of each column of the results: variables, responses, and measures of limits.

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> neck_study().names
        (('variables.neck', 'neck'), ('responses.tilt', 'tilt'))
        """
        variables = ((f"variables.{each.name}", each.name) for each in self.variables)
        responses = ((f"responses.{name}", name) for name in self.responses)
        limits = ((f"limits.{self.columns[name].key}", name) for name in self.columns if name not in self.responses)
        return *variables, *responses, *limits

    @property
    def columns(self) -> Mapping[str, Measure]:
        """Computed measures of each design, by name: the responses, and the further measures to which limits apply."""
        requested = {(each.key, each.point) for each in self.responses.values()}
        further = [each for each in self.limits if (each.key, each.point) not in requested]
        return {**self.responses, **{each.key if each.key not in self.responses else f"limit {each.key}": each for each in further}}

    @property
    def facts(self) -> dict[str, str]:
        """Inputs on which the results depend, as strings. Studies with equal facts have equal results.

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> list(neck_study().facts)
        ['version', 'design', 'plan', 'variables.neck', 'responses.tilt']
        """
        return {
            "version": __version__,
            "design": digest(self.design, physics=True)[:16],
            "plan": _describe(self.plan),
            **{f"variables.{each.name}": _describe(each) for each in self.variables},
            **{f"responses.{name}": f"{each.key} at {each.point}{_offer(each)}" for name, each in self.columns.items()},
        }

    def sample(self, start: int, stop: int) -> Array:
        """Compute values (n, d) of the variables in SI for the plan's designs `start` to `stop` (excluded).

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> neck_study().sample(1, 3).shape
        (2, 1)
        """
        at = shares(self.plan, start, stop)
        return np.stack([variable.at(at[:, number]) for number, variable in enumerate(self.variables)], axis=-1)

    def mechanism_for(self, values: Array) -> Mechanism:
        """Build the design with `values` (..., d) of the variables.

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> neck_study().mechanism_for(np.array([0.0015])).parts["neck"].thickness
        0.0015
        """
        return self.mechanism_at(tuple(values[..., number] for number in range(len(self.variables))))

    def mechanism_at(self, columns: tuple[Number, ...]) -> Mechanism:
        """Build the design from `columns`, the real or complex values (...) of each variable.

        Only numbers of the design that depend on a complex value become complex.

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> neck_study().mechanism_at((0.0015,)).parts["neck"].thickness
        0.0015
        """
        return apply_columns(self.design, self.variables, columns)

    @property
    def numbers(self) -> Numbers | None:
        """Numbers that differ between designs, as linear functions of the variables. None if designs are built directly from the variables.

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> neck_study().numbers  # what `drawn_from` makes of the variables will do
        """
        return None

    def evaluate(self, mechanism: Mechanism, names: tuple[str, ...] | None = None) -> tuple[Array | str, ...]:
        """Compute the measures named in `names` (default: all columns) of a design or a batch. A missing value is replaced by its reason.

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> round(float(neck_study().evaluate(neck_study().design)[0]))
        106
        """
        columns = self.columns
        return measure_all(mechanism, tuple(columns[name] for name in (columns if names is None else names)))

    def feasible(self, responses: Array, limits: Sequence[Requirement] | None = None) -> Array:
        """Return the mask (n,) of designs that meet all limits, from all responses (n, r). A design without values violates every limit.

        `limits` replaces the limits of the study.

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> neck_study().feasible(np.array([[100.0], [np.nan]])).tolist()
        [True, False]
        """
        names = list(self.columns)
        measured_by = {(each.key, each.point): names.index(name) for name, each in self.columns.items()}
        verdicts = [
            Verdict(each, responses[:, measured_by[each.key, each.point]]).passed for each in (self.limits if limits is None else limits)
        ]
        return np.all([np.all(np.isfinite(responses), axis=1), *verdicts], axis=0)


def _offer(measure: Measure) -> str:
    """The package and version of a measure, if it is from another package."""
    offer = MEASURES.offer(measure.kind.form)
    return f", of {offer}" if offer else ""


def name_findings(study: Study) -> Iterator[Finding]:
    """Check the column names of the results for duplicate and invalid names.

    >>> from dataclasses import replace
    >>> from flexstage.studies.sweeps.example import neck_study
    >>> print(*name_findings(replace(neck_study(), responses={"neck": neck_study().responses["tilt"]})))
    responses.neck: column "neck" exists already, from variables.neck. Use unique names.
    """
    owners = {"design": "the number of a design"}
    for where, name in study.names:
        if not name.strip() or not name.isprintable():
            yield Finding(where, "the name is empty, or contains control characters", "Use letters and digits")
        elif name in owners:
            yield Finding(where, f'column "{name}" exists already, from {owners[name]}', "Use unique names")
        owners[name] = where


def _describe(value: Plan | Variable) -> str:
    """All fields that results depend on, as text; absent ones are left out."""
    kept = [(each.name, getattr(value, each.name)) for each in fields(value) if each.repr and each.name != "name"]
    return ", ".join(f"{name} {_word(item)}" for name, item in kept if item is not None and item is not False and item != ())


def _word(item: object) -> str:
    if isinstance(item, Quantity):
        return f"{item.name} [{item.si}]"
    if isinstance(item, tuple):
        return " and ".join(_word(each) for each in item)
    return str(item.value) if isinstance(item, Enum) else str(item)
