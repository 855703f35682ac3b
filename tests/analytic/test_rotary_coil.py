"""A coil that drives a rotation: angle, lever, damping, limits and heat by closed form; mirrored; through file, rig, budget and loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.budget import budget
from flexstage.analysis.assessment.judge import judge
from flexstage.analysis.workspace.force_workspace import force_workspace
from flexstage.base.finding import DesignError
from flexstage.control.study.resolve import resolve
from flexstage.control.study.setup import LoopSetup
from flexstage.experiment.virtual_rig.inputs import InputQuantity
from flexstage.experiment.virtual_rig.rig import rig
from flexstage.experiment.virtual_rig.setup import NoiseDrive, RigSetup
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.damping import modal_ratios
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.frequency import transfer
from flexstage.models.linear.port import ports
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.stage import nonlinear
from flexstage.parts.force_actuator import ForceActuator
from flexstage.parts.rotary_coil import RotaryCoil
from flexstage.parts.voice_coil import Supply

TORQUE, ARM = 0.2, 0.03
COIL = RotaryCoil(
    torque_constant=TORQUE,
    peak_current=2.0,
    continuous_current=0.7,
    resistance=5.0,
    voltage=6.0,
    inductance=1e-3,
    maximum_torque=0.3,
    angular_travel=0.1,
    thermal_resistance=4.0,
    temperature_rise=40.0,
)
TWIST = tuple(f"platform.{name}" for name in ("x", "y", "z", "rx", "ry", "rz"))


def turned(coil: RotaryCoil = COIL, **changes: object) -> Mechanism:
    """The tilt stage, turned about its axis by a rotary coil in the place of its voice coil, which pushes on an arm."""
    stage = fs.case("tilt-stage")
    links = {**stage.links, "motor": Link((GROUND, PLATFORM), "coil", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))}
    return replace(stage, parts={**stage.parts, "coil": coil}, links=links, **changes)


def test_the_angle_is_torque_over_stiffness() -> None:
    model = lumped(turned())
    found = static_gain(model, TWIST, ("motor", "platform.mz")).values
    np.testing.assert_allclose(found[:, 0], TORQUE * found[:, 1], rtol=1e-9, atol=1e-15)
    assert ideal(turned()).thrust.ravel() == pytest.approx([TORQUE])


def test_a_torque_is_two_opposite_forces_on_arms() -> None:
    """F = T/(2 r), at any frequency; on the ground both pairs meet in nothing that moves."""
    lines = np.array([0.0, 5.0, 300.0])
    whole = turned()
    pair = {
        name: Link((GROUND, PLATFORM), "push", (sign * ARM, 0.0, 0.0), (0.0, sign, 0.0)) for name, sign in (("one", 1.0), ("two", -1.0))
    }
    links = {name: link for name, link in whole.links.items() if name != "motor"}
    forced = replace(whole, parts={**whole.parts, "push": ForceActuator()}, links=links | pair)
    assert whole.damping is not None
    by_torque, by_forces = (
        transfer(model, ports(model, TWIST, names), lines, whole.damping).sum(axis=-1)
        for model, names in ((lumped(whole), ("motor",)), (lumped(forced), ("one", "two")))
    )
    np.testing.assert_allclose(by_torque, by_forces * TORQUE / (2.0 * ARM), rtol=1e-9, atol=1e-15)


def test_a_voltage_drive_damps_the_rotation() -> None:
    """zeta = (c + k_t^2/R)/(2 I omega), I = K/omega^2 from the model's own statics and first mode."""
    driven = turned(replace(COIL, drive=Supply.VOLTAGE, damping=1e-3), damping=fs.ModalDamping(0.0))
    model = lumped(driven)
    omega = np.sqrt(eigen(model).values[0])
    stiffness = 1.0 / static_gain(model, ("platform.rz",), ("platform.mz",)).values.item()
    expected = (1e-3 + TORQUE**2 / 5.0) * omega / (2.0 * stiffness)
    assert model.damping is not None
    assert modal_ratios(model, eigen(model), model.damping)[0] == pytest.approx(expected, rel=2e-3)


def test_limits_bound_the_angle() -> None:
    stage = turned()
    model = lumped(stage)
    reach = force_workspace(stage, ideal(stage), model)
    gain = static_gain(model, ("platform.rz",), ("motor",)).values.item()
    currents = {"peak current": 2.0, "continuous current": 0.7, "heat": np.sqrt(40.0 / 20.0), "voltage": 1.2, "maximum torque": 1.5}
    found = dict(zip(reach.bounds.columns, reach.bounds.values[0], strict=True))
    for name, current in currents.items():
        assert found[f"motor {name}"] == pytest.approx(gain * current, rel=1e-9)
    assert found["motor travel"] == pytest.approx(0.05, rel=1e-6)
    heating = next(each for each in judge(stage) if each.requirement.key == "heating.rz")
    assert heating.value == pytest.approx((0.02 / gain) ** 2 * 20.0, rel=1e-6)


def test_about_a_turn_the_coil_still_turns_it() -> None:
    """The nonlinear model, about 0.1 A, by the linear gain."""
    stage = replace(turned(), gravity=(0.0, 0.0, 0.0))
    about = linearise(equilibrium(nonlinear(stage), {"motor": 0.1}))
    found, expected = (static_gain(model, ("platform.rz",), ("motor",)).values.item() for model in (about, lumped(stage)))
    assert found == pytest.approx(expected, rel=1e-2)


def test_a_mirrored_coil_turns_the_other_way() -> None:
    assert COIL.mirrored.thrust == -TORQUE
    limits, mirrored = ({each.name: each.held for each in part.limits} for part in (COIL, COIL.mirrored))
    assert limits == mirrored


def test_file_rig_budget_and_loop_take_it() -> None:
    stage = fs.loads(fs.dumps(turned()))
    assert stage.parts["coil"] == COIL
    drive = NoiseDrive(torque=1e-3, band=(0.0, 90.0))
    record = rig(stage, lumped(stage), RigSetup(seconds=4.0, rate=256.0, drive=drive, input_quantity=InputQuantity.TORQUE))
    assert record.channels[0].unit == "N m"
    assert np.std(record.values[:, 0]) == pytest.approx(1e-3, rel=0.2)
    assert budget(stage, {"rz": 1e-3}, noise={"motor": fs.Spectrum(1e-12)}).ideal.at("rz", "actuator noise") > 0.0
    assert resolve(stage, LoopSetup()).plant.coordinates.input_units == ("A",)


def test_a_coil_without_torque_is_refused() -> None:
    with pytest.raises(DesignError, match="torque_constant: must not be zero"):
        fs.loads(fs.dumps(turned(replace(COIL, torque_constant=0.0))))
