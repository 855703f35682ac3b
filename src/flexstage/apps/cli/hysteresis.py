"""The command `hysteresis`: a stack's hysteresis and creep from records of volts and stroke."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexstage.apps.cli.answer import Asked, answer
from flexstage.apps.cli.identify import Report, writable
from flexstage.apps.cli.options import Json
from flexstage.apps.cli.output import STDOUT, announced, write
from flexstage.apps.cli.record import Rate, Said, Units, opened_records
from flexstage.apps.cli.speech import warn

if TYPE_CHECKING:
    from flexstage.readings.measured.record import Record
    from flexstage.studies.hysteresis import StackTest


def hysteresis(  # noqa: PLR0913 (its options)
    record: Annotated[
        Path,
        typer.Argument(help="File of the test: universal file, MAT, HDF5 or CSV.", metavar="RECORD", show_default=False),
    ],
    *,
    volts: Annotated[
        str | None, typer.Option("--volts", metavar="NAME", help="Channel of the volts. Default: the one in volts.", show_default=False)
    ] = None,
    stroke: Annotated[
        str | None,
        typer.Option("--stroke", metavar="NAME", help="Channel of the stroke. Default: the one in a length.", show_default=False),
    ] = None,
    step: Annotated[
        Path | None,
        typer.Option("--step", metavar="RECORD", help="Record of a step of the volts, for creep.", show_default=False),
    ] = None,
    limits: Annotated[
        tuple[str, str] | None,
        typer.Option("--limits", metavar="LOW HIGH", help='Volts of the stack, e.g. --limits "0 V" "1000 V".', show_default=False),
    ] = None,
    units: Units = None,
    rate: Rate = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="STACK.TOML", help="Hysteresis file to write, for the loop.", show_default=False),
    ] = None,
    json: Json = None,
    report: Report = None,
) -> None:
    """Identify the hysteresis of a stack.

    From a record of volts and stroke: a Prandtl-Ishlinskii model that has an inverse, sized on parts of the record that are not fitted.

    With the record of a step, its creep.
    """
    writable([record, *([] if step is None else [step])], None, [("--output", output), ("--json", json), ("--report", report)])
    said = Said(None, None, None, units, rate, "record", None, None, None)
    found = _identified(said, record, step, (volts, stroke, limits))
    for caution in found.found.cautions:
        warn(caution)
    if output is not None:
        from flexstage.analysis.loop.hysteresis.stack import dumps_hysteresis

        _written(output, dumps_hysteresis(found.stack), "--output")
    if report is not None:
        from flexstage.present.hysteresis_report import hysteresis_report

        _written(report, hysteresis_report(found), "--report")
    if json is None and STDOUT in (str(report), str(output)):
        return
    from flexstage.present.documents.hysteresis import hysteresis_body
    from flexstage.present.tables.hysteresis import plays_table, stack_table

    answer(Asked("hysteresis", None, None, json), lambda: hysteresis_body(found), lambda: [stack_table(found), plays_table(found)])


def _identified(said: Said, record: Path, step: Path | None, named: tuple[str | None, str | None, tuple[str, str] | None]) -> StackTest:
    from flexstage.studies.hysteresis import Channels, stack_test

    volts, stroke, limits = named
    between = None if limits is None else _volts(limits)
    opened = [_record(each, said) for each in (record, step) if each is not None]
    return stack_test(opened[0], Channels(volts, stroke), step=opened[1] if step is not None else None, limits=between)


def _record(path: Path, said: Said) -> Record:
    from flexstage.base.finding import refuse
    from flexstage.readings.measured.record import Record

    (found,) = opened_records([path], said.options())
    if not isinstance(found, Record):
        raise refuse(str(path), "it holds frequency responses, which show no hysteresis", "Give a record of volts and stroke over time")
    return found


def _volts(limits: tuple[str, str]) -> tuple[float, float]:
    from flexstage.base.finding import refuse
    from flexstage.base.quantity import VOLTAGE
    from flexstage.base.unit import parse

    low, high = (parse(text, VOLTAGE, where="--limits") for text in limits)
    if low >= high:
        raise refuse("--limits", f"{limits[0]} to {limits[1]} is no range", "Give the lower voltage first")
    return low, high


def _written(target: Path, text: str, option: str) -> None:
    write(target, text, option)
    if str(target) != STDOUT:
        announced(f"Wrote {target}")
