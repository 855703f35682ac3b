"""The cruciform torsion hinge against closed forms, two leaves, a solver of its section's torsion, and finite elements."""

from __future__ import annotations

from itertools import pairwise

import ngsolve
import numpy as np
import pytest
from netgen import occ

import flexstage as fs
from flexstage.analysis.complete import analyse
from flexstage.analysis.loaded.stability import stability
from flexstage.beams.compliance import beam_of, compliance
from flexstage.beams.stress import stress
from flexstage.parts.cruciform import Cruciform, cross
from flexstage.parts.section import Rectangle
from flexstage.show.table import result_table
from flexstage.solid.fea.geometry.draw import draw_form
from flexstage.solid.fea.hinges.hinge import hinge_compliance
from flexstage.solid.fea.meshing.estimate import Accuracy

STEEL = fs.Material(young=200e9, poisson=0.3, density=7800.0)
HINGE = Cruciform("steel", length=0.03, thickness=1e-3, width=0.01)
AXES = ("x", "y", "z", "rx", "ry", "rz")


def prandtl(slender: float) -> float:
    """J of a plus sign of thickness 1: twice the integral of Prandtl's stress function, on a quarter, graded to the corner."""
    far = 0.5 * slender
    corners = [(0.0, 0.0), (far, 0.0), (far, 0.5), (0.5, 0.5), (0.5, far), (0.0, far)]
    face = occ.Face(occ.Wire([occ.Segment(occ.Pnt(*one, 0), occ.Pnt(*other, 0)) for one, other in pairwise([*corners, corners[0]])]))
    for edge in face.edges:
        edge.name = "symmetry" if min(abs(edge.center.x), abs(edge.center.y)) < 1e-9 else "wall"
    next(vertex for vertex in face.vertices if abs(vertex.p.x - 0.5) + abs(vertex.p.y - 0.5) < 1e-9).hpref = 1
    mesh = ngsolve.Mesh(occ.OCCGeometry(face, dim=2).GenerateMesh(maxh=0.4))
    mesh.RefineHP(6, 0.15)
    space = ngsolve.H1(mesh, order=6, dirichlet="wall")
    trial, test = space.TnT()
    form = ngsolve.BilinearForm(ngsolve.grad(trial) * ngsolve.grad(test) * ngsolve.dx).Assemble()
    load = ngsolve.LinearForm(2.0 * test * ngsolve.dx).Assemble()
    stress_function = ngsolve.GridFunction(space)
    stress_function.vec.data = form.mat.Inverse(space.FreeDofs(), "sparsecholesky") * load.vec
    return 8.0 * ngsolve.Integrate(stress_function, mesh, order=12)


@pytest.mark.parametrize("slender", [3.0, 5.0, 10.0])
def test_torsion_constant_is_that_of_prandtls_stress_function(slender: float) -> None:
    assert cross(1.0, slender).torsion == pytest.approx(prandtl(slender), rel=2.5e-4)


def test_area_and_second_moments_are_those_of_its_outline_and_of_its_pieces() -> None:
    section = cross(2.0, 7.0)
    pieces = section.pieces(np.zeros(0))
    for polygons in ((section.outline(np.zeros(0)),), pieces):
        area = inertia = 0.0
        for corners in polygons:
            y, z = corners.T
            ahead, beyond = np.roll(y, -1), np.roll(z, -1)
            crossed = y * beyond - ahead * z
            area += 0.5 * float(np.sum(crossed))
            inertia += float(np.sum(crossed * (y * y + y * ahead + ahead * ahead))) / 12.0
        assert (area, inertia) == pytest.approx((section.area, section.inertia_z), rel=1e-14)


def test_shear_factor_ends_in_that_of_a_square_and_in_twice_that_of_a_leaf() -> None:
    assert cross(1.0, 1.0 + 1e-9).shear == pytest.approx(1.2, rel=1e-6)
    assert cross(1e-5, 1.0).shear == pytest.approx(2.4, rel=1e-4)


def test_stiffness_is_the_closed_form() -> None:
    """Vlasov's torsion, Timoshenko's bending, and tension, written in length, thickness and width of thin leaves, which err by t / b."""
    part = Cruciform("steel", length=0.03, thickness=1e-5, width=0.01)
    length, thickness, width = part.length, part.thickness, part.width
    area, inertia, torsion = 2.0 * width * thickness, thickness * width**3 / 12.0, 2.0 / 3.0 * width * thickness**3
    reach = length / width * np.sqrt(6.0 / 1.3)
    shear = 2.4 * length / (STEEL.shear * area)
    bending = length**3 / (12.0 * 200e9 * inertia) + shear
    turning = length / (200e9 * inertia)
    twist = length / (STEEL.shear * torsion) * (1.0 - np.tanh(reach) / reach)
    expected = [length / (200e9 * area), bending, bending, twist, turning, turning]
    assert np.diag(compliance(part, STEEL)) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 3.0, 10.0, 30.0])
def test_twist_at_stations_converges_to_the_closed_integral(ratio: float) -> None:
    """Vlasov's, which thin leaves end in: shear by warping, beside it, weighs as the square of thickness over length."""
    part = Cruciform("steel", length=ratio * 0.01, thickness=1e-6, width=0.01)
    section = part.throat
    reach = 0.5 * part.length * np.sqrt(STEEL.shear * section.torsion / (200e9 * section.warping))
    closed = part.length / (STEEL.shear * section.torsion) * (1.0 - np.tanh(reach) / reach)
    assert compliance(part, STEEL)[3, 3] == pytest.approx(closed, rel=1e-6)


def test_thin_leaves_twist_as_two_leaves_side_by_side_and_are_as_stressed() -> None:
    """The law of the leaf knows nothing of this one; leaves as thin as a hundredth of their width share only the middle."""
    thin = Cruciform("steel", length=0.03, thickness=1e-4, width=0.01)
    leaf = fs.Leaf("steel", length=0.03, thickness=1e-4, width=0.01)
    assert compliance(leaf, STEEL)[3, 3] / compliance(thin, STEEL)[3, 3] == pytest.approx(2.0, rel=2e-2)
    torque = np.array([0.0, 0.0, 0.0, 0.01, 0.0, 0.0])
    both, alone = stress(thin, STEEL, torque), stress(leaf, STEEL, 0.5 * torque)
    assert both is not None
    assert alone is not None
    assert both.nominal == pytest.approx(alone.nominal, rel=2e-2)


def test_stress_far_from_the_ends_is_that_of_uniform_torsion_and_in_bending_moment_times_distance() -> None:
    part = Cruciform("steel", length=0.3, thickness=1e-3, width=0.01)
    beam = beam_of(part, STEEL)
    section = part.throat
    assert float(beam.twisting.rate[0]) == pytest.approx(1.0 / (STEEL.shear * section.torsion), rel=1e-7)
    assert section.torsional_stress(np.asarray(2.0), np.asarray(1.0)) == pytest.approx(2.0 * 1e-3 / section.torsion)
    strips = Rectangle(part.thickness, part.width).torsional_stress(np.asarray(1.0), np.asarray(0.0))
    assert section.torsional_stress(np.asarray(2.0), np.asarray(0.0)) == pytest.approx(strips, rel=1e-12)  # each leaf carries half of it
    bent = stress(part, STEEL, np.array([0.0, 0.0, 0.0, 0.0, 0.0, 3.0]))
    assert bent is not None
    assert bent.nominal == pytest.approx(3.0 * 0.005 / section.inertia_z, rel=1e-12)


def column(part: Cruciform) -> fs.Mechanism:
    """A hinge upright on the ground, a body on it that 1 N presses down."""
    return fs.Mechanism(
        "column",
        materials={"steel": STEEL},
        parts={"hinge": part},
        bodies={"platform": fs.Body(reference=(0.0, 0.0, float(part.length)))},
        links={"hinge": fs.Link(("ground", "platform"), "hinge", (0.0, 0.0, 0.5 * float(part.length)), fs.Z, bends=fs.X)},
        forces={"load": fs.Force("platform", (0.0, 0.0, float(part.length)), (0.0, 0.0, -1.0))},
        gravity=(0.0, 0.0, 0.0),
    )


def test_a_long_stout_column_buckles_as_eulers() -> None:
    part = Cruciform("steel", length=0.4, thickness=2.5e-3, width=0.01)
    stage = column(part)
    euler = np.pi**2 * 200e9 * part.throat.inertia_z / (4.0 * 0.4**2)
    assert stability(stage, fs.lumped(stage)).dead == pytest.approx(euler, rel=1e-3)
    found = analyse(stage).buckling
    assert found is not None
    assert found.critical[..., 0] == pytest.approx(euler, rel=1e-12)


def test_a_column_of_thin_leaves_twists_long_before_it_bends() -> None:
    """G J A / I_p of Timoshenko & Gere; the ends' restraint of warping, which the factor counts in part, makes it larger by 2 % at most."""
    part = Cruciform("steel", length=0.1, thickness=2e-4, width=0.01)
    stage = column(part)
    section = part.throat
    twisting = STEEL.shear * section.torsion * section.area / section.polar
    euler = np.pi**2 * 200e9 * section.inertia_z / (4.0 * 0.1**2)
    assert twisting < 0.6 * euler
    assert 1.0 <= stability(stage, fs.lumped(stage)).dead / twisting < 1.02
    found = analyse(stage).buckling
    assert found is not None
    assert found.critical[..., 0] == pytest.approx(twisting, rel=1e-12)
    assert "torsional buckling load" in result_table(found).notes[0]


def test_solid_has_the_area_of_its_section() -> None:
    assert draw_form(HINGE).mass == pytest.approx(1e9 * HINGE.throat.area * 0.03, rel=1e-9)


@pytest.mark.parametrize(
    ("part", "order", "bound"),
    [
        pytest.param(Cruciform("steel", length=0.02, thickness=2.5e-3, width=0.01), 3, 0.05, id="stout"),
        pytest.param(HINGE, 5, 0.025, id="slender", marks=pytest.mark.full),
        pytest.param(Cruciform("steel", length=0.06, thickness=5e-4, width=0.01), 5, 0.03, id="thin", marks=pytest.mark.full),
    ],
)
def test_theory_agrees_with_finite_elements(part: Cruciform, order: int, bound: float) -> None:
    """Between rigid faces, which also prevent contraction: what the theory leaves out, by nu^2 times width over length."""
    found = hinge_compliance(part, STEEL, Accuracy(error=0.01, orders=(2, order), meshes=1))
    theory = dict(zip(AXES, np.diag(compliance(part, STEEL)), strict=True))
    solid = dict(zip(AXES, np.diag(found.compliance), strict=True))
    assert theory == pytest.approx(solid, rel=bound)
    leaf = Rectangle(part.thickness, part.width)
    assert part.length / (STEEL.shear * 2.0 * leaf.torsion) > 1.1 * solid["rx"]  # restrained warping is no small part
