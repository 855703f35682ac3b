"""Controllers in C for processors of their own: against the simulation, over compilers, and on an emulated Cortex-M."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.controllers.lqg import LQG
from flexstage.control.controllers.notch import Notch
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.prefilter import Prefilter
from flexstage.control.damping.sampled import SampledLegs
from flexstage.control.export.code.hardware import FLAGS, Hardware, hardware_code
from flexstage.control.export.code.precision import Precision, typed
from flexstage.control.export.compiler import find_compiler
from flexstage.control.simulation.machine import Machine, machine
from flexstage.control.simulation.run import simulate
from flexstage.control.study.choices import ControllerKind
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import resolve
from flexstage.control.study.runs import driven_machine
from flexstage.control.study.setup import ControllerSetup, LoopSetup
from tests.elsewhere.loops import electric, full_loop, six_axes, way

needs_compiler = pytest.mark.skipif(find_compiler() is None, reason="no compiler of C on the PATH")
SAMPLES = 200
EMULATED = {
    "m7": ("mps2-an500", ("-mcpu=cortex-m7", "-mfloat-abi=hard", "-mfpu=fpv5-d16")),
    "m3, floating point by software": ("mps2-an385", ("-mcpu=cortex-m3",)),
}
ARM, QEMU = shutil.which("arm-none-eabi-gcc"), shutil.which("qemu-system-arm")


@cache
def laws(kind: str) -> tuple[Machine, Decentralised | None]:
    """Six axes of the shipped stage under single loops, or one axis under an observer."""
    if kind == "lqg":
        asked = LoopSetup(controller=ControllerSetup(kind=ControllerKind.LQG, bandwidth=20.0))
        given = resolve(parallelogram(), asked)
        control = make_controller(given, given.plant.coordinates.strokes)
        assert isinstance(control.made_of, LQG)
        return driven_machine(given, control), None
    wired = six_axes()
    loops = platform_loops(wired.plant.coordinates)
    law = PI(0.02, 8.0) if kind == "pi" else PID(0.02, 8.0, 1e-5, 900.0)
    shaped = (Prefilter(90.0, 1.0, 300.0), *(None,) * 5) if kind == "pid" else ()
    notches = ((Notch(106.0, 0.05, 0.5), Notch(173.0, 0.1, 0.5)),) * 6
    forward = wired.plant.coordinates.strokes if kind == "pid" else None
    control = Decentralised(loops, (law,) * 6, notches, forward, shaped)
    given = machine(wired.plant, control.system(wired.plant.hardware.step), electric())
    smooth = replace(given.amplifiers, step=np.zeros(6))
    return given if kind == "pid" else replace(given, amplifiers=smooth), control


@cache
def code(kind: str, precision: Precision) -> Hardware:
    given, law = laws(kind)
    reference = way(given, SAMPLES)[0] if kind != "lqg" else np.full((SAMPLES, 1), 2e-6)
    return hardware_code(given, law, simulate(given, reference), name="stage", precision=precision, about="Made for a test.")


def written(folder: Path, made: Hardware) -> Path:
    for name, text in {"stage.h": made.header, "stage.c": made.source, "stage_test.c": made.test}.items():
        (folder / name).write_text(text)
    return folder


def here(folder: Path, made: Hardware, *flags: str) -> tuple[float, str]:
    """The test program on this computer: how far off, and the hash of all bits."""
    command = [*find_compiler(), *FLAGS, *flags, "-DSTAGE_MAIN", "stage.c", "stage_test.c", "-o", "stage"]
    subprocess.run(command, cwd=written(folder, made), check=True, capture_output=True)
    done = subprocess.run([folder / "stage"], check=False, capture_output=True, text=True)
    worst, bits = done.stdout.split()
    assert done.returncode == 0, worst
    return float(worst), bits


@needs_compiler
@pytest.mark.parametrize("precision", Precision)
@pytest.mark.parametrize("kind", ["pi", pytest.param("pid", marks=pytest.mark.full), "lqg"])
def test_strokes_are_those_of_the_simulation(tmp_path, kind, precision):
    worst, _ = here(tmp_path, code(kind, precision))
    step = np.max(laws(kind)[0].amplifiers.step)  # where a converter rounds, the other way at times
    assert worst < precision.tolerance or step > 0.0
    assert worst > 0.0 or step > 0.0


@needs_compiler
@pytest.mark.parametrize("precision", Precision)
def test_force_feedback_in_legs_is_that_of_the_law(tmp_path, precision):
    """By its test, which tells a gain that is wrong too; in single precision with a pole that is a thousandth of the rate."""
    given, law = laws("pi")
    inner = SampledLegs(given.actuators[1:4], np.array([3e-8, 4e-8, 5e-8]), 1e-3, 2, 0.1 * given.step, 10)
    made = hardware_code(given, law, simulate(given, way(given, 20)[0]), name="stage", precision=precision, legs=inner)
    worst, _ = here(tmp_path, made)
    assert 0.0 < worst < precision.tolerance
    wrong = made.source.replace("* set->leg[i]", "* 0.999f * set->leg[i]" if precision is Precision.SINGLE else "* 0.999 * set->leg[i]")
    assert wrong != made.source
    with pytest.raises(AssertionError, match=r"e-0[34]"):
        here(tmp_path, replace(made, source=wrong))


@needs_compiler
@pytest.mark.parametrize("precision", [Precision.SINGLE, pytest.param(Precision.DOUBLE, marks=pytest.mark.full)])
def test_the_same_bits_whatever_the_optimisation(tmp_path, precision):
    found = {here(tmp_path, code("pi", precision), flag)[1] for flag in ("-O0", "-O3")}
    assert len(found) == 1


def test_the_step_calls_nothing():
    for kind in ("pi", "pid", "lqg"):
        source = code(kind, Precision.SINGLE).source
        assert [line for line in source.splitlines() if line.startswith("#include")] == ['#include "stage.h"', "#include <float.h>"]
        assert "double" not in source
        assert not any(word in source for word in ("fabs", "rint", "malloc", "sqrt"))


def test_costs_are_stated():
    small, large = code("pi", Precision.SINGLE), code("pi", Precision.DOUBLE)
    assert f"{large.flops} additions and multiplications" in large.header
    assert small.flops == large.flops
    assert large.state - 4 == 2 * (small.state - 4)
    lqg, given = code("lqg", Precision.DOUBLE), laws("lqg")[0]
    states = len(given.controller.A)
    assert lqg.flops < 2 * states * 2 + 2 * states * 5 + 100  # in modal form A costs two or four a state, not one for every pair


START = """
typedef unsigned int word;
double_or_float stage_worst(unsigned long long *hash);
extern word stack_top, data_start, data_end, data_from, bss_start, bss_end;
static void semihost(int what, const void *with)
{
    register int r0 __asm__("r0") = what;
    register const void *r1 __asm__("r1") = with;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}
void *memcpy(void *to, const void *from, word n) { char *a = to; const char *b = from; while (n--) *a++ = *b++; return to; }
void *memset(void *to, int value, word n) { char *a = to; while (n--) *a++ = (char)value; return to; }
static void start(void)
{
    static char text[] = "................ \\n";
    static word end[2] = {0x20026, 0};
    unsigned long long hash;
    word *a, *b, i;
    for (a = &data_start, b = &data_from; a < &data_end;) *a++ = *b++;
    for (a = &bss_start; a < &bss_end;) *a++ = 0;
#ifdef __ARM_FP
    *(volatile word *)0xe000ed88 |= 0xf << 20;
    __asm__ volatile("dsb\\n isb");
#endif
    stage_worst(&hash);
    for (i = 0; i < 16; i++) text[i] = "0123456789abcdef"[(hash >> (60 - 4 * i)) & 15];
    semihost(4, text);
    semihost(0x20, end);
    for (;;) continue;
}
__attribute__((section(".vectors"), used)) static const void *const vectors[2] = {&stack_top, (const void *)start};
"""
LAYOUT = """
MEMORY { code (rx) : ORIGIN = 0, LENGTH = 4M  data (rwx) : ORIGIN = 0x20000000, LENGTH = 4M }
SECTIONS {
  .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) . = ALIGN(8); data_from = .; } > code
  .data : AT(ADDR(.text) + SIZEOF(.text)) { data_start = .; *(.data*) . = ALIGN(8); data_end = .; } > data
  .bss : { bss_start = .; *(.bss*) *(COMMON) . = ALIGN(8); bss_end = .; } > data
  stack_top = 0x20000000 + 4M;
  /DISCARD/ : { *(.ARM.exidx*) *(.ARM.attributes) *(.comment) }
}
"""


@needs_compiler
@pytest.mark.skipif(ARM is None or QEMU is None, reason="no compiler or emulator of Cortex-M on the PATH")
@pytest.mark.parametrize("kind", ["pi", *(pytest.param(kind, marks=pytest.mark.full) for kind in ("pid", "lqg"))])
@pytest.mark.parametrize("precision", Precision)
@pytest.mark.parametrize("core", EMULATED)
def test_a_cortex_m_gives_the_same_bits(tmp_path, kind, precision, core):
    made = code(kind, precision)
    _, bits = here(tmp_path, made)
    board, flags = EMULATED[core]
    (tmp_path / "start.c").write_text(START.replace("double_or_float", typed("double", precision)))
    (tmp_path / "layout.ld").write_text(LAYOUT)
    sources = ["stage.c", "stage_test.c", "start.c"]
    command = [ARM, "-O2", "-std=gnu99", "-ffp-contract=off", "-mthumb", *flags, "-ffreestanding", "-nostdlib", *sources]
    subprocess.run([*command, "-T", "layout.ld", "-o", "stage.elf", "-lgcc"], cwd=tmp_path, check=True, capture_output=True)
    run = [QEMU, "-M", board, "-nographic", "-semihosting-config", "enable=on,target=native", "-kernel", "stage.elf"]
    done = subprocess.run(run, cwd=tmp_path, check=False, capture_output=True, text=True, timeout=120)
    assert (done.stdout + done.stderr).split()[-1] == bits


class Loaded:
    """The controller in this process."""

    def __init__(self, folder: Path, made: Hardware, given: Machine, states: int, settings: int) -> None:
        place = written(folder, made) / "stage.so"
        command = [*find_compiler(), *FLAGS, "-shared", "-fPIC", "stage.c", "-o", str(place)]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        self.library = ctypes.CDLL(str(place))
        self.f, self.g, self.m = len(given.names), len(given.gauges), len(given.actuators)
        self.state, self.set = ctypes.create_string_buffer(states + 64), ctypes.create_string_buffer(settings + 64)
        self.enable = settings - 4
        self.library.stage_init(self.state, self.set)
        if hasattr(self.library, "stage_set_gains"):
            self.library.stage_set_gains.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, *[ctypes.c_double] * 3]

    def switch(self, on: bool) -> None:
        ctypes.c_int.from_buffer(self.set, self.enable).value = int(on)

    def step(self, reference: np.ndarray, reading: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Strokes given, and all outputs."""
        entry, out = np.concatenate([reference, reading]), np.zeros(2 * self.f + 4 * self.m + self.f + self.g)
        self.library.stage_step(self.state, self.set, entry.ctypes.data_as(ctypes.c_void_p), out.ctypes.data_as(ctypes.c_void_p))
        start = 2 * self.f + 2 * self.m
        return out[start : start + self.m], out


@pytest.fixture
def loaded(tmp_path) -> Loaded:
    made, (given, _) = code("pi", Precision.DOUBLE), laws("pi")
    return Loaded(tmp_path, made, given, made.state, made.parameters)


@needs_compiler
def test_it_is_enabled_without_a_bump(loaded):
    random = np.random.default_rng(2)
    reference, reading = 1e-6 * random.standard_normal(6), 1e-6 * random.standard_normal(6)
    first, _ = loaded.step(reference, reading)
    assert not first.any()
    loaded.switch(on=True)
    for _ in range(50):
        moved, _ = loaded.step(reference, reading)
    assert np.max(np.abs(moved)) > 1e-9
    loaded.switch(on=False)
    for _ in range(20):
        still, _ = loaded.step(-3.0 * reference, 2.0 * reading)
        assert np.array_equal(still, moved)
    loaded.switch(on=True)
    again, _ = loaded.step(-3.0 * reference, 2.0 * reading)
    assert np.max(np.abs(again - moved)) < 1e-12 * np.max(np.abs(moved))
    further, _ = loaded.step(-3.0 * reference, 2.0 * reading)
    assert np.max(np.abs(further - again)) > 1e-12


@needs_compiler
def test_an_observer_is_enabled_without_a_bump(tmp_path):
    made, (given, _) = code("lqg", Precision.DOUBLE), laws("lqg")
    one = Loaded(tmp_path, made, given, made.state, made.parameters)
    wanted, reading = np.array([1e-6]), np.array([2e-7])
    one.switch(on=True)
    for _ in range(100):
        moved = one.step(wanted, reading)[0].copy()
    one.switch(on=False)
    assert np.array_equal(one.step(-wanted, 3.0 * reading)[0], moved)
    one.switch(on=True)
    again = one.step(-wanted, 3.0 * reading)[0].copy()
    assert abs(again - moved) < 1e-9 * abs(moved)
    assert one.step(-wanted, 3.0 * reading)[0] != again


@needs_compiler
def test_gains_change_without_a_bump_and_take_effect(loaded):
    loaded.switch(on=True)
    reference, reading = np.full(6, 1e-6), np.zeros(6)
    for _ in range(400):
        previous = loaded.step(reference, reading)[0].copy()
    usual = loaded.step(reference, reading)[0] - previous
    last = previous + usual
    for loop in range(6):
        loaded.library.stage_set_gains(loaded.state, loaded.set, loop, 0.5, 80.0, 0.0)
    changed = loaded.step(reference, reading)[0].copy()
    assert np.max(np.abs(changed - last)) < 11.0 * np.max(np.abs(usual))  # no jump of 25 times the direct part, which is 250 such steps
    for _ in range(400):
        later = loaded.step(reference, reading)[0].copy()
    rate = loaded.step(reference, reading)[0] - later
    assert np.allclose(rate, 10.0 * usual, rtol=1e-6)


@needs_compiler
def test_what_is_no_number_is_held(loaded):
    loaded.switch(on=True)
    good = np.full(6, 1e-7)
    loaded.step(good, good)
    for bad in (np.nan, np.inf, -np.inf, 1e308):
        given, out = loaded.step(np.full(6, bad if bad != 1e308 else np.nan), np.full(6, bad))
        assert np.all(np.isfinite(given))
        status = out[-12:]
        assert np.all(status[:6] == (2.0 if bad == 1e308 else 1.0))
        assert np.all(status[6:] == 1.0)


@needs_compiler
def test_numbers_that_overflow_leave_its_states_finite(loaded):
    loaded.switch(on=True)
    for sign in (1.0, -1.0) * 50:
        given, _ = loaded.step(np.full(6, sign * 1e308), np.zeros(6))
        assert np.all(np.isfinite(given))
    for _ in range(3):
        given, out = loaded.step(np.zeros(6), np.zeros(6))
    assert np.all(np.isfinite(out[:24]))


def test_an_inverse_of_hysteresis_is_refused():
    given = full_loop(inverse=True)
    with pytest.raises(DesignError, match="inverse of this hysteresis model"):
        hardware_code(given, None, None, name="stage", precision=Precision.SINGLE)
