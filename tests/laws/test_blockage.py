"""Blocked strokes: what is advised to be freed lets them move, and what is not blocked is not told so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.caveats import design_warnings
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.likeness import drawn_units
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.mechanism.store import loads
from flexstage.models.ideal import ideal
from flexstage.parts.freedom import ALL, Freedom

STAGES = ("parallelogram", "bridge", "tip-tilt", "xy-stage", "double-triangle")


def with_freedoms(mechanism: Mechanism, change: dict[str, frozenset[Freedom]]) -> Mechanism:
    """The stage with the freedoms of links, by their addresses (`left`, `drive/front`), stated anew."""

    def stated(address: str, link: Link) -> Link:
        return replace(link, free=tuple(each for each in ALL if each in change[address])) if address in change else link

    units = {
        name: replace(unit, links={key: stated(f"{name}/{key}", link) for key, link in unit.links.items()})
        for name, unit in mechanism.units.items()
    }
    return replace(mechanism, links={name: stated(name, link) for name, link in mechanism.links.items()}, units=units)


def freedoms(mechanism: Mechanism) -> dict[str, frozenset[Freedom]]:
    """The freedoms of every link by its address."""
    links = dict(mechanism.links)
    for name, unit in mechanism.units.items():
        links |= {f"{name}/{link}": drawn for link, drawn in unit.links.items()}
    return {name: frozenset(mechanism.parts[link.part].intended if link.free is None else link.free) for name, link in links.items()}


def freed(mechanism: Mechanism, told: tuple[str, ...]) -> Mechanism:
    free = freedoms(mechanism)
    for name in told:
        link, _, freedom = name.rpartition(".")
        free[link] |= {Freedom(freedom)}
    return with_freedoms(mechanism, free)


def check(mechanism: Mechanism) -> int:
    """The number of strokes that are blocked, after trying what is advised for each."""
    found = ideal(mechanism)
    assert set(found.blocked) == set(found.immobile)
    for actuator, blockage in found.blocked.items():
        assert blockage.free
        ways = [blockage.free] if blockage.together else [(each,) for each in blockage.free]
        for way in ways:
            assert actuator not in ideal(freed(mechanism, way)).immobile
    return len(found.blocked)


@pytest.mark.parametrize("name", STAGES)
def test_sound_stages_are_not_blocked(name: str) -> None:
    assert check(case(name)) == 0


@pytest.mark.parametrize(
    ("name", "trials"), [("parallelogram", 6), ("bridge", 3), ("tip-tilt", 3), pytest.param("xy-stage", 20, marks=pytest.mark.full)]
)
def test_freeing_what_is_advised_lets_the_stroke_move(name: str, trials: int) -> None:
    stage = case(name)
    mechanism = replace(stage, units={name: replace(unit, like=None) for name, unit in drawn_units(stage).items()})
    links = freedoms(mechanism)
    blocked = 0
    for trial in range(trials):
        chance = np.random.default_rng([trial, 7])
        chosen = chance.choice(list(links), size=min(len(links), 1 + trial % 3), replace=False)
        try:
            blocked += check(with_freedoms(mechanism, dict.fromkeys(map(str, chosen), frozenset())))
        except ValueError:  # a stroke that no path leads from is refused before
            continue
    assert blocked > 0


def test_actuators_that_are_blocked_alike_are_told_once() -> None:
    mechanism = case("double-triangle")
    locked = with_freedoms(mechanism, {name: frozenset() for name in freedoms(mechanism) if name.startswith("horizontal/")})
    told = [warning for warning in design_warnings(locked) if "stroke cannot move" in warning.what]
    assert [each.where for each in told] == ["B1, B2, B3", "B4, B5, B6"]


def test_a_platform_without_actuators_that_cannot_move_is_told() -> None:
    mechanism = case("parallelogram")
    bare = replace(mechanism, units={}, placements={}, links={name: replace(link, free=()) for name, link in mechanism.links.items()})
    assert any("all six degrees of freedom" in warning.what for warning in design_warnings(replace(bare, requirements={})))


def test_the_links_that_block_are_named_with_what_to_free() -> None:
    mechanism = case("parallelogram")
    one = ideal(with_freedoms(mechanism, {"left": frozenset()})).blocked["B"]
    assert (one.free, one.together) == (("left.y",), False)
    assert {name.partition(".")[0] for name in one.against} == {"left"}
    both = ideal(with_freedoms(mechanism, {"left": frozenset(), "right": frozenset()})).blocked["B"]
    assert (set(both.free), both.together) == ({"left.y", "right.y"}, True)


def test_a_stack_without_hinges_is_told_where_they_belong() -> None:
    """A lever pushed by a stack that is fixed to it and to the ground cannot turn; with hinges at the ends it does."""
    rigid = loads(LEVER)
    (told,) = ideal(rigid).blockages
    assert str(told).startswith("stack: the stroke cannot move: it is blocked by the locked degrees of freedom of pivot (x), stack (rz)")
    assert "The actuator, elastic only along its axis, has no hinge at ground and platform: add a hinge at each end" in told.advice
    ends = 'bodies.base = { mass = "1 g", point = true }\nbodies.tip = { mass = "1 g", point = true }\n[parts]'
    hinged = LEVER.replace('["ground", "platform"], part = "stack"', '["base", "tip"], part = "stack"').replace("[parts]", ends) + JOINTS
    assert ideal(loads(hinged)).blockages == ()


LEVER = """
format = "flexstage 1"
name = "lever"
materials.steel.like = "17-4PH"
bodies.platform = { mass = "50 g", point = true }
[parts]
pivot = { kind = "notch", material = "steel", thickness = "0.8 mm", width = "10 mm", profile = { shape = "circular", radius = "3 mm" } }
stack = { kind = "piezo", like = "PiezoDrive SA050536" }
[links]
pivot = { joins = ["ground", "platform"], part = "pivot", at = ["0 mm", "-8 mm", "0 mm"], along = "y", bends = "z" }
stack = { joins = ["ground", "platform"], part = "stack", at = ["15 mm", "-23 mm", "0 mm"], along = "y" }
"""
JOINTS = """
low = { joins = ["ground", "base"], part = "pivot", at = ["15 mm", "-45 mm", "0 mm"], along = "y", bends = "z" }
high = { joins = ["tip", "platform"], part = "pivot", at = ["15 mm", "-1 mm", "0 mm"], along = "y", bends = "z" }
"""
