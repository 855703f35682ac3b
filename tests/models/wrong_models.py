"""Seeded tests of stages that a sum of linear, viscous modes does not describe, or not all of it, and how often intervals hold.

Each gives a record or responses, and the natural frequency and damping ratio that intervals shall hold. Where a mode wanders with its
amplitude or with time, its damping is none of the stage's: nan.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.linalg import expm

from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.identify import identify
from flexstage.experiment.records.record import Channel, Record, Responses, Role, in_memory

NATURAL, RATIO = 60.0, 0.01
RATE, SECONDS = 512.0, 40.0
_SPARE, _FINER = 2048, 8
_SHAPE = np.array([1.0, 0.6])

Made: TypeAlias = tuple[Record | Responses, float, float]


def right(seed: int) -> Made:
    """One linear, viscous mode."""
    random = np.random.default_rng(seed)
    drive = _white(random)
    return _record(random, drive, _modal(drive, _resonance(NATURAL, RATIO)) * _SHAPE), NATURAL, RATIO


def hidden_neighbour(seed: int) -> Made:
    """A mode of 0.2 to 2 % of the first one's residue, half to three half-widths beside it, of another shape."""
    random = np.random.default_rng(seed)
    drive = _white(random)
    beside = NATURAL * (1.0 + RATIO * random.choice([-1.0, 1.0]) * random.uniform(0.5, 3.0))
    shape = np.geomspace(0.002, 0.02, 8)[seed % 8] * np.array([1.0, random.uniform(-1.0, 1.0)])
    moved = _modal(drive, _resonance(NATURAL, RATIO)) * _SHAPE + _modal(drive, _resonance(beside, 1.3 * RATIO)) * shape
    return _record(random, drive, moved), NATURAL, RATIO


def hysteretic(seed: int) -> Made:
    """Two modes of structural damping, shapes out of phase: 1 / (1 - (f/f0)^2 + j eta), whose pole is f0 (1 + j eta)^(1/2) j."""
    random = np.random.default_rng(seed)
    drive, loss = _white(random), 2.0 * RATIO

    def single(natural: float) -> Callable[[np.ndarray], np.ndarray]:
        return lambda lines: 1.0 / (1.0 - (lines / natural) ** 2 + 1j * loss)

    turned = np.exp(0.3j) * np.array([0.5, -0.5])
    other = np.concatenate([_modal(drive, lambda lines, part=part: part * single(1.3 * NATURAL)(lines)) for part in turned], axis=1)
    pole = NATURAL * np.sqrt(1.0 + 1j * loss)
    return _record(random, drive, _modal(drive, single(NATURAL)) * _SHAPE + other), abs(pole), pole.imag / abs(pole)


def cubic_spring(seed: int) -> Made:
    """A spring that hardens or softens by 0.3 % at the rms motion under white noise.

    Equivalent linearisation (Caughey 1963): k (1 + 3 e s^2), with s^2 of that same stiffness.
    """
    random = np.random.default_rng(seed)
    drive = _white(random)
    cubic, omega, step = 0.003 * random.choice([-1.0, 1.0]), 2.0 * np.pi * NATURAL, 1.0 / RATE / _FINER
    gain = np.sqrt(4.0 * RATIO * omega**3 * RATE)  # a variance of 1 without the cubic term
    push = gain * _finer(drive)
    matrix = np.array([[0.0, 1.0], [-(omega**2), -2.0 * RATIO * omega]])
    turn = expm(matrix * step)
    felt = np.linalg.solve(matrix, turn - np.eye(2))[:, 1]
    (a, b, c, d), (place, speed), half = turn.ravel().tolist(), felt.tolist(), 0.5 * step * cubic * omega**2
    moved, x, v = np.empty(len(push)), 0.0, 0.0
    for index, force in enumerate((0.5 * (push + np.roll(push, -1))).tolist()):
        moved[index] = x
        v -= half * x**3
        x, v = a * x + b * v + place * force, c * x + d * v + speed * force
        v -= half * x**3
    variance = 1.0
    for _ in range(20):
        variance = 1.0 / (1.0 + 3.0 * cubic * variance)
    natural = NATURAL * np.sqrt(1.0 + 3.0 * cubic * variance)
    return _record(random, drive, moved[::_FINER, None] * _SHAPE), float(natural), np.nan


def warming(seed: int) -> Made:
    """Its frequency drifts by 15 to 50 % of its half-width during the record: the mean is meant."""
    random = np.random.default_rng(seed)
    drive = _white(random)
    push = _finer(drive)
    time = np.clip((np.arange(len(push)) / RATE / _FINER - _SPARE / RATE) / SECONDS, 0.0, 1.0)
    omega = 2.0 * np.pi * NATURAL * (1.0 + random.choice([-1.0, 1.0]) * random.uniform(0.15, 0.5) * RATIO * (time - 0.5))
    poles = omega * (-RATIO + 1j * np.sqrt(1.0 - RATIO**2))
    turns = np.exp(poles / RATE / _FINER)
    moved, state = np.empty(len(push), dtype=complex), 0j
    for index, (turn, felt) in enumerate(
        zip(turns.tolist(), ((turns - 1.0) / poles * 0.5 * (push + np.roll(push, -1))).tolist(), strict=True)
    ):
        moved[index] = state
        state = turn * state + felt
    return _record(random, drive, np.imag(moved[::_FINER, None]) * _SHAPE), NATURAL, np.nan


def unrecorded_force(seed: int) -> Made:
    """A white force of 20 to 100 % of the recorded one shakes the same mode."""
    random = np.random.default_rng(seed)
    drive = _white(random)
    other = random.uniform(0.2, 1.0) * _white(random)
    return _record(random, drive, _modal(drive + other, _resonance(NATURAL, RATIO)) * _SHAPE), NATURAL, RATIO


def leakage(seed: int, *, length: int = 1024, told: str = "") -> Made:
    """Responses by Welch's method, Hann's window of 2 s, not stated: lines 0.5 Hz apart, a half-width of 0.6 Hz."""
    made = right(seed)[0]
    assert isinstance(made, Record)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)
    pieces = np.lib.stride_tricks.sliding_window_view(made.values, length, axis=0)[:: length // 2]
    lines = np.fft.rfft((pieces - pieces.mean(axis=2, keepdims=True)) * window, axis=2)
    crossed, own = np.sum(lines[:, 1:] * np.conj(lines[:, :1]), axis=0).T, np.sum(np.abs(lines) ** 2, axis=0).T
    kept = slice(20 * length // 1024, 220 * length // 512)
    coherence = np.abs(crossed) ** 2 / own[:, :1] / own[:, 1:]
    channels = made.outputs, made.inputs
    frequencies = np.fft.rfftfreq(length, 1.0 / RATE)[kept]
    values = (crossed / own[:, :1])[kept, :, None]
    found = Responses(frequencies, *channels, values, coherence=coherence[kept, :, None], averages=len(pieces), window=told)
    return found, NATURAL, RATIO


def leakage_told(seed: int) -> Made:
    """The same, and the window is stated: it is divided out."""
    return leakage(seed, told="hann")


def blow(seed: int) -> Made:
    """One blow on a mode at 100 Hz that moves by 1 to 10 % of its half-width as it fades: the limit of small motion is meant."""
    random = np.random.default_rng(seed)
    rate, count = 1024.0, 4096
    share, fade = random.uniform(3e-5, 3e-4) * random.choice([-1.0, 1.0]), random.uniform(0.1, 0.4)
    time = np.arange(count - 100) / rate
    values = np.zeros((count, 2))
    values[100, 0] = 1.0
    values[100:, 1] = np.exp(-2.0 * time) * np.sin(2.0 * np.pi * 100.0 * (time - share * np.expm1(-time / fade) * fade))
    values[:, 1] += 1e-3 * random.standard_normal(count)
    return in_memory((Channel("u", "N", Role.INPUT), Channel("y1", "um", Role.OUTPUT)), rate, values), np.hypot(100.0, 1.0 / np.pi), np.nan


def blow_responses(seed: int) -> Made:
    """The ratio of the transforms of that record."""
    made, natural, ratio = blow(seed)
    assert isinstance(made, Record)
    lines = np.fft.rfft(made.values, axis=0)[160:1600]
    frequencies = np.fft.rfftfreq(made.length, 1.0 / made.rate)[160:1600]
    return Responses(frequencies, made.outputs, made.inputs, (lines[:, 1:] / lines[:, :1])[:, :, None]), natural, ratio


KINDS = (
    right,
    hidden_neighbour,
    hysteretic,
    cubic_spring,
    warming,
    unrecorded_force,
    leakage,
    leakage_told,
    blow,
    blow_responses,
)


@dataclass(frozen=True)
class Held:
    """How intervals held, test by test.

    Whether they held frequency and damping (n, 2; nan: not asked), whether those of noise `alone` would have, by how much they are wider
    (n,), and in how many tests the mode was not found.
    """

    inside: np.ndarray
    alone: np.ndarray
    widening: np.ndarray
    missed: int


def held(kind: Callable[[int], Made], seeds: Iterable[int]) -> Held:
    inside: list[np.ndarray] = []
    alone: list[np.ndarray] = []
    widening: list[float] = []
    missed = 0
    for seed in seeds:
        what, *true = kind(seed)
        found = identify(what)
        near = np.flatnonzero(np.abs(found.frequencies / true[0] - 1.0) < 0.05)
        if not len(near):
            missed += 1
            continue
        mode = int(near[np.argmin(np.abs(found.frequencies[near] - true[0]))])
        off = np.abs(np.array([found.frequencies[mode], found.damping[mode]]) - true)
        half = NORMAL_95 * np.array([found.frequency_deviations[mode], found.damping_deviations[mode]])
        inside.append(np.where(np.isnan(off), np.nan, off <= half))
        alone.append(np.where(np.isnan(off), np.nan, off <= half / found.widening[mode]))
        widening.append(float(found.widening[mode]))
    return Held(np.array(inside), np.array(alone), np.array(widening), missed)


def _white(random: np.random.Generator) -> np.ndarray:
    """White noise up to the highest line, that line left out."""
    lines = np.fft.rfft(random.standard_normal(round(SECONDS * RATE) + 2 * _SPARE))
    lines[-1] = 0.0
    return np.fft.irfft(lines)


def _finer(values: np.ndarray) -> np.ndarray:
    lines = np.fft.rfft(values)
    full = np.zeros(len(values) * _FINER // 2 + 1, dtype=complex)
    full[: len(lines)] = lines * _FINER
    return np.fft.irfft(full)


def _resonance(natural: float, ratio: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda lines: 1.0 / (1.0 - (lines / natural) ** 2 + 2j * ratio * lines / natural)


def _modal(drive: np.ndarray, response: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    return np.fft.irfft(np.fft.rfft(drive) * response(np.fft.rfftfreq(len(drive), 1.0 / RATE)), len(drive))[:, None]


def _record(random: np.random.Generator, drive: np.ndarray, moved: np.ndarray, noise: float = 0.03) -> Record:
    """The stretch between the spares, with noise as a share of each output's rms."""
    stretch = slice(_SPARE, _SPARE + round(SECONDS * RATE))
    outputs = moved[stretch]
    outputs = outputs + noise * np.std(outputs, axis=0) * random.standard_normal(outputs.shape)
    channels = (Channel("u", "N", Role.INPUT), *(Channel(f"y{index + 1}", "um", Role.OUTPUT) for index in range(outputs.shape[1])))
    return in_memory(channels, RATE, np.column_stack([drive[stretch], outputs]))
