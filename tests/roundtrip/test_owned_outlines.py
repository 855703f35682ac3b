"""Outlines that stand in any direction, and outlines lent to another body: files, findings, and the same stage drawn in two ways."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.units.scale import deg, mm
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar
from flexstage.mechanism.checks import check
from flexstage.mechanism.geometry.outline import outlines
from flexstage.mechanism.mechanism import Link, Mechanism, Placement, Unit
from flexstage.mechanism.store import dumps, loads, schema
from flexstage.parts.body import Block, Body, Cylinder
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod

STEEL = Material(young=200e9, poisson=0.3, density=7750.0)
PLATE = Body(solids={"plate": Block("steel", (0.2, 0.2, 0.02), (0.0, 0.0, 0.1))})
LUG = Block("steel", (0.01, 0.02, 0.03), (0.0, 0.005, 0.075))
PIN = Cylinder("steel", 0.004, 0.01, (0.0, 0.005, 0.055), along=(0.0, 1.0, 0.0))
RING = Polar(0.08, 20 * deg, InstanceOrientation.TANGENT)


def lent(end: str = "lug", owner: str = "platform", **body: object) -> Mechanism:
    """Three rods on lugs of the platform that are drawn in the rods' unit."""
    lug = replace(Body(solids={"block": LUG, "pin": PIN}, points={"end": (0.0, 0.0, 0.05)}, of=owner), **body)
    strut = Link(("ground", end), "wire", (0.0, 0.0, 0.03), (0.0, 0.0, 1.0))
    return Mechanism(
        "lugs",
        materials={"steel": STEEL},
        parts={"wire": Rod("steel", 40 * mm, 1 * mm)},
        bodies={"platform": PLATE},
        units={"leg": Unit({"lug": lug}, {"strut": strut})},
        placements={"L1-L3": Placement("leg", RING)},
    )


def drawn() -> Mechanism:
    """The same stage with the lugs drawn in the platform, turned one by one."""
    solids = dict(PLATE.solids)
    for number in range(3):
        angle = (20 + 120 * number + 90) * deg
        x, y = (np.cos(angle), np.sin(angle), 0.0), (-np.sin(angle), np.cos(angle), 0.0)
        base = 0.08 * np.array([np.sin(angle), -np.cos(angle), 0.0])

        def turned(at, base=base, x=x, y=y):
            return tuple(base + at[0] * np.array(x) + at[1] * np.array(y) + [0.0, 0.0, at[2]])

        solids[f"block{number}"] = replace(LUG, at=turned(LUG.at), along=x)
        solids[f"pin{number}"] = replace(PIN, at=turned(PIN.at), along=y)
    stage = lent("platform")
    return replace(stage, bodies={"platform": Body(solids=solids)}, units={"leg": replace(stage.units["leg"], bodies={})})


def test_lent_outlines_are_their_owners() -> None:
    stage, other = expand(lent()), expand(drawn())
    assert list(stage.bodies) == ["platform"]
    assert {link.joins for link in stage.links.values()} == {("ground", "platform")}
    mine, theirs = stage.bodies["platform"], other.bodies["platform"]
    assert list(mine.solids) == ["platform.plate", *(f"L{number}/lug.{name}" for number in (1, 2, 3) for name in ("block", "pin"))]
    for name in ("mass", "centre", "inertia"):
        np.testing.assert_allclose(getattr(mine.mass, name), getattr(theirs.mass, name), rtol=1e-13, atol=1e-15)
    for one, two in zip(mine.solids.values(), theirs.solids.values(), strict=True):
        np.testing.assert_allclose(one.frame.position, two.frame.position, atol=1e-15)
        np.testing.assert_allclose(one.frame.rotation, two.frame.rotation, atol=1e-15)
    assert stage.points["L2/lug.end"][0] == "platform"
    assert check(lent()) == check(drawn()) == ()


def test_lent_outlines_are_outlined_with_the_ground() -> None:
    stage = lent("platform", owner="ground")
    assert check(stage) == ()
    names = [outline.name for outline in outlines(expand(stage))]
    assert "L3/lug.pin" in names
    assert list(expand(stage).bodies["platform"].solids) == ["platform.plate"]
    assert not expand(stage).points


def test_a_turned_block_has_turned_inertia() -> None:
    lying = fs.Block("steel", (0.3, 0.2, 0.1))
    upright = fs.Block("steel", (0.1, 0.3, 0.2), along=(0.0, 0.0, 1.0), up=(0.0, -1.0, 0.0))
    one, two = (
        fs.Mechanism("", materials={"steel": STEEL}, bodies={"platform": fs.Body(solids={"s": solid})}) for solid in (lying, upright)
    )
    np.testing.assert_allclose(
        expand(one).bodies["platform"].mass.inertia, expand(two).bodies["platform"].mass.inertia, rtol=1e-12, atol=1e-18
    )


def test_files_keep_directions_and_owners() -> None:
    stage = lent(solids={"block": replace(LUG, along=(0.0, 0.0, 1.0), up=(1.0, 0.0, 0.0))})
    text = dumps(stage)
    assert 'of = "platform"' in text
    assert 'up = "x"' in text
    assert loads(text) == stage
    assert {"along", "up"} <= set(schema()["$defs"]["Block"]["properties"])


def with_bar(mechanism: Mechanism, owner: str) -> Mechanism:
    """The stage with another body of that owner."""
    return replace(mechanism, bodies={**mechanism.bodies, "bar": Body(of=owner)})


def on_platform(body: Body) -> Mechanism:
    """The stage with its platform replaced."""
    return replace(lent(), bodies={"platform": body})


@pytest.mark.parametrize(
    ("mechanism", "words"),
    [
        (lent(owner="platfrom"), ["units.leg.bodies.lug.of", '"platfrom"', "platform"]),
        (
            with_bar(replace(lent(), bodies={**lent().bodies, "pad": Body(of="platform")}), "pad"),
            ["bodies.bar.of", '"pad"', '"platform"'],
        ),
        (with_bar(lent(), "bar"), ["bodies.bar.of", '"bar"', "remove 'of'"]),
        (on_platform(replace(PLATE, of="ground")), ["bodies.platform.of", "cannot belong to another body"]),
        (lent(solids={}, mass=1.0), ["units.leg.bodies.lug", '"platform"', "mass not allowed"]),
        (lent(reference=(0.0, 0.0, 0.0)), ["units.leg.bodies.lug", "reference not allowed"]),
        (on_platform(Body(mass=1.0)), ["units.leg.bodies.lug", 'its solids belong to "platform"', "specified mass"]),
        (
            replace(
                lent(),
                links={"l": Link(("platform", "bar"), "wire", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))},
                bodies={**lent().bodies, "bar": Body(of="platform")},
            ),
            ["links.l.joins", 'both ends join "platform"'],
        ),
        (lent(solids={"block": replace(LUG, up=(0.0, 1.0, 1.0), along=(0.0, 1.0, 0.0))}), ["lug.solids.block.up", "got 45 deg"]),
        (lent(solids={"block": replace(LUG, along=(0.0, 0.0, 0.0))}), ["lug.solids.block.along", "zero"]),
        (replace(lent(), payloads={"load": fs.Payload("L1/lug", 1.0, (0.0, 0.0, 0.0))}), ["payloads.load.body", '"L1/lug"']),
    ],
)
def test_what_cannot_be_is_named(mechanism: Mechanism, words: list[str]) -> None:
    text = " ".join(str(finding) for finding in check(mechanism))
    for word in words:
        assert word in text
