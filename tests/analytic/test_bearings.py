"""Stages without stiffness along their drive, on air or magnetic bearings: x / F = -1 / (m w^2), and the limit of a soft spring."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.apps.cli import run
from flexstage.control.study.choices import Axes, ControllerKind
from flexstage.control.study.setup import ControllerSetup, LoopSetup
from flexstage.control.study.study import loop_study
from flexstage.models.linear.port import ports
from flexstage.models.linear.state_space import state_space
from flexstage.show.tables.overview import floating_line

FORCE, MASS, COIL = 12.0, 2.0, 0.1
STIFF = (1e8, 2e8, 1e5, 2e5, 3e5)
"""Of the film of air: y, z, rx, ry, rz."""
OMEGA = 2.0 * np.pi


def slide(bearing, *, gravity=(0.0, 0.0, -9.81), centre=(0.0, 0.0, 0.0), free=fs.X):
    """A platform on a bearing at the origin, free along or about x, and a coil along it."""
    return fs.Mechanism(
        "slide",
        parts={"bearing": bearing, "coil": fs.VoiceCoil(force_constant=FORCE, peak_current=2.0, resistance=3.0, mass=COIL)},
        bodies={"platform": fs.Body(mass=MASS, centre=centre, inertia=fs.Inertia(4e-3, 5e-3, 6e-3))},
        links={
            "guide": fs.Link(("ground", "platform"), "bearing", (0.0, 0.0, 0.0), free, bends=fs.Z),
            "motor": fs.Link(("ground", "platform"), "coil", (0.0, 0.0, 0.0), fs.X),
        },
        sensors={"scale": fs.Encoder(range=0.05, period=20e-6, steps=4096)},
        gauges={"G": fs.Probe("scale", "platform", fs.Pose((0.05, 0.0, 0.0), fs.X))},
        damping=fs.ModalDamping(0.01),
        gravity=gravity,
    )


def film(along=0.0):
    return fs.Spring(diagonal=(along, *STIFF), free=(fs.Freedom.X,))


@pytest.mark.parametrize("bearing", [fs.Joint((fs.Freedom.X,)), film()])
def test_response_is_that_of_a_free_mass(bearing):
    stage = slide(bearing)
    model, grid = fs.lumped(stage), np.array([0.1, 10.0, 300.0])
    assert fs.check(stage) == ()
    by_hand = -FORCE / ((MASS + COIL) * (OMEGA * grid) ** 2)
    np.testing.assert_allclose(fs.response(model, ["platform.x"], ["motor"], grid).values[:, 0, 0], by_hand, rtol=1e-8)
    np.testing.assert_allclose(
        fs.response(model, ["G"], ["motor"], grid, damping=fs.StructuralDamping()).values[:, 0, 0], by_hand, rtol=1e-6
    )
    rayleigh, w = fs.RayleighDamping(200.0, 0.0), OMEGA * grid  # a force alpha m per velocity
    damped = FORCE / ((MASS + COIL) * (200.0j * w - w**2))
    np.testing.assert_allclose(fs.response(model, ["platform.x"], ["motor"], grid, damping=rayleigh).values[:, 0, 0], damped, rtol=1e-8)
    found = fs.modes(model)
    assert found.frequencies[0] == 0.0
    assert found.names[0] == "x"
    assert found.platform[0] == 0


@pytest.mark.parametrize("law", [fs.ModalDamping(0.01), fs.RayleighDamping(0.4, 1e-5)])
def test_a_mode_at_zero_frequency_has_no_damping_ratio(law):
    """Rayleigh's (alpha / omega + beta omega) / 2 has no limit there; the other modes keep their ratios."""
    model = fs.lumped(slide(film()))
    ratios = state_space(model, ports(model, ["platform.x"], ["motor"]), law).ratios
    assert ratios[0] == 0.0
    assert np.all(ratios[1:] > 0.0)


def test_a_soft_spring_is_the_limit():
    """Modes, response, state space and stiffness tend to those with a spring of 1 N/m along the bearing."""
    model, soft = fs.lumped(slide(film())), fs.lumped(slide(film(1.0)))
    np.testing.assert_allclose(fs.modes(model).frequencies[1:], fs.modes(soft).frequencies[1:], rtol=1e-6)
    grid = np.array([500.0, 2000.0])
    for inputs in (["motor"], ["platform.fz"], ["ground"]):
        one, other = (fs.response(each, ["platform", "G"], inputs, grid).values for each in (model, soft))
        np.testing.assert_allclose(one, other, rtol=1e-5, atol=1e-5 * np.max(np.abs(other)))
    chosen = [(each, ports(each, ["platform.x"], ["motor"])) for each in (model, soft)]
    spaces = [state_space(each, port, fs.ModalDamping(0.01)).transfer(grid) for each, port in chosen]
    np.testing.assert_allclose(*spaces, rtol=1e-5)
    free, held = fs.statics(model), fs.statics(soft)
    assert np.isinf(free.compliance.at("platform.x", "platform.fx"))
    np.testing.assert_allclose(free.stiffness.values, held.stiffness.values, rtol=1e-6, atol=1.0 + 1e-6)


def test_two_masses_vibrate_against_one_another():
    """f = (k (1/m + 1/n))^(1/2) / 2 pi beside the mode at 0 Hz, and x / F = -(k - n w^2) / (w^2 (k (m + n) - m n w^2))."""
    spring, second = 1e6, 0.5
    stage = slide(film())
    across = tuple(10.0 * each for each in STIFF)
    stage = replace(
        stage,
        parts={**stage.parts, "spring": fs.Spring(diagonal=(spring, *across), free=())},
        bodies={**stage.bodies, "second": fs.Body(mass=second, centre=(0.0, 0.0, 0.0), inertia=fs.Inertia(1e-3, 1e-3, 1e-3))},
        links={**stage.links, "spring": fs.Link(("platform", "second"), "spring", (0.0, 0.0, 0.0), fs.X)},
        damping=fs.ModalDamping(0.0),
    )
    model, first = fs.lumped(stage), MASS + COIL
    frequencies = fs.modes(model).frequencies
    assert frequencies[0] == 0.0
    assert np.min(np.abs(frequencies - np.sqrt(spring * (1.0 / first + 1.0 / second)) / OMEGA)) < 1e-6
    grid = np.array([1.0, 100.0, 1000.0])
    square = (OMEGA * grid) ** 2
    by_hand = -FORCE * (spring - second * square) / (square * (spring * (first + second) - first * second * square))
    np.testing.assert_allclose(fs.response(model, ["platform.x"], ["motor"], grid).values[:, 0, 0], by_hand, rtol=1e-6)


def test_a_loop_controls_the_double_integrator():
    found = loop_study(slide(fs.Joint((fs.Freedom.X,))))
    assert found.stability.stable
    assert found.margins is not None
    (own,) = found.margins.channels
    assert all(np.isfinite(each.value) and each.value > 0.0 for each in (own.gain_low, own.gain_high, own.phase, own.delay))


def test_modal_coordinates_need_modes_that_are_not_at_zero():
    asked = LoopSetup(controller=ControllerSetup(kind=ControllerKind.PID, coordinates=Axes.MODAL))
    with pytest.raises(fs.DesignError, match="too few independent modes"):
        loop_study(slide(film()), asked)


def test_undefined_statics_are_named():
    analysis = fs.analyse(slide(film()), whole=False)
    assert analysis.modes is not None
    assert analysis.statics is not None
    assert "without stiffness" in analysis.missing["force_workspace"]
    assert floating_line(analysis.linear) == (
        "Motion along x, driven by motor, has no stiffness: a mode at 0 Hz. "
        "Static stiffness, and strokes under force, are undefined along these axes."
    )


def pendulum():
    """A platform below a bearing about x, turned by a coil above it."""
    turning = fs.Spring(diagonal=(1e8, 1e8, 1e8, 0.0, 1e5, 1e5), free=(fs.Freedom.RX,))
    stage = slide(turning, centre=(0.0, 0.0, -0.02))
    return replace(stage, links={**stage.links, "motor": fs.Link(("ground", "platform"), "coil", (0.0, 0.0, 0.05), fs.Y)}, gauges={})


def undriven():
    """The slide without its coil."""
    stage = slide(film())
    return replace(stage, links={"guide": stage.links["guide"]}, gauges={})


@pytest.mark.parametrize(
    ("stage", "reason"),
    [
        (slide(film(), gravity=(-9.81, 0.0, 0.0)), "no equilibrium exists"),
        (pendulum(), "weight acts as a spring"),
        (undriven(), "singular"),
    ],
    ids=["inclined", "pendulum", "undriven"],
)
def test_stages_that_fall_swing_or_are_not_driven_are_refused(stage, reason):
    with pytest.raises(fs.DesignError, match=reason):
        fs.analyse(stage, whole=False)


def test_mass_along_the_bearing_is_that_of_all_that_moves():
    found = fs.mass_matrix(slide(film()), fs.lumped(slide(film())))
    assert found.reduced is not None
    assert found.reduced.values[0, 0] == pytest.approx(MASS + COIL, rel=1e-9)


def test_the_error_budget_without_stiffness_is_that_of_a_closed_loop(tmp_path, capfd):
    """It names the controller, and its noise is that of the same loop."""
    path = tmp_path / "slide.toml"
    path.write_text(fs.dumps(slide(film())))
    assert run(["budget", str(path)]) == 0
    shown = capfd.readouterr().out
    assert "The drive direction has no stiffness." in shown
    assert "PID in platform coordinates" in shown
    assert "Positioning noise" in shown
    for option, value in (("--input-asd", "motor=1 uA/Hz^0.5"), ("--command", "x=1 um"), ("--temperature", "1 K"), ("--band", "1 Hz 9 Hz")):
        assert run(["budget", str(path), option, *(value.split(" Hz ") if option == "--band" else [value])]) == 2
        assert "error: budget: these options do not apply: the drive direction has no stiffness" in capfd.readouterr().err
