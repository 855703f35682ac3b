"""Operating points: equilibria of a displaced, loaded, fixed or heated stage, and the models linearised about them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from flexstage.analysis.loaded.strained import left_out, strain_warnings
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array
from flexstage.base.record import INNER
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.channels import wrench_places
from flexstage.models.linear.model import LinearModel
from flexstage.models.nonlinear.elements.strain import strains
from flexstage.models.nonlinear.equilibrium import State, equilibrium, require_equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.paths.critical_load import require_continuation, unstable_motions
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH, WRENCH_UNITS

_STILL = 1e-12
"""Motion that counts as zero [rad, or relative to the flexures' length]."""
_SHARES = np.linspace(0.0, 1.0, 17)[1:-1]
"""Shares of the requested displacement at which an equilibrium is sought if there is none at 1."""


class OperatingPoint(Result):
    """Operating point: `sag` is the static deflection under weight, loads and heat, `moved` the displacement from static equilibrium.

    `sag` and `moved` have a row for the platform and for each named point; the columns are displacement and rotation vector. `moved` is
    None if `at` is empty. `held` lists every displaced or fixed coordinate: its value relative to the static equilibrium, and the force
    that holds it. `rest` is the static equilibrium, `state` the displaced equilibrium, and `linear` the model linearised about `state`.
    """

    sag: Matrix
    moved: Matrix | None
    held: Matrix | None
    locked: tuple[str, ...]
    rest: Annotated[State, INNER]
    state: Annotated[State, INNER]
    linear: Annotated[LinearModel, INNER]
    doubts: Annotated[tuple[Finding, ...], INNER]
    provenance: str

    @cached_property
    def links(self) -> LinearModel:
        """Model linearised for lost motion: its flexures have no inner coordinates and follow their ends quasi-statically."""
        return linearise(self.state, locked=self.locked, inner=False)

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings of strains beyond the limits of the theory, and of drives without effect."""
        return (*self.doubts, *strain_warnings(strains(self.state)), *left_out(self.state))


@check_arguments
def operating_point(
    mechanism: Mechanism,
    at: Mapping[str, float] | None = None,
    *,
    loads: Mapping[str, float] | None = None,
    fixed: Sequence[str] = (),
    temperature: float = 0.0,
) -> OperatingPoint:
    """Compute the operating point of a stage at large displacements, and linearise about it.

    First, the static equilibrium is solved under weight, payloads, preloads, specified forces, `loads` (as in `equilibrium`) and
    `temperature` (a uniform change [K]). Then, forces of constant direction displace the coordinates in `at` from this equilibrium.
    Coordinates are for example `platform.y` [m] or `platform.rz` [rad] (a component of the rotation vector). `at` can also contain strokes,
    by stack name; the operating point is computed with these strokes. In the linear model, the coordinates displaced by `at` are free, and
    the displacing forces are constant. The coordinates named in `fixed` are fixed at their equilibrium value, or at the value in `at`.

    Raises `DesignError` for unknown names, contradictory conditions, and a missing equilibrium. The error for a missing equilibrium reports
    the largest fraction of the displacements for which an equilibrium was found. `DesignError` is also raised if the stage is unstable
    under the forces.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> result = operating_point(parallelogram(), {"platform.x": 1e-4})
    >>> round(float(result.moved.at("platform", "x")) * 1e6, 3), round(float(result.held.at("platform.x", "force")))
    (100.0, 1939)
    """
    requested = Conditions(nonlinear(mechanism, temperature=temperature), loads or {}, at or {}, tuple(dict.fromkeys(fixed)))
    require(_contradictions(requested))
    rest, state = requested.rest, requested.reach(1.0)
    if not bool(state.converged):
        raise refuse("--at", *_how_far(requested))
    _require_stable(requested, state)
    if requested.at:
        require_continuation(requested.reach(0.0), state)
    places = (PLATFORM, *(name for name in wrench_places(requested.model.assembly) if name not in requested.model.bodies))
    units = (TWIST_UNITS,) * len(places)
    sag = np.stack([rest.twist(name) for name in places])
    linear = linearise(state, locked=requested.fixed)
    return OperatingPoint(
        sag=Matrix(sag, places, COMPONENTS, units),
        moved=Matrix(np.stack([state.twist(name) for name in places]) - sag, places, COMPONENTS, units) if requested.at else None,
        held=_held(requested, state),
        locked=requested.fixed,
        rest=rest,
        state=state,
        linear=linear,
        doubts=tuple(_idle(requested, state)),
        provenance=linear.provenance,
    )


def require_consistent(model: Nonlinear, at: Mapping[str, float], loads: Mapping[str, float], hold: Sequence[str]) -> None:
    """Raise `DesignError` with all contradictions between displacements, loads and fixed coordinates.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> require_consistent(nonlinear(parallelogram()), {"platform.x": 1e-4}, {"platform.fy": 1.0}, [])
    """
    require(_contradictions(Conditions(model, loads, at, tuple(dict.fromkeys(hold)))))


@dataclass(frozen=True, eq=False)
class Conditions:
    """Definition of an operating point: constant `loads`, displacements and strokes `at`, `fixed` coordinates, and a fraction `weight`."""

    model: Nonlinear
    loads: Mapping[str, float]
    at: Mapping[str, float]
    fixed: tuple[str, ...] = ()
    weight: float = 1.0

    @cached_property
    def rest(self) -> State:
        """Static equilibrium under only the constant loads."""
        result = equilibrium(self.model, self.loads, weight=self.weight)
        require_equilibrium(result)
        return result

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the displaced coordinates, then of the other fixed coordinates."""
        return tuple(dict.fromkeys([*(name for name in self.at if name not in self.driven), *self.fixed]))

    @cached_property
    def driven(self) -> dict[str, float]:
        """Strokes and forces in `at`, by input name."""
        inputs = {channel.name for channel in self.model.inputs}
        return {name: value for name, value in self.at.items() if name in inputs}

    def held(self, share: float | Array) -> dict[str, Any]:
        """Return the values of displaced and fixed coordinates at a fraction of the displacement."""
        return {name: coordinate(self.rest, name) + share * self.at.get(name, 0.0) for name in self.coordinates}

    def reach(self, share: float | Array) -> State:
        """Return the equilibria at fractions of the displacement."""
        given = {name: self.loads.get(name, 0.0) + share * value for name, value in self.driven.items()}
        return equilibrium(self.model, {**self.loads, **given}, hold=self.held(share), weight=self.weight, start=self.rest)


def coordinate(state: State, name: str) -> Array:
    """Return the value (...) [m, rad] of a coordinate at a state; `name` is as in the `hold` of `equilibrium`.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> round(float(coordinate(equilibrium(nonlinear(parallelogram()), hold={"platform.x": 1e-4}), "platform.x")), 12)
    0.0001
    """
    owner, _, component = name.rpartition(".")
    if not owner or component not in COMPONENTS:
        raise refuse(name, "unknown coordinate", f"Use e.g. platform.{component if component in COMPONENTS else 'y'}")
    return state.twist(owner)[..., COMPONENTS.index(component)]


def _contradictions(requested: Conditions) -> Iterator[Finding]:
    for name in requested.driven:
        if name in requested.loads:
            yield Finding(name, "specified both as a constant load and as a drive", "Remove one of the two")
    for name in requested.coordinates:
        owner, _, component = name.rpartition(".")
        load = f"{owner}.{FORCES[COMPONENTS.index(component)]}" if component in COMPONENTS else ""
        if name in requested.at and (load in requested.loads or load in requested.at):
            what = f"the force along this coordinate is a result, but {load} specifies it"
            yield Finding(name, what, f"Remove {load}, or {name}")
    bodies = [
        requested.model.assembly.points[owner][0] if owner in requested.model.assembly.points else owner for owner in _owners(requested)
    ]
    for body in dict.fromkeys(bodies):
        if bodies.count(body) > 6:
            yield Finding(body, f"too many coordinates fixed (got {bodies.count(body)}, expected 6 at most)", "Fix fewer coordinates")


def _owners(requested: Conditions) -> list[str]:
    return [name.rpartition(".")[0] for name in requested.coordinates]


def _how_far(requested: Conditions) -> tuple[str, str]:
    """Message for a missing equilibrium, with the largest share of the displacement that has one."""
    tried = requested.reach(_SHARES)
    count = int(np.argmin(np.append(tried.converged, False)))
    if not count:
        return "no equilibrium found, not even at 1/16 of the displacement", "Check the fixed coordinates for a contradiction"
    share, most = _SHARES[count - 1], float(np.max(strains(tried).largest[count - 1], initial=0.0))
    units = [WRENCH.unit(name.rpartition(".")[2]) for name in requested.coordinates]
    force = ", ".join(f"{each:.4g} {unit}" for each, unit in zip(tried.reactions[count - 1], units, strict=True))
    reached = ", ".join(f"{name} = {share * value:.4g}" for name, value in requested.at.items())
    what = f"no equilibrium found; the last equilibrium is at {share:.0%} of the displacement ({reached})"
    return (
        f"{what}{f', held by a force of {force}' if force else ''}, with a largest strain of {most:.2%}",
        "Use a displacement below that value",
    )


def _require_stable(requested: Conditions, state: State) -> None:
    """Refuse an operating point that is unstable after release."""
    count = int(unstable_motions(state, locked=requested.fixed))
    if count > 0:
        most = float(np.max(strains(state).largest, initial=0.0))
        ways = f"{count} unstable mode{'s' if count > 1 else ''}"
        loose = [name for name in requested.coordinates if name not in requested.fixed]
        under = (
            "the released stage is unstable under the force that displaces it"
            if loose
            else "the stage is unstable under its weight, loads or strokes"
        )
        what = f"{under} ({ways}, largest strain {most:.2%}){_stable_until(requested)}"
        lock = f"Use --fixed {loose[0]}, or run" if loose else "Run"
        raise refuse(", ".join(loose) or PLATFORM, what, f"{lock} flexstage buckle to find the buckling mode")


def _stable_until(requested: Conditions) -> str:
    """Largest share, in sixteenths, of the displacements, or of the loads without displacements, at which the stage is stable."""
    rest = equilibrium(requested.model, {name: _SHARES * value for name, value in requested.loads.items()})
    states = requested.reach(_SHARES) if requested.at else rest
    stays = unstable_motions(states, locked=requested.fixed) == 0
    count = int(np.argmin(np.append(stays, False)))
    return f"; it is stable up to {_SHARES[count - 1]:.0%} of the {'displacements' if requested.at else 'loads'}" if count else ""


def _held(requested: Conditions, state: State) -> Matrix | None:
    if not requested.coordinates:
        return None
    places = [COMPONENTS.index(name.rpartition(".")[2]) for name in requested.coordinates]
    values = [requested.at.get(name, 0.0) for name in requested.coordinates]
    units = tuple((TWIST_UNITS[place], WRENCH_UNITS[place]) for place in places)
    return Matrix(np.stack([values, state.reactions], axis=-1), requested.coordinates, ("value", "force"), units)


def _idle(requested: Conditions, state: State) -> Iterator[Finding]:
    """Drives and loads without effect."""
    for name, value in {**requested.loads, **requested.driven}.items():
        if value == 0.0 and name not in requested.coordinates:
            yield Finding(name, "the value zero has no effect", "Use another value, or remove this entry")
    moved = np.abs(state.pose.position - requested.rest.pose.position) / requested.model.size
    turned = np.abs(state.pose.turn - requested.rest.pose.turn)
    if any(requested.driven.values()) and max(np.max(moved), np.max(turned)) < _STILL:
        yield Finding(", ".join(requested.driven), "no effect on the stage", "Check the links of this actuator")
