"""Forms of the studio's jobs: the JSON Schema of a command's input, a specification and its values, the key figures of a result."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from flexstage.apps.cli.option_groups import default_last
from flexstage.apps.studio.protocol import Figure, Problem, Specified

_STUDIES = ("sweep", "optimise")
_OWN = ("--help", "--stage", "--report", "--json", "--csv", "--xlsx")
"""Options without an entry: the studio sets them, or they concern the printed text."""


def form(command: str) -> Mapping[str, Any]:
    """Return the JSON Schema of the study or set-up file of a command, or of its options if the command has no such file."""
    if command == "loop":
        from flexstage.control.study.file import setup_schema  # takes long to import

        return setup_schema()
    if command in _STUDIES:
        from flexstage.studies.form import study_schema

        return study_schema()
    if command == "design":
        from flexstage.studies.synthesis.specification import specification_schema

        return specification_schema()
    return {"properties": dict(_options(command))}


def _options(command: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """The schemas of the options of `verify` or `identify`."""
    from typer import Context, Typer  # takes long to import
    from typer.main import get_command

    from flexstage.experiment.commands.identify import identify
    from flexstage.solid.commands.solid import verify

    app = Typer(add_completion=False)
    app.command()(verify if command == "verify" else identify)
    loaded = get_command(app)
    for each in loaded.params:
        if each.param_type_name == "option" and each.opts[0] not in _OWN and (record := each.get_help_record(Context(loaded))):
            yield each.opts[0], _property(each, *record)


def _property(option: Any, names: str, meaning: str) -> dict[str, Any]:
    """The schema of an option: a switch, a choice of values, some values, or one."""
    _, _, value = names.rpartition(" ")
    choices = value.strip("<>").split("|") if value.startswith("<") and "|" in value else []
    kind = {"enum": choices} if choices else {"type": "boolean" if option.is_flag else "string"}
    many = {"minItems": option.nargs} if option.nargs > 1 else {}
    return {"description": default_last(meaning), "examples": [value], **kind, **many}


def specify(text: str, file: str, values: str) -> Specified:
    """Read the text of a specification and return it with its values and errors.

    An example replaces an empty text. `values` (TOML) replace values in the text; `file` is the path of the specification.
    """
    from flexstage.base.finding import DesignError
    from flexstage.mechanism.store.decode import dotted
    from flexstage.mechanism.store.file import parse_toml
    from flexstage.mechanism.store.lines import spot_of
    from flexstage.studies.synthesis.specification import EXAMPLE, loads_specification

    text, tree, problems = text or EXAMPLE, None, list[Problem]()
    try:
        text = _with_values(text, values, parse_toml(values, file)) if values else text
        tree = parse_toml(text, file)
        if isinstance(tree.get("requirements"), dict):
            tree["requirements"] = dotted("requirements", tree["requirements"])
        loads_specification(text, where=file)
    except DesignError as error:
        for each in error.findings:
            spot = spot_of(each, file)
            where = "specification" if spot.address in (file, "file", "") else spot.address
            problems.append(Problem(where, each.what, each.advice, spot.line, spot.column))
    return Specified(text, json.loads(json.dumps(tree, default=str)), tuple(problems))


def _with_values(text: str, values: str, tree: Mapping[str, Any]) -> str:
    """A TOML text with other values, its comments preserved where its layout allows that."""
    import tomllib

    import tomlkit  # takes long to import
    from tomlkit.exceptions import TOMLKitError

    try:
        document = tomlkit.parse(text)
        _replace_values(document, tree)
        changed = tomlkit.dumps(document)
        return changed if tomllib.loads(changed) == tree else values
    except (TOMLKitError, tomllib.TOMLDecodeError):
        return values


def _replace_values(table: Any, values: Mapping[str, Any]) -> None:
    for key in [key for key in table if key not in values]:
        del table[key]
    for key, value in values.items():
        if isinstance(value, Mapping) and isinstance(table.get(key), Mapping):
            _replace_values(table[key], value)
        elif key not in table or table[key] != value:
            table[key] = value


def key_figures(document: Mapping[str, Any]) -> tuple[Figure, ...]:
    """Return the key figures of a command's result, in SI units and degrees, for a comparison of runs."""
    kind = document["kind"]
    return tuple(Figure(name, kind, unit, unit, 1.0, value, None) for name, value, unit in _FIGURES[kind](document))


_Rows = Iterator[tuple[str, float | None, str]]


def _verdicts(document: Mapping[str, Any]) -> _Rows:
    return ((each["key"], each["value"], each["unit"]) for each in document["requirements"])


def _ranges(document: Mapping[str, Any]) -> _Rows:
    for each in document["responses"]:
        yield f"smallest {each['name']}", each["min_value"], each["unit"]
        yield f"largest {each['name']}", each["max_value"], each["unit"]


def _optimum(document: Mapping[str, Any]) -> _Rows:
    """Objectives and margins of the best design; none for a front."""
    best = document.get("optimum", {"limits": ()})
    for each in document["objectives"] if "objectives" in best else ():
        yield each["name"], best["objectives"][each["name"]], each["unit"]
    for each in best["limits"]:
        yield f"margin of {each['measure']}", each["margin"], "1"


def _answers(document: Mapping[str, Any]) -> _Rows:
    return ((f"{each['architecture']}, {each['actuator']}", each["goal"], each["unit"]) for each in document["answers"])


def _differences(document: Mapping[str, Any]) -> _Rows:
    rows = (each for each in document["rows"] if each["group"] == "stage")
    return ((f"{each['figure']}: relative difference of theory from finite elements", each["difference"], "1") for each in rows)


def _modes(document: Mapping[str, Any]) -> _Rows:
    for each in document["modes"]:
        yield f"mode {each['number']}", each["frequency_hz"], "Hz"
        yield f"damping ratio of mode {each['number']}", each["damping"], "1"


def _loop(document: Mapping[str, Any]) -> _Rows:
    for name, each in document["bandwidths"]["coordinates"].items():
        yield f"bandwidth {name}", each["tracking_hz"], "Hz"
    for name, each in document["margins"]["loops"].items():
        phase = each["phase_rad"]["value"]
        yield f"gain margin {name}", each["gain_high"]["value"], "1"
        yield f"phase margin {name}", None if phase is None else math.degrees(phase), "deg"
    yield "peak sensitivity", document["peaks"]["sensitivity"]["value"], "1"
    for name, value, unit in zip(*(document["noise"][key] for key in ("outputs", "rms", "units")), strict=True):
        yield f"positioning noise {name}", value, unit


_FIGURES: Mapping[str, Callable[[Mapping[str, Any]], _Rows]] = {
    "analyse": _verdicts,
    "sweep": _ranges,
    "optimise": _optimum,
    "design": _answers,
    "verify": _differences,
    "identify": _modes,
    "loop": _loop,
}
"""Names, values and units of the key figures by command."""
