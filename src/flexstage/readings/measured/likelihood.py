"""Maximum-likelihood modes of one band: poles, participations and shapes at once, from the cells of records."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.readings.measured.lines import Cells, expanded, nodes

_CHUNK = 4_000_000
_STEPS = 60
_CONVERGED = 1e-4


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
    """Data of one band: its cells, the noise variance of every output per line in every cell (p, c), and the degree of the polynomial."""

    cells: Cells
    variance: Array
    degree: int


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
    modal = start
    damping, cost = 1e-3, np.inf
    sums = _sums(band, modal.poles)
    cost = _cost(sums, modal)
    information, gradient = _normal(sums, modal)
    for _ in range(_STEPS):
        scale = np.real(np.diagonal(information))
        scale = np.maximum(scale, 1e-12 * np.max(scale))
        step = np.linalg.solve(information + damping * np.diag(scale), gradient)
        gain = float(np.real(np.vdot(step, gradient)))
        trial = _moved(modal, step)
        trial_sums = _sums(band, trial.poles)
        trial_cost = _cost(trial_sums, trial)
        if trial_cost <= cost and np.all(trial.poles.real < 0.0):
            modal, sums, cost = trial, trial_sums, trial_cost
            information, gradient = _normal(sums, modal)
            damping = max(damping * 0.1, 1e-9)
            if gain < _CONVERGED:
                return Fit(modal, cost, information, converged=True)
        elif damping > 1e8:
            break
        else:
            damping *= 10.0
    return Fit(modal, cost, information, converged=gain < 1.0)


def shaped(band: Band, poles: Array, participation: Array) -> Modal:
    """Shapes by linear least squares for given poles and participations of the inputs; transients begin at nought."""
    inputs = band.cells.cross.shape[2] - 1
    full = np.zeros((len(poles), inputs + band.cells.blocks), dtype=complex)
    full[:, :inputs] = participation
    sums = _sums(band, poles)
    count = len(poles)
    shapes = np.empty((len(sums.power), count), dtype=complex)
    for output in range(len(sums.power)):
        gram = np.einsum("rm,rmsn,sn->rs", np.conj(full), sums.gram[output][:count, :, :count], full)
        cross = np.einsum("rm,rm->r", np.conj(full), sums.cross[output][:count])
        shapes[output] = np.linalg.lstsq(gram, cross, rcond=1e-12)[0]
    return Modal(poles, full, shapes)


def residual_power(band: Band, modal: Modal) -> Array:
    """Power (p, c) that modes and polynomial leave in every cell."""
    cells = band.cells
    functions = _functions(band, modal.poles)[:, : len(modal.poles)]
    polynomials = _polynomials(band)
    values = _coefficients(band, modal)
    every = np.concatenate([functions, polynomials], axis=1)
    inputs = cells.cross.shape[2] - 1
    left = np.empty_like(band.variance)
    for block in range(cells.blocks):
        chosen = cells.block == block
        columns = [*range(inputs), inputs + block]
        inside = np.einsum("cfa,ofn->ocan", every[chosen], values[:, :, columns], optimize=True)
        crossed = np.einsum("ocan,cano->oc", np.conj(inside), cells.cross[chosen], optimize=True)
        own = np.einsum("ocan,canbm,ocbm->oc", np.conj(inside), cells.own[chosen], inside, optimize=True)
        left[:, chosen] = cells.power[chosen].T - 2.0 * crossed.real + own.real
    return left


def _functions(band: Band, poles: Array) -> Array:
    """Legendre coefficients (c, 2k, 5) in every cell of 1/(j f - p) and of its derivative by p."""
    away = 1.0 / (1j * nodes(band.cells.low, band.cells.high)[:, None, :] - poles[:, None])
    return expanded(np.concatenate([away, away**2], axis=1))


def _polynomials(band: Band) -> Array:
    low, high = np.min(band.cells.low), np.max(band.cells.high)
    x = (2.0 * nodes(band.cells.low, band.cells.high) - low - high) / (high - low)
    return expanded(np.moveaxis(np.polynomial.legendre.legvander(x, band.degree), -1, 1)).astype(complex)


def _raw(band: Band, functions: Array) -> _Sums:
    """Sums before elimination, over the functions (c, f, 5), inputs and transients of all blocks."""
    cells, weights = band.cells, 1.0 / band.variance
    inputs, outputs = cells.cross.shape[2] - 1, cells.cross.shape[3]
    count, total = functions.shape[1], inputs + cells.blocks
    gram = np.zeros((outputs, count, total, count, total), dtype=complex)
    cross = np.zeros((outputs, count, total), dtype=complex)
    together = max(1, _CHUNK // (count * (inputs + 1)) ** 2)
    for block in range(cells.blocks):
        columns = [*range(inputs), inputs + block]
        every = np.flatnonzero(cells.block == block)
        for start in range(0, len(every), together):
            chosen = every[start : start + together]
            products = _products(functions[chosen], cells.own[chosen])
            shape = (outputs, count, inputs + 1, count, inputs + 1)
            part = (weights[:, chosen] @ products.reshape(len(chosen), -1)).reshape(shape)
            gram[np.ix_(range(outputs), range(count), columns, range(count), columns)] += part
            weighted = cells.cross[chosen] * weights[:, chosen].T[:, None, None, :]
            cross[:, :, columns] += np.einsum("cfa,cano->ofn", np.conj(functions[chosen]), weighted, optimize=True)
    return _Sums(gram, cross, np.sum(weights * cells.power.T, axis=1))


def _products(functions: Array, own: Array) -> Array:
    """Gram matrices (c, f, n, f, n) of functions times inputs in every cell."""
    count, size, inputs = len(own), own.shape[1], own.shape[2]
    half = np.conj(functions) @ own.reshape(count, size, -1)
    half = half.reshape(count, -1, inputs, size, inputs).swapaxes(3, 4).reshape(count, -1, size)
    full = half @ functions.swapaxes(1, 2)
    return full.reshape(count, functions.shape[1], inputs, inputs, functions.shape[1]).swapaxes(3, 4)


def _sums(band: Band, poles: Array) -> _Sums:
    functions = np.concatenate([_functions(band, poles), _polynomials(band)], axis=1)
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
    functions = np.concatenate([_functions(band, modal.poles)[:, :count], _polynomials(band)], axis=1)
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
