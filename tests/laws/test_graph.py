"""Laws of the graph of bodies and links: which actuators lie on a path between ground and platform, against a search of all paths."""

from __future__ import annotations

from collections.abc import Iterator

from hypothesis import given
from hypothesis import strategies as st

from flexstage.mechanism.checks.graph import graph_findings
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.parts.body import Body
from flexstage.parts.piezo import Piezo

Edges = dict[str, tuple[str, str]]

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


def joined(edges: Edges) -> set[str]:
    """The bodies that hang together with the ground."""
    reached = {GROUND}
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
    assert {finding.where for finding in graph_findings(stage)} == idle | loose
