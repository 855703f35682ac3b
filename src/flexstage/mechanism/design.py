"""Single designs of a batch of descriptions, for models without batch axes."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.references import transformed

_NEAR, _SMALL = 1e-4, 1e-6
"""Step to a neighbouring design: relative, and absolute for zero numbers [SI]."""


def designs(mechanism: Mechanism) -> int | None:
    """Return the number of designs along the batch axis of a description; `None` for a single design.

    >>> designs(Mechanism("stage")) is None
    True
    """
    sizes = [len(each) for each in _numbers(mechanism) if isinstance(each, np.ndarray) and _is_batch(each)]
    return max(sizes) if sizes else None


def design(mechanism: Mechanism, place: int, share: float = 0.0) -> Mechanism:
    """Return the design at an index of a batch; a complex number becomes its real part plus `share` times its imaginary part.

    >>> import flexstage as fs
    >>> design(fs.Mechanism("stage", gravity=(0.0, 0.0, np.array([-9.8, -1.6]))), 1).gravity[2]
    -1.6
    """

    def single(_: str, value: Any) -> Any:
        if not isinstance(value, (complex, np.ndarray)):
            return value
        own = value[min(place, len(value) - 1)] if isinstance(value, np.ndarray) and _is_batch(value) else value
        near = np.asarray(np.real(own) + share * np.imag(own) if np.iscomplexobj(own) else own)
        return float(near) if near.ndim == 0 else near

    return transformed(mechanism, single)  # type: ignore[no-any-return]


def step_size(mechanism: Mechanism) -> float:
    """Return the `share` for `design` that changes each number by at most 1e-4 of its value; zero if all numbers are real.

    >>> step_size(Mechanism("stage"))
    0.0
    """
    numbers = [np.ravel(each) for each in _numbers(mechanism) if np.any(np.imag(each))]
    if not numbers:
        return 0.0
    whole = np.concatenate([each.astype(complex) for each in numbers])
    whole = whole[np.imag(whole) != 0.0]
    allowed = np.where(np.real(whole) == 0.0, _SMALL, _NEAR * np.abs(np.real(whole)))
    return float(np.min(allowed / np.abs(np.imag(whole))))


def _is_batch(value: Array) -> bool:
    """Whether the first axis of an array is the batch axis: numbers have no other axis, matrices two."""
    return value.ndim in (1, 3)


def _numbers(mechanism: Mechanism) -> list[Any]:
    """Arrays and complex numbers of a description."""
    results: list[Any] = []

    def note(_: str, value: Any) -> Any:
        results.extend([value] if isinstance(value, (complex, np.ndarray)) else ())
        return value

    transformed(mechanism, note)
    return results
