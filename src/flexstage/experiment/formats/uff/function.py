"""Header of a function at nodal degrees of freedom: data set 58 of universal files, records 1 to 11.

Reference: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File Formats", data set number 58. Fields have
fixed columns, except that the first abscissa and the step may be padded differently.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from flexstage.base.text import printable
from flexstage.experiment.records.clock import printed_uncertainty, round_nominal
from flexstage.experiment.records.record import RATES, Role
from flexstage.experiment.records.unit import plain_unit

TIME, RESPONSE, TRANSMISSIBILITY, COHERENCE = 1, 4, 5, 6
KINDS = {
    0: "general function",
    1: "time response",
    2: "auto spectrum",
    3: "cross spectrum",
    4: "frequency response function",
    5: "transmissibility",
    6: "coherence",
    7: "auto correlation",
    8: "cross correlation",
    9: "power spectral density",
    10: "energy spectral density",
    12: "spectrum",
    26: "multiple coherence",
}
"""Function types by number."""
REAL_SINGLE, REAL_DOUBLE, COMPLEX_SINGLE, COMPLEX_DOUBLE = 2, 4, 5, 6
_DIRECTIONS = ("", "+X", "+Y", "+Z", "+RX", "+RY", "+RZ", "-RZ", "-RY", "-RX", "-Z", "-Y", "-X")
_ROLES = {13: Role.INPUT, 8: Role.OUTPUT, 11: Role.OUTPUT, 12: Role.OUTPUT}
_TIME_AXIS, _FREQUENCY_AXIS = 17, 18
HEAD_LINES = 11


@dataclass(frozen=True)
class Axis:
    """Quantity of an axis: its code (the "specific data type" of UFF), its label and its unit."""

    kind: int
    label: str
    unit: str


@dataclass(frozen=True)
class Function:
    """Header of one function: five lines of text, function type, response and reference points, data form, and axes."""

    texts: tuple[str, ...]
    kind: int
    response: tuple[str, int, int]
    reference: tuple[str, int, int]
    precision: int
    count: int
    is_even: bool
    first: float
    step: float
    step_uncertainty: float
    abscissa: Axis
    ordinate: Axis
    denominator: Axis

    @property
    def is_complex(self) -> bool:
        """Whether the values are complex."""
        return self.precision in (COMPLEX_SINGLE, COMPLEX_DOUBLE)

    @property
    def is_double(self) -> bool:
        """Whether the values are of double precision."""
        return self.precision in (REAL_DOUBLE, COMPLEX_DOUBLE)

    @property
    def is_time(self) -> bool:
        """Whether the function is a time history: of function type 1, or of type 0 (general) as a function of time."""
        return not self.is_complex and (self.kind == TIME or (self.kind == 0 and self.abscissa.kind == _TIME_AXIS))

    @property
    def is_response(self) -> bool:
        """Whether the function is a frequency response: type 4, 5 (transmissibility), or 0 (complex, as a function of frequency)."""
        return self.kind in (RESPONSE, TRANSMISSIBILITY) or (self.kind == 0 and self.is_complex and self.abscissa.kind == _FREQUENCY_AXIS)

    @property
    def rate(self) -> float:
        """Sampling rate in Hz of an evenly spaced time history, from its printed time step."""
        return round_nominal(1.0 / self.step, 1.01 * self.step_uncertainty + 1e-15)

    @property
    def role(self) -> Role:
        """Role of the channel in a test, from the quantity of the ordinate: forces are inputs, motions outputs."""
        return _ROLES.get(self.ordinate.kind, Role.UNKNOWN)

    @property
    def output_name(self) -> str:
        """Name of the response: entity, node and direction, else the label of the ordinate, else the first line of text."""
        name = place_name(self.response)
        label = re.sub(r"\s*[\[(][^\])]*[\])]\s*$", "", self.ordinate.label)
        return name or label or self.texts[0].split(" : ")[0].strip() or "output"

    @property
    def input_name(self) -> str:
        """Name of the excitation: entity, node and direction."""
        return place_name(self.reference) or "input"


def parse_head(lines: list[str]) -> Function:
    """Parse the header of a function from its eleven lines; raises `ValueError` with the number of an unreadable record.

    >>> lines = ["NONE"] * 5 + ["    1         0    0         0       NONE         3   1       NONE         0   0"]
    >>> lines += ["         4       100         1  0.00000e+00  4.88281e-04  0.00000e+00"]
    >>> lines += ["        17    0    0    0 time                 s", "         8    0    0    0 NONE                 um", "", ""]
    >>> found = parse_head(lines)
    >>> found.output_name, found.rate, found.ordinate.unit, found.role.value
    ('3+X', 2048.0, 'um', 'output')
    """
    if len(lines) < HEAD_LINES:
        raise ValueError(f"its header has {len(lines)} of {HEAD_LINES} lines")
    number, response, reference = _parse_places(lines[5])
    precision, count, is_even, first, step = _parse_form(lines[6])
    axes = [_axis(line) for line in lines[7:11]]
    uncertainty = printed_uncertainty(lines[6][30:].split()[1]) if step else 0.0
    return Function(
        tuple(map(_text, lines[:5])), number, response, reference, precision, count, is_even, first, step, uncertainty, *axes[:3]
    )


def _parse_places(line: str) -> tuple[int, tuple[str, int, int], tuple[str, int, int]]:
    try:
        kind = int(line[0:5])
        places = [
            (_text(line[start + 1 : start + 11]), _whole(line[start + 11 : start + 21]), _whole(line[start + 21 : start + 25]))
            for start in (30, 55)
        ]
    except ValueError:
        raise ValueError(f'record 6, the function type and its nodes, cannot be read: "{line.strip()}"') from None
    return kind, places[0], places[1]


def _parse_form(line: str) -> tuple[int, int, bool, float, float]:
    try:
        precision, count, spacing = (int(line[start : start + 10]) for start in (0, 10, 20))
        first, step = (float(word.lower().replace("d", "e")) for word in line[30:].split()[:2])
    except ValueError:
        raise ValueError(f'record 7, the form of the data, cannot be read: "{line.strip()}"') from None
    if precision not in (REAL_SINGLE, REAL_DOUBLE, COMPLEX_SINGLE, COMPLEX_DOUBLE):
        raise ValueError(f"unknown data type (got {precision}, expected 2, 4, 5 or 6)")
    if spacing and not (1.0 / RATES[1] <= step <= 1.0 / RATES[0] and math.isfinite(first)):
        raise ValueError(f"invalid even spacing (got a step of {step:g}, beginning at {first:g})")
    if count < 0:
        raise ValueError(f"invalid number of values (got {count})")
    return precision, count, bool(spacing), first, step


def _axis(line: str) -> Axis:
    return Axis(_whole(line[0:10]), _text(line[25:46]), plain_unit(_text(line[46:67])))


def _whole(text: str) -> int:
    return int(text) if text.strip() else 0


def _text(text: str) -> str:
    return "" if text.strip() == "NONE" else text.strip()


def place_name(place: tuple[str, int, int]) -> str:
    """Format the name of a measurement point: its entity, node and direction, as available.

    >>> place_name(("S1", 0, 0)), place_name(("", 4, -3)), place_name(("plate", 2, 1)), place_name(("", 0, 0))
    ('S1', '4-Z', 'plate 2+X', '')
    """
    name, node, direction = place
    where = _DIRECTIONS[direction] if -6 <= direction <= 6 else ""
    return f"{name} {node}{where}".strip() if node else name


def head(function: Function, size: int) -> bytes:
    """Format the header bytes of a binary data set whose values have `size` bytes in total.

    >>> axes = Axis(17, "time", "s"), Axis(8, "", "um"), Axis(0, "", "")
    >>> plain = Function(("S1", "", "", "", ""), 1, ("S1", 1, 0), ("", 0, 0), 4, 2, True, 0.0, 0.5, 0.0, *axes)
    >>> head(plain, 16).decode().splitlines()[7]
    '    1         0    0         0         S1         1   0       NONE         0   0'
    >>> parse_head(head(plain, 16).decode().splitlines()[2:]).step
    0.5
    """
    start = f"{58:6d}b{1:6d}{2:6d}{HEAD_LINES:12d}{size:12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    lines = [f"{-1:6d}", start, *(f"{printable(text) or 'NONE':80}" for text in function.texts)]
    places = "".join(
        f" {(name or 'NONE')[:10]:>10}{node:10d}{direction:4d}" for name, node, direction in (function.response, function.reference)
    )
    lines.append(f"{function.kind:5d}{0:10d}{0:5d}{0:10d}{places}")
    lines.append(
        f"{function.precision:10d}{function.count:10d}{int(function.is_even):10d}{function.first:13.5e}{function.step:13.5e}{0.0:13.5e}"
    )
    axes = (function.abscissa, function.ordinate, function.denominator, Axis(0, "", ""))
    lines += [f"{axis.kind:10d}{0:5d}{0:5d}{0:5d} {(axis.label or 'NONE')[:20]:20} {(axis.unit or 'NONE')[:20]:20}" for axis in axes]
    return ("\n".join(lines) + "\n").encode()


def count_function(text: str, number: int, count: int) -> str:
    """Append "function NUMBER of COUNT" to a line of text, because the format has no field for it.

    >>> count_function("hann", 3, 12)
    'hann; function 3 of 12'
    """
    return f"{text}; function {number} of {count}" if text else f"function {number} of {count}"
