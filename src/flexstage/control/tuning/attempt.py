"""Design attempt at one bandwidth: laws and notches chosen loop by loop, then evaluated together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import TypeAlias

import numpy as np

from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.family import Place
from flexstage.control.controllers.law import Law
from flexstage.control.controllers.lqg import LQG, Disturbances, Weights, estimator, observer_gain, with_observer
from flexstage.control.controllers.notch import Notch, notch_of_mode
from flexstage.control.systems.system import System
from flexstage.control.tuning.judge import crossing_frequency, judge_loop, keeps_peak, own_bandwidths
from flexstage.control.tuning.laws import LQG_FAMILY, PI_FAMILY, PID_FAMILY
from flexstage.control.tuning.spec import Judgement, TuningSpec
from flexstage.control.tuning.view import View, first_alike

_HIGH = 0.3
"""Loop gain at a mode above which the mode gets a notch: below, |S| is at most 1/(1 - 0.3) = 1.43 there."""
_AGREES = 0.005
"""Negligible relative difference of a crossover: half of the bandwidth tolerance of 1 %."""
_TRUST = (1.0, 30.0, 1000.0)
"""Factors on the stroke noise assumed by an observer, in turn: larger values rely less on its model."""
_TRUST_OF_MASS, _MASS = (0.01, 0.3, 10.0), 0.01
"""Factors relative to equal stroke and gauge noise at the bandwidth, for loops whose gain there is below this fraction of the static gain.

The observer then follows a mass: its speed is the square root of the factor times the bandwidth, for any guide stiffness.
"""
_ROUNDS = 8
_AROUND = 4.0
"""Iterations of LQG weights for the loop gain at the bandwidth, and the largest gain ratio used in one iteration."""
_FLATTEST, _STEEPEST, _SAME_WEIGHT = 0.2, 1.5, 1e-4
"""Exponents of the loop gain over its weight, 1 without dynamics, less with roll-off; minimum weight difference for a secant."""
_FARTHEST = 1e4
"""Limit of the weights relative to the first guess, as a factor."""
_EQUAL = 1e-9
"""Relative difference of responses below which loops count as equal: symmetric stages have rounding errors."""
_WRONG = 1e6
"""Score of an invalid loop, far above any peak of S."""
_WIDTHS = (0.4, 0.6, 0.9, 1.4)
"""Damping ratios of the notches' poles tried: the gain is below 0.7 in a band of about twice this fraction of the frequency."""
_UNSTATED = Disturbances(1e-9, {})
"""Default noise of an observer."""
_Options: TypeAlias = tuple[tuple[tuple[Notch, ...], ...], ...]
"""Sets of notches by loop."""


@dataclass(frozen=True, eq=False)
class Attempt:
    """Design attempt of a `trial`: a controller, its notches by loop, and its open-loop responses `gains` (see `open_gains`)."""

    trial: BandwidthTrial
    controller: Decentralised | LQG
    gains: Array
    notches: tuple[tuple[Notch, ...], ...]

    @cached_property
    def system(self) -> System:
        """Controller as a system, sampled like the plant."""
        return self.controller.system(self.trial.seen.step)

    @cached_property
    def judgement(self) -> Judgement:
        """Evaluation of the closed loop."""
        return judge_loop(self.trial.seen, self.system, self.gains)

    def reaches(self) -> bool:
        """Whether the loop is stable with peaks within the limit, and every crossover is within 1 % of the trial's frequency."""
        seen, spec, frequency = self.trial.seen, self.trial.spec, self.trial.frequency
        passed = all(abs(each / frequency - 1.0) < 0.01 for each in own_bandwidths(seen, self.gains))
        return passed and keeps_peak(seen, lambda: self.system, self.gains, spec.sensitivity)


@dataclass(frozen=True, eq=False)
class BandwidthTrial:
    """Design of controllers with the crossover of all loops at a `frequency` [Hz], on the plant `seen`.

    The first attempt has only the specified notches. Further attempts add notches of several widths at modes with a loop gain above 0.3.
    The best law of a loop has the lowest peak of the sensitivity. With the argument `calm` of `reach`, all peaks up to `calm` count as
    equal; the best law then has the highest gain at low frequencies.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.view import first_alike, view
    >>> plant = integral_loop().plant
    >>> seen = view(plant, platform_loops(plant.coordinates), 0.0)
    >>> found = BandwidthTrial(seen, TuningSpec(PI_FAMILY), 20.0).best()
    >>> round(found.judgement.bandwidths[0], 1), found.notches
    (20.0, ((),))
    >>> BandwidthTrial(seen, TuningSpec(PI_FAMILY), 2000.0).reach() is None
    True
    """

    seen: View
    spec: TuningSpec
    frequency: float

    def best(self) -> Attempt | None:
        """Return the first attempt that meets crossover and specification, else the attempt with the best score; None if no law exists."""
        tried: list[Attempt] = []
        for found in self._attempts(0.0):
            if found.reaches():
                return found
            tried.append(found)
        return min(tried, key=lambda each: each.judgement.score, default=None)

    def reach(self, calm: float = 0.0) -> Attempt | None:
        """Return the first attempt that meets frequency and specification, else None; unlike `best`, it does not rank failed attempts."""
        return next((found for found in self._attempts(calm) if found.reaches()), None)

    def _attempts(self, calm: float) -> Iterator[Attempt]:
        """Attempts, simplest first."""
        if self.spec.family == LQG_FAMILY:
            yield from _attempts_lqg(self)
            return
        first = self._decentralised(calm, ((self.spec.notches,),) * len(self.seen.loops.names))
        if first is None:
            return
        yield first
        if self.spec.automatic and self.spec.family.notched:
            every = (self._decentralised(calm, options) for options in _choices(_place_notches(first)))
            yield from (each for each in every if each is not None)

    def _decentralised(self, calm: float, options: _Options) -> Attempt | None:
        """Best law of each loop, and all loops together."""
        seen, found = self.seen, list[_Chosen]()
        for loop in range(len(options)):
            alike = next(other for other in first_alike(seen.own, loop, _EQUAL) if options[other] == options[loop])
            one = found[alike] if alike < loop else self._choose(options[loop], loop, calm)
            if one is None:
                return None
            found.append(one)
        notches = tuple(each.notches for each in found)
        laws = tuple(each.law for each in found)
        controller = Decentralised(seen.loops, laws, notches if any(notches) else (), self.spec.feedforward)
        gains = seen.driven * np.stack([each.response for each in found], axis=-1)[:, None, :]
        return Attempt(self, controller, gains, notches)

    def _choose(self, sets: tuple[tuple[Notch, ...], ...], loop: int, calm: float) -> _Chosen | None:
        """Law and notches of the lowest peak of S, with a stable isolated loop and its crossover at the frequency, for all mode shifts.

        Peaks up to `calm` count as equal; the best then has the highest low-frequency gain, the strongest integrator.
        """
        best, lowest = None, (np.inf, 0.0)
        for each in chain.from_iterable(self._candidates(loop, notches) for notches in sets):
            slack = -float(np.abs(each.response[0])) if calm else 0.0
            score = (max(calm, each.nominal), slack)
            if score < lowest and len(self.seen.offsets) > 1:
                worst = _score(self.seen.frequencies, each.response * self.seen.own[:, :, loop], self.frequency)
                score = (max(score[0], worst), slack)
            if score < lowest:
                best, lowest = each, score
        return best

    def _candidates(self, loop: int, notches: tuple[Notch, ...]) -> tuple[_Chosen, ...]:
        """All laws of the family with these notches, cached for other sets of notches and integrators."""
        if (loop, notches) not in self._known:
            self._known[loop, notches] = tuple(self._new_candidates(loop, notches))
        return self._known[loop, notches]

    def _new_candidates(self, loop: int, notches: tuple[Notch, ...]) -> Iterator[_Chosen]:
        """All laws of the family with these notches."""
        seen, frequency = self.seen, self.frequency
        filters = [_sampled_notch(seen, notch) for notch in notches]
        gain = complex(self._gains[loop]) * complex(np.prod([each.transfer(np.array([frequency]))[0, 0, 0] for each, _ in filters]))
        first = next((each.frequency for each in seen.resonances[loop]), None)
        place = Place(frequency, gain, float(seen.static[loop]), first)
        filtered = np.prod([response for _, response in filters], axis=0) if filters else 1.0
        for law, response in self._responses(place):
            if response is not None:
                whole = response * filtered
                yield _Chosen(law, notches, whole, _score(seen.frequencies, whole * seen.own[:1, :, loop], frequency))

    def _responses(self, place: Place) -> list[tuple[Law, Array | None]]:
        """Laws with their responses (f,), None if too fast for the sampling; PI and PID at one frequency differ only by a factor."""
        laws = self.spec.family.laws(place, self.seen.step)
        if self.spec.family not in (PI_FAMILY, PID_FAMILY):
            return [(law, _sampled_response(law, self.seen)) for law in laws]
        size = 1.0 / abs(place.gain)
        return [(law, None if unit is None else size * unit) for law, unit in zip(laws, self._units, strict=True)]

    @cached_property
    def _units(self) -> list[Array | None]:
        unit = self.spec.family.laws(Place(self.frequency, 1.0, 1.0, None), self.seen.step)
        return [_sampled_response(law, self.seen) for law in unit]

    @cached_property
    def _gains(self) -> Array:
        return self.seen.at(self.frequency)

    @cached_property
    def _known(self) -> dict[tuple[int, tuple[Notch, ...]], tuple[_Chosen, ...]]:
        return {}


def _choices(options: _Options) -> Iterator[_Options]:
    """Individual widths for each loop first; then one width for all, with less coupling on some stages."""
    if options:
        yield options
        for number in range(max(map(len, options))):
            yield tuple(sets[min(number, len(sets) - 1) :][:1] for sets in options)


@dataclass(frozen=True, eq=False)
class _Chosen:
    """Law and notches of a loop, and their `response` (f,) from error to command.

    `nominal` is its score with nominal modes.
    """

    law: Law
    notches: tuple[Notch, ...]
    response: Array
    nominal: float


def _sampled_notch(seen: View, notch: Notch) -> tuple[System, Array]:
    """Sampled notch and its response (f,), cached with the view: a search uses the same modes at every frequency."""
    if notch not in seen.kept:
        found = notch.system(seen.step)
        seen.kept[notch] = found, found.sweep(seen.frequencies)[:, 0, 0]
    return seen.kept[notch]


def _sampled_response(law: Law, seen: View) -> Array | None:
    """Response from error to command, with the pose from the error; None for a law too fast for the sampling."""
    try:
        found = law.system(seen.step)
    except DesignError:
        return None
    entry = found.B[:, [0]] - found.B[:, [1]]
    alone = replace(found, B=entry, D=found.D[:, [0]] - found.D[:, [1]], inputs=found.inputs[:1])
    return alone.sweep(seen.frequencies)[:, 0, 0]


def _score(frequencies: Array, gains: Array, frequency: float) -> float:
    """Worst peak of S of a single loop (v, f) over all mode shifts; the crossover is checked only for the first."""
    if abs(crossing_frequency(frequencies, np.abs(gains[0])) / frequency - 1.0) > _AGREES:
        return 2.0 * _WRONG
    return _WRONG * bool(np.any(_encircles(frequencies, gains))) + float(1.0 / np.min(np.abs(1.0 + gains)))


def _encircles(frequencies: Array, gains: Array) -> Array:
    """Whether curves (..., f) of L encircle -1: the final angle of 1 + L and its crossings of the half turn, with sign.

    L with n poles at 0 starts at -n quarter turns: 3 for a free body with an integrating law, 1 for others.
    """
    angles = np.angle(1.0 + gains)
    jumps = angles[..., 1:] - angles[..., :-1]
    turns = np.count_nonzero(jumps < -np.pi, axis=-1) - np.count_nonzero(jumps > np.pi, axis=-1)
    sizes = np.log(np.abs(gains[..., :2]))
    poles = np.round((sizes[..., 0] - sizes[..., 1]) / np.log(frequencies[1] / frequencies[0]))
    begun = np.round(-0.25 * poles - angles[..., 0] / (2.0 * np.pi))
    return np.abs(angles[..., -1] + 2.0 * np.pi * (turns + begun)) > 1.0


def _place_notches(found: Attempt) -> _Options:
    """By loop, sets of notches of several widths on significant modes above the crossover; empty without any."""
    seen, frequency, gains = found.trial.seen, found.trial.frequency, np.abs(found.gains[0])
    result = []
    for loop, given in enumerate(found.notches):
        own = gains[:, loop, loop]
        added = [
            each
            for each in seen.resonances[loop]
            if each.frequency > frequency and np.interp(each.frequency, seen.frequencies, own) > _HIGH
        ]
        widths = _WIDTHS if added else ()
        result.append(tuple((*given, *(notch_of_mode(each.frequency, each.ratio, width) for each in added)) for width in widths))
    return tuple(sets or (given,) for sets, given in zip(result, found.notches, strict=True)) if any(result) else ()


def _attempts_lqg(trial: BandwidthTrial) -> Iterator[Attempt]:
    """Iterate weights by coordinate until every loop's crossover is at the frequency, with observers of decreasing model confidence."""
    seen, spec, frequency = trial.seen, trial.spec, trial.frequency
    driven = driven_gains(seen, frequency)
    first = wanted = frequency / driven
    for trust in _trusts(seen, spec, frequency, driven):
        design = _designer(seen, spec, trust)
        found, wanted = _balance_bandwidths(seen, design, frequency, wanted, first)
        if found is not None:
            gains = seen.responses @ _strokes(seen, found, design.estimates, seen.frequencies)
            yield Attempt(trial, found, gains, ((),) * len(wanted))


def driven_gains(seen: View, frequency: float) -> Array:
    """Compute the gain (k,) of each loop's pose at a frequency [Hz]: the norm of its responses to all strokes.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.view import first_alike, view
    >>> plant = integral_loop().plant
    >>> driven_gains(view(plant, platform_loops(plant.coordinates), 0.0), 1.0).round(2).tolist()
    [0.99]
    """
    return np.linalg.norm(seen.loops.sense @ seen.systems[0].transfer(np.array([frequency]))[0], axis=1)


def _trusts(seen: View, spec: TuningSpec, frequency: float, driven: Array) -> tuple[float, ...]:
    """Factors on the assumed stroke noise in turn, over decades for noisy gauges."""
    expected = spec.expected or _UNSTATED
    heard = np.abs(seen.loops.sense @ seen.loops.coordinates.pose) @ np.array(
        [expected.gauges[name] for name in seen.loops.coordinates.gauges]
    )
    even = float(np.max(heard / (driven * expected.strokes)))
    masses = tuple(even * each for each in _TRUST_OF_MASS)
    if np.max(np.abs(seen.at(frequency)) / np.abs(seen.static)) < _MASS:
        return masses
    return (*_TRUST, *(each for each in masses if each > _TRUST[-1]))


@dataclass(frozen=True, eq=False)
class _Designer:
    """Regulators for an `observer`, which is independent of the bandwidth, as are the `responses` of its states."""

    seen: View
    spec: TuningSpec
    expected: Disturbances
    observer: Array
    estimator: System

    @cached_property
    def estimates(self) -> Array:
        """Responses (s, f, k + n) of s states to k loop errors (subtracted from the pose) and n strokes, at the view's frequencies."""
        return self.estimates_at(self.seen.frequencies)

    def estimates_at(self, frequencies: Array) -> Array:
        """Responses (s, f, k + n) at other frequencies (f,) [Hz]."""
        found, count = self.estimator.sweep(frequencies), len(self.seen.loops.names)
        found[..., :count] = found[..., :count] @ np.linalg.inv(self.seen.loops.sense)
        return np.ascontiguousarray(np.moveaxis(found, 0, 1))

    def __call__(self, wanted: Array, frequency: float) -> LQG:
        """Controller with these weights (k,) [Hz]; its anti-windup rate equals the loops' crossover."""
        model, coordinates = self.seen.systems[0], self.seen.loops.coordinates
        found = with_observer(model, coordinates, Weights(tuple(map(float, wanted))), self.observer, self.spec.feedforward)
        return replace(found, tracking=1.0 / (2.0 * np.pi * frequency), expected=self.expected)


def _designer(seen: View, spec: TuningSpec, trust: float) -> _Designer:
    expected = spec.expected or _UNSTATED
    looser = Disturbances(expected.strokes * trust, expected.gauges)
    model, coordinates = seen.systems[0], seen.loops.coordinates
    key = (looser.strokes, *looser.gauges.items())
    if key not in seen.kept:
        observer = observer_gain(model, coordinates, looser)
        seen.kept[key] = _Designer(seen, spec, looser, observer, estimator(model, observer))
    return seen.kept[key]


def _strokes(seen: View, control: LQG, estimates: Array, frequencies: Array) -> Array:
    """Responses (f, n, k) of the strokes to the loops' errors: u = -K x^ + K_z z, x^ the `estimates` (s, f, k + n) of e and u.

    With the observer's responses known, no eigenvalues are needed: (1 + K X_u) u = (K X_e + K_z Z) e.
    """
    count = len(seen.loops.names)
    states, points, width = estimates.shape
    responses = (control.regulator @ estimates.reshape(states, -1).view(float)).view(complex).reshape(-1, points, width)
    fed = np.moveaxis(responses, 1, 0)
    turning = 2j * np.pi * frequencies
    sums = (step := seen.step or 0.0) / np.expm1(turning * step)
    entered = fed[..., :count] + (control.integral @ np.linalg.inv(seen.loops.sense)) * sums[:, None, None]
    return np.linalg.solve(np.eye(len(responses)) + fed[..., count:], entered)


def _balance_bandwidths(seen: View, design: _Designer, frequency: float, wanted: Array, first: Array) -> tuple[LQG | None, Array]:
    """Design with a gain of 1 of all loops at the frequency, or the nearest after a few iterations; and its weights.

    Weights follow by the secant method on the loops' gains there, in logarithms. Abandoned if they differ from `first` by decades.
    """
    found, before, slope = None, None, 1.0
    at = np.array([frequency])
    responses, estimates = seen.loops.sense @ seen.systems[0].transfer(at), design.estimates_at(at)
    for _ in range(_ROUNDS):
        if not np.all(np.abs(np.log(wanted / first)) < np.log(_FARTHEST)):
            return None, first
        try:
            found = design(wanted, frequency)
        except DesignError:  # weights without a numerical solution of the equation
            return None, first
        gains = np.log(np.abs(np.einsum("fkn,fnk->k", responses, _strokes(seen, found, estimates, at))))
        if np.all(np.abs(gains) < _AGREES):
            break
        if before is not None:
            moved = np.log(wanted) - before[0]
            far = np.abs(moved) > _SAME_WEIGHT
            slope = np.where(far, np.clip((gains - before[1]) / np.where(far, moved, 1.0), _FLATTEST, _STEEPEST), slope)
        before = np.log(wanted), gains
        wanted = wanted * np.exp(-np.clip(gains, -np.log(_AROUND), np.log(_AROUND)) / slope)
    return found, wanted
