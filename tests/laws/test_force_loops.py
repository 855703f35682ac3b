"""Laws of loops on force actuators: inputs in amperes, the plant of a driven mass, amplifiers of current."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.units.scale import X, Z, mm
from flexstage.control.export.code.controller import controller_code
from flexstage.control.plant_models.coordinates import coordinates
from flexstage.control.plant_models.electronics import AmplifierSettings, sampling_chain
from flexstage.control.plant_models.plants import plant
from flexstage.control.study.choices import Compensation, ControllerKind
from flexstage.control.study.runs import driven_machine
from flexstage.control.study.setup import AmplifierSetup, ControllerSetup, HystereticStacks, LoopSetup
from flexstage.control.study.study import loop_study
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, ModalDamping, Probe
from flexstage.models.ideal import ideal
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.actuator import ForceLimit
from flexstage.parts.body import Body, Inertia
from flexstage.parts.encoder import Encoder
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.piezo import Piezo
from flexstage.parts.voice_coil import Supply, VoiceCoil

COIL = VoiceCoil(
    force_constant=12.0, peak_current=5.0, continuous_current=2.0, voltage=24.0, resistance=3.0, inductance=1.5e-3, mass=0.1, damping=0.5
)
MASS, FASTEST = 0.9, 20e3


def stage(**coils):
    """A platform on two leaves along y, free along x, pushed by coils at heights above its centre."""
    links = {
        name: Link((GROUND, PLATFORM), "leaf", (at, 25 * mm, 0.0), (0.0, -1.0, 0.0), bends=Z)
        for name, at in (("left", -30 * mm), ("right", 30 * mm))
    }
    return Mechanism(
        name="voice coils on leaves",
        materials={"steel": Material(young=200e9, poisson=0.3, density=7800.0)},
        parts={"leaf": Leaf("steel", length=50 * mm, thickness=0.4 * mm, width=20 * mm), **coils},
        bodies={PLATFORM: Body(mass=MASS, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-3, 1e-3, 1e-3))},
        links=links | {name: Link((GROUND, PLATFORM), name, (-40 * mm, 0.0, 0.0), X) for name in coils},
        sensors={"scale": Encoder(range=10 * mm, period=1e-9, noise_density=1e-10, bandwidth=FASTEST)},
        gauges={"S": Probe("scale", PLATFORM, Pose(at=(40 * mm, 0.0, 0.0), along=X))},
        damping=ModalDamping(0.01),
    )


@pytest.fixture(scope="module")
def single():
    return stage(motor=COIL)


@pytest.fixture(scope="module")
def study(single):
    return loop_study(
        single, LoopSetup(amplifier=AmplifierSetup(bandwidth=5e3, bits=16, current_noise=2e-6), controller=ControllerSetup(quick=True))
    )


def test_a_command_of_one_metre_takes_the_current_that_holds_it(single):
    loop = coordinates(ideal(single), lumped(single))
    held = static_gain(lumped(single), ("platform.x",), ("motor",)).values
    np.testing.assert_allclose(loop.strokes, 1.0 / held, rtol=1e-12)
    assert [(channel.name, channel.unit) for channel in loop.commands("command.")] == [("command.motor", "A")]


def test_coils_in_one_line_share_the_force_by_their_constants():
    """The pseudo-inverse: least sum of squared currents, so each in proportion to its force constant."""
    weak = replace(COIL, force_constant=6.0)
    both = stage(strong=COIL, weak=weak)
    currents = coordinates(ideal(both), lumped(both)).strokes[:, 0]
    assert currents[1] / currents[0] == pytest.approx(0.5)


def test_the_plant_of_a_coil_is_a_driven_mass_behind_the_lags(single):
    """k_f / (k - m w^2 + j w c), amplifier and gauge of first order."""
    model = lumped(single)
    found = plant(model, ideal(single), sampling_chain(single, amplifiers=AmplifierSettings(bandwidth=5e3)))
    lines = np.array([1.0, 10.0, 60.0, 300.0])
    seen = found.system.transfer(lines)[:, found.system.output_names.index("gap.S"), found.system.input_names.index("motor")]
    stiffness = 1.0 / static_gain(model, ("platform.x",), ("platform.fx",)).values.item()
    natural, omega = 2.0 * np.pi * found.frequencies[0], 2.0 * np.pi * lines
    damper = COIL.damping + 2.0 * 0.01 * stiffness / natural
    driven = COIL.force_constant / (stiffness * (1.0 - (omega / natural) ** 2) + 1j * omega * damper)
    np.testing.assert_allclose(seen, driven / (1.0 + 1j * lines / 5e3) / (1.0 + 1j * lines / FASTEST), rtol=2e-3)


def test_a_loop_on_a_coil_is_closed_far_above_the_resonance_of_its_springs(study):
    """PID without being asked: stable, its gain passing 1 above five times the resonance, steps without error at the end."""
    assert study.stability.stable
    assert study.setup.controller.kind is ControllerKind.PID
    assert study.controller.bandwidth > 5.0 * study.plant.frequencies[0]
    assert study.static_errors is None
    assert "force-driven stage has no lost motion" in study.reasons["static_errors"]
    run = study.runs[0].simulated
    assert abs(run.error[-1, 0]) < 1e-3 * run.reference[-1, 0]


def test_the_exported_controller_gives_amperes(study):
    code = controller_code(driven_machine(study.settled, study.controller))
    commands = {signal.field: [channel.unit for channel in signal.channels] for signal in code.outputs}
    assert (commands["command"], commands["given"]) == (["A"], ["A"])
    assert "volts" not in commands
    assert any("in A." in line for line in code.about)


def test_a_current_amplifier_clips_at_the_peak_and_rises_by_the_volts_that_are_left(single):
    """Clipped by peak current and V/R, not by heat; (V - R i/2)/L in the mean; one step of 2^bits over both ways."""
    found = sampling_chain(single, amplifiers=AmplifierSettings(bits=12, current_noise=3e-6)).amplifiers["motor"]
    assert (found.low, found.high, found.noise_density) == (-5.0, 5.0, 3e-6)
    assert found.slew == pytest.approx((24.0 - 0.5 * 3.0 * 5.0) / 1.5e-3)
    assert found.step == pytest.approx(10.0 / 2**12)
    slow = stage(motor=replace(COIL, drive=Supply.VOLTAGE, resistance=6.0))
    voltage = sampling_chain(slow).amplifiers["motor"]
    assert (voltage.high, voltage.bandwidth) == (pytest.approx(4.0), pytest.approx(6.0 / (2.0 * np.pi * 1.5e-3)))
    assert [limit.name for limit in COIL.limits if isinstance(limit, ForceLimit) and not limit.clips] == ["continuous current"]


@pytest.mark.parametrize(
    ("setup", "found"),
    [
        (LoopSetup(amplifier=AmplifierSetup(resistance=50.0)), "motor: resistance applies to amplifiers of stacks"),
        (LoopSetup(amplifier=AmplifierSetup(noise=1e-6)), "motor: noise_density applies to"),
        (
            LoopSetup(hysteresis=HystereticStacks(width=0.1)),
            "hysteresis: hysteresis needs stacks, but the stage has force actuators (motor)",
        ),
        (LoopSetup(compensate=(Compensation.LOAD,)), "compensate: load compensation is not supported"),
    ],
)
def test_what_is_of_stacks_is_refused_of_coils_by_name(single, setup, found):
    with pytest.raises(fs.DesignError) as refused:
        loop_study(single, setup)
    assert any(str(finding).startswith(found) for finding in refused.value.findings), str(refused.value)


def test_strokes_and_forces_together_are_refused_by_name():
    stack = Piezo(stroke=50e-6, stiffness=20e6, length=40 * mm, diameter=10 * mm)
    with pytest.raises(fs.DesignError, match=r"strokes \(stack\) and forces \(motor\) drive the stage"):
        coordinates(ideal(stage(motor=COIL, stack=stack)), None)


def test_stated_numbers_make_a_pi_controller_still(single):
    """As for stacks: who gives gains without a kind has given those of PI."""
    found = loop_study(single, LoopSetup(controller=ControllerSetup(integral=0.5), seconds=0.05))
    assert found.setup.controller.kind is ControllerKind.PI
