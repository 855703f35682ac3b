"""Stacks held at their charge: stiffness by coupling, the corner of the leakage, what is left of hysteresis and creep."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from flexstage.base.finding import DesignError
from flexstage.base.number import Table
from flexstage.cases.registry import case
from flexstage.control.damping.charge import at_constant_charge, leak_charge
from flexstage.control.damping.legs import legs, without_stiffness
from flexstage.control.example import integral_loop
from flexstage.control.hysteresis.creep import Creep
from flexstage.control.hysteresis.models.bouc_wen import bouc_wen
from flexstage.control.plant_models.creep_plant import add_creep
from flexstage.control.plant_models.electronics import Amplifier, AmplifierSettings, ChargeDrive, ChargeHold, sampling_chain
from flexstage.control.plant_models.plants import plant
from flexstage.control.simulation.actuation import Actuation
from flexstage.control.simulation.machine import Amplifiers, Relief, machine
from flexstage.control.study.choices import Compensation
from flexstage.control.study.file import loads_setup
from flexstage.control.study.hardware.amplifiers import ChargeSetup
from flexstage.control.study.resolve import resolve
from flexstage.control.study.runs import driven_machine
from flexstage.control.study.setup import ControllerSetup, DampingSetup, HystereticStacks, LoopSetup
from flexstage.control.study.study import loop_study
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped

HELD = ChargeSetup(coupling=0.7, corner=0.1)


@pytest.mark.parametrize("name", ["parallelogram", "double-triangle"])
def test_without_coupling_it_is_a_drive_of_volts(name):
    volts = resolve(case(name), LoopSetup()).plant
    charge = resolve(case(name), LoopSetup(amplifier=ChargeSetup(coupling=0.0, corner=0.1))).plant
    lines = np.geomspace(1e-3, 3e3, 12)
    found, wanted = charge.system.transfer(lines), volts.system.transfer(lines)
    assert charge.frequencies == pytest.approx(volts.frequencies, rel=1e-12)
    assert np.max(np.abs(found - wanted)) < 1e-12 * np.max(np.abs(wanted))


@pytest.mark.parametrize("coupling", [0.3, 0.7, 0.95])
def test_open_electrodes_over_short_ones_are_one_over_one_less_the_square(coupling):
    """What the stack alone carries: axial stiffness with its charge held over that with its volts held."""
    stage = case("parallelogram")
    model = lumped(stage)
    (leg,) = legs(stage, model)
    stiff = at_constant_charge(model, (leg,), {leg.actuator: ChargeDrive(coupling, 0.1, 0.2)})
    assert stiff.stiffness[leg.link].law[0, 0] / model.stiffness[leg.link].law[0, 0] == pytest.approx(1.0 / (1.0 - coupling**2), rel=1e-14)
    alike = without_stiffness(model, (leg,), left=1.0 / (1.0 - coupling**2))
    assert eigen(stiff).values == pytest.approx(eigen(alike).values, rel=1e-12)
    row, column = stiff.output_index((f"{leg.link}.fx",))[0], stiff.input_index((leg.actuator,))[0]
    assert stiff.feedthrough[row, column] == pytest.approx(-stiff.stiffness[leg.link].law[0, 0], rel=1e-14)


@pytest.mark.parametrize("name", ["parallelogram", "double-triangle"])
def test_the_plant_is_that_of_stacks_of_a_relaxing_stiffness(name):
    """By nodal coordinates at each frequency: k / (1 - kappa^2 s/(s + w_0)) instead of k, the same free stroke for the same command."""
    stage = case(name)
    model, drive = lumped(stage), ChargeDrive(0.6, 0.5, 0.2)
    held = legs(stage, model)
    drives = {each.actuator: drive for each in held}
    links = tuple(each.link for each in held)
    stiff = plant(at_constant_charge(model, held, drives), ideal(stage), sampling_chain(stage), links=links)
    found = leak_charge(stiff, held, drives)
    K, M = model.stiffness_matrix, model.inertia_matrix
    shapes = scipy.linalg.eigh(at_constant_charge(model, held, drives).stiffness_matrix, M)
    damping = M @ shapes[1] @ np.diag(2.0 * model.damping.ratio * np.sqrt(shapes[0])) @ shapes[1].T @ M
    rows = model.output_index(tuple(f"platform.{each}" for each in found.coordinates.names))
    outputs = [f"relative.{each}" for each in found.coordinates.names]
    stretches = [np.asarray(model.stiffness[each.link].operator)[0] for each in held]
    for line in (0.0, 1e-3, 0.3, 2.0, 40.0, 150.0, 900.0):
        s = 2j * np.pi * line
        soft = drive.coupling**2 * s / (s + 2.0 * np.pi * drive.corner)
        laws = [each.stiffness / (1.0 - soft) for each in held]
        whole = K + s * damping + s**2 * M
        for each, law, stretch in zip(held, laws, stretches, strict=True):
            whole = whole + (law - each.stiffness) * np.outer(stretch, stretch)
        driven = np.stack([law * stretch for law, stretch in zip(laws, stretches, strict=True)], axis=-1)
        wanted = model.output[rows] @ np.linalg.solve(whole, driven)
        answer = found.system.transfer(np.array([line]))[0]
        places = [found.system.output_names.index(each) for each in outputs]
        columns = [found.system.input_names.index(each.actuator) for each in held]
        np.testing.assert_allclose(answer[np.ix_(places, columns)], wanted, rtol=0.0, atol=1e-8 * np.max(np.abs(wanted)))


def test_modes_rise_and_rest_stays():
    """Between the modes on volts and those on rigid stacks; at rest the platform is as stiff as on volts."""
    volts, charge = (resolve(case("double-triangle"), asked) for asked in (LoopSetup(), LoopSetup(amplifier=HELD)))
    told = charge.charge
    assert np.all(told.by_charge >= told.by_volts * (1.0 - 1e-9))
    assert np.all(told.by_charge <= told.by_volts * np.sqrt(told.stiffer[0]))
    assert told.by_charge[0] / told.by_volts[0] > 1.2
    assert charge.highest > volts.highest
    at_rest = [each.plant.system.transfer(np.zeros(1))[0] for each in (volts, charge)]
    assert np.max(np.abs(at_rest[1] - at_rest[0])) < 1e-9 * np.max(np.abs(at_rest[0]))


def test_legs_on_charge_are_damped_too():
    found = resolve(case("parallelogram"), LoopSetup(amplifier=HELD, damping=DampingSetup(ratio=0.05)))
    assert found.damping.min_ratio >= 0.05 * (1.0 - 1e-6)
    assert not [each for each in found.plant.system.output_names if each.endswith(".fx")]
    assert found.plant.system.growth < 0.0


def test_the_corner_follows_from_the_leakage():
    given = loads_setup('format = "flexstage loop 1"\namplifier = { kind = "charge", coupling = 0.6, leakage = "100 Mohm", bits = 16 }')
    power = sampling_chain(case("double-triangle"), amplifiers=given.amplifier.settings).amplifiers["B1"]
    assert power.charge.corner == pytest.approx(1.0 / (2.0 * np.pi * 100e6 * 0.4e-6), rel=1e-12)
    assert power.step == pytest.approx(150e-6 / 2**16)


def way_of(amplitude, period, count):
    return 0.5 * amplitude * (1.0 - np.cos(2.0 * np.pi * np.arange(count) / period))


@pytest.mark.parametrize(("period", "corner", "share"), [(40, 2000, 0.2), (6000, 60, 1.0)])
def test_hysteresis_is_left_above_the_corner_and_whole_below(period, corner, share):
    """Width of a stack's loop over that on volts, the corner's period and the loop's in samples."""
    example = integral_loop()
    power = Amplifiers(*(np.array([each]) for each in (0.0, 1.0, np.inf, 0.0, 1e-6, 0.0)))
    bare = replace(machine(example.plant, example.controller), amplifiers=power)
    volts = replace(bare, hysteresis=bouc_wen(100e-6, (0.0, 100.0), 0.15))
    charge = replace(volts, relief=Relief(np.array([0.2]), np.array([-np.expm1(-2.0 * np.pi / corner)])))
    path = 50e-6 * (1.0 - np.cos(2.0 * np.pi * np.arange(max(2 * period, 4000)) / period))
    rising, falling = np.array_split((strokes(volts, path) - path)[-period:], 2)
    kept = np.array_split((strokes(charge, path) - path)[-period:], 2)
    assert np.max(np.abs(kept[0] - kept[1][::-1])) / np.max(np.abs(rising - falling[::-1])) == pytest.approx(share, rel=0.1)


def test_charge_leaks_with_the_time_constant_of_the_corner():
    """After R C = 1/(2 pi corner), 1/e of the removed hysteretic stroke is still removed."""
    amplifier = ChargeSetup(coupling=0.3, corner=40.0, residual_hysteresis=0.2)
    asked = LoopSetup(amplifier=amplifier, hysteresis=HystereticStacks(width=0.1), controller=ControllerSetup(quick=True))
    found = loop_study(case("parallelogram"), asked)
    relief = driven_machine(found.settled, found.controller, found.stacks).relief
    samples = 1.0 / (2.0 * np.pi * 40.0 * found.settled.plant.hardware.step)
    assert (1.0 - relief.leak[0]) ** samples == pytest.approx(np.exp(-1.0), rel=1e-9)
    assert relief.residual_hysteresis[0] == 0.2


def strokes(given, path):
    """What a stack alone makes (n,) of commands (n,)."""
    actuate = Actuation(given)
    return np.array([actuate(np.array([value]))[2][0] for value in path])


def test_creep_is_left_above_the_corner_and_whole_below():
    bare = integral_loop().plant
    held = replace(bare, hardware=replace(bare.hardware, amplifiers=Table({"B": Amplifier(charge=ChargeDrive(0.0, 0.1, 0.2))})))
    creep = Creep([1.0], [0.1, 0.05], [2e-3, 1e-3])
    lines = np.array([0.0, 1e-5, 5.0])
    free, own, less = (each.system.transfer(lines)[:, 0, 0] for each in (bare, add_creep(bare, creep), add_creep(held, creep)))
    share = (less - free) / (own - free)
    assert share[0] == pytest.approx(1.0, abs=1e-12)
    s = 2j * np.pi * lines
    np.testing.assert_allclose(share, 0.2 + 0.8 * 0.2 * np.pi / (s + 0.2 * np.pi), rtol=1e-9)


BAD = {
    "corner and leakage are both missing": ("parallelogram", LoopSetup(amplifier=ChargeSetup(coupling=0.5))),
    "corner and leakage are both specified": ("parallelogram", LoopSetup(amplifier=ChargeSetup(coupling=0.5, corner=1.0, leakage=1e6))),
    "needs the electromechanical coupling": ("parallelogram", LoopSetup(amplifier=ChargeSetup(corner=1.0))),
    "at least 0 and less than 1": ("parallelogram", LoopSetup(amplifier=ChargeSetup(coupling=1.0, corner=1.0))),
    "the stage has force actuators": ("voice-coil-stage", LoopSetup(amplifier=HELD)),
    "the inverse model applies to voltage drive": (
        "parallelogram",
        LoopSetup(amplifier=HELD, hysteresis=HystereticStacks(width=0.1), compensate=(Compensation.HYSTERESIS,)),
    ),
}


@pytest.mark.parametrize("told", BAD)
def test_what_cannot_be_is_said(told):
    name, asked = BAD[told]
    with pytest.raises(DesignError, match=told):
        resolve(case(name), asked)


def test_leakage_needs_a_capacitance():
    stage = case("parallelogram")
    bare = replace(stage, parts={**stage.parts, "stack": replace(stage.parts["stack"], capacitance=None)})
    with pytest.raises(DesignError, match="leakage needs the stack's capacitance"):
        sampling_chain(bare, amplifiers=AmplifierSettings(charge=ChargeHold(0.5, 0.2, leakage=1e6)))
