"""The envelope of every document, and its text: plain JSON, finite numbers only."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from enum import Enum
from typing import Any, TypeAlias

import numpy as np

import flexstage
from flexstage.analysis.cautions import Caveats, caveats
from flexstage.base.digest import digest
from flexstage.base.finding import Finding
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.theory import Reading

FORMAT = "flexstage result 1"

Document: TypeAlias = dict[str, Any]


def enveloped(
    kind: str, mechanism: Mechanism | None, reading: Reading | None, body: Mapping[str, Any], more: Iterable[Finding] = ()
) -> Document:
    """A document: what it is, of which description (absent: of a record alone), by which reading and version, caveats, then its `body`.

    `more` are cautions of the result's own.

    >>> enveloped("mapping", Mechanism("stage"), None, {"mobility": 6})["name"]
    'stage'
    """
    known = Caveats() if mechanism is None else caveats(mechanism)
    return {
        "format": FORMAT,
        "kind": kind,
        "version": flexstage.__version__,
        "name": None if mechanism is None else mechanism.name,
        "reading": None if reading is None else reading.value,
        "physics_digest": None if mechanism is None else digest(mechanism, physics=True),
        "cautions": findings((*known.cautions, *more)),
        "defaults": findings(known.defaults),
        **body,
    }


def findings(found: Iterable[Finding]) -> list[Document]:
    """Findings as {where, what, advice}.

    >>> findings([Finding("B4/pivot", "it is thin", "Thicken it")])
    [{'where': 'B4/pivot', 'what': 'it is thin', 'advice': 'Thicken it'}]
    """
    return [{"where": each.where, "what": each.what, "advice": each.advice} for each in found]


def plain(document: Mapping[str, Any]) -> Document:
    """The document in plain values: numbers that are not finite are null, with their reasons by path under `reasons`.

    >>> plain({"gain": float("inf")})
    {'gain': None, 'reasons': {'gain': 'infinite'}}
    """
    reasons: dict[str, str] = dict(document.get("reasons") or {})
    values = _plain({key: value for key, value in document.items() if key != "reasons"}, "", reasons)
    return {**values, **({"reasons": reasons} if reasons else {})}


def as_text(document: Mapping[str, Any]) -> str:
    """The document as JSON text: finite numbers only, every other one null with its reason under `reasons`.

    >>> print(as_text({"gain": float("nan")}))
    {
     "gain": null,
     "reasons": {
      "gain": "not a number"
     }
    }
    """
    text = json.dumps(plain(document), indent=1, ensure_ascii=False, allow_nan=False)
    return "\n".join(line if line.isprintable() else "".join(map(_escaped, line)) for line in text.split("\n"))


def _escaped(letter: str) -> str:
    """A letter as it stands in JSON; what is not printable as its escape, which means the same and steers no terminal."""
    return letter if letter.isprintable() else json.dumps(letter)[1:-1]


def _plain(value: Any, where: str, reasons: dict[str, str]) -> Any:
    """Plain JSON values; what is not finite is noted in `reasons` under its path (`modes.3.frequency_hz`)."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item, f"{where}.{key}" if where else str(key), reasons) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist(), where, reasons)
    if isinstance(value, (list, tuple)):
        if all(type(item) is float and math.isfinite(item) for item in value):
            return [item + 0.0 for item in value]  # responses are long
        return [_plain(item, f"{where}.{number}", reasons) for number, item in enumerate(value)]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        return _plain(value.item(), where, reasons)
    if isinstance(value, float) and not math.isfinite(value):
        reasons[where] = "not a number" if math.isnan(value) else "infinite"
        return None
    return value + 0.0 if isinstance(value, float) else value  # no -0.0
