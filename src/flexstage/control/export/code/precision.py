"""The numbers of a controller for hardware: their type, and text in it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from enum import Enum

import numpy as np

_CONSTANT = re.compile(r"(?<![\w.])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])")


class Precision(Enum):
    """The type of the controller's numbers."""

    SINGLE = "float32"
    DOUBLE = "float64"

    @property
    def word(self) -> str:
        """The type in C."""
        return "float" if self is Precision.SINGLE else "double"

    @property
    def bytes(self) -> int:
        """Bytes of a number."""
        return np.dtype(self.value).itemsize

    @property
    def digits(self) -> int:
        """Binary digits behind the first."""
        return int(np.finfo(self.value).nmant)

    @property
    def tolerance(self) -> float:
        """How far outputs may be from the simulation's, of the largest: rounding of some hundred samples that add up."""
        return 1e-4 if self is Precision.SINGLE else 1e-11

    @property
    def largest(self) -> float:
        """The largest number."""
        return float(np.finfo(self.value).max)


def typed(text: str, precision: Precision) -> str:
    """Text in a precision: constants and their type."""
    if precision is Precision.DOUBLE:
        return text
    marked = re.sub(r"/\*.*?\*/", lambda comment: re.sub(r"(\d)", "\\1\0", comment.group()), text, flags=re.DOTALL)  # no constants
    return _CONSTANT.sub(r"\1f", re.sub(r"\bdouble\b", "float", marked)).replace("\0", "")


def count_constants(lines: Sequence[str]) -> int:
    """How many numbers stand in a text.

    >>> count_constants(["{1.0, 2.5e-3}", "x[3]"])
    2
    """
    return len(_CONSTANT.findall(" ".join(lines)))
