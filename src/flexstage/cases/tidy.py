"""Decimal rounding of a case's numbers, so that its design file shows the digits its author wrote."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar

from flexstage.mechanism.pattern import Polar

_ANGLES = ("first", "turn", "step")
Value = TypeVar("Value")


def tidy(value: Value) -> Value:
    """The same description with every float rounded to 15 significant digits: `1.54 * mm` becomes exactly the number that "1.54 mm" reads as.

    Angles stay as they are: they are round in degrees, not in radians.

    >>> tidy((1.54 * 1e-3,))
    (0.00154,)
    """
    return _tidy(value)


def _tidy(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.15g}")
    if isinstance(value, tuple):
        return tuple(_tidy(item) for item in value)
    if isinstance(value, Mapping):
        return {name: _tidy(item) for name, item in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in fields(value) if not (isinstance(value, Polar) and field.name in _ANGLES)]
        return replace(value, **{name: _tidy(getattr(value, name)) for name in names})
    return value
