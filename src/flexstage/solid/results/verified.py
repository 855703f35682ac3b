"""Verifications that are known: rows and warnings in the user's cache, as long as neither the description nor the program changes."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from flexstage.base.finding import DesignError, Finding
from flexstage.base.register import offered_packages
from flexstage.base.storage.digest import digest
from flexstage.base.storage.store import write
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.fea.geometry.sound import has_imports
from flexstage.solid.fea.jobs.cache import Cache, folder_of
from flexstage.solid.fea.jobs.install import SOLVER_VERSION
from flexstage.solid.results.resolution import Resolution
from flexstage.solid.results.verification import Row, Verification

MOST = 200
"""Files that are kept; those written longest ago go first."""


@dataclass(frozen=True)
class Known:
    """What a verification tells without the solids behind it: its rows, why a group is not there, its own warnings and notes."""

    rows: tuple[Row, ...]
    reasons: Mapping[str, str]
    warnings: tuple[Finding, ...]
    notes: tuple[str, ...] = ()

    def of(self, mechanism: Mechanism) -> Verification:
        """The verification of a description, without solids: enough for tables and documents, too little for a report."""
        return Verification(mechanism, self.rows, {}, None, None, self.reasons)


def recall(mechanism: Mechanism, asked: Resolution, cache: Cache) -> Known | None:
    """What is known of a verification; `None` where nothing is, or what is there cannot be used.

    >>> recall(Mechanism("nothing"), Resolution(), Cache(Path("/nowhere"))) is None
    True
    """
    try:
        found = json.loads(_path(mechanism, asked, cache).read_text(encoding="utf-8"))
        text = found["told"]
        if found["checksum"] != _sum(text):
            return None
        told: dict[str, Any] = json.loads(text)
        rows = tuple(_row(each) for each in told["rows"])
        return Known(rows, told["reasons"], tuple(Finding(**each) for each in told["warnings"]), tuple(told["notes"]))
    except (OSError, ValueError, KeyError, TypeError):  # not there, or damaged: it is worked out again
        return None


def _row(told: dict[str, Any]) -> Row:
    values: dict[str, Any] = {**told, "calibration": tuple(told["calibration"])}
    return Row(**values)


def retain(known: Known, mechanism: Mechanism, asked: Resolution, cache: Cache) -> None:
    """Keep what a verification tells. Not that of imported solids, whose files may change; where there is no room, nothing is kept."""
    if has_imports(mechanism):
        return
    path, text = _path(mechanism, asked, cache), json.dumps(asdict(known))
    with contextlib.suppress(OSError, DesignError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write(path, json.dumps({"checksum": _sum(text), "told": text}))
        for old in sorted(path.parent.glob("*.verified"), key=lambda each: -each.stat().st_mtime)[MOST:]:
            old.unlink(missing_ok=True)


def _path(mechanism: Mechanism, asked: Resolution, cache: Cache) -> Path:
    key = _sum(f"{digest(mechanism)} {asked} {_program()}")
    return folder_of(cache) / f"{key}.verified"


def _sum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:32]


@functools.cache
def _program() -> str:
    """Digest of all that a verification is worked out by: the code of flexstage, what it computes with, and packages that add to it."""
    state = hashlib.sha256(" ".join([SOLVER_VERSION, version("numpy"), version("scipy"), *offered_packages()]).encode())
    home = str(Path(__file__).parents[2])
    files = sorted(f"{folder}/{name}" for folder, _, names in os.walk(home) for name in names if name.endswith(".py"))
    for name in files:
        with open(name, "rb") as stream:  # noqa: PTH123 (of nine hundred files)
            state.update(name.removeprefix(home).encode() + stream.read())
    return state.hexdigest()
