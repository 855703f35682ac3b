"""A superelement against the solid model of the same body: what one writes and the other computes in the stage."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.base.units.scale import X, Y, Z, mm
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.body import Block, Body, Inertia
from flexstage.parts.condensation import condense
from flexstage.parts.leaf import Leaf
from flexstage.solid.exchange.matrices import export_superelement
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import model
from flexstage.spatial.frame import COMPONENTS, FORCES
from tests.stock import STEEL

MESH = Fineness(neck=3.0, block=3.0, grading=0.8, order=2)
KEPT, MANY = (Reduction(MESH, modes=count) for count in (12, 40))
PLATFORM = Body(mass=0.02, centre=(60 * mm, 0.0, 0.0), inertia=Inertia(2e-6, 2e-6, 2e-6))


def forked():
    """A block held by a leaf from the ground, and two leaves from it to a rigid platform."""
    block = Block("steel", (20 * mm, 30 * mm, 10 * mm), at=(20 * mm, 0.0, 0.0))
    leaf = Leaf("steel", length=10 * mm, thickness=2 * mm, width=8 * mm)
    links = {
        "foot": Link(("ground", "fork"), "leaf", (5 * mm, 0.0, 0.0), X, Z),
        "left": Link(("fork", "platform"), "leaf", (35 * mm, 10 * mm, 0.0), X, Z),
        "right": Link(("fork", "platform"), "leaf", (35 * mm, -10 * mm, 0.0), X, Y),
    }
    bodies = {"platform": PLATFORM, "fork": Body(solids={"block": block})}
    return Mechanism("forked", materials={"steel": STEEL}, parts={"leaf": leaf}, bodies=bodies, links=links)


def exported(part):
    """The rigid platform on the exported part alone."""
    link = Link({"foot": "ground", "left": "platform", "right": "platform"}, "fork", (0.0, 0.0, 0.0), X, Z)
    return Mechanism("exported", parts={"fork": part}, bodies={"platform": PLATFORM}, links={"fork": link})


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The exported part, the stage that it stands in, and the solid model of the drawn one with more modes."""
    part = export_superelement(forked(), "fork", tmp_path_factory.mktemp("exported") / "fork.npz", KEPT, cache=None)
    return part, lumped(exported(part)), model(forked(), MANY, cache=None)


TWIST, WRENCH = (tuple(f"platform.{name}" for name in names) for names in (COMPONENTS, FORCES))


def test_compliance_at_the_platform_is_that_of_the_solid(found):
    _, lumps, solid = found
    gains = [static_gain(each, TWIST, WRENCH).values for each in (lumps, solid)]
    np.testing.assert_allclose(gains[0], gains[1], rtol=1e-6, atol=1e-6 * np.max(np.abs(gains[1])) * 1e-3)


def test_its_mass_is_that_of_the_drawn_solid(found):
    volume = 20 * 30 * 10 + 3 * 10 * 2 * 8
    assert condense(found[0]).mass == pytest.approx(volume * mm**3 * STEEL.density, rel=1e-6)


def test_frequencies_are_those_of_the_solid_up_to_half_the_highest_mode_kept(found):
    part, lumps, solid = found
    highest = np.sqrt(np.max(np.sort(condense(part).squares)[: KEPT.modes]))
    values = [np.sqrt(eigen(each).values) for each in (lumps, solid)]
    low = values[1] < 0.5 * highest
    assert np.sum(low) >= 6
    np.testing.assert_allclose(values[0][: np.sum(low)], values[1][low], rtol=3e-4)  # without the inertia of its ports' motions 2e-3


def test_what_cannot_be_exported_is_told(tmp_path):
    with pytest.raises(DesignError, match="unknown solid"):
        export_superelement(forked(), "spoon", tmp_path / "spoon.npz")
    with pytest.raises(DesignError, match="a name that ends in"):
        export_superelement(forked(), "fork", tmp_path / "fork.mat")


def test_a_stage_of_it_is_the_same_read_as_solids(found):
    """What is exported is taken as it is stated: the chain from a solid to a file and back into a stage of solids is closed."""
    part, lumps, _ = found
    solid = model(exported(part), KEPT, cache=None)
    np.testing.assert_allclose(static_gain(solid, TWIST, WRENCH).values, static_gain(lumps, TWIST, WRENCH).values, rtol=1e-6, atol=1e-14)
    np.testing.assert_allclose(eigen(solid).values, eigen(lumps).values, rtol=1e-6)
