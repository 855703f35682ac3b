"""Included files (`include`): materials, parts, units and other reusable entries for a design."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from flexstage.base.finding import DesignError, Finding
from flexstage.mechanism.grammar.grammar import TAGS
from flexstage.mechanism.grammar.node import kind
from flexstage.mechanism.store.file import FORMAT, parse_toml, read_text
from flexstage.mechanism.store.lines import with_lines

INCLUDE = "include"
SECTIONS = ("numbers", "materials", "parts", "sensors", "units", "sources")
"""Sections allowed in an included file: reusable entries without a position."""
_BESIDE = ("format", "name", INCLUDE)
_LIST = 'Use a list of files: include = ["stock.toml"]'


@dataclass(frozen=True, eq=False)
class Included:
    """Tree of a design that contains the entries of included files.

    `origin` gives the file of each included entry (`parts.neck`) and the text of this file.
    """

    tree: dict[str, Any]
    origin: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    def located(self, findings: list[Finding]) -> Iterator[Finding]:
        """Yield all errors; the address of an error in an included entry begins with the file and line of the entry."""
        for finding in findings:
            file, text = self.origin.get(entry_of(finding.where), ("", ""))
            yield from with_lines([finding], text, file) if file else (finding,)


def entry_of(address: str) -> str:
    """Return the entry to which an address belongs: its first two names.

    >>> entry_of("parts.neck.profile.radius")
    'parts.neck'
    """
    return ".".join(address.split(".")[:2])


def with_included(raw: dict[str, Any], where: str, above: tuple[Path, ...] = ()) -> tuple[Included, list[Finding]]:
    """Return the tree with the entries of included files, and the errors.

    Paths are relative to the folder of the file `where`. `above` are the files that refer to this file. An entry that occurs in two files
    is an error.

    >>> with_included({"name": "a", "include": "stock.toml"}, "stage.toml")[1][0].what
    'must be a list of files (got "stock.toml")'
    """
    names = raw.get(INCLUDE, [])
    tree = {key: dict(value) if key in SECTIONS and isinstance(value, dict) else value for key, value in raw.items() if key != INCLUDE}
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        return Included(tree), [Finding(INCLUDE, f"must be a list of files (got {kind(names)})", _LIST)]
    origin: dict[str, tuple[str, str]] = {}
    findings: list[Finding] = []
    for name in names:
        entries, told = _entries(name, where, above)
        findings += told
        for address, (value, file, text) in entries.items():
            section, entry = address.split(".", 1)
            if entry in tree.setdefault(section, {}):
                other = origin[address][0] if address in origin else "this file"
                what = f"{address} is both in {file} and in {other}"
                findings.append(Finding(INCLUDE, what, "Rename or remove one; use [overrides] for single values of included entries"))
                continue
            tree[section][entry] = value
            origin[address] = (file, text)
    return Included(tree, origin), findings


_Entries = dict[str, tuple[Any, str, str]]


def _entries(name: str, where: str, above: tuple[Path, ...]) -> tuple[_Entries, list[Finding]]:
    """Entries of an included file by address, with their file and text, and the errors of the file."""
    here, path = Path(where).resolve(), (Path(where).parent / name).resolve()
    if path in (here, *above):
        what = f"{name} would include itself" if path == here else f"circular reference between this file and {name}"
        return {}, [Finding(INCLUDE, what, "Remove one include")]
    try:
        text = read_text(path)
        raw = parse_toml(text, name)
    except DesignError as error:
        return {}, [replace(each, where=f"{INCLUDE}: {each.where.replace(str(path), name)}") for each in error.findings]
    findings = list(with_lines(_strange(raw), text, name))
    included, told = with_included({key: value for key, value in raw.items() if key in (*SECTIONS, INCLUDE)}, str(path), (*above, here))
    findings += [replace(each, where=f"{name}: {each.where}") for each in told]
    result: _Entries = {}
    for section, table in included.tree.items():
        for entry, value in table.items() if isinstance(table, dict) else ():
            if entry != TAGS:
                address = f"{section}.{entry}"
                result[address] = (_with_whole_paths(value, path.parent), *included.origin.get(address, (name, text)))
    return result, [replace(each, where=f"{INCLUDE}: {each.where}") for each in findings]


def _strange(raw: dict[str, Any]) -> Iterator[Finding]:
    """Errors of an included file: wrong or missing format, unsupported sections."""
    if raw.get("format") != FORMAT:
        result = f"found {kind(raw['format'])}" if "format" in raw else "format missing"
        yield Finding("format", result, f'Begin an included file with format = "{FORMAT}"')
        return
    for key, value in raw.items():
        if key not in (*SECTIONS, *_BESIDE):
            place = f"{key}.{next(iter(value))}" if isinstance(value, dict) and value else key
            yield Finding(place, f"not allowed in an included file (expected {', '.join(SECTIONS)})", "Move it to the design file")
        elif key in SECTIONS and not isinstance(value, dict):
            yield Finding(key, f"must be a table (got {kind(value)})", "Write a table: [name]")


def _with_whole_paths(value: Any, folder: Path) -> Any:
    """An entry with absolute file paths, from the folder of its file."""
    if isinstance(value, dict):
        return {
            key: str(folder / item)
            if isinstance(item, str) and (key == "file" or key.endswith("_file"))
            else _with_whole_paths(item, folder)
            for key, item in value.items()
        }
    return [_with_whole_paths(item, folder) for item in value] if isinstance(value, list) else value
