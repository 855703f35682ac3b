"""The graph of bodies and links: everything hangs together, and no actuator pushes into the void."""

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
"""By body, the bodies that links join it to."""


@dataclass(frozen=True)
class _Edge:
    """A link of the expanded stage: its name, the bodies it joins, its part's name."""

    name: str
    joins: tuple[str, str]
    part: str


def graph_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Findings about the expanded graph; presupposes that its names exist.

    >>> from flexstage.parts.body import Body
    >>> print(*graph_findings(Mechanism("", bodies={"platform": Body(mass=1.0)})))
    platform: no chain of links leads from it to the ground. Join it by a link, or remove it.
    """
    bodies, edges = _graph(mechanism)
    neighbours = _neighbours(edges)
    reached = _reach(neighbours, GROUND)
    yield from _loose_findings([body for body in bodies if body not in reached], neighbours)
    used = _on_a_path(edges) if PLATFORM in reached else {edge.name for edge in edges}
    for edge in edges:
        if imposes_stroke(mechanism.parts[edge.part]) and edge.name not in used and set(edge.joins) <= reached:
            what = f"the actuator joins {edge.joins[0]} and {edge.joins[1]}, on no path between ground and platform"
            yield Finding(edge.name, what, "Lead one of its ends to the ground and the other to the platform, or remove it")


def _graph(mechanism: Mechanism) -> tuple[list[str], list[_Edge]]:
    bodies = placed_bodies(mechanism)
    edges = [edge for name, link in mechanism.links.items() for edge in _edges(name, link.part, joined(link, bodies))]
    units = drawn_units(mechanism)
    for copy, unit in unit_of_copy(mechanism).items():
        for name, link in units[unit].links.items():
            edges += _edges(f"{copy}/{name}", link.part, joined(link, bodies, copy, units[unit].bodies))
    return [name for name, body in bodies.items() if body.of is None], edges


def _edges(name: str, part: str, joins: tuple[str, ...]) -> Iterator[_Edge]:
    """A link as an edge; one with ports as edges from its first body to each other."""
    first, *others = dict.fromkeys(joins)
    yield from (_Edge(name if len(others) == 1 else f"{name}.{other}", (first, other), part) for other in others)


def _loose_findings(loose: Iterable[str], neighbours: _Neighbours) -> Iterator[Finding]:
    """One finding for bodies that hang together, however many: one link may be what is missing."""
    rest = dict.fromkeys(loose)
    while rest:
        first = next(iter(rest))
        group = _reach(neighbours, first)
        others = [body for body in rest if body in group and body != first]
        also, them = (f", {name_first(others)}", "one of them by a link, or remove them") if others else ("", "it by a link, or remove it")
        yield Finding(first, f"no chain of links leads from it{also} to the ground", f"Join {them}")
        rest = {body: None for body in rest if body not in group}


def _neighbours(edges: Iterable[_Edge]) -> _Neighbours:
    neighbours: dict[str, set[str]] = {}
    for edge in edges:
        first, second = edge.joins
        neighbours.setdefault(first, set()).add(second)
        neighbours.setdefault(second, set()).add(first)
    return neighbours


def _reach(neighbours: _Neighbours, start: str) -> set[str]:
    """The bodies that hang together with one."""
    reached, front = {start}, [start]
    while front:
        new = neighbours.get(front.pop(), set()) - reached
        reached |= new
        front += new
    return reached


def _on_a_path(edges: list[_Edge]) -> set[str]:
    """The links on any path between ground and platform that visits no body twice.

    They form one block (two-connected part) with a closing edge between the two: depth-first search after Hopcroft and Tarjan 1973, begun
    with that edge, so that its block is the first to be complete at the ground.
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
