"""The command `loop`: analyse the control loop of a stage and export its controller."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexstage.base.finding import Finding, require
from flexstage.base.lazy import LazyModule
from flexstage.base.processes.jobs import cores
from flexstage.control.export.code.precision import Precision
from flexstage.control.loop_files import file_findings, require_names, write_export, write_hardware, written_files
from flexstage.control.loop_options import LoopOptions
from flexstage.control.show import tables
from flexstage.control.study import setup as forms
from flexstage.control.study.checks import setup_findings
from flexstage.control.study.compare import Comparison, compare_controllers
from flexstage.control.study.file import example as commented_example
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.experiment.pipeline import Identification, identification, usable_measurement
from flexstage.experiment.progress import ProgressCallback, followed
from flexstage.experiment.record_options import RECORD, AcceptFault, Arrays, Channels, Inputs, Outputs, RecordTexts, Units, open_records
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.design import Lumped
from flexstage.show.command.displaced import CommandStage, OperatingPointOptions, command_stage
from flexstage.show.command.models import Models
from flexstage.show.command.options import (
    FEA,
    Full,
    text_option,
)
from flexstage.show.command.output import announce, require_writable, write
from flexstage.show.command.progress import progress_bar
from flexstage.show.table import Table

if TYPE_CHECKING:
    from flexstage.control.show import report as pages
else:
    pages = LazyModule("flexstage.control.show.report")  # figures, scenes and sections: thirty modules


@command("report", "export", "hardware")
def loop(  # noqa: PLR0913  a loop has that many knobs
    context: typer.Context,
    mechanism: Lumped,
    options: LoopOptions,
    place: OperatingPointOptions,
    *,
    compare: Annotated[bool, typer.Option("--compare", help="Compare PI, PID, integral resonant control and LQG.")] = False,
    fea: Annotated[bool, FEA] = False,
    record: Annotated[list[Path] | None, RECORD] = None,
    inputs: Inputs = None,
    outputs: Outputs = None,
    channels: Channels = None,
    units: Units = None,
    arrays: Arrays = None,
    accept_fault: AcceptFault = None,
    export: Annotated[
        list[Path] | None,
        text_option(
            "--export",
            "FILE",
            "File to export: the plant (.mat), the controller (.c, .fmu), the whole loop (.loop.fmu), or the path of --tracking (.csv). "
            "Repeatable.",
        ),
    ] = None,
    hardware: Annotated[Path | None, text_option("--hardware", "FILE.c", "Write the controller in C: FILE.c, FILE.h, FILE_test.c.")] = None,
    full: Full = False,
    float32: Annotated[bool, typer.Option("--float32", help="Use 32-bit floating-point numbers in the code of --hardware.")] = False,
    example: Annotated[Path | None, text_option("--example", "LOOP.TOML", "Commented set-up file to write; nothing is computed.")] = None,
) -> CommandResult | None:
    """Close the control loop of a stage.

    Tunes a controller, and prints bandwidth, stability margins, settling time and positioning noise by source.

    By default, the plant is the lumped model, sampled at 10 kHz with one sample of delay (fast stages: at a higher rate). The controller is
    PI with notch filters, or PID for force-driven stages. The controller is tuned by optimisation with a peak sensitivity Ms of at most 2
    (6 dB). With --quick, it is tuned without optimisation.

    With --at, --load, --fixed or --temperature, the plant is linearised at that operating point.

    With --record, the plant is the identified model of the test. With --fea, the plant is a finite-element model of the nominal stage,
    with frequencies accurate to 1 %.

    Example of a comparison: flexstage loop stage.toml --floor VC-D --tune-for balance --compare --report loops.html
    """
    if example is not None:
        write(example, commented_example(), "--example")
        announce(f"Wrote {example}. Next: flexstage loop {context.params['design']} --setup {example}")
        return None
    exports = export or []
    require_names(exports, hardware)
    own = [(f"--{name}", context.params[name]) for name in ("json", "xlsx", "report")]
    require_writable([*own, *written_files(exports, hardware)])
    texts = RecordTexts(inputs, outputs, channels, units, arrays=arrays, accept_fault=accept_fault)
    if not record:
        texts.require_unsaid()
    asked, findings = options.read()
    require([*findings, *setup_findings(asked), *file_findings(asked, exports, hardware)])
    require(_fea_findings(place, options.model) if fea else ())
    if compare:
        _require_comparable(asked, {"--export": bool(exports), "--hardware": hardware is not None})
    models: Models = context.obj
    solid = models.modes("solid")(mechanism, computing=True) if fea else None
    stands = CommandStage(mechanism, asked.model) if fea else command_stage(mechanism, place, asked.model)
    model = None if fea else asked.model
    with progress_bar() as shown:
        test = _identified(record, texts, shown.share)
        on: dict[str, Any] = {"there": stands.operating_point, "solid": solid, "test": test, "tell": shown.share}
        if compare:
            return _compared(compare_controllers(mechanism, asked, workers=cores(), **on), asked, stands, model)
        found = loop_study(mechanism, asked, **on)
    for target in exports:
        write_export(found, target)
    if hardware is not None:
        write_hardware(found, hardware, Precision.SINGLE if float32 else Precision.DOUBLE)
    return _closed(found, stands, model, full=full)


def _identified(record: list[Path] | None, texts: RecordTexts, tell: ProgressCallback) -> Identification | None:
    """Modes identified from the records, all of one test."""
    if not record:
        return None
    reader = texts.options()
    with followed(tell):
        return identification(usable_measurement(open_records(record, reader), reader.accept_faults))


def _compared(rivals: Comparison, asked: forms.LoopSetup, stands: CommandStage, model: Model | None) -> CommandResult:
    """Result of several controllers on one plant."""
    return CommandResult(
        stands.mechanism,
        lambda: rivals,
        lambda: [*stands.tables(), *tables.comparison_tables(rivals)],
        lambda: pages.comparison_report(stands.mechanism, asked, rivals),
        model,
        (*stands.warnings, *rivals.warnings),
        kind="loops",
    )


def _closed(found: LoopStudy, stands: CommandStage, model: Model | None, *, full: bool) -> CommandResult:
    """Result of one loop."""
    return CommandResult(
        stands.mechanism,
        lambda: stands.body(found) if stands.operating_point is not None else found,
        lambda: [*stands.tables(), *(_tables(found) if full else tables.short_tables(found))],
        lambda: pages.loop_report(found),
        model,
        (*stands.warnings, *found.warnings),
    )


def _fea_findings(where: OperatingPointOptions, model: Model | None) -> Iterator[Finding]:
    """Options that contradict a finite-element plant of the nominal stage."""
    if where:
        yield Finding("--fea", f"finite elements need the nominal stage (got {where.options})", "Remove --fea, or these options")
    if model is not None:
        yield Finding("--fea", f"contradicts --model {model.value}, another plant model", "Remove --fea or --model")


def _require_comparable(asked: forms.LoopSetup, written: Mapping[str, bool]) -> None:
    """Refuse options that belong to one controller."""
    said = {
        **written,
        "controller.kind": asked.controller.kind is not None,
        **{f"controller.{name}": True for name in asked.controller.stated if getattr(asked.controller, name) is not None},
        "controller.loops": bool(asked.controller.loops),
    }
    what = "belongs to one controller, but --compare tunes several kinds"
    require(Finding(name, what, f"Remove {name}") for name, is_said in said.items() if is_said)


def _tables(found: LoopStudy) -> list[Table | str | None]:
    small = None if found.second_order is None else found.second_order.text
    return [
        *tables.loop_tables(found),
        small,
        *tables.margin_tables(found),
        *tables.measured_tables(found),
        *tables.time_tables(found.runs),
        *tables.error_tables(found),
    ]
