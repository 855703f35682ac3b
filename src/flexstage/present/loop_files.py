"""A loop for other programs, as files: controller in C, functional mock-up unit, plant for MATLAB; there whole or not at all."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.analysis.loop.code.controller import controller_code
from flexstage.analysis.loop.code.program import Program
from flexstage.analysis.loop.code.text import identifier
from flexstage.analysis.loop.plant import Plant, held
from flexstage.analysis.loop.simulation.machine import Machine
from flexstage.analysis.loop.system import System
from flexstage.base.finding import refuse
from flexstage.base.store import atomic_write
from flexstage.present.fmu.unit import fmu
from flexstage.readings.linear.model import Channel


def write_controller(path: str | os.PathLike[str], given: Machine, about: str = "") -> tuple[Path, Path]:
    """Write the controller of a machine as C99, `controller.c` and its header beside it; their names are those of its functions.

    Raises `DesignError` where a file cannot be written, and for a name that does not end in `.c`.

    >>> import tempfile
    >>> from flexstage.analysis.loop.example import integral_loop
    >>> from flexstage.analysis.loop.simulation.machine import machine
    >>> example = integral_loop()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = write_controller(Path(folder) / "stage.c", machine(example.plant, example.controller))
    ...     [each.name for each in written], "void stage_step(" in written[1].read_text()
    (['stage.c', 'stage.h'], True)
    """
    source = _ending(path, ".c")
    program = controller_code(given, source.stem, about)
    if program.name != source.stem:
        raise refuse(os.fspath(path), f'"{source.stem}" is no name for functions of C', f"Call it {program.name}.c")
    header = source.with_suffix(".h")
    for place, text in ((header, program.header), (source, program.source)):
        _write(place, text.encode())
    return source, header


def write_fmu(path: str | os.PathLike[str], program: Program, *, sources_only: bool = False) -> Path:
    """Write a program as functional mock-up unit (FMI 2.0 for Co-Simulation); see `fmu`.

    Raises `DesignError` where the file cannot be written, for a name that does not end in `.fmu`, and where there is no compiler.

    >>> import tempfile
    >>> from flexstage.analysis.loop.example import integral_loop
    >>> from flexstage.analysis.loop.simulation.machine import machine
    >>> example = integral_loop()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     known = controller_code(machine(example.plant, example.controller))
    ...     write_fmu(Path(folder) / "stage.fmu", known, sources_only=True).name
    'stage.fmu'
    """
    place = _ending(path, ".fmu")
    _write(place, fmu(program, sources_only=sources_only))
    return place


def write_plant(path: str | os.PathLike[str], given: Plant) -> Path:
    """Write a plant as MATLAB file (v5): state space with names and units, continuous and between hold and sampler.

    Structures `continuous` and `sampled` (where the loop has a rate) hold A, B, C, D, `step` [s] (0: continuous), inputs, outputs, their
    units and `states`; beside them frequencies [Hz] and damping ratios of the modes, what was simplified, where it is from. Raises
    `DesignError` where the file cannot be written, and for a name that does not end in `.mat`.

    >>> import scipy.io, tempfile
    >>> from flexstage.analysis.loop.example import integral_loop
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = scipy.io.loadmat(write_plant(Path(folder) / "plant.mat", integral_loop().plant), simplify_cells=True)
    >>> found["sampled"]["step"], list(found["sampled"]["inputs"][:2]), found["continuous"]["A"].shape
    (0.0001, ['B', 'ground.x'], (7, 7))
    """
    from scipy.io import savemat

    place, content = _ending(path, ".mat"), io.BytesIO()
    variables: dict[str, Any] = {
        "continuous": _system(given.system, given.states),
        "frequencies_hz": given.frequencies,
        "damping_ratios": given.ratios,
        "note": given.note,
        "provenance": given.provenance,
    }
    if given.hardware.step is not None:
        variables["sampled"] = _system(held(given), ())
    savemat(content, variables, oned_as="column")
    made = bytearray(content.getvalue())
    made[:116] = b"MATLAB 5.0 MAT-file, Platform: any".ljust(116)  # scipy writes the time: the same plant is to be the same file
    _write(place, bytes(made))
    return place


def _system(system: System, states: tuple[str, ...]) -> dict[str, Any]:
    named = states or tuple(f"x{number + 1}" for number in range(len(system.A)))
    return {
        **{name: getattr(system, name) for name in "ABCD"},
        "step": system.step or 0.0,
        "states": _cells(named),
        **_channels("input", system.inputs),
        **_channels("output", system.outputs),
    }


def _channels(kind: str, channels: tuple[Channel, ...]) -> dict[str, Any]:
    return {f"{kind}s": _cells(each.name for each in channels), f"{kind}_units": _cells(each.unit for each in channels)}


def _cells(texts: Any) -> Any:
    return np.array(list(texts), dtype=object).reshape(-1, 1)


def _ending(path: str | os.PathLike[str], suffix: str) -> Path:
    place = Path(path)
    if place.suffix != suffix:
        raise refuse(os.fspath(path), f"its name does not end in {suffix}", f"Call it {identifier(place.stem)}{suffix}")
    return place


def _write(place: Path, content: bytes) -> None:
    with atomic_write(place) as beside:
        beside.write_bytes(content)
