"""Frequencies of neighbouring modes with their derivatives as matrices, valid for repeated and crossing modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.models.batch.choice import Choice, choose, participation, platform_rows
from flexstage.models.linear.eigen import cholesky, solve
from flexstage.models.linear.model import Contribution, LinearModel, assemble

_STEP = 1e-20
_ROOM = 6
"""Number of modes computed in addition to the requested ones, because their frequencies may decrease."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """k modes of one design: ascending `frequencies` (k,) [Hz] and their `slopes` (n, k, k) [Hz per unit of each variable].

    To first order, a small change d of the n variables changes the frequencies to the eigenvalues of diag(f) plus the sum of d_p slopes_p
    over the variables p. This also applies to repeated and crossing modes. The entries are slopes_ij = phi_i^T (dK - (lambda_i +
    lambda_j)/2 dM) phi_j / (2 pi (omega_i + omega_j)). Here f are the `frequencies`, phi the mode shapes, lambda = omega^2 the eigenvalues,
    and dK and dM the changes of the stiffness and mass matrices per unit of the variable p. `shapes` (N, k) and `weighted`, the mass matrix
    times `shapes`, are used to pair the modes of two designs.
    """

    frequencies: Array
    slopes: Array
    shapes: Array
    weighted: Array


@dataclass(frozen=True)
class Modes:
    """Requested modes: the `count` lowest modes of the platform, or of any body."""

    count: int
    platform: bool


def spectra(model: LinearModel, asked: tuple[Modes, ...], shape: tuple[int, int]) -> list[tuple[Spectrum, ...]]:
    """Compute the spectra of s designs with n variables; the batch (s n,) of the model contains each design n times.

    Each copy has a tiny imaginary step in a different variable. `shape` contains the numbers s and n. With n = 0, the batch (s,) is real,
    and there are no slopes. Raises `DesignError` if the stage has too few modes.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> spectra(lumped(double_triangle()), (Modes(1, platform=True),), (1, 0))[0][0].frequencies.round(1).tolist()
    [106.0, 106.0, 126.2, 144.2, 173.1, 173.1]
    """
    designs, variables = shape
    each = max(variables, 1)
    first = slice(None, None, each)
    size = len(model.coordinates)
    stiffness, inertia = (
        np.broadcast_to(assemble({name: _real(_rows_of(item, first)) for name, item in matrix.items()}, size), (designs, size, size))
        for matrix in (model.stiffness, model.inertia)
    )
    solved = solve(stiffness, inertia, np.ones(stiffness.shape[-1]))
    rows = np.real(platform_rows(model))
    rows = rows[first] if rows.ndim > 2 and len(rows) > 1 else rows
    root = np.linalg.solve(cholesky(stiffness), rows.mT)
    parts = participation(root, rows @ solved.shapes, solved.values)
    picked = [[_select_modes(wanted, solved.values[design], parts[design]) for wanted in asked] for design in range(designs)]
    result = []
    for design in range(designs):
        own = picked[design]
        union = np.unique(np.concatenate(own)) if own else np.zeros(0, dtype=int)
        values, shapes = solved.values[design, union], solved.shapes[design][:, union]
        slopes = _slopes(model, values, shapes, slice(design * each, (design + 1) * each), variables)
        places = [np.searchsorted(union, each_) for each_ in own]
        frequencies = np.sqrt(values) / (2.0 * np.pi)
        weighted = inertia[design] @ shapes
        result.append(tuple(Spectrum(frequencies[at], slopes[:, at[:, None], at[None]], shapes[:, at], weighted[:, at]) for at in places))
    return result


def _real(item: Contribution) -> Contribution:
    return Contribution(np.real(item.operator), np.real(item.law))


def _select_modes(requested: Modes, values: Array, parts: Array) -> Array:
    """Indices of the requested modes and of some above them, from their `participation` (6, k)."""
    if not np.all(np.isfinite(values)):
        raise refuse("frequency", "a motion has no stiffness", "Narrow the ranges")
    if requested.platform:
        found = np.flatnonzero(choose(values[None], parts[None], Choice()).mask[0])
    else:
        found = np.arange(min(requested.count + _ROOM, len(values)))
    if len(found) < requested.count:
        raise refuse("frequency", f"the stage has fewer modes than requested (got {len(found)})", "Use a lower number")
    return found


def _slopes(model: LinearModel, values: Array, shapes: Array, rows: slice, variables: int) -> Array:
    count = len(values)
    if not variables:
        return np.zeros((0, count, count))
    own = [{name: _rows_of(item, rows) for name, item in matrix.items()} for matrix in (model.stiffness, model.inertia)]
    stiffness, inertia = (_project(contributions, shapes) for contributions in own)
    change = stiffness - 0.5 * (values[:, None] + values[None]) * inertia
    omega = np.sqrt(values)
    return np.broadcast_to(change / (2.0 * np.pi * (omega[:, None] + omega[None])), (variables, count, count))


def _rows_of(item: Contribution, rows: slice) -> Contribution:
    operator, law = (part if part.ndim == 2 or len(part) == 1 else part[rows] for part in (item.operator, item.law))
    return Contribution(operator, law)


def _project(contributions: dict[str, Contribution], shapes: Array) -> Array:
    """Phi^T dA Phi (n, k, k) of a stepped matrix in contributions; those without variables are skipped."""
    total = np.zeros((shapes.shape[-1], shapes.shape[-1]))
    for item in contributions.values():
        if np.iscomplexobj(item.operator) or np.iscomplexobj(item.law):
            seen = item.operator @ shapes
            total = total + np.imag(seen.mT @ item.law @ seen) / _STEP
    return 0.5 * (total + total.mT)
