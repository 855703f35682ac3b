"""Leaf springs: plate action and constrained warping against plate elements (reference B6) and a Ritz solution of the thin plate."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.beams.mass import mass
from flexstage.beams.plate import moment_factor, shear_factor
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from tests.analytic.hinges import UNIT, diagonal
from tests.analytic.plate_ritz import factor

# b/L | factors on 12 EI/L^3 (guided), 3 EI/L^3 (tip force), EI/L (moment) | on G b t^3 / 3 L: elements, closed form
TABLE = (
    (0.1, 1.0209, 1.0109, 1.0076, 1.0511, 1.0488),
    (0.2, 1.0376, 1.0206, 1.0150, 1.1073, 1.1027),
    (0.5, 1.0679, 1.0450, 1.0377, 1.3191, 1.3032),
    (2.0, 1.0912, 1.0842, 1.0819, 4.0195, 3.7937),
)
THIN = 1e-6
# width, reinforced thickness of a leaf of 40 x 0.3 mm, 8 mm thin at both ends | C_x, C_y, C_z, C_rx, C_ry, C_rz in N and mm by `flexstage
# solid --scope hinge --accuracy 0.2%` between rigid faces | error of our law in percent
REINFORCED = (
    ((20.0, 3.0), (1.51620e-5, 4.29275e-1, 1.51814e-4, 2.15649e-4, 4.65570e-7, 1.65329e-3), (1.13, -0.29, 1.66, 4.08, -1.20, -0.80)),
    ((8.0, 3.0), (3.89520e-5, 1.09864, 1.81065e-3, 1.60754e-3, 7.37940e-6, 4.23251e-3), (-1.59, -0.66, -0.83, 0.80, -2.60, -1.18)),
    ((20.0, 0.6), (2.29341e-5, 4.45624e-1, 1.86586e-4, 5.79098e-4, 6.96053e-7, 1.99300e-3), (1.74, -0.38, 2.01, -0.97, 0.57, -1.12)),
)


def reinforced_in_mm(width, thick):
    """The leaf of the table."""
    return ReinforcedLeaf("m", 40.0, 0.3, width, flexure_length=8.0, reinforced_thickness=thick)


def leaf(width, thickness=THIN):
    return Leaf("m", length=1.0, thickness=thickness, width=width)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"b/L={row[0]}")
def test_bending_against_plate_elements(row):
    """Within 0.08 %, of factors that span 0.8 to 9 % (the elements' own error at b/L = 0.1 is 0.05 %, see the Ritz solution)."""
    width, guided, tip, moment = row[:4]
    rigidity = width * THIN**3 / 12.0
    found = diagonal(leaf(width), UNIT)
    assert 1.0 / (12.0 * rigidity * found[1]) == pytest.approx(guided, abs=8e-4)
    assert 1.0 / (rigidity * found[5]) == pytest.approx(moment, abs=8e-4)
    assert 1.0 / (3.0 * rigidity * (found[1] + 0.25 * found[5])) == pytest.approx(tip, abs=8e-4)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"b/L={row[0]}")
def test_torsion_is_the_closed_form_and_its_error_is_known(row):
    width, elements, closed = row[0], *row[4:]
    stiffness = 1.0 / diagonal(leaf(width), UNIT)[3] / (UNIT.shear * width * THIN**3 / 3.0)
    assert stiffness == pytest.approx(closed, abs=6e-5)
    assert elements / stiffness - 1.0 == pytest.approx({0.1: 0.0022, 0.2: 0.0042, 0.5: 0.0122, 2.0: 0.0595}[width], abs=1e-4)


@pytest.mark.parametrize("row", TABLE[1:], ids=lambda row: f"b/L={row[0]}")
def test_the_ritz_solution_is_an_authority(row):
    """It meets the plate elements to their last digit."""
    assert factor(row[0], 0.3, guided=True, across=8) == pytest.approx(row[1], abs=2.5e-4)
    assert factor(row[0], 0.3, guided=False, across=8) == pytest.approx(row[3], abs=1e-4)


@pytest.mark.parametrize("poisson", [0.1, 0.3, 0.45])
@pytest.mark.parametrize("width", [0.03, 0.07, 0.15, 0.3, 0.7, 1.4, 3.0, 8.0])
def test_factors_against_the_ritz_solution(width, poisson):
    across, along = (4, 50) if width < 0.1 else (6, 30) if width < 2.0 else (12, 30)
    even = factor(width, poisson, guided=False, across=across, along=along)
    odd = factor(width, poisson, guided=True, across=across, along=along)
    assert moment_factor(1.0 / width, poisson) == pytest.approx(even, rel=6e-4)
    assert shear_factor(1.0 / width, poisson) == pytest.approx(odd, rel=6e-4)


@pytest.mark.parametrize("poisson", [0.0, 0.2, 0.45])
def test_factors_run_from_beam_to_plane_strain(poisson):
    slenderness = np.geomspace(1e-6, 1e8, 57)
    for each in (moment_factor, shear_factor):
        values = each(slenderness, poisson)
        assert values[0] == pytest.approx(1.0 / (1.0 - poisson**2), rel=1e-5)
        assert values[-1] == pytest.approx(1.0, rel=1e-7)
        assert np.all(np.diff(values) <= 1e-15)


def test_without_contraction_a_leaf_is_a_beam():
    """nu = 0: Timoshenko's beam, shear factor 6/5."""
    found = diagonal(leaf(0.5, thickness=0.01), Material(young=1.0, poisson=0.0, density=1.0))
    area, rigidity, across = 0.005, 0.5 * 0.01**3 / 12.0, 0.01 * 0.5**3 / 12.0
    shear = 1.2 / (0.5 * area)
    expected = (1.0 / area, 1.0 / (12.0 * rigidity) + shear, 1.0 / (12.0 * across) + shear, 1.0 / across, 1.0 / rigidity)
    np.testing.assert_allclose(found[[0, 1, 2, 4, 5]], expected, rtol=1e-13)


@pytest.mark.parametrize("width", [0.05, 0.5, 2.0])
def test_a_section_of_a_beam_is_the_frame_element(width):
    """Tension, Timoshenko's bending with Cowper's factor, Saint-Venant's torsion: nothing of the plate, nothing of warping."""
    thickness, nu = 0.02, UNIT.poisson
    area, upright, flat = width * thickness, thickness * width**3 / 12.0, width * thickness**3 / 12.0
    short, long = min(width, thickness), max(width, thickness)
    odd = np.arange(1.0, 400.0, 2.0)
    torsion = short**3 * long / 3.0 * (1.0 - 192.0 / np.pi**5 * short / long * np.sum(np.tanh(0.5 * odd * np.pi * long / short) / odd**5))
    shear = (12.0 + 11.0 * nu) / (10.0 * (1.0 + nu)) / (UNIT.shear * area)
    bending = [1.0 / (12.0 * flat) + shear, 1.0 / (12.0 * upright) + shear]
    expected = [1.0 / area, *bending, 1.0 / (UNIT.shear * torsion), 1.0 / upright, 1.0 / flat]
    found = diagonal(Leaf("m", length=1.0, thickness=thickness, width=width, section=LeafSection.BEAM), UNIT)
    np.testing.assert_allclose(found * UNIT.young, expected, rtol=1e-11)


def reinforced(thick, width=2.0, thickness=0.01, fillet=None, section=LeafSection.PLATE):
    """A leaf of length 1, thin over 0.2 at both ends."""
    return ReinforcedLeaf("m", 1.0, thickness, width, section, flexure_length=0.2, reinforced_thickness=thick, fillet=fillet)


def in_series(thin, middle):
    """Two thin pieces of length 0.2, 0.4 away from the centre, and a middle: diagonals about the centre."""
    arm = np.array([0.0, thin[5], thin[4], 0.0, 0.0, 0.0])
    return 2.0 * (thin + 0.16 * arm) + middle


@pytest.mark.parametrize("thick", [0.01, 0.03, 0.5])
def test_a_reinforced_leaf_is_three_beams_in_series(thick):
    pieces = (Leaf("m", length, each, 2.0, LeafSection.BEAM) for length, each in ((0.2, 0.01), (0.6, thick)))
    found = diagonal(reinforced(thick, section=LeafSection.BEAM), UNIT)
    np.testing.assert_allclose(found, in_series(*(diagonal(piece, UNIT) for piece in pieces)), rtol=1e-12)


def test_a_rigid_middle_leaves_two_plates():
    """Of a vanishing thickness: the torsion of stouter ones has shear besides."""
    found = diagonal(reinforced(1e3 * THIN, thickness=THIN), UNIT)
    expected = in_series(diagonal(Leaf("m", 0.2, THIN, 2.0), UNIT), 0.0)
    np.testing.assert_allclose(found[[1, 3, 5]], expected[[1, 3, 5]], rtol=1e-5)


def test_a_fillet_stiffens_and_has_its_mass():
    square, rounded = reinforced(0.1), reinforced(0.1, fillet=0.04)
    assert np.all(diagonal(rounded, UNIT) < diagonal(square, UNIT))
    np.testing.assert_allclose(diagonal(reinforced(0.1, fillet=1e-9), UNIT), diagonal(square, UNIT), rtol=1e-6)
    volume = 2.0 * (0.4 * 0.01 + 0.6 * 0.1 + 4.0 * 0.04**2 * (1.0 - 0.25 * np.pi))
    whole = mass(rounded, UNIT)
    assert whole[0, 0] + 2.0 * whole[0, 6] + whole[6, 6] == pytest.approx(volume, rel=1e-12)


@pytest.mark.parametrize("row", REINFORCED, ids=lambda row: f"{row[0]}")
def test_reinforced_leaves_are_as_wrong_as_recorded(row):
    size, elements, stated = row
    np.testing.assert_allclose(100.0 * (diagonal(reinforced_in_mm(*size)) / elements - 1.0), stated, atol=0.012)
