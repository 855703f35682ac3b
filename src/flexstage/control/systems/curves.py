"""Sensitivities of a loop on a frequency grid that resolves all resonances, and frequencies at which they cross a value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.control.systems.closed import Loop, LoopBreak, open_at
from flexstage.control.systems.system import System

_OFFSETS = np.array([-81.0, -27.0, -9.0, -3.0, -1.0, 0.0, 1.0, 3.0, 9.0, 27.0, 81.0])
_PER_DECADE = 12
_TURN, _GROWTH = 0.6, 1.0
"""Largest change of a loop's angle [rad], and of the logarithm of its magnitude, between adjacent frequencies."""
_ROUNDS, _MOST = 8, 20_000


@dataclass(frozen=True, eq=False)
class Curves:
    """Sensitivity S = (I + L)^-1 of a loop opened at `cut`, complex (f, n, n) over `frequencies` (f,) [Hz].

    The open loop of channel i, with the other loops closed, is L_i = 1/S_ii - 1. `response` evaluates S at any frequency.
    """

    cut: LoopBreak
    names: tuple[str, ...]
    frequencies: Array
    sensitivity: Array
    response: System

    @property
    def loops(self) -> Array:
        """Loop transfer functions L_i (f, n), complex: each loop is opened singly, with all others closed."""
        own = np.diagonal(self.sensitivity, axis1=1, axis2=2)
        return np.where(own == 0.0, np.inf, 1.0 / np.where(own == 0.0, 1.0, own) - 1.0)

    def crossings(self, of: Callable[[Array], Array], channel: int) -> tuple[Array, Array]:
        """Find the frequencies [Hz] at which `of`, a real function of a channel's S_ii, changes sign; also return S_ii there."""
        values = of(self.sensitivity[:, channel, channel])
        places = sign_changes(values)
        low, high = self.frequencies[places], self.frequencies[places + 1]
        ends = (low, high), (values[places], values[places + 1])
        found = roots(lambda points: of(self.response.sweep(points)[:, channel, channel]), *ends)
        return found, self.response.sweep(found)[:, channel, channel]


def sensitivity(open_loop: System) -> System:
    """Return S = (I + L)^-1 as a system; its inputs and outputs have the names of L's outputs.

    >>> from flexstage.control.example import integral_loop
    >>> found, far = open_at(integral_loop(), LoopBreak.POSE), np.array([40.0])
    >>> bool(np.allclose(sensitivity(found).transfer(far) * (1.0 + found.transfer(far)), 1.0))
    True
    """
    inverse = np.linalg.inv(np.eye(len(open_loop.D)) + open_loop.D)
    B, C = open_loop.B @ inverse, -inverse @ open_loop.C
    return replace(open_loop, A=open_loop.A + B @ -open_loop.C, B=B, C=C, D=inverse, inputs=open_loop.outputs)


def curves(closed: Loop, cut: LoopBreak) -> Curves:
    """Compute S at frequencies around every pole of the closed loop and of each single open loop, refined until every L_i is smooth.

    The highest frequency is half the sampling rate. For a continuous loop, the highest frequency is 100 times that of the fastest pole.

    >>> from flexstage.control.example import integral_loop
    >>> found = curves(integral_loop(), LoopBreak.POSE)
    >>> found.names, bool(np.max(np.abs(np.diff(np.angle(found.loops[:, 0])) % (2.0 * np.pi) - np.pi)) > np.pi - 0.7)
    (('x',), True)
    """
    whole = sensitivity(open_at(closed, cut))
    names = tuple(name.removeprefix(f"{cut.value}.") for name in whole.output_names)
    poles = [whole.poles, *(open_at(closed, cut, name).poles for name in names)]
    frequencies = dense_frequencies(np.concatenate(poles), whole.step)
    found = Curves(cut, names, frequencies, whole.sweep(frequencies), whole)
    for _ in range(_ROUNDS):
        between = refine(found)
        if not len(between) or len(found.frequencies) > _MOST:
            break
        places = np.searchsorted(found.frequencies, between)
        refined = np.insert(found.sensitivity, places, whole.sweep(between), axis=0)
        found = replace(found, frequencies=np.insert(found.frequencies, places, between), sensitivity=refined)
    return found


def rates_of(poles: Array, step: float | None, least: float = 1e-6) -> Array:
    """Convert poles to rates [1/s]: poles are unchanged, or for a sampled system ln(z)/T (a pole z = 0 becomes a fast pole).

    >>> rates_of(np.array([np.exp(-0.5)]), 0.1).round(9).tolist()
    [(-5+0j)]
    """
    return poles.astype(complex) if step is None else np.log(np.where(np.abs(poles) > least, poles, least).astype(complex)) / step


def points_around(rates: Array) -> Array:
    """Return frequencies [Hz] around each resonance at multiples of its half width (above 50 % damping only the natural frequency).

    >>> points_around(np.array([-1.0 + 100.0j])).round(3)[4:7].tolist()  # 100/(2 pi), and 1/(2 pi) either side
    [15.756, 15.915, 16.075]
    """
    natural, width = np.abs(np.imag(rates)) / (2.0 * np.pi), np.maximum(np.abs(np.real(rates)), 1e-9 * np.abs(rates)) / (2.0 * np.pi)
    sharp = width < 0.5 * np.hypot(natural, width)
    spread = natural[sharp, None] + width[sharp, None] * _OFFSETS
    return np.concatenate([spread.ravel(), np.hypot(natural, width)[~sharp]])


def dense_frequencies(poles: Array, step: float | None) -> Array:
    """Return frequencies [Hz] that resolve a system with these poles: about 12 per decade, and more around each resonance.

    >>> found = dense_frequencies(np.array([-1.0 + 100.0j, -1.0 - 100.0j]), None)
    >>> round(float(found[0]), 4), round(float(found[-1])), len(found)
    (0.0159, 1592, 73)
    """
    rates = rates_of(poles, step)
    rates = rates[np.abs(rates) > 1e-9 * np.max(np.abs(rates), initial=0.0)]
    natural = np.abs(rates) / (2.0 * np.pi)
    if not len(natural):
        natural = np.array([1.0 if step is None else 0.01 / step])
    end = 100.0 * np.max(natural) if step is None else 0.5 / step
    low = 1e-3 * min(np.min(natural), end)
    coarse = np.geomspace(low, end, 2 + int(_PER_DECADE * np.log10(end / low)))
    near = points_around(rates)
    return np.unique(np.concatenate([coarse, near[(near > low) & (near < end)]]))


def refine(found: Curves) -> Array:
    """Return the midpoints of frequency steps over which the phase or magnitude of a loop changes too much."""
    loops = found.loops
    finite = np.where(np.isfinite(loops) & (loops != 0.0), loops, 1e-300)
    change = np.log(finite[1:] / finite[:-1])
    wild = np.any((np.abs(np.imag(change)) > _TURN) | (np.abs(np.real(change)) > _GROWTH), axis=1)
    wide = np.diff(found.frequencies) > 1e-9 * found.frequencies[1:]
    places = np.flatnonzero(wild & wide)
    return 0.5 * (found.frequencies[places] + found.frequencies[places + 1])


def sign_changes(values: Array) -> Array:
    """Find the indices (k,) before each change of sign; a value of 0 counts as positive.

    >>> sign_changes(np.array([-1.0, 0.0, 2.0, -3.0])).tolist()
    [0, 2]
    """
    return np.flatnonzero((values[1:] >= 0.0) != (values[:-1] >= 0.0))


def roots(of: Callable[[Array], Array], ends: tuple[Array, Array], values: tuple[Array, Array]) -> Array:
    """Find k zeros of a function at once, within brackets `ends` (low, high) at which its `values` have opposite signs.

    The method is the Illinois variant of the false-position method; it is accurate to rounding error.

    >>> roots(lambda x: x**2 - 2.0, (np.array([0.0]), np.array([2.0])), (np.array([-2.0]), np.array([2.0]))).round(12).tolist()
    [1.414213562373]
    """
    (low, high), (below, above) = ends, values
    if not len(low):
        return low
    for _ in range(100):
        differ = above != below
        move = np.where(differ, above * (high - low) / np.where(differ, above - below, 1.0), 0.0)
        if np.all(np.abs(move) <= 2e-16 * np.abs(high)):
            break
        middle = high - move
        found = of(middle)
        crossed = np.sign(found) * np.sign(above) < 0.0
        low, below = np.where(crossed, high, low), np.where(crossed, above, 0.5 * below)
        high, above = middle, found
    return high
