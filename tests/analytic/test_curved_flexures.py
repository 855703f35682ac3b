"""Flexures that are not straight when free, bent blanks and leaves warm on one side, against closed forms."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy

import flexstage as fs
from flexstage.base.finding import DesignError
from flexstage.base.units.scale import Z
from flexstage.beams.flexure.law import Resolution
from flexstage.mechanism.mechanism import Link
from flexstage.models.linear.static import static_gain
from flexstage.models.nonlinear.elements.strain import strains
from flexstage.models.nonlinear.stage import nonlinear
from flexstage.spatial.frame import COMPONENTS, FORCES
from tests.analytic.test_large_displacements import RIGIDITY, SOFT, THIN, body, cantilever, stage

CURVATURES = np.array([0.3, -1.0, 0.5 * np.pi])
WIDE = fs.Leaf("soft", length=1.0, thickness=5e-3, width=0.2)
FINE = Resolution(8, 8, 10, points=14)
WARM = replace(SOFT, expansion=1e-3)


@pytest.mark.parametrize("leaf", [THIN, WIDE, fs.Rod("soft", length=1.0, diameter=5e-3)])
def test_a_free_blank_takes_its_circle(leaf: Any) -> None:
    """Its end lies at (sin k L / k, (1 - cos k L) / k), turned by k L, without any strain: of a plate too, which curves one way only."""
    for curvature in CURVATURES:
        state = fs.equilibrium(cantilever(replace(leaf, curvature=float(curvature))))
        place = [np.sin(curvature) / curvature - 1.0, (1.0 - np.cos(curvature)) / curvature, 0.0, 0.0, 0.0, curvature]
        np.testing.assert_allclose(state.twist(), place, atol=2e-9)
        assert float(np.max(strains(state).largest)) < 1e-11


def test_a_curved_cantilever_under_a_force_at_its_end() -> None:
    """E I theta'' = -F cos theta, theta(0) = 0, theta'(L) = k, solved as a boundary value problem."""
    for curvature, force in ((1.0, 3.0), (0.5 * np.pi, -2.0), (-0.7, 5.0)):
        places = np.linspace(0.0, 1.0, 41)
        found = scipy.integrate.solve_bvp(
            lambda _, y, f=force: np.array([y[1], -f * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]),
            lambda a, b, k=curvature: np.array([a[0], a[2], a[3], b[1] - k]),
            places,
            np.stack([curvature * places, 0.0 * places + curvature, places, 0.0 * places]),
            tol=1e-10,
            max_nodes=20000,
        )
        state = fs.equilibrium(cantilever(replace(THIN, curvature=curvature)), {"platform.fy": force * RIGIDITY})
        expected = [found.y[2, -1] - 1.0, found.y[3, -1], found.y[0, -1]]
        assert state.twist()[[0, 1, 5]] == pytest.approx(expected, abs=1e-7)


def test_tip_flexibilities_of_a_circular_beam() -> None:
    """Of a quarter circle by Castigliano's theorem, thin: pi/4, 3 pi/4 - 2 and -1/2 times R^3 / (E I) in its plane.

    And R^3 (pi/4 / (E I_y) + (3 pi/4 - 2) / (G J)) out of it (S. Timoshenko, Strength of Materials I, 1955, 79 to 81).
    """
    model = cantilever(replace(THIN, curvature=0.5 * np.pi))
    about = fs.linearise(fs.equilibrium(model))
    found = static_gain(about, tuple(f"platform.{name}" for name in COMPONENTS), tuple(f"platform.{name}" for name in FORCES)).values
    law, radius = model.flexures[0].law, 2.0 / np.pi
    twist, wide, bend = (law.form[0, place, place] / float(law.rigidity[0]) for place in (0, 6, 12))  # a beam's modes are of stress
    square, other = 0.25 * np.pi, 0.75 * np.pi - 2.0
    assert found[0, 0] == pytest.approx(bend * radius**3 * square, rel=1e-6)
    assert found[1, 1] == pytest.approx(bend * radius**3 * other, rel=1e-6)
    assert found[0, 1] == pytest.approx(-0.5 * bend * radius**3, rel=1e-6)
    assert found[5, 5] == pytest.approx(bend, rel=1e-6)
    assert found[2, 2] == pytest.approx(radius**3 * (wide * square + twist * other), rel=1e-6)


def test_a_leaf_that_is_warm_on_one_side() -> None:
    """As a beam it is a blank of curvature -alpha dT / t; both ends clamped it pushes with E I alpha dT / t and stays straight."""
    warm, held = replace(THIN, face_temperature_difference=3e-2), {f"platform.{name}": 0.0 for name in ("x", "y", "z", "rx", "ry", "rz")}
    curvature = -1e-3 * 3e-2 / 3e-5
    free = fs.equilibrium(cantilever(warm, WARM))
    np.testing.assert_allclose(free.twist(), fs.equilibrium(cantilever(replace(THIN, curvature=curvature))).twist(), atol=1e-12)
    clamped = fs.equilibrium(cantilever(warm, WARM), hold=held)
    np.testing.assert_allclose(clamped.reactions[5], -curvature * RIGIDITY, rtol=1e-9)


def test_a_wide_leaf_that_is_warm_on_one_side_curves_both_ways() -> None:
    """A plate free of its clamps has k = a2 = -alpha dT / t where Gaussian curvature costs little; a clamp keeps it from curving across."""
    small = replace(WIDE, width=0.1, face_temperature_difference=5e-5)
    curvature = -1e-3 * 5e-5 / 5e-3
    state = fs.equilibrium(cantilever(small, WARM))
    turned = float(state.rotation()[2])
    assert 1.001 < turned / curvature < 1.0 + 0.3 * 0.1  # a strip of about its width at each end bends by up to 1 + nu
    held = {f"platform.{name}": 0.0 for name in ("x", "y", "z", "rx", "ry", "rz")}
    clamped = fs.equilibrium(cantilever(small, WARM), hold=held)
    moment = float(clamped.reactions[5])
    assert 1.001 < moment / (-curvature * 0.1 * 5e-3**3 / 12.0) < 1.0 / (1.0 - 0.3)
    along = 6.0 * moment / (0.1 * 5e-3**2)
    over = 0.5 * 1e-3 * 5e-5 + 0.3 * along  # a clamp keeps the section straight: E alpha dT / 2 and what bending adds
    np.testing.assert_allclose(strains(clamped).stress, np.sqrt(along**2 + over**2 - along * over), rtol=0.03)


@pytest.mark.parametrize(
    "leaf", [replace(THIN, curvature=1.2), replace(WIDE, face_temperature_difference=0.5), replace(WIDE, curvature=-0.8)]
)
def test_the_order_of_ends_does_not_matter(leaf: fs.Leaf) -> None:
    """Drawn from the other end its y axis is reversed, and with it the sign of its curvature."""
    turned = replace(
        leaf, **{name: -value for name in ("curvature", "face_temperature_difference") if (value := getattr(leaf, name)) is not None}
    )
    drawn = stage(
        leaf, {"platform": body(1.0, 0.0, 0.0)}, {"leaf": Link(("ground", "platform"), "leaf", (0.5, 0, 0), (1.0, 0, 0), bends=Z)}, WARM
    )
    other = Link(("platform", "ground"), "leaf", (0.5, 0, 0), (-1.0, 0, 0), bends=Z)
    reverse = stage(turned, {"platform": body(1.0, 0.0, 0.0)}, {"leaf": other}, WARM)
    size = float(nonlinear(drawn).flexures[0].law.rigidity[0])
    loads = {"platform.fy": 2.0 * size, "platform.fz": 3.0 * size, "platform.fx": -size}
    assert leaf.mirrored.mirrored == leaf
    assert leaf.mirrored == turned
    one, two = (fs.equilibrium(nonlinear(each, resolution=FINE), loads).twist() for each in (drawn, reverse))
    np.testing.assert_allclose(one, two, atol=1e-8)


def test_warmth_needs_an_expansion() -> None:
    with pytest.raises(DesignError, match="expansion"):
        cantilever(replace(WIDE, face_temperature_difference=1.0))
