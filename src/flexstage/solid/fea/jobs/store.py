"""Files of superelements and hinges: one line of JSON that describes the data, then the arrays as NPZ. The files contain no code."""

from __future__ import annotations

import functools
import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.base.version import __version__
from flexstage.solid.fea.hinges.hinge_form import HingeSolid
from flexstage.solid.fea.jobs.install import SOLVER_VERSION
from flexstage.solid.fea.solver.superelement import Skin, Superelement

FORMAT = 1
"""Number of the file format; increase it with every change of the format."""

_RECORDS = {record.__name__: record for record in (Superelement, Skin, HingeSolid, Finding)}


@functools.cache
def program() -> str:
    """Return the identity of the program: flexstage with a digest of its solid model's code, NGSolve, and the file format.

    Stored results of another program identity are therefore never used.

    >>> program().endswith(f"with NGSolve {SOLVER_VERSION}, format {FORMAT}")
    True
    """
    state = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        state.update(path.name.encode() + path.read_bytes())
    return f"flexstage {__version__} ({state.hexdigest()[:16]}) with NGSolve {SOLVER_VERSION}, format {FORMAT}"


def to_bytes(element: Superelement | HingeSolid | None, key: str) -> bytes:
    """Return the bytes of a file that stores a superelement or a hinge with its `key`, or only the key (`None`).

    >>> small = Superelement(0, 0, {}, {}, {}, {}, {}, {}, {}, np.zeros((0, 6)), np.zeros((0, 6)), Skin(*[np.zeros(0)] * 5), 3, 1)
    >>> from_bytes(to_bytes(small, "key"), "key").freedoms
    3
    """
    arrays: dict[str, Array] = {}
    tree = _flatten(element, "", arrays)
    body = io.BytesIO()
    np.savez(body, allow_pickle=False, **{str(number): value for number, value in enumerate(arrays.values())})
    head = {"what": f"flexstage {type(element).__name__.lower()}", "key": key, "made": program(), "tree": tree}
    return json.dumps({**head, "checksum": _checksum(head, body.getvalue())}).encode() + b"\n" + body.getvalue()


def from_bytes(data: bytes, key: str) -> Any:
    """Return the value stored by `to_bytes`. If the data are damaged, of another version or for another key, return the reason as text.

    >>> from_bytes(b"nonsense", "key")
    'it is damaged: unknown header'
    """
    line, _, body = data.partition(b"\n")
    try:
        head = json.loads(line)
        stated = head.pop("checksum")
    except (ValueError, KeyError, AttributeError, RecursionError):
        return "it is damaged: unknown header"
    if _checksum(head, body) != stated:
        return f"it is damaged: wrong checksum of its {len(data):,} bytes"
    if head.get("made") != program():
        return f"it is of another version: {head.get('made')}"
    if head.get("key") != key:
        return "it has other content"
    with np.load(io.BytesIO(body), allow_pickle=False) as arrays:
        return _build(head["tree"], arrays)


def _checksum(head: Mapping[str, Any], body: bytes) -> str:
    state = hashlib.blake2b(json.dumps(head).encode(), digest_size=32)
    state.update(body)
    return state.hexdigest()


def _flatten(value: object, path: str, arrays: dict[str, Array]) -> Any:
    """A value as JSON, its arrays by number in order of `arrays`."""
    if isinstance(value, np.ndarray):
        arrays[path] = value
        return {"array": len(arrays) - 1}
    if isinstance(value, Mapping):
        return {"map": [[name, _flatten(item, f"{path}/{name}", arrays)] for name, item in value.items()]}
    if is_dataclass(value):
        parts = {field.name: _flatten(getattr(value, field.name), f"{path}.{field.name}", arrays) for field in fields(value)}
        return {"record": type(value).__name__, "fields": parts}
    if value is None or isinstance(value, (int, float, str)):
        return value
    raise TypeError(f"{path} cannot be stored: {type(value).__name__}")


def _build(tree: Any, arrays: Mapping[str, Array]) -> Any:
    if not isinstance(tree, dict):
        return tree
    if "array" in tree:
        return arrays[str(tree["array"])]
    if "map" in tree:
        return {name: _build(item, arrays) for name, item in tree["map"]}
    return _RECORDS[tree["record"]](**{name: _build(item, arrays) for name, item in tree["fields"].items()})
