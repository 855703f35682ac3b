"""Journal of unsaved edits: one file in the cache for each design and process.

The journal is rewritten before an edit is acknowledged. It remains if the process ends without saving.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

from flexstage.base.finding import DesignError, refuse
from flexstage.base.storage.store import cache_folder, has_ended, process_mark, write

_FOLDER = "studio"


@dataclass(frozen=True)
class Draft:
    """An unsaved text with its time [s since 1970], the pinned designs, the file's digest, and the studio's port and token."""

    time: float
    text: str
    pins: Mapping[str, str]
    digest: str
    port: int
    token: str


@dataclass
class Journal:
    """The unsaved text of the design at `path`, written before an edit is acknowledged."""

    path: Path
    port: int = 0
    token: str = ""
    _is_kept: bool = field(default=False, init=False)

    @property
    def _place(self) -> Path:
        return _folder() / f"{_stem(self.path)}-{process_mark()}.json"

    def keep(self, text: str, pins: Mapping[str, str], digest: str) -> None:
        """Replace the stored text. Raises `DesignError` if the text cannot be stored."""
        draft = Draft(time.time(), text, pins, digest, self.port, self.token)
        place = self._place
        try:
            place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)  # for this user alone: it has the token
        except OSError as error:
            raise refuse(
                str(place.parent), f"cannot be created: {error.strerror}", "Choose another folder, e.g. FLEXSTAGE_CACHE=/tmp/cache"
            ) from None
        write(place, json.dumps(asdict(draft)))
        self._is_kept = True

    def clear(self) -> None:
        """Remove the journal: no unsaved edit remains."""
        if self._is_kept:
            discard(self._place)
            self._is_kept = False


def discard(place: Path) -> None:
    """Remove a journal."""
    with contextlib.suppress(OSError):
        place.unlink()


def drafts(path: Path) -> dict[Path, Draft]:
    """Return the unsaved texts of this design that ended studios left, by journal file, the newest first."""
    found: dict[Path, Draft] = {}
    with contextlib.suppress(OSError, DesignError):
        for place in _folder().glob(f"{_stem(path)}-*.json"):
            with contextlib.suppress(OSError, ValueError, TypeError):
                if has_ended(place.stem.partition("-")[2], place.stat().st_mtime):
                    found[place] = Draft(**json.loads(place.read_text(encoding="utf-8")))
    return dict(sorted(found.items(), key=lambda each: -each[1].time))


def _folder() -> Path:
    return cache_folder() / _FOLDER


def _stem(path: Path) -> str:
    """The part of a journal's name that identifies its design."""
    return hashlib.sha256(str(path.resolve()).encode(errors="surrogateescape")).hexdigest()[:24]
