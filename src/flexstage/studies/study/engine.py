"""Platform frequencies of a study's designs, thousands a second: planned once for a study, then asked for any designs of it.

Which way a design goes, and whether descriptions are fitted, depends on the study alone: not on how its designs are cut into pieces, nor on
how many of them are left to compute.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from flexstage.analysis.requirements import Subject
from flexstage.base.finding import DesignError
from flexstage.base.number import Array, Table
from flexstage.mechanism.locate import canonical
from flexstage.mechanism.mechanism import Mechanism
from flexstage.readings.batch.choice import Choice
from flexstage.readings.batch.engine import Plan, Status, planned, platform_modes
from flexstage.readings.batch.numbers import Family, drawn_family, family
from flexstage.studies.study.definition import Study
from flexstage.studies.study.numbers import Numbers
from flexstage.studies.study.variable import varied_by

_MODES = 6
_FIT = 4_700
"""Descriptions that fitting takes, and `_EACH` more for every number: so many more designs must there be that it pays, `_TIMES` over."""
_EACH = 34
_TIMES = 4
_SURE = (Status.ITERATED, Status.WHOLE)


@dataclass(frozen=True, eq=False)
class Planned:
    """The `plan` for designs that differ in `numbers`."""

    plan: Plan
    numbers: Numbers


@dataclass(frozen=True, eq=False)
class Engine:
    """What the engine answers of a study: platform modes (from 0) by name of the response, none where there is no plan."""

    modes: Mapping[str, int]
    planned: Planned | None = None

    def answers(self, values: Array) -> tuple[Array, Array]:
        """Frequencies (n, m) [Hz] of the m responses for designs with `values` (n, d) of the variables, and which designs (n,) have them.

        A design without them may have fewer such modes, or move freely: reading it by itself tells.

        >>> from flexstage.studies.study.example import neck_study
        >>> engine_of(neck_study()).answers(np.array([[0.00154]]))[0].round(1).tolist()
        [[106.0]]
        """
        if self.planned is None:
            return np.zeros((len(values), 0)), np.ones(len(values), dtype=bool)
        found = platform_modes(self.planned.plan, self.planned.numbers.at(values))
        return found.frequencies[:, list(self.modes.values())], np.isin(found.status, _SURE)

    @property
    def iterates(self) -> bool:
        """Whether designs take microseconds: small stages are solved whole, and gain nothing from being many."""
        return self.planned is not None and self.planned.plan.start is not None


def engine_of(study: Study) -> Engine:
    """The engine for a study: its plan, over the variables' ranges where the study has designs enough for that to pay.

    What it does not cover is left to the other readings: designs described in a way of the study's own, a varied limit of modes. Raises
    nothing.

    >>> from flexstage.studies.study.example import neck_study
    >>> dict(engine_of(neck_study()).modes)
    {'tilt': 0}
    """
    wanted = {name: int(each.name) - 1 for name, each in study.columns.items() if each.subject is Subject.PLATFORM_FREQUENCY}
    modes = Table({name: mode for name, mode in wanted.items() if mode < _MODES})
    parametric = any(each.variant is not None for each in study.variables)
    numbers = _columns(study) if parametric else study.numbers
    if not modes or numbers is None or not _writes_numbers(type(study), parametric=parametric) or _moves_limit(study):
        return Engine(Table({}))
    limit = study.design.mode_limit
    choice = Choice(_MODES, np.inf if limit is None else float(np.max(limit)))
    try:
        with threadpool_limits(1):  # sums over several threads would not be the same to the bit
            family_ = _drawn(study, numbers) if parametric else family(study.design, numbers.addresses)
            return Engine(modes, Planned(planned(family_, choice, _ranges(study, numbers)), numbers))
    except DesignError:
        return Engine(Table({}))


def _moves_limit(study: Study) -> bool:
    """Whether a variable moves the limit of modes."""
    addresses = [each for variable in study.variables if variable.variant is None for each in variable.addresses]
    return any(canonical(study.design, each) == "mode_limit" for each in addresses)


def _columns(study: Study) -> Numbers:
    """The variables themselves as numbers: what designs are drawn from, where parameters of a case vary."""
    count = len(study.variables)
    return Numbers(tuple(each.name for each in study.variables), np.arange(count), np.ones(count))


@dataclass(frozen=True, eq=False)
class _Drawing:
    """What describes designs by the values of all variables."""

    study: Study

    def __call__(self, columns: tuple[Array, ...]) -> Mechanism:
        return varied_by(self.study.design, self.study.variables, columns)


def _drawn(study: Study, numbers: Numbers) -> Family:
    """The designs drawn from the variables' values, about the middle of their ranges."""
    return drawn_family(_Drawing(study), numbers.addresses, np.array([float(each.at(np.array(0.5))) for each in study.variables]))


def _ranges(study: Study, numbers: Numbers) -> tuple[Array, Array] | None:
    """Over what the descriptions are to be fitted."""
    if study.plan.designs < _TIMES * (_FIT + _EACH * len(numbers.addresses)):
        return None
    low, high = (np.array([getattr(each, end) for each in study.variables]) for end in ("low", "high"))
    return numbers.ranges(low, high)


def _writes_numbers(kind: type[Study], *, parametric: bool) -> bool:
    """Whether a kind of study says itself which numbers its designs differ in, if it describes them in a way of its own."""
    return kind.described is Study.described or (kind.numbers is not Study.numbers and not parametric)
