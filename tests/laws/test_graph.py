"""Laws of the graph of bodies and links: which actuators lie on a path between ground and platform, against a search of all paths."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from flexstage.mechanism.checks.graph import graph_findings
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.parts.body import Body
from flexstage.parts.piezo import Piezo

Edges = dict[str, tuple[str, str]]

OTHERS = re.compile(r"(?:with |, )(\w+)")
NAMES = (GROUND, PLATFORM, "a", "b", "c", "d", "e")
STACK = Piezo(stroke=1e-5, stiffness=1e7, length=0.02, diameter=0.005)

pairs = st.lists(st.sampled_from(NAMES), min_size=2, max_size=2, unique=True).map(tuple)
graphs = st.lists(pairs, min_size=1, max_size=9).map(lambda found: {f"link{number}": pair for number, pair in enumerate(found)})


def paths(edges: Edges, body: str, seen: frozenset[str]) -> Iterator[frozenset[str]]:
    """The links of every path from a body to the platform that visits no body twice."""
    if body == PLATFORM:
        yield frozenset()
        return
    for name, (first, second) in edges.items():
        if body in (first, second):
            other = second if body == first else first
            if other not in seen:
                yield from (frozenset({name}) | rest for rest in paths(edges, other, seen | {other}))


def joined(edges: Edges, body: str = GROUND) -> set[str]:
    """The bodies that hang together with one."""
    reached = {body}
    for _ in NAMES:
        reached |= {body for pair in edges.values() if reached & set(pair) for body in pair}
    return reached


@given(graphs)
def test_actuators_off_every_path_are_named_and_no_others(edges: Edges) -> None:
    stage = Mechanism(
        name="random graph",
        parts={"stack": STACK},
        bodies={body: Body() for body in NAMES if body != GROUND},
        links={name: Link(pair, "stack", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) for name, pair in edges.items()},
    )
    reached = joined(edges)
    used = set().union(*paths(edges, GROUND, frozenset({GROUND})))
    idle = {name for name, pair in edges.items() if set(pair) <= reached and name not in used} if PLATFORM in reached else set()
    loose = set(NAMES) - reached
    groups = {frozenset(joined(edges, body)) for body in loose}
    found = list(graph_findings(stage))
    assert {finding.where for finding in found} - loose == idle
    told = {frozenset([each.where, *OTHERS.findall(each.what)]) for each in found if each.where in loose}
    assert told == groups
    assert len(found) == len(idle) + len(groups)


def test_bodies_that_hang_together_are_one_finding_however_many() -> None:
    bodies = ["platform", *(f"b{number}" for number in range(500))]
    links = {f"l{number}": Link(pair, "stack", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) for number, pair in enumerate(pairwise(bodies))}
    stage = Mechanism("broken chain", parts={"stack": STACK}, bodies={body: Body() for body in bodies}, links=links)
    [finding] = graph_findings(stage)
    assert finding.where == "platform"
    assert finding.what == "not connected to the ground (with b0, b1, b2, b3, b4, b5, b6, b7 and 492 more)"
