"""Documents: results as plain JSON values (`docs/json.md`).

Matrices are {rows, columns, unit, values}; a scalar's unit is in its key (`frequency_hz`). Numbers that are not finite become null,
with the reason under `reasons`.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import is_dataclass
from enum import Enum
from typing import Any, TypeAlias

import numpy as np

from flexstage.base.record import walk

Document: TypeAlias = dict[str, Any]
_UNUSUAL = re.compile(r"[^ -~\n]")
"""Characters that may be unprintable."""


def plain(result: Any) -> Document:
    """Convert a result, or a mapping of results, to plain values; null values have a reason by path under `reasons`.

    >>> plain({"gain": float("inf")})
    {'gain': None, 'reasons': {'gain': 'infinite'}}
    """
    reasons = dict[str, str]()
    whole = walk(result)
    values = _plain({key: value for key, value in whole.items() if key != "reasons"}, "", reasons)
    reasons = dict(whole.get("reasons") or {}) | reasons
    return {**values, **({"reasons": reasons} if reasons else {})}


def as_text(result: Any) -> str:
    """Return the document as JSON text. A number that is not finite is null, with a reason under `reasons`.

    >>> print(as_text({"gain": float("nan")}))
    {
     "gain": null,
     "reasons": {
      "gain": "not a number"
     }
    }
    """
    text = json.dumps(plain(result), indent=1, ensure_ascii=False, allow_nan=False)
    return _UNUSUAL.sub(lambda found: found[0] if found[0].isprintable() else json.dumps(found[0])[1:-1], text)


def _plain(value: Any, where: str, reasons: dict[str, str]) -> Any:
    """Plain JSON values; values that are not finite get a reason under their path (`modes.3.frequency_hz`)."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item, f"{where}.{key}" if where else str(key), reasons) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist(), where, reasons)
    if isinstance(value, (list, tuple)):
        if all(type(item) is float and math.isfinite(item) for item in value):
            return [item + 0.0 for item in value]  # fast path for long responses
        return [_plain(item, f"{where}.{number}", reasons) for number, item in enumerate(value)]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, complex):
        return _plain((value.real, value.imag), where, reasons)
    if isinstance(value, np.generic):
        return _plain(value.item(), where, reasons)
    if is_dataclass(value):
        return _record(value, where, reasons)
    if isinstance(value, float) and not math.isfinite(value):
        reasons[where] = "not a number" if math.isnan(value) else "infinite"
        return None
    return value + 0.0 if isinstance(value, float) else value  # no -0.0


def _record(value: Any, where: str, reasons: dict[str, str]) -> Any:
    if hasattr(value, "to_json"):
        return _plain(value.to_json(), where, reasons)
    result = walk(value)
    reasons |= {f"{where}.{key}": reason for key, reason in result.pop("reasons", {}).items()}
    return _plain(result, where, reasons)
