"""Guides from a ground structure: wires and leaves between the faces of a block and the ground, chosen by stiffness.

Candidate elements are normal to five faces of the block, in a grid of three by three places on each face; the payload is on the sixth face.
Lines along the axes are sufficient: if the pure forces reciprocal to motions along and about axes span their space, the forces along axes
do so too. A candidate includes all its images under the symmetries of the specification (an orbit), so that a guide is as symmetric as its
specification.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.compliance import compliance
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import spatial_rotation, transport
from flexstage.studies.synthesis.constraint_space import reciprocal_space, twists_of

_RESISTS = 0.02
"""Fraction of an element's stiffness along the required motions, from which the element is regarded as resisting them."""
_ORBITS = 4
_BETTER = 1.5
"""Factor by which an additional orbit must increase the ratio of stiffnesses."""
_ASIDE = 0.05
"""Weight of actuator forces along other motions in the choice of actuator places."""
MIRRORS: tuple[Array, ...] = (np.diag([-1, 1, 1]), np.diag([1, -1, 1]))
"""Symmetries of every set of motions along and about axes, with a payload on top."""
QUARTER_TURN: Array = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])

_Grid = tuple[int, int, int]


@dataclass(frozen=True, order=True)
class Place:
    """A place on a face of the block, normal to the axis `face`. `grid` contains its side (-1, 1), and its column and row (-1, 0, 1)."""

    face: int
    grid: _Grid

    @property
    def side(self) -> int:
        """Sign of the outward normal along the axis."""
        return self.grid[self.face]


@dataclass(frozen=True, order=True)
class Element:
    """A wire or leaf, normal to the block at a place. `width` is the axis along the width of a leaf, -1 for a wire."""

    place: Place
    width: int = -1


@dataclass(frozen=True, eq=False)
class Block:
    """Half sizes of the block, pitch of its grid, length of elements by axis, thickness and width of leaves, diameter of wires [m]."""

    half: Array
    pitch: Array
    length: Array
    thickness: float
    width: float
    wire: float
    material: Material

    def point(self, place: Place) -> Array:
        """Return the position of a place on its face."""
        return np.where(np.arange(3) == place.face, self.half, self.pitch) * place.grid

    def stiffness(self, element: Element) -> Array:
        """Return the stiffness (6, 6) of an element against a motion of the block about its centre."""
        place = element.place
        inward, aside = -place.side * np.eye(3)[place.face], np.eye(3)[element.width if element.width >= 0 else place.face - 1]
        length = float(self.length[place.face])
        wire = Rod("", length=length, diameter=self.wire)
        part = wire if element.width < 0 else Leaf("", length=length, thickness=self.thickness, width=self.width)
        axes = np.column_stack([inward, np.cross(aside, inward), aside])
        to_centre = spatial_rotation(axes).T @ transport(self.point(place) - 0.5 * length * inward)
        return np.asarray(to_centre.T @ np.linalg.inv(compliance(part, self.material)) @ to_centre)

    def force(self, place: Place) -> Array:
        """Return the wrench (6,) of a unit force at a place, directed into the block."""
        inward = -place.side * np.eye(3)[place.face]
        return np.concatenate([inward, np.cross(self.point(place), inward)])

    @property
    def scale(self) -> Array:
        """Sizes (6,) of twists with similar displacements: translations of 1 m; rotations of 1 m divided by the block's mean half size."""
        return np.repeat([1.0, 1.0 / float(np.mean(self.half))], 3)


@dataclass(frozen=True)
class Guide:
    """A guide: its elements, and the `ratio` of its smallest stiffness along other motions to its largest stiffness along required motions.

    `conditioning` is the smallest singular value of the scaled forces of its `actuators` along the required motions.
    """

    elements: tuple[Element, ...]
    ratio: float
    actuators: tuple[Place, ...] = ()
    conditioning: float = 0.0


def stiffness_ratio(stiffness: Array, motions: frozenset[str], scale: Array) -> float:
    """Return the ratio of the smallest stiffness along other motions to the largest stiffness along the required motions.

    The stiffness along other motions is computed with the required motions free. `scale` (6,) makes translations and rotations comparable.

    >>> stiffness_ratio(np.diag([1.0, 50.0, 60.0, 70.0, 80.0, 90.0]), frozenset({"x"}), np.ones(6))
    50.0
    """
    stiffness = stiffness * np.outer(scale, scale)
    wanted = twists_of(motions)
    other = reciprocal_space(wanted)
    soft, mixed = wanted.T @ stiffness @ wanted, wanted.T @ stiffness @ other
    held = other.T @ stiffness @ other - mixed.T @ np.linalg.solve(soft, mixed)
    return float(np.linalg.eigvalsh(held)[0] / np.linalg.eigvalsh(soft)[-1])


def places(rows: Sequence[int]) -> Iterator[Place]:
    """Yield all places. On side faces, only the given `rows` along z are used."""
    steps = (-1, 0, 1)
    for face, grid in product(range(3), product(steps, steps, steps)):
        if grid[face] and (grid[2] in rows if face < 2 else grid[2] < 0):
            yield Place(face, grid)


def orbits(symmetries: Sequence[Array], rows: Sequence[int]) -> list[tuple[Element, ...]]:
    """Return the candidates. Each candidate is a tuple of one element and all its images under the symmetries.

    >>> len(orbits(MIRRORS, (0,))), len(orbits((*MIRRORS, QUARTER_TURN), (0,)))
    (24, 13)
    """
    found = dict[tuple[Element, ...], None]()
    for place, width in product(places(rows), range(-1, 3)):
        if width != place.face:
            orbit = {Element(place, width)}
            while (grown := orbit | {_image(each, one) for each in orbit for one in symmetries}) != orbit:
                orbit = grown
            found[tuple(sorted(orbit))] = None
    return list(found)


def _image(element: Element, symmetry: Array) -> Element:
    axis = [int(each) for each in np.argmax(np.abs(symmetry), axis=0)]
    x, y, z = (int(each) for each in symmetry @ element.place.grid)
    return Element(Place(axis[element.place.face], (x, y, z)), axis[element.width] if element.width >= 0 else -1)


def find_guide(block: Block, motions: frozenset[str], symmetries: Sequence[Array], rows: Sequence[int]) -> Guide | None:
    """Choose the guide with the largest ratio of stiffnesses, without actuators. Returns `None` if no candidate permits the motions.

    An orbit is an element with its images under the symmetries. Orbits are excluded if their stiffness along a required motion exceeds a
    small fraction of the sum of their stiffnesses along all axes.
    """
    scaled, wanted = np.outer(block.scale, block.scale), twists_of(motions)
    stiffness = dict[tuple[Element, ...], Array]()
    for orbit in orbits(symmetries, rows):
        whole = np.sum([block.stiffness(each) for each in orbit], axis=0)
        if np.linalg.eigvalsh(wanted.T @ (whole * scaled) @ wanted)[-1] < _RESISTS * np.trace(whole * scaled):
            stiffness[orbit] = whole
    options = list(stiffness)

    def merit(chosen: Sequence[int]) -> float:
        used = [each.place for index in chosen for each in options[index]]
        if len(set(used)) < len(used):
            return -1.0
        return stiffness_ratio(np.sum([stiffness[options[index]] for index in chosen], axis=0), motions, block.scale)

    best, ratio = (), 0.0
    for count in range(1, min(_ORBITS, len(options)) + 1):
        chosen = exchange(len(options), count, merit)
        if (value := merit(chosen)) > _BETTER * ratio:
            best, ratio = chosen, value
    return Guide(tuple(each for index in sorted(best) for each in options[index]), ratio) if best else None


def with_actuators(guide: Guide, block: Block, motions: frozenset[str], room: Sequence[Place]) -> Guide:
    """Place an actuator for each motion at places without elements, so that the map from actuators to motions is well conditioned.

    The merit is the smallest singular value of the forces along the required motions, minus a small fraction of the norm of the forces
    along other motions.
    """
    used = {each.place for each in guide.elements}
    free = [each for each in room if each not in used]
    if len(free) < len(motions):
        return guide
    forces, wanted = np.array([block.force(each) * block.scale for each in free]), twists_of(motions)
    along, aside = forces @ wanted, forces @ reciprocal_space(wanted)

    def merit(chosen: Sequence[int]) -> float:
        return _conditioning(along[list(chosen)]) - _ASIDE * float(np.linalg.norm(aside[list(chosen)]))

    chosen = sorted(exchange(len(free), len(motions), merit))
    return replace(guide, actuators=tuple(free[index] for index in chosen), conditioning=_conditioning(along[chosen]))


def _conditioning(forces: Array) -> float:
    return float(np.linalg.svd(forces, compute_uv=False)[-1])


def exchange(options: int, count: int, merit: Callable[[Sequence[int]], float]) -> tuple[int, ...]:
    """Choose `count` of several options. The options are added one by one, then exchanged one by one as long as the `merit` increases.

    >>> exchange(5, 2, lambda chosen: sum(chosen))
    (4, 3)
    """
    chosen = tuple[int, ...]()
    for _ in range(min(count, options)):
        chosen = (*chosen, max((each for each in range(options) if each not in chosen), key=lambda each: merit((*chosen, each))))
    value = -np.inf
    while (now := merit(chosen)) > value:
        value = now
        for place in range(len(chosen)):
            others = chosen[:place] + chosen[place + 1 :]
            found = max((each for each in range(options) if each not in others), key=lambda each: merit((*others, each)))
            if merit((*others, found)) > value * (1.0 + 1e-9) + 1e-12:
                chosen = (*others, found)
                break
    return chosen
