"""Laws of hinges as solids: random ones of all families mesh; their 6x6 is symmetric, scales, and grows from below."""

from __future__ import annotations

from itertools import pairwise

import ngsolve
import numpy as np
import pytest

from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular, Elliptic, Filleted, Straight
from flexstage.parts.rod import Rod
from flexstage.solid.fea.geometry.piece import medium
from flexstage.solid.fea.hinges.hinge import hinge_compliance, hinge_mesh
from flexstage.solid.fea.hinges.specimen import END, START
from flexstage.solid.fea.meshing.estimate import Accuracy, change
from flexstage.solid.fea.meshing.mesh import PieceMesh
from flexstage.solid.fea.solver.field import apply_form, field, rigid, stiffness
from flexstage.spatial.frame import axes, identity
from tests.models.solids import solver

STEEL = Material(young=200e9, poisson=0.3, density=7750.0)
MM = 1e-3
ONCE = Accuracy(error=0.0, orders=(2, 2), meshes=1)


FOLDING = Notch("m", 1.0 * MM, 50.3 * MM, Circular(2.0 * MM))
"""The shipped stage's lever hinge in one piece: at the mesher's first sizes its curved elements fold."""


def random_hinges(count):
    """Hinges of all families in turn, thicknesses and ratios log-uniform over what is made: t 0.2-4 mm, R/t 0.7-20, b/t 0.5-20."""
    draw = np.random.default_rng(3)

    def between(low, high):
        return float(np.exp(draw.uniform(np.log(low), np.log(high))))

    def profile(thickness):
        radius = thickness * between(0.7, 20.0)
        fillet = thickness * between(0.5, 3.0)
        shapes = (
            Circular(radius),
            Elliptic(radius, radius * between(0.3, 2.0)),
            Filleted(fillet * between(2.2, 15.0), fillet),
            Straight(thickness * between(2.0, 20.0)),
        )
        return shapes[draw.integers(len(shapes))]

    for number in range(count):
        thickness = between(0.2, 4.0) * MM
        family = number % 5
        if family in (0, 1):
            yield Notch("m", thickness, thickness * between(0.5, 20.0), profile(thickness))
        elif family == 2:
            width = None if draw.uniform() < 0.5 else thickness * between(0.5, 2.0)
            yield Neck("m", thickness, profile(thickness), width)
        elif family == 3:
            size = thickness * between(10.0, 300.0)
            yield Leaf("m", size, thickness, max(size * between(0.1, 2.0), 2.0 * thickness))
        else:
            yield Rod("m", thickness * between(3.0, 40.0), thickness)


@pytest.mark.parametrize("count", [2, pytest.param(120, marks=pytest.mark.full)])
def test_random_hinges_mesh(count):
    """No failure, no element turned inside out, both outer faces found."""
    for part in [FOLDING, *random_hinges(count)]:
        mesh = hinge_mesh(part, order=3)
        mesh.Curve(3)
        points = mesh.MapToAllElements(ngsolve.IntegrationRule(ngsolve.TET, 8), ngsolve.VOL)
        assert np.min(ngsolve.Det(ngsolve.specialcf.JacobianMatrix(3))(points)) > 0.0
        assert set(mesh.GetBoundaries()) >= {START, END}


SAMPLES = [
    Notch("m", 1.0 * MM, 3.0 * MM, Circular(2.0 * MM)),
    Neck("m", 1.0 * MM, Elliptic(3.0 * MM, 1.5 * MM), width=1.5 * MM),
    pytest.param(Neck("m", 1.0 * MM, Filleted(5.0 * MM, 1.0 * MM)), marks=pytest.mark.full),
    Leaf("m", 20.0 * MM, 0.5 * MM, 8.0 * MM),
]


def spaces(part, order=2):
    mesh = hinge_mesh(part, order=order)
    mesh.Curve(order)
    whole = PieceMesh(mesh, (medium(STEEL),), (START, END), np.zeros(mesh.ne, dtype=int), np.zeros(mesh.ne, dtype=bool))
    return field(whole, [], order), field(whole, [START, END], order)


@pytest.mark.parametrize("part", SAMPLES)
def test_stiffness_is_symmetric(part):
    """Before anything is made symmetric: K_ij = u_i . K u_j of the assembled matrix, to 1e-8."""
    _, held = spaces(part)
    form, moved = stiffness(held), rigid(held, identity(), faces=END)
    free = stiffness(held, assemble=False)
    motion = moved - solver(held, form)(apply_form(free, moved))
    law = motion.T @ apply_form(free, motion)
    assert change(law, law.T) < 1e-8


@pytest.mark.parametrize("part", [SAMPLES[0], pytest.param(SAMPLES[1], marks=pytest.mark.full), *SAMPLES[2:]])
def test_a_side_is_computed_for_the_whole(part):
    """A crystal as good as isotropic, turned out of the planes of symmetry, is computed whole: the same but for the mesh."""
    order = Accuracy(error=0.0, orders=(5, 5), meshes=1)
    lame, shear = medium(STEEL).lame, medium(STEEL).shear
    crystal = Material(None, None, STEEL.density, c11=lame + 2.0 * shear, c12=lame, c44=1.00001 * shear).oriented(axes((1.0, 2.0, 3.0)))
    side, whole = (hinge_compliance(part, each, order).compliance for each in (STEEL, crystal))
    assert change(side, whole) < 0.01
    assert side[0, 2] == 0.0 != whole[0, 2]


@pytest.mark.parametrize("part", SAMPLES)
def test_rigid_motion_is_free_of_stress(part):
    """Moved by its own size, or turned by 1 rad, its stress is rounding beside the modulus, in curved elements too; so are its forces."""
    space, _ = spaces(part, order=3)
    points = space.meshed.mesh.MapToAllElements(ngsolve.IntegrationRule(ngsolve.TET, 5), ngsolve.VOL)
    motions = rigid(space, identity()) * np.array([5 * MM] * 3 + [1.0] * 3)
    for motion in motions.T:
        function = ngsolve.GridFunction(space.space)
        function.vec.FV().NumPy()[:] = motion
        gradient = ngsolve.Grad(function) * 1e3
        stress = space.stress(0.5 * (gradient + gradient.trans))(points)
        assert np.max(np.abs(stress)) < 1e-9 * STEEL.young
    form = stiffness(space, assemble=False)
    distorted = motions * np.linspace(1.0, 2.0, space.size)[:, None]
    assert np.linalg.norm(apply_form(form, motions)) < 1e-9 * np.linalg.norm(apply_form(form, distorted))


@pytest.mark.parametrize("part", SAMPLES)
def test_doubly_symmetric_hinges_are_diagonal_at_their_centre(part):
    found = hinge_compliance(part, STEEL, Accuracy(error=0.0, orders=(3, 3), meshes=1)).whole
    assert change(np.diag(np.diag(found)), found) < 2e-3


def test_compliance_scales_with_size_and_modulus():
    """Twice as large and three times as stiff: translations yield 1/(3 2) of it, rotations 1/(3 2^3).

    The mesh of a bar scales too, where no two ways of meshing it are equally good.
    """
    part, twice = (Neck("m", size * MM, Straight(6.1 * size * MM), width=1.57 * size * MM) for size in (1.0, 2.0))
    stiffer = Material(young=3.0 * STEEL.young, poisson=STEEL.poisson, density=1.0)
    small, large = hinge_compliance(part, STEEL, ONCE).compliance, hinge_compliance(twice, stiffer, ONCE).compliance
    expected = np.diag(small) / 3.0 / np.array([2.0, 2.0, 2.0, 8.0, 8.0, 8.0])
    np.testing.assert_allclose(np.diag(large), expected, rtol=1e-6)


def test_order_raises_compliance():
    """Fewer freedoms are stiffer (Rayleigh and Ritz), in every direction: C of the next order minus C is not negative; flat faces."""
    part = Neck("m", 1.0 * MM, Straight(6.0 * MM), width=1.5 * MM)
    orders = [hinge_compliance(part, STEEL, Accuracy(error=0.0, orders=(order, order), meshes=1)).compliance for order in (1, 2, 3, 4)]
    for lower, higher in pairwise(orders):
        scale = 1.0 / np.sqrt(np.diag(higher))
        assert np.min(np.linalg.eigvalsh((higher - lower) * np.outer(scale, scale))) > -1e-12


def test_a_square_neck_bends_alike_both_ways():
    part = Neck("m", 1.0 * MM, Circular(2.0 * MM), width=1.0 * MM)
    own = np.diag(hinge_compliance(part, STEEL, Accuracy(error=0.0, orders=(3, 3), meshes=1)).compliance)
    np.testing.assert_allclose(own[[1, 5]], own[[2, 4]], rtol=0.02)
