"""Actuator loads: distribution of weight, payload and forces (also eccentric) over the stacks, and the stacks' load limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.workspace.stroke import StrokeLimits, stroke_actuators
from flexstage.base.finding import Finding, refuse
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, Vector, matvec, stack
from flexstage.base.record import Along, Graded, Heading, Layout, Mark
from flexstage.base.units.quantity import FORCE, SHARE, Bound
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Force, Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import displacement, static_gain
from flexstage.models.linear.undetermined import require_balanced, require_known
from flexstage.parts.part import push_of
from flexstage.spatial.frame import COMPONENTS, FORCES, WRENCH_UNITS, transport

OWN_WEIGHT = "own weight"
_ROUNDING = 1e-9
SAFETY = Graded(1.5, 1.0, Mark.PLAIN)
"""Grades of safety factors: failed below 1, warning below 1.5."""


class LoadRange(Result):
    """Least and largest compression [N] of each stack over the strokes, and the used fractions of maximum load and tension limit."""

    TABLE: ClassVar[Layout] = Layout(
        "Axial forces of the stacks over all strokes",
        "min_force max_force usage pull",
        notes=(
            "Strokes are from zero voltage. Forces include permanent load, but not the preload; the share used in compression includes it.",
            "The limit in tension is the sum of preload and tensile limit.",
        ),
    )

    actuators: tuple[str, ...]
    min_force: Annotated[Array, FORCE, Along("actuators"), Heading("smallest", digits=4)]
    max_force: Annotated[Array, FORCE, Along("actuators"), Heading("largest", digits=4)]
    usage: Annotated[Array, SHARE, Bound(high=1.0), Along("actuators"), Heading("used in compression")]
    pull: Annotated[Array, SHARE, Bound(high=1.0), Along("actuators"), Heading("used in tension")]


class LoadShare(Result):
    """Axial forces of the stacks under permanent load, positive in compression.

    `loads` (actuators x causes) [N] are the forces due to own weight, payloads and specified forces. `share` (actuators x wrench
    components) are the forces per unit wrench at the platform's reference point. `stroke` (actuators x strokes) [N/m] are the forces per
    unit stroke. `maximum`, `preload` and `tensile` (..., n) [N] are the stacks' limits (NaN: not specified). `reference` (..., 3) [m] is
    the platform's reference point.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Axial forces of the stacks", "loads preload tensile maximum", head="actuator", notes=("Compression is positive.",)
    )

    actuators: tuple[str, ...]
    loads: Annotated[Matrix, Heading(digits=4)]
    share: Matrix
    stroke: Matrix
    maximum: Annotated[Array, FORCE, Along("actuators"), Heading("limit")]
    preload: Annotated[Array, FORCE, Along("actuators")]
    tensile: Annotated[Array, FORCE, Along("actuators"), Heading("tensile limit")]
    reference: Array
    provenance: str

    @property
    def compression(self) -> Annotated[Array, FORCE, Along("actuators")]:
        """Compression (..., n) [N] under gravity and all forces at zero strokes, without preload."""
        return np.sum(self.loads.values, axis=-1)

    def under(self, force: Array, at: Array) -> Array:
        """Return the compression (..., n) [N] due to a force (..., 3) [N] on the platform at a point (..., 3) [m], in stage axes."""
        moment = np.cross(at - self.reference, force)
        wrench = np.concatenate(np.broadcast_arrays(force, moment), axis=-1)
        return matvec(self.share.values, wrench)

    def range(self, limits: StrokeLimits) -> tuple[Array, Array]:
        """Return the exact least and largest compression (..., n) [N] over the box of strokes under permanent load."""
        least, largest = limits.swing(self.stroke.values)
        return self.compression + least, self.compression + largest

    def usage(self, compression: Array) -> Array:
        """Return the ratio (..., n) of compression, including preload, to the maximum load; NaN if unspecified."""
        return (compression + np.nan_to_num(self.preload)) / self.maximum

    def pull(self, compression: Array) -> Array:
        """Return the ratio (..., n) of tension to the sum of preload and tensile limit; infinite if neither is specified.

        Above 1, the stack separates or breaks.
        """
        allowed = np.nan_to_num(self.preload) + np.nan_to_num(self.tensile)
        tension = np.maximum(0.0, -compression)
        safe = np.where(allowed > 0.0, allowed, 1.0)
        return np.where(tension <= 0.0, 0.0, np.where(allowed > 0.0, tension / safe, np.inf))

    def over(self, limits: StrokeLimits) -> LoadRange:
        """Return the load range of the stacks over the box of strokes under permanent load."""
        least, largest = self.range(limits)
        return LoadRange(self.actuators, least, largest, self.usage(largest), self.pull(least))

    def use(self, limits: StrokeLimits) -> Array:
        """Return the largest utilisation of each stack's load limits over the box of strokes (..., n), in compression or tension."""
        least, largest = self.range(limits)
        pressed, pulled = np.broadcast_arrays(self.usage(largest), self.pull(least))
        return np.where(np.real(pulled) > np.real(np.nan_to_num(pressed)), pulled, pressed)

    def tension_findings(self, limits: StrokeLimits) -> Iterator[Finding]:
        """Yield a warning for each stack whose tension exceeds preload plus tensile limit, or whose limits are not specified."""
        least, pull = self.range(limits)[0], self.pull(self.range(limits)[0])
        first, share = (np.real(each).reshape(-1, len(self.actuators))[0] for each in (least, pull))
        scale = np.max(np.abs(first), initial=0.0)
        for place, name in enumerate(self.actuators):
            if share[place] <= 1.0 or -first[place] <= _ROUNDING * scale:
                continue
            what = f"tension of {-first[place]:.4g} N in the stack at the worst corner of the stroke range"
            if np.isinf(share[place]):
                yield Finding(name, f"{what}, preload and tensile limit missing", 'Add e.g. preload = "200 N"')
            else:
                yield Finding(name, f"{what}, {share[place]:.3g} times the limit in tension", "Preload the stack, or limit the voltage")


def load_share(mechanism: Mechanism, model: LinearModel) -> LoadShare:
    """Compute the distribution of weight (bodies, links, payloads) and specified forces over the stacks, with strokes fixed.

    External forces are converted to generalised forces f on the coordinates of their bodies. The stack forces are C K^-1 f: K is the
    stiffness matrix, and C maps coordinates to stack forces. Displacements are small. All stacks are assumed to transmit tension, even
    stacks without preload and tensile limit; check `pull`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> stage = double_triangle()
    >>> shared = load_share(stage, lumped(stage))
    >>> round(float(shared.share.values[3:, 2].sum()), 1)  # levers 3 : 1, and lifting relieves
    -2.9
    """
    assembly = expand(mechanism)
    names = tuple(assembly.strokes)
    if not names:
        raise refuse("stacks", "the stage has no stacks", "Use the deflection under permanent load")
    axial = tuple(f"{link}.fx" for link in assembly.strokes.values())
    require_known(model, axial)
    causes = dead_loads(mechanism, model)
    motion = displacement(model, stack(list(causes.values())))
    loads = -model.seen(model.output_index(axial), motion)
    wrench = static_gain(model, axial, tuple(f"{PLATFORM}.{name}" for name in FORCES)).values
    parts = stroke_actuators(mechanism).values()
    return LoadShare(
        actuators=names,
        loads=Matrix(loads, names, tuple(causes), "N"),
        share=Matrix(-wrench, names, FORCES, ratio_units(("N",) * len(names), WRENCH_UNITS)),
        stroke=Matrix(-static_gain(model, axial, names).values, names, names, "N/m"),
        maximum=_stated([part.maximum_load for part in parts]),
        preload=_stated([part.preload for part in parts]),
        tensile=_stated([part.tensile_limit for part in parts]),
        reference=assembly.bodies[PLATFORM].reference,
        provenance=model.provenance,
    )


def dead_loads(mechanism: Mechanism, model: LinearModel) -> dict[str, Array]:
    """Compute generalised forces (..., n) by cause: own weight, each payload, each specified force, each spring preload.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> list(dead_loads(double_triangle(), lumped(double_triangle())))
    ['own weight']
    """
    require_balanced(model, "gravity", stack((*mechanism.gravity, 0.0, 0.0, 0.0)))
    carried = {
        name: applied_forces(mechanism, model, Force(load.body, load.at, _times(load.mass, mechanism.gravity)))
        for name, load in mechanism.payloads.items()
    }
    gravity, falling = stack(mechanism.gravity), model.base_inertia[..., :3]
    everything = falling @ gravity if gravity.ndim == 1 else matvec(falling, gravity)
    own = everything - sum(carried.values(), np.zeros(len(model.coordinates)))
    forces = {name: applied_forces(mechanism, model, force) for name, force in mechanism.forces.items()}
    return {OWN_WEIGHT: own, **{f"payload {name}": load for name, load in carried.items()}, **forces, **_preloads(mechanism, model)}


def _preloads(mechanism: Mechanism, model: LinearModel) -> dict[str, Array]:
    """Forces of links with preload on the bodies that they join."""
    return {
        f"preload of {name}": sum((applied_forces(mechanism, model, each) for each in pair), np.zeros(len(model.coordinates)))
        for name, pair in preload_pairs(expand(mechanism)).items()
    }


def preload_pairs(assembly: Assembly) -> dict[str, tuple[Force, Force]]:
    """Return a pair of preload forces for each link: the forces on its first and on its second body.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> preload_pairs(expand(double_triangle()))
    {}
    """
    result: dict[str, tuple[Force, Force]] = {}
    for name, link in assembly.links.items():
        push = push_of(link.part)
        if push is not None:
            at, along = (tuple(np.moveaxis(each, -1, 0)) for each in (link.frame.position, link.frame.rotation[..., :, 0]))
            first, second = (Force(body, at, _times(sign * push, along)) for body, sign in zip(link.joins, (-1.0, 1.0), strict=True))
            result[name] = first, second
    return result


def _times(factor: Number, direction: Vector) -> Vector:
    x, y, z = (factor * component for component in direction)
    return x, y, z


def applied_forces(mechanism: Mechanism, model: LinearModel, force: Force) -> Array:
    """Compute generalised forces (..., n) of a force on a body at a point, in the stage's frame; zero on the ground.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> stage = double_triangle()
    >>> applied_forces(stage, lumped(stage), Force("platform", (0.0, 0.0, 0.105), (0.0, 0.0, -10.0))).sum().round(6).item()
    -10.0
    """
    if force.body == GROUND:
        return np.zeros(len(model.coordinates))
    arm = stack(force.at) - expand(mechanism).bodies[force.body].reference
    push = stack((*force.force, 0.0, 0.0, 0.0))
    wrench = transport(arm).mT @ push[..., None]
    index = model.output_index(tuple(f"{force.body}.{name}" for name in COMPONENTS))
    require_balanced(model, f"a force on {force.body}", wrench[..., 0], index)
    rows = model.output[..., index, :]
    return (rows.mT @ wrench)[..., 0]


def _stated(values: list[Number | None]) -> Array:
    return stack([np.nan if value is None else value for value in values])
