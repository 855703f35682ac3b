"""The command `compare`: compare model, finite elements and test of a stage."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from flexstage.analysis.complete import platform_modes
from flexstage.experiment import comparison
from flexstage.experiment.record_options import RECORD, Moved, RecordTexts, identify_records, shapes_on
from flexstage.experiment.show.report import compare_report
from flexstage.experiment.show.sections import compare_tables
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.design import Lumped, elastic_model, load_notes
from flexstage.show.command.models import Models
from flexstage.show.command.options import FEA, ElasticModelName
from flexstage.show.command.terminal import print_warning


@command("report")
def compare(
    context: typer.Context,
    mechanism: Lumped,
    *,
    record: Annotated[list[Path], RECORD],
    model: ElasticModelName = Model.LUMPED,
    fea: Annotated[bool, FEA] = False,
    texts: RecordTexts,
    excitation: Moved = None,
) -> CommandResult:
    """Compare theory, FEA and experiment.

    Modes are paired by their shapes at the sensors; repeated modes are paired as a subspace. Output
    channels must have the names of gauges or motions of the stage.

    FEA results are included if the cache contains them; with --fea, missing FEA results are computed.
    """
    linear = elastic_model(mechanism, model, loaded=True)
    highest = platform_modes(mechanism, linear).highest
    seen = identify_records(record, replace(texts, excitation=excitation), linear, highest)
    models: Models = context.obj
    solid = models.modes("solid")(mechanism, computing=fea)
    found = comparison.compare(mechanism, seen.found, solid, model=model)
    for warning in found.data_warnings[len(seen.found.data_warnings) :]:
        print_warning(warning)
    return CommandResult(
        mechanism,
        lambda: found,
        lambda: (*load_notes(mechanism, model), *compare_tables(found)[:-1]),
        lambda: compare_report(found, seen, mechanism, shapes_on(mechanism, seen)),
        model=model,
    )
