"""The command `compare`: theory, FEA and the test of a stage side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexstage.analysis.complete import platform_modes
from flexstage.experiment import comparison
from flexstage.experiment.record_options import (
    Allow,
    Arrays,
    Band,
    Inputs,
    Kind,
    Moved,
    Only,
    Outputs,
    Rate,
    RecordTexts,
    Resolution,
    Units,
    identify_records,
    shapes_on,
)
from flexstage.experiment.show.report import compare_report
from flexstage.experiment.show.sections import compare_tables
from flexstage.models.theory import Model
from flexstage.show.command.answer import answer
from flexstage.show.command.design import elastic_model, open_design
from flexstage.show.command.models import Models
from flexstage.show.command.options import Changes, Csv, Design, Json, ModelName, Report, Xlsx, text_option
from flexstage.show.command.output import require_writable, save
from flexstage.show.command.terminal import print_warning


def compare(  # noqa: PLR0913 (its options)
    context: typer.Context,
    design: Design,
    *,
    record: Annotated[list[Path], text_option("--record", "RECORD", "File of the test. May be given several times.")],
    model: ModelName = Model.LUMPED,
    fea: Annotated[bool, typer.Option("--fea", help="Compute finite elements where the cache does not have them.")] = False,
    inputs: Inputs = None,
    outputs: Outputs = None,
    only: Only = None,
    units: Units = None,
    rate: Rate = None,
    arrays: Arrays = None,
    kind: Kind = None,
    allow: Allow = None,
    band: Band = None,
    resolution: Resolution = None,
    excitation: Moved = None,
    changes: Changes = None,
    json: Json = None,
    csv: Csv = None,
    xlsx: Xlsx = None,
    report: Report = None,
) -> None:
    """Theory, FEA and experiment side by side.

    Modes are paired by their shapes at the sensors, which bear the names of the stage's gauges; repeated modes as a subspace.

    FEA is shown where the cache holds all of it, else with --fea.
    """
    texts = RecordTexts(inputs, outputs, only, units, rate, kind, allow, band, resolution, arrays, excitation)
    require_writable([("--json", json), ("--xlsx", xlsx), ("--report", report)], design, record)
    mechanism = open_design(design, changes)
    linear = elastic_model(mechanism, model)
    highest = platform_modes(mechanism, linear).highest
    seen = identify_records(record, texts, linear, highest)
    models: Models = context.obj
    solid = models.modes("solid")(mechanism, computing=fea)
    found = comparison.compare(mechanism, seen.found, solid, model=model)
    for warning in found.data_warnings[len(seen.found.data_warnings) :]:
        print_warning(warning)
    if report is not None:
        save(report, compare_report(found, seen, mechanism, shapes_on(mechanism, seen)), "--report")
    tables = compare_tables(found)[:-1]
    answer("compare", mechanism, lambda: found, lambda: tables, model=model, json=json, csv=csv, xlsx=xlsx, beside=(report,))
