"""Initial design of a study: a design file, or a shipped case with parameters; and the varied parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.units.quantity import Quantity
from flexstage.cases.parameters import Stated, parameter
from flexstage.cases.registry import Variant, case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import load
from flexstage.studies.form import StudyFile, VariedTable


def start(file: StudyFile, folder: Path) -> tuple[Mechanism, Variant | None]:
    """Return the design and the case of a study's file. For a design file, which must be in `folder`, the case is `None`.

    Raises `DesignError` unless either a design file or a case is specified.

    >>> from flexstage.studies.form import study_file
    >>> text = 'format = "flexstage study 1"' + chr(10) + 'case = "hexapod"' + chr(10) + 'parameters.slope = "50 deg"'
    >>> start(study_file(text, "here"), Path())[1].stated[0][0]
    'slope'
    """
    findings = list[Finding]()
    if bool(file.design) == bool(file.case):
        found = "both a design file and a case are specified" if file.design else "design missing"
        findings.append(Finding("design", found, 'Use e.g. design = "stage.toml", or case = "double-triangle"'))
    if file.design and file.parameters:
        findings.append(Finding("parameters", "a design file has no parameters", "Remove the parameters, or use a case"))
    require(findings)
    return (load(folder / file.design), None) if file.design else _draw(file.case or "", file.parameters)


def _draw(name: str, table: Mapping[str, Any]) -> tuple[Mechanism, Variant]:
    """The case with the parameters of the table."""
    stated = _read_parameters(name, table)
    changed = case(name, stated)
    return changed, Variant(name, tuple((each, parameter(changed, each).value) for each in stated))


def _read_parameters(name: str, table: Mapping[str, Any]) -> dict[str, Stated]:
    """Parameters in the table: numbers of a quantity with their units."""
    found = dict[str, Stated]()
    findings = list[Finding]()
    for key, value in _leaves(table):
        try:
            known = parameter(case(name), key, f"parameters.{key}")
            if known.quantity.si != "1" and not isinstance(value, str):
                findings.append(Finding(f"parameters.{key}", f"unit missing (got {value!r})", f'Use e.g. "{known.text}"'))
            else:
                found[key] = value
        except DesignError as error:
            findings += error.findings
    require(findings)
    return found


def _leaves(tree: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Keys and values: dots of a key open tables in TOML, but are part of a name here."""
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def read_parameters(table: VariedTable, where: str, variant: Variant | None) -> tuple[tuple[str, ...], Quantity]:
    """Return the full names and the quantity of the parameters in a variable's table at `where`. Raises `DesignError` with all errors.

    >>> names, quantity = read_parameters(VariedTable("1 mm", "2 mm", parameter=("neck_radius",)), "variables.r", Variant("hexapod"))
    >>> names, quantity.name
    (('neck_radius',), 'length')
    """
    if table.address is not None:
        raise refuse(f"{where}.address", "both an address and a parameter are specified", "Remove one of them")
    if variant is None:
        advice = 'Use the address of a number: address = "parts.neck.thickness"'
        raise refuse(f"{where}.parameter", "a design file has no parameters", advice)
    names = list[str]()
    found = list[Quantity]()
    findings = list[Finding]()
    for each in table.parameter or ():
        try:
            known = parameter(variant.start, each, f"{where}.parameter")
        except DesignError as error:
            findings += error.findings
            continue
        names.append(known.name)
        found.append(known.quantity)
    require(findings)
    return tuple(names), one_quantity(f"{where}.parameter", found)


def one_quantity(where: str, found: list[Quantity]) -> Quantity:
    """Return the common quantity of several numbers. Raises `DesignError` if their quantities differ.

    >>> from flexstage.base.units.quantity import ANGLE, LENGTH
    >>> one_quantity("variables.a.address", [LENGTH, LENGTH]).name
    'length'
    """
    if len({each.si for each in found}) > 1:
        raise refuse(where, f"different quantities: {', '.join(each.name for each in found)}", "Use two variables")
    return found[0]
