"""Performance of a controller of any kind from frequency responses: fast enough for searches and trade-off curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.systems.closed import pose_controller
from flexstage.control.systems.system import System
from flexstage.control.tuning.judge import first_rise, highest_gain
from flexstage.control.tuning.search import Field

_BAND = 0.02
"""Settling band of steps."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """Performance of a controller: `peaks` (v,) of the sensitivity for the v variants of a field, other values for each of k loops.

    `rejection` (2, k) [Hz] contains the sensitivity crossover of the model, then the lowest crossover for mode shifts within the spread.
    `noise` [m] is the rms noise in regulation, `floor` [m] the contribution of the floor. `settling` [s] (2 %) and `overshoot` are the
    largest values for mode shifts within the spread; `delay_margin` [s] is that of the model.
    """

    peaks: Array
    rejection: Array
    noise: Array
    floor: Array
    settling: Array
    overshoot: Array
    delay_margin: Array


def outcome(within: Field, control: System, gain: float = 1.0) -> Outcome:
    """Evaluate a stable loop with the controller's output multiplied by `gain`; stability is not checked.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.search import field
    >>> from flexstage.control.tuning.view import view
    >>> from flexstage.control.tuning.laws import PI_FAMILY
    >>> from flexstage.control.tuning.spec import TuningSpec
    >>> closed = integral_loop(gain=100.0)
    >>> seen = view(closed.plant, platform_loops(closed.plant.coordinates), 0.0)
    >>> found = outcome(field(seen, TuningSpec(PI_FAMILY, spread=0.0)), closed.controller)
    >>> bool(found.peaks[0] < 2.0), float(found.overshoot[0].round(2)), bool(found.settling[0] < 0.06)
    (True, 0.0, True)
    """
    count, coordinates = len(within.seen.loops.names), within.seen.loops.coordinates
    entered, eye = pose_controller(control, coordinates, within.seen.loops.sense), np.eye(count)
    every = gain * entered.sweep(within.frequencies.ravel(), slice(count)).reshape(*within.frequencies.shape, -1, count)
    opened = within.strokes @ every
    left = np.linalg.inv(eye + opened)
    slow = gain * entered.sweep(within.lines[1:])
    following = np.linalg.solve(eye + within.slow_strokes @ slow[..., :count], within.slow_strokes @ slow[..., count:])
    steps, interval = _steps(np.einsum("whkk->whk", following)), 0.5 / float(within.lines[-1])
    lengths = coordinates.scale[:, None] * np.linalg.inv(within.seen.loops.sense)
    shaken = np.sum(np.abs(left[0] @ within.disturbed) ** 2, axis=(0, 2))
    heard = np.sum(np.abs((eye - left[0]) * within.heard[:, None, :]) ** 2, axis=(0, 2))
    own = np.einsum("vfkk->vfk", left)
    far = np.array([[first_rise(np.abs(own[v, :, k]), within.frequencies[v]) for k in range(count)] for v in within.spread])
    return Outcome(
        peaks=np.array([highest_gain(each)[0] for each in lengths @ left @ np.linalg.inv(lengths)]),
        rejection=np.stack([far[0], np.min(far, axis=0)]),
        noise=np.sqrt(shaken + heard),
        floor=np.sqrt(shaken),
        settling=np.max(_settling(steps), axis=0) * interval,
        overshoot=np.max(steps, axis=(0, 1)) - 1.0,
        delay_margin=np.array([_delay_margin(1.0 / own[0, :, k] - 1.0, within.frequencies[0]) for k in range(count)]),
    )


def _steps(following: Array) -> Array:
    """Step responses (w, n, k) for complementary sensitivities (w, h, k), within a period of the lines."""
    whole = np.concatenate([np.ones((len(following), 1, following.shape[-1])), following], axis=1)
    return np.cumsum(np.fft.irfft(whole, axis=1), axis=1)


def _settling(steps: Array) -> Array:
    """Settling time of steps (w, n, k) within 2 %, in samples, linearly interpolated."""
    off = np.abs(steps - 1.0)
    last = np.max(np.where(off > _BAND, np.arange(steps.shape[1])[:, None], -1), axis=1)
    ends = [np.take_along_axis(off, np.clip(last + by, 0, steps.shape[1] - 1)[:, None], axis=1)[:, 0] for by in (0, 1)]
    return np.where(last < 0, 0.0, last + np.clip((ends[0] - _BAND) / np.maximum(ends[0] - ends[1], 1e-300), 0.0, 1.0))


def _delay_margin(opened: Array, frequencies: Array) -> float:
    """Smallest delay that moves L with gain 1 to -1, linearly interpolated."""
    sizes, turn = np.log(np.abs(opened)), np.unwrap(np.angle(opened))
    places = np.flatnonzero(sizes[1:] * sizes[:-1] <= 0.0)
    share = sizes[places] / (sizes[places] - sizes[places + 1])
    angle = turn[places] + share * (turn[places + 1] - turn[places])
    at = frequencies[places] + share * (frequencies[places + 1] - frequencies[places])
    return float(np.min(np.mod(angle + np.pi, 2.0 * np.pi) / (2.0 * np.pi * at), initial=np.inf))
