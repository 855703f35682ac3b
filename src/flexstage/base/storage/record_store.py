"""Store of results in files, by key: one line of JSON that describes the data, then the arrays as NPZ. The files contain no code."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.store import write

FORMAT = 1
"""Number of the file format; increase it with every change of the format."""


@dataclass(frozen=True)
class RecordStore:
    """Files with the ending `suffix` in a folder. Each file contains a dataclass of the kinds `records`, or only its key (`None`).

    The fields are numbers, strings, arrays, tuples, mappings and such dataclasses. A file is written completely or not at all, and is read
    only by the program that `made` identifies.

    >>> from flexstage.base.finding import Finding
    >>> from flexstage.base.storage.store import temporary_folder
    >>> with temporary_folder() as folder:
    ...     store = RecordStore(folder / "results", ".finding", (Finding,))
    ...     _ = store.keep("first", Finding("B4", "too thin", "Use 1 mm"))
    ...     store.find("first").what
    'too thin'
    """

    folder: Path
    suffix: str
    records: tuple[type, ...]
    made: str = ""

    def path(self, key: str) -> Path:
        """Return the path of the file for a key, which may not exist."""
        return self.folder / f"{key}{self.suffix}"

    def find(self, key: str) -> Any:
        """Return the value stored for a key. Raises `FileNotFoundError`, `OSError` or, for a damaged or outdated file, `ValueError`."""
        return from_bytes(self.path(key).read_bytes(), key, self.records, self.made)

    def keep(self, key: str, value: Any) -> Path:
        """Store a value. Raises `OSError` or `DesignError` if the file cannot be written."""
        return self.write(key, to_bytes(value, key, self.made))

    def write(self, key: str, data: bytes) -> Path:
        """Write the file for a key. Raises `OSError` or `DesignError` if it cannot be written."""
        self.folder.mkdir(parents=True, exist_ok=True)
        return write(self.path(key), data)


def to_bytes(value: Any, key: str, made: str = "") -> bytes:
    """Return the bytes of a file that stores a value with its `key`."""
    arrays: list[Array] = []
    tree = _flatten(value, "", arrays)
    body = io.BytesIO()
    np.savez(body, allow_pickle=False, **{str(number): each for number, each in enumerate(arrays)})
    head = {"what": f"flexstage {type(value).__name__.lower()}", "key": key, "made": made, "tree": tree}
    return json.dumps({**head, "checksum": _checksum(head, body.getvalue())}).encode() + b"\n" + body.getvalue()


def from_bytes(data: bytes, key: str, records: tuple[type, ...], made: str = "") -> Any:
    """Return the value stored by `to_bytes`. Raises `ValueError` for data that are damaged, of another version or for another key.

    >>> from_bytes(b"nonsense", "key", ())
    Traceback (most recent call last):
    ValueError: it is damaged: unknown header
    """
    line, _, body = data.partition(b"\n")
    try:
        head = json.loads(line)
        stated = head.pop("checksum")
    except (ValueError, KeyError, AttributeError, TypeError, RecursionError):
        raise ValueError("it is damaged: unknown header") from None
    if _checksum(head, body) != stated:
        raise ValueError(f"it is damaged: wrong checksum of its {len(data):,} bytes")
    if head.get("made") != made:
        raise ValueError(f"it is of another version: {head.get('made')}")
    if head.get("key") != key:
        raise ValueError("it has other content")
    with np.load(io.BytesIO(body), allow_pickle=False) as arrays:
        return _build(head["tree"], arrays, {record.__name__: record for record in records})


def _checksum(head: Mapping[str, Any], body: bytes) -> str:
    state = hashlib.blake2b(json.dumps(head).encode(), digest_size=32)
    state.update(body)
    return state.hexdigest()


def _flatten(value: object, path: str, arrays: list[Array]) -> Any:
    """A value as JSON, its arrays by number in order of `arrays`."""
    if isinstance(value, np.ndarray):
        arrays.append(value)
        return {"array": len(arrays) - 1}
    if isinstance(value, Mapping):
        return {"map": [[name, _flatten(item, f"{path}/{name}", arrays)] for name, item in value.items()]}
    if is_dataclass(value):
        parts = {field.name: _flatten(getattr(value, field.name), f"{path}.{field.name}", arrays) for field in fields(value)}
        return {"record": type(value).__name__, "fields": parts}
    if isinstance(value, tuple):
        return [_flatten(item, path, arrays) for item in value]
    if value is None or isinstance(value, (int, float, str)):
        return value
    raise TypeError(f"{path} cannot be stored: {type(value).__name__}")


def _build(tree: Any, arrays: Mapping[str, Array], records: Mapping[str, type]) -> Any:
    if isinstance(tree, list):
        return tuple(_build(item, arrays, records) for item in tree)
    if not isinstance(tree, dict):
        return tree
    if "array" in tree:
        return arrays[str(tree["array"])]
    if "map" in tree:
        return {name: _build(item, arrays, records) for name, item in tree["map"]}
    return records[tree["record"]](**{name: _build(item, arrays, records) for name, item in tree["fields"].items()})
