"""Crystals of cubic symmetry as solids: bars and plates by closed forms, and where a crystal lies in a stage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.units.scale import mm
from flexstage.beams.compliance import compliance
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.parts.body import Body, Inertia
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular, Straight
from flexstage.solid.fea.geometry.piece import is_mirrored, medium
from flexstage.solid.fea.hinges.hinge import hinge_compliance
from flexstage.solid.fea.jobs.content import content
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.solid.fea.solver.component import components
from flexstage.spatial.frame import axes

SILICON = Material(None, None, 2329.0, c11=165.64e9, c12=63.94e9, c44=79.51e9)
"""Hopcroft, Nix & Kenny, J. MEMS 19 (2010) 229-238."""
SECOND, THIRD, FOURTH = (Accuracy(error=0.5, orders=(order, order), meshes=1) for order in (2, 3, 4))
DIRECTIONS = {
    "100": (((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)), 130.0),
    "110": (((1.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 169.0),
    "111": (((1.0, 1.0, 1.0), (1.0, -1.0, 0.0)), 188.0),
}
"""The crystal's directions along and up a part, and Young's modulus along it as the paper prints it [GPa]."""


def seen(*directions):
    """The crystal in the axes of a part that lies in these directions of it."""
    return SILICON.oriented(axes(*directions))


@pytest.mark.parametrize("name", [pytest.param("100", marks=pytest.mark.full), pytest.param("110", marks=pytest.mark.full), "111"])
def test_a_bar_has_youngs_modulus_of_its_direction(name):
    """Of two bars the longer gives way by (L2 - L1) / E A more, and bends by (L2 - L1) / E I more: ends cancel, whatever they are."""
    directions, printed = DIRECTIONS[name]
    found = [hinge_compliance(Neck("si", mm, Straight(size * mm), width=mm), seen(*directions), FOURTH).compliance for size in (6, 9)]
    more = np.diag(found[1] - found[0])
    young = 3 * mm / np.array([more[0] * mm**2, more[5] * mm**4 / 12.0])
    np.testing.assert_allclose(young / 1e9, printed, atol=0.6)
    np.testing.assert_allclose(young, float(seen(*directions).young), rtol=1e-3)


def test_an_isotropic_material_stated_as_a_crystal_is_itself():
    steel = Material(young=200e9, poisson=0.3, density=7750.0)
    lame = medium(steel).lame
    cubic = Material(None, None, 7750.0, c11=lame + 2.0 * steel.shear, c12=lame, c44=steel.shear)
    part = Notch("steel", 0.5 * mm, 2 * mm, Circular(1.5 * mm))
    first, second = (hinge_compliance(part, each, SECOND).compliance for each in (steel, cubic.oriented(axes((1.0, 2.0, 3.0)))))
    np.testing.assert_allclose(second, first, rtol=1e-6, atol=1e-9 * np.max(np.abs(first)))


@pytest.mark.parametrize("name", ["100", pytest.param("110", marks=pytest.mark.full)])
def test_a_wide_leaf_bends_as_a_plate_of_its_crystal(name):
    """E / (1 - nu12 nu21): 9 % more than the bar's along 100, where silicon contracts, and hardly more along 110, where it does not."""
    material = seen(*DIRECTIONS[name][0])
    leaf = Leaf("si", length=12 * mm, thickness=0.5 * mm, width=8 * mm)
    found = np.diag(hinge_compliance(leaf, material, THIRD).compliance)
    theory = np.diag(compliance(leaf, material))
    np.testing.assert_allclose(found[[1, 5]], theory[[1, 5]], rtol=0.01)


def test_a_crystal_lies_in_the_stage():
    """A leaf along y is one along x, turned by a quarter, and one along 110 is not; with the crystal turned by as much it is again."""
    first = content(lone(SILICON, (1.0, 0.0, 0.0)))
    assert content(lone(SILICON, (0.0, 1.0, 0.0))) == first
    assert content(lone(SILICON, (1.0, 1.0, 0.0))) != first
    assert content(lone(replace(SILICON, crystal=((1.0, -1.0, 0.0), (0.0, 0.0, 1.0))), (1.0, 1.0, 0.0))) == first


def lone(material, along):
    """A leaf between the ground and a rigid platform, as a component."""
    body = Body(mass=0.1, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-5, 1e-5, 1e-5))
    parts = {"leaf": Leaf("si", 10 * mm, mm, 4 * mm)}
    links = {"leaf": Link(("ground", "platform"), "leaf", (0.0, 0.0, 0.0), along, (0.0, 0.0, 1.0))}
    return components(Mechanism("leaf", materials={"si": material}, parts=parts, bodies={"platform": body}, links=links))[0]


def test_which_mirrors_leave_a_crystal_as_it_is():
    assert [is_mirrored(medium(seen(*DIRECTIONS["110"][0])), axis) for axis in range(3)] == [True, True, True]
    assert [is_mirrored(medium(seen((1.0, 2.0, 0.0), (0.0, 0.0, 1.0))), axis) for axis in range(3)] == [False, False, True]
