"""Checks of the graph of bodies and links: connected bodies, actuators between ground and platform."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from flexstage.base.finding import Finding, name_first
from flexstage.mechanism.assembly.expand import placed_bodies, placed_links
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.parts.part import imposes_stroke

_Neighbours: TypeAlias = Mapping[str, set[str]]
"""Adjacent bodies, by body."""


@dataclass(frozen=True)
class _Edge:
    """Link of the expanded stage: name, joined bodies, part."""

    name: str
    joins: tuple[str, str]
    part: str


def graph_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of the expanded graph; all names must exist.

    >>> from flexstage.parts.body import Body
    >>> print(*graph_findings(Mechanism("", bodies={"platform": Body(mass=1.0)})))
    platform: not connected to the ground. Join it by a link, or remove it.
    """
    edges = [edge for name, link, joins in placed_links(mechanism) for edge in _edges(name, link.part, joins)]
    neighbours = _neighbours(edges)
    reached = _reach(neighbours, {GROUND})
    bodies = (name for name, body in placed_bodies(mechanism).items() if body.of is None)
    yield from _loose_findings([body for body in bodies if body not in reached], neighbours)
    drives = [edge for edge in edges if imposes_stroke(mechanism.parts[edge.part]) and set(edge.joins) <= reached]
    useless = _off_all_paths(drives, neighbours) if PLATFORM in reached else ()
    for edge in drives:
        if edge.name in useless:
            what = f"the actuator between {edge.joins[0]} and {edge.joins[1]} is not in a chain of links from ground to platform"
            yield Finding(edge.name, what, "Connect one end to the ground and the other to the platform, or remove the actuator")


def _edges(name: str, part: str, joins: tuple[str, ...]) -> Iterator[_Edge]:
    """A link as an edge; one with ports as edges from its first body to each other body."""
    first, *others = dict.fromkeys(joins)
    yield from (_Edge(name if len(others) == 1 else f"{name}.{other}", (first, other), part) for other in others)


def _loose_findings(loose: Iterable[str], neighbours: _Neighbours) -> Iterator[Finding]:
    """One error per connected group of bodies: a single link may be missing."""
    rest = dict.fromkeys(loose)
    while rest:
        first = next(iter(rest))
        group = _reach(neighbours, {first})
        others = [body for body in rest if body in group and body != first]
        also, them = (
            (f" (with {name_first(others)})", "one of them by a link, or remove them") if others else ("", "it by a link, or remove it")
        )
        yield Finding(first, f"not connected to the ground{also}", f"Join {them}")
        rest = {body: None for body in rest if body not in group}


def _neighbours(edges: Iterable[_Edge]) -> _Neighbours:
    neighbours: dict[str, set[str]] = {}
    for edge in edges:
        first, second = edge.joins
        neighbours.setdefault(first, set()).add(second)
        neighbours.setdefault(second, set()).add(first)
    return neighbours


def _reach(neighbours: _Neighbours, start: set[str], without: str = "") -> set[str]:
    """Bodies connected with those of `start`, by chains of links without one body."""
    reached, front = {*start}, [*start]
    while front:
        new = neighbours.get(front.pop(), set()) - reached - {without}
        reached |= new
        front += new
    return reached


def _off_all_paths(edges: list[_Edge], neighbours: _Neighbours) -> set[str]:
    """Links on no simple path between ground and platform: one body separates each of them from these two (Menger 1927)."""
    off: set[str] = set()
    for body in neighbours if edges else ():
        reached = _reach(neighbours, {GROUND, PLATFORM} - {body}, body)
        off |= {edge.name for edge in edges if reached.isdisjoint({*edge.joins} - {body})}
    return off
