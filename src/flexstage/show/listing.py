"""Listings: the shipped cases, their parameters and the catalogue as tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from flexstage.base.finding import refuse, suggest_nearest
from flexstage.cases.parameters import parameters
from flexstage.cases.registry import CASES, case
from flexstage.mechanism.catalogue import Catalogue, Section
from flexstage.mechanism.grammar.grammar import TAGS
from flexstage.show.table import Cell, Mark, Table, make_table, text_table
from flexstage.show.tables.description import TAG_MARKS


def case_table() -> Table | None:
    """Tabulate the shipped cases by name.

    >>> case_table().rows[0][0].text
    'double-triangle'
    """
    summaries = {name: case.summary for name, case in CASES.items()}
    return text_table("Cases", ["name", "summary"], summaries, notes=["flexstage new stage.toml --case NAME"])


def parameter_table(name: str) -> Table | None:
    """Tabulate the parameters of a shipped case: name, quantity, value. Raises `DesignError` with the nearest name for an unknown case.

    >>> parameter_table("parallelogram").texts()[-2]
    ['spacing', 'length', '50 mm']
    """
    rows = {each.name: (each.quantity.name, each.text) for each in parameters(case(name)).values()}
    notes = ["Named numbers of the design file.", f"flexstage new stage.toml --case {name} --case-parameter NAME=VALUE"]
    return text_table(f"Parameters of {name}", ["name", "quantity", "value"], rows, notes=notes)


def catalogue_tables(catalogue: Catalogue) -> tuple[Table, ...]:
    """Tabulate the materials, actuators and sensors of a catalogue, with values as written in a design file, and with sources.

    >>> from flexstage.mechanism.catalogue import Catalogue
    >>> catalogue_tables(Catalogue((), {}).extended({"materials": {"steel": {"young": "200 GPa"}}}))[0].texts()[1]
    ['steel', '200 GPa']
    """
    return tuple(_section_table(section, catalogue.sources) for section in catalogue.sections if section.entries)


def find_section(catalogue: Catalogue, name: str) -> Catalogue:
    """Return the catalogue with one section only, such as `materials` or `coils`. Raises `DesignError` for an unknown section.

    >>> from flexstage.mechanism.catalogue import shipped_catalogue
    >>> [section.record.__name__ for section in find_section(shipped_catalogue(), "gauges").sections]
    ['Gauge']
    """
    if name not in (names := [section.name for section in catalogue.sections]):
        raise refuse(name, "unknown section", suggest_nearest(name, names))
    return replace(catalogue, sections=tuple(section for section in catalogue.sections if section.name == name))


def catalogue_body(catalogue: Catalogue) -> dict[str, Any]:
    """Convert the catalogue to plain values by section and entry, as written in a design file, with the sources.

    >>> from flexstage.mechanism.catalogue import Catalogue
    >>> catalogue_body(Catalogue((), {}).extended({"materials": {"steel": {"young": "200 GPa"}}}))["materials"]
    {'steel': {'young': '200 GPa'}}
    """
    return {**{section.name: dict(section.entries) for section in catalogue.sections}, "sources": dict(catalogue.sources)}


def _section_table(section: Section, sources: Mapping[str, str]) -> Table:
    keys = list(dict.fromkeys(key for entry in section.entries.values() for key in entry if key not in (TAGS, "source")))
    rows = [[Cell(name, Mark.STRONG), *(_entry_cell(entry, key) for key in keys)] for name, entry in section.entries.items()]
    tags = [tag for entry in section.entries.values() for tag in entry.get(TAGS, {}).values()]
    used = {word for tag in tags for word in tag.split()[1:2]}
    notes = [f"{key}: {text}" for key, text in sources.items() if key in used]
    return make_table(f"{section.title}: {len(rows)}", ["name", *keys], rows, notes=notes)


def _entry_cell(entry: Mapping[str, Any], key: str) -> Cell:
    if key not in entry:
        return Cell("", Mark.FAINT)
    tag = str(entry.get(TAGS, {}).get(key, "")).partition(" ")[0]
    return Cell(str(entry[key]), TAG_MARKS.get(tag, Mark.PLAIN))
