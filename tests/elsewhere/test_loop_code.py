"""Generated C and functional mock-up units against the simulation in numpy; without warnings, and validated by FMPy."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.base.number import Table
from flexstage.control.damping.sampled import SampledLegs
from flexstage.control.example import integral_loop
from flexstage.control.export.code.controller import controller_code
from flexstage.control.export.code.legs import with_legs
from flexstage.control.export.code.program import FLAGS, WARNINGS, Program
from flexstage.control.export.code.whole import loop_code
from flexstage.control.export.compiler import find_compiler
from flexstage.control.export.files import write_controller, write_fmu, write_plant
from flexstage.control.export.fmu.unit import fmu, fmu_sources
from flexstage.control.hysteresis.models.bouc_wen import BoucWen, bouc_wen
from flexstage.control.hysteresis.models.envelope import Envelope
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.simulation.machine import Machine, Relief, machine
from flexstage.control.simulation.result import Simulated
from flexstage.control.simulation.run import simulate
from flexstage.control.systems.system import static
from flexstage.models.linear.model import Channel
from tests.elsewhere.compiled_loop import run_program, simulate_compiled
from tests.elsewhere.independent_loop import Computer
from tests.elsewhere.loops import PLATFORM, full_loop, plays, six_axes, way, without_limits
from tests.elsewhere.test_loop_simulation import worst
from tests.laws.preisach import Preisach

needs_compiler = pytest.mark.skipif(find_compiler() is None, reason="no compiler of C on the PATH")


def enveloped() -> PrandtlIshlinskii:
    """Plays between bent envelopes, in volts and metres."""
    model = plays(6)
    knots, bent = np.array([-200.0, 300.0, 700.0, 1200.0]), np.array([-150.0, 320.0, 690.0, 1100.0])
    after = Envelope(np.array([-1e-4, 0.0, 2e-4]), np.array([-0.9e-4, 1e-6, 2.2e-4]))
    return PrandtlIshlinskii(model.thresholds, model.weights, Envelope(knots, bent), after)


def bouc_wens() -> BoucWen:
    """Of three shapes; the second has no slow part (beta = gamma), where its formula has another form."""
    ones = [bouc_wen(150e-6, (0.0, 1000.0), 0.1, skew=skew) for skew in (0.3, 1.0, -0.2)] * 2
    return BoucWen(*(np.array([getattr(one, name)[0] for one in ones]) for name in ("gain", "lag", "beta", "gamma")), 1e-6)


def full(*, inverse: bool = False) -> Machine:
    return full_loop(inverse=inverse, motions=PLATFORM)


KINDS: dict[str, Callable[[], Machine]] = {
    "Bouc-Wen, unrounded": lambda: replace(full(), hysteresis=bouc_wens(), compensation=plays(), resolution=np.zeros(6)),
    "charge": lambda: replace(full(), relief=Relief(np.full(6, 0.2), np.full(6, 0.01))),
    "linear": lambda: without_limits(full()),
    "limits": lambda: replace(full(), hysteresis=None),
    "hysteresis": full,
    "inverse": lambda: full(inverse=True),
    "envelopes": lambda: replace(full(), hysteresis=enveloped(), compensation=enveloped()),
    "all motions": lambda: full_loop(inverse=True),
    "slack": lambda: replace(full(), amplifiers=replace(full().amplifiers, slew=np.full(6, np.inf), step=np.zeros(6))),
}
FULL = pytest.mark.full
EVERY = [kind if kind.startswith("Bouc-Wen") else pytest.param(kind, marks=FULL) for kind in KINDS]
COMPILED = [kind if kind == "charge" or kind.startswith("Bouc-Wen") else pytest.param(kind, marks=FULL) for kind in KINDS]


@needs_compiler
@pytest.mark.parametrize("kind", COMPILED)
def test_compiled_loops_equal_numpy(kind):
    given = KINDS[kind]()
    reference, disturbances = way(given, 400, size=35e-6)
    found, expected = simulate_compiled(given, reference, disturbances), simulate(given, reference, disturbances)
    assert max(worst(found, expected).values()) < 1e-12, worst(found, expected)
    assert np.array_equal(found.saturated, expected.saturated)
    assert np.array_equal(found.slewing, expected.slewing)


@needs_compiler
@FULL
def test_compiled_loops_equal_numpy_without_disturbances():
    given = full_loop()
    reference, _ = way(given, 300)
    assert max(worst(simulate_compiled(given, reference), simulate(given, reference)).values()) < 1e-12


@needs_compiler
@FULL
@pytest.mark.parametrize("free", [False, True])
def test_loops_without_states_of_their_own_compile_as_well(free):
    """A controller that only passes the reference on, one axis, no volts, with and without limits: groups of size 0 everywhere."""
    example = integral_loop()
    through = static(np.eye(1), (Channel("reference.x", "m"),), (Channel("command.B", "m"),), example.step)
    given = machine(example.plant, through, motions=())
    given = without_limits(given) if free else given
    reference = np.full((300, 1), 1e-6)
    found, expected = simulate_compiled(given, reference), simulate(given, reference)
    assert np.max(np.abs(found.pose - expected.pose)) < 1e-12 * 1e-6
    assert len(fmu(controller_code(given, "2 odd */ names"))) > 1000


def replayed(step: object, program: Program, given: Machine, known: Simulated) -> dict[str, np.ndarray]:
    """Outputs of a controller's step, called sample by sample with the reference and readings of a simulation."""
    sizes = {signal.field: len(signal.channels) for signal in program.outputs}
    inputs = np.ascontiguousarray(np.hstack([known.reference, known.readings]))
    outputs = np.empty((len(inputs), sum(sizes.values())))
    for entry, out in zip(inputs, outputs, strict=True):
        step(entry.ctypes.data_as(ctypes.c_void_p), out.ctypes.data_as(ctypes.c_void_p))
    ends = np.cumsum([0, *sizes.values()])
    return {field: outputs[:, start:stop] for field, start, stop in zip(sizes, ends[:-1], ends[1:], strict=True)}


@needs_compiler
def test_the_exported_controller_gives_the_volts_of_the_simulation(tmp_path):
    given = full_loop(inverse=True)
    known = simulate(given, *way(given, 400))
    source, header = write_controller(tmp_path / "controller.c", given, "Made for a test.")
    assert "Made for a test." in header.read_text()
    made = tmp_path / "controller.so"
    subprocess.run([*find_compiler(), *FLAGS, "-o", str(made), str(source), "-lm"], check=True, cwd=tmp_path)
    loaded, state = ctypes.CDLL(str(made)), ctypes.create_string_buffer(1 << 16)
    loaded.controller_init(state)
    program = controller_code(given)
    found = replayed(lambda entry, out: loaded.controller_step(state, entry, out), program, given, known)
    for field in ("pose", "error", "command", "asked", "given", "volts"):
        ours = getattr(known, field)
        assert np.max(np.abs(found[field] - ours)) < 1e-12 * np.max(np.abs(ours)), field


@needs_compiler
def test_force_feedback_is_part_of_the_exported_controller():
    """Three samples of the legs to one of the pose: what the pose's loop gives stays, and both together keep within the amplifiers."""
    given = full_loop(inverse=True)
    known, names = simulate(given, *way(given, 120)), (given.actuators[4], given.actuators[1])
    inner = SampledLegs(names, np.array([3e-8, 5e-8]), 0.02, 2, given.step / 3.0, 3)
    tensions = 40.0 * np.random.default_rng(4).normal(size=(360, 2)).cumsum(axis=0)
    tensions[7, 1] = np.nan
    program = with_legs(controller_code(given), given, inner)
    assert program.step == inner.step
    assert [line.partition(":")[0] for line in program.about if "step every" in line] == [f"Call the step every {inner.step:.12g} s"]
    rows = run_program(program, np.hstack([np.repeat(known.reference, 3, axis=0), np.repeat(known.readings, 3, axis=0), tensions]))
    ends = np.cumsum([0, *(len(signal.channels) for signal in program.outputs)])
    found = {signal.field: rows[:, slice(*ends[place : place + 2])] for place, signal in enumerate(program.outputs)}
    assert found["given"] == pytest.approx(np.repeat(known.given, 3, axis=0), abs=1e-12 * np.max(np.abs(known.given)))
    assert np.flatnonzero(found["tension_status"]).tolist() == [15]
    tensions[7, 1] = tensions[6, 1]
    assert found["added"] == pytest.approx(inner.strokes(tensions), abs=1e-12 * np.max(np.abs(found["added"])))
    wanted, last = found["given"].copy(), np.zeros(6)
    wanted[:, [4, 1]] += found["added"]
    powers, limited = given.amplifiers, 0
    for total, volts, asked, alone in zip(found["total"], found["volts"], wanted, found["given"], strict=True):
        most = powers.slew * inner.step
        last = np.clip(np.clip(asked, powers.low, powers.high), last - most, last + most)
        limited += np.any(last != asked)
        assert total == pytest.approx(last, abs=1e-18)
        assert np.all((volts - powers.bias)[[0, 2, 3, 5]] != 0.0) or not np.any(alone)
    assert 0 < limited < 360


def lost(count: int, gauges: int) -> np.ndarray:
    """What is added to readings (n, g): at times no number, infinite, or more than any gauge's range; most of it nothing."""
    random = np.random.default_rng(5)
    spoilt = random.choice([np.nan, np.inf, -np.inf, 1.0, -1e300], size=(count, gauges))
    added = np.where(random.random((count, gauges)) < 0.1, spoilt, 0.0)
    added[60:75, 1], added[0, 0] = np.nan, np.inf  # for long, and before there was any good one
    return added


def by_hand(given: Machine, reference: np.ndarray, gaps: np.ndarray) -> dict[str, np.ndarray]:
    """The controller alone, on readings before they are rounded, written down anew."""
    computer, found = Computer(given), []
    state = computer.start()
    for wanted, gap in zip(reference, gaps, strict=True):
        state, _, signals = computer.sample(state, wanted, gap)
        found.append(signals)
    return {name: np.array([each[name] for each in found]) for name in found[0]}


@pytest.mark.parametrize("inverse", [False, True])
def test_lost_readings_are_held_and_taken_again(inverse):
    given = full_loop(inverse=inverse, motions=PLATFORM)
    reference, disturbances = way(given, 200)
    bare, added = simulate(given, reference, disturbances), lost(200, 6)
    noise = {f"noise.{name}": disturbances[f"noise.{name}"] + added[:, index] for index, name in enumerate(given.gauges)}
    found = simulate(given, reference, disturbances | noise)
    by_status = np.abs(added) > 0.0  # NaN too: |NaN| > 0 is false
    by_status |= np.isnan(added)
    assert found.out_of_range == pytest.approx(np.mean(by_status, axis=0))
    assert not bare.out_of_range.any()
    assert np.all(np.isfinite(found.volts))
    assert np.all(np.isfinite(found.motions))
    expected = by_hand(given, reference, found.readings)
    for field in ("pose", "command", "asked", "given"):
        ours = getattr(found, field)
        assert np.max(np.abs(expected[field] - ours)) < 1e-11 * np.max(np.abs(ours)), field
    if find_compiler() is not None:
        compiled = simulate_compiled(given, reference, disturbances | noise)
        good = np.abs(found.readings) < 1e-3
        assert np.array_equal(good, np.abs(compiled.readings) < 1e-3)
        both = (replace(each, readings=np.where(good, each.readings, 0.0)) for each in (compiled, found))
        assert max(worst(*both).values()) < 1e-12


def test_a_gauge_beyond_its_range_is_held_until_it_returns():
    """One axis that steps farther than its gauge measures: the reading stays below its end, and the way back is found."""
    example = integral_loop(gain=100.0)
    sensors = Table({"S": replace(example.plant.hardware.sensors["S"], half_range=2e-6)})
    plant = replace(example.plant, hardware=replace(example.plant.hardware, sensors=sensors))
    given = machine(plant, example.controller, motions=("platform.x",))
    reference = np.repeat([[2.2e-6], [0.0]], 1500, axis=0)
    found = simulate(given, reference)
    beyond = np.abs(found.readings[:, 0]) > given.reach[0]
    assert 0.2 < np.mean(beyond) == found.out_of_range[0] < 0.6
    assert np.max(np.abs(found.pose)) <= given.reach[0]
    assert abs(found.motion("platform.x")[-1]) < 1e-9
    assert not simulate(without_limits(given), reference).out_of_range.any()


@pytest.mark.parametrize(("reading", "held"), [(3e-9, 0.0), (4e-9, 1.0)])
def test_a_reading_at_the_very_end_of_its_range_is_taken(reading, held):
    """Three steps of 1 nm are more than 3 nm by a bit of rounding, and the gauge measures 3 nm."""
    example = integral_loop()
    through = static(np.zeros((1, 1)), (Channel("reference.x", "m"),), (Channel("command.B", "m"),), example.step)
    given = replace(machine(example.plant, through, motions=()), resolution=np.array([1e-9]), half_range=np.array([3e-9]))
    assert 3.0 * given.resolution[0] > given.half_range[0]
    entering = np.zeros((4, 1)), {"noise.S": np.full(4, reading)}
    found = [simulate(given, *entering), *([simulate_compiled(given, *entering)] if find_compiler() is not None else [])]
    assert [each.out_of_range.tolist() for each in found] == [[held]] * len(found)
    assert [each.pose.any() for each in found] == [held == 0.0] * len(found)


def spoilt_replay(given: Machine, tmp_path, reference: np.ndarray, readings: np.ndarray) -> dict[str, np.ndarray]:
    """Outputs of the exported controller, compiled by itself, for these references and readings."""
    source, _ = write_controller(tmp_path / "stage.c", given)
    made = tmp_path / "stage.so"
    subprocess.run([*find_compiler(), *FLAGS, "-o", str(made), str(source), "-lm"], check=True, cwd=tmp_path)
    loaded, state = ctypes.CDLL(str(made)), ctypes.create_string_buffer(1 << 16)
    loaded.stage_init(state)
    known = replace(simulate(given, np.zeros((1, 6))), reference=reference, readings=readings)
    return replayed(lambda entry, out: loaded.stage_step(state, entry, out), controller_code(given, "stage"), given, known)


@needs_compiler
def test_the_exported_controller_survives_what_is_no_number(tmp_path):
    given = full_loop(inverse=True)
    reference, _ = way(given, 200)
    readings = simulate(given, reference).readings
    spoilt, wanted = readings + lost(200, 6), reference.copy()
    wanted[[0, 50, 51, 120], [0, 3, 3, 5]] = np.nan, np.inf, -np.inf, np.nan
    found = spoilt_replay(given, tmp_path, wanted, spoilt)
    assert all(np.all(np.isfinite(values)) for values in found.values())
    infinite, beyond = ~np.isfinite(spoilt), np.isfinite(spoilt) & (np.abs(spoilt) > 1e-3)
    assert np.array_equal(found["status"], np.hstack([1.0 * infinite + 2.0 * beyond, 1.0 * ~np.isfinite(wanted)]))
    kept = wanted.copy()
    kept[0, 0], kept[50:52, 3], kept[120, 5] = 0.0, reference[49, 3], reference[119, 5]
    expected = by_hand(given, kept, spoilt)
    for field in ("pose", "command", "asked", "given"):
        assert np.max(np.abs(found[field] - expected[field])) < 1e-11 * np.max(np.abs(expected[field])), field
    never = spoilt_replay(given, tmp_path, reference * np.nan, readings * np.nan)
    assert np.array_equal(never["volts"], np.broadcast_to(given.amplifiers.bias, (200, 6)))  # nothing ever known: it stays at the bias


@needs_compiler
def test_the_exported_controller_survives_numbers_that_overflow(tmp_path):
    given = replace(full_loop(), compensation=None)
    reference = np.zeros((300, 6))
    reference[:100:2], reference[1:100:2] = 1e308, -1e308
    found = spoilt_replay(given, tmp_path, reference, np.zeros((300, 6)))
    assert np.all(np.isfinite(found["volts"]))
    assert np.all(np.isfinite(found["command"][-1]))


@needs_compiler
def test_a_command_that_is_no_number_leaves_the_strokes(tmp_path):
    """Infinity less infinity, within one sum, before there was any other command: the stroke stays that at the bias."""
    given = replace(full_loop(), compensation=None)
    wide = np.tile([10.0, -10.0, 0.0, 0.0, 0.0, 0.0], (6, 1))
    channels = (
        Channel(f"{kind}.{name}", "m") for kind, names in (("reference", given.names), ("command", given.actuators)) for name in names
    )
    every = tuple(channels)
    given = replace(given, controller=static(wide, every[:6], every[6:], given.step))
    found = spoilt_replay(given, tmp_path, np.full((3, 6), 1e308), np.zeros((3, 6)))
    assert np.all(np.isnan(found["command"]))
    assert np.array_equal(found["volts"], np.broadcast_to(given.amplifiers.bias, (3, 6)))


@needs_compiler
def test_fast_mathematics_is_refused(tmp_path):
    source, _ = write_controller(tmp_path / "stage.c", full_loop())
    done = subprocess.run([*find_compiler(), "-c", "-ffast-math", str(source)], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode != 0
    assert "without fast math" in done.stderr


@needs_compiler
@pytest.mark.parametrize("name", [name for name in ("gcc", "clang") if shutil.which(name)])
@pytest.mark.parametrize("standard", ["c99", pytest.param("c11", marks=FULL)])
@pytest.mark.parametrize("kind", EVERY)
def test_no_compiler_warns(tmp_path, name, standard, kind):
    given = KINDS[kind]()
    for program in (controller_code(given), loop_code(given)):
        for file, text in fmu_sources(program).items():
            (tmp_path / file).write_text(text)
        units = [f"{program.name}.c", "fmi2.c"]
        command = [name, f"-std={standard}", "-O1", "-c", "-Wshadow", "-Wdouble-promotion", *WARNINGS, *units]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("kind", EVERY)
def test_the_code_needs_nothing_but_mathematics(kind):
    for program in (controller_code(KINDS[kind]()), loop_code(KINDS[kind]())):
        included = [line for line in program.source.splitlines() if line.startswith("#include")]
        assert included == [f'#include "{program.name}.h"', "#include <math.h>"]
        assert "#include" not in program.header
        assert not any(word in program.source for word in ("malloc", "calloc", "free(", "printf"))


def test_the_same_loop_gives_the_same_text_and_the_same_unit():
    first, again = (controller_code(full_loop(inverse=True)) for _ in range(2))
    assert (first.source, first.header) == (again.source, again.header)
    assert fmu(first, sources_only=True) == fmu(again, sources_only=True)


@needs_compiler
@FULL
def test_the_same_loop_gives_the_same_library(tmp_path, monkeypatch):
    made = []
    for folder in ("a", "b"):
        monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / folder))
        made.append(fmu(controller_code(full_loop(inverse=True))))
        assert not (tmp_path / folder).exists()  # what goes to others is never taken from a folder that was written before
    assert made[0] == made[1]


def test_without_a_compiler_it_is_said_and_the_text_still_comes(tmp_path, monkeypatch):
    given = full_loop(current=0.03)  # no other test has compiled it
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(
        DesignError, match=r"compiler: a functional mock-up unit needs a C compiler.*CC = no-such-compiler.*Install a compiler"
    ):
        write_fmu(tmp_path / "controller.fmu", controller_code(given))
    with pytest.raises(DesignError, match="the compiled simulation needs a C compiler"):
        simulate_compiled(given, np.zeros((2, 6)))
    write_fmu(tmp_path / "controller.fmu", controller_code(given), sources_only=True)
    write_controller(tmp_path / "stage.c", given)
    assert {path.name for path in tmp_path.iterdir()} == {"controller.fmu", "stage.c", "stage.h"}


@pytest.mark.parametrize(
    ("write", "name", "message"),
    [
        (write_controller, "controller.txt", r"does not end in \.c\. Use controller\.c"),
        (write_controller, "2 axes.c", r'"2 axes" is a reserved function name\. Use stage_2_axes\.c'),
        (write_controller, "Math.c", r"its header Math\.h would replace a system header.*Use stage_Math\.c"),
        (lambda path, given: write_fmu(path, controller_code(given)), "controller.zip", r"does not end in \.fmu"),
        (lambda path, _: write_plant(path, integral_loop().plant), "plant.m", r"does not end in \.mat"),
    ],
)
def test_bad_names_are_refused(tmp_path, write, name, message):
    with pytest.raises(DesignError, match=message):
        write(tmp_path / name, full_loop())


def test_a_hysteresis_without_c_is_refused():
    given = full_loop()
    one = Preisach.__new__(Preisach)  # of this kind, whatever its numbers
    with pytest.raises(DesignError, match="Preisach cannot be exported as C"):
        loop_code(replace_unchecked(given, one))


def replace_unchecked(given: Machine, model: object) -> Machine:
    changed = replace(given)
    object.__setattr__(model, "start", lambda bias: bias)
    object.__setattr__(changed, "hysteresis", model)
    return changed


def test_plants_for_matlab_read_back_and_are_the_same_file(tmp_path):
    from scipy.io import loadmat

    wired = six_axes()
    content = [write_plant(tmp_path / name, wired.plant).read_bytes() for name in ("a.mat", "b.mat")]
    assert content[0] == content[1]
    found = loadmat(tmp_path / "a.mat", simplify_cells=True)
    for name in "ABCD":
        assert np.array_equal(found["continuous"][name], getattr(wired.plant.system, name))
        assert np.array_equal(found["sampled"][name], getattr(wired.held, name))
    assert list(found["sampled"]["inputs"]) == list(wired.held.input_names)
    assert list(found["continuous"]["output_units"]) == [channel.unit for channel in wired.plant.system.outputs]
    assert list(found["continuous"]["states"]) == list(wired.plant.states)
    assert (found["continuous"]["step"], found["sampled"]["step"]) == (0.0, wired.plant.hardware.step)
    assert found["note"] == wired.plant.note
