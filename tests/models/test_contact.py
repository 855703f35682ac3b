"""Outlines checked against each other: what does not meet, overlaps or nearly coincides is found and named before meshing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.finding import Finding
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import Link, Mechanism, Placement, Unit
from flexstage.parts.body import Block, Body, Cylinder, Solid
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.profile import Circular
from flexstage.solid.fea.geometry.contact import contact_findings
from flexstage.solid.fea.jobs.apart import contacts_apart

STEEL = Material(young=200e9, poisson=0.3, density=7750.0)
BLOCK = Block("steel", (0.02, 0.02, 0.02), at=(0.02, 0.0, 0.0))


def stage(solids: dict[str, Solid], **bodies: Body) -> Mechanism:
    """A leaf of 20 x 1 x 10 mm along x from the ground to a platform whose face is at x = 10 mm."""
    return Mechanism(
        "leaf and block",
        materials={"steel": STEEL},
        parts={"leaf": Leaf("steel", 0.02, 0.001, 0.01), "neck": Neck("steel", thickness=0.002, profile=Circular(0.004))},
        bodies={"platform": Body(solids=solids), **bodies},
        links={"leaf": Link(("ground", "platform"), "leaf", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))},
    )


def only(mechanism: Mechanism, **options: float) -> Finding:
    (finding,) = contact_findings(mechanism, **options)
    return finding


def moved(solid: Block, x: float, y: float = 0.0, z: float = 0.0) -> Block:
    return replace(solid, at=tuple(np.add(solid.at, (x, y, z)).tolist()))


def test_a_sound_stage_has_no_findings() -> None:
    assert contact_findings(stage({"block": BLOCK})) == ()


@pytest.mark.parametrize("name", ["parallelogram", "double-triangle"])
def test_buildable_cases_have_no_findings(name: str) -> None:
    assert contact_findings(case(name)) == ()


@pytest.mark.parametrize(("gap", "said"), [(5e-6, "5 um away"), (1e-7, "0.1 um away"), (3e-3, "3 mm away")])
def test_gap_of_a_joint_is_measured(gap: float, said: str) -> None:
    finding = only(stage({"block": moved(BLOCK, gap)}))
    assert finding.where == "leaf"
    assert said in finding.what


def test_a_link_that_runs_into_its_body_says_how_deep() -> None:
    finding = only(stage({"block": moved(BLOCK, -120e-6)}))
    assert "runs 120 um into platform" in finding.what


def test_an_end_face_that_overhangs_says_how_much_of_it_lies_on_the_body() -> None:
    finding = only(stage({"block": moved(BLOCK, 0.0, z=0.0125)}))  # the block begins at z = 2.5 mm of -5 ... 5 mm
    assert "only 25 % of its end face" in finding.what


def test_a_link_drawn_backwards_is_told_to_turn() -> None:
    base = stage({"block": BLOCK}, arm=Body(solids={"block": moved(BLOCK, -0.04)}))
    link = replace(base.links["leaf"], joins=("platform", "arm"))
    finding = only(replace(base, links={"leaf": link}))
    assert "drawn from arm to platform" in finding.what
    assert "Reverse `along`" in finding.advice
    turned = replace(base, links={"leaf": replace(link, along=(-1.0, 0.0, 0.0))})
    assert contact_findings(turned) == ()


def test_a_link_drawn_backwards_is_told_beside_an_equal_one_that_is_not() -> None:
    base = stage({"block": BLOCK})
    leaf = base.links["leaf"]
    arm = Unit(bodies={"tip": Body(solids={"block": BLOCK})}, links={"leaf": replace(leaf, joins=("ground", "tip"))})
    other = replace(arm, links={"leaf": replace(leaf, joins=("tip", "ground"))})
    placements = {"A": Placement("one", Pose((0.0, 0.1, 0.0))), "B": Placement("two", Pose((0.0, 0.2, 0.0)))}
    finding = only(replace(base, units={"one": arm, "two": other}, placements=placements))
    assert finding.where == "B/leaf"
    assert "drawn from ground to B/tip" in finding.what


def test_a_link_that_meets_its_body_beside_the_end_face() -> None:
    rail = Block("steel", (0.03, 0.004, 0.02), at=(0.005, 0.0025, 0.0))  # lies on the side y = 0.5 mm of the leaf
    finding = only(stage({"block": BLOCK, "rail": rail}))
    assert "outside its end face" in finding.what


@pytest.mark.parametrize(("shift", "said"), [((0.0, 3e-5, 0.0), "30 um away"), ((0.02, 0.0, 0.0), "along an edge")])
def test_outlines_of_one_body_touch_over_faces(shift: tuple[float, float, float], said: str) -> None:
    second = moved(BLOCK, shift[0], 0.02 + shift[1], shift[2])
    finding = only(stage({"block": BLOCK, "lug": second}))
    assert finding.where == "platform"
    assert said in finding.what
    assert "platform.lug" in finding.what


def test_a_slot_between_joined_outlines() -> None:
    lug, bridge = moved(BLOCK, 0.0, 0.02005), Block("steel", (0.02, 0.04005, 0.02), at=(0.04, 0.010025, 0.0))
    findings = contact_findings(stage({"block": BLOCK, "bridge": bridge, "lug": lug}))
    assert "a slot of 50 um" in findings[0].what
    assert "50 um" in findings[1].what  # its bottom


def test_overlap_of_foreign_bodies_says_volume_and_place() -> None:
    other = Body(solids={"block": moved(BLOCK, 0.0, 0.018)})
    finding = only(stage({"block": BLOCK}, other=other))
    assert "overlaps other.block by 800 mm3 around (20, 9, 0) mm" in finding.what


def test_touching_is_too_near_and_so_is_less_than_the_clearance() -> None:
    apart = {
        distance: stage({"block": BLOCK}, other=Body(solids={"block": moved(BLOCK, 0.0, 0.02 + distance)})) for distance in (0.0, 1e-4)
    }
    assert "touches other.block" in only(apart[0.0]).what
    assert contact_findings(apart[1e-4]) == ()
    assert "100 um from other.block, less than the clearance of 300 um" in only(apart[1e-4], clearance=3e-4).what


def test_a_step_of_a_micrometre_between_outlines_is_a_sliver() -> None:
    finding = only(stage({"block": BLOCK, "lug": moved(BLOCK, 0.02, 0.0, 1e-6)}))
    assert "1 um" in finding.what
    assert "platform.block and platform.lug" in finding.what


def test_a_rod_slightly_wider_than_its_block_is_a_sliver() -> None:
    rod = Cylinder("steel", diameter=0.0201, length=0.02, at=(0.04, 0.0, 0.0), along=(1.0, 0.0, 0.0))
    assert "platform.rod" in only(stage({"block": BLOCK, "rod": rod})).what


def test_findings_of_a_stage_come_together() -> None:
    base = case("parallelogram")
    shifted = {name: replace(link, at=tuple(np.add(link.at, (0.0, 2e-5, 0.0)).tolist())) for name, link in base.links.items()}
    far = {**base.bodies["platform"].solids, "far": moved(BLOCK, 0.0, 0.0, 0.3)}
    findings = contact_findings(replace(base, links=shifted, bodies={"platform": Body(solids=far)}))
    assert [finding.where for finding in findings] == ["left", "right", "platform"]
    assert all("20 um away from platform" in finding.what for finding in findings[:2])


def test_copies_are_named_with_the_first() -> None:
    base = case("double-triangle")
    unit = base.units["horizontal"]
    back = replace(unit.links["back"], at=tuple(np.add(unit.links["back"].at, (-1e-5, 0.0, 0.0)).tolist()))
    units = {**base.units, "horizontal": replace(unit, links={**unit.links, "back": back})}
    finding = only(replace(base, units=units))
    assert finding.where == "B1/back"
    assert "10 um away from B1/base (also B2/back, B3/back)" in finding.what


def test_a_part_without_shape_is_named() -> None:
    base = stage({"block": BLOCK})
    joint = replace(base, parts={**base.parts, "leaf": Joint((Freedom.RZ,))})
    finding = only(joint)
    assert finding.where == "leaf"
    assert "has neither a shape" in finding.what


def test_a_process_of_its_own_finds_the_same() -> None:
    bad = stage({"block": moved(BLOCK, 5e-6)}, other=Body(solids={"block": moved(BLOCK, 0.0, 0.018)}))
    (found,) = contacts_apart([bad])
    assert found == contact_findings(bad)
    assert len(found) == 2
