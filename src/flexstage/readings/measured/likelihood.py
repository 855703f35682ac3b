"""Maximum-likelihood modes of one band: poles, participations and shapes at once, from the cells of records."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.readings.measured.lines import Cells, expanded, nodes
from flexstage.readings.measured.smear import Smear

_CHUNK = 4_000_000
_FREE = 1e-9
_STEPS = 60
_CONVERGED = 1e-3
_NEGLIGIBLE = 1e-5
_NOISE_LINES = 400
_SILENT = 1e-14


@dataclass(frozen=True, eq=False)
class Modal:
    """Modes of a band: `poles` (k,) in Hz (pole in rad/s over 2 pi), `participation` (k, m+b) of the inputs and of the blocks' transients,
    `shapes` (p, k). H = sum of shape participation / (j f - pole), and a polynomial for what lies outside."""

    poles: Array
    participation: Array
    shapes: Array

    def without(self, index: int) -> Modal:
        """The modes but one."""
        kept = [each for each in range(len(self.poles)) if each != index]
        return Modal(self.poles[kept], self.participation[kept], self.shapes[:, kept])


@dataclass(frozen=True, eq=False)
class Band:
    """Data of one band: its cells, the noise variance of every output per line in every cell (p, c), and the functions (c, b, 6) that stand
    for what lies outside: Legendre coefficients in every cell. `smear` says how windows have smeared the lines, if they have; `shape`
    (p, c) how the noise variance is known to go with frequency."""

    cells: Cells
    variance: Array
    background: Array
    smear: Smear | None = None
    shape: Array | float = 1.0


@dataclass(frozen=True, eq=False)
class Fit:
    """Modes fitted to a band, twice the negative log-likelihood halved (`cost`: chi-square per complex number) and Fisher information.

    `information` is complex and of the parameters (poles; participation row by row; shapes output by output).
    """

    modal: Modal
    cost: float
    information: Array
    converged: bool


@dataclass(frozen=True, eq=False)
class _Sums:
    """Per output, with the polynomial eliminated: Gram matrix (p, f, n, f, n) of functions times inputs, products with data (p, f, n), and
    data's own power (p,)."""

    gram: Array
    cross: Array
    power: Array


def fit(band: Band, start: Modal) -> Fit:
    """The modes that maximise the likelihood, by Levenberg-Marquardt from `start`.

    The residual is analytic in all parameters, so that complex least squares apply: noise is circular and independent between lines and
    outputs.
    """
    modal, damping = start, 1e-3
    sums = _sums(band, modal.poles)
    cost = _cost(sums, modal)
    if not len(modal.poles):
        return Fit(modal, cost, np.zeros((0, 0)), converged=True)
    information, gradient = _normal(sums, modal)
    for _ in range(_STEPS):
        if _step(information, gradient, _FREE)[1] < _CONVERGED:
            return Fit(modal, cost, information, converged=True)
        trial = _moved(modal, _step(information, gradient, damping)[0])
        trial_sums = _sums(band, trial.poles)
        trial_cost = _cost(trial_sums, trial)
        if trial_cost <= cost and np.all(trial.poles.real < 0.0):
            modal, sums, cost = trial, trial_sums, trial_cost
            information, gradient = _normal(sums, modal)
            damping = max(damping * 0.1, _FREE)
        elif damping > 1e8:
            break
        else:
            damping *= 10.0
    return Fit(modal, cost, information, converged=False)


def _step(information: Array, gradient: Array, damping: float) -> tuple[Array, float]:
    """A damped Newton step and the fall of the cost it promises."""
    scale = np.real(np.diagonal(information))
    scale = np.maximum(scale, 1e-12 * np.max(scale))
    step = np.linalg.solve(information + damping * np.diag(scale), gradient)
    return step, float(np.real(np.vdot(step, gradient)))


def shaped(band: Band, poles: Array, participation: Array) -> Modal:
    """Shapes by linear least squares for given poles and participations of the inputs; transients begin at nought."""
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
    """Power (p, c) that modes and background leave in every cell."""
    cells, left = band.cells, np.empty_like(band.variance)
    for chosen, inside in explained(band, modal):
        crossed = np.einsum("ocan,cano->oc", np.conj(inside), cells.cross[chosen], optimize=True)
        own = np.einsum("ocan,canbm,ocbm->oc", np.conj(inside), cells.own[chosen], inside, optimize=True)
        left[:, chosen] = cells.power[chosen].T - 2.0 * crossed.real + own.real
    return left


def explained(band: Band, modal: Modal) -> Iterator[tuple[Array, Array]]:
    """Block by block, the numbers of its cells and the factors (p, c, 6, n) of Z in them that modes and background amount to."""
    count = len(modal.poles)
    every = np.concatenate([_functions(band, modal.poles)[:, :count], band.background], axis=1)
    values = _coefficients(band, modal)
    for block, columns in enumerate(band.cells.columns):
        chosen = np.flatnonzero(band.cells.block == block)
        yield chosen, np.einsum("cfa,ofn->ocan", every[chosen], values[:, :, list(columns)], optimize=True)


def _functions(band: Band, poles: Array) -> Array:
    """Legendre coefficients (c, 2k, 6) in every cell of 1/(j f - p) and of its derivative by p."""
    points = nodes(band.cells.low, band.cells.high)
    if band.smear is not None:
        return expanded(np.moveaxis(np.concatenate(band.smear.functions(points, poles), axis=2), 2, 1))
    away = 1.0 / (1j * points[:, None, :] - poles[:, None])
    return expanded(np.concatenate([away, away**2], axis=1))


def noise(band: Band, modal: Modal) -> Array:
    """Noise variance per line of every output in every cell (p, c), from what modes and background leave: means over 400 lines or more."""
    power, cells = residual_power(band, modal) / band.shape, band.cells
    outputs, total = len(power), int(np.sum(cells.count))
    used = band.background.shape[1] * cells.width + len(modal.poles) * (1.0 + cells.width / outputs)
    free = max(0.1, 1.0 - used / total)
    found = np.empty_like(power)
    for block in range(len(cells.columns)):
        chosen = np.flatnonzero(cells.block == block)
        lines = np.cumsum(cells.count[chosen])
        parts = max(1, int(lines[-1]) // _NOISE_LINES)
        place = np.minimum((lines - 1) * parts // int(lines[-1]), parts - 1)
        for part in np.unique(place):
            members = chosen[place == part]
            mean = np.sum(power[:, members], axis=1) / (np.sum(cells.count[members]) * free)
            found[:, members] = mean[:, None]
    signal = np.sum(cells.power, axis=0)[:, None] / total
    return np.maximum(found * band.shape, _SILENT * signal)


def background(cells: Cells, outside: Array, degree: int = 3) -> Array:
    """An orthonormal basis (c, b, 6) of polynomials up to `degree` and of the tails 1/(j f - p) of the poles `outside` (Hz).

    Directions that add less than 1e-5 to it are left out.
    """
    points = nodes(cells.low, cells.high)
    x = (2.0 * points - np.min(cells.low) - np.max(cells.high)) / (np.max(cells.high) - np.min(cells.low))
    tails = 1.0 / (1j * points[:, :, None] - outside)
    every = np.concatenate([np.polynomial.legendre.legvander(x, degree), tails], axis=2)
    weight = np.sqrt(np.repeat(cells.count / points.shape[1], points.shape[1]))
    rows = every.reshape(-1, every.shape[2])
    rows = rows / np.linalg.norm(rows * weight[:, None], axis=0)
    left, values, _ = np.linalg.svd(rows * weight[:, None], full_matrices=False)
    kept = left[:, values > _NEGLIGIBLE * values[0]] / weight[:, None]
    return expanded(np.moveaxis(kept.reshape(*points.shape, -1), 2, 1))


def _raw(band: Band, functions: Array) -> _Sums:
    """Sums before elimination, over the functions (c, f, 6), inputs and transients of all blocks."""
    cells, weights = band.cells, 1.0 / band.variance
    outputs, count, total = cells.cross.shape[3], functions.shape[1], cells.width
    gram = np.zeros((outputs, count, total, count, total), dtype=complex)
    cross = np.zeros((outputs, count, total), dtype=complex)
    for block, columns in enumerate(cells.columns):
        together = max(1, _CHUNK // (count * len(columns)) ** 2)
        every = np.flatnonzero(cells.block == block)
        for start in range(0, len(every), together):
            chosen = every[start : start + together]
            products = _products(functions[chosen], cells.own[chosen])
            shape = (outputs, count, len(columns), count, len(columns))
            part = (weights[:, chosen] @ products.reshape(len(chosen), -1)).reshape(shape)
            gram[np.ix_(range(outputs), range(count), columns, range(count), columns)] += part
            weighted = cells.cross[chosen] * weights[:, chosen].T[:, None, None, :]
            cross[:, :, list(columns)] += np.einsum("cfa,cano->ofn", np.conj(functions[chosen]), weighted, optimize=True)
    return _Sums(gram, cross, np.sum(weights * cells.power.T, axis=1))


def _products(functions: Array, own: Array) -> Array:
    """Gram matrices (c, f, n, f, n) of functions times inputs in every cell."""
    count, size, inputs = len(own), own.shape[1], own.shape[2]
    half = np.conj(functions) @ own.reshape(count, size, -1)
    half = half.reshape(count, -1, inputs, size, inputs).swapaxes(3, 4).reshape(count, -1, size)
    full = half @ functions.swapaxes(1, 2)
    return full.reshape(count, functions.shape[1], inputs, inputs, functions.shape[1]).swapaxes(3, 4)


def _sums(band: Band, poles: Array) -> _Sums:
    functions = np.concatenate([_functions(band, poles), band.background], axis=1)
    raw = _raw(band, functions)
    kept = 2 * len(poles)
    outputs, count, total = raw.cross.shape
    size = kept * total
    gram = raw.gram.reshape(outputs, count * total, count * total)
    cross = raw.cross.reshape(outputs, -1)
    gone = np.swapaxes(np.conj(gram[:, :size, size:]), 1, 2)
    scale = 1.0 / np.sqrt(np.real(np.diagonal(gram[:, size:, size:], axis1=1, axis2=2)))
    inner = gram[:, size:, size:] * scale[:, :, None] * scale[:, None, :] + 1e-13 * np.eye(gone.shape[1])
    right = np.concatenate([gone, cross[:, size:, None]], axis=2) * scale[:, :, None]
    solved = np.linalg.solve(inner, right)
    corrected = np.conj(np.swapaxes(right, 1, 2)) @ solved
    left = gram[:, :size, :size] - corrected[:, :-1, :-1]
    return _Sums(
        left.reshape(outputs, kept, total, kept, total),
        (cross[:, :size] - corrected[:, :-1, -1]).reshape(outputs, kept, total),
        raw.power - corrected[:, -1, -1].real,
    )


def _coefficients(band: Band, modal: Modal) -> Array:
    """Factors (p, f, n) of the modes' functions and, best for them, of the polynomials."""
    count = len(modal.poles)
    functions = np.concatenate([_functions(band, modal.poles)[:, :count], band.background], axis=1)
    raw = _raw(band, functions)
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


def _jacobian(modal: Modal, output: int) -> Array:
    """Derivatives (f n, parameters) of one output's factors by poles, participations and that output's shapes."""
    count, total = modal.participation.shape
    outputs = len(modal.shapes)
    result = np.zeros((2 * count, total, count + count * total + outputs * count), dtype=complex)
    modes, entries = np.arange(count), np.arange(total)
    shape = modal.shapes[output]
    result[count + modes, :, modes] = shape[:, None] * modal.participation
    place = count + modes[:, None] * total + entries
    result[modes[:, None], entries, place] = shape[:, None]
    result[modes, :, count + count * total + output * count + modes] = modal.participation
    return result.reshape(2 * count * total, -1)


def _normal(sums: _Sums, modal: Modal) -> tuple[Array, Array]:
    """Fisher information and gradient."""
    count, total = modal.participation.shape
    information, gradient = 0.0, 0.0
    for output in range(len(modal.shapes)):
        jacobian = np.conj(_jacobian(modal, output).T)
        gram = sums.gram[output].reshape(2 * count * total, -1)
        values = (modal.shapes[output][:, None] * modal.participation).ravel()
        gradient = gradient + jacobian @ (sums.cross[output].ravel() - gram[:, : count * total] @ values)
        information = information + jacobian @ gram @ np.conj(jacobian.T)
    return np.asarray(information), np.asarray(gradient)


def _moved(modal: Modal, step: Array) -> Modal:
    count, total = modal.participation.shape
    poles, participation, shapes = np.split(step, [count, count + count * total])
    return replace(
        modal,
        poles=modal.poles + poles,
        participation=modal.participation + participation.reshape(count, total),
        shapes=modal.shapes + shapes.reshape(len(modal.shapes), count),
    )
