"""Export files of a loop: controller in C, functional mock-up unit, plant for MATLAB. No file is left incomplete."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.base.storage.store import move_all, write, write_temporary
from flexstage.base.text import printable
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.damping.sampled import SampledLegs
from flexstage.control.export.code.controller import controller_code
from flexstage.control.export.code.hardware import hardware_code
from flexstage.control.export.code.legs import with_legs
from flexstage.control.export.code.precision import Precision
from flexstage.control.export.code.program import Program
from flexstage.control.export.code.text import identifier
from flexstage.control.export.fmu.unit import fmu
from flexstage.control.plant_models.plants import Plant, zero_order_hold
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.run import simulate
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel
from flexstage.show.matlab import cells, channel_variables

_TESTED = 300
ENDINGS = {
    ".mat": "the plant for MATLAB",
    ".c": "the controller in C",
    ".fmu": "the controller as functional mock-up unit",
    ".csv": "the commanded trajectory",
}
"""Content of an export by the ending of its file name."""
WHOLE = ".loop.fmu"
"""File name ending of the whole loop as functional mock-up unit: controller, amplifiers, stacks, stage and gauges."""


def export_findings(path: str | os.PathLike[str]) -> Iterator[Finding]:
    """Return findings for the file name of an export: an unknown ending, or a reserved function name.

    >>> print(*export_findings("math.c"))
    math.c: its header math.h would replace a system header, or "math" is a reserved function name. Use stage_math.c.
    """
    place = Path(path)
    name = identifier(place.stem)
    if place.suffix not in ENDINGS:
        known = ", ".join(f"{ending} ({what})" for ending, what in {**ENDINGS, WHOLE: "the whole loop as one unit"}.items())
        yield Finding(os.fspath(path), f'unknown ending "{place.suffix}" of an export', f"Use one of {known}")
    elif place.suffix == ".c" and name != place.stem:
        what = f'its header {place.stem}.h would replace a system header, or "{place.stem}" is a reserved function name'
        yield Finding(os.fspath(path), what, f"Use {name}.c")


def hardware_findings(path: str | os.PathLike[str]) -> Iterator[Finding]:
    """Return findings for the file name of a controller for hardware.

    >>> print(*hardware_findings("plant.mat"))
    plant.mat: the file name does not end in .c. Use plant.c.
    """
    if Path(path).suffix != ".c":
        yield Finding(os.fspath(path), "the file name does not end in .c", f"Use {identifier(Path(path).stem)}.c")
    else:
        yield from export_findings(path)


def controller_files(path: str | os.PathLike[str], given: Machine, about: str = "", legs: SampledLegs | None = None) -> dict[Path, str]:
    """Generate the controller of a loop as C99. Returns the texts of the source and its header, by file name.

    The stem of the file name is the prefix of all C names.

    With `legs`, the code includes the force feedback in these legs. Raises `DesignError` if the file name does not end in `.c`, or if it is
    reserved.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> [each.name for each in controller_files("stage.c", machine(example.plant, example.controller))]
    ['stage.c', 'stage.h']
    """
    source = _suffix_findings(path, ".c")
    require(export_findings(path))
    program = whole_controller(given, source.stem, about, legs)
    return {source: program.source, source.with_suffix(".h"): program.header}


def whole_controller(given: Machine, name: str, about: str = "", legs: SampledLegs | None = None) -> Program:
    """Generate the controller program of a loop, including sampled force feedback in `legs`."""
    outer = controller_code(given, name, about)
    return outer if legs is None else with_legs(outer, given, legs)


def hardware_files(
    path: str | os.PathLike[str],
    given: Machine,
    law: Decentralised | None,
    reference: Array,
    *,
    precision: Precision,
    about: str = "",
    legs: SampledLegs | None = None,
) -> dict[Path, str]:
    """Generate a controller for hardware (see `hardware_code`). Returns the texts of source, header and test program, by file name.

    The test replays a simulation of the loop from zero state, without noise, for the first 300 samples of a `reference` (n, f) [m, rad].
    Raises `DesignError` if the file name does not end in `.c`, or if it is reserved.
    """
    source = Path(path)
    require(hardware_findings(path))
    tested = simulate(given, reference[:_TESTED])
    made = hardware_code(given, law, tested, name=source.stem, precision=precision, about=about, legs=legs)
    return {source: made.source, source.with_suffix(".h"): made.header, source.with_name(f"{source.stem}_test.c"): made.test}


@check_arguments
def write_controller(path: str | os.PathLike[str], given: Machine, about: str = "") -> tuple[Path, Path]:
    """Write the controller of a loop as C99 source and header (see `controller_files`); if one fails, neither file is written.

    Raises `DesignError` in the same cases as `controller_files`, and if a file cannot be written.

    >>> import tempfile
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_temporary = write_controller(Path(folder) / "stage.c", machine(example.plant, example.controller))
    ...     [each.name for each in write_temporary], "void stage_step(" in write_temporary[1].read_text()
    (['stage.c', 'stage.h'], True)
    """
    files = controller_files(path, given, about)
    move_all([write_temporary(place, text) for place, text in files.items()])
    source, header = files
    return source, header


@check_arguments
def write_fmu(path: str | os.PathLike[str], program: Program, *, sources_only: bool = False) -> Path:
    """Write a C program as a functional mock-up unit (FMI 2.0 for Co-Simulation); see `fmu`.

    Raises `DesignError` if the file cannot be written, if its name does not end in `.fmu`, and in the cases of `fmu`.

    >>> import tempfile
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     known = controller_code(machine(example.plant, example.controller))
    ...     write_fmu(Path(folder) / "stage.fmu", known, sources_only=True).name
    'stage.fmu'
    """
    return write(_suffix_findings(path, ".fmu"), fmu(program, sources_only=sources_only))


@check_arguments
def write_plant(path: str | os.PathLike[str], given: Plant) -> Path:
    """Write a plant as MATLAB file (see `plant_file`).

    Raises `DesignError` if the file name does not end in `.mat`, or if the file cannot be written.

    >>> import tempfile
    >>> from flexstage.control.example import integral_loop
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_plant(Path(folder) / "plant.mat", integral_loop().plant).name
    'plant.mat'
    """
    return write(_suffix_findings(path, ".mat"), plant_file(given))


def plant_file(given: Plant) -> bytes:
    """Generate a MATLAB file (v5) of a plant: state space with names and units, both continuous and sampled with a hold.

    Structures `continuous` and `sampled` (for a sampled loop) contain A, B, C, D, `step` [s] (0: continuous), inputs, outputs, their units
    and `states`. The file also contains the modes' frequencies [Hz] and damping ratios, simplifications, and provenance.

    >>> import scipy.io
    >>> from flexstage.control.example import integral_loop
    >>> found = scipy.io.loadmat(io.BytesIO(plant_file(integral_loop().plant)), simplify_cells=True)
    >>> found["sampled"]["step"], list(found["sampled"]["inputs"][:2]), found["continuous"]["A"].shape
    (0.0001, ['B', 'ground.x'], (7, 7))
    """
    content = io.BytesIO()
    variables: dict[str, Any] = {
        "continuous": _system(given.system, given.states),
        "frequencies_hz": given.frequencies,
        "damping_ratios": given.ratios,
        "note": printable(given.note),
        "provenance": printable(given.provenance),
    }
    if given.hardware.step is not None:
        variables["sampled"] = _system(zero_order_hold(given), ())
    scipy.io.savemat(content, variables, oned_as="column")
    made = bytearray(content.getvalue())
    made[:116] = b"MATLAB 5.0 MAT-file, Platform: any".ljust(116)  # scipy writes the time; equal plants must give equal files
    return bytes(made)


def path_file(commanded: Array, step: float, coordinates: tuple[Channel, ...]) -> str:
    """Generate a CSV file of a trajectory (n, f) of f coordinates, sampled every `step` [s]: times, then coordinates with units.

    >>> import numpy as np
    >>> path_file(np.array([[0.0], [1e-6]]), 1e-4, (Channel("x", "m"),)).splitlines()
    ['time [s],x [m]', '0,0', '0.0001,1e-06']
    """
    heads = ["time [s]", *(f"{each.name.rpartition('.')[2]} [{each.unit}]" for each in coordinates)]
    rows = (",".join(f"{value:.12g}" for value in (place * step, *row)) for place, row in enumerate(commanded))
    return "\n".join([",".join(heads), *rows]) + "\n"


def _system(system: System, states: tuple[str, ...]) -> dict[str, Any]:
    named = states or tuple(f"x{number + 1}" for number in range(len(system.A)))
    return {
        **{name: getattr(system, name) for name in "ABCD"},
        "step": system.step or 0.0,
        "states": cells(named),
        **channel_variables("input", system.inputs),
        **channel_variables("output", system.outputs),
    }


def _suffix_findings(path: str | os.PathLike[str], suffix: str) -> Path:
    place = Path(path)
    if place.suffix != suffix:
        raise refuse(os.fspath(path), f"the file name does not end in {suffix}", f"Use {identifier(place.stem)}{suffix}")
    return place
