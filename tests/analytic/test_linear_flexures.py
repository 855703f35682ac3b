"""Flexures assembled by hand, at small displacements: parallelogram (reference B7), cross-axis pivot (B8), bridge amplifier (B11).

Leaves of a material that does not contract sideways (nu = 0) are beams; thin ones do not shear.
"""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.beams.compliance import compliance
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.spatial.frame import Frame, transport, turn_z, twist_transform

BEAM = Material(young=70e3, poisson=0.0, density=1.0)


def rigidity(leaf):
    return BEAM.young * leaf.width * leaf.thickness**3 / 12.0


def unsheared(leaf):
    """The leaf's compliance less its shear along y: the beams of Euler and Bernoulli that exact elasticas and frame elements stand for."""
    own = compliance(leaf, BEAM)
    own[1, 1] -= 1.2 * leaf.length / (BEAM.shear * leaf.thickness * leaf.width)
    return own


def seen(own, centre, angle=0.0):
    """The stiffness of a part of compliance `own` for the twist of its second body at the origin."""
    operator = twist_transform(Frame(turn_z(angle), np.array([*centre, 0.0])), np.zeros(3))
    return operator.T @ np.linalg.inv(own) @ operator


def parallelogram(leaf, half_spacing):
    """Two leaves along x, half their spacing `half_spacing` along y; reference point midway between their moving ends."""
    return sum(seen(unsheared(leaf), (-0.5 * leaf.length, side * half_spacing)) for side in (1.0, -1.0))


def test_parallelogram_follows_the_linear_law():
    """Awtar, Slocum & Sevincer 2007 without load terms: f = 24 u_y; u_x = p / 2 d_0; theta = (m + 12 u_y) / 2 w^2 d_0, d_0 = 12 (L/t)^2."""
    leaf, half_spacing = Leaf("m", length=1.0, thickness=1e-4, width=0.01), 0.3
    unit, d0 = rigidity(leaf), 12.0 * 1e8
    compliant = np.linalg.inv(parallelogram(leaf, half_spacing))
    assert compliant[1, 1] * unit * 24.0 == pytest.approx(1.0, rel=1e-7)
    assert compliant[0, 0] * unit * 2.0 * d0 == pytest.approx(1.0, rel=1e-7)
    assert compliant[5, 5] * unit * 2.0 * half_spacing**2 * d0 == pytest.approx(1.0, rel=1e-7)
    assert compliant[5, 1] / compliant[1, 1] * 2.0 * half_spacing**2 * d0 == pytest.approx(12.0, rel=1e-7)


def test_parallelogram_against_the_exact_elastica():
    """First row of the exact table, f = 0.24, d_0 = 30000 (t/L = 0.02): the motion is linear to 0.02 %, the turning to 0.5 %."""
    leaf = Leaf("m", length=1.0, thickness=0.02, width=0.01)
    found = np.linalg.inv(parallelogram(leaf, 0.3)) @ np.array([0.0, 0.24, 0.0, 0.0, 0.0, 0.0]) * rigidity(leaf)
    assert found[1] == pytest.approx(0.01001017, rel=2e-4)
    assert found[5] == pytest.approx(2.2310e-5, rel=5e-3)


@pytest.mark.parametrize("crossing", [0.0, 0.12732, 0.3, 0.5])
@pytest.mark.parametrize("half_angle", [np.pi / 6, np.pi / 4])
def test_cross_axis_pivot_at_zero_load(crossing, half_angle):
    """Wittrick 1951: K_0 = 8 (EI/L) (3 lam^2 - 3 lam + 1), whatever the angle."""
    leaf = Leaf("m", length=1.0, thickness=1e-4, width=0.01)
    offset = 0.5 - crossing
    both = sum(seen(unsheared(leaf), (offset * np.cos(a), offset * np.sin(a)), a) for a in (half_angle, -half_angle))
    pivot = 1.0 / np.linalg.inv(both)[5, 5]
    assert pivot * leaf.length / rigidity(leaf) == pytest.approx(8.0 * (3.0 * crossing**2 - 3.0 * crossing + 1.0), rel=1e-6)


def test_cross_axis_pivot_against_the_exact_elastica():
    """M / phi at phi = 0.01: 2.000033 EI/L for lam = 0.5, 7.999911 for lam = 0."""
    leaf = Leaf("m", length=1.0, thickness=1e-4, width=0.01)
    for crossing, exact in ((0.5, 2.000033), (0.0, 7.999911)):
        offset = (0.5 - crossing) * np.cos(np.pi / 4)
        both = sum(seen(unsheared(leaf), (offset, side * offset), side * np.pi / 4) for side in (1.0, -1.0))
        assert both[5, 5] / rigidity(leaf) == pytest.approx(exact, rel=2e-5)


def bridge(angle, *, shear):
    """Amplification and input stiffness of a quarter bridge: leaf, rigid bar, leaf in line at `angle`, both ends kept from turning."""
    leaf = Leaf("m", length=5.0, thickness=0.5, width=10.0)
    own = compliance(leaf, BEAM) if shear else unsheared(leaf)
    carries = (transport(np.array([side * 12.5, 0.0, 0.0])) for side in (1.0, -1.0))
    chain = np.linalg.inv(sum(carry @ own @ carry.T for carry in carries))[:2, :2]
    turned = turn_z(angle)[:2, :2] @ chain @ turn_z(angle)[:2, :2].T
    amplification = turned[1, 0] / turned[1, 1]
    return abs(amplification), turned[0, 0] - turned[0, 1] * amplification


@pytest.mark.parametrize(("degrees", "exact"), [(6.0, 9.401136), (1.0, 40.0056), (3.0, 18.2064), (10.0, 5.6466)])
def test_bridge_amplifier(degrees, exact):
    """R = s c (c_t - c_a) / (c^2 c_a + s^2 c_t) to the digits printed; the frame elements of the reference do not shear."""
    amplification, _ = bridge(np.deg2rad(degrees), shear=False)
    assert amplification == pytest.approx(exact, abs=0.51 * 10.0 ** -len(str(exact).split(".")[1]))


def test_bridge_amplifier_input_stiffness():
    assert bridge(np.deg2rad(6.0), shear=False)[1] == pytest.approx(416.527, abs=6e-4)


def test_bridge_amplifier_with_shear():
    """The same law with c_t = 2 ((L/2)^3 - (L/2 - l_f)^3) / 3 EI + 2 k l_f / (G A): the leaf's own shear, a thousandth of c_t."""
    inertia, area = 10.0 * 0.5**3 / 12.0, 5.0
    lateral = 2.0 * (15.0**3 - 10.0**3) / (3.0 * BEAM.young * inertia) + 2.0 * 1.2 * 5.0 / (BEAM.shear * area)
    axial, sine, cosine = 10.0 / (BEAM.young * area), np.sin(0.1), np.cos(0.1)
    expected = sine * cosine * (lateral - axial) / (cosine**2 * axial + sine**2 * lateral)
    assert bridge(0.1, shear=True)[0] == pytest.approx(expected, rel=1e-12)


def test_bridge_amplifier_optimum():
    """R is largest at tan^2 a = c_a / c_t: 0.657 degrees."""
    angles = np.deg2rad(np.linspace(0.6, 0.72, 121))
    best = angles[np.argmax([bridge(angle, shear=False)[0] for angle in angles])]
    assert np.rad2deg(best) == pytest.approx(0.657, abs=1.1e-3)
