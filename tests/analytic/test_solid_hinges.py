"""Hinges by elasticity against independent finite elements: plane stress, axisymmetric, plates, and a notch in three dimensions.

The reference's columns (reference.md B1 to B4, B6, B12) were computed with other elements by another code. Plane stress is the limit of a
narrow hinge: here its width is a quarter of its thickness.
"""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular, Elliptic, Filleted
from flexstage.solid.fea.geometry.draw import specimen
from flexstage.solid.fea.hinges.hinge import hinge_compliance
from flexstage.solid.fea.hinges.roots import Roots
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.spatial.frame import transport
from tests.elsewhere.test_notch_elements import HINGES

UNIT = Material(young=1.0, poisson=0.3, density=1.0)
STEEL = Material(young=200e9, poisson=0.3, density=7750.0)
MM = 1e-3
NARROW = 0.25
"""Width over thickness: plane stress."""
SLIGHT = 0.01
"""Thickness of a leaf over the lesser of its length and width: a plate."""

QUICK = Accuracy(error=0.0, orders=(3, 3), meshes=1)
CAREFUL = Accuracy(error=0.0, orders=(4, 4), meshes=1)
PER_NEWTON_MM = np.array([1e3, 1e3, 1e3, 1e-3, 1e-3, 1e-3])
"""From m/N and rad/(N m) to mm/N and rad/(N mm)."""


def quick_and_full(quick, every):
    """Cases at both depths: `quick` ones always at order three, every one at order four in full."""
    few = [pytest.param(key, QUICK, id=f"{key} quick") for key in quick]
    return [*few, *(pytest.param(key, CAREFUL, id=f"{key}", marks=pytest.mark.full) for key in every)]


def expect(found, reference, tolerance):
    np.testing.assert_allclose(np.asarray(found), np.asarray(reference), rtol=tolerance, atol=0.0)


# B1, right-circular notch of R = 1: t -> C_thz, C_x, C_y, times E b; blocks of length R.
CIRCULAR = {
    0.05: (25629, 13.042, 448.34),
    0.10: (4588.15, 8.8695, 165.52),
    0.20: (829.427, 5.8944, 62.154),
    0.40: (151.707, 3.7742, 23.599),
    0.50: (87.921, 3.2332, 17.293),
    0.80: (27.761, 2.2798, 9.0043),
}


@pytest.mark.parametrize(("thickness", "accuracy"), quick_and_full([0.2, 0.8], CIRCULAR))
def test_right_circular_notches(thickness, accuracy):
    radius = 10 * MM
    width = NARROW * thickness * radius
    found = hinge_compliance(Notch("m", thickness * radius, width, Circular(radius)), UNIT, accuracy, stub=radius)
    own = np.diag(found.compliance) * width
    expect([own[5] * radius**2, own[0], own[1]], CIRCULAR[thickness], 0.01)


@pytest.mark.full
def test_a_wide_notch_is_in_plane_strain():
    """B1: E becomes E/(1 - nu^2) inside a wide hinge; of two widths the difference, where what happens at the edges drops out."""
    radius, widths = 10 * MM, np.array([20 * MM, 40 * MM])
    parts = [Notch("m", 0.2 * radius, width, Circular(radius)) for width in widths]
    stiffness = [1.0 / hinge_compliance(part, UNIT, CAREFUL, stub=radius).compliance[5, 5] for part in parts]
    expect(np.diff(widths) * radius**2 / np.diff(stiffness), CIRCULAR[0.2][0] * (1.0 - 0.3**2), 0.01)


# B2, corner-filleted notch, b = 10 mm, N and mm: l, r, t -> C_thz, C_x, C_y.
FILLETED = {
    (10, 1, 0.5): (4.279925e-4, 9.652974e-6, 2.877766e-3),
    (10, 1, 1.0): (5.602200e-5, 4.989984e-6, 4.196303e-4),
    (20, 1, 0.5): (9.079915e-4, 1.965298e-5, 2.716382e-2),
}
# B3, elliptic: a, c, t.
ELLIPTIC = {
    (5, 2, 0.5): (1.392495e-4, 5.558679e-6, 2.419273e-4),
    (8, 2, 0.8): (6.704537e-5, 6.251940e-6, 4.100871e-4),
    (5, 5, 0.5): (9.176335e-5, 4.434686e-6, 8.275846e-5),
}


def narrowed(part, accuracy):
    """C_thz, C_x, C_y of a narrow hinge, scaled to a width of 10 mm, in N and mm; its stubs are as long as it is high."""
    own = np.diag(hinge_compliance(part, STEEL, accuracy).compliance) * PER_NEWTON_MM * part.width / (10 * MM)
    return own[[5, 0, 1]]


@pytest.mark.parametrize(("sizes", "accuracy"), quick_and_full([(10, 1, 0.5)], FILLETED))
def test_filleted_notches(sizes, accuracy):
    total, radius, thickness = (size * MM for size in sizes)
    part = Notch("m", thickness, NARROW * thickness, Filleted(total, radius))
    expect(narrowed(part, accuracy), FILLETED[sizes], 0.01)


@pytest.mark.parametrize(("sizes", "accuracy"), quick_and_full([(8, 2, 0.8)], ELLIPTIC))
def test_elliptic_notches(sizes, accuracy):
    along, across, thickness = (size * MM for size in sizes)
    part = Notch("m", thickness, NARROW * thickness, Elliptic(along, across))
    expect(narrowed(part, accuracy), ELLIPTIC[sizes], 0.01)


# B4, toroidal neck of R = 1, E = 1: t -> C_th, C_x, by axisymmetric elements.
TOROIDAL = {0.05: (718836, 180.926), 0.10: (63852.8, 64.424), 0.20: (5699.49, 22.939), 0.50: (237.09, 5.7499)}


@pytest.mark.parametrize(("thickness", "accuracy"), quick_and_full([0.2], TOROIDAL))
def test_toroidal_necks(thickness, accuracy):
    radius = 10 * MM
    found = hinge_compliance(Neck("m", thickness * radius, Circular(radius)), UNIT, accuracy, stub=radius).compliance
    expect([found[4, 4] * radius**3, found[5, 5] * radius**3, found[0, 0] * radius], np.take(TOROIDAL[thickness], [0, 0, 1]), 0.01)


# B6, leaf as a plate: b/L -> guided, tip force, moment over 12EI/L^3, 3EI/L^3, EI/L; torsion over G (b t^3/3)/L.
PLATES = {
    0.1: (1.0209, 1.0109, 1.0076, 1.0511),
    0.2: (1.0376, 1.0206, 1.0150, 1.1073),
    0.5: (1.0679, 1.0450, 1.0377, 1.3191),
    2.0: (1.0912, 1.0842, 1.0819, 4.0195),
}
FINE_PLATE = Accuracy(error=0.0, orders=(5, 5), meshes=2)
"""The widest leaf yields most at its clamped corners: two meshes of order five."""


@pytest.mark.parametrize(
    ("ratio", "accuracy"),
    [
        pytest.param(0.1, QUICK, id="0.1 quick"),
        *(pytest.param(key, FINE_PLATE, id=f"{key}", marks=pytest.mark.full) for key in PLATES),
    ],
)
def test_leaves_as_plates(ratio, accuracy):
    size = 100 * MM
    width = ratio * size
    thickness = SLIGHT * min(width, size)
    found = hinge_compliance(Leaf("m", size, thickness, width), UNIT, accuracy)
    bending, twisting = width * thickness**3 / 12.0, width * thickness**3 / 3.0 / 2.6
    to_tip = transport(np.array([0.5 * size, 0.0, 0.0]))
    tip = to_tip @ found.compliance @ to_tip.T
    factors = [
        found.stiffness[1, 1] * size**3 / (12.0 * bending),
        size**3 / (3.0 * bending * tip[1, 1]),
        size / (bending * found.compliance[5, 5]),
        size / (twisting * found.compliance[3, 3]),
    ]
    expect(factors, PLATES[ratio], 0.01)


NOTCH = Notch("m", 1.54 * MM, 10 * MM, Circular(3 * MM))
"""B12, whose blocks are 10 mm long."""
WHOLE = (2.91198e-6, 3.14493e-5, 4.58567e-6)
ALONE = (1.586e-6, 7.06e-6, 4.306e-6)


def checked_b12(accuracy, tolerance, own, symmetry):
    found = hinge_compliance(NOTCH, STEEL, accuracy, stub=10 * MM)
    whole, alone = (np.diag(each)[[0, 1, 5]] * PER_NEWTON_MM[[0, 1, 5]] for each in (found.whole, found.compliance))
    expect(whole, WHOLE, tolerance)
    expect(alone, ALONE, own)
    scale = np.sqrt(np.diag(found.whole))
    off = found.whole / np.outer(scale, scale) - np.eye(6)
    assert np.max(np.abs(off)) < symmetry


def test_a_notch_in_three_dimensions_quickly():
    """C_y alone is a small difference of lever arms: it has four times the error of the whole."""
    checked_b12(Accuracy(error=0.0, orders=(4, 4), meshes=1), 0.01, 0.04, 1e-3)


@pytest.mark.full
def test_a_notch_in_three_dimensions():
    """B12 to 0.3 %, with its blocks and alone; symmetric as the reference's, whose off-diagonals are below 4e-5."""
    checked_b12(Accuracy(error=0.0, orders=(5, 5), meshes=2), 0.003, 0.003, 1e-4)


@pytest.mark.parametrize("size", [(1, 5, 5), *(pytest.param(size, marks=pytest.mark.full) for size, _, _ in HINGES if size != (1, 5, 5))])
def test_notches_between_rigid_faces_at_the_ends_of_their_arcs(size):
    """All six freedoms against elements of another mesh: 0.3 %. Faces 3 % of R before the ends are up to 1.3 % too stiff."""
    thickness, radius, width = (value * MM for value in size)
    notch = Notch("m", thickness, width, Circular(radius))
    found = np.diag(hinge_compliance(notch, STEEL, CAREFUL, roots=Roots(first=False, second=False)).compliance)
    (stored,) = (elements for each, elements, _ in HINGES if each == size)
    expect(found * PER_NEWTON_MM, stored, 3e-3)


def test_a_specimen_ends_where_its_arcs_do():
    """The faces of a rigid end stand at the profile's ends, and what is blunted there adds next to nothing to the volume."""
    radius, thickness, width = 3.0, 1.0, 4.0
    drawn = specimen(Notch("m", thickness * MM, width * MM, Circular(radius * MM)), (0.0, 0.0), 1.0).solid
    assert [drawn.bounding_box[end].x for end in (0, 1)] == pytest.approx([-radius, radius], abs=1e-6)
    whole = width * (2.0 * radius * (thickness + 2.0 * radius) - np.pi * radius**2)
    assert drawn.mass == pytest.approx(whole, rel=0.02)
