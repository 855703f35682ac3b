"""Checks of the graph of bodies and links: connected bodies, actuators between ground and platform."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from flexstage.base.finding import Finding, name_first
from flexstage.mechanism.assembly.expand import joined, placed_bodies, unit_of_copy
from flexstage.mechanism.assembly.likeness import drawn_units
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
    bodies, edges = _graph(mechanism)
    neighbours = _neighbours(edges)
    reached = _reach(neighbours, GROUND)
    yield from _loose_findings([body for body in bodies if body not in reached], neighbours)
    used = _on_a_path(edges) if PLATFORM in reached else {edge.name for edge in edges}
    for edge in edges:
        if imposes_stroke(mechanism.parts[edge.part]) and edge.name not in used and set(edge.joins) <= reached:
            what = f"the actuator between {edge.joins[0]} and {edge.joins[1]} is not in a chain of links from ground to platform"
            yield Finding(edge.name, what, "Connect one end to the ground and the other to the platform, or remove the actuator")


def _graph(mechanism: Mechanism) -> tuple[list[str], list[_Edge]]:
    bodies = placed_bodies(mechanism)
    edges = [edge for name, link in mechanism.links.items() for edge in _edges(name, link.part, joined(link, bodies))]
    units = drawn_units(mechanism)
    for copy, unit in unit_of_copy(mechanism).items():
        for name, link in units[unit].links.items():
            edges += _edges(f"{copy}/{name}", link.part, joined(link, bodies, copy, units[unit].bodies))
    return [name for name, body in bodies.items() if body.of is None], edges


def _edges(name: str, part: str, joins: tuple[str, ...]) -> Iterator[_Edge]:
    """A link as an edge; one with ports as edges from its first body to each other body."""
    first, *others = dict.fromkeys(joins)
    yield from (_Edge(name if len(others) == 1 else f"{name}.{other}", (first, other), part) for other in others)


def _loose_findings(loose: Iterable[str], neighbours: _Neighbours) -> Iterator[Finding]:
    """One error per connected group of bodies: a single link may be missing."""
    rest = dict.fromkeys(loose)
    while rest:
        first = next(iter(rest))
        group = _reach(neighbours, first)
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


def _reach(neighbours: _Neighbours, start: str) -> set[str]:
    """Bodies connected with one."""
    reached, front = {start}, [start]
    while front:
        new = neighbours.get(front.pop(), set()) - reached
        reached |= new
        front += new
    return reached


def _on_a_path(edges: list[_Edge]) -> set[str]:
    """Links on any simple path between ground and platform.

    They form a biconnected component with a closing edge between the two. Depth-first search (Hopcroft and Tarjan 1973) starts with that
    edge, so that its component is the first complete one at the ground.
    """
    ways: dict[str, list[tuple[str, str]]] = {}
    for edge in (_Edge("", (GROUND, PLATFORM), ""), *edges):
        for here, there in (edge.joins, edge.joins[::-1]):
            ways.setdefault(here, []).append((edge.name, there))
    depth, low = {GROUND: 0}, {GROUND: 0}
    trail: list[str] = []
    walk = [(GROUND, "", iter(ways[GROUND]))]
    while True:
        body, via, rest = walk[-1]
        name, there = next(rest, ("", ""))
        if not there:
            walk.pop()
            parent = walk[-1][0]
            if low[body] < depth[parent]:
                low[parent] = min(low[parent], low[body])
            elif not via:
                return set(trail)
            else:
                while trail.pop() != via:
                    pass
        elif there not in depth:
            depth[there] = low[there] = len(walk)
            trail.append(name)
            walk.append((there, name, iter(ways[there])))
        elif name != via and depth[there] < depth[body]:
            trail.append(name)
            low[body] = min(low[body], depth[there])
