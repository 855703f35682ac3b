"""Functional mock-up units run by an importer of our own, which calls every function of FMI 2.0, and by FMPy where it is installed."""

from __future__ import annotations

import ctypes
import io
import sys
import zipfile
from ctypes import c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from xml.etree import ElementTree

import numpy as np
import pytest

from flexstage.control.example import integral_loop
from flexstage.control.export.code.controller import controller_code
from flexstage.control.export.code.whole import loop_code
from flexstage.control.export.compiler import find_compiler
from flexstage.control.export.files import write_fmu
from flexstage.control.export.fmu.unit import fmu
from flexstage.control.simulation.machine import machine
from flexstage.control.simulation.run import simulate
from tests.elsewhere.loops import full_loop, way

pytestmark = pytest.mark.skipif(find_compiler() is None or sys.platform != "linux", reason="no compiler of C, or no Linux")

OK, DISCARD, ERROR = 0, 2, 3
LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p, c_char_p)
ALLOCATE = ctypes.CFUNCTYPE(c_void_p, c_size_t, c_size_t)
RELEASE = ctypes.CFUNCTYPE(None, c_void_p)


class Callbacks(ctypes.Structure):
    _fields_ = (
        ("logger", LOGGER),
        ("allocate", ALLOCATE),
        ("release", RELEASE),
        ("finished", c_void_p),
        ("environment", c_void_p),
    )


class Importer:
    """A unit loaded: its variables by name, its functions, what it said, and the memory it holds."""

    def __init__(self, content: bytes, folder) -> None:
        archive = zipfile.ZipFile(io.BytesIO(content))
        self.description = ElementTree.fromstring(archive.read("modelDescription.xml"))  # noqa: S314 made by ourselves
        (name,) = [each for each in archive.namelist() if each.startswith("binaries/linux64/")]
        self.library = ctypes.CDLL(archive.extract(name, folder))
        self.references = {each.get("name"): int(each.get("valueReference")) for each in self.description.iter("ScalarVariable")}
        self.said: list[str] = []
        self.held: dict[int, object] = {}
        self.callbacks = Callbacks(LOGGER(self._log), ALLOCATE(self._allocate), RELEASE(self._release), None, None)
        self.library.fmi2Instantiate.restype = c_void_p
        self.library.fmi2GetVersion.restype = c_char_p

    def _log(self, _environment, _instance, _status, _category, form, text) -> None:
        self.said.append((form % text if text else form).decode())

    def _allocate(self, count, size):
        memory = ctypes.create_string_buffer(count * size)
        self.held[ctypes.addressof(memory)] = memory
        return ctypes.addressof(memory)

    def _release(self, memory) -> None:
        del self.held[memory]

    def instance(self, guid: str | None = None) -> c_void_p | None:
        guid = self.description.get("guid") if guid is None else guid
        made = self.library.fmi2Instantiate(b"one", 1, guid.encode(), b"", ctypes.byref(self.callbacks), 0, 0)
        return None if made is None else c_void_p(made)

    def running(self, start: float = 0.0) -> c_void_p:
        one = self.instance()
        assert self.library.fmi2SetupExperiment(one, 0, c_double(0.0), c_double(start), 0, c_double(0.0)) == OK
        assert self.library.fmi2EnterInitializationMode(one) == OK
        assert self.library.fmi2ExitInitializationMode(one) == OK
        return one

    def set(self, one, values: dict[str, float]) -> int:
        references = (c_uint * len(values))(*(self.references[name] for name in values))
        return self.library.fmi2SetReal(one, references, c_size_t(len(values)), (c_double * len(values))(*values.values()))

    def get(self, one, names) -> np.ndarray:
        references, found = (c_uint * len(names))(*(self.references[name] for name in names)), (c_double * len(names))()
        assert self.library.fmi2GetReal(one, references, c_size_t(len(names)), found) == OK
        return np.array(found)

    def step(self, one, now: float, step: float) -> int:
        return self.library.fmi2DoStep(one, c_double(now), c_double(step), 1)


@pytest.fixture(scope="module")
def known():
    given = full_loop(inverse=True)
    return given, simulate(given, *way(given, 120)), fmu(controller_code(given))


def inputs(given, found, k: int) -> dict[str, float]:
    values = {f"reference.{name}": value for name, value in zip(given.names, found.reference[k], strict=True)}
    return values | dict(zip(given.gauges, found.readings[k], strict=True))


def test_a_unit_gives_the_volts_of_the_simulation(known, tmp_path):
    given, found, content = known
    unit = Importer(content, tmp_path)
    one, names = unit.running(start=0.5), [f"volts.{name}" for name in given.actuators]
    assert unit.get(one, names) == pytest.approx(given.amplifiers.bias, rel=1e-15)  # at rest it asks for the bias, not for 0 V
    for k in range(len(found.times)):
        assert unit.set(one, inputs(given, found, k)) == OK
        assert unit.step(one, 0.5 + k * given.step, given.step) == OK
        assert np.max(np.abs(unit.get(one, names) - found.volts[k])) < 1e-12 * 1000.0
    unit.library.fmi2Terminate(one)
    unit.library.fmi2FreeInstance(one)
    assert not unit.held  # all memory is given back
    assert not unit.said


def test_a_unit_holds_lost_readings_and_says_so(known, tmp_path):
    given, found, content = known
    unit = Importer(content, tmp_path)
    one, names = unit.running(), [f"volts.{name}" for name in given.actuators]
    status = ["status.S1", "status.S2", "status.reference.x"]
    for k in range(60):
        lost = {"S1": np.nan, "S2": 1.0, "reference.x": np.inf} if 20 <= k < 30 else {}
        assert unit.set(one, inputs(given, found, k) | lost) == OK
        assert unit.step(one, k * given.step, given.step) == OK
        assert unit.get(one, status).tolist() == ([1.0, 2.0, 1.0] if lost else [0.0, 0.0, 0.0])
        assert np.all(np.isfinite(unit.get(one, names)))
    assert np.max(np.abs(unit.get(one, names) - found.volts[59])) < 0.05 * 1000.0  # it has followed again


@pytest.mark.parametrize("name", ["fmi2", "model", "int", "2 axes \u202e", "FMI2"])
def test_units_of_any_name_load_and_run(tmp_path, name):
    """Names that are others' already, in C, FMI or a system, are made their own."""
    example = integral_loop()
    program = controller_code(machine(example.plant, example.controller), name)
    unit = Importer(fmu(program), tmp_path)
    one = unit.running()
    assert unit.set(one, {"reference.x": 1e-6}) == OK
    assert unit.step(one, 0.0, 1e-3) == OK
    assert unit.get(one, ["given.B"])[0] > 1e-9
    assert unit.description.get("modelName") == program.name
    assert program.name.startswith("stage_")
    assert program.name.isidentifier()


def test_steps_of_the_importer_take_the_samples_that_lie_in_them(known, tmp_path):
    given, found, content = known
    unit = Importer(content, tmp_path)
    once, parted = unit.running(), unit.running()
    names = [f"given.{name}" for name in given.actuators]
    for one in (once, parted):
        unit.set(one, inputs(given, found, 40))
    unit.step(once, 0.0, 3.0 * given.step)
    for number in range(12):
        unit.step(parted, 0.25 * number * given.step, 0.25 * given.step)
    assert np.array_equal(unit.get(once, names), unit.get(parted, names))
    unit.step(once, 3.0 * given.step, 0.5 * given.step)  # the sample at its start
    after = unit.get(once, names)
    unit.step(once, 3.5 * given.step, 0.5 * given.step)  # none
    assert np.array_equal(unit.get(once, names), after)


def test_states_are_kept_serialised_and_brought_back(known, tmp_path):
    given, found, content = known
    unit = Importer(content, tmp_path)
    library, one, names = unit.library, unit.running(), [f"volts.{name}" for name in given.actuators]

    def run(one, start: int) -> np.ndarray:
        for k in range(start, start + 20):
            unit.set(one, inputs(given, found, k))
            unit.step(one, k * given.step, given.step)
        return unit.get(one, names)

    run(one, 0)
    kept, size = c_void_p(), c_size_t()
    assert library.fmi2GetFMUstate(one, ctypes.byref(kept)) == OK
    first = run(one, 20)
    assert library.fmi2SetFMUstate(one, kept) == OK
    assert np.array_equal(run(one, 20), first)
    assert library.fmi2SerializedFMUstateSize(one, kept, ctypes.byref(size)) == OK
    content = ctypes.create_string_buffer(size.value)
    assert library.fmi2SerializeFMUstate(one, kept, content, size) == OK
    other, brought = unit.running(), c_void_p()
    assert library.fmi2DeSerializeFMUstate(other, content, size, ctypes.byref(brought)) == OK
    assert library.fmi2SetFMUstate(other, brought) == OK
    assert np.array_equal(run(other, 20), first)
    assert library.fmi2Reset(other) == OK
    assert unit.get(other, names) == pytest.approx(given.amplifiers.bias, rel=1e-15)
    for each in (kept, brought):
        assert library.fmi2FreeFMUstate(one, ctypes.byref(each)) == OK
        assert not each.value
    assert library.fmi2SerializeFMUstate(one, kept, content, c_size_t(1)) == ERROR


def test_what_the_standard_forbids_is_refused_and_said(known, tmp_path):
    _, _, content = known
    unit = Importer(content, tmp_path)
    assert unit.library.fmi2GetVersion() == b"2.0"
    assert unit.instance(guid="{0}") is None
    assert "GUID" in unit.said[-1]
    one = unit.instance()
    assert unit.step(one, 0.0, 1e-4) == ERROR
    assert unit.said[-1] == "the FMU is not in step mode"
    assert unit.library.fmi2ExitInitializationMode(one) == ERROR
    assert unit.library.fmi2Terminate(one) == ERROR
    running, wrong = unit.running(), (c_uint * 1)(100_000)
    assert unit.library.fmi2GetReal(running, wrong, c_size_t(1), (c_double * 1)()) == ERROR
    assert unit.set(running, {"volts.B1": 1.0}) == ERROR  # an output
    assert unit.library.fmi2GetInteger(running, wrong, c_size_t(1), (c_int * 1)()) == ERROR
    assert unit.library.fmi2GetInteger(running, wrong, c_size_t(0), (c_int * 1)()) == OK
    assert unit.library.fmi2CancelStep(running) == ERROR
    assert unit.library.fmi2GetRealStatus(running, 0, (c_double * 1)()) == DISCARD
    assert unit.step(running, 0.0, -1.0) == ERROR


@pytest.mark.parametrize("kind", ["controller", pytest.param("loop", marks=pytest.mark.full)])
def test_fmpy_validates_without_findings_and_simulates(known, tmp_path, kind):
    fmpy = pytest.importorskip("fmpy")
    validation = pytest.importorskip("fmpy.validation")
    given, found, _ = known
    program = controller_code(given) if kind == "controller" else loop_code(given)
    path = str(write_fmu(tmp_path / f"{kind}.fmu", program))
    assert validation.validate_fmu(path) == []
    reference, disturbances = way(given, len(found.times))
    series = {f"reference.{name}": column for name, column in zip(given.names, reference.T, strict=True)}
    series |= dict(zip(given.gauges, found.readings.T, strict=True)) if kind == "controller" else disturbances
    entering = np.zeros(len(found.times), dtype=[("time", float), *((name, float) for name in series)])
    entering["time"] = found.times
    for name, column in series.items():
        entering[name] = column
    names = [f"given.{name}" for name in given.actuators]
    step = given.step
    made = fmpy.simulate_fmu(
        path, start_time=0.0, stop_time=found.times[-1], step_size=step, output_interval=step, input=entering, output=names
    )
    ours = np.stack([made[name] for name in names], axis=-1)[1:]  # what a step gives is there at its end
    assert np.max(np.abs(ours - found.given[: len(ours)])) < 1e-12 * np.max(np.abs(found.given))
