"""Search for weights of linear-quadratic control that improve the controller of highest bandwidth."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy

from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.control.controllers.lqg import LQG, Disturbances, Weights, observer_gain, with_observer
from flexstage.control.tuning.attempt import driven_gains
from flexstage.control.tuning.judge import closed_growth
from flexstage.control.tuning.objective import TuningObjective
from flexstage.control.tuning.outcome import Outcome, outcome
from flexstage.control.tuning.search import SETTLED, Field, last_mode
from flexstage.control.tuning.spec import TuningSpec

_BANDWIDTHS, _TRUSTS, _POSES = (0.25, 0.5, 1.0), (1.0, 30.0, 1000.0), (0.01, 0.1, 1.0)
"""Grid of starts: bandwidths as fractions of the first mode; factors on the assumed stroke noise; weights of the pose."""
_SLOWER, _SURER, _LOOSER = (0.01, 0.03, 0.1), (0.01, 1.0), (1e-4, 1e-3, 1e-2)
"""Grid if no other start is stable with shifted modes: a regulator that does not act on modes is robust to them."""
_BEGUN, _TRUSTED = (0.25, 0.5, 1.0), (0.1, 1.0, 10.0)
"""Grid around a known controller: fractions of its bandwidth, and factors on the stroke noise assumed by its observer."""
_FIRST = (0.4, 1.2, 0.8)
"""Edges of the first simplex: factors of e for bandwidths, noise and weights of the pose. The grid's steps are twice as large."""
_ROUNDS, _SMALLER, _EVALUATIONS = 2, 0.35, 190
"""Restarts of the simplex, smaller, at its result, because it degenerates at kinks; evaluations per round."""
_SHARPNESS = 16.0
"""Sharpness s of the smooth minimum of improvements, -ln(mean(exp(-s g)))/s: within ln(n)/s of the minimum of n, about 15 % for 15."""
_STEEP = 20.0
"""Weight of a violated bound: an excess of 1 % costs as much as a fifth of an improvement by e."""
_INSIDE = 0.985
"""Fraction of the peak limit at the frequency grid, for peaks between its points."""
_NOISIER = 1.15
"""Noise factor that still counts as equal: with dominant gauge noise, as without floor vibration, rejection increases noise."""
_UNSTABLE = 1e3


@dataclass(frozen=True, eq=False)
class RegulatorSpace:
    """Search space: a point contains the logarithms of bandwidths [Hz], of the strokes' noise [m/Hz^0.5], and of weights of the pose.

    The point has a bandwidth and a pose weight for each loop; equal loops share them.
    """

    within: Field
    expected: Disturbances
    feedforward: Array | None

    @property
    def firsts(self) -> tuple[int, ...]:
        """Indices of all different loops; of equal loops, only the first index."""
        return tuple(sorted(set(self.within.alike)))

    def controller(self, point: Array) -> LQG:
        """Design the controller of a point."""
        count, alike = len(self.firsts), self.within.alike
        places = [self.firsts.index(first) for first in alike]
        numbers = np.exp(point)
        weights = Weights(tuple(numbers[:count][places].tolist()), tuple(numbers[count + 1 :][places].tolist()))
        model, coordinates = self.within.seen.systems[0], self.within.seen.loops.coordinates
        observer = observer_gain(model, coordinates, Disturbances(float(numbers[count]), self.expected.gauges))
        return with_observer(model, coordinates, weights, observer, self.feedforward)

    def outcome(self, point: Array) -> Outcome | None:
        """Evaluate a point. Returns `None` if the point gives no controller, or the loop is unstable at the largest mode shifts.

        The nominal loop is always stable, because regulator and observer are stable.
        """
        seen = self.within.seen
        ends = {min(seen.offsets), max(seen.offsets)}
        try:
            system = self.controller(point).system(seen.step)
        except DesignError:
            return None
        growths = [closed_growth(each, system) for offset, each in zip(seen.offsets, seen.systems, strict=True) if offset in ends]
        return None if max(growths) >= 0.0 else outcome(self.within, system)


def weigh(searched: RegulatorSpace, against: Outcome, begun: LQG, bandwidth: float) -> LQG:
    """Optimise the weights of linear-quadratic control: maximise the smallest improvement of the objective's quantities.

    Improvements are relative to the known outcome `against`. The method is the downhill simplex (Nelder & Mead, Computer Journal 7 (1965)
    308), with coefficients that depend on the dimension (Gao & Han, Computational Optimization and Applications 51 (2012) 259). The simplex
    starts from the best point of a grid. The grid extends around the first mode and includes the controller `begun`. If the crossover
    `bandwidth` [Hz] of `begun` is above the modes, the grid has only points around `begun`. The search is deterministic.
    """
    cost, seen = partial(_cost, searched, against), searched.within.seen
    first = float(seen.modes[0])
    known = list(_grid_around(searched, begun, bandwidth))
    if bandwidth > last_mode(seen):
        start = min(known, key=cost)
    else:
        start = min([*_grid(searched, first, _BANDWIDTHS, _TRUSTS, _POSES), known[0]], key=cost)
        if cost(start) >= _UNSTABLE:
            start = min(_grid(searched, first, _SLOWER, _SURER, _LOOSER), key=cost)
    count = len(searched.firsts)
    edges = np.repeat(_FIRST, (count, 1, count))
    for number in range(_ROUNDS):
        simplex = np.vstack([start, start + _SMALLER**number * np.diag(edges)])
        options = {"initial_simplex": simplex, "maxfev": _EVALUATIONS, "adaptive": True}
        start = scipy.optimize.minimize(cost, start, method="Nelder-Mead", options=options).x
    return searched.controller(start)


def _grid_around(searched: RegulatorSpace, begun: LQG, bandwidth: float) -> Iterator[Array]:
    """Weights of a known controller with a tiny pose weight, then those of slower ones, all scaled by the roll-off."""
    seen, firsts = searched.within.seen, list(searched.firsts)
    weights, expected = begun.weights or Weights(bandwidth), begun.expected or searched.expected
    stated = np.broadcast_to(weights.bandwidth, (len(seen.loops.names),))[firsts]
    poses, driven = np.array(_POSES), driven_gains(seen, bandwidth)[firsts]
    yield np.log([*stated, expected.strokes, *(poses[0] / driven**2)])
    for share in _BEGUN:
        slower = stated * share * driven / driven_gains(seen, share * bandwidth)[firsts]
        for trust in _TRUSTED:
            for pose in poses:
                yield np.log([*slower, trust * expected.strokes, *(pose / driven**2)])


def _grid(
    searched: RegulatorSpace, first: float, shares: tuple[float, ...], trusts: tuple[float, ...], poses: tuple[float, ...]
) -> Iterator[Array]:
    count = len(searched.firsts)
    for share in shares:
        for trust in trusts:
            for pose in poses:
                yield np.log([share * first] * count + [trust * searched.expected.strokes] + [pose] * count)


def _cost(searched: RegulatorSpace, against: Outcome, point: Array) -> float:
    found = searched.outcome(point)
    if found is None:
        return _UNSTABLE
    better = np.concatenate(list(_improvements(searched.within.spec, found, against)))
    least = -float(np.log(np.mean(np.exp(-_SHARPNESS * better)))) / _SHARPNESS
    return _STEEP * excess_of(searched.within, found) - least


def _improvements(spec: TuningSpec, found: Outcome, against: Outcome) -> Iterator[Array]:
    """Logarithms by loop of the objective's quantities."""
    if spec.objective in (TuningObjective.BALANCE, TuningObjective.REJECTION):
        yield np.log(found.rejection[0] / against.rejection[0])
    if spec.objective in (TuningObjective.BALANCE, TuningObjective.NOISE):
        more = _NOISIER if spec.objective is TuningObjective.BALANCE else 1.0
        yield np.log(more * np.maximum(against.noise, 1e-300) / np.maximum(found.noise, 1e-300))
    if spec.objective in (TuningObjective.BALANCE, TuningObjective.SETTLING):
        yield np.log(np.maximum(against.settling, 1e-300) / np.maximum(found.settling, 1e-300))


def merit(spec: TuningSpec, found: Outcome) -> float:
    """Compute the merit of an outcome: the mean over all loops of the logarithm of the objective's quantity.

    For a balance the quantity is the lower of two frequencies: the sensitivity crossover, and six divided by the settling time.
    """
    settling = np.maximum(found.settling, 1e-300)
    merits = {
        TuningObjective.BALANCE: np.minimum(found.rejection[0], SETTLED / settling),
        TuningObjective.REJECTION: found.rejection[0],
        TuningObjective.SETTLING: 1.0 / settling,
        TuningObjective.NOISE: 1.0 / np.maximum(found.noise, 1e-300),
    }
    return float(np.mean(np.log(merits[spec.objective or TuningObjective.BALANCE])))


def worth(within: Field, found: Outcome) -> float:
    """Compute the merit minus weighted violations of bounds. Peaks are limited only for gain errors and mode shifts within the spread."""
    spec = within.spec
    limits = np.array([each.limit if each.limit <= spec.sensitivity else np.inf for each in within.variants])
    return merit(spec, found) - _STEEP * _excess(spec, found, limits)


def excess_of(within: Field, found: Outcome) -> float:
    """Sum the relative violations of all bounds; limits of peaks are reduced, because maxima may be between grid frequencies."""
    return _excess(within.spec, found, _INSIDE * np.array([each.limit for each in within.variants]))


def _excess(spec: TuningSpec, found: Outcome, limits: Array) -> float:
    over = [
        *(found.peaks / limits - 1.0),
        *(found.overshoot - spec.overshoot),
        *((spec.rejection or 0.0) / found.rejection[0] - 1.0),
        *((0.0 if spec.settling is None else found.settling / spec.settling - 1.0) * np.ones(len(found.settling))),
        *((spec.delay_margin or 0.0) / found.delay_margin - 1.0),
    ]
    return float(np.sum(np.maximum(over, 0.0)))
