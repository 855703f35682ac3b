"""Waveforms of the wave generator: segments of wave tables, point by point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.base.number import Array
from flexstage.control.serve.errors import Code, CommandError

LARGEST = 262_144
"""Maximum total number of points in all wave tables."""


def segment(kind: str, values: Sequence[float]) -> Array:
    """Compute a segment of a wave table, in the unit of the axis, from its kind (PNT, SIN_P, RAMP, LIN) and the arguments of `WAV`.

    Raises `CommandError` for an unknown kind, a wrong number of values, and invalid values.

    >>> segment("LIN", [5, 4, 1, 5, 0, 0]).tolist()
    [1.0, 2.0, 3.0, 4.0, 5.0]
    """
    if kind == "PNT":
        return _points(values)
    if kind not in _CURVES:
        raise CommandError(Code.WAVE_TYPE)
    count, form = _CURVES[kind]
    if len(values) != count:
        raise CommandError(Code.NUMBER_OF_PARAMETERS)
    length, amplitude, offset, wave, start, *rest = values
    lengths = [_whole(each) for each in (length, wave, start, *rest)]
    if not 1 <= lengths[0] <= LARGEST:
        raise CommandError(Code.WAVE_TOO_LARGE)
    if lengths[1] < 1 or lengths[2] + lengths[1] > lengths[0] or any(each >= lengths[1] for each in lengths[3:]):
        raise CommandError(Code.PARAMETER_OUT_OF_RANGE)
    share = (np.arange(lengths[0]) - lengths[2]).clip(0, lengths[1] - (kind == "LIN"))
    return offset + amplitude * form(share, lengths[1], *lengths[3:])


def _whole(value: float) -> int:
    if not 0 <= value <= LARGEST or value != int(value):
        raise CommandError(Code.PARAMETER_OUT_OF_RANGE)
    return int(value)


def _points(values: Sequence[float]) -> Array:
    """Individual points: position of the first (1), number, and values."""
    if len(values) < 3:
        raise CommandError(Code.NUMBER_OF_PARAMETERS)
    first, count = _whole(values[0]), _whole(values[1])
    if first != 1:
        raise CommandError(Code.PARAMETER_OUT_OF_RANGE)
    if count != len(values) - 2:
        raise CommandError(Code.NUMBER_OF_PARAMETERS)
    return np.array(values[2:])


def _sine(at: Array, wave: int, centre: int) -> Array:
    """Inverted cosine: from 0 to 1 at the centre, and back to 0 at the end."""
    rise = 0.5 - 0.5 * np.cos(np.pi * at / max(centre, 1))
    fall = 0.5 + 0.5 * np.cos(np.pi * (at - centre) / (wave - centre))
    return np.where(at < centre, rise, fall)


def _ramp(at: Array, wave: int, rounded: int, centre: int) -> Array:
    """Ramp to 1 at the centre and back, rounded at the foot, the top and the end."""
    return np.where(at < centre, _rounded(at, centre, rounded), _rounded(wave - at, wave - centre, rounded))


def _rounded(at: Array, length: float, rounded: int) -> Array:
    """Transition from 0 to 1 over a length, with constant acceleration over `rounded` at both ends; middle slope 1/(length - rounded)."""
    if length <= 0.0:
        return np.ones_like(at, dtype=float)
    edge = min(rounded, 0.5 * length)
    if edge == 0.0:
        return np.clip(at / length, 0.0, 1.0)
    slope = 1.0 / (length - edge)
    foot, top = 0.5 * slope * at**2 / edge, 1.0 - 0.5 * slope * (length - at) ** 2 / edge
    return np.where(at < edge, foot, np.where(at > length - edge, top, slope * (at - 0.5 * edge)))


_CURVES = {"SIN_P": (6, _sine), "LIN": (6, lambda at, wave, rounded: _rounded(at, wave - 1, rounded)), "RAMP": (7, _ramp)}
