"""Numbers of a description: a float, or a read-only array with batch axes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Number: TypeAlias = float | NDArray[np.float64]
"""Physical value: a float for one design, an array for a batch. Complex values are for complex-step differentiation."""

Array: TypeAlias = NDArray[Any]
"""Real or complex array with leading batch axes."""

Vector: TypeAlias = tuple[Number, Number, Number]
"""Vector of components x, y, z."""


class Table(Mapping[str, Any]):
    """Immutable, ordered, picklable mapping from names to values.

    >>> Table({"a": 1})["a"]
    1
    """

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, Any]) -> None:
        self._items = {name: freeze(value) for name, value in items.items()}

    def __reduce__(self) -> tuple[type[Table], tuple[dict[str, Any]]]:
        return Table, (self._items,)

    def __getitem__(self, name: str) -> Any:
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __repr__(self) -> str:
        return f"Table({self._items!r})"


def freeze(value: Any) -> Any:
    """Return an immutable form of a value: arrays read-only, lists as tuples, mappings as `Table`.

    >>> freeze([1.0, [2.0]])
    (1.0, (2.0,))
    """
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return _frozen_array(value)
    if isinstance(value, Table):
        return value
    if isinstance(value, Mapping):
        return Table(value)
    if isinstance(value, (list, tuple)):
        return tuple(freeze(item) for item in value)
    return value


def _frozen_array(value: Array) -> Any:
    if value.ndim == 0:
        return value.item()
    kind = np.complex128 if np.iscomplexobj(value) else np.float64
    if value.base is None and not value.flags.writeable and value.dtype == kind:
        return value
    copy = np.array(value, dtype=kind)
    copy.flags.writeable = False
    return copy


def stack(values: Any) -> Array:
    """Stack the numbers of a (nested) sequence along new last axes; the batch axes of the numbers are broadcast.

    >>> stack([1.0, np.array([2.0, 3.0])]).tolist()
    [[1.0, 2.0], [1.0, 3.0]]
    """
    if not isinstance(values, (list, tuple)):
        return np.asarray(values)
    if all(isinstance(value, (float, int, complex)) for value in values):
        return np.array(values)
    inner = [stack(value) for value in values]
    depth = _depth(values)
    tails = [item.shape[item.ndim - depth + 1 :] for item in inner]
    batch = np.broadcast_shapes(*(item.shape[: item.ndim - depth + 1] for item in inner))
    return np.stack([np.broadcast_to(item, batch + tail) for item, tail in zip(inner, tails, strict=True)], axis=-depth)


def _depth(values: Any) -> int:
    return 1 + _depth(values[0]) if isinstance(values, (list, tuple)) else 0


def same_batch(*matrices: Array) -> list[Array]:
    """Broadcast the batch axes of matrices (..., r, c) of any size.

    >>> [each.shape for each in same_batch(np.eye(2), np.zeros((4, 1, 3)))]
    [(4, 2, 2), (4, 1, 3)]
    """
    batch = np.broadcast_shapes(*(each.shape[:-2] for each in matrices))
    return [np.broadcast_to(each, (*batch, *each.shape[-2:])) for each in matrices] if batch else list(matrices)


def join(matrices: Iterable[Array], axis: int = -2) -> Array:
    """Join matrices (..., r, c) below each other, or side by side with `axis` -1; the batch axes are broadcast.

    >>> join([np.eye(2), np.zeros((4, 1, 2))]).shape
    (4, 3, 2)
    """
    return np.concatenate(same_batch(*matrices), axis=axis)


def matvec(matrix: Array, vector: Array) -> Array:
    """Multiply matrices (..., r, c) by vectors (..., c).

    >>> matvec(np.ones((3, 1, 2)), np.array([1.0, 2.0])).tolist()
    [[3.0], [3.0], [3.0]]
    """
    return (matrix @ vector[..., None])[..., 0]


def magnitude(value: Any) -> Any:
    """Return |x|, valid for complex-step derivatives: x or -x, depending on the sign of the real part.

    >>> magnitude(np.array([-2.0 + 1e-20j])).tolist()
    [(2-1e-20j)]
    """
    return np.where(np.real(value) < 0.0, -np.asarray(value), value)


def with_step(value: Array, slope: Array, number: Array) -> Array:
    """Return f(x + ih) = f(x) + ih f'(x) of a complex `number` x + ih, from `value` f and `slope` f' at the real part.

    This is faster than evaluating f with complex numbers. For a real `number`, the result is `value`.

    >>> number = np.array([0.5 + 1e-20j])
    >>> bool(with_step(np.sin(number.real), np.cos(number.real), number) == np.sin(number))
    True
    """
    return value + 1j * (slope * np.imag(number)) if np.iscomplexobj(number) else value


def first_design(values: Array, axes: int) -> Array:
    """Return the first design of a batch: index 0 of all axes except the last `axes` axes.

    >>> first_design(np.array([[1.0, 2.0], [3.0, 4.0]]), 1).tolist()
    [1.0, 2.0]
    """
    return values[(0,) * (values.ndim - axes)]


_ALIKE = 1e-9


def index_of_largest(values: Array, slack: Array | float = 0.0) -> Array:
    """Return the index of the largest real value along the last axis; among equal values, the first index.

    Values within 1e-9 (relative) or `slack` (absolute) of the largest count as equal, so that rounding errors do not decide a tie.

    >>> int(index_of_largest(np.array([1.0, 3.0 - 1e-15, 3.0])))
    1
    """
    top = np.max(values, axis=-1, keepdims=True)
    alike = values >= top - np.maximum(_ALIKE * np.abs(top), slack)
    return np.where(np.any(alike, axis=-1), np.argmax(alike, axis=-1), np.argmax(values, axis=-1))


def argsort_descending(values: Array, alike: float = _ALIKE) -> list[int]:
    """Return indices in descending order; values equal within `alike` (relative to the largest) keep their order.

    >>> argsort_descending(np.array([1.0, 3.0 - 1e-15, 3.0]))
    [1, 2, 0]
    """
    order = np.argsort(-values, kind="stable")
    if not order.size:
        return []
    apart = -np.diff(values[order]) > alike * np.max(np.abs(values))
    groups = np.split(order, 1 + np.flatnonzero(apart))
    return [int(index) for group in groups for index in np.sort(group)]


def distinct_values(values: Array) -> Array:
    """Return the distinct values above 0, ascending. Of values that differ by less than 1e-9 (relative), only the smallest is kept.

    >>> distinct_values(np.array([2.0, 1.0, 2.0 + 1e-12])).tolist()
    [1.0, 2.0]
    """
    ascending = np.sort(values)
    return ascending[np.diff(ascending, prepend=-np.inf) > _ALIKE * np.abs(ascending)]
