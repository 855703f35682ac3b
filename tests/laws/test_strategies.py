"""What the random stages promise: valid by construction, of the mobility they say, and of all kinds."""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, Phase, find, given, settings

from flexstage.mechanism.checks import check
from flexstage.parts.part import is_actuator
from tests.laws.shared import ideal
from tests.laws.strategies import actuated_platforms, mechanisms, moved, platforms, rosettes, turns


def findings(mechanism):
    return [str(finding) for finding in check(mechanism)]


@given(mechanisms())
def test_random_graphs_are_valid(mechanism):
    assert findings(mechanism) == []
    assert any(is_actuator(mechanism.parts[link.part]) for link in mechanism.links.values())


@given(platforms())
def test_random_platforms_are_valid(drawn):
    assert findings(drawn[0]) == []


@given(rosettes())
def test_random_rosettes_are_valid(mechanism):
    assert findings(mechanism) == []


@given(actuated_platforms(), turns())
def test_moved_stages_are_valid(mechanism, move):
    assert findings(moved(mechanism, *move)) == []


@given(actuated_platforms())
def test_actuated_platforms_are_actuated(mechanism):
    found = ideal(mechanism)
    assert found.mobility == 6 - len(mechanism.links)
    assert found.actuated


@given(platforms(wires=0, struts=6))
def test_rows_of_the_mapping_are_the_lines(drawn):
    """R_a of a platform on struts: stroke ratio times (n, r x n) about the platform's reference, whatever the units are made of."""
    mechanism, lines, ratios = drawn
    body = mechanism.bodies["platform"]
    reference = np.array(body.centre if body.reference is None else body.reference)
    expected = []
    for (point, along), ratio in zip(lines, ratios, strict=True):
        unit = np.array(along) / np.linalg.norm(along)
        expected.append(ratio * np.array([*unit, *np.cross(np.array(point) - reference, unit)]))
    np.testing.assert_allclose(ideal(mechanism).mapping.values, expected, atol=1e-9)


SEARCH = settings(max_examples=500, phases=[Phase.generate], derandomize=True, suppress_health_check=list(HealthCheck))


def test_all_kinds_are_drawn():
    """Two closed loops, six bodies, eight strokes, and every number of freedoms are within reach."""
    assert find(mechanisms(), lambda drawn: len(drawn.links) == len(drawn.bodies) + 2, settings=SEARCH)
    assert find(mechanisms(), lambda drawn: len(drawn.bodies) >= 6, settings=SEARCH)
    assert find(platforms(), lambda drawn: len(drawn[0].placements) == 8, settings=SEARCH)
    for wires in range(6):
        assert find(platforms(), lambda drawn, wires=wires: len(drawn[0].links) == wires, settings=SEARCH)
