"""The design that a study starts from: a design file, or a shipped case with parameters; and the parameters that are varied."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from flexstage.base.finding import DesignError
from flexstage.base.quantity import Quantity
from flexstage.cases.parameters import Stated, parameter, with_parameters
from flexstage.cases.registry import Variant, case, shipped
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.node import NumberNode
from flexstage.mechanism.store import load
from flexstage.studies.sweeps.fields import Fields

_NONE = (Mechanism(""), None)


def start(fields: Fields, folder: Path) -> tuple[Mechanism, Variant | None]:
    """The design that a study's file names, and the case that it is drawn from: `None` for a design file, looked for in `folder`.

    >>> found = []
    >>> tree = {"case": "hexapod", "parameters": {"slope": "50 deg"}}
    >>> start(Fields(tree, "", found), Path())[1].stated[0][0], found
    ('slope', [])
    """
    path, name = fields.text("design"), fields.text("case")
    table = fields.table("parameters")
    if bool(path) == bool(name):
        found = "both a design file and a case are named" if path else "no design is named"
        fields.note("design", found, 'Write design = "stage.toml", or case = "double-triangle"')
        return _NONE
    if path and table.tree:
        fields.note("parameters", "a design file has numbers, no parameters", "Leave them out, or start from a case")
    try:
        return (load(folder / path), None) if path else _drawn(name, table)
    except DesignError as error:
        fields.findings.extend(error.findings)
        return _NONE


def _drawn(name: str, table: Fields) -> tuple[Mechanism, Variant | None]:
    """The case with the parameters that the table states."""
    own, stated = shipped(name).parameters, _stated(name, table)
    if table.findings:
        return _NONE
    changed = with_parameters(own, stated, table.where)
    names = (parameter(own, each).name for each in stated)
    return case(name, stated), Variant(name, tuple((each, parameter(changed, each).value) for each in names))


def _stated(name: str, table: Fields) -> dict[str, Stated]:
    """What the table states: numbers of a quantity with their units."""
    found: dict[str, Stated] = {}
    for key, value in _leaves(table.tree):
        try:
            known = parameter(shipped(name).parameters, key, table.at(key))
            number = isinstance(known.node, NumberNode) and known.node.quantity.si != "1"
            if number and not isinstance(value, str):
                table.note(key, f"found {value!r} without a unit", f'Write for example "{known.text}"')
            else:
                found[key] = value
        except DesignError as error:
            table.findings.extend(error.findings)
    return found


def _leaves(tree: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Keys and values: dots of a key open tables in TOML, and are dots of a name here."""
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def parameters_varied(table: Fields, variant: Variant | None) -> tuple[tuple[str, ...], Quantity | None]:
    """The parameters that a variable's table names, by full name, and their quantity; `None` after a finding.

    >>> found = []
    >>> names, quantity = parameters_varied(Fields({"parameter": "neck.radius"}, "variables.r", found), Variant("hexapod"))
    >>> names, quantity.name
    (('neck.profile.radius',), 'length')
    """
    asked = table.text_or_texts("parameter")
    if "of" in table.tree:
        table.text_or_texts("of")
        table.note("of", "both an address and a parameter are named", "Name one of them")
    if variant is None:
        table.note("parameter", "a design file has no parameters", 'Give the address of a number: of = "parts.neck.thickness"')
        return asked, None
    names: list[str] = []
    found: list[Quantity] = []
    for each in asked:
        try:
            known = parameter(variant.parameters, each, table.at("parameter"))
        except DesignError as error:
            table.findings.extend(error.findings)
            continue
        names.append(known.name)
        if known.quantity is None:
            table.note("parameter", f"{known.name} is no number that can vary: {known.kind}", "State it in [parameters]")
        else:
            found.append(known.quantity)
    return tuple(names), one_quantity(table, "parameter", found) if len(found) == len(asked) else None


def one_quantity(table: Fields, key: str, found: list[Quantity]) -> Quantity | None:
    """The quantity that all have; a finding where they have several, and `None` where there is none.

    >>> one_quantity(Fields({}, "variables.a", []), "of", []) is None
    True
    """
    if len({each.si for each in found}) > 1:
        table.note(key, f"they are of different quantities: {', '.join(each.name for each in found)}", "Use two variables")
        return None
    return found[0] if found else None
