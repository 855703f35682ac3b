"""Errors of identified modes over seeds, beside the least that statistics allow."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.identify import identify
from tests.models.synthetic_records import NARROW, WIDE, Truth, record, truth


@dataclass(frozen=True)
class Case:
    name: str
    frequencies: tuple[float, ...]
    noise: float
    seconds: float = 120.0


CASES = (Case("pairs 1.2 % and 1.1 % apart, 10 % noise", WIDE, 0.10), Case("pairs 0.08 % and 0.06 % apart, 3 % noise", NARROW, 0.03))


@dataclass(frozen=True)
class Trial:
    """Of one record: relative errors (k,) of frequency and damping, those over their stated deviations, MAC (k,), angle of pairs in
    degrees, whether as many modes were found as there are, and time."""

    frequency: np.ndarray
    damping: np.ndarray
    scores: np.ndarray
    mac: np.ndarray
    angle: float
    found: int
    seconds: float


def trials(case: Case, seeds: Iterable[int]) -> list[Trial]:
    return [trial(case, seed) for seed in seeds]


def trial(case: Case, seed: int) -> Trial:
    """One record of modes drawn anew with the seed."""
    known = truth(case.frequencies, seed=1000 + seed)
    made = record(known, seed, noise=case.noise, seconds=case.seconds)
    start = time.process_time()
    found = identify(made)
    return compared(known, found, time.process_time() - start)


def compared(known: Truth, found: Identified, seconds: float = 0.0) -> Trial:
    count = len(known.frequencies)
    if len(found.frequencies) != count:
        nothing = np.full(count, np.inf)
        return Trial(nothing, nothing, np.full((2, count), np.inf), np.zeros(count), 90.0, len(found.frequencies), seconds)
    order = paired(known, found)
    frequency, damping = found.frequencies[order] - known.frequencies, found.damping[order] - known.damping
    scores = np.stack([frequency / found.frequency_deviations[order], damping / found.damping_deviations[order]])
    mac = np.diagonal(assurance(known.shapes, found.shapes[:, order]))
    pairs = [[index, index + 1] for index in range(count - 1) if known.frequencies[index + 1] / known.frequencies[index] < 1.02]
    angle = max((subspace_degrees(known.shapes[:, pair], found.shapes[:, order][:, pair]) for pair in pairs), default=0.0)
    return Trial(frequency / known.frequencies, damping / known.damping, scores, mac, angle, count, seconds)


def paired(known: Truth, found: Identified) -> np.ndarray:
    """For each mode the one found, by frequency and, where near, by shape; the best of all pairings."""
    from scipy.optimize import linear_sum_assignment

    away = np.abs(found.frequencies[None, :] / known.frequencies[:, None] - 1.0) / 0.01
    return linear_sum_assignment(away + 1.0 - assurance(known.shapes, found.shapes))[1]


def assurance(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    cross = np.abs(first.conj().T @ second) ** 2
    return cross / np.outer(np.sum(np.abs(first) ** 2, axis=0), np.sum(np.abs(second) ** 2, axis=0))


def subspace_degrees(first: np.ndarray, second: np.ndarray) -> float:
    left, right = np.linalg.qr(first)[0], np.linalg.qr(second)[0]
    distance = right - left @ (left.conj().T @ right)
    return float(np.degrees(np.arcsin(min(1.0, np.linalg.norm(distance, 2)))))


def bound(known: Truth, noise: float, seconds: float = 120.0, rate: float = 2048.0) -> np.ndarray:
    """Cramer-Rao: least relative standard deviations (2, k) of frequencies and damping for anyone who knows that there are these modes,
    real ones, and nothing else; white inputs of variance 1, known exactly."""
    lines = np.arange(1.0, rate / 2.0, 0.125)
    response = known.response(lines)
    variance = noise**2 * np.mean(np.sum(np.abs(response) ** 2, axis=2), axis=0)
    columns = np.stack(list(_derivatives(known, lines)), axis=-1) / np.sqrt(variance)[None, :, None, None]
    rows = columns.reshape(-1, columns.shape[-1])
    information = 2.0 * seconds * 0.125 * np.real(rows.conj().T @ rows)
    scale = 1.0 / np.sqrt(np.diagonal(information))
    covariance = np.linalg.pinv(information * np.outer(scale, scale), rcond=1e-11, hermitian=True) * np.outer(scale, scale)
    return np.sqrt(np.diagonal(covariance)[: 2 * len(known.frequencies)]).reshape(2, -1)


def _derivatives(known: Truth, lines: np.ndarray) -> Iterable[np.ndarray]:
    """Derivatives (f, p, m) of the response by ln frequencies, ln damping ratios, shapes and participations."""
    count = len(known.frequencies)
    natural, omega = 2 * np.pi * known.frequencies, 2 * np.pi * lines[:, None]
    single = known._receptances(lines)
    by_damping = -(single**2) * 2j * known.damping * omega / natural
    by_frequency = 2.0 * single - single**2 * (2.0 + 2j * known.damping * omega / natural)
    for factor in (by_frequency, by_damping):
        for mode in range(count):
            yield factor[:, mode, None, None] * np.outer(known.shapes[:, mode], known.participation[mode])
    for mode in range(count):
        for output in range(len(known.shapes)):
            place = np.zeros((len(known.shapes), 1))
            place[output] = 1.0
            yield single[:, mode, None, None] * (place * known.participation[mode])
        for column in range(known.participation.shape[1]):
            place = np.zeros((1, known.participation.shape[1]))
            place[0, column] = 1.0
            yield single[:, mode, None, None] * (known.shapes[:, mode, None] * place)


def worst_bound(case: Case, seeds: Iterable[int], draws: int = 200) -> np.ndarray:
    """Worst of six relative errors (2, seeds * draws) of frequency and damping of an estimator that reaches the bound."""
    random = np.random.default_rng(0)
    rows = [bound(truth(case.frequencies, seed=1000 + seed), case.noise, case.seconds) for seed in seeds]
    return np.concatenate([np.max(np.abs(random.standard_normal((draws, *row.shape))) * row, axis=2).T for row in rows], axis=1)
