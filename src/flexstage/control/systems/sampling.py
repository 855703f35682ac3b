"""Sampling of continuous systems between a digital-to-analogue converter and a sampler."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import scipy

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.control.systems.system import System


def discretise(system: System, step: float, delay: float = 0.0, early: int = 0) -> System:
    """Discretise a continuous system by zero-order hold with `step` [s] and input `delay` [s]; exact at the samples.

    For the step T and the delay (d + f) T, with an integer d and 0 <= f < 1, the input changes within the step: x[k+1] = e^{AT} x[k] +
    Gamma_1 u[k-d-1] + Gamma_0 u[k-d], Gamma_0 = int_0^{(1-f)T} e^{As} ds B, Gamma_1 = e^{A(1-f)T} int_0^{fT} e^{As} ds B (Astrom and
    Wittenmark, Computer-Controlled Systems, 1997, section 2.3). If f = 0, the input changes at a sample. The first `early` outputs then
    have the value before this change, all other outputs the value after it. All inputs have the same delay. Raises `DesignError` for a
    sampled system, and for invalid times.

    >>> from flexstage.models.linear.model import Channel
    >>> metre = (Channel("u", "m"),), (Channel("y", "m"),)
    >>> lag = System(-np.eye(1), np.eye(1), np.eye(1), np.zeros((1, 1)), *metre)
    >>> found = discretise(lag, np.log(2.0))
    >>> found.A.round(12).tolist(), found.B.round(12).tolist()
    ([[0.5]], [[0.5]])
    >>> len(discretise(lag, 0.1, delay=0.25).A)  # the state, and three past inputs
    4
    """
    require(_findings(system, step, delay))
    whole, part = split_delay(delay / step)
    after, start = _hold_matrices(system, (1.0 - part) * step)
    late, before = _hold_matrices(system, part * step)
    (size, width), seen = system.B.shape, whole + (part > 0.0)
    count = whole + 1 if np.any(system.D[:early]) else seen
    entries, direct = np.zeros((size, count + 1, width)), np.zeros((len(system.D), count + 1, width))  # blocks of u[k], u[k-1], ...
    entries[:, whole] = start
    if part > 0.0:
        entries[:, whole + 1] = after @ before
    direct[early:, seen], direct[:early, count] = system.D[early:], system.D[:early]
    entries, direct = (each.reshape(len(each), (count + 1) * width) for each in (entries, direct))
    shift = np.hstack([np.zeros((count * width, size)), np.eye(count * width, k=-width)])
    return replace(
        system,
        A=np.vstack([np.hstack([after @ late, entries[:, width:]]), shift]),
        B=np.vstack([entries[:, :width], np.eye(count * width, width)]),
        C=np.hstack([system.C, direct[:, width:]]),
        D=direct[:, :width],
        step=step,
    )


def first_order_hold(system: System, step: float) -> System:
    """Discretise a continuous system by first-order hold (inputs linear between samples), with `step` [s]; exact at the samples.

    x[k+1] = e^{AT} x[k] + (Gamma - Gamma_1) u[k] + Gamma_1 u[k+1], Gamma_1 = int_0^T e^{A(T-s)} (s/T) ds B (Franklin, Powell and Workman,
    Digital Control of Dynamic Systems, 1998, section 6.3.2). The result has the states x[k] - Gamma_1 u[k], because x[k+1] requires the
    future input u[k+1]. For smooth inputs such as floor motion at the angular frequency omega, the relative error is (omega T)^2/12,
    without the jumps of a zero-order hold. For motion relative to the floor, the relative error is (omega_0 T)^2/12 with the resonance
    omega_0, about 1e-3 for omega_0 T = 0.1. T is the step. Raises `DesignError` for a sampled system, and for invalid times.

    >>> from flexstage.models.linear.model import Channel
    >>> metre = (Channel("u", "m"),), (Channel("y", "m"),)
    >>> integrator = System(np.zeros((1, 1)), np.eye(1), np.eye(1), np.zeros((1, 1)), *metre)
    >>> found = first_order_hold(integrator, 0.1)
    >>> found.B.round(12).tolist(), found.D.round(12).tolist()  # the trapezoidal rule
    ([[0.1]], [[0.05]])
    """
    require(_findings(system, step))
    size, width = system.B.shape
    upper = np.hstack([system.A * step, system.B * step])
    whole = np.pad(scipy.linalg.block_diag(upper, np.eye(width)), ((0, width), (0, 0)))
    A, gamma, ramp = np.split(scipy.linalg.expm(whole)[:size], [size, size + width], axis=1)
    return replace(system, A=A, B=gamma - ramp + A @ ramp, D=system.D + system.C @ ramp, step=step)


def split_delay(samples: float) -> tuple[int, float]:
    """Split a delay [samples] into whole samples and the remainder; a remainder of the size of rounding errors is 0."""
    nearest_whole = round(samples)
    if abs(samples - nearest_whole) < 1e-9:
        return nearest_whole, 0.0
    return int(np.floor(samples)), samples - np.floor(samples)


def _hold_matrices(system: System, time: float) -> tuple[Array, Array]:
    """Matrices e^{At} and int_0^t e^{As} ds B."""
    size, width = system.B.shape
    whole = np.pad(np.hstack([system.A, system.B]), ((0, width), (0, 0)))
    found = scipy.linalg.expm(whole * time)
    return found[:size, :size], found[:size, size:]


def bilinear(system: System, step: float, prewarp: float | None = None) -> System:
    """Discretise a continuous controller by Tustin's rule (bilinear), s = c (z - 1)/(z + 1), c = 2/T, T = `step`.

    With `prewarp` f [Hz], c = 2 pi f / tan(pi f T): the response at f is exact. Poles in the left half plane stay stable. Raises
    `DesignError` for a sampled system, and for `prewarp` above half the sampling rate.

    >>> from flexstage.models.linear.model import Channel
    >>> metre = (Channel("e", "m"),), (Channel("u", "m"),)
    >>> integrator = System(np.zeros((1, 1)), np.eye(1), np.eye(1), np.zeros((1, 1)), *metre)
    >>> found = bilinear(integrator, 0.1)
    >>> found.A.tolist(), found.D.round(12).tolist()  # the trapezoidal rule: half a step at once
    ([[1.0]], [[0.05]])
    """
    require(_findings(system, step))
    if prewarp is not None and not 0.0 < prewarp < 0.5 / step:
        what = f"{prewarp:g} Hz is not between 0 and half the sampling rate, {0.5 / step:g} Hz"
        raise refuse("prewarp", what, "Choose a lower frequency, or sample faster")
    factor = 2.0 / step if prewarp is None else 2.0 * np.pi * prewarp / np.tan(np.pi * prewarp * step)
    identity = np.eye(len(system.A))
    inverse = np.linalg.inv(factor * identity - system.A)
    return replace(
        system,
        A=inverse @ (factor * identity + system.A),
        B=2.0 * factor * inverse @ system.B,
        C=system.C @ inverse,
        D=system.D + system.C @ inverse @ system.B,
        step=step,
    )


def _findings(system: System, step: float, delay: float = 0.0) -> Iterator[Finding]:
    if system.step is not None:
        yield Finding("system", f"already sampled, every {system.step:g} s", "Use a continuous system")
    if not 0.0 < step < np.inf:
        yield Finding("step", f"must be positive (got {step:g} s)", "Use a positive time")
    if not 0.0 <= delay < np.inf:
        yield Finding("delay", f"must be 0 or more (got {delay:g} s)", "Use a time of 0 or more")
