"""Kinematics of the graph: relative twists at links and at points as linear functions of the bodies' twists."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import cast

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array, Table
from flexstage.base.processes.memory import require_memory
from flexstage.base.sparse import Sparse
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink
from flexstage.mechanism.mechanism import GROUND, PLATFORM
from flexstage.spatial.frame import COMPONENTS, Frame, transport, twist_transform

LARGE = 60
"""Smallest number of bodies for which a single design uses sparse matrices."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Layout of the coordinate vector: six coordinates per body, the platform first; then the internal coordinates of links.

    `inner` is the number of internal coordinates of each link: amplitudes of its fixed-interface modes, which are zero in a rigid motion.
    In a `sparse` layout, matrices with the coordinates as columns have the type `flexstage.base.sparse.Sparse`.
    """

    bodies: tuple[str, ...]
    inner: Mapping[str, int] = field(default_factory=lambda: Table({}))
    sparse: bool = False

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 6 * len(self.bodies) + sum(self.inner.values())

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates: of bodies, such as `platform.x` and `B6/pole.rz`, then of modes, such as `B1/leaf.mode1`."""
        twists = (f"{body}.{component}" for body in self.bodies for component in COMPONENTS)
        return (*twists, *(f"{link}.mode{number + 1}" for link, count in self.inner.items() for number in range(count)))

    def columns(self, body: str) -> slice:
        """Return the slice of a body's six coordinates."""
        start = self._starts[body]
        return slice(start, start + 6)

    @cached_property
    def _starts(self) -> Mapping[str, int]:
        """First coordinate of every body."""
        return {body: 6 * number for number, body in enumerate(self.bodies)}

    @cached_property
    def inner_starts(self) -> Mapping[str, int]:
        """Index of the first internal coordinate, for every link with internal coordinates."""
        ends = np.cumsum(list(self.inner.values()), dtype=int).tolist()
        return {name: 6 * len(self.bodies) + end - self.inner[name] for name, end in zip(self.inner, ends, strict=True)}

    def embed(self, first: int, block: Array) -> Array:
        """Return a matrix (..., r, n) that contains a block (..., r, c) from column `first`, and is zero elsewhere."""
        if self.sparse:
            return cast("Array", Sparse(np.arange(first, first + block.shape[-1]), block, self.size))
        result = np.zeros((*block.shape[:-1], self.size), dtype=block.dtype)
        result[..., first : first + block.shape[-1]] = block
        return result

    def selector(self, body: str) -> Array:
        """Return the selection matrix (6, n) of a body's twist at its reference point, in the stage's axes."""
        return self.embed(self._starts[body], np.eye(6))

    def inner_selector(self, link: str) -> Array:
        """Return the selection matrix (m, n) of a link's m internal coordinates; m may be 0."""
        return self.embed(self.inner_starts.get(link, 0), np.eye(self.inner.get(link, 0)))


def layout(assembly: Assembly, inner: Mapping[str, int] | None = None, *, sparse: bool = False) -> Layout:
    """Return the coordinate layout of an expanded stage, dense or `sparse`. `inner` is the number of internal coordinates by link.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> layout(expand(double_triangle())).coordinates[:2]
    ('platform.x', 'platform.y')
    """
    return Layout(tuple(sorted(assembly.bodies, key=lambda name: name != PLATFORM)), Table(inner or {}), sparse)


def is_single(assembly: Assembly) -> bool:
    """Return whether a stage is a single design, without batch axes and complex steps.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> is_single(expand(double_triangle()))
    True
    """
    places = [(link.frame.rotation, link.frame.position) for link in assembly.links.values()]
    places += [(body.frame.rotation, body.reference) for body in assembly.bodies.values()]
    return all(turn.ndim == 2 and at.ndim == 1 and not np.iscomplexobj(turn) and not np.iscomplexobj(at) for turn, at in places)


def require_room(assembly: Assembly, matrices: float) -> None:
    """Raise `DesignError` for a stage whose dense matrices exceed the available memory.

    `matrices` is the number of dense matrices. A matrix has 6 columns per body, 6 rows per body or link (the larger number), and 8 bytes
    per entry.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> require_room(expand(double_triangle()), matrices=20.0)
    """
    bodies, links = len(assembly.bodies), len(assembly.links)
    needed = 8.0 * matrices * 36.0 * bodies * max(bodies, links)

    def fits(there: float) -> str:
        most = int(np.sqrt(there / needed) * bodies)
        return f"Join bodies without relative motion, or analyse parts of the stage: about {most:,} bodies with as many links per body fit"

    require_memory("stage", f"matrices of {bodies:,} bodies and {links:,} links", needed, fits)


def twist_at(assembly: Assembly, order: Layout, body: str, frame: Frame) -> Array:
    """Compute the matrix (..., 6, n) that gives a body's twist at a frame's origin, in the frame's axes; zero for the ground.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> assembly = expand(double_triangle())
    >>> twist_at(assembly, layout(assembly), "platform", assembly.links["B4/upper"].frame).shape
    (6, 114)
    """
    if body == GROUND:
        return order.embed(0, np.zeros((6, 0)))
    return order.embed(order.columns(body).start, twist_transform(frame, assembly.bodies[body].reference))


def end_twists(assembly: Assembly, order: Layout, link: PlacedLink) -> tuple[Array, Array]:
    """Compute the matrices (..., 6, n) that give the twists of a link's first and second body, at the link's centre in the link's frame.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> assembly = expand(double_triangle())
    >>> len(end_twists(assembly, layout(assembly), assembly.links["B1/front"]))
    2
    """
    first, second = link.joins
    return twist_at(assembly, order, first, link.frame), twist_at(assembly, order, second, link.frame)


def deformation(assembly: Assembly, order: Layout, link: PlacedLink) -> Array:
    """Compute the matrix (..., 6, n) that gives a link's relative twist, second minus first body, at the link's centre in the link's frame.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> assembly = expand(double_triangle())
    >>> deformation(assembly, layout(assembly), assembly.links["B1/front"]).shape
    (6, 114)
    """
    first, second = end_twists(assembly, order, link)
    return second - first


def free_deformations(assembly: Assembly) -> Array:
    """Compute the free deformations (..., 6 L, n) of all L links for n unit strokes, in the links' frames.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> free_deformations(expand(double_triangle())).sum(axis=0).tolist()
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    """
    places = {name: number for number, name in enumerate(assembly.links)}
    columns = []
    for name, link in assembly.strokes.items():
        own = assembly.actuator(name).free_deformation
        column = np.zeros((*own.shape[:-1], 6 * len(places)), dtype=own.dtype)
        column[..., 6 * places[link] : 6 * places[link] + 6] = own
        columns.append(column)
    return np.stack(np.broadcast_arrays(*columns), axis=-1) if columns else np.zeros((6 * len(places), 0))


def with_ground(assembly: Assembly, order: Layout) -> Array:
    """Compute the motion (..., n, 6) of all coordinates if the ground moves rigidly, for a unit twist at the platform's reference point.

    The rows of internal coordinates are zero. Raises `DesignError` if there is no platform.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> assembly = expand(double_triangle())
    >>> with_ground(assembly, layout(assembly))[:6].tolist() == np.eye(6).tolist()  # the platform itself
    True
    """
    if PLATFORM not in assembly.bodies:
        raise refuse("bodies", f'unknown body "{PLATFORM}"', f"Declare the moving platform under bodies.{PLATFORM}")
    centre = assembly.bodies[PLATFORM].reference
    carries = [transport(assembly.bodies[body].reference - centre) for body in order.bodies]
    batch = np.broadcast_shapes(*(carry.shape[:-2] for carry in carries))
    moving = [np.broadcast_to(carry, (*batch, 6, 6)) for carry in carries]
    return np.concatenate([*moving, np.zeros((*batch, order.size - 6 * len(order.bodies), 6))], axis=-2)
