"""Pairing of the modes of two models by the modal assurance criterion (MAC) of all common motions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.analysis.dynamics.modes import Modes, clusters
from flexstage.base.number import Array, first_design
from flexstage.models.linear.model import LinearModel

RELIABLE = 0.8
"""Modal assurance below which two modes do not match."""

_CLOSE = 0.01
_LENGTH = 0.1
_MOTIONS = ("m", "rad")
_UNSEEN = 1e-9


@dataclass(frozen=True)
class Pair:
    """Partner of a mode in another model: index and frequency [Hz] of the partner, and modal assurance of the pair (0 to 1)."""

    index: int
    frequency: float
    assurance: float

    @property
    def reliable(self) -> bool:
        """Whether the modal assurance is sufficient for a comparison."""
        return self.assurance >= RELIABLE


@dataclass(frozen=True, eq=False)
class Moving:
    """Modes together with their linear model."""

    modes: Modes
    model: LinearModel


def pair_modes(own: Moving, other: Moving) -> dict[int, Pair]:
    """Pair each platform mode, by index, with the most similar mode of another model.

    The modal assurance (Allemang and Brown 1982) is weighted by kinetic energy. A least-squares fit of the common motion outputs converts
    the modes of both models to the coordinates of the smaller model. The inertia of the smaller model gives the kinetic energy. In the fit,
    rotations are multiplied by the platform's radius of gyration. The modal assurance is normalised by the total kinetic energy of each
    mode, including motion without an output.

    Any mode of the other model can be paired, also a local mode. Modes with frequencies that differ by less than 1 % are compared as a
    subspace and paired in ascending order. Below a modal assurance of `RELIABLE`, the paired mode is only the most similar mode, not a
    match.

    >>> from flexstage.analysis.dynamics.modes import modes
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(double_triangle())
    >>> result = Moving(modes(model), model)
    >>> pairs = pair_modes(result, result)
    >>> all(index == pair.index for index, pair in pairs.items()), round(min(pair.assurance for pair in pairs.values()), 9)
    (True, 1.0)
    """
    first, second = _alike(own, other)
    frequencies, others = (first_design(each.modes.frequencies, 1) for each in (own, other))
    highest = max((frequencies[index] for index in own.modes.platform), default=0.0) * (1.0 + _CLOSE)
    near = np.flatnonzero(frequencies <= highest)
    rows, columns = scipy.optimize.linear_sum_assignment(-((first[:, near].T @ second) ** 2))
    partner = dict(zip(near[rows].tolist(), columns.tolist(), strict=True))
    result: dict[int, Pair] = {}
    for group in clusters(frequencies[near], _CLOSE):
        members = sorted(partner[index] for index in group if index in partner)
        shared = _shared_energy(first[:, group], second[:, sorted(_with_close(members, others))])
        result |= {
            index: Pair(member, float(others[member]), float(share)) for index, member, share in zip(group, members, shared, strict=False)
        }
    return {index: result[index] for index in own.modes.platform if index in result}


def _with_close(members: Iterable[int], frequencies: Array) -> set[int]:
    """Modes with those closer than 1 %."""
    return {int(index) for member in members for index in np.flatnonzero(np.abs(frequencies / frequencies[member] - 1.0) <= _CLOSE)}


def _shared_energy(own: Array, other: Array) -> Array:
    """Shared kinetic energy of modes (r, n) with the subspace of modes (r, k) of another model.

    The energy of each mode is 1, including motion without an output; the share is at most 1 if the models' masses differ.
    """
    most = max(1.0, float(np.linalg.norm(other, 2))) if other.size else 1.0
    return np.sum((other.T @ own) ** 2, axis=0) / (most**2 * np.maximum(np.sum(own**2, axis=0), 1.0))


def _alike(own: Moving, other: Moving) -> tuple[Array, Array]:
    """Both models' modes (r, n) in coordinates of the smaller model; the sum of squares is twice the observed kinetic energy."""
    names = {channel.name for channel in other.model.outputs}
    common = tuple(channel.name for channel in own.model.outputs if channel.name in names and channel.unit in _MOTIONS)
    small = min(own, other, key=lambda each: len(each.model.coordinates)).model
    units = {channel.name: channel.unit for channel in small.outputs}
    weight = np.array([[gyration(small) if units[name] == "rad" else 1.0] for name in common])
    back = np.linalg.pinv(weight * _rows(small, common), rcond=_UNSEEN)
    half = _root(first_design(small.inertia_matrix, 2)) @ back
    first, second = (half @ (weight * (_rows(each.model, common) @ first_design(each.modes.shapes, 2))) for each in (own, other))
    return first, second


def _rows(model: LinearModel, names: tuple[str, ...]) -> Array:
    return first_design(model.output, 2)[model.output_index(names)]


def _root(inertia: Array) -> Array:
    """Square root of the inertia, including massless coordinates."""
    values, vectors = np.linalg.eigh(inertia)
    return np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T


def gyration(model: LinearModel) -> float:
    """Return the platform's radius of gyration [m], which scales angles to lengths; 0.1 m if the platform is not rigid."""
    item = model.inertia.get("platform")
    if item is None or item.law.shape[-2:] != (6, 6):
        return _LENGTH
    law = np.diag(first_design(item.law, 2))
    return float(np.sqrt(np.mean(law[3:]) / np.mean(law[:3]))) or _LENGTH
