"""The command `identify`: identify the modes of a stage from records of a test."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from flexstage.base.record import SideBySide
from flexstage.experiment.comparison import compare
from flexstage.experiment.pipeline import Identification
from flexstage.experiment.record_options import Moved, RecordTexts, identify_records, shapes_on
from flexstage.experiment.shapes_on_stage import StageShapes
from flexstage.experiment.show.report import identify_report
from flexstage.experiment.show.tables import identified_table, measured_shape_table, recorded_table
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.design import elastic_model, open_design
from flexstage.show.command.options import text_option
from flexstage.show.command.terminal import print_warning
from flexstage.show.table import Table, result_table

Records: TypeAlias = Annotated[
    list[Path],
    typer.Argument(help="Files of one test: UFF, MAT, HDF5 or CSV. Repeatable.", metavar="RECORD...", show_default=False),
]


@command("report")
def identify(
    records: Records,
    *,
    stage: Annotated[
        Path | None, text_option("--stage", "STAGE.TOML", "Design file of the tested stage, to convert mode shapes to its motions.")
    ] = None,
    texts: RecordTexts,
    excitation: Moved = None,
) -> CommandResult:
    """Find the modes in records of a test.

    Prints frequencies and damping with 95 % confidence intervals, and mode shapes. The identification is automatic.

    The command refuses a record with faulty channels, unless you accept the fault with --accept-fault.
    """
    texts = replace(texts, excitation=excitation)
    mechanism = None if stage is None else open_design(stage)
    seen = identify_records(records, texts, None if mechanism is None else elastic_model(mechanism, Model.LUMPED))
    seen = seen if mechanism is None else _with_doubts(mechanism, seen)
    shapes = None if mechanism is None else shapes_on(mechanism, seen)
    page = partial(identify_report, seen, mechanism, shapes)
    return CommandResult(mechanism, lambda: _body(seen, shapes), lambda: _tables(seen), page)


def _with_doubts(mechanism: Mechanism, seen: Identification) -> Identification:
    """Add and print a warning for every channel that appears exchanged, inverted or scaled compared with the stage's model."""
    named = {channel.name for channel in elastic_model(mechanism, Model.LUMPED).outputs}
    if not any(channel.name in named for channel in seen.found.outputs) or not len(seen.found.frequencies):
        return seen
    doubts = tuple(f"{each}." for each in compare(mechanism, seen.found).misnamed)
    for each in doubts:
        print_warning(each)
    return replace(seen, found=replace(seen.found, data_warnings=(*seen.found.data_warnings, *doubts))) if doubts else seen


def _body(seen: Identification, shapes: StageShapes | None) -> SideBySide:
    return SideBySide((seen, seen.found, {} if shapes is None else {"platform": shapes}))


def _tables(seen: Identification) -> Iterator[Table | None]:
    yield recorded_table(seen.test)
    yield identified_table(seen.found)
    yield result_table(seen.found.peaks)
    yield measured_shape_table(seen.found) if len(seen.found.frequencies) else None
