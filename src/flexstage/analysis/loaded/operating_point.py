"""Operating points: equilibria of a displaced, loaded, fixed or heated stage, and the models linearised about them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from flexstage.analysis.loaded.strained import left_out, strain_warnings
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW
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


@dataclass(frozen=True, eq=False)
class OperatingPoint(InNotebook):
    """Operating point: a stage under constant `loads`, with coordinates and strokes displaced by `at`, and coordinates `fixed`.

    `weight` is the applied fraction of gravity. `rest` is the static equilibrium under weight, loads and heat, and `state` the displaced
    equilibrium. `linear` is the model linearised about `state`. `sag` and `moved` have a row for the platform and for each named point; the
    columns are displacement and rotation vector.
    """

    model: Annotated[Nonlinear, INNER]
    loads: Annotated[Mapping[str, float], INNER] = field(default_factory=dict[str, float])
    at: Annotated[Mapping[str, float], INNER] = field(default_factory=dict[str, float])
    fixed: Annotated[tuple[str, ...], INNER] = ()
    weight: Annotated[float, INNER] = 1.0

    @cached_property
    def sag(self) -> Annotated[Matrix, VIEW]:
        """Static deflection under weight, loads and heat."""
        return self._twists(np.stack([self.rest.twist(name) for name in self._places]))

    @cached_property
    def moved(self) -> Annotated[Matrix | None, VIEW]:
        """Displacement from static equilibrium; None without displaced coordinates and strokes."""
        return self._twists(np.stack([self.state.twist(name) for name in self._places]) - self.sag.values) if self.at else None

    @cached_property
    def held(self) -> Annotated[Matrix | None, VIEW]:
        """Displaced and fixed coordinates: values relative to static equilibrium, and the forces that hold them."""
        if not self.coordinates:
            return None
        places = [COMPONENTS.index(name.rpartition(".")[2]) for name in self.coordinates]
        values = [self.at.get(name, 0.0) for name in self.coordinates]
        units = tuple((TWIST_UNITS[place], WRENCH_UNITS[place]) for place in places)
        return Matrix(np.stack([values, self.state.reactions], axis=-1), self.coordinates, ("value", "force"), units)

    @property
    def locked(self) -> Annotated[tuple[str, ...], VIEW]:
        """Fixed coordinates."""
        return self.fixed

    @property
    def provenance(self) -> Annotated[str, VIEW]:
        """Model and method."""
        return self.linear.provenance

    @cached_property
    def rest(self) -> State:
        """Static equilibrium under only the constant loads."""
        result = equilibrium(self.model, self.loads, weight=self.weight)
        require_equilibrium(result)
        return result

    @cached_property
    def state(self) -> State:
        """Equilibrium under the constant loads and the whole displacement."""
        return self.reach(1.0) if self.loads or self.at or self.fixed else self.rest

    @cached_property
    def linear(self) -> LinearModel:
        """Model linearised about the state; fixed coordinates are fixed, displaced coordinates are free under constant forces."""
        return linearise(self.state, locked=self.fixed)

    @cached_property
    def links(self) -> LinearModel:
        """Model linearised for lost motion: its flexures have no inner coordinates and follow their ends quasi-statically."""
        return linearise(self.state, locked=self.fixed, inner=False)

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings of strains beyond the limits of the theory, and of drives without effect."""
        return (*_idle(self), *strain_warnings(strains(self.state)), *left_out(self.state))

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the displaced coordinates, then of the other fixed coordinates."""
        return tuple(dict.fromkeys([*(name for name in self.at if name not in self.driven), *self.fixed]))

    @cached_property
    def driven(self) -> dict[str, float]:
        """Strokes and forces in `at`, by input name."""
        inputs = {channel.name for channel in self.model.inputs}
        return {name: value for name, value in self.at.items() if name in inputs}

    def targets(self, share: float | Array) -> dict[str, Any]:
        """Return the values of displaced and fixed coordinates at a fraction of the displacement."""
        return {name: coordinate(self.rest, name) + share * self.at.get(name, 0.0) for name in self.coordinates}

    def reach(self, share: float | Array) -> State:
        """Return the equilibria at fractions of the displacement."""
        given = {name: self.loads.get(name, 0.0) + share * value for name, value in self.driven.items()}
        return equilibrium(self.model, {**self.loads, **given}, hold=self.targets(share), weight=self.weight, start=self.rest)

    def contradictions(self) -> Iterator[Finding]:
        """Yield the contradictions between displacements, loads and fixed coordinates."""
        for name in self.driven:
            if name in self.loads:
                yield Finding(name, "specified both as a constant load and as a drive", "Remove one of the two")
        for name in self.coordinates:
            owner, _, component = name.rpartition(".")
            load = f"{owner}.{FORCES[COMPONENTS.index(component)]}" if component in COMPONENTS else ""
            if name in self.at and (load in self.loads or load in self.at):
                what = f"the force along this coordinate is a result, but {load} specifies it"
                yield Finding(name, what, f"Remove {load}, or {name}")
        points, owners = self.model.assembly.points, [name.rpartition(".")[0] for name in self.coordinates]
        for body, count in Counter(points[owner][0] if owner in points else owner for owner in owners).items():
            if count > 6:
                yield Finding(body, f"too many coordinates fixed (got {count}, expected 6 at most)", "Fix fewer coordinates")

    @property
    def _places(self) -> tuple[str, ...]:
        return (PLATFORM, *(name for name in wrench_places(self.model.assembly) if name not in self.model.bodies))

    def _twists(self, values: Array) -> Matrix:
        return Matrix(values, self._places, COMPONENTS, (TWIST_UNITS,) * len(values))


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
    result = OperatingPoint(nonlinear(mechanism, temperature=temperature), dict(loads or {}), dict(at or {}), tuple(dict.fromkeys(fixed)))
    require(result.contradictions())
    if not bool(result.state.converged):
        raise refuse("--at", *_how_far(result))
    _require_stable(result)
    if result.at:
        require_continuation(result.reach(0.0), result.state)
    _ = result.linear  # refuses stages that are too large
    return result


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


def _how_far(point: OperatingPoint) -> tuple[str, str]:
    """Message for a missing equilibrium, with the largest share of the displacement that has one."""
    tried = point.reach(_SHARES)
    count = int(np.argmin(np.append(tried.converged, False)))
    if not count:
        return "no equilibrium found, not even at 1/16 of the displacement", "Check the fixed coordinates for a contradiction"
    share, most = _SHARES[count - 1], float(np.max(strains(tried).largest[count - 1], initial=0.0))
    units = [WRENCH.unit(name.rpartition(".")[2]) for name in point.coordinates]
    force = ", ".join(f"{each:.4g} {unit}" for each, unit in zip(tried.reactions[count - 1], units, strict=True))
    reached = ", ".join(f"{name} = {share * value:.4g}" for name, value in point.at.items())
    what = f"no equilibrium found; the last equilibrium is at {share:.0%} of the displacement ({reached})"
    return (
        f"{what}{f', held by a force of {force}' if force else ''}, with a largest strain of {most:.2%}",
        "Use a displacement below that value",
    )


def _require_stable(point: OperatingPoint) -> None:
    """Refuse an operating point that is unstable after release."""
    count = int(unstable_motions(point.state, locked=point.fixed))
    if count > 0:
        most = float(np.max(strains(point.state).largest, initial=0.0))
        ways = f"{count} unstable mode{'s' if count > 1 else ''}"
        loose = [name for name in point.coordinates if name not in point.fixed]
        under = (
            "the released stage is unstable under the force that displaces it"
            if loose
            else "the stage is unstable under its weight, loads or strokes"
        )
        what = f"{under} ({ways}, largest strain {most:.2%}){_stable_until(point)}"
        lock = f"Use --fixed {loose[0]}, or run" if loose else "Run"
        raise refuse(", ".join(loose) or PLATFORM, what, f"{lock} flexstage buckle to find the buckling mode")


def _stable_until(point: OperatingPoint) -> str:
    """Largest share, in sixteenths, of the displacements, or of the loads without displacements, at which the stage is stable."""
    loads = {name: _SHARES * value for name, value in point.loads.items()}
    states = point.reach(_SHARES) if point.at else equilibrium(point.model, loads)
    stays = unstable_motions(states, locked=point.fixed) == 0
    count = int(np.argmin(np.append(stays, False)))
    return f"; it is stable up to {_SHARES[count - 1]:.0%} of the {'displacements' if point.at else 'loads'}" if count else ""


def _idle(point: OperatingPoint) -> Iterator[Finding]:
    """Drives and loads without effect."""
    for name, value in {**point.loads, **point.driven}.items():
        if value == 0.0 and name not in point.coordinates:
            yield Finding(name, "the value zero has no effect", "Use another value, or remove this entry")
    moved = np.abs(point.state.pose.position - point.rest.pose.position) / point.model.size
    turned = np.abs(point.state.pose.turn - point.rest.pose.turn)
    if any(point.driven.values()) and max(np.max(moved), np.max(turned)) < _STILL:
        yield Finding(", ".join(point.driven), "no effect on the stage", "Check the links of this actuator")
