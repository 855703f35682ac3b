"""Maximum-likelihood estimation of the modes of one band: poles, participations and shapes together, from the cells of records."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.spectral.lines import Cells, legendre_coefficients, nodes
from flexstage.experiment.spectral.smear import WindowLeakage

_CHUNK = 4_000_000
_FREE, _SMALL = 1e-9, 1e-4
_MIXING = 0.25
_STEPS = 60
_CONVERGED = 1e-3
_NOISE_LINES, _SCATTER_LINES = 100, 25
_DIGITS = 1e-6


@dataclass(frozen=True, eq=False)
class Modal:
    """Modes of a band: H(f) is the sum over modes of shape times participation / (j f - pole), plus terms of modes outside the band.

    `poles` (k,) are in Hz (rad/s divided by 2 pi). `participation` (k, m+b) has m columns for inputs and b for the transients of blocks;
    `shapes` (p, k) has a row for each output.
    """

    poles: Array
    participation: Array
    shapes: Array

    def without(self, index: int) -> Modal:
        """Return a copy without the mode of this index."""
        kept = [each for each in range(len(self.poles)) if each != index]
        return Modal(self.poles[kept], self.participation[kept], self.shapes[:, kept])


@dataclass(frozen=True, eq=False)
class Band:
    """Data of one band: its cells, and the noise `variance` (p, c) per line of every output in every cell.

    `background` (c, b, 8) are the basis functions of modes outside the band, as Legendre coefficients in every cell. `smear` describes how
    windows smear the lines, if known. `shape` (p, c) is the relative noise variance of every output in every cell, if known. `rounding`
    (p,) is the variance per line caused by rounding of samples. The first `inputs` columns of the drive are inputs, the others transients
    (default: all are inputs).
    """

    cells: Cells
    variance: Array
    background: Array
    smear: WindowLeakage | None = None
    shape: Array | float = 1.0
    rounding: Array | float = 0.0
    inputs: int | None = None


@dataclass(frozen=True, eq=False)
class Fit:
    """Modes fitted to a band, with `cost`, the negative log-likelihood (half of chi-squared), and the Fisher information.

    `information` (q, q) is complex. Its parameters are, in this order: poles, participations mode by mode, shapes output by output.
    """

    modal: Modal
    cost: float
    information: Array
    converged: bool


@dataclass(frozen=True, eq=False)
class _Background:
    """Gram matrix per output (p, q, q) of background functions times inputs, over `scale` (p, q); `beside`: the number of others."""

    beside: int
    gram: Array
    scale: Array


@dataclass(frozen=True, eq=False)
class _Sums:
    """Sums per output: Gram matrix (p, f, n, f, n) of functions times inputs, products with data (p, f, n), data power (p,).

    `background` is the eliminated part, if any.
    """

    gram: Array
    cross: Array
    power: Array
    background: _Background | None = None


def fit(band: Band, start: Modal, enough: float = np.inf) -> Fit:
    """Maximise the likelihood of the modes by the Levenberg-Marquardt method from `start`.

    The noise is assumed circular and independent between lines and outputs. The residual is analytic in all parameters, so complex least
    squares apply. The iteration stops early if the cost exceeds `enough` and is predicted to remain above it.

    >>> from flexstage.experiment.example import one_mode_band
    >>> found = fit(*one_mode_band())
    >>> found.converged, round(float(abs(found.modal.poles[0])), 1)
    (True, 10.0)
    """
    modal, damping = start, 1e-3
    sums = _sums(band, modal.poles)
    cost = _cost(sums, modal)
    if not len(modal.poles):
        return Fit(modal, cost, np.zeros((0, 0)), converged=True)
    information, gradient = _normal(sums, modal)
    newton, promised = _step(information, gradient, _FREE)
    for _ in range(_STEPS):
        if promised < _CONVERGED or cost - promised > enough:
            return _as_fit(modal, cost, information, converged=promised < _CONVERGED)
        trial = _apply_step(modal, newton if damping == _FREE else _step(information, gradient, damping)[0])
        trial_sums = _sums(band, trial.poles, sums.background) if np.all(np.real(trial.poles) < 0.0) else None
        fall = -np.inf if trial_sums is None else cost - _cost(trial_sums, trial)
        if trial_sums is not None and fall >= 0.0:
            modal, sums, cost = trial, trial_sums, cost - fall
            information, gradient = _normal(sums, modal)
            if fall < 0.1 * _CONVERGED and damping < _SMALL:
                return _as_fit(modal, cost, information, converged=True)
            newton, promised = _step(information, gradient, _FREE)
            damping = max(damping * 0.1, _FREE)
        elif damping > 1e8:
            break
        else:
            damping *= 10.0
    return _as_fit(modal, cost, information, converged=False)


def _as_fit(modal: Modal, cost: float, information: Array, *, converged: bool) -> Fit:
    own = len(modal.poles) + modal.participation.size + modal.shapes.size
    return Fit(modal, cost, information[:own, :own], converged)


def _step(information: Array, gradient: Array, damping: float) -> tuple[Array, float]:
    """Damped Newton step, and its predicted cost reduction."""
    scale = np.real(np.diagonal(information))
    scale = np.maximum(scale, 1e-12 * np.max(scale))
    step = np.linalg.solve(information + damping * np.diag(scale), gradient)
    return step, float(np.real(np.vdot(step, gradient)))


def with_shapes(band: Band, poles: Array, participation: Array) -> Modal:
    """Compute shapes by linear least squares for given poles and input participations; transients start at zero.

    >>> from flexstage.experiment.example import POLE, one_mode_band
    >>> round(abs(with_shapes(one_mode_band()[0], np.array([POLE]), np.ones((1, 1))).shapes[0, 0]))
    5
    """
    full = np.zeros((len(poles), band.cells.width), dtype=complex)
    full[:, : participation.shape[1]] = participation
    sums = _sums(band, poles)
    count = len(poles)
    shapes = np.empty((len(sums.power), count), dtype=complex)
    for output in range(len(sums.power)):
        gram = np.einsum("rm,rmsn,sn->rs", np.conj(full), sums.gram[output][:count, :, :count], full)
        cross = np.einsum("rm,rm->r", np.conj(full), sums.cross[output][:count])
        shapes[output] = np.linalg.lstsq(gram, cross, rcond=1e-12)[0]
    return Modal(poles, full, shapes)


def residual_power(band: Band, modal: Modal) -> Array:
    """Compute the powers and cross powers (p, p, c) of the residuals in every cell. The first index belongs to the conjugated output.

    >>> from flexstage.experiment.example import one_mode_band
    >>> band, start = one_mode_band()
    >>> bool(np.sum(residual_power(band, fit(band, start).modal).real) < 0.1 * np.sum(band.cells.own_power))
    True
    """
    cells = band.cells
    left = np.moveaxis(cells.power.copy(), 0, 2)
    for chosen, inside in explained_share(band, modal):
        crossed = np.einsum("ocan,canp->opc", np.conj(inside), cells.cross[chosen], optimize=True)
        half = np.einsum("canbm,pcbm->canp", cells.own[chosen], inside, optimize=True)
        own = np.einsum("ocan,canp->opc", np.conj(inside), half, optimize=True)
        left[:, :, chosen] += own - crossed - np.conj(np.swapaxes(crossed, 0, 1))
    return left


def explained_share(band: Band, modal: Modal) -> Iterator[tuple[Array, Array]]:
    """Compute, block by block, the outputs that modes and background explain, as factors (p, c, 8, n) of the columns of Z (see `Cells`).

    Yields, for each block, the indices of its cells and the factors in these cells.

    >>> from flexstage.experiment.example import one_mode_band
    >>> [len(chosen) for chosen, _ in explained_share(*one_mode_band())] == [len(one_mode_band()[0].cells.low)]
    True
    """
    every = np.concatenate([resonances(band, modal.poles), band.background], axis=1)
    values = _coefficients(band, modal)
    for block, columns in enumerate(band.cells.columns):
        chosen = np.flatnonzero(band.cells.block == block)
        yield chosen, np.einsum("cfa,ofn->ocan", every[chosen], values[:, :, list(columns)], optimize=True)


def noise(band: Band, modal: Modal) -> Array:
    """Estimate the noise variance (p, c) per line of every output in every cell: the mean residual power over 100 lines or more.

    >>> from flexstage.experiment.example import one_mode_band
    >>> band, start = one_mode_band()
    >>> bool(0.8 < noise(band, fit(band, start).modal)[0, 0] / band.variance[0, 0] < 1.2)
    True
    """
    cells = band.cells
    power = np.real(np.einsum("ooc->oc", residual_power(band, modal))) / band.shape
    found = _pool_cells(power, cells) / _free_share(band, modal)
    return np.maximum(found * band.shape, silence(cells, band.rounding))


def silence(cells: Cells, rounding: Array | float) -> Array:
    """Compute the lower bound of the noise variance (p, c) per line.

    Cells represent responses with a relative error e of 1e-6. This error is common to all N lines, so averaging does not reduce it. The
    lower bound is the larger of N e^2 times the power of the output per line and `rounding` (p,), the variance caused by rounding of
    samples. The lower bound prevents false modes and confidence intervals that are too narrow.

    >>> from flexstage.experiment.example import one_mode_band
    >>> cells = one_mode_band()[0].cells
    >>> bool(silence(cells, 7.0).min() == 7.0), bool(np.all(silence(cells, 0.0) < 1e-8 * np.max(cells.own_power / cells.count[:, None])))
    (True, True)
    """
    return np.maximum(_DIGITS**2 * np.sum(cells.count) * cells.own_power.T / cells.count, np.reshape(rounding, (-1, 1)))


def scatter(band: Band, modal: Modal) -> Array:
    """Estimate the covariance (q, q) of the likelihood's gradient for noise correlated between outputs.

    The result is the middle matrix S of the sandwich estimator I^-1 S I^-1 (White 1982), with I and the parameters of `Fit.information`. S
    approaches the Fisher information if noise is independent between outputs. The covariance of the noise is the residual power averaged
    over only 25 lines, because the residual of an unrecorded force follows the resonances. The variance of the noise is at least `silence`.

    >>> from flexstage.experiment.example import one_mode_band
    >>> found = fit(*one_mode_band())
    >>> bool(0.7 < abs(scatter(one_mode_band()[0], found.modal)[0, 0] / found.information[0, 0]) < 1.3)
    True
    """
    cells, outputs = band.cells, len(modal.shapes)
    left = np.conj(residual_power(band, modal))
    noise = _pool_cells(left.reshape(-1, left.shape[2]), cells, _SCATTER_LINES).reshape(left.shape) / _free_share(band, modal)
    alone = np.arange(outputs)
    noise[alone, alone] = np.maximum(np.real(noise[alone, alone]), silence(cells, band.rounding))
    weights = (noise / band.variance[:, None, :] / band.variance[None, :, :]).reshape(outputs**2, -1)
    functions, full = _derivatives(band, modal)
    gram = _gram(cells, weights, functions, functions).reshape(outputs, outputs, len(full[0]), -1)
    kept = len(modal.poles) + modal.participation.size + modal.shapes.size
    total = np.zeros((full[0].shape[1],) * 2, dtype=complex)
    for first in range(outputs):
        for second in range(outputs):
            total += np.conj(full[first].T) @ gram[first, second] @ full[second]
    return total[:kept, :kept]


def shares(band: Band, modal: Modal, groups: Array) -> tuple[Array, Array]:
    """Compute the contributions of g groups of cells to the gradient (g, q) and to the information (g, q, q) for q parameters (see `Fit`).

    `groups` (c,) are the group numbers of the cells, from 0. For fitted modes the gradients sum to zero.

    >>> from flexstage.experiment.example import one_mode_band
    >>> band, start = one_mode_band()
    >>> found = fit(band, start)
    >>> gradient, information = shares(band, found.modal, np.arange(len(band.cells.low)) % 2)
    >>> bool(np.allclose(np.sum(information, axis=0), found.information, rtol=1e-6, atol=1e-9 * np.max(abs(found.information))))
    True
    """
    cells = band.cells
    functions, full = _derivatives(band, modal)
    kept = len(modal.poles) + modal.participation.size + modal.shapes.size
    crossed = np.zeros((len(cells.low), functions.shape[1], cells.width, len(full)), dtype=complex)
    for chosen, inside in explained_share(band, modal):
        left = cells.cross[chosen] - np.einsum("canbm,ocbm->cano", cells.own[chosen], inside, optimize=True)
        part = np.einsum("cfa,cano->cfno", np.conj(functions[chosen]), left, optimize=True)
        crossed[chosen[:, None], :, list(cells.columns[cells.block[chosen[0]]])] = np.moveaxis(part, 2, 1)
    crossed = (crossed / band.variance.T[:, None, None, :]).reshape(len(cells.low), -1, len(full))
    gradient, information = [], []
    for group in range(int(np.max(groups)) + 1):
        chosen = groups == group
        own = _gram(cells.select_cells(chosen), 1.0 / band.variance[:, chosen], functions[chosen], functions[chosen])
        gram = own.reshape(len(full), len(full[0]), -1)
        cross = np.sum(crossed[chosen], axis=0)
        each = [(np.conj(one.T) @ column, np.conj(one.T) @ own @ one) for one, column, own in zip(full, cross.T, gram, strict=True)]
        gradient.append(np.sum([slope for slope, _ in each], axis=0)[:kept])
        information.append(np.sum([curved for _, curved in each], axis=0)[:kept, :kept])
    return np.array(gradient), np.array(information)


def _derivatives(band: Band, modal: Modal) -> tuple[Array, list[Array]]:
    """Functions (c, f, 8) of modes and background, and by output the derivatives (f n, q) of their factors by all parameters."""
    near = _legendre_functions(band, modal.poles)
    functions = np.concatenate([near, band.background], axis=1)
    size, outputs = near.shape[1] * band.cells.width, len(modal.shapes)
    own = _raw_sums(band, functions).gram.reshape(outputs, functions.shape[1] * band.cells.width, -1)
    return functions, [_add_background(own[output], _jacobian(modal, output, _pairs(modal.poles)), size) for output in range(outputs)]


def _add_background(gram: Array, jacobian: Array, size: int) -> Array:
    """Derivatives of all factors, the background's after the modes'."""
    scale = 1.0 / np.sqrt(np.real(np.diagonal(gram)[size:]))
    inner = gram[size:, size:] * np.outer(scale, scale) + 1e-13 * np.eye(len(scale))
    rest = -np.linalg.solve(inner, (gram[size:, :size] @ jacobian) * scale[:, None]) * scale[:, None]
    return np.concatenate([jacobian, rest])


def _free_share(band: Band, modal: Modal) -> float:
    """Share of the lines not used by fit parameters."""
    used = band.background.shape[1] * band.cells.width + len(modal.poles) * (1.0 + band.cells.width / len(modal.shapes))
    return max(0.1, 1.0 - used / float(np.sum(band.cells.count)))


def _pool_cells(power: Array, cells: Cells, least: int = _NOISE_LINES) -> Array:
    """Means per line of powers (q, c), over neighbouring cells of at least `least` lines together."""
    found = np.empty_like(power)
    for block in range(len(cells.columns)):
        chosen = np.flatnonzero(cells.block == block)
        lines = np.cumsum(cells.count[chosen])
        parts = max(1, int(lines[-1]) // least)
        place = np.minimum((lines - 1) * parts // int(lines[-1]), parts - 1)
        for part in np.unique(place):
            members = chosen[place == part]
            found[:, members] = (np.sum(power[:, members], axis=1) / np.sum(cells.count[members]))[:, None]
    return found


def background(cells: Cells, outside: Array, degree: int = 3) -> Array:
    """Construct an orthonormal basis (c, b, 8) for polynomials up to `degree` and for the terms 1/(j f - p) with the poles `outside` [Hz].

    Basis functions below 1e-6, the relative precision of cells, are omitted.

    >>> from flexstage.experiment.example import one_mode_band
    >>> background(one_mode_band()[0].cells, np.zeros(0), 1).shape[1:]
    (2, 8)
    """
    points = nodes(cells.low, cells.high)
    x = (2.0 * points - np.min(cells.low) - np.max(cells.high)) / (np.max(cells.high) - np.min(cells.low))
    tails = 1.0 / (1j * points[:, :, None] - outside)
    every = np.concatenate([np.polynomial.legendre.legvander(x, degree), tails], axis=2)
    weight = np.sqrt(np.repeat(cells.count / points.shape[1], points.shape[1]))
    rows = every.reshape(-1, every.shape[2])
    rows = rows / np.linalg.norm(rows * weight[:, None], axis=0)
    left, values, _ = np.linalg.svd(rows * weight[:, None], full_matrices=False)
    kept = left[:, values > _DIGITS * values[0]] / weight[:, None]
    return legendre_coefficients(np.moveaxis(kept.reshape(*points.shape, -1), 2, 1))


def resonances(band: Band, poles: Array) -> Array:
    """Compute 1/(j f - p) in every cell for poles p (k,) in Hz, as Legendre coefficients (c, k, 8).

    >>> from flexstage.experiment.example import one_mode_band
    >>> band, start = one_mode_band()
    >>> resonances(band, start.poles).shape == (len(band.cells.low), 1, 8)
    True
    """
    return _legendre_functions(band, poles)[:, : len(poles)]


def _legendre_functions(band: Band, poles: Array) -> Array:
    """Legendre coefficients (c, f, 8) in every cell of 1/(j f - p), of its derivatives by p, and of products of near poles' functions."""
    points, pairs = nodes(band.cells.low, band.cells.high), _pairs(poles)
    if band.smear is not None:
        middles = np.array([0.5 * (poles[first] + poles[second]) for first, second in pairs], dtype=complex)
        both = band.smear.functions(points, np.concatenate([poles, middles]))
        every = [both[0][:, :, : len(poles)], both[1][:, :, : len(poles)], both[1][:, :, len(poles) :]]
        return legendre_coefficients(np.moveaxis(np.concatenate(every, axis=2), 2, 1))
    away = 1.0 / (1j * points[:, None, :] - poles[:, None])
    products = [away[:, first] * away[:, second] for first, second in pairs]
    return legendre_coefficients(np.concatenate([away, away**2, *(each[:, None] for each in products)], axis=1))


def _pairs(poles: Array) -> list[tuple[int, int]]:
    """Poles closer than half a half-width: their shapes mix, with additional rotation parameters."""
    return [
        (first, second)
        for second in range(len(poles))
        for first in range(second)
        if abs(poles[first] - poles[second]) < -_MIXING * (poles[first] + poles[second]).real
    ]


def _raw_sums(band: Band, functions: Array) -> _Sums:
    """Sums before elimination, over the functions (c, f, 8), inputs and transients of all blocks."""
    weights = 1.0 / band.variance
    return _Sums(_gram(band.cells, weights, functions, functions), _cross(band.cells, weights, functions), _power(band.cells, weights))


def _power(cells: Cells, weights: Array) -> Array:
    return np.sum(weights * cells.own_power.T, axis=1)


def _cross(cells: Cells, weights: Array, functions: Array) -> Array:
    """Products (w, f, n) of functions times inputs with the outputs, summed over cells with weights (w, c)."""
    cross = np.zeros((len(weights), functions.shape[1], cells.width), dtype=complex)
    for block, columns in enumerate(cells.columns):
        chosen = np.flatnonzero(cells.block == block)
        weighted = cells.cross[chosen] * weights[:, chosen].T[:, None, None, :]
        cross[:, :, list(columns)] += np.einsum("cfa,cano->ofn", np.conj(functions[chosen]), weighted, optimize=True)
    return cross


def _gram(cells: Cells, weights: Array, left: Array, right: Array) -> Array:
    """Gram matrices (w, l, n, r, n) of two sets of functions times inputs, summed over cells with weights (w, c)."""
    rows, first, last, total = len(weights), left.shape[1], right.shape[1], cells.width
    gram = np.zeros((rows, first, total, total, last), dtype=complex)
    for block, columns in enumerate(cells.columns):
        together = max(1, _CHUNK // (last * len(columns)) ** 2)
        every = np.flatnonzero(cells.block == block)
        part = np.zeros((rows, first * last * len(columns) ** 2), dtype=complex)
        for start in range(0, len(every), together):
            chosen = every[start : start + together]
            part += weights[:, chosen] @ _products(left[chosen], right[chosen], cells.own[chosen])
        part = part.reshape(rows, first, len(columns), len(columns), last)
        if list(columns) == list(range(total)) and len(cells.columns) == 1:
            gram = part
        else:
            gram[np.ix_(range(rows), range(first), columns, columns, range(last))] += part
    return gram.swapaxes(3, 4)


def _products(left: Array, right: Array, own: Array) -> Array:
    """Gram matrices (c, l n n r) of functions times inputs in every cell: functions first and last, inputs between."""
    count, size, inputs, rows = len(own), own.shape[1], own.shape[2], left.shape[1] * own.shape[2] ** 2
    half = np.conj(left) @ own.reshape(count, size, -1)
    half = half.reshape(count, left.shape[1], inputs, size, inputs).swapaxes(3, 4).reshape(count, rows, size)
    return (half @ right.swapaxes(1, 2)).reshape(count, rows * right.shape[1])


def _sums(band: Band, poles: Array, known: _Background | None = None) -> _Sums:
    """Sums of the modes' functions, with the background eliminated: its `known` part is independent of the poles."""
    cells, weights, near = band.cells, 1.0 / band.variance, _legendre_functions(band, poles)
    functions = np.concatenate([near, band.background], axis=1)
    outputs, kept, total = len(weights), near.shape[1], cells.width
    size = kept * total
    gram = _gram(cells, weights, near, functions).reshape(outputs, size, functions.shape[1] * total)
    cross = _cross(cells, weights, functions).reshape(outputs, -1)
    if known is None or known.beside != kept:
        known = _background_sums(band, weights, functions)
    gone = np.swapaxes(np.conj(gram[:, :, size:]), 1, 2)
    right = np.concatenate([gone, cross[:, size:, None]], axis=2) * known.scale[:, :, None]
    corrected = np.conj(np.swapaxes(right, 1, 2)) @ np.linalg.solve(known.gram, right)
    left = gram[:, :, :size] - corrected[:, :-1, :-1]
    return _Sums(
        left.reshape(outputs, kept, total, kept, total),
        (cross[:, :size] - corrected[:, :-1, -1]).reshape(outputs, kept, total),
        _power(cells, weights) - corrected[:, -1, -1].real,
        known,
    )


def _background_sums(band: Band, weights: Array, functions: Array) -> _Background:
    """Computed from products with all functions: BLAS rounding depends on position, and close modes are sensitive to it."""
    count = band.background.shape[1]
    kept, size = functions.shape[1] - count, count * band.cells.width
    gram = _gram(band.cells, weights, band.background, functions)[:, :, :, kept:].reshape(len(weights), size, size)
    scale = 1.0 / np.sqrt(np.real(np.diagonal(gram, axis1=1, axis2=2)))
    return _Background(kept, gram * scale[:, :, None] * scale[:, None, :] + 1e-13 * np.eye(gram.shape[1]), scale)


def _coefficients(band: Band, modal: Modal) -> Array:
    """Factors (p, f, n) of the modes' functions and the corresponding optimal polynomials."""
    count = len(modal.poles)
    functions = np.concatenate([resonances(band, modal.poles), band.background], axis=1)
    raw = _raw_sums(band, functions)
    outputs, every, total = raw.cross.shape
    size = count * total
    gram, cross = raw.gram.reshape(outputs, every * total, every * total), raw.cross.reshape(outputs, -1)
    modes = (modal.shapes[:, :, None] * modal.participation[None]).reshape(outputs, size)
    right = cross[:, size:] - np.einsum("oij,oj->oi", gram[:, size:, :size], modes)
    inner = gram[:, size:, size:]
    scale = 1.0 / np.sqrt(np.real(np.diagonal(inner, axis1=1, axis2=2)))
    scaled = inner * scale[:, :, None] * scale[:, None, :] + 1e-13 * np.eye(inner.shape[1])
    rest = np.linalg.solve(scaled, (right * scale)[:, :, None])[:, :, 0] * scale
    return np.concatenate([modes, rest], axis=1).reshape(outputs, every, total)


def _cost(sums: _Sums, modal: Modal) -> float:
    count = len(modal.poles)
    values = modal.shapes[:, :, None] * modal.participation[None]
    inside = np.einsum("orm,ormsn,osn->", np.conj(values), sums.gram[:, :count, :, :count], values, optimize=True)
    crossed = np.einsum("orm,orm->", np.conj(values), sums.cross[:, :count])
    return float(np.sum(sums.power) - 2.0 * crossed.real + inside.real)


def _jacobian(modal: Modal, output: int, pairs: list[tuple[int, int]]) -> Array:
    """Derivatives (f n, parameters) of one output's factors by poles, participations, that output's shapes, and mixing of near poles."""
    count, total = modal.participation.shape
    outputs = len(modal.shapes)
    base = count + count * total + outputs * count
    result = np.zeros((2 * count + len(pairs), total, base + 2 * len(pairs)), dtype=complex)
    modes, entries = np.arange(count), np.arange(total)
    shape = modal.shapes[output]
    result[count + modes, :, modes] = shape[:, None] * modal.participation
    place = count + modes[:, None] * total + entries
    result[modes[:, None], entries, place] = shape[:, None]
    result[modes, :, count + count * total + output * count + modes] = modal.participation
    for number, (first, second) in enumerate(pairs):
        result[2 * count + number, :, base + 2 * number] = shape[first] * modal.participation[second]
        result[2 * count + number, :, base + 2 * number + 1] = shape[second] * modal.participation[first]
    return result.reshape(-1, result.shape[2])


def _normal(sums: _Sums, modal: Modal) -> tuple[Array, Array]:
    """Fisher information and gradient, mixing included."""
    count, total = modal.participation.shape
    information, gradient = 0.0, 0.0
    pairs = _pairs(modal.poles)
    for output in range(len(modal.shapes)):
        jacobian = _jacobian(modal, output, pairs)
        gram = sums.gram[output].reshape(len(jacobian), -1)
        values = (modal.shapes[output][:, None] * modal.participation).ravel()
        gradient = gradient + np.conj(jacobian.T) @ (sums.cross[output].ravel() - gram[:, : count * total] @ values)
        information = information + np.conj(jacobian.T) @ gram @ jacobian
    return np.asarray(information), np.asarray(gradient)


def _apply_step(modal: Modal, step: Array) -> Modal:
    """Modes after a step; for mixed near poles H = C (j f - A)^-1 B is diagonalised by the eigenvectors of A."""
    count, total = modal.participation.shape
    outputs = len(modal.shapes)
    poles, participation, shapes, mixing = np.split(step, np.cumsum([count, count * total, outputs * count]))
    matrix = np.diag(modal.poles + poles)
    for (first, second), (one, other) in zip(_pairs(modal.poles), mixing.reshape(-1, 2), strict=True):
        matrix[first, second] += one
        matrix[second, first] += other
    rows, columns = modal.participation + participation.reshape(count, total), modal.shapes + shapes.reshape(outputs, count)
    if not len(mixing):
        return Modal(np.diagonal(matrix), rows, columns)
    values, vectors = np.linalg.eig(matrix)
    return Modal(values, np.linalg.solve(vectors, rows), columns @ vectors)
