"""The command `compare`: theory, FEA and the test of a stage side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexstage.analysis.complete import platform_modes
from flexstage.experiment import comparison
from flexstage.experiment.record_options import (
    RECORD,
    AcceptFault,
    Arrays,
    Band,
    Channels,
    FrequencyResolution,
    Inputs,
    Kind,
    Moved,
    Outputs,
    Rate,
    RecordTexts,
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
from flexstage.show.command.options import FEA, Changes, Csv, Design, Json, ModelName, Report, Xlsx
from flexstage.show.command.output import require_writable, save
from flexstage.show.command.terminal import print_warning


def compare(  # noqa: PLR0913 (its options)
    context: typer.Context,
    design: Design,
    *,
    record: Annotated[list[Path], RECORD],
    model: ModelName = Model.LUMPED,
    fea: Annotated[bool, FEA] = False,
    inputs: Inputs = None,
    outputs: Outputs = None,
    channels: Channels = None,
    units: Units = None,
    rate: Rate = None,
    arrays: Arrays = None,
    kind: Kind = None,
    accept_fault: AcceptFault = None,
    band: Band = None,
    frequency_resolution: FrequencyResolution = None,
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
    texts = RecordTexts(inputs, outputs, channels, units, rate, kind, accept_fault, band, frequency_resolution, arrays, excitation)
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
