"""Outlines checked without CAD against the CAD kernel: no clash missed, none invented, joints and pieces told alike."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from flexstage.analysis.assessment.judge import measure_all
from flexstage.analysis.assessment.requirements import measure
from flexstage.cases.registry import CASES, case
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.geometry.contact import contact_findings, gaps, least_gap
from flexstage.mechanism.geometry.pieces import SAGITTA, pieces
from flexstage.mechanism.mechanism import Link, Mechanism, Probe
from flexstage.parts.body import Block, Body, Cylinder, Extrusion, Solid, Sphere
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.gauge import Gauge, SensorSense
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Part
from flexstage.parts.profile import Circular, Elliptic, Filleted, length, rise
from flexstage.parts.rod import Rod
from flexstage.solid.fea.geometry.contact import contact_findings as cad_findings
from flexstage.solid.fea.geometry.draw import draw_form, move_solid
from flexstage.solid.fea.geometry.stage_pieces import stage_pieces

STEEL = Material(young=200e9, poisson=0.3, density=7750.0)
DEEP = 0.1
"""Clashes thicker than this are never missed [mm]."""
PARTS: dict[str, Part] = {
    "leaf": Leaf("steel", 0.03, 0.001, 0.01),
    "rod": Rod("steel", length=0.03, diameter=0.004),
    "notch": Notch("steel", 0.001, 0.012, Circular(0.006)),
    "oval": Notch("steel", 0.001, 0.012, Elliptic(0.012, 0.005)),
    "filleted": Notch("steel", 0.001, 0.012, Filleted(0.02, 0.004)),
    "neck": Neck("steel", thickness=0.002, profile=Circular(0.008)),
    "square": Neck("steel", thickness=0.002, profile=Circular(0.006), width=0.003),
}


def _direction(chance: np.random.Generator) -> tuple[float, float, float]:
    axes = np.eye(3) if chance.random() < 0.5 else chance.normal(size=(1, 3))
    x, y, z = (float(value) for value in chance.permutation(axes)[0])
    return x, y, z


def _upright(along: tuple[float, float, float]) -> tuple[float, float, float]:
    return (1.0, 0.0, 0.0) if abs(along[0]) < 0.9 * float(np.linalg.norm(along)) else (0.0, 0.0, 1.0)


def _solid(chance: np.random.Generator) -> Solid:
    x, y, z = (float(value) for value in chance.uniform(-0.02, 0.02, size=3))
    along = _direction(chance)
    if chance.random() < 0.5:
        sides = chance.uniform(0.005, 0.03, size=3)
        hole = (float(0.6 * sides[0]), float(0.7 * sides[1])) if chance.random() < 0.5 else None
        a, b, c = (float(side) for side in sides)
        return Block("steel", (a, b, c), (x, y, z), hole, along, _upright(along))
    diameter = float(chance.uniform(0.005, 0.03))
    bore = 0.6 * diameter if chance.random() < 0.5 else None
    return Cylinder("steel", diameter, float(chance.uniform(0.005, 0.03)), (x, y, z), along, bore)


def random_stage(seed: int) -> Mechanism:
    """Three bodies of one solid each and three links between them, thrown into one cube of 40 mm."""
    chance = np.random.default_rng([seed, 40])
    bodies = {name: Body(solids={"s": _solid(chance)}) for name in ("platform", "a", "b")}
    links: dict[str, Link] = {}
    for number, joins in enumerate((("ground", "a"), ("a", "b"), ("b", "platform"))):
        x, y, z = (float(value) for value in chance.uniform(-0.02, 0.02, size=3))
        along = _direction(chance)
        links[f"l{number}"] = Link(joins, str(chance.choice(list(PARTS))), (x, y, z), along, _upright(along))
    return Mechanism("thrown", materials={"steel": STEEL}, parts=PARTS, bodies=bodies, links=links)


def drilled_stage(seed: int) -> Mechanism:
    """An angle with a hole, a ball and a pin that may stand in the hole, and links of random parts between them."""
    chance = np.random.default_rng([seed, 41])
    along = _direction(chance)
    angle = ((-0.015, -0.015), (0.02, -0.015), (0.02, -0.002), (0.0, 0.0), (0.0, 0.02), (-0.015, 0.02))
    hole = Cylinder("steel", 0.009, 0.02, (-0.007, -0.007, 0.0), subtract=True)
    x, y, z = (float(value) for value in chance.uniform(-0.02, 0.02, size=3))
    u, v, w = (float(value) for value in chance.uniform(-0.003, 0.003, size=3))
    bodies = {
        "platform": Body(solids={"s": Extrusion("steel", angle, 0.01), "hole": hole}),
        "a": Body(solids={"s": Sphere("steel", 0.012, (x, y, z))}),
        "b": Body(solids={"s": Cylinder("steel", 0.004, 0.03, (u - 0.007, v - 0.007, w), along=(0.1 * along[0], 0.1 * along[1], 1.0))}),
    }
    return replace(random_stage(seed), bodies=bodies)


def clashes(mechanism: Mechanism) -> dict[frozenset[str], float]:
    """Pairs of drawn solids that overlap and belong to nothing in common, with the thickness of their common volume [mm]."""
    stage = stage_pieces(mechanism)
    shapes = {name: move_solid(draw_form(piece.form), piece.frame) for name, piece in stage.pieces.items()}
    found: dict[frozenset[str], float] = {}
    for one, other in combinations(stage.pieces, 2):
        ends = [
            set(stage.assembly.links[name].joins) if name in stage.assembly.links else {stage.pieces[name].body} for name in (one, other)
        ]
        are_links = [name in stage.assembly.links for name in (one, other)]
        if not all(are_links) and ends[0] & ends[1]:
            continue
        low, high = (np.array([[*shape.bounding_box[end]] for shape in (shapes[one], shapes[other])]) for end in (0, 1))
        if np.any(low.max(axis=0) > high.min(axis=0)):
            continue
        common = shapes[one] * shapes[other]
        if common.mass > 0.0:
            found[frozenset((one, other))] = 2.0 * common.mass / sum(face.mass for face in common.faces)
    return found


def told(mechanism: Mechanism, word: str = "overlaps") -> set[frozenset[str]]:
    """Pairs that the outlines alone tell to overlap."""
    pairs: set[frozenset[str]] = set()
    for finding in contact_findings(mechanism):
        words = finding.what.split()
        if words[1] == word:
            pairs.add(frozenset((finding.where, words[2].rstrip(","))))
    return pairs


def _agrees(mechanism: Mechanism) -> int:
    by_cad, by_outlines = clashes(mechanism), told(mechanism)
    missed = {pair: thick for pair, thick in by_cad.items() if thick > DEEP and pair not in by_outlines}
    assert not missed
    assert not by_outlines - by_cad.keys()
    return len(by_outlines)


def test_random_clashes_are_those_of_cad() -> None:
    assert sum(_agrees(random_stage(seed)) for seed in range(8)) > 8
    assert sum(_agrees(drilled_stage(seed)) for seed in range(3)) > 2


def test_a_pin_that_clears_its_hole_clashes_with_nothing() -> None:
    plate, pin = Block("steel", (0.06, 0.06, 0.01)), Cylinder("steel", 0.004, 0.04, (0.01, 0.0, 0.0))
    hole = Cylinder("steel", 0.006, 0.02, (0.01, 0.0, 0.0), subtract=True)
    for holes, clears in (({}, False), ({"hole": hole}, True), ({"hole": replace(hole, length=0.004)}, False)):
        drawn = replace(random_stage(0), links={}, bodies={"platform": Body(solids={"s": plate, **holes}), "a": Body(solids={"s": pin})})
        assert told(drawn) == (set() if clears else {frozenset(("platform.s", "a.s"))})
        assert bool(clashes(drawn)) is not clears


@pytest.mark.full
def test_two_hundred_random_stages_clash_as_cad_says() -> None:
    assert sum(_agrees(random_stage(seed)) for seed in range(200)) > 200
    assert sum(_agrees(drilled_stage(seed)) for seed in range(100)) > 100


QUICK = ("parallelogram", "bridge")
UNDRAWN = {"mirror-mount", "telescope-mount", "quad-suspension", "scott-russell", "steering-mirror"}
"""The mirrors and knees of the mounts have no outlines, nor have the masses of the suspension, the lever of the linkage and a membrane."""
DRAWN = [name for name in CASES if name not in UNDRAWN]


@pytest.mark.parametrize("name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.full) for name in DRAWN])
def test_shipped_cases_are_told_what_cad_tells(name: str) -> None:
    mechanism = case(name)
    by_cad, found = cad_findings(mechanism), contact_findings(mechanism)
    assert bool(found) == bool(by_cad)
    assert told(mechanism) <= {pair for pair, _ in clashes(mechanism).items()} if found else True
    places = " ".join(f"{finding.where} {finding.what}" for finding in found)
    assert all(finding.where in places for finding in by_cad)


BLOCK = Block("steel", (0.02, 0.02, 0.02), at=(0.02, 0.0, 0.0))


def stage(solids: dict[str, Solid], part: str = "leaf", **bodies: Body) -> Mechanism:
    """A link of 20 mm along x from the ground to a platform whose face is at x = 10 mm."""
    parts = {"leaf": Leaf("steel", 0.02, 0.001, 0.01), "neck": Neck("steel", thickness=0.002, profile=Circular(0.01)), "ball": Joint()}
    return Mechanism(
        "link and block",
        materials={"steel": STEEL},
        parts=parts,
        bodies={"platform": Body(solids=solids), **bodies},
        links={"link": Link(("ground", "platform"), part, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))},
    )


def shifted(solid: Solid, *by: float) -> Solid:
    return replace(solid, at=tuple(float(here) + step for here, step in zip(solid.at, by, strict=True)))


@pytest.mark.parametrize("part", ["leaf", "neck"])
@pytest.mark.parametrize(
    ("by", "said"),
    [
        ((0.54, 0.0, 0.0), "gap of 540 mm"),
        ((5e-6, 0.0, 0.0), "gap of 0.005 mm"),
        ((0.0, 0.05, 0.0), "between its end and platform"),
        ((-120e-6, 0.0, 0.0), "penetrates platform by 0.12 mm"),
        ((0.0, 0.0, 0.0125), "% of its end face lies on platform"),
    ],
)
def test_joints_off_their_faces_are_told_as_cad_does(part: str, by: tuple[float, ...], said: str) -> None:
    mechanism = stage({"block": shifted(BLOCK, *by)}, part)
    (finding,) = contact_findings(mechanism)
    assert finding.where == "link"
    assert said in finding.what
    assert {each.where for each in cad_findings(mechanism)} == {"link"}


@pytest.mark.parametrize(("height", "told"), [(4e-5, False), (8e-5, True)])
def test_beside_its_end_face_a_link_keeps_clear_but_for_a_twentieth_of_a_millimetre(height: float, *, told: bool) -> None:
    """A bead of 0.4 mm on the face that the end stands on: let be up to 0.05 mm, told by what lies beyond that."""
    bead = Block("steel", (height, 0.02, 0.0004), at=(0.01 - 0.5 * height, 0.0, 0.001))
    found = contact_findings(stage({"block": BLOCK, "bead": bead}))
    assert [finding.what for finding in found] == (["it penetrates platform by 0.03 mm outside its end face"] if told else [])


def test_what_has_no_outline_is_not_judged() -> None:
    assert contact_findings(stage({"block": BLOCK})) == ()
    assert contact_findings(stage({"block": shifted(BLOCK, 0.5, 0.0, 0.0)}, "ball")) == ()
    assert contact_findings(replace(stage({}), bodies={"platform": Body(mass=1.0)})) == ()


def test_a_link_drawn_backwards_is_told_to_turn() -> None:
    base = stage({"block": BLOCK}, arm=Body(solids={"block": shifted(BLOCK, -0.04, 0.0, 0.0)}))
    (finding,) = contact_findings(replace(base, links={"link": replace(base.links["link"], joins=("platform", "arm"))}))
    assert "drawn from arm to platform" in finding.what


def test_a_body_in_pieces_says_how_far_they_are_apart() -> None:
    lid = shifted(BLOCK, 0.0, 0.0203, 0.0)
    (finding,) = contact_findings(stage({"block": BLOCK, "lid": lid}))
    assert finding.where == "platform"
    assert "lid is 0.3 mm away from platform.block" in finding.what
    (edge,) = contact_findings(stage({"block": BLOCK, "lid": shifted(BLOCK, 0.02, 0.02, 0.0)}))
    assert "along an edge" in edge.what
    assert contact_findings(stage({"block": BLOCK, "lid": shifted(BLOCK, 0.0, 0.02, 0.0)})) == ()


@pytest.mark.parametrize("buried", [0.008, 0.02])
def test_a_solid_within_another_one_clashes_for_both(buried: float) -> None:
    inner = Body(solids={"chip": Block("steel", (0.004, 0.004, 0.004), at=(0.01 + buried, 0.0, 0.0))})
    mechanism = stage({"block": BLOCK}, chip=inner)
    joined = replace(mechanism, links={**mechanism.links, "hold": Link(("platform", "chip"), "ball", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))})
    (finding,) = contact_findings(joined)
    assert "overlaps chip.chip by" in finding.what


@pytest.mark.parametrize(
    ("at", "said"),
    [
        ((0.03, 0.26, 0.0), "250 mm away"),
        ((0.29, 0.0, 0.0), "260 mm away from the outline of platform, along its axis"),
        ((0.0315, 0.0, 0.0), "1.5 mm away"),
        ((0.0305, 0.0, 0.0), None),
        ((0.02, 0.0, 0.0), None),
    ],
)
def test_a_gauge_beside_its_target_is_told(at: tuple[float, float, float], said: str | None) -> None:
    gauge = Probe("probe", "platform", Pose(at, along=(1.0, 0.0, 0.0)), SensorSense.OPENS)
    found = contact_findings(replace(stage({"block": BLOCK}), sensors={"probe": Gauge(1e-4)}, gauges={"S": gauge}))
    assert [said is not None and said in each.what for each in found] == ([] if said is None else [True])


def test_copies_are_told_once() -> None:
    found = [finding.what for finding in contact_findings(case("hexapod"))]
    assert len(found) == 1
    assert "same for A2/front, A3/front, B1/front" in found[0]


def test_a_face_lies_in_the_material_of_a_tube_not_in_its_bore() -> None:
    tube = Cylinder("steel", 0.02, 0.02, (0.02, 0.0, 0.0), (1.0, 0.0, 0.0), bore=0.004)
    (finding,) = contact_findings(stage({"tube": tube}))
    assert "% of its end face" in finding.what


@pytest.mark.parametrize("name", ["notch", "oval", "filleted"])
def test_pieces_of_hinges_lie_within_their_cuts_and_fill_them(name: str) -> None:
    part = PARTS[name]
    assert isinstance(part, Notch)
    half, height = 0.5 * float(length(part.profile)), float(rise(part.profile))
    along = float(part.profile.along) if isinstance(part.profile, Elliptic) else height
    for piece in pieces(part):
        curved = np.maximum(0.0, np.abs(piece.points[:, 0]) - (half - along)) / along
        surface = 0.5 * float(part.thickness) + height * (1.0 - np.sqrt(1.0 - np.minimum(1.0, curved) ** 2))
        below = surface - np.abs(piece.points[:, 1])
        assert np.all(below >= -1e-12)
        upright = height * curved / np.sqrt(np.maximum(1e-12, 1.0 - np.minimum(1.0, curved) ** 2)) / along
        assert np.all(below / np.sqrt(1.0 + upright**2) <= 2.0 * SAGITTA)


def with_post(apart: float) -> Mechanism:
    """The parallelogram guide with a post on the ground, this far in front of the end face of its block, x = 30 mm."""
    guide = case("parallelogram")
    post = Body(solids={"bar": Block("steel", (0.002, 0.01, 0.01), at=(0.031 + apart, 0.0, 0.0))})
    foot = Link(("ground", "post"), "fixed", (0.031 + apart, 0.0, 0.0), (0.0, 0.0, 1.0))
    return replace(
        guide, bodies={**guide.bodies, "post": post}, links={**guide.links, "foot": foot}, parts={**guide.parts, "fixed": Joint()}
    )


@pytest.mark.parametrize("apart", [2e-5, 1e-4, -5e-4])
def test_required_strokes_reduce_the_clearance(apart: float) -> None:
    """By 18 um towards the post, and 8 nm as the block tilts; an overlap grows by as much. Without required strokes it is that at rest."""
    moved, still = with_post(apart), replace(with_post(apart), requirements={})
    found = [float(measure_all(each, (measure(each, "clearance", "here"),))[0]) for each in (moved, still)]
    assert found == pytest.approx([apart - 18e-6, apart], abs=1e-8)


def test_gaps_follow_the_twists_of_bodies() -> None:
    """A bar of 20 mm, turned by 45 degrees about its middle, comes nearer by (sqrt(2) - 1) half sides; a link moves by half its bodies'."""
    bars = {"near": Block("steel", (0.02, 0.02, 0.02)), "far": Block("steel", (0.02, 0.02, 0.02), at=(0.05, 0.0, 0.0))}
    bodies = {name: Body(solids={"bar": solid}, reference=solid.at) for name, solid in bars.items()}
    drawn = replace(random_stage(0), links={}, bodies={"platform": bodies.pop("near"), **bodies})
    turned = {"platform": np.array([0.002, 0.0, 0.0, 0.0, 0.0, 0.25 * np.pi])}
    for twists, apart in (
        ({}, 0.03),
        (turned, 0.038 - 0.01 * np.sqrt(2.0)),
        ({"far": np.array([-0.035, 0.0, 0.0, 0.0, 0.0, 0.0])}, -0.005),
    ):
        found = least_gap(drawn, twists)
        assert found is not None
        assert found.distance == pytest.approx(apart, abs=1e-9)
    wall = Block("steel", (0.01, 0.002, 0.02), at=(0.0, 0.01, 0.0))
    beside = replace(stage({"s": BLOCK}), bodies={"platform": Body(solids={"s": BLOCK}), "far": Body(solids={"wall": wall})})
    gaps_of_link = [
        next(each.distance for each in gaps(beside, 0.05, twists) if "link" in {each.first, each.second})
        for twists in ({}, {"platform": np.array([0.0, 0.004, 0.0, 0.0, 0.0, 0.0])})
    ]
    assert np.diff(gaps_of_link) == pytest.approx(-0.002, abs=1e-4)
