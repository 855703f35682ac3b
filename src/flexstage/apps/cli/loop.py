"""The command `loop`: the control loop of a stage, from a commanded pose to nanometres, and its controller out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexstage.apps.cli.answer import Asked, answer
from flexstage.apps.cli.bar import bar
from flexstage.apps.cli.loop_options import (
    Amplifier,
    Bandwidth,
    Compensate,
    Coordinates,
    Delay,
    FloorNoise,
    GaugeNoise,
    Hysteresis,
    Kind,
    Moves,
    Rate,
    ReadBy,
    Resolution,
    Said,
    Seconds,
    Seed,
    Sensitivity,
    Setup,
    Trajectory,
)
from flexstage.apps.cli.opening import announce, opened
from flexstage.apps.cli.options import Changes, Design, Json
from flexstage.apps.cli.output import STDOUT, announced, write

if TYPE_CHECKING:
    from flexstage.mechanism.mechanism import Mechanism
    from flexstage.present.table import Table
    from flexstage.studies.loop.setup import LoopSetup
    from flexstage.studies.loop.study import LoopStudy

Report = Annotated[
    Path | None, typer.Option("--report", metavar="FILE", help="Write a self-contained HTML report with pictures.", show_default=False)
]
Exports = Annotated[
    list[Path] | None,
    typer.Option(
        "--export",
        metavar="FILE",
        help="Write the loop for other programs: plant.mat, controller.c, controller.fmu; several times.",
        show_default=False,
    ),
]
Example = Annotated[
    Path | None,
    typer.Option("--example", metavar="LOOP.TOML", help="Write a commented set-up file to start from, and stop.", show_default=False),
]


def loop(  # noqa: PLR0913  a loop has that many knobs
    design: Design,
    *,
    setup: Setup = None,
    controller: Kind = None,
    coordinates: Coordinates = None,
    bandwidth: Bandwidth = None,
    sensitivity: Sensitivity = None,
    rate: Rate = None,
    delay: Delay = None,
    trajectory: Trajectory = None,
    command: Moves = None,
    seconds: Seconds = None,
    compensate: Compensate = None,
    hysteresis: Hysteresis = None,
    floor: FloorNoise = None,
    gauge_noise: GaugeNoise = None,
    resolution: Resolution = None,
    amplifier: Amplifier = None,
    seed: Seed = None,
    reading: ReadBy = None,
    changes: Changes = None,
    json: Json = None,
    report: Report = None,
    export: Exports = None,
    example: Example = None,
) -> None:
    """Close the control loop of a stage.

    Tunes a controller, judges its stability and margins, simulates steps or a trajectory, and says whose the remaining noise is.

    With nothing else given: a PI controller with notches, as fast as a margin of 6 dB lets it be, at 10 kHz, one sample late.
    """
    outputs = [("--json", json), ("--report", report), ("--example", example), *_exports(export or [])]
    if example is not None:
        _write_example(design, example)
        return
    _require_names(export or [])
    said = Said(
        file=setup,
        reading=reading,
        rate=rate,
        delay=delay,
        kind=controller,
        coordinates=coordinates,
        bandwidth=bandwidth,
        sensitivity=sensitivity,
        compensate=compensate,
        hysteresis=hysteresis,
        floor=floor,
        gauge_noise=gauge_noise,
        resolution=resolution,
        amplifier=amplifier,
        trajectory=trajectory,
        moves=command,
        seconds=seconds,
        seed=seed,
    )
    asked = said.setup()
    mechanism = opened(design, changes, outputs)
    found = _studied(mechanism, asked)
    _reported(found, report)
    _exported(found, export or [])
    if json is None and str(report) == STDOUT:
        return
    from flexstage.present.documents.loop import loop_body

    answer(Asked("loop", mechanism, asked.reading, json, found.cautions), lambda: loop_body(found), lambda: _tables(found))


def _write_example(design: Path, example: Path) -> None:
    from flexstage.apps.cli.output import output_findings
    from flexstage.base.finding import require
    from flexstage.studies.loop.file import example as commented

    require(output_findings([("--example", example)], design))
    write(example, commented(), "--example")
    announced(f"Wrote {example}. Next: flexstage loop {design} --setup {example}")


def _studied(mechanism: Mechanism, asked: LoopSetup) -> LoopStudy:
    from flexstage.studies.loop.study import loop_study

    with bar() as shown:
        return loop_study(mechanism, asked, tell=shown.share)


def _reported(found: LoopStudy, report: Path | None) -> None:
    if report is None:
        return
    from flexstage.present.loop_report import loop_report

    write(report, loop_report(found), "--report")
    if str(report) != STDOUT:
        announce(report)


def _exports(targets: list[Path]) -> Iterator[tuple[str, Path]]:
    """Files that exports come as: source and header of what is C."""
    for target in targets:
        yield from (("--export", each) for each in ((target, target.with_suffix(".h")) if target.suffix == ".c" else (target,)))


def _require_names(targets: list[Path]) -> None:
    """Refuse what no export is, before anything is computed."""
    from flexstage.base.finding import Finding, require
    from flexstage.present.loop_files import export_findings

    require(Finding(f"--export {each.where}", each.what, each.advice) for target in targets for each in export_findings(target))


def _exported(found: LoopStudy, targets: list[Path]) -> None:
    from flexstage.analysis.loop.code.text import identifier

    for target in targets:
        for place, content in _export(found, target).items():
            write(place, content, "--export")
            announce(place)
        if target.suffix == ".fmu" and (name := identifier(target.stem)) != target.stem:
            announced(f"Within {target} the model is called {name}: its own name would not do in C.")


def _export(found: LoopStudy, target: Path) -> Mapping[Path, str | bytes]:
    """What is written for one option, by file."""
    from flexstage.analysis.loop.code.controller import controller_code
    from flexstage.present.fmu.unit import fmu
    from flexstage.present.loop_files import controller_files, plant_file
    from flexstage.studies.loop.runs import driven_machine

    if target.suffix == ".mat":
        return {target: plant_file(found.settled.plant)}
    machine = driven_machine(found.settled, found.control, found.stacks)
    about = f"{found.settled.mechanism.name or 'stage'}: {found.verdict.sentence}"
    if target.suffix == ".c":
        return controller_files(target, machine, about)
    return {target: fmu(controller_code(machine, target.stem, about))}


def _tables(found: LoopStudy) -> Iterator[Table | None]:
    from flexstage.present.tables import loop as tables
    from flexstage.present.tables import loop_error as errors

    yield tables.loop_table(found)
    yield tables.law_table(found)
    yield tables.margin_table(found)
    yield tables.step_table(found.runs)
    yield tables.tracking_table(found.runs)
    yield errors.rest_table(found.rest)
    yield errors.noise_table(found)
    if found.stacks is not None and found.sweep is not None:
        yield errors.hysteresis_table(found.stacks, found.sweep)
