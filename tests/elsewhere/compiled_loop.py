"""The simulation by generated C, compiled and loaded: what `simulate` computes, from the code that is exported."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.store import temporary_folder
from flexstage.control.export.code.program import FLAGS, Program, Signal
from flexstage.control.export.code.whole import loop_code
from flexstage.control.export.compiler import compile_source
from flexstage.control.simulation.disturbances import inflow
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.result import Series, Simulated, simulation_result
from flexstage.control.simulation.running import require_finite
from flexstage.control.systems.system import select

_NONE: Mapping[str, Array] = {}
_RUN = """
void {name}_run({name}_state *state, long count, const double *inputs, double *outputs);
void {name}_run({name}_state *state, long count, const double *inputs, double *outputs)
{{
    long k;
    for (k = 0; k < count; k++)
        {name}_step(state, (const {name}_input *)(const void *)(inputs + k * {inputs}), ({name}_output *)(void *)(outputs + k * {outputs}));
}}
long {name}_size(void);
long {name}_size(void) {{ return (long)sizeof({name}_state); }}
"""


def simulate_compiled(given: Machine, reference: Array, disturbances: Mapping[str, Array] = _NONE) -> Simulated:
    """The loop's answer as by `simulate`, computed by C that is generated, compiled (once for each machine, then kept) and loaded.

    Equal to `simulate` but for the order of summation. Raises `DesignError` as `simulate` does, for a hysteresis that has no form in C, and
    where there is no compiler.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> from flexstage.control.simulation.run import simulate
    >>> from flexstage.control.export.compiler import find_compiler
    >>> example = integral_loop()
    >>> known, asked = machine(example.plant, example.controller), np.full((500, 1), 1e-6)
    >>> found = simulate_compiled(known, asked) if find_compiler() else simulate(known, asked)
    >>> bool(np.max(np.abs(found.pose - simulate(known, asked).pose)) < 1e-18)
    True
    """
    moved, read, added = inflow(given, len(reference), disturbances)
    felt = tuple(index for index, channel in enumerate(given.disturbances) if channel.name in disturbances)
    program = loop_code(_without_idle_disturbances(given, felt))
    rows = run_program(program, np.hstack([reference, moved[:, felt], read, added]))
    series = _series(program, rows, reference)
    require_finite(given, np.hstack([series.motions, series.command, series.stroke]))
    return simulation_result(given, series)


def _without_idle_disturbances(given: Machine, felt: tuple[int, ...]) -> Machine:
    """The machine without the disturbances that are nought all the time: most of what a program would multiply."""
    names = tuple(given.disturbances[index].name for index in felt)
    return replace(given, plant=select(given.plant, (*given.actuators, *names), given.plant.output_names))


def _series(program: Program, rows: Array, reference: Array) -> Series:
    """Columns of the outputs by the fields they stand in."""
    ends = np.cumsum([0, *(len(signal.channels) for signal in program.outputs)])
    columns = {signal.field: slice(*ends[number : number + 2]) for number, signal in enumerate(program.outputs)}
    parts = {field: rows[:, place] for field, place in columns.items()}
    return Series(
        reference=reference,
        pose=parts["pose"],
        motions=parts["motion"],
        command=parts["command"],
        asked=parts["asked"],
        given=parts["given"],
        stroke=parts["stroke"],
        readings=parts["rounded"],
    )


def run_program(program: Program, inputs: Array) -> Array:
    """Outputs (n, outputs) of a program for inputs (n, inputs), from rest."""
    numbers = sum(math.prod(state.sizes) for state in program.states)
    library = _load(program.name, program.header, program.source + _driver(program), numbers)
    outputs = np.empty((len(inputs), _count(program.outputs)))
    state = ctypes.create_string_buffer(library[f"{program.name}_size"]())
    library[f"{program.name}_init"](state)
    inputs = np.ascontiguousarray(inputs)
    pointer = ctypes.POINTER(ctypes.c_double)
    library[f"{program.name}_run"](state, ctypes.c_long(len(inputs)), inputs.ctypes.data_as(pointer), outputs.ctypes.data_as(pointer))
    return outputs


def _driver(program: Program) -> str:
    return _RUN.format(name=program.name, inputs=_count(program.inputs), outputs=_count(program.outputs))


def _count(signals: tuple[Signal, ...]) -> int:
    return sum(len(signal.channels) for signal in signals)


@lru_cache(maxsize=32)
def _load(name: str, header: str, source: str, numbers: int) -> ctypes.CDLL:
    """The library in this process; its state holds so many numbers."""

    with temporary_folder() as folder:
        (folder / "made.so").write_bytes(compile_source("the compiled simulation", {f"{name}.h": header, f"{name}.c": source}, FLAGS))
        library = ctypes.CDLL(str(folder / "made.so"))
    size = library[f"{name}_size"]
    size.restype = ctypes.c_long
    assert size() == numbers * ctypes.sizeof(ctypes.c_double)
    return library
