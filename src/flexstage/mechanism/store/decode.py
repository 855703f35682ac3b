"""Decoding of a file's tree into a description; all errors are collected and raised together."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Table
from flexstage.mechanism.addresses.address import set_text, set_value
from flexstage.mechanism.addresses.locate import canonical, locate
from flexstage.mechanism.assembly.expand import unknown_entries
from flexstage.mechanism.assembly.mount import STAGES, Mount, mount_all
from flexstage.mechanism.catalogue import SECTIONS, Catalogue, Section, shipped_catalogue
from flexstage.mechanism.checks import copy_findings, package_findings, require_valid
from flexstage.mechanism.grammar.formulas import NUMBERS, read_numbers
from flexstage.mechanism.grammar.grammar import LIKE, OVERRIDES, TAGS, node_of
from flexstage.mechanism.grammar.node import BAD, MOST_FINDINGS, EnoughError, Reader, kind, short
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.mechanism.store.anchor import anchor_paths
from flexstage.mechanism.store.file import FORMAT, parse_toml, read_text
from flexstage.mechanism.store.include import entry_of, with_included
from flexstage.mechanism.store.lines import with_lines

_Record = TypeVar("_Record")
CATALOGUE = "catalogue"
"""File key for the user's catalogue of materials, actuators and sensors."""


def mechanism_from(raw: dict[str, Any], where: str = "", above: tuple[Path, ...] = ()) -> Mechanism:
    """Decode a file's tree into a description; raises `DesignError` with all errors.

    Paths of included files and of mounted stages are relative to the folder of the file `where`. `above` are the files that are currently
    being read, to detect circular references.

    >>> mechanism_from({"format": "flexstage 1", "name": "empty"}).name
    'empty'
    """
    included, told = with_included(raw, where, above)
    raw = included.tree
    table = raw.get(NUMBERS)
    numbers = read_numbers({name: value for name, value in table.items() if name != TAGS} if isinstance(table, dict) else {})
    reader = Reader(numbers=numbers, formulas=dict(numbers.formulas))
    mechanism: Any = None
    try:
        reader.note(told)
        _check_format(reader, raw, FORMAT)
        reader.note(numbers.findings)
        try:
            mechanism = _mechanism(reader, raw, _Files(where, above), frozenset(included.origin))
        except DesignError as error:
            reader.note(error.findings)
    except EnoughError:
        reader.findings.append(Finding("file", f"at least {MOST_FINDINGS} errors", "Correct these first"))
    if reader.findings:
        reader.findings += reader.bounds
    if reader.findings and STAGES not in raw:
        reader.findings += _unknown_names({name: table for name, table in raw.items() if isinstance(table, dict)})
    require(included.located(list(dict.fromkeys(reader.findings))))
    return mechanism


def _unknown_names(raw: dict[str, dict[str, Any]]) -> Iterator[Finding]:
    """Unknown entries and bodies that a tree names, found although other values of the file are wrong."""
    yield from unknown_entries(raw)
    bodies = {GROUND, *raw.get("bodies", ())}
    for name, link in raw.get("links", {}).items():
        joins = link.get("joins") if isinstance(link, dict) else None
        for body in joins if isinstance(joins, list) else ():
            if isinstance(body, str) and "/" not in body and body not in bodies:
                yield Finding(f"links.{name}.joins", f'unknown body "{body}"', suggest_nearest(body, bodies))


def read_design(text: str, where: str) -> Mechanism:
    """Decode a file's text into a description without checks of the description."""
    return mechanism_from(parse_toml(text, where), where)


def record_from(record: type[_Record], raw: dict[str, Any], form: str, *, tagged: bool = True) -> _Record:
    """Decode a tree with the format `form` into an object of the class `record`; raises `DesignError` with all errors.

    The fields of the class have the same annotations as those of a description. If a key is a Python keyword, its field has a final
    underscore. If `tagged`, tables may have tags, which are dropped.

    >>> from flexstage.parts.rod import Rod
    >>> record_from(Rod, {"format": "rod 1", "material": "steel", "length": "3 mm", "diameter": "1 mm"}, "rod 1").length
    0.003
    """
    reader = Reader(tagged)
    _check_format(reader, raw, form)
    value: Any = BAD
    try:
        value = reader.read(node_of(record), {key: part for key, part in raw.items() if key != "format"}, "")
    except EnoughError:
        reader.findings.append(Finding("file", f"at least {MOST_FINDINGS} errors", "Correct these first"))
    require([*reader.findings, *reader.bounds])
    return value


def _check_format(reader: Reader, raw: dict[str, Any], form: str) -> None:
    result = raw.get("format")
    if result is None:
        reader.refuse("format", "missing", f'Begin the file with format = "{form}"')
    elif result != form:
        other = isinstance(result, str) and re.fullmatch(r"flexstage( [a-z]+)? \d+", result) and _kind_of(result) != _kind_of(form)
        told = f", a {_kind_of(result)}, expected a {_kind_of(form)}" if other else ""
        reader.refuse("format", f"unknown format (got {kind(result)}{told})", f'Begin a {_kind_of(form)} with format = "{form}"')
        require(reader.findings)  # further errors of another kind of file are irrelevant


def _kind_of(form: str) -> str:
    """Name of a file format: "flexstage study 1" is a study file, "flexstage 1" a design file."""
    return f"{' '.join(form.split()[1:-1]) or 'design'} file"


@dataclass(frozen=True)
class _Files:
    """The file being read, and files of mounted stages."""

    where: str
    above: tuple[Path, ...]

    def carried(self, reader: Reader, raw: Any) -> dict[str, tuple[Mount, Mechanism]]:
        """Mounted stages of a table, with their descriptions."""
        if not isinstance(raw, dict):
            reader.refuse(STAGES, f"must be a table (got {kind(raw)})", 'Use e.g. fine = { file = "fine.toml" }')
            return {}
        mounts = {name: reader.read(node_of(Mount), item, f"{STAGES}.{name}") for name, item in raw.items() if name != TAGS}
        result = {name: (item, self.read(reader, name, item)) for name, item in mounts.items() if isinstance(item, Mount)}
        return {name: (item, stage) for name, (item, stage) in result.items() if stage is not None}

    def read(self, reader: Reader, name: str, item: Mount) -> Mechanism | None:
        """The stage in a file; an error if unreadable or circular."""
        path, here = (Path(self.where).parent / item.file).resolve(), Path(self.where).resolve()
        address = f"{STAGES}.{name}.file"
        if path in (here, *self.above):
            what = "the stage would contain itself" if path == here else f"circular reference between this file and {item.file}"
            reader.refuse(address, what, "Use the file of another stage")
            return None
        try:
            text = read_text(path)
        except DesignError as error:
            return self._refuse(reader, address, (replace(finding, where=item.file) for finding in error.findings))
        try:
            tree = mechanism_from(parse_toml(text, item.file), str(path), (*self.above, here))
            return require_valid(anchor_paths(tree, path.parent))
        except DesignError as error:
            told = [finding for finding in error.findings if finding.where.startswith(f"{item.file}: ")]
            rest = [finding for finding in error.findings if finding not in told]
            return self._refuse(reader, address, (*told, *with_lines(rest, text, item.file)))

    def _refuse(self, reader: Reader, address: str, findings: Iterable[Finding]) -> None:
        reader.note(replace(finding, where=f"{address}: {finding.where}") for finding in findings)


def _mechanism(reader: Reader, raw: dict[str, Any], files: _Files, included: frozenset[str]) -> Any:
    packages = raw.get("packages")
    if isinstance(packages, list):  # kinds of missing packages are unknown, and so other errors are irrelevant
        require(package_findings(each for each in packages if isinstance(each, str)))
    raw = _with_likes(reader, raw, catalogue_of(raw.get(CATALOGUE), files.where))
    body = {key: value for key, value in raw.items() if key not in ("format", "overrides", STAGES, CATALOGUE)}
    if isinstance(raw.get("requirements"), dict):
        try:
            body["requirements"] = dotted("requirements", raw["requirements"])
        except DesignError as error:
            reader.note(error.findings)
    mechanism = reader.read(node_of(Mechanism), body, "")
    if not isinstance(mechanism, Mechanism):
        return BAD
    require(copy_findings(mechanism))
    mechanism = mount_all(mechanism, files.carried(reader, raw[STAGES]) if STAGES in raw else {})
    overrides = raw.get("overrides", {})
    formulas = {canonical(mechanism, where): text for where, text in reader.formulas.items()}
    reader.formulas.clear()
    if included and isinstance(overrides, dict):
        stated = replace(mechanism, formulas=Table(formulas), tags=Table({**mechanism.tags, **reader.tags}))
        mechanism, overrides = _with_own_values(reader, stated, overrides, included)
        formulas, reader.tags = dict(mechanism.formulas), dict(mechanism.tags) | _tags_above(raw)
    values = _overrides(reader, mechanism, overrides) if isinstance(overrides, dict) else reader.read(OVERRIDES, overrides, "overrides")
    if not isinstance(values, dict):
        return BAD
    sources = reader.sources | dict(mechanism.sources)
    tags = {**mechanism.tags, **reader.tags}
    mechanism = replace(mechanism, overrides={**mechanism.overrides, **values}, tags=Table(tags), sources=Table(sources))
    formulas |= {canonical(mechanism, where): text for where, text in reader.formulas.items()}  # the address of an override, if it is one
    return replace(mechanism, formulas=Table(formulas))


def dotted(where: str, table: dict[str, Any]) -> dict[str, Any]:
    """Return a table with dotted keys instead of nested tables: in TOML, `stroke.x` without quotes is a table `stroke`.

    Raises `DesignError` for a key that occurs twice.

    >>> dotted("requirements", {"stroke": {"x": "at least 5 um"}, "mass": "at most 2 kg"})
    {'stroke.x': 'at least 5 um', 'mass': 'at most 2 kg'}
    """
    entries = list(_entries(table))
    keys = [key for key, _ in entries]
    require(Finding(f"{where}.{key}", "specified twice", "Keep one") for key in dict.fromkeys(keys) if keys.count(key) > 1)
    return dict(entries)


def _entries(table: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, dict) and key != TAGS:
            yield from ((f"{key}.{inner}", each) for inner, each in _entries(value))
        else:
            yield key, value


def catalogue_of(name: Any, where: str) -> Catalogue:
    """Return the shipped catalogue, extended by the user's catalogue file `name` in the folder of the design file."""
    if name is None:
        return shipped_catalogue()
    if not isinstance(name, str):
        raise refuse(CATALOGUE, f"must be a file name (got {kind(name)})", 'Use catalogue = "lab.toml"')
    tree = parse_toml(read_text(Path(where).parent / name), name)
    known = {section.name: dict for section in SECTIONS} | {"sources": str}
    for key, value in tree.items():
        if key not in known or not isinstance(value, dict) or not all(isinstance(each, known[key]) for each in value.values()):
            raise refuse(f"{CATALOGUE}: {name}: {key}", "unknown section", suggest_nearest(key, known))
    return shipped_catalogue().extended(tree)


def _with_likes(reader: Reader, raw: dict[str, Any], catalogue: Catalogue) -> dict[str, Any]:
    """The tree with catalogue entries merged (`like`)."""
    for key in dict.fromkeys(section.key for section in catalogue.sections):
        table = raw.get(key)
        if isinstance(table, dict):
            raw = raw | {key: {name: _with_like(reader, catalogue, key, name, entry) for name, entry in table.items()}}
    return raw


def _section_of(catalogue: Catalogue, key: str, entry: dict[str, Any]) -> Section | None:
    """Section of an entry with `like`: by its kind, or without a kind by the name."""
    sections = [each for each in catalogue.sections if each.key == key]
    if "kind" in entry:
        return next((each for each in sections if each.kind == entry["kind"]), None)
    return next((each for each in sections if str(entry[LIKE]) in each.entries), sections[0])


def _with_like(reader: Reader, catalogue: Catalogue, key: str, name: str, entry: Any) -> Any:
    """An entry merged over the catalogue entry of `like`. Missing keys of an unknown entry are not reported."""
    if not isinstance(entry, dict) or LIKE not in entry or (section := _section_of(catalogue, key, entry)) is None:
        return entry
    like, known = entry[LIKE], section.entries
    if not isinstance(like, str) or like not in known:
        reader.refuse(f"{key}.{name}.{LIKE}", f"the catalogue has no {kind(like)}", suggest_nearest(kind(like), known))
    shipped = known.get(str(like)) or next(iter(known.values()), {})
    tags, own = {key: tag for key, tag in shipped.get(TAGS, {}).items() if key not in entry}, entry.get(TAGS, {})
    reader.sources.update(catalogue.sources_of(tags.values()))
    brought = {"source": f"{like} of the catalogue"} | dict(shipped) | ({"kind": section.kind} if section.kind else {})
    merged = brought | entry | {TAGS: tags | own if isinstance(own, dict) else own}
    return {key: value for key, value in merged.items() if key != LIKE}


def _with_own_values(
    reader: Reader, mechanism: Mechanism, raw: dict[str, Any], included: frozenset[str]
) -> tuple[Mechanism, dict[str, Any]]:
    """The description with overrides of included entries applied, and the other overrides."""
    rest: dict[str, Any] = {}
    for address, value in raw.items():
        if not _is_of(mechanism, address, included):
            rest[address] = value
            continue
        try:
            if isinstance(value, str):
                mechanism = set_text(mechanism, address, value)
            else:
                mechanism = set_value(mechanism, address, locate(mechanism, address).node.read(value, address, reader))
        except DesignError as error:
            reader.note(replace(finding, where=f'overrides."{short(address)}"') for finding in error.findings)
    return mechanism, rest


def _is_of(mechanism: Mechanism, address: str, entries: frozenset[str]) -> bool:
    """Whether an address is of a value of one of these entries."""
    try:
        place = locate(mechanism, address)
    except DesignError:
        return False
    return not place.owners and entry_of(place.address) in entries


def _tags_above(raw: dict[str, Any]) -> dict[str, str]:
    """Tags above all tables."""
    tags = raw.get(TAGS)
    return {key: tag for key, tag in tags.items() if isinstance(tag, str)} if isinstance(tags, dict) else {}


def _overrides(reader: Reader, mechanism: Mechanism, raw: dict[str, Any]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for address, value in raw.items():
        where = f'overrides."{short(address)}"'
        if address == TAGS:
            reader.refuse(where, "not an address", "Use [tags] for tags of overrides, by address")
            continue
        try:
            values[address] = reader.read(locate(mechanism, address).node, value, where)
            for key in [key for key in reader.formulas if key.startswith(where)]:
                reader.formulas[address + key.removeprefix(where)] = reader.formulas.pop(key)
        except DesignError as error:
            key = f"{address}.{next(iter(value))}" if isinstance(value, dict) and value else ""
            advice = f'. Quote a key with dots: "{short(key)}"' if key else ""
            reader.note(replace(finding, where=where, advice=finding.advice + advice) for finding in error.findings)
    return values
