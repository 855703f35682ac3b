"""Output to the terminal: results to stdout, all other text to stderr; treatment of control characters and write errors."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

from flexstage.base.finding import DesignError, refuse
from flexstage.base.text import printable

if TYPE_CHECKING:
    from typing_extensions import Buffer


def print_result(text: str = "") -> None:
    """Print a line of a result to stdout."""
    sys.stdout.write(f"{text}\n")


def print_note(text: str) -> None:
    """Print a line other than a result (progress, the path of a written file) to stderr."""
    sys.stderr.write(f"{text}\n")


def print_warning(text: object) -> None:
    """Print a warning to stderr."""
    print_note(f"warning: {text}")


def print_styled(text: str) -> None:
    """Print a result with terminal styles to stdout. Control characters in texts of users must be escaped before the call."""
    encoding = sys.stdout.encoding or "utf-8"
    print_bytes(text.encode(encoding, "backslashreplace"))


def print_bytes(data: bytes) -> None:
    """Print bytes to stdout unchanged."""
    sys.stdout.flush()
    sys.stdout.buffer.write(data)
    sys.stdout.buffer.flush()


@contextmanager
def streams() -> Generator[None]:
    """Replace stdout and stderr during a command.

    Control characters are written as escapes. A failed write to stdout (a full disk, a closed stream) is an error; for a closed pipe the
    error is `BrokenPipeError`. A failed write to stderr is ignored.
    """
    _fill()
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _stream(before[0], 1), _stream(before[1], 2)
    try:
        yield
    finally:
        for each in (sys.stdout, sys.stderr):
            with contextlib.suppress(DesignError, OSError):
                each.flush()
        sys.stdout, sys.stderr = before


def _fill() -> None:
    """Open replacements for closed standard streams, so that files do not get their numbers. Stdout still fails."""
    for number, mode in enumerate((os.O_RDONLY, os.O_RDONLY, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)  # takes the lowest free number


def _stream(stream: TextIO | None, number: int) -> TextIO:
    try:
        number = number if stream is None else stream.fileno()
    except io.UnsupportedOperation:  # a notebook's
        return stream or sys.__stdout__ or io.StringIO()
    except ValueError:  # closed by the program that called this
        pass
    raw = _Raw(number, told=number != 2 if stream is None else stream is sys.stdout)
    by_lines = stream is sys.stderr or raw.isatty()
    return _Printable(io.BufferedWriter(raw), getattr(stream, "encoding", None) or "utf-8", "backslashreplace", line_buffering=by_lines)


class _Raw(io.FileIO):
    """Bytes of a stream. After the first refusal they are discarded; if `told`, it raises an error, or `BrokenPipeError`."""

    def __init__(self, number: int, *, told: bool) -> None:
        super().__init__(number, "w", closefd=False)
        self._told, self._refused = told, False

    def write(self, data: Buffer, /) -> int:
        """Write some of the bytes; returns their number."""
        try:
            while not self._refused:
                count = super().write(data)
                if count is not None:
                    return count
                time.sleep(0.01)  # the pipe is full and does not block
        except OSError as error:
            self._refused = True
            if self._told and isinstance(error, BrokenPipeError):
                raise
            if self._told:
                raise refuse("stdout", f"cannot be written: {error.strerror}", "Free space, or redirect the output") from None
        return memoryview(data).nbytes


class _Printable(io.TextIOWrapper):
    """A text stream without terminal control characters."""

    def write(self, text: str, /) -> int:
        """Write text."""
        super().write(printable(text, keep="\n\t"))
        return len(text)
