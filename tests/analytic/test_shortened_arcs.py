"""What stopping an arc short of the end face changes, by the beam integrals of the section (no FEA)."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("netgen")

from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular
from flexstage.solid.fea.geometry.draw import draw_form
from flexstage.solid.fea.geometry.hinge_edge import SHORTENED

SHIPPED = {"foot_notch": (5.0, 0.85), "lever_notch": (2.0, 1.0), "B12": (3.0, 1.54)}


def integral(radius: float, thickness: float, power: int, shortened: float) -> float:
    """int dx / h^power over the notch, h jumping to full height where the arc has stopped."""
    reach = np.arcsin(1.0 - shortened)
    points, weights = np.polynomial.legendre.leggauss(400)
    angle = reach * points
    height = thickness + 2.0 * radius * (1.0 - np.cos(angle))
    within = np.sum(weights * reach * radius * np.cos(angle) / height**power)
    return float(within + 2.0 * shortened * radius / (thickness + 2.0 * radius) ** power)


@pytest.mark.parametrize("name", SHIPPED)
def test_stopping_the_arc_short_hardly_changes_the_hinge(name):
    """Axial compliance by at most 0.15 %, bending by at most 0.04 %."""
    radius, thickness = SHIPPED[name]
    axial, bending = (integral(radius, thickness, power, SHORTENED) / integral(radius, thickness, power, 0.0) - 1.0 for power in (1, 3))
    assert -1.5e-3 < axial < 0.0
    assert -4e-4 < bending < 0.0


@pytest.mark.parametrize("name", SHIPPED)
def test_the_drawn_solid_is_the_shortened_one(name):
    """Its volume is the section's integral, arc and stop included."""
    radius, thickness = SHIPPED[name]
    notch = Notch("steel", thickness=thickness * 1e-3, width=10e-3, profile=Circular(radius * 1e-3))
    assert draw_form(notch).mass == pytest.approx(10.0 * integral(radius, thickness, -1, SHORTENED), rel=1e-9)
