"""The text of an edited design: snapshots for undo and redo, named pinned designs, and its file on disk."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from flexstage.base.finding import refuse
from flexstage.base.storage.store import write

_MOST = 200
"""Number of stored snapshots."""
_USUAL = 5_000_000
"""Largest file that is read here [bytes]; the reader of designs reports larger and unreadable files."""
_MARK = b"\xef\xbb\xbf"


@dataclass(frozen=True)
class Stored:
    """A file on disk: its `text` with line ends converted to LF, its digest, its byte order mark and its line ends."""

    path: Path
    text: str
    digest: str
    mark: bytes
    ending: str

    @classmethod
    def read(cls, path: Path) -> Stored:
        """Read a file as it is on disk. Raises `DesignError` if the file cannot be read."""
        raw, text = _read(path)
        mark = _MARK if raw.startswith(_MARK) else b""
        ending = "\r\n" if "\r\n" in text and text.count("\n") == text.count("\r\n") else "\n"
        return cls(path, text.replace("\r\n", "\n") if ending == "\r\n" else text, _digest(raw), mark, ending)

    def write(self, text: str, *, over: bool) -> Stored:
        """Write a text to the file, completely or not at all. Unless `over` is true, refuse if another program has changed the file."""
        found = _digest(self.path.read_bytes()) if self.path.exists() else ""
        if found != self.digest and not over:
            what = "changed on disk by another program" if found else "removed by another program"
            raise refuse(self.path.name, what, "Reload it (your text remains in undo), or overwrite it")
        raw = self.mark + text.replace("\n", self.ending).encode()
        write(self.path, raw)
        return replace(self, text=text, digest=_digest(raw))


@dataclass(frozen=True)
class History:
    """The present text, earlier texts and undone texts. `revision` counts all changes; `page` made the last change."""

    text: str
    past: tuple[str, ...] = ()
    future: tuple[str, ...] = ()
    revision: int = 1
    page: int = 0
    pins: Mapping[str, str] = field(default_factory=dict[str, str])

    def change(self, text: str, page: int) -> History:
        """Return the history with another present text; an equal text changes nothing."""
        if text == self.text:
            return self
        return self._step(text, (*self.past, self.text)[-_MOST:], (), page)

    def undo(self, page: int) -> History:
        """Return the history with the previous text restored."""
        return self._step(self.past[-1], self.past[:-1], (self.text, *self.future), page) if self.past else self

    def redo(self, page: int) -> History:
        """Return the history with the next undone text restored."""
        return self._step(self.future[0], (*self.past, self.text), self.future[1:], page) if self.future else self

    def _step(self, text: str, past: tuple[str, ...], future: tuple[str, ...], page: int) -> History:
        return replace(self, text=text, past=past, future=future, revision=self.revision + 1, page=page)

    def pin(self, name: str, *, keep: bool) -> History:
        """Return the history with the present text pinned under a name, or with that name removed."""
        kept = {key: text for key, text in self.pins.items() if key != name}
        return replace(self, pins={**kept, name: self.text} if keep else kept)

    def require_known(self, revision: int, page: int) -> None:
        """Refuse an edit of a page that has not received the last change of another page."""
        if revision < self.revision and page != self.page:
            raise refuse("text", "another window changed the text first", "The new text is shown now; repeat your change")


def _read(path: Path) -> tuple[bytes, str]:
    """A file's bytes and text; raises `DesignError` if it does not exist."""
    with contextlib.suppress(OSError, ValueError):
        if path.is_file() and path.stat().st_size <= _USUAL:
            raw = path.read_bytes()
            return raw, raw.decode("utf-8-sig")
    from flexstage.mechanism.store.file import read_text  # takes long to import

    text = read_text(path)
    return path.read_bytes(), text


def _digest(raw: bytes) -> str:
    return hashlib.sha256(raw).hexdigest()
