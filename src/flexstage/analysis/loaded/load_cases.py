"""Load cases and stroke ends of a design: by how much what loads the stage may grow there until something gives way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.loaded.course import course
from flexstage.analysis.loaded.operating_point import Conditions
from flexstage.analysis.loaded.stability import give_way
from flexstage.analysis.loaded.standing import drawn, load_factors
from flexstage.analysis.workspace.force_workspace import input_limits
from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import DesignError, Finding, LowerBoundError, refuse
from flexstage.base.notebook import Result
from flexstage.base.number import first_design
from flexstage.base.record import INNER, Heading, Layout
from flexstage.base.units.quantity import DISPLACEMENT, RATIO
from flexstage.base.units.unit import quantity_of_unit, show
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.paths.critical_load import (
    Critical,
    NothingGivesWayError,
    critical_load,
    require_continuation,
    unstable_motions,
)
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.models.nonlinear.state import STATED, WEIGHT
from flexstage.parts.part import push_of
from flexstage.spatial.frame import COMPONENTS, FORCES

REST = "at rest"
ENOUGH = 1e-4
"""How closely a factor is printed."""
_MOST = 1e12
"""Up to how many times a load is followed."""
_ENDS = 8
"""Actuators whose ends are looked at one by one; of more only the worst corner."""


@dataclass(frozen=True, eq=False)
class LoadCase(CheckedFields):
    """A load that `grows` (loads by name, weight and stated forces among them), and where the stage stands.

    `stays` are loads that do not grow. Coordinates and strokes in `at` are brought there, counted from rest, and kept there: the stage
    counts as free under the force that this takes, but for coordinates that are `locked`. `gravity` says whether there is weight.
    """

    load: str
    place: str
    grows: Mapping[str, float]
    stays: Mapping[str, float] = field(default_factory=dict[str, float])
    at: Mapping[str, float] = field(default_factory=dict[str, float])
    locked: tuple[str, ...] = ()
    gravity: float = 1.0

    @property
    def shares(self) -> tuple[float, float]:
        """The shares of weight and of stated forces that do not grow."""
        return (0.0 if WEIGHT in self.grows else self.gravity, 0.0 if STATED in self.grows else 1.0)

    @property
    def whole(self) -> dict[str, float]:
        """All loads but the stage's own."""
        grown = {name: value for name, value in self.grows.items() if name not in {WEIGHT, STATED}}
        return {name: self.stays.get(name, 0.0) + grown.get(name, 0.0) for name in {**self.stays, **grown}}


@dataclass(frozen=True, eq=False)
class CaseFactor:
    """How many times its `load` the stage bears at a `place`, all else staying, of which `kind` the end is, and the `buckling_mode`.

    `factor` is infinite where nothing gives way up to the largest factor, NaN where it is not known; `why` gives the reason. `bound` is the
    factor up to which the stage is stable, NaN where that is not known.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Load cases and stroke ends",
        "load place factor bound kind buckling_mode why",
        notes=("Each load alone, all else constant; actuators are free where a force brings the stage to the operating point.",),
    )

    load: str
    place: Annotated[str, Heading("operating point")]
    factor: Annotated[float, RATIO, Heading("load factor", digits=5)]
    kind: str
    buckling_mode: str
    why: Annotated[str, Heading("not followed because")]
    bound: Annotated[float, RATIO, Heading("stable up to", digits=5)] = np.nan
    found: Annotated[Critical | None, INNER] = None


class CaseFactors(Result):
    """Every load case and stroke end of a design, `cases`, and what the least factor of them is asked to be, `demand`."""

    cases: tuple[CaseFactor, ...]
    demand: Annotated[float, RATIO]
    provenance: str

    @property
    def least(self) -> CaseFactor | None:
        """The case that bears least; None where nothing gives way."""
        known = [case for case in self.cases if np.isfinite(case.factor)]
        return min(known, key=lambda case: case.factor, default=None)

    @property
    def least_bound(self) -> CaseFactor | None:
        """The case whose path ends first without a vanishing stiffness; None where all are followed."""
        unknown = [case for case in self.cases if np.isnan(case.factor) and case.bound > 0.0]
        return min(unknown, key=lambda case: case.bound, default=None)

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Cases that bear less than they have, or less than is asked."""
        return tuple(self._doubts())

    def _doubts(self) -> Iterator[Finding]:
        bound = max(1.0, self.demand)
        short = [case for case in self.cases if case.factor < bound]
        if short:
            least = min(short, key=lambda case: case.factor)
            asked = f" ({self.demand:g} is asked for)" if self.demand > 1.0 else ""
            others = f"; {len(short) - 1} more of {len(self.cases)} load cases bear less than {bound:g} times theirs" if short[1:] else ""
            what = f"it bears {least.factor:.4g} times {least.load}{asked}, where {give_way(least.buckling_mode)}{others}"
            yield Finding(least.place, what, "Ask for less stroke, lighten the load, or make what it presses on stiffer")
        for case in self.cases:
            if np.isnan(case.factor) and not case.bound >= bound:
                yield Finding(
                    case.place, f"how many times {case.load} it bears is not known: {case.why}", "Ask flexstage stroke how far it goes"
                )


@check_arguments
def buckling_factors(
    mechanism: Mechanism, cases: Sequence[LoadCase] | None = None, *, temperature: float = 0.0, most: float = _MOST, demand: float = 1.0
) -> CaseFactors:
    """The critical factor of every load case and stroke end of a design, at large displacements.

    Loads are the weight with its payloads, and stated forces with preloads; of a path in `[paths]` those that its `hold` states too. They
    grow one at a time, all else stays: at rest; at both ends of every path; of a design without paths at both ends of every actuator, where
    there are at most eight, and at the corner of the strokes that is worst by linearised buckling. A coordinate is brought there by a dead
    force that stays, as `--at` has it; a stroke is kept. A load is followed up to `most` times.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> [case.place for case in buckling_factors(parallelogram(), most=2.0).cases]
    ['at rest', 'B = -5.429 um', 'B = 32.57 um']
    """
    model = nonlinear(mechanism, temperature=temperature)
    asked = load_cases(mechanism) if cases is None else cases
    return CaseFactors(tuple(_factor(model, case, most) for case in asked), demand, model.provenance)


def load_cases(mechanism: Mechanism) -> tuple[LoadCase, ...]:
    """The load cases and stroke ends of a design, as `buckling_factors` has them.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> [(case.load, case.place) for case in load_cases(parallelogram())][:2]
    [('weight', 'at rest'), ('weight', 'B = -5.429 um')]
    """
    own = list(_own(mechanism))
    ends = [each for name in mechanism.paths for each in path_cases(mechanism, name)] or list(_stroke_cases(mechanism))
    return (*(LoadCase(load, REST, {load: 1.0}) for load in own), *ends)


def _own(mechanism: Mechanism) -> Iterator[str]:
    if np.any(np.asarray(mechanism.gravity) != 0.0):
        yield WEIGHT
    if mechanism.forces or any(np.any(push_of(link.part) or 0.0) for link in expand(mechanism).links.values()):
        yield STATED


def path_cases(mechanism: Mechanism, name: str, places: Mapping[str, float] | None = None) -> Iterator[LoadCase]:
    """The load cases of one path: at both ends, or at `places` of its drive [SI] by what they are called.

    >>> from flexstage.cases.registry import case
    >>> [each.place for each in path_cases(case("long-travel-xy"), "x")]
    ['platform.x = -5 mm', 'platform.x = 5 mm']
    """
    stated, found = mechanism.paths[name], course(mechanism, name)
    ends = {f"{stated.drive} = {text}": value for text, value in zip(stated.to, found.values[[0, -1]], strict=True)}
    text = ", ".join(f"{load} = {stated.hold.get(load) or stated.hold[_coordinate(load)]}" for load in found.loads)
    for place, value in (ends if places is None else places).items():
        at, own = ({found.drive: value} if value else {}), [each for each in _own(mechanism) if found.weight or each != WEIGHT]
        for load in own if at or found.loads or places is not None else ():
            yield LoadCase(load, place, {load: 1.0}, stays=found.loads, at=at, locked=found.locked, gravity=found.weight)
        if found.loads:
            yield LoadCase(text, place, found.loads, at=at, locked=found.locked, gravity=found.weight)


def _coordinate(load: str) -> str:
    """The coordinate that a force or moment works on.

    >>> _coordinate("platform.fx")
    'platform.x'
    """
    owner, _, component = load.rpartition(".")
    return f"{owner}.{COMPONENTS[FORCES.index(component)]}" if component in FORCES else load


def _stroke_cases(mechanism: Mechanism) -> Iterator[LoadCase]:
    """Both ends of every actuator, and the worst corner of all by linearised buckling; none where limits are not stated."""
    own, model = list(_own(mechanism)), drawn(mechanism)
    if not own or not model.actuators:
        return
    try:
        limits = input_limits(mechanism, model)
    except DesignError:
        return
    units = {channel.name: channel.unit for channel in model.inputs}
    ends = [first_design(each, 1) for each in (limits.low, limits.high)]
    if len(limits.actuators) <= _ENDS:
        for place, name in enumerate(limits.actuators):
            for value in (float(end[place]) for end in ends):
                if value:
                    yield from (LoadCase(load, _place(name, value, units[name]), {load: 1.0}, stays={name: value}) for load in own)
    worst = load_factors(mechanism)
    if worst is not None and np.any(worst.strokes) and len(limits.actuators) > 1:
        strokes = dict(zip(limits.actuators, first_design(worst.strokes, 1).tolist(), strict=False))
        yield from (LoadCase(load, "worst corner of all strokes", {load: 1.0}, stays=strokes) for load in own)


def _place(name: str, value: float, unit: str) -> str:
    return f"{name} = {show(value, DISPLACEMENT if unit == 'm' else quantity_of_unit(unit), digits=4)}"


def _factor(model: Nonlinear, case: LoadCase, most: float) -> CaseFactor:
    try:
        found = case_critical(model, case, most=most)
    except NothingGivesWayError as error:
        return CaseFactor(case.load, case.place, np.inf, "", "", error.findings[0].what, most)
    except DesignError as error:
        bound = error.bound if isinstance(error, LowerBoundError) else np.nan
        return CaseFactor(case.load, case.place, np.nan, "", "", "; ".join(each.what for each in error.findings), bound)
    moving = found.link or " and ".join(_moving(found))
    return CaseFactor(case.load, case.place, found.factor, found.kind.value, moving, "", found.factor, found)


def case_critical(model: Nonlinear, case: LoadCase, *, most: float = _MOST, tolerance: float = ENOUGH) -> Critical:
    """The factor on what grows in a load case, from where the stage stands there; below 1 it is looked for from no load on.

    Raises `DesignError` where the stage has no equilibrium there, and as `critical_load` does.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> stage = nonlinear(parallelogram())
    >>> round(case_critical(stage, LoadCase("push", "at rest", {"platform.fx": -1e3}, gravity=0.0)).factor, 3)
    11.063
    """
    point = Conditions(model, case.whole, case.at, case.locked, case.gravity)
    known, hold = _brought(point)
    stays = {**case.stays, **point.driven}
    weight, stated = case.shares
    return critical_load(
        model,
        case.grows,
        rest=stays,
        hold=hold,
        locked=case.locked,
        weight=weight,
        stated=stated,
        known=known,
        most=most,
        tolerance=tolerance,
    )


def _brought(point: Conditions) -> tuple[State | None, dict[str, float]]:
    """The stage where a case has it under all of its load, if it is stable there, and the coordinates that keep it there."""
    if not point.at and not point.fixed:
        return None, {}
    there, hold = point.reach(1.0), point.held(1.0)
    if not bool(there.converged):
        raise refuse("stage", "no equilibrium was found there", "Ask for less")
    if not point.at or int(unstable_motions(there, locked=point.fixed)):
        return None, hold
    require_continuation(point.reach(0.0), there)
    return there, hold


def _moving(found: Critical) -> tuple[str, ...]:
    """The bodies that move most as the stage gives way, at most three."""
    sizes = np.sqrt(np.sum(found.shape[:, :3] ** 2, axis=-1))
    most = [found.bodies[place] for place in np.argsort(-sizes, kind="stable") if sizes[place] > 0.5 * np.max(sizes)]
    return tuple(most[:3])
