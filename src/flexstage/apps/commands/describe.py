"""Commands that describe stages: `new`, `check`, `schema`, `plan`, `catalogue`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from json import dumps as as_json
from pathlib import Path
from typing import Annotated

import typer

from flexstage.analysis.caveats import caveats, model_findings
from flexstage.analysis.loaded.standing import drawn
from flexstage.apps.words import File
from flexstage.base.finding import DesignError, Finding, combine_warnings, refuse, require
from flexstage.base.storage.document import as_text
from flexstage.base.text import printable
from flexstage.base.version import __version__
from flexstage.cases.registry import shipped_case
from flexstage.control.hysteresis.stack import hysteresis_schema
from flexstage.control.study.file import setup_schema
from flexstage.mechanism.geometry.contact import contact_findings
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import loads, shipped_catalogue
from flexstage.mechanism.store import schema as design_schema
from flexstage.mechanism.store.file import read_text
from flexstage.mechanism.store.lines import with_lines
from flexstage.show.command.answer import list_caveats, show
from flexstage.show.command.design import change, open_design
from flexstage.show.command.options import Changes, Design, Json, output_option, text_option
from flexstage.show.command.output import STDOUT, announce, require_writable, write
from flexstage.show.command.terminal import print_result, print_warning
from flexstage.show.document import FORMAT, check_document
from flexstage.show.figures.drawing import drawing, format_of
from flexstage.show.listing import case_table, catalogue_body, catalogue_tables, find_section, parameter_table
from flexstage.show.plan import plan_figure
from flexstage.show.tables.description import composition_table
from flexstage.show.tables.overview import count_text, floating_line
from flexstage.show.viewer.data import still_data
from flexstage.solid.fea.geometry.sound import solid_findings
from flexstage.studies.form import study_schema
from flexstage.studies.synthesis.specification import specification_schema

DEFAULT_CASE = "double-triangle"
SCHEMA_FILE = "flexstage.schema.json"
"""Name of the schema file in the first line of a new design file, for editors. `flexstage schema > FILE` writes it to the same folder."""


def new(
    target: Annotated[Path | None, typer.Argument(metavar="STAGE.TOML", help="File to write.", show_default=False)] = None,
    *,
    case: Annotated[str, typer.Option(metavar="NAME", help="Case to write; --list shows all cases.")] = DEFAULT_CASE,
    case_parameter: Annotated[
        list[str] | None, text_option("--case-parameter", "NAME=VALUE", "Parameter of the case, e.g. long_arm=80mm. Repeatable.")
    ] = None,
    listed: Annotated[bool, typer.Option("--list", help="List the shipped cases.")] = False,
    list_parameters: Annotated[bool, typer.Option("--list-parameters", help="List the parameters of the case.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
) -> None:
    """Write a case (an example stage) as a commented design file."""
    if listed or list_parameters:
        show([case_table() if listed else parameter_table(case)])
        return
    if target is None:
        raise refuse("STAGE.TOML", "missing", "Use e.g. 'flexstage new stage.toml --case hexapod'")
    stated = _stated(case_parameter or ())
    start = shipped_case(case)
    require_writable([(str(target), target)])
    if target.exists() and not force:
        require([Finding(str(target), "file exists", "Choose another name, or overwrite it with --force")])
    text = start.text(stated, _heading(case, start.summary, printable(str(target)), stated))
    write(target, f"#:schema ./{SCHEMA_FILE}\n{text}", str(target))
    announce(f"Wrote {target} ({case}: {start.summary}). Next: flexstage analyse {target}")


def _stated(assignments: Sequence[str]) -> dict[str, str]:
    """Names and values of parameters."""
    split = [each.partition("=") for each in assignments]
    advice = "Use e.g. --case-parameter long_arm=80mm"
    require(Finding(f'--case-parameter "{name}"', "value missing", advice) for name, equals, _ in split if not equals)
    names = [name.strip() for name, _, _ in split]
    twice = {name for name in names if names.count(name) > 1}
    require(Finding(f"--case-parameter {name}", "given twice", "Give it once") for name in sorted(twice))
    return {name.strip(): value.strip() for name, _, value in split}


def _heading(case: str, summary: str, target: str, stated: Mapping[str, str]) -> str:
    return (
        f"{case}: {summary}.\n"
        + "".join(f"Parameter {name} = {value}.\n" for name, value in stated.items())
        + f"flexstage check {target}     flexstage analyse {target} --report report.html\n"
        f"flexstage schema > {Path(target).with_name(SCHEMA_FILE)}     is for editors that check this file during typing.\n"
        "Every physical value has a unit. tags mark values as stated or derived, with the source; untagged values are assumed."
    )


def check(design: Design, *, changes: Changes = None, json: Json = None) -> None:
    """Check a design file.

    Prints every error with key, value and hint. Exit code 2 if there is an error.

    Also lists default values and warnings, which do not change the exit code. Warnings marked "finite elements:" apply only to the
    finite-element model.
    """
    require_writable([("--json", json)], [design])
    try:
        text = read_text(design)
        mechanism = change(loads(text, where=str(design), folder=design.parent), changes or ())
        require(with_lines(model_findings(mechanism), text, str(design)))
    except DesignError as error:
        if json is not None:
            write(json, as_text(check_document(None, error.findings)) + "\n", "--json")
        raise
    if json is not None:
        write(json, as_text(check_document(mechanism)) + "\n", "--json")
    if json != STDOUT:
        _tell_sound(design, mechanism)


def _tell_sound(design: Path, mechanism: Mechanism) -> None:
    show((composition_table(mechanism), floating_line(drawn(mechanism)), *list_caveats("check", mechanism)))
    solid = () if contact_findings(mechanism) else solid_findings(mechanism)
    for finding in solid:
        print_warning(f"finite elements: {finding}")
    count = len(combine_warnings(caveats(mechanism).warnings)) + len(solid)
    counted = f", {count_text(count, 'warning')}" if count else ""
    print_result(f"{design}: no errors{counted}.")


_SCHEMAS = {
    File.DESIGN: design_schema,
    File.STUDY: study_schema,
    File.LOOP: setup_schema,
    File.SPECIFICATION: specification_schema,
    File.HYSTERESIS: hysteresis_schema,
}


def schema(
    kind: Annotated[
        File,
        typer.Argument(
            metavar="[KIND]", help="Kind of file: design, study, set-up of a loop, specification, or hysteresis model of a stack."
        ),
    ] = File.DESIGN,
) -> None:
    """Print the JSON Schema of a kind of file, for text editors."""
    print_result(as_json(_SCHEMAS[kind](), indent=1, ensure_ascii=False))


def plan(
    design: Design,
    *,
    output: Annotated[Path, output_option("PLAN.SVG", "SVG, PDF or PNG file to write.")],
    changes: Changes = None,
) -> None:
    """Draw the dimensioned plan of a stage.

    The plan shows the stage from above, with names, radii, angles, and sizes in mm.
    """
    ending = format_of(str(output))
    mechanism = open_design(design, changes, [("--output", output)])
    write(output, drawing(plan_figure(mechanism, still_data(mechanism)), ending), "--output")
    announce(f"Wrote {output}")


def catalogue(
    section: Annotated[
        str | None,
        typer.Argument(
            metavar="[SECTION]", help="Section to list: materials, stacks, amplified, coils or gauges. Default: all.", show_default=False
        ),
    ] = None,
    *,
    json: Json = None,
) -> None:
    """List the shipped materials, actuators and sensors.

    The list contains the source of each number. In a design file, the key like = "NAME" copies an entry of this list.
    """
    require_writable([("--json", json)])
    known = shipped_catalogue() if section is None else find_section(shipped_catalogue(), section)
    if json is not None:
        body = {"format": FORMAT, "kind": "catalogue", "version": __version__, **catalogue_body(known)}
        write(json, as_text(body) + "\n", "--json")
    tables = list(catalogue_tables(known))
    if json != STDOUT and tables:
        show(tables)
    elif json != STDOUT:
        typer.echo(f'No shipped {section}. A design file uses a catalogue of your own with catalogue = "lab.toml".')
