"""JSON Schema (2020-12) of files, for editors: keys, alternatives, units with examples, and descriptions."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from flexstage.mechanism.assembly.mount import STAGES, Mount
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import Definitions
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.decode import CATALOGUE
from flexstage.mechanism.store.file import FORMAT
from flexstage.mechanism.store.include import INCLUDE


def schema() -> dict[str, Any]:
    """Return the JSON Schema of a design file. Each class is a definition; quantities are strings with a unit.

    >>> schema()["properties"]["max_mode_frequency"]["examples"]
    ['4 kHz']
    """
    result = schema_of(Mechanism, FORMAT, "flexstage design", formulas=True, tables={STAGES: Mount})
    said = "Files to include, with numbers, materials, parts, sensors, units and sources; paths are relative to this file."
    result["properties"] |= {INCLUDE: {"type": "array", "items": {"type": "string"}, "description": said}}
    result["properties"] |= {CATALOGUE: {"type": "string", "description": "File with more materials, actuators and sensors for `like`."}}
    return result


def schema_of(
    record: type, form: str, title: str, *, tagged: bool = True, formulas: bool = False, tables: Mapping[str, type] = MappingProxyType({})
) -> dict[str, Any]:
    """Return the JSON Schema of a file that contains one record of a class, and `format = form`.

    If `tagged`, tables may have tags; if `formulas`, numbers may be formulas. `tables` are additional tables of records, by key.

    >>> from flexstage.parts.rod import Rod
    >>> schema_of(Rod, "rod 1", "rod")["properties"]["format"]
    {'const': 'rod 1'}
    """
    definitions = Definitions(tagged, formulas)
    root = node_of(record).definition(definitions)
    beside = {name: {"type": "object", "additionalProperties": node_of(each).schema(definitions)} for name, each in tables.items()}
    properties = {"format": {"const": form}, **root.pop("properties"), **beside}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        **root,
        "required": ["format", *root["required"]],
        "properties": properties,
        "$defs": dict(sorted(definitions.known.items())),
    }
