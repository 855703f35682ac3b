"""Lines for the reader: results to stdout, all else to stderr."""

from __future__ import annotations

import os
import sys
from typing import TextIO


def say(text: str = "") -> None:
    """Print a line of a result to stdout."""
    sys.stdout.write(f"{text}\n")


def tell(text: str) -> None:
    """Print a line that is not the result (progress, where a file was written) to stderr, as long as somebody reads there."""
    try:
        sys.stderr.write(f"{text}\n")
    except BrokenPipeError:
        silence(sys.stderr)


def silence(stream: TextIO) -> None:
    """Let go of a stream whose reader has gone: what is held back would fail again at the interpreter's end, and change the exit code."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def finish() -> None:
    """Write out what is held back on stdout and stderr, as long as somebody reads there."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:
            silence(stream)


def warn(text: str) -> None:
    """Print a warning to stderr."""
    tell(f"warning: {text}")
