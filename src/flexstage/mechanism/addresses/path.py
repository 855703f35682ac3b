"""Reading and replacing one field deep inside a frozen description."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache, reduce
from typing import Any

from flexstage.base.number import Table
from flexstage.base.storage.digest import KEY

_INDEX = {"x": 0, "y": 1, "z": 2, "rx": 3, "ry": 4, "rz": 5}


def _index(name: str) -> int:
    """Index of a component by its name or number; -1 if unknown."""
    return int(name) if name.isdecimal() else _INDEX.get(name, -1)


MATRICES = ("compliance", "matrix")
"""Fields of symmetric 6x6 matrices."""


def with_mirror(path: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """Return the path and, for an off-diagonal entry of a symmetric 6x6 matrix, also the path of its symmetric entry.

    >>> with_mirror(("compliance", "x", "rz"))
    (('compliance', 'x', 'rz'), ('compliance', 'rz', 'x'))
    """
    if path[-3:-2] and path[-3] in MATRICES and path[-1] != path[-2]:
        return path, (*path[:-2], path[-1], path[-2])
    return (path,)


def member(value: Any, name: str) -> Any:
    """Return the field, entry or component with this name.

    >>> member((1.0, 2.0, 3.0), "y")
    2.0
    """
    if isinstance(value, Mapping):
        return value[name]
    if isinstance(value, tuple):
        return value[_index(name)]
    return getattr(value, _field_name(value, name))


def follow(value: Any, path: Iterable[str]) -> Any:
    """Return the member of a value at a full path.

    >>> follow({"at": (1.0, 2.0)}, ("at", "y"))
    2.0
    """
    return reduce(member, path, value)


def has_member(value: Any, name: str) -> bool:
    """Return whether the value has a field, entry or component with this name.

    >>> has_member((1.0, 2.0, 3.0), "w")
    False
    """
    if isinstance(value, Mapping):
        return name in value
    if isinstance(value, tuple):
        return 0 <= _index(name) < len(value)
    return name in _field_names(type(value))


def _field_name(value: Any, name: str) -> str:
    """Field of a file key that is a Python keyword (`from`)."""
    return _field_names(type(value)).get(name, name)


@cache
def _field_names(kind: type) -> Mapping[str, str]:
    """Fields of a description class, by field name and file key; none for other classes."""
    own = fields(kind) if is_dataclass(kind) else ()
    return {field.name: field.name for field in own} | {field.metadata[KEY]: field.name for field in own if KEY in field.metadata}


def completions(value: Any, name: str) -> tuple[tuple[str, ...], ...]:
    """Return the paths to all members with this name: members of the value itself, else of its nested descriptions and tables.

    >>> completions((1.0, 2.0), "y")
    (('y',),)
    """
    if has_member(value, name):
        return ((_field_name(value, name),),)
    if not is_dataclass(value):
        return ()
    results: list[tuple[str, ...]] = []
    for own in dict.fromkeys(_field_names(type(value)).values()):
        inner = getattr(value, own)
        if isinstance(inner, Mapping) or is_dataclass(inner):
            results += [(own, *rest) for rest in completions(inner, name)]
    return tuple(results)


def complete(value: Any, path: tuple[str, ...]) -> tuple[str, ...]:
    """Return the full path with omitted levels completed (`radius` for `profile.radius`) if unique.

    Raises `KeyError` with the unknown or ambiguous name.

    >>> from flexstage.parts.notch import Notch
    >>> from flexstage.parts.profile import Circular
    >>> complete(Notch("steel", 1e-3, 1e-2, Circular(5e-3)), ("radius",))
    ('profile', 'radius')
    """
    if not path:
        return ()
    result = completions(value, path[0])
    if len(result) != 1:
        raise KeyError(path[0])
    return result[0] + complete(follow(value, result[0]), path[1:])


def replace_member(value: Any, path: tuple[str, ...], new: Any) -> Any:
    """Return a copy of the value in which the member at the full path is `new`.

    >>> replace_member((1.0, 2.0, 3.0), ("y",), 5.0)
    (1.0, 5.0, 3.0)
    """
    return replace_members(value, [(path, new)])


def replace_members(value: Any, changes: Iterable[tuple[tuple[str, ...], Any]]) -> Any:
    """Return a copy of the value with new members at several full paths; no path may be inside another.

    >>> replace_members((1.0, 2.0, 3.0), [(("y",), 5.0), (("z",), 6.0)])
    (1.0, 5.0, 6.0)
    """
    within: dict[str, list[tuple[tuple[str, ...], Any]]] = {}
    for path, new in changes:
        if not path:
            return new
        within.setdefault(path[0], []).append((path[1:], new))
    inner = {name: replace_members(member(value, name), own) for name, own in within.items()}
    if isinstance(value, Mapping):
        return Table({**value, **inner})
    if isinstance(value, tuple):
        placed = {_index(name): each for name, each in inner.items()}
        return tuple(placed.get(index, each) for index, each in enumerate(value))
    return replace(value, **inner)
