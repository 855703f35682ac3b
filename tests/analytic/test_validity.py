"""What the hinges say of their own error, against the tables it was taken from and against those it was not (reference B1-B4, B6)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.beams.validity import validity
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular, Elliptic, Straight
from flexstage.parts.rod import Rod
from tests.analytic.hinges import UNIT, circular, diagonal, error
from tests.analytic.test_notch_profiles import ELLIPTIC, FILLETED, Filleted
from tests.analytic.test_paros_weisbord import TABLE as NOTCHES
from tests.analytic.test_smith_toroid import TABLE as TOROIDS


@pytest.mark.parametrize("row", NOTCHES, ids=lambda row: f"t/R={row[0]}")
def test_narrow_notches_are_in_plane_stress(row):
    """As wide as thick: bending within 0.6 %; along x, where B1's shorter blocks yield 1 to 3 % less, up to 3 %."""
    expected = validity(circular(row[0], width=row[0])).errors
    found = diagonal(circular(row[0]), UNIT)
    for component, index, elements, tolerance in (("rz", 5, row[1], 0.6), ("x", 0, row[5], 0.4 + 4.0 * row[0])):
        assert 100.0 * float(expected[component]) == pytest.approx(error(found[index], elements), abs=tolerance)


@pytest.mark.parametrize("row", TOROIDS, ids=lambda row: f"t/R={row[0]}")
def test_toroids(row):
    """Bending within 0.3 %; along x up to 0.6 %: the reference does not state its blocks."""
    part = Neck("m", thickness=row[0], profile=Circular(1.0))
    expected, found = validity(part).errors, diagonal(part, UNIT)
    for component, index, elements, tolerance in (("rz", 5, row[1], 0.3), ("x", 0, row[4], 0.2 + 0.8 * row[0])):
        assert 100.0 * float(expected[component]) == pytest.approx(error(found[index], elements), abs=tolerance)


@pytest.mark.parametrize("row", FILLETED[1:2])
def test_narrow_fillets_are_in_plane_stress(row):
    expected = validity(Notch("m", thickness=row[2], width=row[2], profile=Filleted(row[0], row[1]))).errors
    for component, stated in (("rz", row[4]), ("x", row[6])):
        assert 100.0 * float(expected[component]) == pytest.approx(stated, abs=1.0)


@pytest.mark.parametrize("row", ELLIPTIC)
def test_narrow_ellipses_are_in_plane_stress(row):
    expected = validity(Notch("m", thickness=row[2], width=row[2], profile=Elliptic(row[0], row[1]))).errors
    for component, stated in (("rz", row[4]), ("x", row[6]), ("y", row[8])):
        assert 100.0 * float(expected[component]) == pytest.approx(stated, abs=1.0)


def test_thin_hinges_follow_the_root_of_the_ratio():
    """The roots yield as much under a thin hinge as under a thick one, and a thin one yields as the root of R/t."""
    thin, thick = (float(validity(circular(ratio, width=ratio)).errors["x"]) for ratio in (0.02, 0.08))
    assert thin == pytest.approx(-0.07, abs=0.005)
    assert 1.6 < thick / thin < 2.0


def test_the_errors_depend_on_the_material():
    """Contraction that clamped ends prevent goes with the square of Poisson's ratio."""
    leaf = Leaf("m", length=1.0, thickness=0.01, width=1.0)
    low, high = (float(validity(leaf, material=replace(UNIT, poisson=poisson)).errors["x"]) for poisson in (0.2, 0.4))
    assert high / low == pytest.approx(4.0, rel=0.05)


def test_a_square_leaf_is_stiffer_along_its_plane():
    """Clamped ends hold its contraction: elements have 2.5 % less compliance along x and 2.7 % along z."""
    errors = validity(Leaf("m", length=1.0, thickness=0.01, width=1.0)).errors
    assert 100.0 * float(errors["x"]) == pytest.approx(2.5, abs=0.3)
    assert 100.0 * float(errors["z"]) == pytest.approx(2.7, abs=0.3)


def test_outside_of_what_was_compared_nothing_is_stated():
    """Nor along z and about x of a notch on blocks; a batch has no number there."""
    assert "z" not in validity(circular(0.2)).errors
    assert "rx" not in validity(circular(0.2)).errors
    assert not validity(circular(1.2)).errors


def test_no_error_is_stated_for_a_neck_thicker_than_wide():
    """With its sides exchanged, the law of a bar would take plate action across the wrong side, and miss the error by 1.4 %."""
    flat, upright = (Neck("m", thickness=sides[0], width=sides[1], profile=Straight(30.0)) for sides in ((1.0, 10.0), (10.0, 1.0)))
    assert float(validity(flat).errors["y"]) == pytest.approx(0.05, abs=0.002)
    assert not validity(upright).errors
    assert not validity(circular(0.2), material=replace(UNIT, poisson=0.49)).errors
    found = validity(circular(np.array([0.2, 1.2]))).errors["x"]
    assert np.isnan(found).tolist() == [False, True]


@pytest.mark.parametrize("poisson", [0.25, 0.33])
@pytest.mark.parametrize(
    "profile", [Circular(1.0), Elliptic(1.0, 0.5), Filleted(2.0, 1.0), Straight(1.0)], ids=lambda each: type(each).__name__
)
def test_wide_thin_hinges_bend_in_plane_strain(profile, poisson):
    """Their limit is closed: 1 - nu^2 of the compliance of beam theory. It is a finding, of a batch for its worst design."""
    width = np.array([0.01, 1e3])
    found = validity(Notch("m", 1e-5 if profile != Straight(1.0) else 1e-2, width, profile), "hinge", replace(UNIT, poisson=poisson))
    narrow, wide = 1.0 / (1.0 + found.errors["rz"])
    assert wide == pytest.approx(1.0 - poisson**2, abs=2e-3)
    assert wide < narrow <= 1.001
    (finding,) = found.findings
    assert finding.where == "hinge"
    assert f"1 - nu^2 = {1.0 - poisson**2:.3g}" in finding.what
    assert f"{100.0 / (1.0 - poisson**2) - 100.0:.2g} % too soft" in finding.what


OUTSIDE = (
    (Notch("m", thickness=1.2, width=10.0, profile=Circular(1.0)), "thickness over radius = 1.2 is above 0.8"),
    (Notch("m", thickness=1.0, width=0.5, profile=Circular(5.0)), "width over thickness = 0.5 is below 1"),
    (Notch("m", thickness=1.0, width=5.0, profile=Elliptic(2.0, 4.0)), "thickness over radius at the throat = 1 is above 0.8"),
    (Notch("m", thickness=1.0, width=5.0, profile=Filleted(10.0, 0.5)), "thickness over radius = 2 is above 1"),
    (Notch("m", thickness=1.0, width=5.0, profile=Straight(2.0)), "length over thickness = 2 is below 3"),
    (Neck("m", thickness=0.6, profile=Circular(1.0)), "thickness over radius = 0.6 is above 0.5"),
    (Leaf("m", length=20.0, thickness=1.0, width=4.0), "thickness over width = 0.25 is above 0.2"),
    (Rod("m", length=4.0, diameter=1.0), "length over diameter = 4 is below 5"),
)


@pytest.mark.parametrize(("part", "words"), OUTSIDE)
def test_advice_outside_the_range(part, words):
    (finding,) = validity(part, "B4/pivot").findings
    assert finding.where == "B4/pivot"
    assert words in finding.what
    assert "compliance_matrix" in finding.advice


def test_a_batch_names_its_first_design_outside():
    (finding,) = validity(circular(np.array([0.1, 0.9, 1.0])), "B4/pivot").findings
    assert finding.where == "B4/pivot[1]"
    assert "0.9" in finding.what


def test_parts_that_are_stated_have_no_error():
    found = validity(Joint())
    assert not found.ranges
    assert not found.errors
    assert not found.findings


@pytest.mark.parametrize(
    ("part", "shortest"),
    [
        (lambda length: Rod("m", length=length, diameter=1.0), 3.0),
        (lambda length: Notch("m", thickness=1.0, width=1.0, profile=Straight(length)), 3.0),
        (lambda length: Leaf("m", length=length, thickness=1.0, width=5.0), 10.0),
    ],
    ids=["rod", "straight", "leaf"],
)
def test_parts_shorter_than_those_compared_have_no_error(part, shortest):
    """Rods and straight notches were compared from three thicknesses of length on, leaves from ten; torsion of a round rod is exact."""
    assert validity(part(0.99 * shortest)).errors.keys() <= {"rx"}
    assert {"x", "rz"} <= validity(part(1.01 * shortest)).errors.keys()
