"""Names by which the entries of a description refer to one another, told by the fields that hold them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
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
"""Section of the entries that a field of this name refers to."""
BODIES = ("body", "base", "of", "joins")
"""Fields that refer to bodies."""


def references(value: Any, where: str) -> Iterator[tuple[str, str, str]]:
    """Yield the names of materials, parts, units and sensors in a value at `where`: address, section, name.

    >>> from flexstage.parts.notch import Notch
    >>> from flexstage.parts.profile import Circular
    >>> list(references(Notch("steel", 1e-3, 1e-2, Circular(5e-3)), "parts.notch"))
    [('parts.notch.material', 'materials', 'steel')]
    """
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from references(item, f"{where}.{name}")
    elif isinstance(value, Description):
        for name in (each.name for each in fields(value)):  # type: ignore[arg-type]
            item = getattr(value, name)
            if isinstance(item, str) and name in SECTIONS and (item or name != "replaces"):
                yield f"{where}.{name}", SECTIONS[name], item
            elif isinstance(item, (Table, Description)):
                yield from references(item, f"{where}.{name}")


def renamed(value: Any, change: Callable[[str, str], str]) -> Any:
    """Return a value with `change(field, name)` in the place of each name to which it refers.

    >>> from flexstage.mechanism.mechanism import Link
    >>> renamed(Link(("ground", "platform"), "leaf"), lambda field, name: f"fine/{name}").joins
    ('fine/ground', 'fine/platform')
    """
    if isinstance(value, Mapping):
        return Table({key: renamed(item, change) for key, item in value.items()})
    if not isinstance(value, Description):
        return value
    own = {each.name: getattr(value, each.name) for each in fields(value) if each.init}  # type: ignore[arg-type]
    return replace(value, **{name: _changed(name, item, change) for name, item in own.items()})


def _changed(name: str, item: Any, change: Callable[[str, str], str]) -> Any:
    if (name not in SECTIONS and name not in BODIES) or not item:
        return renamed(item, change)
    if isinstance(item, Mapping):
        return Table({key: change(name, each) for key, each in item.items()})
    if isinstance(item, tuple):
        return tuple(change(name, each) for each in item)
    return change(name, item) if isinstance(item, str) else renamed(item, change)
