"""Number type of a controller for hardware, and the conversion of C code to it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from enum import Enum

import numpy as np

_CONSTANT = re.compile(r"(?<![\w.])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])")


class Precision(Enum):
    """Number type of the controller."""

    SINGLE = "float32"
    DOUBLE = "float64"

    @property
    def bytes(self) -> int:
        """Size of a number [bytes]."""
        return np.dtype(self.value).itemsize

    @property
    def digits(self) -> int:
        """Number of binary digits after the leading digit."""
        return int(np.finfo(self.value).nmant)

    @property
    def tolerance(self) -> float:
        """Tolerance of outputs, divided by the largest output, for rounding errors that accumulate over some hundred samples."""
        return 1e-4 if self is Precision.SINGLE else 1e-11

    @property
    def largest(self) -> float:
        """Largest finite number."""
        return float(np.finfo(self.value).max)


def typed(text: str, precision: Precision) -> str:
    """Convert the constants and types in C code to the number type `precision`."""
    if precision is Precision.DOUBLE:
        return text
    marked = re.sub(r"/\*.*?\*/", lambda comment: re.sub(r"(\d)", "\\1\0", comment.group()), text, flags=re.DOTALL)  # no constants
    return _CONSTANT.sub(r"\1f", re.sub(r"\bdouble\b", "float", marked)).replace("\0", "")


def count_constants(lines: Sequence[str]) -> int:
    """Count the numeric constants in lines of C code.

    >>> count_constants(["{1.0, 2.5e-3}", "x[3]"])
    2
    """
    return len(_CONSTANT.findall(" ".join(lines)))
