"""Functional mock-up units as files: description, sources, and the library for this computer."""

from __future__ import annotations

import io
import platform
import sys
import zipfile
from collections.abc import Mapping
from importlib.resources import files

from flexstage.base.finding import refuse
from flexstage.control.export.code.program import FLAGS, Program, Signal
from flexstage.control.export.compiler import compile_source
from flexstage.control.export.fmu.description import description, guid

_LONG_AGO = (1980, 1, 1, 0, 0, 0)
_FOLDERS = {("linux", "x86_64"): ("linux64", "so"), ("darwin", "x86_64"): ("darwin64", "dylib")}


def fmu(program: Program, *, sources_only: bool = False) -> bytes:
    """Build an FMI 2.0 co-simulation unit (`.fmu`) of a program: `modelDescription.xml`, sources, and a library for this computer.

    The program's samples follow each other at its sampling period, from the start time. A communication step runs all samples that lie
    within it, with the inputs set before it. Equal programs and compilers give identical bytes. With `sources_only`, the unit contains no
    library. Otherwise, `DesignError` is raised if there is no compiler, or if FMI 2.0 has no name for this type of computer.

    >>> from flexstage.control.export.code.controller import controller_code
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> made = fmu(controller_code(machine(example.plant, example.controller)), sources_only=True)
    >>> zipfile.ZipFile(io.BytesIO(made)).namelist()[:3]
    ['modelDescription.xml', 'sources/controller.c', 'sources/controller.h']
    """
    texts = fmu_sources(program)
    members: dict[str, bytes] = {"modelDescription.xml": description(program, [name for name in texts if name.endswith(".c")])}
    members |= {f"sources/{name}": text.encode() for name, text in texts.items()}
    if not sources_only:
        kind = sys.platform, platform.machine()
        if kind not in _FOLDERS:
            what = f"libraries of {kind[0]} on {kind[1]} have no FMI 2.0 name, or cannot be built"
            raise refuse("functional mock-up unit", what, "Write the unit with sources only: the importer compiles them")
        folder, suffix = _FOLDERS[kind]
        members[f"binaries/{folder}/{program.name}.{suffix}"] = compile_source("a functional mock-up unit", texts, FLAGS)
    return _zip(members)


def fmu_sources(program: Program) -> dict[str, str]:
    """Generate the sources of a unit by file name: the program, its FMI functions, and the header that connects them.

    >>> from flexstage.control.export.code.product import Code
    >>> sorted(fmu_sources(Program("none", (), 1.0, (), (), (), Code())))
    ['fmi2.c', 'model.h', 'none.c', 'none.h']
    """
    name = program.name
    runtime = files("flexstage.control.export.fmu").joinpath("fmi2.c").read_text(encoding="utf-8")
    return {f"{name}.c": program.source, f"{name}.h": program.header, "fmi2.c": runtime, "model.h": _shared_name(program)}


def _shared_name(program: Program) -> str:
    name = program.name
    lines = [
        "/* The program called by the FMI 2.0 functions. */",
        "#ifndef MODEL_H",
        "#define MODEL_H",
        "",
        f'#include "{name}.h"',
        "",
        f"typedef {name}_state model_state;",
        f"typedef {name}_input model_input;",
        f"typedef {name}_output model_output;",
        f"#define MODEL_INIT {name}_init",
        f"#define MODEL_STEP {name}_step",
        f"#define MODEL_PERIOD {name.upper()}_PERIOD",
        f"#define MODEL_INPUTS {_count(program.inputs)}",
        f"#define MODEL_OUTPUTS {_count(program.outputs)}",
        f'#define MODEL_GUID "{guid(program)}"',
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def _count(signals: tuple[Signal, ...]) -> int:
    return sum(len(signal.channels) for signal in signals)


def _zip(members: Mapping[str, bytes]) -> bytes:
    """Archive without times: equal members give equal bytes."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, value in members.items():
            entry = zipfile.ZipInfo(name, _LONG_AGO)
            entry.external_attr, entry.compress_type = 0o644 << 16, zipfile.ZIP_DEFLATED
            archive.writestr(entry, value)
    return content.getvalue()
