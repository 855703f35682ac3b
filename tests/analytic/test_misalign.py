"""Misaligned guides against closed forms: the load that a turned leaf leaves, the turn at which the guide gives way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.loaded.misalign import misalign, misalignments, seated
from flexstage.cases.double_triangle import double_triangle
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.section import Rectangle
from flexstage.show.displaced import misalign_report, misalignments_report
from flexstage.show.viewer.animation import misalign_data
from flexstage.spatial.rotation import exponential
from tests.laws.test_nonlinear import guide

SLENDER = Leaf("steel", length=0.1, thickness=0.37e-3, width=0.05, section=LeafSection.BEAM)


def slender(turn: np.ndarray | None = None) -> fs.Mechanism:
    return replace(guide(turn), parts={"leaf": SLENDER})


def limit() -> float:
    """4 pi sqrt(E I G J) / (E I_y) [rad], any length: uniform bending in the stiff plane until the leaves twist away."""
    section = Rectangle(SLENDER.thickness, SLENDER.width)
    return 4.0 * np.pi * np.sqrt(section.inertia_z * section.torsion / 2.6) / section.inertia_y


def test_a_guide_gives_way_at_its_critical_misalignment():
    found = misalignments(slender(), ("ry",)).critical
    assert found.rows == ("left", "right")
    assert found.values[:, 0] == pytest.approx(limit(), rel=5e-5)


def test_the_axes_are_those_of_the_link():
    turn = exponential(np.array([0.4, -1.0, 0.3]))
    assert misalignments(slender(turn), ("ry",)).critical.values[:, 0] == pytest.approx(limit(), rel=5e-5)


def test_units_of_measurement_do_not_change_it():
    """Lengths by 1.6, moduli by 0.37: the same angle, found on the same path."""
    drawn = slender()
    links = {name: replace(link, at=tuple(1.6 * np.array(link.at))) for name, link in drawn.links.items()}
    steel = replace(drawn.materials["steel"], young=0.37 * drawn.materials["steel"].young)
    part = replace(SLENDER, **{name: 1.6 * getattr(SLENDER, name) for name in ("length", "thickness", "width")})
    scaled = replace(drawn, materials={"steel": steel}, parts={"leaf": part}, links=links)
    assert misalign(scaled, "left", "ry", 1e-4, points=2).critical == pytest.approx(limit(), rel=5e-5)


def test_beyond_it_no_stable_state_is_one_of_the_guide():
    """To the other side too; rows beyond the critical size are unstable, or have no numbers."""
    found = misalign(slender(), "left", "ry", -1.5 * limit(), points=4)
    assert found.critical == found.followed == pytest.approx(-limit(), rel=5e-5)
    assert not np.any(found.along.values[-1, -1] == 0.0)


def test_below_it_both_leaves_bend_uniformly():
    """M = E I_y phi / (2 L), opposite in the two, as nothing else holds the platform."""
    found = misalign(slender(), "left", "ry", 0.5 * limit(), points=3)
    moment = 200e9 * Rectangle(SLENDER.thickness, SLENDER.width).inertia_y * 0.5 * limit() / (2.0 * SLENDER.length)
    assert found.along.at("3", "load") == pytest.approx(moment, rel=1e-3)
    assert np.abs(found.loads.values[:, 4]) == pytest.approx([moment, moment], rel=1e-3)
    assert found.along.values[:, -1].tolist() == [0.0, 0.0, 0.0]
    assert found.along.at("3", "f1") < found.along.at("1", "f1")


def test_what_is_not_held_twice_follows_freely():
    """About z one leaf bends and the platform goes with it: hardly any load, and nothing gives way."""
    found = misalign(slender(), "left", "rx", 1e-3, points=2)
    assert found.along.at("2", "load") < 0.1 * misalign(slender(), "left", "ry", 1e-3, points=2).along.at("2", "load")
    single = replace(slender(), links={"left": slender().links["left"]})
    free = misalign(single, "left", "ry", 1e-3, points=2)
    assert abs(free.along.at("2", "load")) < 1e-9
    assert np.isnan(free.critical)


def test_of_all_copies_the_loads_are_told_and_the_first_to_give_way_is_played():
    """M = E I_y phi / (2 L) of either leaf at a size that all bear; the worst goes to where it gives way."""
    found = misalignments(slender(), ("ry",), size=0.1 * limit())
    moment = 200e9 * Rectangle(SLENDER.thickness, SLENDER.width).inertia_y * 0.1 * limit() / (2.0 * SLENDER.length)
    assert found.load.values[:, 0] == pytest.approx([moment, moment], rel=1e-3)
    assert found.worst is not None
    assert found.worst.along.values[-1, 0] == found.worst.critical == np.min(found.critical.values)
    assert "path left ry" in misalignments_report(slender(), found)
    assert found.stress.values[0, 0] < np.max(found.worst.strained.stress)


def test_copies_stand_on_the_ground():
    assert seated(double_triangle()) == ("B1", "B2", "B3", "B4", "B5", "B6")


@pytest.mark.parametrize(("copy", "axis"), [("middle", "ry"), ("left", "q")])
def test_names_that_are_none_are_refused(copy: str, axis: str):
    with pytest.raises(fs.DesignError):
        misalign(slender(), copy, axis, 1e-3)


def test_its_report_stands_alone():
    found = misalign(slender(), "left", "ry", 1.5 * limit(), points=4)
    assert found.along.values[-1, -1] > 0
    page = misalign_report(slender(), found)
    assert "buckles at" in page
    assert "<svg" in page
    played = misalign_data(slender(), found).motions
    assert [each.name for each in played] == ["left ry"]
    assert played[0].course is not None
    sizes = np.max(np.abs(played[0].course.poses), axis=(1, 2))
    assert np.all(np.diff(sizes) > 0.0)
