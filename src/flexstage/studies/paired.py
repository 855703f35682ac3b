"""Pairing of two readings' platform modes by their shapes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from flexstage.analysis.modes import Modes, clusters
from flexstage.base.number import Array
from flexstage.readings.linear.model import LinearModel

_CLOSE = 0.01


@dataclass(frozen=True)
class Pair:
    """The mode of another reading that a mode is paired with: its index, its frequency [Hz], the share 0 to 1 of the shape they share."""

    index: int
    frequency: float
    assurance: float


def paired(modes: Modes, others: Modes, model: LinearModel) -> dict[int, Pair]:
    """For each platform mode, by index, the platform mode of another reading with the most similar motion of the platform.

    Modal assurance (Allemang and Brown 1982) of the platform's twists, weighted by the platform's inertia in `model`. Modes closer than 1 %
    are compared as a subspace: within it every basis is as good.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.readings.lumped import lumped
    >>> from flexstage.studies.complete import platform_modes
    >>> stage = double_triangle()
    >>> found = platform_modes(stage, lumped(stage))
    >>> pairs = paired(found, found, lumped(stage))
    >>> [pair.index for pair in pairs.values()], round(min(pair.assurance for pair in pairs.values()), 9)
    ([0, 1, 2, 3, 4, 5], 1.0)
    """
    half = np.linalg.cholesky(_inertia(model)).T
    own, other = (_unit(half @ each.platform_shapes[:, list(each.platform)]) for each in (modes, others))
    first, second = linear_sum_assignment(-((own.T @ other) ** 2))
    shared = np.zeros(len(modes.platform))
    for group in clusters(modes.platform_frequencies, _CLOSE):
        members = [int(second[list(first).index(index)]) for index in group if index in first]
        basis = np.linalg.qr(other[:, members])[0]
        shared[group] = np.sum((basis.T @ own[:, group]) ** 2, axis=0)
    return {
        modes.platform[i]: Pair(others.platform[j], float(others.frequencies[others.platform[j]]), float(shared[i]))
        for i, j in zip(first.tolist(), second.tolist(), strict=True)
    }


def _unit(shapes: Array) -> Array:
    return shapes / np.linalg.norm(shapes, axis=0)


def _inertia(model: LinearModel) -> Array:
    """The platform's 6x6; the unit matrix where the model has no rigid platform mass."""
    item = model.inertia.get("platform")
    return np.eye(6) if item is None or item.law.shape != (6, 6) else item.law
