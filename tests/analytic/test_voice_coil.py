"""A voice coil on a leaf parallelogram of one freedom, by hand: x/i = k_f / (k - m w^2 + j w c), c = c_own + k_f^2/R."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.response import response
from flexstage.base.scale import X, Z, mm
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, ModalDamping, StructuralDamping
from flexstage.mechanism.restrict import restrict
from flexstage.models.ideal import ideal
from flexstage.models.linear.damping import modal_ratios
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.port import ports
from flexstage.models.linear.state_space import state_space
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.freedom import Freedom
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.voice_coil import Drive, VoiceCoil

YOUNG, LENGTH, THICKNESS, WIDTH = 200e9, 50 * mm, 0.4 * mm, 20 * mm
COIL = VoiceCoil(force_constant=12.0, resistance=6.0, mass=0.1, magnet_mass=0.4, damping=0.5)
MASS = 0.9
"""Of the platform without the coil [kg]; the magnet stands on the ground."""


UNDAMPED = ModalDamping(0.0)


def stage(coil=COIL, damping=UNDAMPED):
    """Two leaves along y, 60 mm apart, let the platform move along x; nothing else of them gives way."""
    leaf = Leaf("steel", length=LENGTH, thickness=THICKNESS, width=WIDTH)
    links = {
        name: Link((GROUND, PLATFORM), "leaf", (at, 0.5 * LENGTH, 0.0), (0.0, -1.0, 0.0), bends=Z)
        for name, at in (("left", -30 * mm), ("right", 30 * mm))
    }
    whole = Mechanism(
        name="voice coil on a parallelogram",
        materials={"steel": Material(young=YOUNG, poisson=0.3, density=7800.0)},
        parts={"leaf": leaf, "coil": coil},
        bodies={PLATFORM: Body(mass=MASS, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-3, 1e-3, 1e-3))},
        links=links | {"motor": Link((GROUND, PLATFORM), "coil", (-40 * mm, 0.0, 0.0), X)},
        damping=damping,
    )
    return restrict(whole, {"leaf": ((Freedom.Y,), ())})


def by_hand(model, frequencies, coil=COIL, damped=None):
    """x/i in m/A, with the stiffness of the model's own statics."""
    stiffness = 1.0 / static_gain(model, ("platform.x",), ("platform.fx",)).values.item()
    omega = 2.0 * np.pi * frequencies
    damper = coil.damping if damped is None else damped
    return coil.force_constant / (stiffness - (MASS + coil.mass) * omega**2 + 1j * omega * damper)


def test_force_map_and_static_motion_per_ampere():
    """Leaves between parallel faces: 12 E I / L^3 each, as plates in bending E / (1 - nu^2) at most; 12 N/A along x."""
    found, model = ideal(stage()), lumped(stage())
    assert found.force_map.values.tolist() == [[12.0]]
    assert (found.force_map.rows, found.force_map.columns, found.force_map.unit) == (("fx",), ("motor",), (("N/A",),))
    beam = 2.0 * YOUNG * WIDTH * THICKNESS**3 / LENGTH**3
    per_ampere = static_gain(model, ("platform.x",), ("motor",))
    assert per_ampere.unit == (("m/A",),)
    assert COIL.force_constant / beam * (1.0 - 0.3**2) < per_ampere.values.item() < COIL.force_constant / beam * 1.001


def test_bode_plot_current_drive():
    """The whole curve, its resonance at sqrt(k/m) / (2 pi) of the coil's mass too, and -40 dB a decade above."""
    model = lumped(stage())
    natural = float(np.sqrt(eigen(model).values[0])) / (2.0 * np.pi)
    grid = natural * np.array([1e-3, 0.3, 0.99, 1.0, 1.01, 3.0, 100.0, 1000.0])
    found = response(model, ("platform.x",), ("motor",), grid).at("platform.x", "motor")
    assert found == pytest.approx(by_hand(model, grid), rel=1e-9)
    assert np.abs(found[-2] / found[-1]) == pytest.approx(100.0, rel=1e-3)
    assert np.abs(found[3]) == pytest.approx(COIL.force_constant / (2.0 * np.pi * natural * COIL.damping), rel=1e-9)


def test_bode_plot_voltage_drive():
    """Back-EMF adds k_f^2/R = 24 N s/m to the 0.5 N s/m of the coil, and the ratio c / (2 sqrt(k m)) is that of the mode."""
    coil = replace(COIL, drive=Drive.VOLTAGE)
    assert coil.viscous_damping == 24.5
    model = lumped(stage(coil))
    grid = np.array([0.1, 3.0, 7.0, 20.0, 300.0])
    expected = by_hand(model, grid, coil, damped=24.5)
    assert response(model, ("platform.x",), ("motor",), grid).at("platform.x", "motor") == pytest.approx(expected, rel=1e-9)
    stiffness = 1.0 / static_gain(model, ("platform.x",), ("platform.fx",)).values.item()
    ratio = 24.5 / (2.0 * np.sqrt(stiffness * (MASS + coil.mass)))
    assert modal_ratios(model, eigen(model), ModalDamping(0.0)) == pytest.approx([ratio], rel=1e-9)
    chosen = ports(model, ("platform.x",), ("motor",))
    assert state_space(model, chosen, ModalDamping(0.0)).transfer(grid)[:, 0, 0] == pytest.approx(expected, rel=1e-9)


def test_magnets_and_structural_damping():
    """Negative magnetic stiffness lowers the stage's, and the loss factor of steel turns with the coil's own damping."""
    steel = replace(stage().materials["steel"], loss_factor=0.02)
    pulling = replace(COIL, stiffness=-1000.0)
    plain, pulled = (replace(stage(coil, StructuralDamping()), materials={"steel": steel}) for coil in (COIL, pulling))
    stiffness = [1.0 / static_gain(lumped(each), ("platform.x",), ("platform.fx",)).values.item() for each in (plain, pulled)]
    assert stiffness[1] - stiffness[0] == pytest.approx(-1000.0, rel=1e-9)
    omega = 2.0 * np.pi * 5.0
    expected = 12.0 / (stiffness[1] + 0.02j * stiffness[0] - 1.0 * omega**2 + 0.5j * omega)
    found = response(lumped(pulled), ("platform.x",), ("motor",), np.array([5.0])).at("platform.x", "motor")
    assert found == pytest.approx([expected], rel=1e-9)


def test_the_magnet_may_move():
    """With the coil on the ground the magnet's mass goes with the platform."""
    moving = lumped(stage(replace(COIL, coil=COIL.coil.FIRST)))
    fixed = lumped(stage())
    ratio = eigen(fixed).values[0] / eigen(moving).values[0]
    assert ratio == pytest.approx((MASS + COIL.magnet_mass) / (MASS + COIL.mass), rel=1e-9)
