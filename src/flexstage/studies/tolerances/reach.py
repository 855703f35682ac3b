"""Numbers of an entry of `[scatter]`. Kinds, shared parts and units are expanded into numbers of single instances."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from flexstage.base.finding import DesignError, refuse, suggest_nearest
from flexstage.mechanism.addresses.address import get
from flexstage.mechanism.addresses.locate import Place, locate, unit_of_copy
from flexstage.mechanism.assembly.expand import PlacedLink, copy_names, expand
from flexstage.mechanism.assembly.misalignment import MISALIGNED
from flexstage.mechanism.grammar.node import NumberNode, VectorNode
from flexstage.mechanism.mechanism import Mechanism, posed
from flexstage.parts.compound import Compound
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import COMPONENTS

KINDS: Mapping[str, tuple[type, ...]] = {
    "hinges": (Notch, Neck, Leaf, Compound),
    "notches": (Notch,),
    "necks": (Neck,),
    "leaves": (Leaf,),
    "rods": (Rod,),
    "stacks": (Piezo,),
}
"""Kinds of parts in entries of `[scatter]`: `hinges.thickness` is the thickness of every notch, neck, leaf and compound hinge."""
PLACED = ("units", "gauges")
"""Kinds with a placement: `units.shift` is the shift of every instance of a unit."""
_NONE = "no kind has a similar name"


@dataclass(frozen=True)
class ScatteredNumbers:
    """Addresses of an entry's numbers by vector component (`""` for scalars); `shared` maps addresses of instances to the shared part."""

    components: Mapping[str, tuple[str, ...]]
    shared: Mapping[str, str]


def reach(design: Mechanism, source: str) -> ScatteredNumbers:
    """Expand an address or a kind into the addresses of numbers in single instances, with an address for each component of a vector.

    A source with a kind has the form kind.number: `hinges.thickness`, `units.rotation.z`, `gauges.shift`, `stacks.stroke` or
    `materials.young`. Kinds are the keys of `KINDS`, `units`, `gauges` and `materials`. The name of a unit or of a pattern means all its
    instances: `horizontal.shift.x` or `S1-S3.shift`. Raises `DesignError` for unknown addresses, with the nearest names.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> reach(parallelogram(), "hinges.thickness").components[""]
    ('links.left.thickness', 'links.right.thickness', 'B/back.thickness', 'B/front.thickness')
    >>> list(reach(parallelogram(), "units.shift").components)
    ['x', 'y', 'z']
    """
    shared = dict[str, str]()
    components = dict[str, list[str]]()
    links = _described(design)
    for address in _addresses(design, source.strip()):
        for component, number in _numbers(design, address):
            components.setdefault(component, []).extend(_copies(design, locate(design, number), links, shared))
    return ScatteredNumbers({name: tuple(dict.fromkeys(found)) for name, found in components.items()}, shared)


def _addresses(design: Mechanism, source: str) -> tuple[str, ...]:
    """The addresses of a kind, or the address itself."""
    owner, _, rest = source.partition(".")
    stem = rest.partition(".")[0]
    if owner in KINDS:
        return _of_links(design, source, lambda link: isinstance(_inner(link), KINDS[owner]), rest)
    if owner == "materials" and stem not in design.materials:
        return _stated_addresses(design, source, (f"materials.{name}.{rest}" for name in design.materials))
    if owner in PLACED and stem not in (*MISALIGNED, *design.units, *design.gauges):
        raise refuse(source, f'"{stem}" has no placement', suggest_nearest(stem, MISALIGNED))
    if stem in MISALIGNED and (names := _standing(design, owner)):
        return tuple(f"{name}.{rest}" for name in names)
    try:
        locate(design, source)
    except DesignError as error:
        near = suggest_nearest(owner, (*KINDS, *PLACED), otherwise=_NONE)
        missed = any(f'"{owner}"' in each.what for each in error.findings)
        if missed and near != _NONE and "/" not in source and "." in source:
            raise refuse(source, f'unknown name "{owner}"', near) from error
        raise
    return (source,)


def _described(design: Mechanism) -> tuple[PlacedLink, ...]:
    """The links of all instances as described, with compounds in one piece."""
    return tuple(dict.fromkeys(link.described for link in expand(design).links.values()))


def _standing(design: Mechanism, owner: str) -> tuple[str, ...]:
    """The instances of a kind, a unit or a pattern."""
    copies = unit_of_copy(design)
    if owner == "units":
        return tuple(copies)
    if owner == "gauges":
        return tuple(name for key in posed(design.gauges) for name in copy_names(key))
    if owner in (*design.placements, *design.gauges) and len(copy_names(owner)) > 1:
        return copy_names(owner)
    return tuple(copy for copy, unit in copies.items() if unit == owner)


def _of_links(design: Mechanism, source: str, wanted: Callable[[PlacedLink], bool], rest: str) -> tuple[str, ...]:
    links = [link for link in _described(design) if wanted(link)]
    if not links:
        raise refuse(source, "the design has no such part", f"Use one of the parts {', '.join(design.parts)}")
    return _stated_addresses(design, source, (f"{_home(link)}.{rest}" for link in links))


def _stated_addresses(design: Mechanism, source: str, candidates: Iterator[str]) -> tuple[str, ...]:
    """The addresses that the design states; if none, the error of the first."""
    found = list[str]()
    complaint: DesignError | None = None
    for address in candidates:
        try:
            if get(design, address) is not None:
                found.append(address)
        except DesignError as error:
            complaint = complaint or error
    if not found:
        what = complaint.findings[0] if complaint is not None else None
        raise refuse(source, what.what if what else "missing in the design", what.advice if what else "Add it")
    return tuple(found)


def _inner(link: PlacedLink) -> object:
    return link.part.part if isinstance(link.part, Restricted) else link.part


def _home(link: PlacedLink) -> str:
    return link.name if "/" in link.name else f"links.{link.name}"


def _numbers(design: Mechanism, address: str) -> Iterator[tuple[str, str]]:
    """The numbers of a vector by component; a single number unchanged."""
    node = locate(design, address).node
    if isinstance(node, VectorNode) and not node.single:
        yield from ((name, f"{address}.{name}") for name in COMPONENTS[: len(node.items)])
    elif isinstance(node, NumberNode):
        if get(design, address) is None:
            raise refuse(address, "missing in the design", "Add it, or choose another number")
        yield "", address
    else:
        raise refuse(address, "not a number", "Use the address of one of its numbers")


def _copies(design: Mechanism, place: Place, links: tuple[PlacedLink, ...], shared: dict[str, str]) -> Iterator[str]:
    """The same number of every instance of a part or of a link drawn in a unit, else the number itself."""
    found = [(link, rest) for link in links if (rest := _rest(place, link)) is not None]
    of_part = not place.in_link and (bool(place.owners) or place.path[0] == "parts")
    for link, rest in found:
        address = locate(design, f"{_home(link)}.{'.'.join(rest)}").address
        if of_part:
            shared[address] = locate(design, f"parts.{link.link.part}.{'.'.join(rest)}").address
        yield address
    if not found:
        yield place.address


def _rest(place: Place, link: PlacedLink) -> tuple[str, ...] | None:
    """The path within a link or its part, if the address is in this link."""
    if place.misaligned:
        return None
    if place.owners:
        drawn = place.owners[-1]
        return place.path if drawn in (link.name, link.drawn, f"links.{link.name}") else None
    if place.path[0] == "parts":
        return place.path[2:] if link.link.part == place.path[1] else None
    if place.path[0] == "units" and place.path[2] == "links":
        return place.path[4:] if link.drawn == f"{place.path[1]}/{place.path[3]}" else None
    if place.path[0] == "links":
        return place.path[2:] if link.name == place.path[1] else None
    return None
