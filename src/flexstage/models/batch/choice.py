"""Which modes are the platform's, design by design: those of the largest platform share below a limit, clusters whole."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array

NEGLIGIBLE = 1e-3
"""A platform share below which a mode is not the platform's: rounding, or links that swing beside a platform at rest."""


@dataclass(frozen=True)
class Choice:
    """How many platform modes are wanted, below which frequency [Hz], and which relative gap of frequencies joins modes to a cluster."""

    count: int = 6
    limit: float = np.inf
    cluster: float = 1e-6


@dataclass(frozen=True, eq=False)
class Chosen:
    """`mask` (b, k) of the platform's modes; `least` (b,) smallest mean share of a cluster among them; `exact` (b,): as many as asked."""

    mask: Array
    least: Array
    exact: Array


def choose(values: Array, share: Array, choice: Choice) -> Chosen:
    """Choose from ascending eigenvalues (b, k) and platform shares (b, k), as `analysis.modes` does for one design.

    >>> found = choose(np.array([[1.0, 2.0, 3.0]]), np.array([[0.2, 0.1, 0.9]]), Choice(count=2))
    >>> found.mask.tolist(), found.least.tolist()
    ([[True, False, True]], [0.2])
    """
    frequencies = np.sqrt(values) / (2.0 * np.pi)
    group = groups(frequencies, choice.cluster)
    first = np.take_along_axis(frequencies, _first_members(group), axis=1)
    mean = means(share, group)
    key = np.where((first < choice.limit) & (mean >= NEGLIGIBLE), mean, -np.inf)
    order = np.argsort(-key, axis=1, kind="stable")
    rank = np.empty_like(order)
    np.put_along_axis(rank, order, np.arange(order.shape[1])[None], axis=1)
    last = order[:, min(choice.count, order.shape[1]) - 1 :][:, :1]
    allowed = np.isfinite(key)
    mask = ((rank < choice.count) | (group == np.take_along_axis(group, last, axis=1))) & allowed
    least = np.min(np.where(mask, mean, np.inf), axis=1)
    return Chosen(mask, least, mask.sum(axis=1) == choice.count)


def groups(values: Array, gap: float) -> Array:
    """Numbers (b, k) of the clusters of ascending values: a relative gap above `gap` begins a new one.

    >>> groups(np.array([[1.0, 1.0 + 1e-9, 2.0]]), 1e-6).tolist()
    [[0, 0, 1]]
    """
    with np.errstate(invalid="ignore"):
        new = ~(values[:, 1:] - values[:, :-1] <= gap * values[:, 1:])
    return np.concatenate([np.zeros((len(values), min(1, values.shape[1])), dtype=int), np.cumsum(new, axis=1)], axis=1)


def means(values: Array, group: Array) -> Array:
    """Mean (b, k, ...) over each value's group; groups are runs along axis 1.

    >>> means(np.array([[1.0, 3.0, 5.0]]), np.array([[0, 0, 1]])).tolist()
    [[2.0, 2.0, 5.0]]
    """
    count = group.shape[1]
    if not values.size:
        return values
    place = (np.arange(len(group))[:, None] * count + group).ravel()
    flat = values.reshape(len(place), math.prod(values.shape[2:]))
    total = np.zeros_like(flat)
    np.add.at(total, place, flat)
    size = np.bincount(place, minlength=len(place))
    return (total[place] / size[place, None]).reshape(values.shape)


def _first_members(group: Array) -> Array:
    position = np.broadcast_to(np.arange(group.shape[1]), group.shape)
    new = np.concatenate([np.ones((len(group), 1), dtype=bool), group[:, 1:] != group[:, :-1]], axis=1)
    return np.maximum.accumulate(np.where(new, position, 0), axis=1)
