"""The command `loop`: the control loop of a stage, from a commanded pose to nanometres, and its controller out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexstage.base.finding import Finding, require
from flexstage.base.lazy import Late
from flexstage.base.processes.jobs import cores
from flexstage.base.units.quantity import (
    DISPLACEMENT,
    FREQUENCY,
    NOISE_DENSITY,
    RATIO,
    TIME,
)
from flexstage.control.export.code.precision import Precision
from flexstage.control.loop_files import file_findings, require_names, write_export, write_hardware, written_files
from flexstage.control.loop_options import (
    Setup,
    compensation,
    floor_setup,
    follow_setup,
    hysteretic_stacks,
    override,
    trajectory_setup,
)
from flexstage.control.show import tables
from flexstage.control.study import setup as forms
from flexstage.control.study.checks import setup_findings
from flexstage.control.study.choices import Axes, Compensation, Following
from flexstage.control.study.compare import Comparison, compare_controllers
from flexstage.control.study.file import example as commented_example
from flexstage.control.study.file import load_setup
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.control.tuning.objective import TuningObjective
from flexstage.experiment.pipeline import Identification, identification, usable_measurement
from flexstage.experiment.progress import Told, followed
from flexstage.experiment.record_options import RECORD, AcceptFault, Arrays, Channels, Inputs, Outputs, RecordTexts, Units, open_records
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, write_result
from flexstage.show.command.design import open_design
from flexstage.show.command.displaced import At, Fixed, Footing, Load, Place, Temperature, footing
from flexstage.show.command.models import Models
from flexstage.show.command.options import (
    FEA,
    MODEL,
    AmplifierValues,
    Changes,
    Csv,
    Design,
    GaugeNoise,
    GaugeResolution,
    Json,
    Report,
    Seed,
    Xlsx,
    rate_option,
    text_option,
    word_option,
)
from flexstage.show.command.output import announce, require_writable, write
from flexstage.show.command.progress import progress_bar
from flexstage.show.command.values import Values, amplifier_values
from flexstage.show.table import Table

if TYPE_CHECKING:
    from flexstage.control.show import report as pages
else:
    pages = Late("flexstage.control.show.report")  # figures, scenes and sections: thirty modules


def loop(  # noqa: PLR0913  a loop has that many knobs
    context: typer.Context,
    design: Design,
    *,
    setup: Setup = None,
    controller: Annotated[
        str | None,
        text_option(
            "--controller",
            "KIND",
            "Kind of controller: pi, pid, resonant, ppf, pvf or lqg; none for an open loop. Default: pi, with force actuators pid.",
        ),
    ] = None,
    coordinates: Annotated[
        Axes | None,
        word_option("--coordinates", Axes, "Coordinates of the single loops. Default: platform.", show_default=False),
    ] = None,
    bandwidth: Annotated[str | None, text_option("--bandwidth", "VALUE", "Bandwidth to tune to. Default: maximum at the margin.")] = None,
    tune_for: Annotated[
        TuningObjective | None,
        word_option("--tune-for", TuningObjective, "Objective of optimisation-based tuning. Default: none.", show_default=False),
    ] = None,
    compare: Annotated[bool, typer.Option("--compare", help="Comparison of PI, PID, integral resonant control and LQG.")] = False,
    max_sensitivity: Annotated[
        str | None, text_option("--max-sensitivity", "NUMBER", "Maximum peak sensitivity Ms of a tuned loop. Default: 2.")
    ] = None,
    force_feedback: Annotated[
        str | None,
        text_option("--force-feedback", "RATIO", "Modal damping by integral force feedback in the legs, e.g. 50%. Default: none."),
    ] = None,
    tracking: Annotated[
        Following | None,
        word_option(
            "--tracking", Following, "Tracking method of a known path; zv and zvd need a set-up file. Default: none.", show_default=False
        ),
    ] = None,
    rate: Annotated[str | None, rate_option("10 kHz, or 10 times the highest platform mode")] = None,
    delay: Annotated[str | None, text_option("--delay", "VALUE", "Delay from sampling to the new output. Default: one sample.")] = None,
    trajectory: Annotated[
        str | None,
        text_option("--trajectory", "NAME|FILE", "Trajectory: step, raster, spiral, sine, or CSV file of times and poses. Default: step."),
    ] = None,
    amplitude: Annotated[
        list[str] | None,
        text_option("--amplitude", "AXIS=VALUE", "Amplitude of a step or sine, e.g. x=1um. Repeatable. Default: 1 um, 10 urad, all axes."),
    ] = None,
    seconds: Annotated[float | None, text_option("--seconds", "NUMBER", "Duration in seconds. Default: until all has settled.")] = None,
    feedforward: Annotated[
        list[str] | None,
        text_option(
            "--feedforward",
            "NAME",
            f"Feedforward: {', '.join(each.value for each in Compensation)}, or none. Repeatable. Default: lost-motion.",
        ),
    ] = None,
    hysteresis: Annotated[
        str | None,
        text_option("--hysteresis", "FILE|SHARE", "Hysteresis of the stacks: file of a model, or width, e.g. 15%. Default: none."),
    ] = None,
    floor: Annotated[
        list[str] | None,
        text_option("--floor", "[AXIS=]VALUE", 'Floor vibration: VC-D, z=VC-C or "x=3 um/s^2/Hz^0.5". Repeatable. Default: none.'),
    ] = None,
    gauge_noise: GaugeNoise = None,
    resolution: GaugeResolution = None,
    amplifier: AmplifierValues = None,
    seed: Seed = None,
    model: Annotated[Model | None, MODEL] = None,
    fea: Annotated[bool, FEA] = False,
    at: At = None,
    load: Load = None,
    fixed: Fixed = None,
    temperature: Temperature = None,
    record: Annotated[list[Path] | None, RECORD] = None,
    inputs: Inputs = None,
    outputs: Outputs = None,
    channels: Channels = None,
    units: Units = None,
    arrays: Arrays = None,
    accept_fault: AcceptFault = None,
    changes: Changes = None,
    json: Json = None,
    csv: Csv = None,
    xlsx: Xlsx = None,
    report: Report = None,
    export: Annotated[
        list[Path] | None,
        text_option(
            "--export",
            "FILE",
            "Exported file: plant.mat, controller.c, controller.fmu, stage.loop.fmu (whole loop), or with --tracking path.csv. Repeatable.",
        ),
    ] = None,
    hardware: Annotated[
        Path | None, text_option("--hardware", "FILE.c", "Write the controller for a processor of its own: FILE.c, FILE.h, FILE_test.c.")
    ] = None,
    float32: Annotated[bool, typer.Option("--float32", help="32-bit numbers in the code of --hardware, instead of 64-bit.")] = False,
    example: Annotated[Path | None, text_option("--example", "LOOP.TOML", "Write a commented set-up file to start from, and stop.")] = None,
) -> None:
    """Close the control loop of a stage.

    Tunes a controller, judges its stability and margins, simulates steps or a trajectory, and says whose the remaining noise is.

    With nothing else given: the lumped model, a PI controller with notches, as fast as a margin of 6 dB lets it be, at 10 kHz, one
    sample late. Where forces drive the stage, a PID controller.

    With --at, --load, --fixed or --temperature: about that operating point.

    With --record or --fea, the plant is the identified model of the test, or finite elements of the nominal stage to 1 %.

    Kinds side by side: flexstage loop stage.toml --floor VC-D --tune-for balance --compare --report loops.html
    """
    exports = export or []
    if example is not None:
        _write_example(design, example)
        return
    require_names(exports, hardware)
    texts = RecordTexts(inputs, outputs, channels, units, arrays=arrays, accept_fault=accept_fault)
    if not record:
        texts.require_unsaid()
    values = Values()
    given = values.attempt(lambda: forms.LoopSetup() if setup is None else load_setup(setup)) or forms.LoopSetup()
    options = {
        "model": model,
        "rate": values.value("--rate", rate, FREQUENCY),
        "delay": values.value("--delay", delay, TIME),
        "seconds": seconds,
        "seed": seed,
        "compensate": values.attempt(lambda: compensation(feedforward)),
        "amplifier": override(given.amplifier, amplifier_values(values, amplifier or ())),
        "gauges": override(
            given.gauges,
            {
                "noise": values.value("--gauge-noise", gauge_noise, NOISE_DENSITY),
                "resolution": values.value("--resolution", resolution, DISPLACEMENT),
            },
        ),
        "floor": values.attempt(lambda: floor_setup(given.floor, floor or ())),
        "controller": override(
            given.controller,
            {
                "kind": None if controller is None else values.attempt(lambda: forms.KINDS.parse(controller, "--controller")),
                "coordinates": coordinates,
                "goal": None if tune_for is None else override(given.controller.goal or forms.GoalSetup(), {"objective": tune_for}),
                "bandwidth": values.value("--bandwidth", bandwidth, FREQUENCY),
                "sensitivity": values.value("--max-sensitivity", max_sensitivity, RATIO),
            },
        ),
        "damping": None
        if force_feedback is None
        else override(given.damping or forms.DampingSetup(), {"ratio": values.value("--force-feedback", force_feedback, RATIO)}),
        "follow": None if tracking is None else follow_setup(given.follow, tracking),
        "hysteresis": hysteretic_stacks(hysteresis),
        "trajectory": values.attempt(lambda: trajectory_setup(given.trajectory, trajectory, amplitude)),
    }
    asked = override(given, options)
    require([*values.findings, *setup_findings(asked), *file_findings(asked, exports, hardware)])
    where = Place(at, load, fixed, temperature)
    require(_fea_findings(where, model) if fea else ())
    written = [("--json", json), ("--xlsx", xlsx), ("--report", report), *written_files(exports, hardware)]
    mechanism = open_design(design, changes, written)
    models: Models = context.obj
    solid = models.modes("solid")(mechanism, computing=True) if fea else None
    stands = Footing(mechanism, asked.model) if fea else footing(mechanism, where, asked.model)
    if compare:
        _require_comparable(asked, {"--export": bool(exports), "--hardware": hardware is not None})
    with progress_bar() as shown:
        on: dict[str, Any] = {
            "there": stands.operating_point,
            "solid": solid,
            "test": _identified(record, texts, shown.share),
            "tell": shown.share,
        }
        rivals = compare_controllers(mechanism, asked, workers=cores(), **on) if compare else None
        found = None if compare else loop_study(mechanism, asked, **on)
    told, documents = None if fea else asked.model, {"json": json, "xlsx": xlsx, "report": report}
    if rivals is not None:
        write_result("loops", _compared(rivals, asked, stands, told), documents, csv)
    if found is not None:
        for target in exports:
            write_export(found, target)
        if hardware is not None:
            write_hardware(found, hardware, Precision.SINGLE if float32 else Precision.DOUBLE)
        write_result("loop", _closed(found, stands, told), documents, csv)


def _identified(record: list[Path] | None, texts: RecordTexts, tell: Told) -> Identification | None:
    """The modes of the records, all of one test."""
    if not record:
        return None
    reader = texts.options()
    with followed(tell):
        return identification(usable_measurement(open_records(record, reader), reader.accept_faults))


def _compared(rivals: Comparison, asked: forms.LoopSetup, stands: Footing, model: Model | None) -> CommandResult:
    """Controllers side by side."""
    return CommandResult(
        stands.mechanism,
        lambda: rivals,
        lambda: [*stands.tables(), *tables.comparison_tables(rivals)],
        lambda: pages.comparison_report(stands.mechanism, asked, rivals),
        model,
        (*stands.warnings, *rivals.warnings),
    )


def _closed(found: LoopStudy, stands: Footing, model: Model | None) -> CommandResult:
    """One loop."""
    return CommandResult(
        stands.mechanism,
        lambda: stands.body(found) if stands.operating_point is not None else found,
        lambda: [*stands.tables(), *_tables(found)],
        lambda: pages.loop_report(found),
        model,
        (*stands.warnings, *found.warnings),
    )


def _fea_findings(where: Place, model: Model | None) -> Iterator[Finding]:
    """What asks for another model than finite elements of the drawn stage."""
    if where:
        yield Finding(
            "--fea", f"finite elements are of the stage as drawn, and {where.options} brings it elsewhere", "Leave one of them out"
        )
    if model is not None:
        yield Finding("--fea", f"--model {model.value} asks for another model of the plant", "Leave one of them out")


def _require_comparable(asked: forms.LoopSetup, written: Mapping[str, bool]) -> None:
    """Refuse what belongs to one controller."""
    said = {
        **written,
        "controller.kind": asked.controller.kind is not None,
        **{f"controller.{name}": True for name in asked.controller.stated if getattr(asked.controller, name) is not None},
        "controller.loops": bool(asked.controller.loops),
    }
    advice = "Leave it out of a comparison, which tunes each kind itself"
    require(
        Finding(name, "it belongs to one controller, and --compare lays several side by side", advice)
        for name, is_said in said.items()
        if is_said
    )


def _write_example(design: Path, example: Path) -> None:
    require_writable([("--example", example)], [design])
    write(example, commented_example(), "--example")
    announce(f"Wrote {example}. Next: flexstage loop {design} --setup {example}")


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
