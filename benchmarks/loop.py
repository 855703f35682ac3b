"""A control loop over 10 s at 10 kHz: in numpy, by generated C, and by python-control's nonlinear simulation of the same loop.

The shipped stage with its 12 lowest modes, six axes under PI control with the reference fed forward, amplifiers with lag, limits of range
and speed and 18-bit converters, hysteresis of ten plays in every stack, gauges that round. Seconds are those of the processor, so that what
else runs on the machine counts little; ratios say how much faster than real time. python-control is given the loop as one difference
equation, written plainly with numpy, for a shorter time; its answers are compared with ours over that time, those of C over all of it.
Targets: numpy at least 3 times faster than real time, C at least 50 times, C equal to numpy to 1e-12.

Then a step of the controller for hardware (`--hardware`) of the shipped stage: PI with notches (target: under 1 us) and LQG in modal form,
in both precisions, with what they add and multiply and the memory they take.

`benchmarks/loop.py --defaults [CASE ...]` compares plain and default tuning of the shipped cases instead (target: 12 s on the shipped
stage, 20 s on any).
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import ctypes
import importlib.util
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import CASES, case
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.export.code.hardware import FLAGS, hardware_code
from flexstage.control.export.code.precision import Precision
from flexstage.control.export.compiler import find_compiler
from flexstage.control.robustness.stability_margins import bandwidths, shifted_peaks
from flexstage.control.simulation.result import Simulated
from flexstage.control.simulation.run import simulate
from flexstage.control.study.choices import ControllerKind
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import resolve
from flexstage.control.study.retained import control_and_modes
from flexstage.control.study.runs import driven_machine, runs
from flexstage.control.study.setup import ControllerSetup, LoopSetup
from flexstage.control.study.study import pose_gains
from flexstage.control.systems.closed import loop as wired
from tests.elsewhere.compiled_loop import simulate_compiled
from tests.elsewhere.independent_loop import Stepped
from tests.elsewhere.loops import PLATFORM, RATE, full_loop, way
from tests.elsewhere.test_loop_simulation import worst

SECONDS, SHORT = 10.0, 0.2
NUMPY, COMPILED, EQUAL = 3.0, 50.0, 1e-12


def timed(action: Callable[[], Simulated]) -> tuple[Simulated, float]:
    start = time.process_time()
    return action(), time.process_time() - start


def told(name: str, spent: float, seconds: float, target: float | None = None) -> None:
    ratio = seconds / spent
    verdict = "" if target is None else f"   target {target:g}: {'met' if ratio >= target else 'MISSED'}"
    print(f"{name:40} {1e6 * spent / seconds / RATE:8.2f} us a sample {ratio:8.1f} times real time{verdict}")


STEPS = 1_000_000
TIMED = """
#include "stage.h"
void many(long count);
void many(long count)
{
    static stage_state state; static stage_parameters set; static stage_input in; static stage_output out;
    long k;
    stage_init(&state, &set);
    set.enable = 1;
    for (k = 0; k < count; k++) {
        in.reading[0] = (stage_real)(k % 7) * 1e-9f;
        stage_step(&state, &set, &in, &out);
    }
}
"""


def hardware(kind: ControllerKind, precision: Precision) -> None:
    """What a step of a controller for hardware costs."""
    given = resolve(double_triangle(), LoopSetup(controller=ControllerSetup(kind=kind, quick=True)))
    control = make_controller(given, given.plant.coordinates.strokes)
    machine = driven_machine(given, control)
    law = control.made_of if isinstance(control.made_of, Decentralised) else None
    made = hardware_code(machine, law, simulate(machine, np.full((50, 6), 1e-7)), name="stage", precision=precision)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        for name, text in {"stage.h": made.header, "stage.c": made.source, "many.c": TIMED}.items():
            (place / name).write_text(text)
        flags = [each for each in FLAGS if each != "-Werror"]
        subprocess.run([*find_compiler(), *flags, "-shared", "-fPIC", "stage.c", "many.c", "-o", "many.so"], cwd=place, check=True)
        library = ctypes.CDLL(str(place / "many.so"))
        start = time.process_time()
        library.many(ctypes.c_long(STEPS))
        spent = (time.process_time() - start) / STEPS
    verdict = "" if law is None else f"   target 1 us: {'met' if spent < 1e-6 else 'MISSED'}"
    memory = f"state {made.state}, parameters {made.parameters}, tables {made.tables} bytes"
    notches = "" if law is None else f", {len(control.notches)} notches"
    told = f"{kind.value}{notches}, {len(machine.controller.A)} states, {precision.value}"
    print(f"{told:40} {1e6 * spent:8.3f} us a step, {made.flops} additions and multiplications, {memory}{verdict}")


def defaults(names: list[str]) -> None:
    """Plain and default tuning: slowest crossover, Ms nominal and with all modes 2, 5 and 10 % off, slowest settling, processor seconds."""
    print(f"{'case':26} {'tuning':8} {'crossover':>11} {'Ms':>6} {'2 %':>6} {'5 %':>6} {'10 %':>6} {'settling':>11} {'tuning':>8}")
    for name in names:
        for quick in (True, False):
            try:
                given = resolve(case(name), LoopSetup(controller=ControllerSetup(quick=quick)))
                gains = pose_gains(given, None if given.kinematics.thrusts else lost_motion(given.kinematics, given.model))
                start = time.process_time()
                given, control, _ = control_and_modes(given, gains)
            except DesignError as error:
                print(f"{name:26} no loop: {error.findings[0].what}")
                break
            spent, closed = time.process_time() - start, wired(given.plant, control.system)
            peaks = " ".join(f"{each.peak:6.2f}" for each in shifted_peaks(closed))
            settling = max(run.step.settling for run in runs(given, control, closed) if run.step is not None)
            limit = 12.0 if name == "double-triangle" else 20.0
            far = f"{np.min(bandwidths(closed).rejection):8.1f} Hz"
            missed = "   MISSED" if spent > limit else ""
            print(
                f"{name:26} {'plain' if quick else 'default':8} {far} {peaks} {1e3 * settling:8.1f} ms {spent:6.1f} s{missed}", flush=True
            )


def by_control(reference: np.ndarray) -> tuple[np.ndarray, float]:
    import control

    given = full_loop()
    loop = Stepped(given)
    system = control.nlsys(loop.update, loop.output, inputs=6, outputs=12, states=len(loop.initial), dt=given.step)
    times = given.step * np.arange(len(reference))
    start = time.process_time()
    answer = control.input_output_response(system, times, reference.T, loop.initial)
    return answer.outputs.T, time.process_time() - start


def main() -> None:
    if "--defaults" in sys.argv:
        defaults(sys.argv[sys.argv.index("--defaults") + 1 :] or list(CASES))
        return
    given = full_loop(motions=PLATFORM)
    reference, _ = way(given, round(SECONDS * RATE))
    found, spent = timed(lambda: simulate(given, reference))
    told("numpy", spent, SECONDS, NUMPY)
    compensated = full_loop(inverse=True, motions=PLATFORM)
    told("numpy, inverse of the hysteresis as well", timed(lambda: simulate(compensated, reference))[1], SECONDS)
    if find_compiler() is None:
        print("generated C: no compiler is there")
    else:
        simulate_compiled(given, reference[:2])  # compiled and kept
        compiled, fast = timed(lambda: simulate_compiled(given, reference))
        told("generated C", fast, SECONDS, COMPILED)
        difference = max(worst(compiled, found).values())
        print(f"  differs from numpy by {difference:.1e} (target {EQUAL:g})")
        for kind in (ControllerKind.PI, ControllerKind.LQG):
            for precision in Precision:
                hardware(kind, precision)
    if importlib.util.find_spec("control") is None:
        print("python-control is not installed, so it is not compared")
        return
    short = reference[: round(SHORT * RATE)]
    theirs, slow = by_control(short)
    told("python-control", slow, SHORT)
    ours = simulate(full_loop(), short)
    difference = np.max(np.abs(np.hstack([ours.pose, ours.given]) - theirs), axis=0) / np.max(np.abs(theirs), axis=0)
    print(f"  differs from ours by {np.max(difference):.1e}; numpy is {slow / SHORT * SECONDS / spent:.0f} times faster")


if __name__ == "__main__":
    main()
