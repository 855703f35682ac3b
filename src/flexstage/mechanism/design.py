"""One design of a batch of descriptions: for models that read one at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import Mechanism

_NEAR, _SMALL = 1e-4, 1e-6
"""How far a design beside one is: of each number, and of numbers that are zero [SI]."""


def designs(mechanism: Mechanism) -> int | None:
    """How many designs a description holds along its one batch axis; `None` of a single one.

    >>> designs(Mechanism("stage")) is None
    True
    """
    sizes = [len(each) for each in _numbers(mechanism) if isinstance(each, np.ndarray) and _is_batch(each)]
    return max(sizes) if sizes else None


def design(mechanism: Mechanism, place: int, share: float = 0.0) -> Mechanism:
    """The design at a place of a batch, and of complex numbers the real one with a `share` of its imaginary parts added.

    >>> import flexstage as fs
    >>> design(fs.Mechanism("stage", gravity=(0.0, 0.0, np.array([-9.8, -1.6]))), 1).gravity[2]
    -1.6
    """
    return _map(mechanism, place, share)


def step_size(mechanism: Mechanism) -> float:
    """The share of imaginary parts that changes no number by more than a ten-thousandth; zero where all are real.

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
    """Whether the first axis of an array in a description is one of designs: numbers have no axis of their own, matrices two."""
    return value.ndim in (1, 3)


def _numbers(value: Any) -> Iterator[Any]:
    if isinstance(value, (complex, np.ndarray)):
        yield value
    elif is_dataclass(value):
        yield from (each for one in fields(value) for each in _numbers(getattr(value, one.name)))
    elif isinstance(value, Mapping):
        yield from (each for one in value.values() for each in _numbers(one))
    elif isinstance(value, (tuple, list)):
        yield from (each for one in value for each in _numbers(one))


def _map(value: Any, place: int, share: float) -> Any:
    if isinstance(value, (complex, np.ndarray)):
        own = value[min(place, len(value) - 1)] if isinstance(value, np.ndarray) and _is_batch(value) else value
        near = np.asarray(np.real(own) + share * np.imag(own) if np.iscomplexobj(own) else own)
        return float(near) if near.ndim == 0 else near
    if is_dataclass(value) and not isinstance(value, type):
        found = {one.name: (getattr(value, one.name), _map(getattr(value, one.name), place, share)) for one in fields(value) if one.init}
        changed = {name: after for name, (before, after) in found.items() if after is not before}
        return replace(value, **changed) if changed else value
    if isinstance(value, Mapping):
        mapped = {key: _map(each, place, share) for key, each in value.items()}
        return mapped if any(mapped[key] is not each for key, each in value.items()) else value
    if isinstance(value, tuple):
        several = tuple(_map(each, place, share) for each in value)
        return several if any(new is not old for new, old in zip(several, value, strict=True)) else value
    return value
