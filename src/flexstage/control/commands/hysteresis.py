"""The command `hysteresis`: identify hysteresis and creep of a stack from records of voltage and stroke."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from flexstage.base.finding import refuse
from flexstage.base.units.quantity import VOLTAGE
from flexstage.base.units.unit import parse
from flexstage.control.hysteresis.show.report import hysteresis_report
from flexstage.control.hysteresis.show.tables import stack_tables
from flexstage.control.hysteresis.stack import dumps_hysteresis
from flexstage.control.hysteresis.stack_test import Channels, stack_test
from flexstage.experiment.record_options import Arrays, Rate, RecordTexts, Units, open_records
from flexstage.experiment.records.record import Record
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.options import output_option, text_option
from flexstage.show.command.output import save


@command("output", "report")
def hysteresis(  # noqa: PLR0913 (its options)
    record: Annotated[
        Path,
        typer.Argument(help="File of the test: universal file, MAT, HDF5 or CSV.", metavar="RECORD", show_default=False),
    ],
    *,
    volts: Annotated[str | None, text_option("--volts", "NAME", "Channel of the voltage. Default: the channel with the unit V.")] = None,
    stroke: Annotated[
        str | None, text_option("--stroke", "NAME", "Channel of the stroke. Default: the channel with a unit of length.")
    ] = None,
    step: Annotated[Path | None, text_option("--step", "RECORD", "Record of a voltage step, to fit creep.")] = None,
    limits: Annotated[
        tuple[str, str] | None, text_option("--limits", "LOW HIGH", 'Voltage range of the stack, e.g. "0 V" "1000 V".')
    ] = None,
    units: Units = None,
    rate: Rate = None,
    arrays: Arrays = None,
    output: Annotated[Path | None, output_option("STACK.TOML", "Hysteresis file to write, for flexstage loop.")] = None,
) -> CommandResult:
    """Identify the hysteresis of a stack.

    Fits an invertible Prandtl-Ishlinskii model to a record of voltage and stroke. The model is validated on sections of the record that the
    fit does not use.

    With a step record, the command also fits the creep.
    """
    between = None if limits is None else _volts(limits)
    reader = RecordTexts(units=units, rate=rate, kind="record", arrays=arrays)
    cycles, stepped = _open(record, reader), None if step is None else _open(step, reader)
    found = stack_test(cycles, Channels(volts, stroke), step=stepped, limits=between)
    if output is not None:
        save(output, dumps_hysteresis(found.stack), "--output")
    page = partial(hysteresis_report, found)
    return CommandResult(None, lambda: found, lambda: stack_tables(found), page, warnings=found.hysteresis.warnings)


def _open(path: Path, reader: RecordTexts) -> Record:
    (found,) = open_records([path], reader.options())
    if not isinstance(found, Record):
        raise refuse(
            str(path), "record contains frequency responses, which show no hysteresis", "Use a record of voltage and stroke over time"
        )
    return found


def _volts(limits: tuple[str, str]) -> tuple[float, float]:
    low, high = (parse(text, VOLTAGE, where="--limits") for text in limits)
    if low >= high:
        raise refuse(
            "--limits", f"not a range (got {limits[0]} to {limits[1]}, expected the lower voltage first)", "Exchange the two voltages"
        )
    return low, high
