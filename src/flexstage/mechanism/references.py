"""References between the entries of a description, found by the fields that contain names."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import fields, replace
from typing import Any

from flexstage.base.number import Table
from flexstage.base.storage.digest import Description

SECTIONS = {
    "material": "materials",
    "counter": "materials",
    "replaces": "parts",
    "part": "parts",
    "unit": "units",
    "like": "units",
    "gauge": "sensors",
}
"""Section of a description to which a field refers, by field name."""
BODIES = ("body", "base", "of", "joins")
"""Fields that refer to bodies."""
FILES = ("file", "stiffness_file", "mass_file", "damping_file")
"""Fields of parts and outlines that contain file names."""


def references(value: Any, where: str) -> Iterator[tuple[str, str, str]]:
    """Yield (address, section, name) of each reference to a material, part, unit or sensor in a value at `where`.

    >>> from flexstage.parts.notch import Notch
    >>> from flexstage.parts.profile import Circular
    >>> list(references(Notch("steel", 1e-3, 1e-2, Circular(5e-3)), "parts.notch"))
    [('parts.notch.material', 'materials', 'steel')]
    """
    entries: dict[str, Any] = {}
    if isinstance(value, Mapping):
        entries = {name: item for name, item in value.items() if not (name == "like" and isinstance(item, str))}
    elif isinstance(value, Description):
        entries = {each.name: getattr(value, each.name) for each in fields(value)}  # type: ignore[arg-type]
    for name, item in entries.items():
        if isinstance(item, str) and name in SECTIONS and (item or name != "replaces"):
            yield f"{where}.{name}", SECTIONS[name], item
        else:
            yield from references(item, f"{where}.{name}")


def renamed(value: Any, names: Collection[str], change: Callable[[str, str], str]) -> Any:
    """Return a value in which each string of the fields `names` is replaced by `change(field, string)`.

    A value without these fields is returned unchanged.

    >>> from flexstage.mechanism.mechanism import Link
    >>> renamed(Link(("ground", "platform"), "leaf"), BODIES, lambda field, name: f"fine/{name}").joins
    ('fine/ground', 'fine/platform')
    """
    return transformed(value, lambda field, leaf: change(field, leaf) if field in names and leaf and isinstance(leaf, str) else leaf)


def transformed(value: Any, change: Callable[[str, Any], Any], field: str = "") -> Any:
    """Return a value in which each leaf of its tree is replaced by `change(field, leaf)`; unchanged objects are kept.

    >>> transformed((1.0, (2.0, 3.0)), lambda _, number: 2.0 * number)
    (2.0, (4.0, 6.0))
    """
    if isinstance(value, Description):
        own = {each.name: getattr(value, each.name) for each in fields(value) if each.init}  # type: ignore[arg-type]
        new = {name: transformed(item, change, name) for name, item in own.items()}
        new = {name: item for name, item in new.items() if item is not own[name]}
        return replace(value, **new) if new else value  # type: ignore[type-var]
    if isinstance(value, Table):
        entries = {key: transformed(item, change, field) for key, item in value.items()}
        return Table(entries) if any(entries[key] is not item for key, item in value.items()) else value
    if isinstance(value, tuple):
        items = tuple(transformed(item, change, field) for item in value)
        return items if any(item is not old for item, old in zip(items, value, strict=True)) else value
    return change(field, value)
