"""Hinges of the two self-consistent sets of the paper's stage, to the digits printed (reference A5, A6). N, mm; E = 200 GPa, nu = 0.3."""

from __future__ import annotations

import pytest

from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular, Straight
from tests.analytic.hinges import diagonal

TORQUES = (
    ("A front", Notch("m", thickness=0.85, width=11.0, profile=Circular(5.0)), 47390),
    ("A lever", Notch("m", thickness=1.0, width=60.0, profile=Circular(5.0)), 389611),
    ("A lever, simplest variant", Notch("m", thickness=1.0, width=30.0, profile=Circular(5.0)), 194806),
    ("A pole", Neck("m", thickness=2.37, profile=Circular(14.367)), 54757),
    ("B front", Notch("m", thickness=0.85, width=14.9, profile=Circular(5.0)), 64192),
    ("B lever", Notch("m", thickness=1.0, width=50.3, profile=Circular(2.0)), 537548),
    ("B pole", Neck("m", thickness=2.37, profile=Circular(8.0)), 74151),
)
AXIAL = (
    ("A neck", Neck("m", thickness=1.54, profile=Circular(14.367)), 1, 52.27, 2),
    ("A front", TORQUES[0][1], 1, 400.1, 1),
    ("A pole, two necks", TORQUES[3][1], 2, 50.79, 2),
    ("B neck", Neck("m", thickness=1.54, width=2.246, profile=Straight(13.235)), 1, 52.268, 3),
    ("B front", TORQUES[4][1], 1, 541.9, 1),
    ("B pole, two necks", TORQUES[6][1], 2, 70.659, 3),
)


@pytest.mark.parametrize(("name", "hinge", "printed"), TORQUES, ids=lambda each: each if isinstance(each, str) else "")
def test_rotational_stiffness(name, hinge, printed):
    assert 1.0 / diagonal(hinge)[5] == pytest.approx(printed, abs=0.6)


@pytest.mark.parametrize(("name", "hinge", "count", "printed", "digits"), AXIAL, ids=lambda each: each if isinstance(each, str) else "")
def test_axial_stiffness(name, hinge, count, printed, digits):
    """In N/um; `count` equal necks in series."""
    assert 1e-3 / (count * diagonal(hinge)[0]) == pytest.approx(printed, abs=0.51 * 10.0**-digits)
