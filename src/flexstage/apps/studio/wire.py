"""Messages of the studio as JSON text: written from their classes, and read back with all errors reported."""

from __future__ import annotations

import base64
import json
import math
import re
import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from flexstage.apps.studio.protocol import Floats, Request, Said
from flexstage.base.finding import refuse

_ADVICE = "Reload the page: its version differs from the version of the server"
_LARGEST = 2**53 - 1
"""The largest integer that is exact in a page and in this server."""
_SURROGATE = re.compile("[\ud800-\udfff]")


def encode(message: Said | Request) -> str:
    """Convert a message to JSON text. Numbers that are not finite become null."""
    return json.dumps({"kind": type(message).__name__.lower(), **_plain(message)}, ensure_ascii=False, allow_nan=False)


def decode(text: str | bytes, base: type = Request) -> Any:
    """Read a message from a text: a request, or another subclass of `base`. Raises `DesignError` if the text is not a message."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        raise refuse("message", "not valid JSON", _ADVICE) from None
    kind = _kinds(base).get(str(found.pop("kind", ""))) if isinstance(found, dict) else None
    if kind is None:
        raise refuse("message", "unknown kind", _ADVICE)
    return _record(kind, found, kind.__name__.lower())


def floats(values: Any) -> Floats:
    """Convert an array to a message."""
    import numpy as np  # the server does not load numpy

    found = np.ascontiguousarray(values, dtype="<f8")
    return Floats(found.shape, base64.b64encode(found.tobytes()).decode("ascii"))


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        return {each.name: _plain(getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [_plain(item) for item in value]
    if hasattr(value, "item"):
        return _plain(value.item())
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _kinds(base: type) -> Mapping[str, type]:
    """The messages of a base class by their kind."""
    below = base.__subclasses__()
    return {name: kind for each in below for name, kind in _kinds(each).items()} if below else {base.__name__.lower(): base}


def _value(hint: Any, found: Any, where: str) -> Any:
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return _of_union(arguments, found, where)
    if origin is Literal:
        return found if found in arguments else _wrong(where, found)
    if origin is tuple:
        return tuple(_value(arguments[0], item, f"{where}.{number}") for number, item in enumerate(_of(list, found, where)))
    if origin is dict:
        return {key: _value(arguments[1], item, f"{where}.{key}") for key, item in _of(dict, found, where).items()}
    if is_dataclass(hint):
        return _record(hint, found, where)
    if hint is Any:
        return found
    if hint is float and type(found) is int:
        found = float(found) if abs(found) <= _LARGEST else found
    return found if type(found) is hint and _is_sound(found) else _wrong(where, found)


def _is_sound(found: Any) -> bool:
    """Whether a value is portable JSON: a finite float, an integer that a float represents exactly, text that is Unicode."""
    if isinstance(found, float):
        return math.isfinite(found)
    return abs(found) <= _LARGEST if isinstance(found, int) else not isinstance(found, str) or _SURROGATE.search(found) is None


def _of_union(hints: tuple[Any, ...], found: Any, where: str) -> Any:
    """The value by the first hint of a union that fits its type, or the last one."""
    if found is None and type(None) in hints:
        return None
    rest = [hint for hint in hints if hint is not type(None)]
    return _value(str if str in rest and isinstance(found, str) else rest[-1], found, where)


def _of(kind: type, found: Any, where: str) -> Any:
    return found if isinstance(found, kind) else _wrong(where, found)


def _record(kind: Any, found: Any, where: str) -> Any:
    hints = get_type_hints(kind)
    if not isinstance(found, dict) or found.keys() != hints.keys():
        raise refuse(where, f"fields must be {', '.join(hints)}", _ADVICE)
    return kind(**{name: _value(hint, found[name], f"{where}.{name}") for name, hint in hints.items()})


def _wrong(where: str, found: Any) -> Any:
    raise refuse(where, f"wrong type or value (got {_shown(found)})", _ADVICE)


def _shown(found: Any) -> str:
    """A wrong value as text: an integer out of range by its length, others by their type."""
    if type(found) is int and abs(found) > _LARGEST:
        return f"an integer of {len(str(abs(found)))} digits"
    if isinstance(found, str) and not _is_sound(found):
        return "text with half a surrogate pair"
    return f"{found}" if isinstance(found, float) else type(found).__name__
