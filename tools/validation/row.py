"""A number of an authority beside ours, and the verdict; sections of such rows as Markdown."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

SMALL = 1e-12


class Scale(Enum):
    """How a tolerance is meant: in the number's unit, or relative to it."""

    ABSOLUTE = "absolute"
    RELATIVE = "relative"


class Verdict(Enum):
    """What a comparison comes to; `RECORDED` is a disagreement that docs/disagreements.md explains."""

    AGREES = "agrees"
    RECORDED = "disagrees, recorded"
    DISAGREES = "**disagrees**"
    UNEXPECTED = "**agrees, though recorded as a disagreement**"


@dataclass(frozen=True)
class Tolerance:
    """How far ours may be off; `bias` is the known error of the theory itself, of which the difference may depart by `value`."""

    value: float
    scale: Scale = Scale.ABSOLUTE
    bias: float | None = None

    def text(self) -> str:
        """The tolerance as it is printed."""
        if self.bias is not None:
            return f"{100.0 * self.bias:+.2f} ± {100.0 * self.value:.2g} %"
        return f"{self.value:.0e} rel." if self.scale is Scale.RELATIVE else f"{self.value:.2g}"


@dataclass(frozen=True)
class Row:
    """`what` is compared; the `reference` as its `source` prints it, and `ours`, both in `unit`.

    Without `tolerance` ours must round to the digits printed. `recorded` says that they are known to differ. `least`: the reference is
    a requirement, and ours must not be smaller.
    """

    what: str
    source: str
    reference: str
    ours: float
    unit: str = ""
    tolerance: Tolerance | None = None
    recorded: bool = False
    least: bool = False

    @property
    def difference(self) -> float:
        """Ours less the reference: relative where the tolerance is."""
        expected = float(self.reference)
        return (self.ours - expected) / (abs(expected) if self.allowed.scale is Scale.RELATIVE else 1.0)

    @property
    def allowed(self) -> Tolerance:
        """The tolerance, or half of the last digit printed (and a little for halves)."""
        return self.tolerance or Tolerance(0.5001 * _last_digit(self.reference))

    @property
    def verdict(self) -> Verdict:
        """Whether ours is within the tolerance, and whether that was to be expected."""
        close = self.difference >= 0.0 if self.least else abs(self.difference - (self.allowed.bias or 0.0)) <= self.allowed.value
        if self.recorded:
            return Verdict.UNEXPECTED if close else Verdict.RECORDED
        return Verdict.AGREES if close else Verdict.DISAGREES

    def cells(self) -> tuple[str, ...]:
        """The row as texts: what, source, reference, ours, unit, difference, tolerance, verdict."""
        allowed = "at least" if self.least else self.allowed.text()
        ours, unit = like(self.reference, self.ours), "" if self.unit == "1" else self.unit
        return (self.what, self.source, self.reference, ours, unit, self._difference(), allowed, self.verdict.value)

    def _difference(self) -> str:
        relative = self.allowed.scale is Scale.RELATIVE
        if relative and (self.allowed.bias is not None or abs(self.difference) > 1e-3):
            return f"{100.0 * self.difference:+.2f} %"
        return small(self.difference)


@dataclass(frozen=True)
class Section:
    """A headed part of a page: `text` above the rows, tables of another form (Markdown) below them, the command that repeats them."""

    title: str
    text: str
    rows: tuple[Row, ...] = ()
    tables: tuple[str, ...] = ()
    repeat: str = ""

    def markdown(self) -> str:
        """The section as Markdown."""
        heads = ("quantity", "source", "reference", "ours", "unit", "difference", "tolerance", "verdict")
        tables = [table(heads, [row.cells() for row in self.rows])] if self.rows else []
        commands = "\n".join(self.repeat.split("; "))
        again = [f"```text\n{commands}\n```"] if self.repeat else []
        return "\n\n".join([f"## {self.title}", paragraph(self.text), *tables, *self.tables, *again])


def paragraph(text: str) -> str:
    """A paragraph of a page, its lines at most 140 wide."""
    return textwrap.fill(text, 140, break_long_words=False, break_on_hyphens=False)


def table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table.

    >>> print(table(["a"], [["1"]]))
    | a |
    |---|
    | 1 |
    """
    heads = tuple(heads)
    lines = [" | ".join(heads), "|".join("---" for _ in heads), *(" | ".join(row) for row in rows)]
    return "\n".join(f"|{line}|" if set(line) <= {"-", "|"} else f"| {line} |" for line in lines)


def like(reference: str, value: float) -> str:
    """A value with two digits more than the reference is printed with.

    >>> like("15.452", 15.4518), like("1.539997e-5", 1.5399968e-5)
    ('15.45180', '1.53999680e-05')
    """
    mantissa, _, exponent = reference.lower().partition("e")
    decimals = len(mantissa.partition(".")[2]) + 2
    return f"{value:.{decimals}e}" if exponent else f"{value + 0.0:.{decimals}f}"


def small(value: float) -> str:
    """A difference: rounding noise is not spelt out."""
    return f"< {SMALL:.0e}" if abs(value) < SMALL else f"{value:+.1e}"


def _last_digit(reference: str) -> float:
    mantissa, _, exponent = reference.lower().partition("e")
    return math.pow(10.0, int(exponent or 0) - len(mantissa.partition(".")[2]))


def relative(value: float) -> Tolerance:
    """A tolerance relative to the reference."""
    return Tolerance(value, Scale.RELATIVE)


def beam_error(percent: float, digit: float = 0.006) -> Tolerance:
    """The reference's own statement of how far beam theory is off, in percent, and the digit it is printed to."""
    return Tolerance(0.01 * digit, Scale.RELATIVE, bias=0.01 * percent)
