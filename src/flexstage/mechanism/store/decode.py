"""From the tree of a file to what it means: every finding is collected before any is raised."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.number import Table
from flexstage.mechanism.catalogue import Catalogue
from flexstage.mechanism.checks import copy_findings, package_findings
from flexstage.mechanism.checks.value import number_findings
from flexstage.mechanism.formulas import NUMBERS, read_numbers
from flexstage.mechanism.grammar import CHANGES, TAGS, node_of
from flexstage.mechanism.locate import canonical, locate
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.node import BAD, MOST_FINDINGS, EnoughError, Reader, kind, short

FORMAT = "flexstage 1"
_FILES = {FORMAT: "a design file"}
_Record = TypeVar("_Record")


def mechanism_from(raw: dict[str, Any], catalogue: Catalogue) -> Mechanism:
    """Return the description that a file's tree means; raises `DesignError` with everything that is wrong with it.

    >>> from flexstage.mechanism.catalogue import shipped_catalogue
    >>> mechanism_from({"format": "flexstage 1", "name": "empty"}, shipped_catalogue()).name
    'empty'
    """
    table = raw.get(NUMBERS)
    numbers = read_numbers({name: value for name, value in table.items() if name != TAGS} if isinstance(table, dict) else {})
    reader = Reader(catalogue, numbers=numbers, formulas=dict(numbers.formulas))
    mechanism: Any = None
    try:
        mechanism = _mechanism(reader, raw)
    except EnoughError:
        reader.findings.append(Finding("file", f"there are {MOST_FINDINGS} findings or more", "Mend these first"))
    require(reader.findings)
    return mechanism


def record_from(record: type[_Record], raw: dict[str, Any], form: str, *, tagged: bool = True) -> _Record:
    """Return the record that a tree means whose `format` is to be `form`; raises `DesignError` with everything that is wrong with it.

    Its fields are annotated as those of descriptions are. `tagged`: its tables may have tags, which are not kept.

    >>> from flexstage.parts.rod import Rod
    >>> record_from(Rod, {"format": "rod 1", "material": "steel", "length": "3 mm", "diameter": "1 mm"}, "rod 1").length
    0.003
    """
    reader = Reader(Catalogue((), {}), tagged)
    _check_format(reader, raw, form)
    value: Any = BAD
    try:
        value = reader.read(node_of(record), {key: part for key, part in raw.items() if key != "format"}, "")
        for address, number, node in () if value is BAD else node_of(record).numbers(value):
            reader.note(number_findings(address, number, node))
    except EnoughError:
        reader.findings.append(Finding("file", f"there are {MOST_FINDINGS} findings or more", "Mend these first"))
    require(reader.findings)
    return value


def _check_format(reader: Reader, raw: dict[str, Any], form: str) -> None:
    found = raw.get("format")
    if found != form:
        what = f"found {kind(found)}" if found is not None else "the file does not say its format"
        reader.refuse("format", what, f'The first line of {_FILES.get(form, "such a file")} is format = "{form}"')


def _mechanism(reader: Reader, raw: dict[str, Any]) -> Any:
    _check_format(reader, raw, FORMAT)
    reader.note(reader.numbers.findings if reader.numbers is not None else ())
    packages = raw.get("packages")
    if isinstance(packages, list) and (missing := tuple(package_findings(each for each in packages if isinstance(each, str)))):
        return reader.note(missing)  # what they offer is not known, which says nothing about the rest
    body = {key: value for key, value in raw.items() if key not in ("format", "change")}
    mechanism = reader.read(node_of(Mechanism), body, "")
    if not isinstance(mechanism, Mechanism):
        return BAD
    if faults := tuple(copy_findings(mechanism)):
        return reader.note(faults)
    changes = raw.get("change", {})
    formulas = {canonical(mechanism, where): text for where, text in reader.formulas.items()}
    reader.formulas.clear()
    values = _changes(reader, mechanism, changes) if isinstance(changes, dict) else reader.read(CHANGES, changes, "change")
    sources = reader.sources | dict(mechanism.sources)
    formulas |= reader.formulas
    return replace(mechanism, changes=values, tags=Table(reader.tags), sources=Table(sources), formulas=Table(formulas))


def _changes(reader: Reader, mechanism: Mechanism, raw: dict[str, Any]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for address, value in raw.items():
        where = f'change."{short(address)}"'
        if address == TAGS:
            reader.refuse(where, "this is no address", "Tags of changes stand in [tags], by address")
            continue
        try:
            place = locate(mechanism, address)
            values[address] = reader.read(place.node, value, where)
            for key in [key for key in reader.formulas if key.startswith(where)]:
                reader.formulas[place.address + key.removeprefix(where)] = reader.formulas.pop(key)
        except DesignError as error:
            reader.note(replace(finding, where=where) for finding in error.findings)
    return values
