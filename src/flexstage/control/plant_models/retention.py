"""Retention of modes in a plant, by loop gain with the controller, and by their effect on margins and steps."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import compress
from typing import Annotated

import numpy as np

from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW
from flexstage.base.units.quantity import FREQUENCY
from flexstage.control.plant_models.electronics import Hardware
from flexstage.control.plant_models.plants import Plant
from flexstage.control.plant_models.reduction import mode_names
from flexstage.control.robustness.response_margins import LoopLines, ResponseMargins
from flexstage.control.systems.closed import Loop, pose_controller
from flexstage.control.systems.curves import dense_frequencies
from flexstage.control.systems.sampling import split_delay
from flexstage.control.systems.system import select
from flexstage.spatial.frame import COMPONENTS

LOOP_GAINS = (0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0)
"""Thresholds of loop gain for retention: the first value, or, if no mode reaches it, the highest value that preserves the margins."""
MARGIN_CHANGE = 0.01
"""Largest permitted relative change of the margins due to all omitted modes together."""
RINGING = 0.001
"""Ringing along any axis, relative to the step, above which a mode is not omitted: 1/20 of the settling band of 2 %."""
_LEAST = 0.01
"""Gain margins are compared as 1/k, for factors up to 100; beyond, no loop is near its stability limit."""
_PLAIN = 400
_UNDERDAMPED = 1e-3


@dataclass(frozen=True, eq=False)
class Retention:
    """Modes retained in the plant, `retained` of `total`; the static compliance of the other modes is kept.

    `gain` is the largest loop gain of an omitted mode at its resonance (`frequency` [Hz]), with all loops closed. `change` is the largest
    relative change of peak sensitivity, margins and rejection that the omitted modes cause together. `wanted` (k,) marks the modes to
    retain. `retune` is true if some modes must be added because of loop gain or margins, not only because of ringing after a step.
    """

    retained: int
    total: int
    gain: float
    frequency: Annotated[float | None, FREQUENCY]
    change: float
    wanted: Annotated[Array, INNER]
    retune: Annotated[bool, INNER] = False

    @property
    def complete(self) -> Annotated[bool, VIEW]:
        """Whether the plant retains all significant modes."""
        return int(np.sum(self.wanted)) <= self.retained


def retention(whole: Plant, closed: Loop) -> Retention:
    """Find the significant modes of a `whole` plant; `closed` is the loop with a subset of its modes and the present controller.

    An omitted mode is significant if it meets one of three criteria. By the first criterion, the mode's loop gain at resonance, with other
    loops and axes closed, is at least 0.1. The mode has the pulse transfer function a b psi(z), with the vectors a to the pose and b from
    the commands. Its loop gain is |a| |psi| |b K S|, where K is the controller and S the sensitivity. The loop gain includes hold and
    sampling exactly, also above half the sampling rate. By the second criterion, the mode makes the true platform motion ring by at least
    `RINGING` along any axis after a step. The third criterion applies if no mode meets the first: modes are added by decreasing loop gain
    until the remaining modes change no margin by more than `MARGIN_CHANGE`.

    >>> from flexstage.control.systems.closed import loop
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.plant_models.reduction import reduce_modes
    >>> closed = integral_loop()
    >>> one = loop(reduce_modes(closed.plant, np.zeros(3, bool)), closed.controller)
    >>> found = retention(closed.plant, one)
    >>> (found.retained, found.total, found.complete)
    (1, 3, True)
    """
    names = mode_names(whole)
    kept = np.isin(names, closed.plant.states)
    if np.all(kept):
        return Retention(len(names), len(names), 0.0, None, 0.0, kept)
    left_out = _contributions(whole, kept, closed)
    chosen, change = _choose(left_out)
    retune = bool(np.any(chosen))
    chosen |= left_out.rings >= RINGING
    wanted = kept.copy()
    wanted[~kept] = chosen
    rest = np.where(chosen, 0.0, left_out.gains)
    largest = np.argmax(rest)
    frequency = None if np.all(chosen) else float(whole.frequencies[~kept][largest])
    return Retention(int(np.sum(kept)), len(names), float(rest[largest]), frequency, change, wanted, retune)


@dataclass(frozen=True, eq=False)
class _Contributions:
    """Effects of omitted modes (d,) in a loop: `gains` at resonance, and `rings` in a step.

    `plant` (f, c, n) is the response of the retained part from commands to pose. `poles` belong to the omitted modes. `held` (2, f, d) are
    their sampled responses behind the hold, less the static term, and the conjugates.
    """

    lines: LoopLines
    plant: Array
    pose: Array
    poles: _Poles
    held: Array
    gains: Array
    rings: Array

    def margins(self, chosen: Array) -> ResponseMargins:
        """Margins including the `chosen` modes."""
        outer = (self.poles.pose(self.pose)[:, :, None] * self.poles.entries[:, None, :]).reshape(len(chosen), -1)
        change = (self.held[0] * chosen) @ outer + (self.held[1] * chosen) @ np.conj(outer)
        return self.lines.margins(self.plant + change.reshape(self.plant.shape))


def _contributions(whole: Plant, kept: Array, closed: Loop) -> _Contributions:
    poles, loop, hardware = _left_out(whole, kept), closed.plant.coordinates, whole.hardware
    own, step = np.abs(np.imag(poles.values)) / (2.0 * np.pi), hardware.step
    own = own if step is None else np.abs(own - np.round(own * step) / step)  # aliases after sampling
    lines = _lines(closed, poles.values)
    lines = np.unique(np.concatenate([lines, own[own > lines[0]]]))
    place = np.clip(np.searchsorted(lines, own), 0, len(lines) - 1)
    feedback, reference = np.split(pose_controller(closed.controller, loop).sweep(lines), 2, axis=2)
    seen = LoopLines(lines, loop.scale, feedback)
    plant = loop.pose @ select(closed.held, loop.actuators, loop.gaps).sweep(lines)
    back = feedback @ seen.sensitivity(plant)
    forward = reference - back @ plant @ reference
    every = (_held(values, np.append(lines, 0.0), hardware) for values in (poles.values, np.conj(poles.values)))
    held = np.stack([each[:-1] - each[-1] for each in every])
    peaks = np.max(np.abs(held[:, place, np.arange(len(own))]), axis=0)
    driven = [np.linalg.norm(np.einsum("dn,dnc->dc", poles.entries, each[place]) / loop.scale, axis=1) for each in (back, forward)]
    seen_as = np.linalg.norm(poles.pose(loop.pose) * loop.scale, axis=1)
    lengths = np.array([loop.length if each[0] == "r" else 1.0 for each in COMPONENTS])
    moved = np.linalg.norm(poles.exits[:, len(loop.gauges) :] * lengths, axis=1)
    decay = 2.0 * np.abs(np.real(poles.values)) / np.abs(poles.values)
    return _Contributions(seen, plant, loop.pose, poles, held, peaks * seen_as * driven[0], peaks * moved * driven[1] * decay)


def _choose(given: _Contributions) -> tuple[Array, float]:
    """Modes (d,) to add, and the change of margins by the others: modes of loop gain 0.1, else as many as margins require."""
    truth = _figures(given.margins(np.ones(len(given.gains), bool)))
    chosen, change = np.zeros(len(given.gains), bool), np.inf
    for least in LOOP_GAINS:
        chosen = given.gains >= least
        change = _change(_figures(given.margins(chosen)), truth)
        if change <= MARGIN_CHANGE or np.any(given.gains >= LOOP_GAINS[0]):
            break
    return chosen, change


@dataclass(frozen=True, eq=False)
class _Poles:
    """Poles (d,) [1/s] of modes, one of each pair, with residues exits (d, p) times entries (d, n), which sum to H."""

    values: Array
    exits: Array
    entries: Array

    def pose(self, pose: Array) -> Array:
        """Residues (d, c) at the pose, from the gauges (the first exits)."""
        return self.exits[:, : pose.shape[1]] @ pose.T


def _left_out(whole: Plant, kept: Array) -> _Poles:
    """Poles of omitted modes, each by itself next to all retained parts: amplifiers, gauges, inner loops and modes."""
    outputs = [*whole.coordinates.gaps, *(f"relative.{name}" for name in COMPONENTS)]
    system, width = select(whole.system, whole.actuators, outputs), len(whole.actuators)
    balanced, entry, exit_, scale = system.balanced
    places = np.array([[whole.states.index(f"{name}{mark}") for mark in ("", "'")] for name in compress(mode_names(whole), ~kept)])
    beside = np.setdiff1d(np.arange(len(system.A)), places.ravel())
    inner, driven, seen = balanced[np.ix_(beside, beside)], entry[beside], exit_[:, beside]
    values, exits, entries = [], [], []
    for place in places:
        square, rate = -system.A[place[1], place[0]], -system.A[place[1], place[1]]
        pole = -0.5 * rate + 1j * np.sqrt(max(square - 0.25 * rate**2, _UNDERDAMPED * square))
        right = np.array([1.0, pole]) / scale[place]
        left = np.array([-np.conj(pole), 1.0]) * scale[place] / (2j * np.imag(pole))
        carried = balanced[np.ix_(beside, place)] @ right
        solved = np.linalg.solve(pole * np.eye(len(beside)) - inner, np.column_stack([driven, carried]))
        force = left @ balanced[np.ix_(place, beside)]
        values.append(pole + force @ solved[:, width])
        entries.append(left @ entry[place] + force @ solved[:, :width])
        exits.append(exit_[:, place] @ right + seen @ solved[:, width])
    return _Poles(np.array(values), np.array(exits), np.array(entries))


def _held(poles: Array, lines: Array, hardware: Hardware) -> Array:
    """Pulse transfer functions psi (f, d) of 1/(s - p) behind hold and delay at `lines` [Hz]; 1/(s - p) for a continuous plant.

    With the delay (d + f) T it is z^-d (Gamma_0 + Gamma_1 / z) / (z - e^{pT}), as in `discretise`.
    """
    step, turning = hardware.step, 2j * np.pi * lines[:, None]
    if step is None:
        return 1.0 / (turning - poles)
    z = np.exp(turning * step)
    whole, part = split_delay(hardware.delay / step)
    late = np.exp(poles * (1.0 - part) * step)
    now, before = (late - 1.0) / poles, late * (np.exp(poles * part * step) - 1.0) / poles
    return z**-whole * (now + before / z) / (z - np.exp(poles * step))


def _lines(closed: Loop, poles: Array) -> Array:
    """Frequencies [Hz] around all poles of the loop and of omitted modes, and logarithmically spaced between."""
    step = closed.step
    seen = poles if step is None else np.exp(poles * step)
    dense = dense_frequencies(np.concatenate([closed.system.poles, closed.held.poles, seen]), step)
    return np.union1d(dense, np.geomspace(dense[0], dense[-1], _PLAIN))


def _figures(found: ResponseMargins) -> Array:
    """Margins as numbers for relative comparison."""
    factors = np.maximum([*found.lows, *(1.0 / np.array(found.gains))], _LEAST)
    return np.array([found.peak, *factors, *found.phases, *found.delays, *found.rejections])


def _change(found: Array, truth: Array) -> float:
    """Largest relative difference; infinite if only one has a limit."""
    finite = np.isfinite(truth)
    if np.any(finite != np.isfinite(found)):
        return np.inf
    return float(np.max(np.abs(found[finite] / truth[finite] - 1.0), initial=0.0))
