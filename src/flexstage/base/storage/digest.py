"""Content digests and comparison of frozen descriptions."""

from __future__ import annotations

import functools
import hashlib
import struct
from collections.abc import Callable, Mapping
from dataclasses import fields
from enum import Enum
from typing import Any, ParamSpec, TypeVar

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.register import origin
from flexstage.base.session import SESSION

DOCUMENT_ONLY = {"physics": False}
"""Field metadata that exclude a field (a name, tags, sources) from the physics digest."""

WHERE_STATED = {"where_stated": True}
"""Field metadata: digests omit the field if it is empty. Digests that were computed before the field existed thus remain valid."""

KEY = "key"
"""Entry of field metadata: the name of the field in files and addresses, if this name is a Python keyword."""

_KEPT = "_digests"
_MANY = 64

P = ParamSpec("P")
T = TypeVar("T")


class Description(CheckedFields):
    """Base class of all descriptions, which are immutable and are compared and hashed by content.

    Two digests exist: `digest(value)` covers the whole document; `digest(value, physics=True)` omits fields marked `DOCUMENT_ONLY`. Floats
    are compared by their bits. The digest of a class from another package includes the package's version.
    """

    __slots__ = ()
    frozen_values = True

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and digest(self) == digest(other)

    def __hash__(self) -> int:
        return hash(digest(self))

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != _KEPT}


def keep(function: Callable[P, T]) -> Callable[P, T]:
    """Decorate a function of descriptions to cache its last 64 results by content. Results for batches are not cached.

    Successive designs often differ in one part only; the cached results of the other parts are reused. Cached arrays are read-only.

    >>> counted = []
    >>> double = keep(lambda value: counted.append(value) or 2.0 * value)
    >>> double(2.0), double(2.0), len(counted)
    (4.0, 4.0, 1)
    """

    @SESSION.keep(_MANY)
    @functools.wraps(function)
    def known(*args: P.args, **kwargs: P.kwargs) -> T:
        result = function(*args, **kwargs)
        for each in result if isinstance(result, tuple) else (result,):
            if isinstance(each, np.ndarray):
                each.setflags(write=False)
        return result

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> T:
        one = not kwargs and all(map(_is_single, args))
        return known(*args) if one else function(*args, **kwargs)  # type: ignore[arg-type]

    return call


def _is_single(value: Any) -> bool:
    """Whether it is a single design."""
    if isinstance(value, Description):
        return all(_is_single(getattr(value, field.name)) for field in fields(value))  # type: ignore[arg-type]
    if isinstance(value, (tuple, list)):
        return all(map(_is_single, value))
    return not isinstance(value, (np.ndarray, Mapping))


def digest(value: Any, *, physics: bool = False) -> str:
    """Return the SHA-256 of a description's content or, if `physics` is true, of the fields that affect the mechanics.

    >>> digest(1.0) == digest(1.0), digest(1.0) == digest(1)
    (True, False)
    """
    if isinstance(value, Description):
        return _own(value, physics=physics).hex()
    return hashlib.sha256(_content(value, physics=physics)).hexdigest()


def _own(value: Description, *, physics: bool) -> bytes:
    """Digest of one description, cached with it: varied designs share unchanged parts."""
    known: dict[bool, bytes] = value.__dict__.setdefault(_KEPT, {})
    if physics not in known:
        pieces = [b"D" + type(value).__name__.encode() + origin(type(value).__module__).encode()]
        for name, piece, always in _counted_fields(type(value), physics=physics):
            if always or getattr(value, name):
                pieces += piece, _content(getattr(value, name), physics=physics)
        known[physics] = hashlib.sha256(b"".join(pieces)).digest()
    return known[physics]


def _content(value: Any, *, physics: bool) -> bytes:
    if isinstance(value, Description):
        return b"D" + _own(value, physics=physics)
    if isinstance(value, Mapping):
        return b"M" + b"".join(_scalar(key) + _content(value[key], physics=physics) for key in sorted(value)) + b"m"
    if isinstance(value, (tuple, list)):
        return b"T" + b"".join(_content(item, physics=physics) for item in value) + b"t"
    return _scalar(value)


def _scalar(value: Any) -> bytes:
    if isinstance(value, float):
        return b"F" + struct.pack("<d", value)
    if isinstance(value, str):
        return b"S" + str(len(value)).encode() + value.encode()
    if isinstance(value, Enum):
        return b"E" + str(value.value).encode()
    if isinstance(value, np.ndarray):
        return b"A" + str((value.shape, value.dtype)).encode() + value.tobytes()
    return b"O" + repr(value).encode() + b";"


@functools.cache
def _counted_fields(cls: type, *, physics: bool) -> tuple[tuple[str, bytes, bool], ...]:
    """Names of the digest fields, with their data, and whether empty ones are included."""
    counted = [field for field in fields(cls) if not (physics and field.metadata.get("physics") is False)]  # type: ignore[arg-type]
    return tuple((field.name, _scalar(field.name), not WHERE_STATED.items() <= field.metadata.items()) for field in counted)
