"""What a lumped stage is made of, in few numbers: laws of its distinct parts, places of its links, inertias of its bodies.

The same numbers as `models.lumped` takes from a description, but before they are put into matrices: twenty-seven links of a stage may
share six parts. Numbers without batch axes hold for every design.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.digest import Description
from flexstage.beams.mass import law_and_mass
from flexstage.mechanism.assembly.expand import Assembly, PlacedBody, PlacedLink, lay_out
from flexstage.mechanism.assembly.incidence import layout
from flexstage.mechanism.assembly.moving_mass import moving_inertia
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.parts.material import Material
from flexstage.parts.part import Part
from flexstage.spatial.frame import cross_matrix, spatial_rotation
from flexstage.spatial.rotation import cross

_BLOCK = 512
"""Designs whose parts are integrated at once."""

NOUGHT = 1e-12
"""What a feature changes by, over its largest number, that counts as rounding."""

PORTION = 32
"""Designs whose numbers stand beside each other, as in kernel.c."""

Some = slice | Sequence[int] | Array
"""Which rows, or which designs."""

GROUNDED = -1
"""The ground among the numbers of bodies."""

SHAPES: Mapping[str, tuple[int, ...]] = {
    "stiffness": (6, 6),
    "mass": (12, 12),
    "turn": (3, 3),
    "first": (3,),
    "second": (3,),
    "inertia": (10,),
}
"""Kinds of features: law and mass of a part in its link's frame; a link's axes in the stage and the arms from it to points of its two
bodies; mass, moments of mass and moments of inertia (xx, yx, yy, zx, zy, zz) of a body with its payloads about that point. No point moves
in its body: it is where the reference point of a nominal design is."""

TURNS = ("first turn", "second turn")
"""How a link's axes turn [rad, in the stage's axes] as its first body and its second see it: derivatives alone, as they have no numbers."""

INERTIA_ENTRIES = np.array([0, 1, 2, 0, 3, 4, 4, 5, 5, 5]), np.array([0, 5, 3, 4, 3, 3, 4, 3, 4, 5])
"""Where the numbers of an inertia stand in its 6x6 matrix."""


@dataclass(frozen=True)
class Feature:
    """One array of numbers: its kind, the part, link or body it is of, and where it starts among all numbers."""

    kind: str
    owner: int
    start: int

    @property
    def key(self) -> tuple[str, int]:
        """Kind and owner."""
        return self.kind, self.owner

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array."""
        return (3,) if self.kind in TURNS else SHAPES[self.kind]

    @property
    def symmetric(self) -> bool:
        """Whether it is a symmetric matrix."""
        return self.kind in {"stiffness", "mass"}

    @property
    def slots(self) -> slice:
        """Where its numbers stand among all."""
        return slice(self.start, self.start + int(np.prod(self.shape)))


@dataclass(frozen=True)
class Topology:
    """Who is joined to whom: `links` are (part, first body, second body), bodies by number, the platform first.

    `locked` says that some link locks freedoms, leaves some without stiffness or has inner coordinates: then the coordinates are not six
    free ones a body.
    """

    bodies: tuple[str, ...]
    links: tuple[tuple[int, int, int], ...]
    parts: int
    locked: bool

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 6 * len(self.bodies)

    @property
    def features(self) -> tuple[Feature, ...]:
        """Every feature, in the order of their numbers."""
        owners = {"stiffness": self.parts, "mass": self.parts, "turn": len(self.links), "first": len(self.links)}
        owners |= {"second": len(self.links), "inertia": len(self.bodies)}
        result: list[Feature] = []
        start = 0
        for kind, count in owners.items():
            for owner in range(count):
                result.append(Feature(kind, owner, start))
                start += int(np.prod(SHAPES[kind]))
        return tuple(result)

    @property
    def changing(self) -> tuple[Feature, ...]:
        """What derivatives are of: every feature but axes, and how axes turn. These stand behind all numbers."""
        places = ((kind, link, self.count + 6 * link + 3 * side) for link in range(len(self.links)) for side, kind in enumerate(TURNS))
        return (*(place for place in self.features if place.kind != "turn"), *itertools.starmap(Feature, places))

    @property
    def count(self) -> int:
        """How many numbers all features hold."""
        return self.features[-1].slots.stop

    @property
    def mirror(self) -> Array:
        """Of each number the one that is the same, as matrices are symmetric; or itself.

        >>> Topology(("platform",), ((0, -1, 0),), 1, locked=False).mirror[[0, 1, 6]].tolist()
        [0, 6, 1]
        """
        places = [(place, np.arange(place.slots.start, place.slots.stop).reshape(place.shape)) for place in self.features]
        return np.concatenate([(own.T if place.symmetric else own).ravel() for place, own in places])


def topology(assembly: Assembly) -> Topology:
    """The topology of an expanded stage; links of one part and material share its number.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = topology(lay_out(double_triangle()))
    >>> found.size, len(found.links), found.parts
    (114, 27, 6)
    """
    bodies = layout(assembly).bodies
    numbers = {name: number for number, name in enumerate(bodies)} | {GROUND: GROUNDED}
    parts = _distinct(assembly)
    links = tuple((_number(parts, link), numbers[link.joins[0]], numbers[link.joins[1]]) for link in assembly.links.values())
    laws = [law_and_mass(link.part, link.material)[0] for link in parts.values()]
    loose = any(bool(item.locked) or item.inner is not None or not np.all(np.any(np.real(item.stiffness) != 0.0, axis=-1)) for item in laws)
    return Topology(bodies, links, len(parts), loose or bool(assembly.superelements))


def _distinct(assembly: Assembly) -> dict[tuple[int, int], PlacedLink]:
    found: dict[tuple[int, int], PlacedLink] = {}
    for link in assembly.links.values():
        found.setdefault(_key(link), link)
    return found


def _key(link: PlacedLink) -> tuple[int, int]:
    return id(link.part), id(link.material)


def distinct_links(assembly: Assembly) -> tuple[PlacedLink, ...]:
    """A link of each distinct part and material, by the part's number.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(distinct_links(lay_out(double_triangle())))
    6
    """
    return tuple(_distinct(assembly).values())


def _number(parts: Mapping[tuple[int, int], PlacedLink], link: PlacedLink) -> int:
    return list(parts).index(_key(link))


Wanted = Callable[[str, int], bool]
"""Whether a feature (kind, owner) is asked for."""


def everything(kind: str, owner: int) -> bool:
    """Ask for every feature.

    >>> everything("mass", 0)
    True
    """
    return bool(kind) and owner >= 0


@dataclass(frozen=True, eq=False)
class Standpoint:
    """How bodies are seen: eigenvalues and their derivatives do not depend on it, but what changes with a number does.

    Each body at one of `points` (3,), by name, in the frame it is drawn in; where it has none, at its reference point. With `turning`
    derivatives are about axes that turn as these frames do, else about those of the stage: what turns as a whole does not change.
    """

    points: Mapping[str, Array]
    turning: bool = True


def standpoint(assembly: Assembly) -> Standpoint:
    """That of all bodies that do not state a reference point, where it is.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> float(standpoint(lay_out(double_triangle())).points["platform"][2].round(4))  # the height of its centre of mass
    0.105
    """
    free = {name: body for name, body in assembly.bodies.items() if body.body.reference is None}
    return Standpoint({name: body.frame.rotation.T @ (body.reference - body.frame.position) for name, body in free.items()})


def features(mechanism: Mechanism, seen: Standpoint, wanted: Wanted = everything) -> dict[tuple[str, int], Array]:
    """The features (..., *shape) of a description by (kind, owner); numbers may have batch axes and be complex.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> float(features(stage, standpoint(lay_out(stage)))["inertia", 0][0].round(3))  # the platform's mass
    13.997
    """
    return {key: array for _, found in stepped_features([mechanism], seen, [wanted]) for key, array in found.items()}


def stepped_features(
    mechanisms: Sequence[Mechanism], seen: Standpoint, wanted: Sequence[Wanted]
) -> Iterator[tuple[int, dict[tuple[str, int], Array]]]:
    """Features of one description with several steps in its numbers, some at a time, with the place of the description they are of.

    Each part is integrated once for all of them. What is used at once is still in the processor's cache.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> seen = standpoint(lay_out(stage))
    >>> [len(found) for _, found in stepped_features([stage], seen, [lambda kind, owner: kind == "mass" and owner == 0])]
    [1, 1, 27]
    """
    assemblies = [lay_out(mechanism) for mechanism in mechanisms]
    for number, links in enumerate(zip(*map(distinct_links, assemblies), strict=True)):
        own = [place for place, asked in enumerate(wanted) if asked("stiffness", number) or asked("mass", number)]
        for kind, arrays in _in_blocks([(links[place].part, links[place].material) for place in own]).items():
            yield from ((place, {(kind, number): array}) for place, array in zip(own, arrays, strict=True))
    for place, (mechanism, assembly, asked) in enumerate(zip(mechanisms, assemblies, wanted, strict=True)):
        yield place, _of_places(mechanism, assembly, seen, asked)


def _of_places(mechanism: Mechanism, assembly: Assembly, seen: Standpoint, asked: Wanted) -> dict[tuple[str, int], Array]:
    """Axes of all links; arms, turns and inertias that are asked for."""
    result: dict[tuple[str, int], Array] = {}
    bodies = {name: _at_point(body, seen.points.get(name)) for name, body in assembly.bodies.items()}
    spins = {name: _spin(body.frame.rotation) for name, body in bodies.items()} if seen.turning else {}
    for number, link in enumerate(assembly.links.values()):
        axes = result["turn", number] = link.frame.rotation
        own = _spin(axes)
        for kind, turn, body in zip(("first", "second"), TURNS, link.joins, strict=True):
            turning = spins.get(body)
            if asked(kind, number):
                arm = np.zeros(3) if body == GROUND else bodies[body].reference - link.frame.position
                result[kind, number] = (
                    arm if turning is None else _without(arm, cross(turning, np.real(arm)), _length(turning) * _length(arm))
                )
            if asked(turn, number) and own is not None and body != GROUND:
                result[turn, number] = 1j * own if turning is None else _without(1j * own, turning, _length(own))
    for number, body in enumerate(layout(assembly).bodies):
        if asked("inertia", number):
            inertia = moving_inertia(mechanism, bodies[body])
            result["inertia", number] = np.zeros(10) if inertia is None else _upright(inertia, spins.get(body))[..., *INERTIA_ENTRIES]
    return result


def _at_point(body: PlacedBody, point: Array | None) -> PlacedBody:
    """A body whose reference is that point of it."""
    return body if point is None else replace(body, body=replace(body.body, reference=tuple(point)))


def spin(rates: Array, axes: Array) -> Array:
    """The vector w (..., 3) by which axes R (..., 3, 3) turn as they change by dR, `rates`: [w]x = dR R^T.

    >>> spin(cross_matrix(np.array([1.0, 2.0, 3.0])), np.eye(3)).tolist()
    [1.0, 2.0, 3.0]
    """
    turned = rates @ np.swapaxes(axes, -1, -2)
    return np.stack([turned[..., 2, 1], turned[..., 0, 2], turned[..., 1, 0]], axis=-1)


def _spin(axes: Array) -> Array | None:
    """By which stepped axes turn; none where they have no step."""
    return spin(np.imag(axes), np.real(axes)) if np.iscomplexobj(axes) else None


def _upright(inertia: Array, turning: Array | None) -> Array:
    """A stepped inertia (..., 6, 6) in axes that turn."""
    if turning is None:
        return inertia
    turned = spatial_rotation(cross_matrix(turning)) @ np.real(inertia)
    root = np.sqrt(np.real(np.diagonal(inertia, axis1=-2, axis2=-1)))
    return _without(inertia, turned + np.swapaxes(turned, -1, -2), _length(turning)[..., None] * root[..., :, None] * root[..., None, :])


def _length(vector: Array) -> Array:
    return np.linalg.norm(np.real(vector), axis=-1, keepdims=True)


def _without(stepped: Array, turned: Array, scale: Array) -> Array:
    """A stepped feature without what turning as a whole makes of it; what is left of its step is nought where it is rounding."""
    left = np.imag(stepped) - turned
    return np.real(stepped) + 1j * np.where(np.abs(left) <= NOUGHT * scale, 0.0, left)


def _in_blocks(parts: list[tuple[Part, Material | None]]) -> dict[str, list[Array]]:
    """Stiffness and mass of a part with each of several steps, some designs after the others: more stations do not fit into the cache."""
    if not parts:
        return {}
    both = _together(parts)
    count = max((array.shape[-1] for array in _arrays(both)), default=1)
    blocks = [slice(start, start + _BLOCK) for start in range(0, count, _BLOCK)] if count > _BLOCK else [slice(None)]
    laws, masses = zip(*(law_and_mass(*_taken(both, block)) for block in blocks), strict=True)
    whole = {"stiffness": _joined([law.stiffness for law in laws]), "mass": _joined(masses)}
    return {kind: list(array) if array.ndim == 4 else [array] * len(parts) for kind, array in whole.items()}


def _together(values: Sequence[Any]) -> Any:
    """Descriptions that differ in steps as one, with a first axis in numbers that do."""
    first = values[0]
    if all(value is first for value in values):
        return first
    if isinstance(first, tuple):
        return tuple(map(_together, zip(*values, strict=True)))
    if isinstance(first, Description):
        own = {field.name: _together([getattr(value, field.name) for value in values]) for field in fields(first)}  # type: ignore[arg-type]
        return replace(first, **own)  # type: ignore[type-var]
    return np.stack(np.broadcast_arrays(*values)) if any(map(np.iscomplexobj, values)) else first


def _joined(arrays: Sequence[Array]) -> Array:
    return np.concatenate(arrays, axis=-3) if len(arrays) > 1 and arrays[0].ndim > 2 else arrays[0]


def _arrays(value: Any) -> Iterator[Array]:
    """Numbers of a description that differ between designs."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, (Description, tuple)):
        own = value if isinstance(value, tuple) else [getattr(value, field.name) for field in fields(value)]  # type: ignore[arg-type]
        for each in own:
            yield from _arrays(each)


def _taken(value: Any, designs: slice) -> Any:
    """Some designs of a description."""
    if isinstance(value, np.ndarray):
        return value[..., designs]
    if isinstance(value, tuple):
        return tuple(_taken(each, designs) for each in value)
    if isinstance(value, Description) and any(True for _ in _arrays(value)):
        return replace(value, **{field.name: _taken(getattr(value, field.name), designs) for field in fields(value)})  # type: ignore[type-var]
    return value


class Rows:
    """Numbers of many designs by rows, read and written like an array (rows, designs).

    Those of `PORTION` designs stand beside each other in `held` (portions, rows, PORTION): what a few designs need lies on few pages of
    memory, not on one for each row. Beyond the last design it is not told what stands there.

    >>> found = Rows(3, 200)
    >>> found[:] = np.arange(600.0).reshape(3, 200)
    >>> found[1:, 150:152].tolist(), found[:, [0]].T.tolist(), found.shape
    ([[350.0, 351.0], [550.0, 551.0]], [[0.0, 200.0, 400.0]], (3, 200))
    """

    def __init__(self, rows: int, designs: int) -> None:
        """Empty ones. They begin on lines of the cache."""
        portions = -(-designs // PORTION)
        room = np.empty(portions * rows * PORTION + 7)
        first = -(room.ctypes.data // 8) % 8
        self.held: Array = room[first:][: portions * rows * PORTION].reshape(portions, rows, PORTION)
        self.shape = (rows, designs)

    def __len__(self) -> int:
        """How many rows there are."""
        return self.shape[0]

    def __array__(self, dtype: np.dtype | None = None, *, copy: bool | None = None) -> Array:
        """All as an array (rows, designs)."""
        return np.asarray(self[:], dtype)

    def __getitem__(self, key: Some | tuple[Some, Some]) -> Array:
        """Some rows of all designs, or of some."""
        rows, designs = key if isinstance(key, tuple) else (key, None)
        own = self.held[:, rows]
        if designs is None:
            return own.swapaxes(0, 1).reshape(own.shape[1], len(own) * PORTION)[:, : self.shape[1]]
        portion, place = np.divmod(np.arange(self.shape[1])[designs], PORTION)
        return own[portion, :, place].T

    def __setitem__(self, key: Some | tuple[Some, Some], values: Array) -> None:
        """Write some rows of all designs, or of some."""
        rows, designs = key if isinstance(key, tuple) else (key, slice(None))
        chosen = np.arange(self.shape[1])[designs]
        values = np.broadcast_to(values, (len(values), len(chosen)))
        if isinstance(designs, slice) and designs.step in {None, 1} and len(chosen) and not chosen[0] % PORTION:
            first, last = chosen[0] // PORTION, (chosen[-1] + 1) // PORTION
            whole = (last - first) * PORTION
            self.held[first:last, rows] = values[:, :whole].reshape(len(values), last - first, PORTION).swapaxes(0, 1)
            chosen, values = chosen[whole:], values[:, whole:]
        if len(chosen):
            portion, place = np.divmod(chosen, PORTION)
            self.held[portion[:, None], np.arange(self.shape[0])[rows], place[:, None]] = values.T


def pack(found: Mapping[tuple[str, int], Array], places: tuple[Feature, ...], count: int) -> Rows:
    """All numbers of `count` designs.

    >>> place = Feature("first", 0, 0)
    >>> pack({("first", 0): np.arange(3.0)}, (place,), 2)[:].tolist()
    [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]
    """
    result = Rows(places[-1].slots.stop, count)
    for place in places:
        put(result, place, found[place.key])
    return result


def put(numbers: Array | Rows, place: Feature, array: Array) -> Array:
    """Write the real numbers (..., *shape) of a feature among all (numbers, designs), and tell which are the same in all designs.

    >>> numbers = np.zeros((3, 2))
    >>> put(numbers, Feature("first", 0, 0), np.array([[0.0, 1.0, 2.0], [0.0, 1.0, 3.0]])).tolist(), numbers.tolist()
    ([True, True, False], [[0.0, 0.0], [1.0, 1.0], [2.0, 3.0]])
    """
    values = np.real(array)
    flat = values.reshape(-1, int(np.prod(place.shape)))
    numbers[place.slots] = flat.T
    return np.asarray((flat == flat[:1]).all(axis=0))
