"""Peaks of frequency responses (H-infinity norms), by the eigenvalues of a Hamiltonian matrix."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.units.quantity import FREQUENCY
from flexstage.control.systems.system import System

_NEAR_AXIS = 1e-3
"""Limit of the real over imaginary part of an eigenvalue on the axis: generous, because all candidates are checked."""
_ACCURACY = 1e-11
_APART = 1e-6
"""Distance of a level above the value at the end of the frequency range, where the Hamiltonian matrix is unbounded."""


@dataclass(frozen=True)
class Peak:
    """Largest value of a response (largest singular value of a matrix) and its frequency [Hz]."""

    value: float
    frequency: Annotated[float, FREQUENCY]


def peak(system: System) -> Peak:
    """Compute the H-infinity norm of a stable system H (supremum of its largest singular value) with the relative accuracy 1e-9.

    The accuracy is only 1e-6 if the peak is less than 1e-6 above the value at half the sampling rate (for a continuous system: the direct
    gain). A number gamma is a singular value of H at some frequency if and only if the Hamiltonian matrix of gamma has an eigenvalue on the
    imaginary axis (Bruinsma and Steinbuch, Systems & Control Letters 14, 1990). No peak between frequencies is therefore missed. Sampled
    systems are mapped by z = (1 + s)/(1 - s), which preserves the norm. Raises `DesignError` for an unstable system, which has no steady
    response.

    >>> from flexstage.models.linear.model import Channel
    >>> metre = (Channel("u", "m"),), (Channel("y", "m"),)
    >>> resonance = System(np.array([[0.0, 1.0], [-1.0, -0.2]]), np.eye(2)[:, 1:], np.eye(2)[:1], np.zeros((1, 1)), *metre)
    >>> round(peak(resonance).value, 9), round(0.5 / (0.1 * 0.99**0.5), 9)  # 1/(2 zeta (1 - zeta^2)^(1/2))
    (5.025189076, 5.025189076)
    """
    if system.growth >= 0.0:
        raise refuse("peak", f"the system is unstable (growth rate {system.growth:.3g} 1/s)", "Stabilise the system first")
    plane = to_plane(system)
    poles, step = system.poles, system.step
    end, own, turn = (np.inf, poles, 2.0 * np.pi) if step is None else (0.5 / step, np.angle(poles), 2.0 * np.pi * step)
    best = _highest_of(system, np.concatenate([[0.0, end], np.abs(own) / turn]))
    least = (1.0 + _APART) * float(np.linalg.norm(plane.system.D, 2))
    for _ in range(30):
        crossings = level_crossings(plane, max(best.value * (1.0 + _ACCURACY), least)) if best.value > 0.0 else np.zeros(0)
        between = 0.5 * (crossings[1:] + crossings[:-1])
        found = _climb(system, _highest_of(system, np.concatenate([crossings, between, [best.frequency]])))
        if found.value <= best.value * (1.0 + _ACCURACY):
            return found if found.value > best.value else best
        best = found
    return best


@dataclass(frozen=True, eq=False)
class Plane:
    """Continuous `system` whose response at s = j nu equals the response of an original system at the frequency f.

    For a continuous original, nu = 2 pi f/`unit`. For an original sampled every T = `step` [s], nu = tan(pi f T).
    """

    system: System
    unit: float
    step: float | None

    def frequencies(self, numbers: Array) -> Array:
        """Convert the mapped frequencies nu to frequencies [Hz]."""
        if self.step is None:
            return numbers * self.unit / (2.0 * np.pi)
        return np.arctan(numbers) / (np.pi * self.step)


def to_plane(system: System) -> Plane:
    """Map a system to a balanced continuous system: by z = (1 + s)/(1 - s) if it is sampled, otherwise by scaling of time.

    >>> from flexstage.control.example import integral_loop
    >>> one = integral_loop().system
    >>> plane, far = to_plane(one), np.array([70.0])
    >>> there = plane.system.transfer(np.tan(np.pi * far * one.step) / (2.0 * np.pi))
    >>> bool(np.allclose(there, one.transfer(far)))
    True
    """
    if system.step is None:
        unit = np.sqrt(np.mean(np.abs(system.poles) ** 2)) or 1.0 if len(system.A) else 1.0
        moved = replace(system, A=system.A / unit, B=system.B / unit)
    else:
        unit, inverse = 1.0, np.linalg.inv(system.A + np.eye(len(system.A)))
        B, C = np.sqrt(2.0) * inverse @ system.B, np.sqrt(2.0) * system.C @ inverse
        A = inverse @ (system.A - np.eye(len(system.A)))
        moved = replace(system, A=A, B=B, C=C, D=system.D - system.C @ inverse @ system.B, step=None)
    return Plane(_balance(moved), unit, system.step)


def _balance(system: System) -> System:
    """Scale the states so that rows and columns have similar norms, inputs and outputs included."""
    size = len(system.A)
    if not size:
        return system
    entry, exit_ = (np.max(np.abs(each), axis=axis, initial=0.0) for each, axis in ((system.B, 1), (system.C, 0)))
    whole = np.block([[system.A, entry[:, None]], [exit_[None], np.zeros((1, 1))]])
    _, (scale, _) = scipy.linalg.matrix_balance(whole, permute=False, separate=True)
    scale = scale[:size] / scale[size]
    return replace(system, A=system.A * scale / scale[:, None], B=system.B / scale[:, None], C=system.C * scale)


def level_crossings(plane: Plane, level: float) -> Array:
    """Find ascending frequencies [Hz] at which a singular value may cross `level`: all true crossings, possibly also other points.

    >>> from flexstage.models.linear.model import Channel
    >>> metre = (Channel("u", "m"),), (Channel("y", "m"),)
    >>> lag = System(-np.eye(1), np.eye(1), np.eye(1), np.zeros((1, 1)), *metre)  # 1/(1 + s) has the size 1/2 at omega = 3^(1/2)
    >>> (2.0 * np.pi * level_crossings(to_plane(lag), 0.5)).round(9).tolist()
    [1.732050808]
    """
    A, B, C, D = plane.system.A, plane.system.B, plane.system.C, plane.system.D
    inner = level**2 * np.eye(D.shape[1]) - D.T @ D
    outer = level**2 * np.eye(D.shape[0]) - D @ D.T
    mixed = A + B @ np.linalg.solve(inner, D.T @ C)
    upper, lower = B @ np.linalg.solve(inner, B.T), level**2 * C.T @ np.linalg.solve(outer, C)
    found = np.linalg.eigvals(np.block([[mixed, upper], [-lower, -mixed.T]]))
    near = np.abs(np.real(found)) <= _NEAR_AXIS * np.abs(found)
    return plane.frequencies(np.unique(np.abs(np.imag(found))[near]))


def _sizes(system: System, frequencies: Array) -> Array:
    return np.linalg.svd(system.sweep(frequencies), compute_uv=False)[:, 0]


def _highest_of(system: System, frequencies: Array) -> Peak:
    sizes = _sizes(system, frequencies)
    place = np.argmax(sizes)
    return Peak(float(sizes[place]), float(frequencies[place]))


def _climb(system: System, start: Peak) -> Peak:
    """The same peak, refined by parabolas of decreasing width."""
    if not np.isfinite(start.frequency) or start.frequency == 0.0:
        return start
    best, width = start, 1e-3 * start.frequency
    end = np.inf if system.step is None else 0.5 / system.step
    for _ in range(12):
        places = best.frequency + width * np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
        sizes = _sizes(system, np.clip(places, 0.0, end))
        bend, slope, _ = np.polyfit(np.arange(-2, 3), sizes / sizes[2], 2)
        top = best.frequency - 0.25 * width * slope / bend if bend < 0.0 else best.frequency
        found = _highest_of(system, np.clip(np.append(places, top), 0.0, end))
        best, width = (found if found.value > best.value else best), 0.3 * width
    return best
