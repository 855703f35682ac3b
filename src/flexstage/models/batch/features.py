"""What a lumped stage is made of, in few numbers: laws of its distinct parts, places of its links, inertias of its bodies.

The same numbers as `models.lumped` takes from a description, but before they are put into matrices: twenty-seven links of a stage may
share six parts. Numbers without batch axes hold for every design.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from flexstage.base.digest import Description
from flexstage.base.number import Array
from flexstage.beams.mass import law_and_mass
from flexstage.mechanism.expand import Assembly, PlacedLink, lay_out
from flexstage.mechanism.incidence import layout
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.mechanism.moving_mass import moving_inertia
from flexstage.parts.material import Material
from flexstage.parts.part import Part

_BLOCK = 128
"""Designs whose parts are integrated at once."""

GROUNDED = -1
"""The ground among the numbers of bodies."""

SHAPES: Mapping[str, tuple[int, ...]] = {
    "stiffness": (6, 6),
    "mass": (12, 12),
    "turn": (3, 3),
    "first": (3,),
    "second": (3,),
    "inertia": (6, 6),
}
"""Kinds of features: law and mass of a part in its link's frame; a link's axes in the stage and the arms from it to the reference points of
its two bodies; inertia of a body with its payloads at its reference point."""


@dataclass(frozen=True)
class Feature:
    """One array of numbers: its kind, the part, link or body it is of, and where it starts among all numbers."""

    kind: str
    owner: int
    start: int

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array."""
        return SHAPES[self.kind]

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
    def count(self) -> int:
        """How many numbers all features hold."""
        return self.features[-1].slots.stop


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


def features(mechanism: Mechanism, wanted: Wanted = everything) -> dict[tuple[str, int], Array]:
    """The features (..., *shape) of a description by (kind, owner); numbers may have batch axes and be complex.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> features(double_triangle())["inertia", 0].diagonal()[:3].round(3).tolist()  # the platform's mass
    [13.997, 13.997, 13.997]
    """
    assembly = lay_out(mechanism)
    result: dict[tuple[str, int], Array] = {}
    for number, link in enumerate(distinct_links(assembly)):
        if wanted("stiffness", number) or wanted("mass", number):
            result["stiffness", number], result["mass", number] = _in_blocks(link.part, link.material)
    for number, link in enumerate(assembly.links.values()):
        result["turn", number] = link.frame.rotation
        for kind, body in zip(("first", "second"), link.joins, strict=True):
            if wanted(kind, number):
                result[kind, number] = np.zeros(3) if body == GROUND else assembly.bodies[body].reference - link.frame.position
    for number, body in enumerate(layout(assembly).bodies):
        if wanted("inertia", number):
            inertia = moving_inertia(mechanism, assembly.bodies[body])
            result["inertia", number] = np.zeros((6, 6)) if inertia is None else inertia
    return result


def _in_blocks(part: Part, material: Material | None) -> tuple[Array, Array]:
    """Stiffness and mass of a part, some designs after the others: the stations of many do not fit into the processor's cache."""
    count = max((len(array) for each in (part, material) for array in _arrays(each)), default=1)
    blocks = [slice(start, start + _BLOCK) for start in range(0, count, _BLOCK)] if count > _BLOCK else [slice(None)]
    found = [law_and_mass(_taken(part, block), _taken(material, block)) for block in blocks]
    return _joined([law.stiffness for law, _ in found]), _joined([mass for _, mass in found])


def _joined(arrays: list[Array]) -> Array:
    return np.concatenate(arrays) if len(arrays) > 1 and arrays[0].ndim > 2 else arrays[0]


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
        return value[designs]
    if isinstance(value, tuple):
        return tuple(_taken(each, designs) for each in value)
    if isinstance(value, Description) and any(True for _ in _arrays(value)):
        return replace(value, **{field.name: _taken(getattr(value, field.name), designs) for field in fields(value)})  # type: ignore[type-var]
    return value


def empty_rows(rows: int, count: int) -> Array:
    """An empty (rows, count) whose rows do not begin on the same line of a processor's cache, as powers of two would.

    >>> empty_rows(3, 512).strides[0] % 128
    64
    """
    return np.empty((rows, count + -count % 16 + 8))[:, :count]


def pack(found: Mapping[tuple[str, int], Array], places: tuple[Feature, ...], count: int) -> Array:
    """All numbers of `count` designs as (numbers, designs).

    >>> place = Feature("first", 0, 0)
    >>> pack({("first", 0): np.arange(3.0)}, (place,), 2).tolist()
    [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]
    """
    result = empty_rows(places[-1].slots.stop, count)
    for place in places:
        values = np.real(found[place.kind, place.owner])
        flat = values.reshape(*values.shape[: values.ndim - len(place.shape)], -1)
        result[place.slots] = flat.T if flat.ndim == 2 else flat[:, None]
    return result
