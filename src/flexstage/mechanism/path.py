"""Reading and replacing one field deep inside a frozen description."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

from flexstage.base.number import Table

_INDEX = {"x": 0, "y": 1, "z": 2, "0": 0, "1": 1, "2": 2}


def member(value: Any, name: str) -> Any:
    """Return the field, entry or component of that name.

    >>> member((1.0, 2.0, 3.0), "y")
    2.0
    """
    if isinstance(value, Mapping):
        return value[name]
    if isinstance(value, tuple):
        return value[int(name) if name.isdigit() else _INDEX[name]]
    return getattr(value, name)


def has_member(value: Any, name: str) -> bool:
    """Whether the value has a field, entry or component of that name.

    >>> has_member((1.0, 2.0, 3.0), "w")
    False
    """
    if isinstance(value, Mapping):
        return name in value
    if isinstance(value, tuple):
        return (int(name) if name.isdigit() else _INDEX.get(name, len(value))) < len(value)
    return is_dataclass(value) and any(field.name == name for field in fields(value))


def complete(value: Any, path: tuple[str, ...]) -> tuple[str, ...]:
    """Return the full path, filling in one skipped level (`radius` for `profile.radius`) where that is unique.

    Raises `KeyError` with the name that was not found.
    """
    if not path:
        return ()
    if has_member(value, path[0]):
        return path[:1] + complete(member(value, path[0]), path[1:])
    inner = [field.name for field in fields(value) if _holds(value, field.name, path[0])] if is_dataclass(value) else []
    if len(inner) != 1:
        raise KeyError(path[0])
    return (inner[0], *complete(getattr(value, inner[0]), path))


def _holds(value: Any, name: str, wanted: str) -> bool:
    inner = getattr(value, name)
    return is_dataclass(inner) and has_member(inner, wanted)


def replaced(value: Any, path: tuple[str, ...], new: Any) -> Any:
    """Return a copy of the value in which the member at the full path is `new`.

    >>> replaced((1.0, 2.0, 3.0), ("y",), 5.0)
    (1.0, 5.0, 3.0)
    """
    if not path:
        return new
    inner = replaced(member(value, path[0]), path[1:], new)
    if isinstance(value, Mapping):
        return Table({**value, path[0]: inner})
    if isinstance(value, tuple):
        index = int(path[0]) if path[0].isdigit() else _INDEX[path[0]]
        return (*value[:index], inner, *value[index + 1 :])
    return replace(value, **{path[0]: inner})
