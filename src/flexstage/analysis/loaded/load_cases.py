"""Critical load factors of a design for its load cases, at the static equilibrium and at the ends of the strokes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.loaded.course import course
from flexstage.analysis.loaded.operating_point import OperatingPoint
from flexstage.analysis.loaded.stability import buckling_clause
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
    NoCriticalLoadError,
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
"""Relative tolerance of a critical load factor."""
_MOST = 1e12
"""Largest load factor of a load path."""
_ENDS = 8
"""Largest number of actuators with a load case at each stroke end; beyond it, only the worst corner."""


@dataclass(frozen=True, eq=False)
class LoadCase(CheckedFields):
    """Load case: one load grows at an operating point. `grows` contains the components of this load, e.g. weight or specified forces.

    `stays` contains the constant loads. Coordinates and strokes in `at` are displacements from the static equilibrium. A displaced
    coordinate is free to move and its force is constant, unless the coordinate is `locked`. `gravity` is the fraction of the weight.
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
        """Fractions of the weight and of the specified forces that remain constant."""
        return (0.0 if WEIGHT in self.grows else self.gravity, 0.0 if STATED in self.grows else 1.0)

    @property
    def whole(self) -> dict[str, float]:
        """Constant and growing loads by name, without weight and specified forces."""
        grown = {name: value for name, value in self.grows.items() if name not in {WEIGHT, STATED}}
        return {name: self.stays.get(name, 0.0) + grown.get(name, 0.0) for name in {**self.stays, **grown}}


@dataclass(frozen=True, eq=False)
class CaseFactor:
    """Critical load factor of a `load` at the operating point `place`, with the `kind` of critical point and the `buckling_mode`.

    `factor` is infinite if the stage is stable up to the largest computed factor. `factor` is NaN if it is unknown; `why` is then the
    reason. `bound` is the factor up to which the stage is known to be stable, or NaN if no such factor is known.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Load cases and stroke ends",
        "load place factor bound kind buckling_mode why",
        notes=("Only the listed load grows; others are constant. Actuators are free if a force brings the stage to the operating point.",),
    )

    load: str
    place: Annotated[str, Heading("operating point")]
    factor: Annotated[float, RATIO, Heading("load factor", digits=5)]
    kind: str
    buckling_mode: str
    why: Annotated[str, Heading("reason")]
    bound: Annotated[float, RATIO, Heading("stable up to", digits=5)] = np.nan
    found: Annotated[Critical | None, INNER] = None


class CaseFactors(Result):
    """Critical load factors of all load cases, `cases`, and the required least factor, `demand`."""

    cases: tuple[CaseFactor, ...]
    demand: Annotated[float, RATIO]
    provenance: str

    @property
    def least(self) -> CaseFactor | None:
        """Case with the least critical load factor; None if the stage does not buckle in any case."""
        known = [case for case in self.cases if np.isfinite(case.factor)]
        return min(known, key=lambda case: case.factor, default=None)

    @property
    def least_bound(self) -> CaseFactor | None:
        """Case with the least `bound` among the cases with an unknown critical load factor; None if there is no such case."""
        unknown = [case for case in self.cases if np.isnan(case.factor) and case.bound > 0.0]
        return min(unknown, key=lambda case: case.bound, default=None)

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings for cases with a factor below 1 or below the required factor."""
        return tuple(self._doubts())

    def _doubts(self) -> Iterator[Finding]:
        bound = max(1.0, self.demand)
        short = [case for case in self.cases if case.factor < bound]
        if short:
            least = min(short, key=lambda case: case.factor)
            requested = f" (expected {self.demand:g} or more)" if self.demand > 1.0 else ""
            others = f"; {len(short) - 1} more of {len(self.cases)} load cases have a factor below {bound:g}" if short[1:] else ""
            what = f"critical load factor of {least.load} is {least.factor:.4g}{requested}: {buckling_clause(least.buckling_mode)}{others}"
            yield Finding(least.place, what, "Reduce stroke or load, or stiffen the parts that carry the load")
        for case in self.cases:
            if np.isnan(case.factor) and not case.bound >= bound:
                yield Finding(
                    case.place,
                    f"critical load factor of {case.load} is unknown: {case.why}",
                    "Run flexstage stroke to find the largest displacement",
                )


@check_arguments
def buckling_factors(
    mechanism: Mechanism, cases: Sequence[LoadCase] | None = None, *, temperature: float = 0.0, most: float = _MOST, demand: float = 1.0
) -> CaseFactors:
    """Compute the critical load factor of every load at every operating point of a design, with large displacements.

    The loads are the weight with payloads, and the specified forces with preloads. At the ends of a path in `[paths]`, the loads in the
    path's `hold` are a further load. In each load case one load grows, and all other loads are constant. The operating points are the
    static equilibrium and both ends of every path. A design without paths has other operating points: the static equilibrium, both stroke
    ends of every actuator (for at most eight actuators), and the combination of stroke ends with the least load factor by linearised
    buckling.

    If an operating point is a displacement of a coordinate, a force of constant direction causes this displacement, as with the option
    `--at`. If an operating point is a stroke, the stroke is fixed at its value. The search for critical load factors ends at the load
    factor `most`.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> [case.place for case in buckling_factors(parallelogram(), most=2.0).cases]
    ['at rest', 'B = -5.429 um', 'B = 32.57 um']
    """
    model = nonlinear(mechanism, temperature=temperature)
    requested = load_cases(mechanism) if cases is None else cases
    return CaseFactors(tuple(_factor(model, case, most) for case in requested), demand, model.provenance)


def load_cases(mechanism: Mechanism) -> tuple[LoadCase, ...]:
    """Return the load cases of a design at all operating points, as in `buckling_factors`.

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
    """Return the load cases of one path: at both ends, or at the drive values [SI] that `places` contains by name.

    >>> from flexstage.cases.registry import case
    >>> [each.place for each in path_cases(case("long-travel-xy"), "x")]
    ['platform.x = -5 mm', 'platform.x = 5 mm']
    """
    stated, result = mechanism.paths[name], course(mechanism, name)
    ends = {f"{stated.drive} = {text}": value for text, value in zip(stated.to, result.values[[0, -1]], strict=True)}
    text = ", ".join(f"{load} = {stated.hold.get(load) or stated.hold[_coordinate(load)]}" for load in result.loads)
    for place, value in (ends if places is None else places).items():
        at, own = ({result.drive: value} if value else {}), [each for each in _own(mechanism) if result.weight or each != WEIGHT]
        for load in own if at or result.loads or places is not None else ():
            yield LoadCase(load, place, {load: 1.0}, stays=result.loads, at=at, locked=result.locked, gravity=result.weight)
        if result.loads:
            yield LoadCase(text, place, result.loads, at=at, locked=result.locked, gravity=result.weight)


def _coordinate(load: str) -> str:
    """Coordinate conjugate to a force or moment.

    >>> _coordinate("platform.fx")
    'platform.x'
    """
    owner, _, component = load.rpartition(".")
    return f"{owner}.{COMPONENTS[FORCES.index(component)]}" if component in FORCES else load


def _stroke_cases(mechanism: Mechanism) -> Iterator[LoadCase]:
    """Load cases at both ends of every actuator, and at the worst corner of all strokes; none without specified limits."""
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
        result = case_critical(model, case, most=most)
    except NoCriticalLoadError as error:
        return CaseFactor(case.load, case.place, np.inf, "", "", error.findings[0].what, most)
    except DesignError as error:
        bound = error.bound if isinstance(error, LowerBoundError) else np.nan
        return CaseFactor(case.load, case.place, np.nan, "", "", "; ".join(each.what for each in error.findings), bound)
    moving = result.link or " and ".join(_moving(result))
    return CaseFactor(case.load, case.place, result.factor, result.kind.value, moving, "", result.factor, result)


def case_critical(model: Nonlinear, case: LoadCase, *, most: float = _MOST, tolerance: float = ENOUGH) -> Critical:
    """Compute the critical load factor of a load case on the path from its operating point.

    A factor below 1 is computed on the path from zero load. Raises `DesignError` if there is no equilibrium at the operating point, and
    whenever `critical_load` raises it.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> stage = nonlinear(parallelogram())
    >>> round(case_critical(stage, LoadCase("push", "at rest", {"platform.fx": -1e3}, gravity=0.0)).factor, 3)
    11.063
    """
    point = OperatingPoint(model, case.whole, case.at, case.locked, case.gravity)
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


def _brought(point: OperatingPoint) -> tuple[State | None, dict[str, float]]:
    """Stable equilibrium of a case under its full load, and the coordinates fixed there."""
    if not point.at and not point.fixed:
        return None, {}
    there, hold = point.state, point.targets(1.0)
    if not bool(there.converged):
        raise refuse("stage", "no equilibrium found", "Reduce the displacement or load")
    if not point.at or int(unstable_motions(there, locked=point.fixed)):
        return None, hold
    require_continuation(point.reach(0.0), there)
    return there, hold


def _moving(result: Critical) -> tuple[str, ...]:
    """Bodies with the largest motion in the buckling mode, at most three."""
    sizes = np.sqrt(np.sum(result.shape[:, :3] ** 2, axis=-1))
    most = [result.bodies[place] for place in np.argsort(-sizes, kind="stable") if sizes[place] > 0.5 * np.max(sizes)]
    return tuple(most[:3])
