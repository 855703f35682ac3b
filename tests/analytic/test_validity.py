"""What the hinges say of their own error, against the tables it was taken from and against those it was not (reference B1-B4, B6)."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.beams.validity import validity
from flexstage.parts.given import Joint
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
def test_circular_notches(row):
    expected = validity(circular(row[0])).errors
    found = diagonal(circular(row[0]), UNIT)
    for component, index, elements in (("rz", 5, row[1]), ("x", 0, row[5]), ("y", 1, row[7])):
        assert 100.0 * float(expected[component]) == pytest.approx(error(found[index], elements), abs=0.01)


@pytest.mark.parametrize("row", TOROIDS, ids=lambda row: f"t/R={row[0]}")
def test_toroids(row):
    part = Neck("m", thickness=row[0], profile=Circular(1.0))
    expected, found = validity(part).errors, diagonal(part, UNIT)
    for component, index, elements in (("rz", 5, row[1]), ("x", 0, row[4])):
        assert 100.0 * float(expected[component]) == pytest.approx(error(found[index], elements), abs=0.01)


@pytest.mark.parametrize("row", FILLETED)
def test_fillets_are_predicted_from_circles(row):
    """Within 1 % of the compliance; their own table was not used."""
    expected = validity(Notch("m", thickness=row[2], width=10.0, profile=Filleted(row[0], row[1]))).errors
    for component, stated in (("rz", row[4]), ("x", row[6]), ("y", row[8])):
        assert 100.0 * float(expected[component]) == pytest.approx(stated, abs=1.0)


@pytest.mark.parametrize("row", ELLIPTIC)
def test_ellipses_are_predicted_from_circles(row):
    expected = validity(Notch("m", thickness=row[2], width=10.0, profile=Elliptic(row[0], row[1]))).errors
    for component, stated in (("rz", row[4]), ("x", row[6])):
        assert 100.0 * float(expected[component]) == pytest.approx(stated, abs=0.5)


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
    assert "given" in finding.advice


def test_a_batch_names_its_first_design_outside():
    (finding,) = validity(circular(np.array([0.1, 0.9, 1.0])), "B4/pivot").findings
    assert finding.where == "B4/pivot[1]"
    assert "0.9" in finding.what


def test_parts_that_are_stated_have_no_error():
    found = validity(Joint())
    assert not found.ranges
    assert not found.errors
    assert not found.findings
