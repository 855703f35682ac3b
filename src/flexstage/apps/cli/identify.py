"""Commands of tests: `identify`, `compare`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from flexstage.apps.cli.answer import Asked, answer, elastic_model
from flexstage.apps.cli.options import Changes, Json, Theory
from flexstage.apps.cli.output import STDOUT, announced, output_findings, write
from flexstage.apps.cli.record import Allow, Band, Inputs, Kind, Only, Outputs, Rate, Resolution, Said, Units, opened_records, told
from flexstage.apps.cli.speech import tell, warn
from flexstage.studies.reading import Reading

if TYPE_CHECKING:
    from flexstage.mechanism.mechanism import Mechanism
    from flexstage.present.table import Table
    from flexstage.readings.linear.model import LinearModel
    from flexstage.studies.fea_modes import FeaModes
    from flexstage.studies.identification import Identification
    from flexstage.studies.measured_shapes import StageShapes

Records: TypeAlias = Annotated[
    list[Path],
    typer.Argument(
        help="Files of one test: universal files, MAT, HDF5 or CSV. Several are put together.", metavar="RECORD...", show_default=False
    ),
]
Report: TypeAlias = Annotated[
    Path | None, typer.Option("--report", metavar="FILE", help="Write a self-contained HTML report with pictures.", show_default=False)
]


def identify(  # noqa: PLR0913 (its options)
    records: Records,
    *,
    stage: Annotated[
        Path | None, typer.Option("--stage", metavar="STAGE.TOML", help="Draw the shapes on this stage.", show_default=False)
    ] = None,
    inputs: Inputs = None,
    outputs: Outputs = None,
    only: Only = None,
    units: Units = None,
    rate: Rate = None,
    kind: Kind = None,
    allow: Allow = None,
    band: Band = None,
    resolution: Resolution = None,
    json: Json = None,
    report: Report = None,
) -> None:
    """Find the modes in records of a test.

    Frequencies, damping and shapes with 95 % intervals, from white or other noise at the inputs; nothing is picked by hand.

    Bad channels are named and explained, and used only as far as --allow says.
    """
    said = Said(inputs, outputs, only, units, rate, kind, allow, band, resolution)
    writable(records, stage, [("--json", json), ("--report", report)])
    mechanism = None if stage is None else _loaded(stage)
    seen = identified(said, records, None if mechanism is None else elastic_model(mechanism, Reading.LUMPED))
    shapes = None if mechanism is None else _shapes(mechanism, seen)
    if report is not None:
        from flexstage.present.measured_report import identify_report

        _reported(report, identify_report(seen, mechanism, shapes))
    if json is None and str(report) == STDOUT:
        return
    from flexstage.present.documents.measured import identify_body
    from flexstage.present.tables.measured import identified_table, measured_shape_table, peak_table, recorded_table

    def tables() -> Iterator[Table | None]:
        yield recorded_table(seen.test)
        yield identified_table(seen.found)
        yield peak_table(seen.found.peaks)
        yield measured_shape_table(seen.found) if len(seen.found.frequencies) else None

    answer(Asked("identify", mechanism, None, json), lambda: identify_body(seen, shapes), tables)


def compare(  # noqa: PLR0913 (its options)
    design: Annotated[Path, typer.Argument(help="Design file (TOML).", metavar="STAGE.TOML", show_default=False)],
    *,
    record: Annotated[
        list[Path],
        typer.Option("--record", metavar="RECORD", help="File of the test. May be given several times.", show_default=False),
    ],
    reading: Theory = Reading.LUMPED,
    fea: Annotated[bool, typer.Option("--fea", help="Compute finite elements where the cache does not have them.")] = False,
    inputs: Inputs = None,
    outputs: Outputs = None,
    only: Only = None,
    units: Units = None,
    rate: Rate = None,
    kind: Kind = None,
    allow: Allow = None,
    band: Band = None,
    resolution: Resolution = None,
    changes: Changes = None,
    json: Json = None,
    report: Report = None,
) -> None:
    """Theory, FEA and experiment side by side.

    Modes are paired by their shapes at the sensors, which bear the names of the stage's gauges; repeated modes as a subspace.

    FEA is shown where the cache holds all of it, else with --fea.
    """
    said = Said(inputs, outputs, only, units, rate, kind, allow, band, resolution)
    writable(record, design, [("--json", json), ("--report", report)])
    mechanism = _loaded(design, changes)
    model = elastic_model(mechanism, reading)
    seen = identified(said, record, model, highest=_highest(mechanism, model))
    from flexstage.present.documents.measured import compare_body
    from flexstage.present.sections.measured import compare_tables
    from flexstage.studies.compare import compare as compared

    found = compared(mechanism, seen.found, _fea(mechanism, computing=fea), reading=reading)
    for caution in found.warnings[len(seen.found.warnings) :]:
        warn(caution)
    if report is not None:
        from flexstage.present.measured_report import compare_report

        _reported(report, compare_report(found, seen, mechanism, _shapes(mechanism, seen)))
    if json is not None or str(report) != STDOUT:
        answer(Asked("compare", mechanism, reading, json), lambda: compare_body(found), lambda: compare_tables(found)[:-1])


def writable(records: list[Path], design: Path | None, outputs: list[tuple[str, str | Path | None]]) -> None:
    """Raises `DesignError` where an output cannot be written, or would overwrite a record or the design."""
    from flexstage.base.finding import Finding, require

    read = {path.resolve(): "a record that is read" for path in records}
    clashes = [
        Finding(option, f"{target} is {read[Path(target).resolve()]}", "Choose another file")
        for option, target in outputs
        if target is not None and str(target) != STDOUT and Path(target).resolve() in read
    ]
    require([*output_findings(outputs, design), *clashes])


def _loaded(design: Path, changes: list[str] | None = None) -> Mechanism:
    from flexstage.apps.cli.opening import changed
    from flexstage.mechanism.store import load

    return changed(load(design), changes or ())


def identified(said: Said, records: list[Path], model: LinearModel | None, highest: float | None = None) -> Identification:
    """The modes of the records, each caution told."""
    options, search, needs = said.options(), said.search(), said.needs(model, highest)
    from flexstage.studies.identification import identification, sound

    with told() as progress:
        test = sound(opened_records(records, options), options.allow, needs, progress)
        seen = identification(test, search, progress)
    for caution in seen.found.warnings:
        warn(caution)
    return seen


def _highest(mechanism: Mechanism, model: LinearModel) -> float:
    from flexstage.studies.complete import platform_modes

    return float(platform_modes(mechanism, model).platform_frequencies[-1])


def _shapes(mechanism: Mechanism, seen: Identification) -> StageShapes:
    from flexstage.readings.ideal import ideal
    from flexstage.studies.measured_shapes import stage_shapes

    found = stage_shapes(ideal(mechanism), seen.found)
    if found.missing:
        tell(f"not given: shapes on the stage: {found.missing}")
    return found


def _fea(mechanism: Mechanism, *, computing: bool) -> FeaModes | None:
    """FEA from the cache, or computed if asked for; where there is none it is said how to get it."""
    from flexstage.readings.solid.cache import Cache
    from flexstage.studies.fea_modes import fea_modes, kept_fea_modes

    if computing:
        return _computed(mechanism, fea_modes)
    found = kept_fea_modes(mechanism, Cache())
    if found is None:
        tell("not given: FEA: the cache does not hold this stage; --fea computes it")
    return found


def _computed(mechanism: Mechanism, compute: Callable[..., FeaModes]) -> FeaModes:
    from flexstage.apps.cli.bar import bar
    from flexstage.readings.solid.cache import Cache
    from flexstage.readings.solid.parts import Ways
    from flexstage.studies.resolution import DEFAULT
    from flexstage.studies.solid_read import solids

    with bar() as shown:
        return compute(mechanism, DEFAULT, solids(Ways(Cache(), shown.step), lambda finding: warn(str(finding))))


def _reported(target: Path, text: str) -> None:
    write(target, text, "--report")
    if str(target) != STDOUT:
        announced(f"Wrote {target}")
