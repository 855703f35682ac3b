"""Output files of the command `loop`: plants, controllers, whole loops and paths, and checks of these files."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from flexstage.base.finding import Finding, require
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.damping.sampled import SampledLegs, sample_legs
from flexstage.control.export.code.hardware import NO_INVERSE
from flexstage.control.export.code.precision import Precision
from flexstage.control.export.code.text import identifier
from flexstage.control.export.code.whole import loop_code
from flexstage.control.export.files import (
    WHOLE,
    controller_files,
    export_findings,
    hardware_files,
    hardware_findings,
    path_file,
    plant_file,
    whole_controller,
)
from flexstage.control.export.fmu.unit import fmu
from flexstage.control.study import setup as forms
from flexstage.control.study.choices import Compensation, Following
from flexstage.control.study.course import stated_motions
from flexstage.control.study.runs import driven_machine
from flexstage.control.study.study import LoopStudy
from flexstage.show.command.output import announce, write


def written_files(exports: Sequence[Path], hardware: Path | None) -> Iterator[tuple[str, Path]]:
    """List the files that `--export` and `--hardware` write, each with its option. C code has several files."""
    for target in exports:
        yield from (("--export", each) for each in ((target, target.with_suffix(".h")) if target.suffix == ".c" else (target,)))
    if hardware is not None:
        files = (hardware, hardware.with_suffix(".h"), hardware.with_name(f"{hardware.stem}_test.c"))
        yield from (("--hardware", each) for each in files)


def require_names(exports: Sequence[Path], hardware: Path | None) -> None:
    """Raise `DesignError` for invalid file names, before any computation."""
    found = [("--export", each) for target in exports for each in export_findings(target)]
    if hardware is not None:
        found += [("--hardware", each) for each in hardware_findings(hardware)]
    require(Finding(f"{option} {each.where}", each.what, each.advice) for option, each in found)


def write_export(found: LoopStudy, target: Path) -> None:
    """Write one file of `--export`, according to its extension."""
    for path, content in _contents(found, target).items():
        write(path, content, "--export")
        announce(f"Wrote {path}")
    if target.suffix == ".fmu" and (name := identifier(target.stem)) != target.stem:
        announce(f"The model in {target} is named {name}: C code cannot use the name {target.stem}.")


def file_findings(asked: forms.LoopSetup, exports: Sequence[Path], hardware: Path | None) -> Iterator[Finding]:
    """Check that `--hardware` needs no inverse of hysteresis, and that a CSV export has a tracking method and a single path."""
    if hardware is not None and Compensation.HYSTERESIS in asked.compensate:
        yield Finding("--hardware", *NO_INVERSE)
    for target in (each for each in exports if each.suffix == ".csv"):
        if asked.follow is None:
            advice = f"Add --tracking: {', '.join(each.value for each in Following)}"
            yield Finding(f"--export {target}", "without tracking, the commanded path equals the trajectory", advice)
        elif isinstance(asked.trajectory, forms.StepMotion) and len(stated_motions(asked.trajectory.amplitude)) != 1:
            yield Finding(
                f"--export {target}",
                "steps of several coordinates are not one path",
                "Specify a step of one coordinate, e.g. --amplitude x=1um",
            )


def write_hardware(found: LoopStudy, target: Path, precision: Precision) -> None:
    """Write the controller for an embedded processor: source, header and test program."""
    machine, made_of = driven_machine(found.settled, found.controller, found.stacks), found.controller.made_of
    law = made_of if isinstance(made_of, Decentralised) else None
    files = hardware_files(
        target, machine, law, found.runs[0].simulated.reference, precision=precision, about=_about(found), legs=_legs(found)
    )
    for path, content in files.items():
        write(path, content, "--hardware")
        announce(f"Wrote {path}")


def _contents(found: LoopStudy, target: Path) -> Mapping[Path, str | bytes]:
    """Contents of one option, by file."""
    if target.suffix == ".mat":
        return {target: plant_file(found.plant)}
    if target.suffix == ".csv" and (commanded := found.runs[0].commanded) is not None:
        return {target: path_file(commanded, 1.0 / found.settled.rate, found.runs[0].simulated.coordinates)}
    machine = driven_machine(found.settled, found.controller, found.stacks)
    if target.suffix == ".c":
        return controller_files(target, machine, _about(found), _legs(found))
    if target.name.endswith(WHOLE):
        return {target: fmu(loop_code(machine, target.stem))}
    return {target: fmu(whole_controller(machine, target.stem, _about(found), _legs(found)))}


def _legs(found: LoopStudy) -> SampledLegs | None:
    """Sampled force feedback, which is part of the export."""
    inner = found.damping
    if inner is None or inner.rate is None:
        return None
    return sample_legs(inner.law, inner.sensed, inner.rate, round(inner.rate / found.settled.rate))


def _about(found: LoopStudy) -> str:
    """Header comment of exported code: the loop, and inner loops outside it."""
    said = f"{found.settled.mechanism.name or 'stage'}: {found.stability.sentence}"
    if found.damping is None:
        return said
    law, sensed = found.damping.law, found.damping.sensed
    gains = ", ".join(f"{each.actuator} {each.stiffness:.6g} N/m" for each in sensed)
    form = "g/(s + a)" if law.order == 1 else "g s/(s + a)^2"
    numbers = f"g = {law.gain:.6g} 1/s, a = {2.0 * math.pi * law.corner:.6g} 1/s"
    where = "Includes" if found.damping.rate is not None else "Does not include the analogue"
    return f"{said}. {where} force feedback in the legs: stroke = {form} tension / k, {numbers}, k: {gains}."
