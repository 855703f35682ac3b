"""Lines for the reader: results to stdout, all else to stderr."""

from __future__ import annotations

import sys
from contextlib import suppress


def say(text: str = "") -> None:
    """Print a line of a result to stdout."""
    sys.stdout.write(f"{text}\n")


def tell(text: str) -> None:
    """Print a line that is not the result (progress, where a file was written) to stderr, as long as somebody reads there."""
    with suppress(BrokenPipeError):
        sys.stderr.write(f"{text}\n")


def warn(text: str) -> None:
    """Print a warning to stderr."""
    tell(f"warning: {text}")
