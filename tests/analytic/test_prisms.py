"""Prismatic parts in closed form: rods, leaves and piezo stacks, with Cowper's shear factors as in SPACAR Light (reference B6)."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.parts.leaf import Leaf
from flexstage.parts.piezo import Piezo
from flexstage.parts.rod import Rod
from tests.analytic.hinges import UNIT, diagonal


def prism(length, area, inertia, rigidity, shear):
    """Timoshenko: L/EA, L^3/12EI + k L/GA, L/GJ, L/EI of a round bar, E = `rigidity`, k / G = `shear`."""
    lateral = length**3 / (12.0 * rigidity * inertia) + shear * length / area
    return length / (rigidity * area), lateral, length / (rigidity * inertia)


def test_rod():
    """k = (7 + 6 nu) / (6 (1 + nu)) = 1.128205 at nu = 0.3; J = 2 I."""
    found = diagonal(Rod("m", length=3.0, diameter=1.0), UNIT)
    axial, lateral, turning = prism(3.0, np.pi / 4.0, np.pi / 64.0, 1.0, 8.8 / 7.8 * 2.6)
    np.testing.assert_allclose(found, (axial, lateral, lateral, 1.3 * turning, turning, turning), rtol=1e-13)


def test_leaf_shear_factor():
    """In its stiff plane a leaf is L^3/12EI + k L/GA, k = (12 + 11 nu) / (10 (1 + nu)) = 1.176923 at nu = 0.3."""
    found = diagonal(Leaf("m", length=3.0, thickness=0.01, width=1.0), UNIT)
    assert found[2] == pytest.approx(27.0 / (12.0 * 0.01 / 12.0) + 15.3 / 13.0 * 2.6 * 3.0 / 0.01, rel=1e-13)


@pytest.mark.parametrize("rigidity", [None, 180.0])
def test_piezo_stack(rigidity):
    """C_x = 1/k; E = k L / A; bending EI of the ceramic or as stated, torsion EI / (1 + nu), shear the ceramic's."""
    stack = Piezo(stroke=1.5e-4, stiffness=17e6, length=0.162, diameter=0.01, poisson=0.25, bending_rigidity=rigidity)
    area = np.pi * 0.01**2 / 4.0
    young = 17e6 * 0.162 / area
    bending = young * np.pi * 0.01**4 / 64.0 if rigidity is None else rigidity
    shear = (7.0 + 6.0 * 0.25) / (6.0 * 1.25) * 2.0 * 1.25 / young
    _, lateral, turning = prism(0.162, area, bending, 1.0, shear)
    np.testing.assert_allclose(diagonal(stack, None), (1.0 / 17e6, lateral, lateral, 1.25 * turning, turning, turning), rtol=1e-13)
