"""Outlines of one body that overlap weigh once: closed forms, the CAD kernel's volumes, derivatives, batches, refusals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from netgen import occ

from flexstage.base.finding import DesignError
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import Normal, Pose
from flexstage.mechanism.mechanism import Placement, Unit
from flexstage.parts.body import Block, Body, Cylinder, Extrusion, Inertia, Solid, Sphere
from flexstage.parts.mass import MassProperties, drawn_solids, mass_properties
from flexstage.parts.material import Material
from flexstage.parts.union import Moments, common_moments
from flexstage.solid.fea.geometry.draw import draw_form, move_solid
from flexstage.solid.fea.geometry.stage_pieces import stage_pieces
from flexstage.spatial.frame import Frame, cross_matrix

DENSITY = 1000.0
MATERIALS = {"steel": Material(young=200e9, poisson=0.3, density=DENSITY), "lead": Material(young=16e9, poisson=0.4, density=11340.0)}
ROUND_OFF = 1e-12
"""Relative: sums of some hundred terms of one size."""


def weighed(*solids: Solid) -> MassProperties:
    found = mass_properties(Body(solids={f"s{number}": solid for number, solid in enumerate(solids)}), MATERIALS)
    assert found is not None
    return found


def same(found: MassProperties, wanted: MassProperties) -> bool:
    size = float(np.max(np.abs(wanted.inertia)))
    return (
        bool(np.isclose(found.mass, wanted.mass, rtol=ROUND_OFF))
        and np.allclose(found.centre, wanted.centre, rtol=0.0, atol=ROUND_OFF)
        and np.allclose(found.inertia, wanted.inertia, rtol=0.0, atol=ROUND_OFF * size)
    )


def block(low: tuple[float, ...], high: tuple[float, ...], **more: Any) -> Block:
    x, y, z = (b - a for a, b in zip(low, high, strict=True))
    u, v, w = (0.5 * (a + b) for a, b in zip(low, high, strict=True))
    return Block("steel", (x, y, z), (u, v, w), **more)


UNIT = block((0.0, 0.0, 0.0), (0.01, 0.01, 0.01))

L_SHAPE = (block((0.0, 0.0, 0.0), (0.03, 0.01, 0.02)), block((0.0, 0.0, 0.0), (0.01, 0.04, 0.02)))
L_PARTS = (block((0.0, 0.0, 0.0), (0.03, 0.01, 0.02)), block((0.0, 0.01, 0.0), (0.01, 0.04, 0.02)))
CROSS = (block((-0.02, -0.005, 0.0), (0.02, 0.005, 0.01)), block((-0.005, -0.03, 0.0), (0.005, 0.03, 0.01)))
CROSS_PARTS = (
    CROSS[0],
    block((-0.005, 0.005, 0.0), (0.005, 0.03, 0.01)),
    block((-0.005, -0.03, 0.0), (0.005, -0.005, 0.01)),
)
STAR = tuple(block(tuple(-0.005 * s for s in a), tuple(0.005 * s for s in a)) for a in ((4.0, 1.0, 1.0), (1.0, 4.0, 1.0), (1.0, 1.0, 4.0)))
STAR_PARTS = (
    STAR[0],
    *(block((-0.005, a, -0.005), (0.005, b, 0.005)) for a, b in ((0.005, 0.02), (-0.02, -0.005))),
    *(block((-0.005, -0.005, a), (0.005, 0.005, b)) for a, b in ((0.005, 0.02), (-0.02, -0.005))),
)
FRAME = block((-0.02, -0.02, 0.0), (0.02, 0.02, 0.01), hole=(0.03, 0.03))
HALF = block((-0.02, -0.02, 0.0), (0.0, 0.02, 0.01))
HALF_FRAME = (
    HALF,
    *(block((0.0, a, 0.0), (0.02, b, 0.01)) for a, b in ((0.015, 0.02), (-0.02, -0.015))),
    block((0.015, -0.015, 0.0), (0.02, 0.015, 0.01)),
)
TUBE = Cylinder("steel", 0.02, 0.03, bore=0.01)
PLATE = block((-0.02, -0.02, 0.0), (0.02, 0.02, 0.01))
BOSSED = (PLATE, *(Cylinder("steel", 0.02, size, (0.0, 0.0, z)) for size, z in ((0.015, -0.0075), (0.005, 0.0125))))


@pytest.mark.parametrize(
    ("overlapping", "apart"),
    [
        (L_SHAPE, L_PARTS),
        (CROSS, CROSS_PARTS),
        (STAR, STAR_PARTS),
        ((UNIT, UNIT, UNIT), (UNIT,)),
        ((UNIT, block((0.002, 0.002, 0.002), (0.004, 0.004, 0.004))), (UNIT,)),
        ((FRAME, block((-0.003, -0.003, 0.0), (0.003, 0.003, 0.01))), (FRAME, block((-0.003, -0.003, 0.0), (0.003, 0.003, 0.01)))),
        ((FRAME, HALF), HALF_FRAME),
        ((TUBE, replace(TUBE, at=(0.0, 0.0, 0.01))), (replace(TUBE, length=0.04, at=(0.0, 0.0, 0.005)),)),
        ((TUBE, Cylinder("steel", 0.01, 0.03)), (replace(TUBE, bore=None),)),
        ((TUBE, Cylinder("steel", 0.005, 0.05)), (TUBE, Cylinder("steel", 0.005, 0.05))),
        ((PLATE, replace(TUBE, bore=None)), BOSSED),
    ],
    ids=["L", "cross", "star", "identical", "nested", "in a hole", "over a hole", "tubes", "pin in a bore", "rod in a bore", "boss"],
)
def test_unions_weigh_as_their_parts_do(overlapping: tuple[Solid, ...], apart: tuple[Solid, ...]) -> None:
    assert same(weighed(*overlapping), weighed(*apart))
    assert same(weighed(*reversed(overlapping)), weighed(*apart))


HOLED = replace(FRAME, hole=None)
CORNER = Extrusion("steel", ((0.0, 0.0), (0.03, 0.0), (0.03, 0.01), (0.01, 0.01), (0.01, 0.04), (0.0, 0.04)), 0.02, (0.0, 0.0, 0.01))
SOLID_TUBE, REAMER = replace(TUBE, bore=None), Cylinder("steel", 0.01, 0.05, subtract=True)


@pytest.mark.parametrize(
    ("drawn", "apart"),
    [
        ((CORNER,), L_PARTS),
        ((replace(CORNER, outline=CORNER.outline[::-1]),), L_PARTS),
        ((CORNER, L_SHAPE[0]), L_PARTS),
        ((HOLED, block((-0.015, -0.015, -1.0), (0.015, 0.015, 1.0), subtract=True)), (FRAME,)),
        ((SOLID_TUBE, REAMER), (TUBE,)),
        ((SOLID_TUBE, REAMER, replace(REAMER, length=0.04), replace(REAMER, diameter=0.004)), (TUBE,)),
        ((TUBE, replace(REAMER, diameter=0.008)), (TUBE,)),
        ((SOLID_TUBE, replace(REAMER, material="lead")), (SOLID_TUBE,)),
        ((SOLID_TUBE, REAMER, Cylinder("lead", 0.01, 0.03)), (TUBE, Cylinder("lead", 0.01, 0.03))),
    ],
    ids=["polygon", "the other way round", "with a block", "square hole", "bore", "the same thrice", "in the bore", "of lead", "filled"],
)
def test_polygons_and_holes_weigh_as_what_is_left_does(drawn: tuple[Solid, ...], apart: tuple[Solid, ...]) -> None:
    assert same(weighed(*drawn), weighed(*apart))
    assert same(weighed(*reversed(drawn)), weighed(*apart))


def test_a_ball_and_its_seat_have_their_closed_forms() -> None:
    """A cap of height h of a ball of radius r: pi h^2 (3 r - h) / 3, its centre 3 (2 r - h)^2 / (4 (3 r - h)) from the ball's."""
    radius, depth = 0.006, 0.002
    ball = weighed(Sphere("steel", 2.0 * radius))
    assert np.isclose(ball.mass, DENSITY * 4.0 / 3.0 * np.pi * radius**3, rtol=ROUND_OFF)
    assert np.allclose(ball.inertia, 0.4 * float(ball.mass) * radius**2 * np.eye(3), rtol=ROUND_OFF)
    cap = DENSITY * np.pi * depth**2 * (3.0 * radius - depth) / 3.0
    arm = 0.75 * (2.0 * radius - depth) ** 2 / (3.0 * radius - depth)
    for plate in (PLATE, Extrusion("steel", ((-0.02, -0.02), (0.02, -0.02), (0.02, 0.02), (-0.02, 0.02)), 0.01, (0.0, 0.0, 0.005))):
        bare, at = weighed(plate), (0.003, -0.002, 0.01 + radius - depth)
        on = weighed(plate, Sphere("steel", 2.0 * radius, at))
        seat = weighed(plate, Sphere("steel", 2.0 * radius, at, subtract=True))
        assert np.isclose(on.mass - bare.mass, ball.mass - cap, rtol=1e-11)
        assert np.isclose(bare.mass - seat.mass, cap, rtol=1e-9)
        moment = bare.mass * bare.centre[2] - seat.mass * seat.centre[2]
        assert np.isclose(moment, cap * (at[2] - arm), rtol=1e-9)
    assert same(weighed(PLATE, Sphere("steel", 0.008, (0.0, 0.0, 0.005))), weighed(PLATE))


def test_derivatives_pass_through_polygons_holes_and_balls() -> None:
    def mass_at(x: Any) -> MassProperties:
        outline = ((-0.02, -0.02), (0.02 + x, -0.02), (0.02, 0.5 * x), (0.01, 0.02), (-0.02, 0.015))
        hole = Cylinder("steel", 0.004 + 0.2 * x, 0.03, (0.005 + x, -0.005, 0.0), subtract=True)
        return weighed(Extrusion("steel", outline, 0.008 + x), hole, Sphere("steel", 0.006, (-0.01, -0.01 + x, 0.005)))

    step, at = 1e-6, 0.003
    exact, low, high = mass_at(at + 1e-30j), mass_at(at - step), mass_at(at + step)
    for name in ("mass", "centre", "inertia"):
        slope = np.imag(getattr(exact, name)) / 1e-30
        assert np.allclose(slope, (getattr(high, name) - getattr(low, name)) / (2.0 * step), rtol=1e-6, atol=1e-6 * np.max(np.abs(slope)))
    batch = mass_at(np.array([at, 2.0 * at]))
    assert np.allclose(batch.inertia[1], mass_at(2.0 * at).inertia, rtol=0.0, atol=ROUND_OFF * np.max(np.abs(batch.inertia)))


def test_two_cubes_turned_by_an_eighth_share_an_octagon() -> None:
    found = weighed(Block("steel", (0.01, 0.01, 0.01)), Block("steel", (0.01, 0.01, 0.01), along=(1.0, 1.0, 0.0)))
    assert np.isclose(found.mass, DENSITY * 1e-6 * (2.0 - 2.0 * (np.sqrt(2.0) - 1.0)), rtol=ROUND_OFF)


def _thrown(seed: int) -> list[Block]:
    """Blocks that are parallel to one another, along any of their edges."""
    chance = np.random.default_rng([seed, 11])
    solids: list[Block] = []
    along = tuple(float(each) for each in chance.normal(size=3))
    up = tuple(float(each) for each in np.cross(along, chance.normal(size=3)))
    edges = (along, up, tuple(float(each) for each in np.cross(along, up)))
    for _ in range(4):
        x, y, z = (float(each) for each in chance.uniform(0.01, 0.03, size=3))
        at = tuple(float(each) for each in chance.uniform(-0.01, 0.01, size=3))
        hole = (0.5 * x, 0.6 * y) if chance.random() < 0.4 else None
        first, second = chance.choice(3, size=2, replace=False)
        solids.append(Block("steel", (x, y, z), at, hole, edges[first], edges[second]))  # type: ignore[arg-type]
    return solids


def _upright(seed: int) -> list[Solid]:
    """Blocks and tubes whose axes are parallel, turned about them."""
    chance = np.random.default_rng([seed, 12])
    solids: list[Solid] = []
    for number in range(4):
        x, y, z = (float(each) for each in chance.uniform(0.01, 0.03, size=3))
        u, v, w = (float(each) for each in chance.uniform(-0.01, 0.01, size=3))
        angle = float(chance.uniform(0.0, np.pi))
        has_hole = chance.random() < 0.5
        if number % 2:
            solids.append(Cylinder("steel", x, z, (u, v, w), bore=0.5 * x if has_hole else None))
        else:
            solids.append(
                Block("steel", (x, y, z), (u, v, w), (0.5 * x, 0.6 * y) if has_hole else None, (np.cos(angle), np.sin(angle), 0.0))
            )
    return solids


def _star(chance: np.random.Generator) -> tuple[tuple[float, float], ...]:
    """Corners of a polygon round the origin, neither convex nor regular."""
    angles = 2.0 * np.pi * (np.arange(7) + 0.8 * chance.random(7)) / 7.0
    radii = chance.uniform(0.005, 0.02, size=7)
    return tuple((float(r * np.cos(a)), float(r * np.sin(a))) for r, a in zip(radii, angles, strict=True))


def _drilled(seed: int) -> list[Solid]:
    """An extrusion, a block and a tube, upright, with holes through them: round, square, of any outline."""
    chance = np.random.default_rng([seed, 13])
    made, cuts = _upright(seed)[:2], _upright(seed + 100)
    holes = [replace(cuts[0], hole=None, subtract=True), replace(cuts[1], bore=None, diameter=0.006, subtract=True)]  # type: ignore[call-arg]
    outline = _star(chance)
    pocket = tuple((0.3 * x, 0.3 * y) for x, y in _star(chance))
    upright = {"along": (1.0, 0.5, 0.0), "up": (0.0, 0.0, 1.0)}
    deep = Extrusion("steel", pocket, 0.02, (0.002, 0.001, 0.01), subtract=True)
    return [Extrusion("steel", outline, 0.012, (0.001, 0.0, 0.002), **upright), *made, *holes, deep]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("throw", "seed"),
    [
        pytest.param(throw, seed, marks=() if seed < quick else pytest.mark.full)
        for throw, quick in ((_thrown, 3), (_upright, 3), (_drilled, 1))
        for seed in range(40)
    ],
)
def test_unions_have_the_volume_and_centre_that_cad_gives_them(throw: Callable[[int], Sequence[Solid]], seed: int) -> None:
    solids = throw(seed)
    found = weighed(*solids)
    stage = replace(case("parallelogram"), bodies={"platform": Body(solids={f"s{n}": solid for n, solid in enumerate(solids)})})
    shown = replace(stage, materials={**stage.materials, "steel": MATERIALS["steel"]}, gauges={}, requirements={})
    shapes = [move_solid(draw_form(piece.form), piece.frame) for piece in stage_pieces(shown).bodies["platform"]]
    fused = occ.Fuse(shapes)
    assert np.isclose(float(found.mass) / DENSITY * 1e9, fused.mass, rtol=1e-6)  # the CAD kernel integrates with its own tolerance
    centre = np.array([fused.center.x, fused.center.y, fused.center.z])
    assert np.allclose(1e3 * found.centre, centre, rtol=0.0, atol=1e-4)


def test_half_a_disc_has_its_closed_form() -> None:
    """A disc of radius r cut through its middle: 4 r / (3 pi) from the cut."""
    wall = block((-0.02, -0.02, -0.02), (0.0, 0.02, 0.02))
    found, wide = weighed(wall, Cylinder("steel", 0.02, 0.01)), weighed(wall)
    half = DENSITY * 0.5 * np.pi * 1e-4 * 0.01
    assert np.isclose(found.mass - wide.mass, half, rtol=1e-11)
    assert np.isclose(found.mass * found.centre[0] - wide.mass * wide.centre[0], half * 0.04 / (3.0 * np.pi), rtol=1e-11)


def _turned(x: Any) -> Block:
    return Block("steel", (0.02, 0.005, 0.003), (x, 0.001, 0.002), along=(1.0, 0.2, 0.0))


@pytest.mark.parametrize("second", [_turned(0.01), Cylinder("steel", 0.02, 0.01, (0.015, 0.0, 0.0))], ids=["turned block", "cut disc"])
def test_the_inertia_of_a_union_does_not_depend_on_where_it_stands(second: Block | Cylinder) -> None:
    """What is shared has its middle beside the mean of its corners; it is taken off about its own centre all the same."""
    solids = (block((-0.015, -0.005, -0.005), (0.015, 0.005, 0.005)), second)
    by = np.array([0.03, -0.05, 0.02])
    here = weighed(*solids)
    there = weighed(*(replace(each, at=tuple(np.array(each.at) + by)) for each in solids))
    assert here.mass < sum(weighed(each).mass for each in solids) * (1.0 - 1e-3)
    assert np.allclose(there.centre, here.centre + by, rtol=0.0, atol=ROUND_OFF)
    assert np.allclose(there.inertia, here.inertia, rtol=0.0, atol=100.0 * ROUND_OFF * np.max(np.abs(here.inertia)))  # of a place far off


def test_derivatives_pass_through_the_union() -> None:
    def mass_at(x: Any) -> MassProperties:
        return weighed(block((-0.015, -0.005, -0.005), (0.015, 0.005, 0.005)), _turned(x))

    step, at = 1e-6, 0.01
    exact, low, high = mass_at(at + 1e-30j), mass_at(at - step), mass_at(at + step)
    for name in ("mass", "centre", "inertia"):
        slope = np.imag(getattr(exact, name)) / 1e-30
        assert np.allclose(slope, (getattr(high, name) - getattr(low, name)) / (2.0 * step), rtol=1e-6, atol=1e-6 * np.max(np.abs(slope)))


def test_derivatives_pass_through_round_cuts() -> None:
    def mass_at(x: Any) -> MassProperties:
        cylinders = Cylinder("steel", 0.02 + 0.1 * x, 0.02, (x, 0.001, 0.002)), Cylinder("steel", 0.015, 0.03, (0.011, 0.0, x))
        return weighed(block((-0.015, -0.005, -0.005), (0.009, 0.005, 0.005)), *cylinders)

    step, at = 1e-6, 0.003
    exact, low, high = mass_at(at + 1e-30j), mass_at(at - step), mass_at(at + step)
    for name in ("mass", "centre", "inertia"):
        slope = np.imag(getattr(exact, name)) / 1e-30
        assert np.allclose(slope, (getattr(high, name) - getattr(low, name)) / (2.0 * step), rtol=1e-6, atol=1e-6 * np.max(np.abs(slope)))


_PLACES = np.array([0.0, 0.004, 0.009, 0.014, 0.02, 0.024, 0.03, 0.0041, 0.0201, -0.004])  # within, cut by different faces, apart


@pytest.mark.parametrize(
    "drawn",
    [
        lambda x: [_turned(x)],
        lambda x: [Cylinder("steel", 0.02, 0.01, (x, 0.0, 0.0))],
        lambda x: [Cylinder("steel", 0.02, 0.01, (0.006, x, 0.0)), Cylinder("steel", 0.015, 0.03, (x, 0.002, 0.003), bore=0.004)],
        lambda x: [Extrusion("steel", ((-0.005, -0.005), (0.005, -0.005), (0.005, 0.005), (0.0, 0.008 - 0.4 * x), (-0.005, 0.005)), 0.02)],
    ],
    ids=["turned block", "disc", "two discs, one of them bored", "polygon that is notched or roofed"],
)
def test_a_batch_weighs_as_its_designs_do(drawn: Callable[[Any], list[Solid]]) -> None:
    base = block((-0.015, -0.005, -0.005), (0.015, 0.005, 0.005))
    steps = _PLACES + 1e-30j
    together, stepped = weighed(base, *drawn(_PLACES)), weighed(base, *drawn(steps))
    for number, place in enumerate(_PLACES):
        alone, beside = weighed(base, *drawn(float(place))), weighed(base, *drawn(steps[number]))
        size = np.max(np.abs(alone.inertia))
        assert np.isclose(together.mass[number], alone.mass, rtol=ROUND_OFF)
        assert np.allclose(together.inertia[number], alone.inertia, rtol=0.0, atol=ROUND_OFF * size)
        assert np.allclose(stepped.inertia[number].imag / 1e-30, beside.inertia.imag / 1e-30, rtol=0.0, atol=1e3 * ROUND_OFF * size / 0.015)


@pytest.mark.parametrize(
    "solids",
    [
        (block((-0.02, -0.005, -0.005), (0.02, 0.005, 0.005)), Cylinder("steel", 0.012, 0.03, along=(0.2, 0.0, 1.0))),
        (Cylinder("steel", 0.01, 0.04), Cylinder("steel", 0.01, 0.04, along=(1.0, 0.0, 0.0))),
        (UNIT, Block("steel", (0.02, 0.006, 0.007), (0.009, 0.006, 0.004), along=(1.0, 0.3, -0.2), up=(0.2, 0.0, 1.0))),
        (PLATE, Sphere("steel", 0.006, (0.019, 0.0, 0.009))),
        (Sphere("steel", 0.006), Sphere("steel", 0.006, (0.004, 0.0, 0.0))),
        (UNIT, replace(UNIT, material="lead", size=(0.004, 0.004, 0.004))),
    ],
    ids=["tilted rod", "crossed rods", "tilted block", "ball over an edge", "two balls", "lead in steel"],
)
def test_what_cannot_be_weighed_is_refused(solids: tuple[Solid, ...]) -> None:
    with pytest.raises(DesignError) as told:
        weighed(*solids)
    (finding,) = told.value.findings
    assert "s1" in finding.what
    assert "specify the body's mass" in finding.advice
    if solids[1].material == "lead":
        assert np.isclose(float(finding.what.split(" mm^3")[0].split()[-1]), 64.0, rtol=1e-3)


def test_a_batch_is_refused_for_the_one_design_that_overlaps() -> None:
    """Beside the block in the first design, aslant through its corner in the second."""
    rod = Cylinder("steel", 0.002, 0.03, (np.array([0.03, 0.009]), 0.009, 0.0), along=(0.2, 0.0, 1.0))
    with pytest.raises(DesignError, match="overlaps s1"):
        weighed(UNIT, rod)
    beside = replace(rod, at=(0.0135, 0.0135, 0.005))  # their boxes meet, they do not
    assert np.isclose(weighed(UNIT, beside).mass, DENSITY * (1e-6 + np.pi * 1e-6 * 0.03))


def test_outlines_that_only_touch_or_pass_each_other_are_let_be() -> None:
    beside = Cylinder("steel", 0.01, 0.03, at=(0.0156, 0.0156, 0.0))  # its box meets the block's, it does not
    assert np.isclose(
        weighed(block((-0.01, -0.012, -0.01), (0.012, 0.012, 0.01)), beside).mass, DENSITY * (0.022 * 0.024 * 0.02 + np.pi * 25e-6 * 0.03)
    )
    assert np.isclose(weighed(UNIT, block((0.01, 0.0, 0.0), (0.02, 0.01, 0.01))).mass, DENSITY * 2e-6)


def test_what_is_lent_to_a_body_weighs_once_with_it() -> None:
    stage = case("double-triangle")
    pad = stage.units["vertical"].bodies["pad"]
    name, solid = next(iter(pad.solids.items()))
    twice = replace(pad, solids={**pad.solids, f"{name} again": solid})
    unit = replace(stage.units["vertical"], bodies={**stage.units["vertical"].bodies, "pad": twice})
    doubled = expand(replace(stage, units={**stage.units, "vertical": unit})).bodies["platform"].mass
    single = expand(stage).bodies["platform"].mass
    assert doubled is not None
    assert single is not None
    assert np.isclose(doubled.mass, single.mass, rtol=ROUND_OFF)


def test_a_stated_mass_counts_with_what_is_lent_to_its_body() -> None:
    """The platform's outlines weigh nothing beside its stated mass; its lugs and pads do, as they do without it."""
    stage = case("double-triangle")
    platform = stage.bodies["platform"]
    stated = replace(platform, mass=2.0, centre=(0.0, 0.0, 0.0), inertia=Inertia(0.1, 0.2, 0.3))
    masses = [
        expand(replace(stage, bodies={"platform": body})).bodies["platform"].mass for body in (stated, replace(stated, mass=5.0), platform)
    ]
    light, heavy, plain = (mass for mass in masses if mass is not None)
    assert np.isclose(heavy.mass - light.mass, 3.0, rtol=1e-12)
    own = mass_properties(platform, stage.materials)
    assert own is not None
    assert np.isclose(light.mass - 2.0, plain.mass - own.mass, rtol=1e-9)  # lugs are flush with the plate: they share nothing with it
    lent = (light.mass * light.centre, plain.mass * plain.centre - own.mass * own.centre)
    np.testing.assert_allclose(*lent, rtol=0.0, atol=1e-9)


def test_a_shifted_copy_neither_gains_nor_loses_mass() -> None:
    """Its lugs are flush with the platform: moved by 10 um they would sink in on one side and come off on the other."""
    stage = case("double-triangle")
    masses = [expand(replace(stage, overrides={"B2.shift.y": shift})).bodies["platform"].mass for shift in (-1e-5, 0.0, 1e-5)]
    assert all(mass is not None and masses[1] is not None and np.isclose(mass.mass, masses[1].mass, rtol=ROUND_OFF) for mass in masses)


def test_a_mirrored_body_is_the_image_of_what_is_drawn() -> None:
    """Weighed by theory, drawn by CAD: both where the mirror shows them, the hole too."""
    hole = Cylinder("steel", 0.004, 0.05, (0.005, 0.025, 0.0), subtract=True)
    unit = Unit(bodies={"angle": Body(solids={"s": replace(CORNER, along=(1.0, 0.3, 0.0)), "hole": hole})}, links={})
    stage = replace(case("parallelogram"), materials={**case("parallelogram").materials, "steel": MATERIALS["steel"]}, gauges={})
    copies = {name: Placement("angle", Pose((0.02, 0.03, 0.04), mirror=mirror)) for name, mirror in (("A", None), ("M", Normal.X))}
    shown = replace(stage, units={"angle": unit}, placements=copies, links={}, requirements={})
    bodies, pieces = expand(shown).bodies, stage_pieces(shown).bodies
    masses = [bodies[f"{name}/angle"].mass for name in "AM"]
    assert masses[0] is not None
    assert masses[1] is not None
    turn = np.diag([-1.0, 1.0, 1.0])
    assert np.isclose(masses[0].mass, masses[1].mass, rtol=ROUND_OFF)
    assert np.allclose(masses[1].centre, turn @ masses[0].centre, rtol=0.0, atol=ROUND_OFF)
    assert np.allclose(masses[1].inertia, turn @ masses[0].inertia @ turn, rtol=0.0, atol=ROUND_OFF * np.max(np.abs(masses[0].inertia)))
    for name, mass in zip("AM", masses, strict=True):
        (piece,) = pieces[f"{name}/angle"]
        drawn = move_solid(draw_form(piece.form), piece.frame)
        assert np.isclose(float(mass.mass) / DENSITY * 1e9, drawn.mass, rtol=1e-6)  # type: ignore[union-attr]
        assert np.allclose(1e3 * mass.centre, [drawn.center.x, drawn.center.y, drawn.center.z], rtol=0.0, atol=1e-4)  # type: ignore[union-attr]


CROSSING = {
    "blocks": (UNIT, Block("steel", (0.02, 0.006, 0.007), (0.009, 0.006, 0.004), along=(1.0, 0.3, 0.0))),
    "blocks, one with a hole": (replace(UNIT, size=(0.02, 0.012, 0.01), hole=(0.008, 0.006)), Block("steel", (0.02, 0.006, 0.007))),
    "a disc in a plate": (UNIT, Cylinder("steel", diameter=0.012, length=0.01, at=(0.002, 0.003, 0.008))),
    "tubes side by side": (
        Cylinder("steel", diameter=0.012, length=0.01, at=(0.002, 0.003, 0.008), bore=0.004),
        Cylinder("steel", diameter=0.014, length=0.01, at=(0.006, 0.001, 0.003)),
    ),
}


def _common(solids: tuple[Solid, ...], rotation: np.ndarray, position: np.ndarray, scale: complex = 1.0) -> list[Moments]:
    """What solids have in common, in a frame that may be turning, moving and growing."""
    grown = {f"s{number}": _grown(solid, scale) for number, solid in enumerate(solids)}
    return [found for _, found in common_moments(drawn_solids(Body(solids=grown), MATERIALS, "", Frame(rotation, position)))]


def _grown(solid: Any, scale: complex) -> Solid:
    lengths = {"at": tuple(scale * each for each in solid.at)}
    for name in ("size", "hole", "diameter", "bore", "length"):
        if (own := getattr(solid, name, None)) is not None:
            lengths[name] = tuple(scale * each for each in own) if isinstance(own, tuple) else scale * own
    return replace(solid, **lengths)


@pytest.mark.parametrize("name", CROSSING)
def test_what_moves_as_one_changes_as_its_motion_says(name: str) -> None:
    """Moved, turned and grown, with all faces: V' = 3 g V, s' = V p' + w x s + 4 g s, S' = 2 sym(p' s + [w]x S) + 5 g S."""
    drift, spin, growth, step = np.array([0.3, -0.2, 0.5]), np.array([0.4, 0.7, -0.6]), 0.8, 1e-30
    turn = cross_matrix(spin)
    still = _common(CROSSING[name], np.eye(3), np.zeros(3))
    moved = _common(CROSSING[name], np.eye(3) + 1j * step * turn, 1j * step * drift, 1.0 + 1j * step * growth)
    assert still
    for now, then in zip(still, moved, strict=True):
        size = abs(float(now.volume)) ** (1.0 / 3.0)
        half = drift[:, None] * now.first + turn @ now.second
        wanted = Moments(
            3.0 * growth * now.volume,
            now.volume * drift + turn @ now.first + 4.0 * growth * now.first,
            half + half.T + 5.0 * growth * now.second,
        )
        for kind, power in (("volume", 2), ("first", 3), ("second", 4)):
            difference = np.imag(getattr(then, kind)) / step - getattr(wanted, kind)
            assert np.max(np.abs(difference)) <= 100.0 * ROUND_OFF * size**power
            assert np.allclose(np.real(getattr(then, kind)), getattr(now, kind), rtol=0.0, atol=ROUND_OFF * size ** (power + 1))
