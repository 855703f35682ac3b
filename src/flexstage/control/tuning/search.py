"""Search for the best law and notches of every loop, robust to mode shifts."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from dataclasses import field as record_field
from functools import cached_property, partial
from typing import cast

import numpy as np
import scipy

from flexstage.analysis.dynamics.random_response import Spectrum
from flexstage.base.number import Array
from flexstage.base.processes.progress import duration
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.family import Family
from flexstage.control.controllers.notch import Notch
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.systems.system import select
from flexstage.control.tuning.fit import STIFF, Bounds, OneLoop, Squares, descend, keeps, sum_squares
from flexstage.control.tuning.judge import highest_gain
from flexstage.control.tuning.laws import PI_FAMILY, PID_FAMILY
from flexstage.control.tuning.objective import TuningObjective
from flexstage.control.tuning.shape import Shape
from flexstage.control.tuning.spec import TuningSpec
from flexstage.control.tuning.view import View, first_alike, resonances
from flexstage.experiment.progress import report

_INSIDE = 0.97
"""Fraction of the peak limit for a single loop: reserve for peaks between frequencies, and for coupling."""
_FAR, _STABLE = 0.1, 2.5
"""Least shift of all modes up to which loops remain stable; for a larger spread this multiple of it. S is limited there, too."""
_LOOSER, _LOOSEST, _LATER = 1.5, 4.0, 8.0
"""Limits of |S|, relative to the specified one: for shifts where the loop need only be stable; and at the delay margin.

Both are finite so that the descent notices a stability limit early: at 8, L is an eighth from -1, at a delay 3 % above the required one.
"""
_TURNS = 0.25 * np.pi * np.arange(1, 8)
"""Phase grid of delays: a mode of gain 1.08 encircles -1 over 44 deg, one of less gain comes nearer to it than 1/8."""
SETTLED = 6.0
"""Settling time times sensitivity crossover of well balanced loops.

A first-order loop with crossover f settles within 2 % after ln(50)/(2 pi f) = 0.62/f. Shifted modes with notches ring ten times as long.
Optimised loops of the shipped stages settle in 3/f to 6/f.
"""
_NEAR, _MOST_NOTCHES = 4.0, 3
"""Modes with notches: up to this factor of the first significant one, and at most this number. Beyond, PI at the first mode has fallen
below 1/4.

If the significant modes exceed the platform's highest mode by this factor, as with damped legs, none is notched.
"""
_ABOVE = 1.6
"""Start of a second notch in a loop with one mode, relative to the mode: a free pair of zeros and poles."""
_ZEROS, _POLE_DAMPINGS, _ZERO_DAMPINGS = (0.2, 0.8), (0.8, 2.4), (0.04, 0.12)
"""Grid of starts: k_i/k_p over the first mode's omega; damping of the first notch's poles (narrow, wide) and zeros (deep, shallow)."""
_LOOSE = 1.35
"""Allowed excess of starts over the peak limit: the descent reduces it, while the next lower gain may be far below."""
_DRIFT = 1e-9
"""Default disturbance of every loop without a specified floor: amplitude density [m/Hz^0.5] at 1 Hz, decreasing with frequency."""
_SCALES = np.geomspace(0.01, 20.0, 40)
"""Gains of starts, 20 % apart: loops are in metres with static gain 1, so that 1 is a crossover near the mode."""
_LEVELS, _STARTS = 6, 4
"""Reductions of the target frequency before starts are abandoned; number of starts pursued, those of highest rejection."""
_RATIO, _FINEST = 1.4, 1.1
"""Factor of the target frequency, its root after a failure, down to this limit: results are within 18 % of the limit."""
_KICKS, _KICK, _TURN = 2, 0.25, 2.4
"""Restarts around a point: their number, distance 0.25 in the logarithms, and directions sin(2.4 n k); 2.4 rad is near the golden angle."""
_ALLOWED, _EVALUATIONS, _AS_MANY = 1e7, 1000, 2000
"""Limit of evaluated responses, about 8 s of CPU time at 3 GHz; limit of evaluations of all loops; responses with the CPU time of the calls
of one evaluation."""
_NEARLY = 0.03
"""Excess of bounds up to which a start counts as well damped: only such starts bound the noise."""
_LEFT = 0.015
"""Fraction of the overshoot reserved for gauge rounding and for peaks between step samples."""
_LEAST = 0.02
"""Lowest k_p omega/k_i at the known crossover, for starts from a known controller."""
_FIRST_DERIVATIVE = 0.01
"""Start value k_d k_i / k_p^2 of PID from PI: zeros at PI's and at a hundred times it, so that all bounds stay met."""
_SLOWEST, _SLOWEST_OF_FAST = 0.1, 0.01
"""Lowest k_i/k_p over the first mode's omega, and over the known crossover.

Slower integrators leave a tail below the 2 % band that is visible in statics.
"""
_COUPLED = 0.5
"""Limit of |g_ij g_ji / (g_ii g_jj)| for individual searches: at this interaction a loop's own plant changes by half."""
_NOISIER = 1.65
"""Noise limit of a balance relative to a quiet loop that already rejects well."""
_LAME = 0.7
"""Minimum rejection of quiet loops in a balance, relative to the best start. Without floor vibration the quietest loop is the slowest: such
loops are made quiet again with nearly the same rejection."""
_AMBITION, _BACK = 0.3, 0.8
"""First target: fraction of the first mode's frequency, or of the start's rejection, with all bounds met."""
_SHARES = (0.98, 0.93, 0.85, 0.75, 0.65, 0.5, 0.35, 0.2)
"""Fractions of the individual loops' results that all together must reach, tried in turn."""
_SAME = 1e-6
"""Relative difference of plants below which loops are equal: symmetric models agree to about 1e-9."""
_CORNER, _OF_RATE = 10.0, 0.4
"""Corner of a PID's filter: ten times the platform's highest mode, or the known crossover, whichever is higher.

It is at most 0.4 of the sampling rate, for Tustin's rule.
"""
_RATE = 20.0
"""Step samples per period of the loops' highest mode, or of the known crossover."""
_PERIODS, _LEAST_LINES, _MOST_LINES = 12.0, 9, 12
"""Step duration in periods of the lowest mode, 0.1 s at 100 Hz; powers of two between 512 and 4096 samples."""
_PLAIN, _PER_DECADE, _AROUND = 90, 20, np.array([-6.0, -3.0, -1.5, -0.7, 0.0, 0.7, 1.5, 3.0, 6.0])
"""Frequencies: this number logarithmically spaced, at least per decade, and around each mode by half widths.

Between them |S| of a pole is linear to 3 %.
"""

_CLOSE = np.linspace(-0.06, 0.06, 25)
"""Grid around a peak exceeded between frequencies: its half width, because it moves during the search, and a spacing of half a per cent."""


@dataclass(frozen=True)
class SearchSettings:
    """Search parameters: weight `quiet` of noise, at most `tries` steps; the search ends if half the sum of squares falls to `enough`."""

    quiet: float
    tries: int
    enough: float = 0.0


_CALM, _KEEP, _LAST = SearchSettings(1.0, 60), SearchSettings(0.05, 60, 0.005), SearchSettings(0.3, 20)
"""Three searches: to make starts quiet; to meet bounds, with noise to rank equals, until no bound is violated; and for all loops at
once."""


class Work:
    """Counter of the responses evaluated by a search, at most `allowed`; it also reports the progress."""

    def __init__(self, allowed: float = _ALLOWED) -> None:
        self.allowed, self.spent, self._begun, self._whole = allowed, 0.0, time.process_time(), allowed

    def affordable(self, tries: int, size: int) -> int:
        """Return how many tries of a descent remain, at most `tries`, if each evaluates `size` responses."""
        return min(tries, int(max(self.allowed - self.spent, 0.0) / size))

    def allow(self, share: float) -> None:
        """Reserve at least a fraction `share` of the total work for the next searches."""
        self.allowed = max(self.allowed, self.spent + share * self._whole)

    def count(self, size: int) -> None:
        """Add `size` responses to the counter."""
        self.spent += size

    def report(self) -> None:
        """Report the completed fraction, and the maximum duration of the whole search."""
        share = min(self.spent / self.allowed, 1.0)
        if share:
            report(share, f"optimising the controller, at most {duration((time.process_time() - self._begun) / share)}")


@dataclass(frozen=True)
class Variant:
    """Variant of the plant: modes shifted by `offset`, commands multiplied by `gain` and delayed by `later` [s].

    `limit` is the highest permitted sensitivity. The delay's phase lag is limited to `turn` [rad]. For modes far above the crossover, a
    smaller `turn` represents a smaller delay; such a mode may be unstable with a delay smaller than `later`.
    """

    offset: float
    gain: float
    later: float
    limit: float
    turn: float = np.inf

    def factor(self, frequencies: Array) -> Array:
        """Compute the complex factor by which gain and delay multiply the plant's response at frequencies (f,) [Hz]."""
        return self.gain * np.exp(-1j * np.minimum(2.0 * np.pi * frequencies * self.later, self.turn))


def variants(spec: TuningSpec) -> tuple[Variant, ...]:
    """Return the plant variants of a specification, the unchanged model first.

    >>> from flexstage.control.tuning.laws import PI_FAMILY
    >>> [each.offset for each in variants(TuningSpec(PI_FAMILY, spread=0.02))]
    [0.0, -0.02, 0.02, -0.05, 0.05, -0.1, 0.1]
    """
    limit, spread = spec.sensitivity, spec.spread
    near = (-spread, spread) if spread else ()
    far = {_STABLE * spread: _LOOSER, farthest(spec): _LOOSEST} if spread else {}
    gains = (1.0 - spec.gain, 1.0 + spec.gain) if spec.gain else ()
    turns = (*_TURNS, np.inf) if spec.delay_margin else ()
    return (
        *(Variant(offset, 1.0, 0.0, limit) for offset in (0.0, *near)),
        *(Variant(sign * offset, 1.0, 0.0, factor * limit) for offset, factor in far.items() for sign in (-1.0, 1.0)),
        *(Variant(0.0, gain, 0.0, limit) for gain in gains),
        *(Variant(0.0, 1.0, 1.03 * (spec.delay_margin or 0.0), _LATER, turn) for turn in turns),
    )


def farthest(spec: TuningSpec) -> float:
    """Return the largest relative shift of all modes for which a loop must be stable."""
    return max(_FAR, _STABLE * spec.spread) if spec.spread else 0.0


@dataclass(frozen=True, eq=False)
class Field:
    """Search data: the responses of plants from the commands of k loops to their poses.

    `plants` (v, f, k, k) are the responses of the v variants. Each variant has its own f `frequencies` (v, f) [Hz]: those of the model,
    multiplied by (1 + offset), so that the modes are at the same indices. `slow` (w, h, k, k) are responses at the evenly spaced
    frequencies `lines` (h,) [Hz], for step responses. They belong to the w variants that have only mode shifts within the spread.

    `disturbed` (f, k, d) are the amplitudes of the loops' poses due to d floor motions, `heard` (f, k) the amplitudes due to gauge noise.
    Both are multiplied by the square root of the frequency spacing, so that a sum of their squares over the frequencies is a mean square.
    `alike` maps each loop to the first equal loop. `allowed` is the limit of each loop's rms noise in regulation; default: no limit. `fast`
    [Hz] is the known crossover, for step sampling and filters.
    """

    seen: View
    spec: TuningSpec
    variants: tuple[Variant, ...]
    frequencies: Array
    plants: Array
    lines: Array
    slow: Array
    disturbed: Array
    heard: Array
    alike: tuple[int, ...]
    allowed: tuple[float, ...] = ()
    fast: float = 0.0
    work: Work = record_field(default_factory=Work)

    @cached_property
    def strokes(self) -> Array:
        """Responses (v, f, k, n) of the v variants from n strokes to the poses of k loops, at `frequencies`."""
        cases = zip(self.variants, self.frequencies, strict=True)
        return np.stack([self.seen.driven_at(each.offset, at) * each.factor(at)[:, None, None] for each, at in cases])

    @cached_property
    def slow_strokes(self) -> Array:
        """Responses (w, h - 1, k, n) from n strokes to the poses of k loops, at the frequencies `lines` except 0."""
        return np.stack([self.seen.driven_at(self.variants[place].offset, self.lines[1:]) for place in self.spread])

    @property
    def size(self) -> int:
        """Number of responses per evaluation (all loops at all frequencies and lines), plus a constant for the CPU time of calls."""
        return (self.frequencies.size + len(self.slow) * len(self.lines)) * len(self.alike) + _AS_MANY

    @property
    def spread(self) -> list[int]:
        """Indices of the variants that have only mode shifts within the spread, the model first."""
        return _spread(self.spec, self.variants)


def _spread(spec: TuningSpec, cases: tuple[Variant, ...]) -> list[int]:
    return [place for place, each in enumerate(cases) if abs(each.offset) <= spec.spread and each.gain == 1.0 and not each.later]


def field(seen: View, spec: TuningSpec, places: tuple[float, ...] = (), fast: float = 0.0, work: Work | None = None) -> Field:
    """Prepare the data of a search from a view at the offsets of `variants`.

    Frequencies are also dense around `places` [Hz]; these frequencies of the model shift with the modes. `fast` is as in `Field`. To
    continue an earlier search, specify its counter `work`.
    """
    drive, cases = seen.loops.drive, variants(spec)
    own = _frequencies(seen, max(each.offset for each in cases), places)
    frequencies = np.stack([own * (1.0 + each.offset) for each in cases])
    plants = np.stack(
        [seen.driven_at(each.offset, at) @ drive * each.factor(at)[:, None, None] for each, at in zip(cases, frequencies, strict=True)]
    )
    lines = _lines(seen, fast)
    slow = np.stack([seen.driven_at(cases[place].offset, lines) @ drive for place in _spread(spec, cases)])
    weights = np.sqrt(np.gradient(own))[:, None]
    found = Field(
        seen=seen,
        spec=spec,
        variants=cases,
        frequencies=frequencies,
        plants=plants,
        lines=lines,
        slow=slow,
        disturbed=_disturbed(seen, own, spec.floor) * weights[:, :, None],
        heard=_heard(seen) * weights,
        alike=tuple(next(first_alike(np.einsum("vfkk->vfk", plants), loop, _SAME)) for loop in range(len(seen.loops.names))),
        fast=fast,
    )
    return replace(found, work=work or Work(min(_ALLOWED, _EVALUATIONS * found.size)))


def last_mode(seen: View) -> float:
    """Return the frequency [Hz] of the n-th mode, where n is the number of loops.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.view import first_alike, view
    >>> plant = integral_loop().plant
    >>> round(last_mode(view(plant, platform_loops(plant.coordinates), 0.0)), 1) == round(float(plant.frequencies[0]), 1)
    True
    """
    return float(seen.modes[min(len(seen.loops.names), len(seen.modes)) - 1])


def _lines(seen: View, fast: float) -> Array:
    """Evenly spaced frequencies [Hz] from 0 to half the rate, for steps of some periods of the lowest mode."""
    rate = _RATE * max(last_mode(seen) * (2.0 if seen.loops.coordinates.forced else 1.0), fast)
    rate = rate if seen.step is None else min(rate, 1.0 / seen.step)
    power = int(np.clip(np.ceil(np.log2(_PERIODS * rate / float(seen.modes[0]))), _LEAST_LINES, _MOST_LINES))
    return np.linspace(0.0, 0.5 * rate, 2 ** (power - 1) + 1)


def _frequencies(seen: View, highest: float, places: tuple[float, ...]) -> Array:
    """Frequencies spaced logarithmically, and densely around the modes and `places`, below half the rate for all plants."""
    top = 20.0 * float(seen.modes[-1]) if seen.step is None else 0.5 / seen.step
    top *= 0.999 / (1.0 + highest)
    lowest = 0.01 * float(seen.modes[0])
    plain = np.geomspace(lowest, top, max(_PLAIN, int(_PER_DECADE * np.log10(top / lowest))))
    single = np.append(True, np.diff(seen.modes) > 0.1 * seen.ratios[1:] * seen.modes[1:])
    around = seen.modes[single, None] * (1.0 + seen.ratios[single, None] * _AROUND)
    near = np.array(places)[:, None] * (1.0 + _CLOSE)
    every = np.unique(np.concatenate([plain, around.ravel(), near.ravel()]))
    return every[(every > 0.0) & (every <= top)]


def _disturbed(seen: View, frequencies: Array, floor: Mapping[str, Spectrum]) -> Array:
    names = [f"relative.{name}" for name in seen.loops.coordinates.names]
    if not floor:
        return _DRIFT * np.eye(len(names))[None] / frequencies[:, None, None]
    moved = select(seen.plant.system, list(floor), names).sweep(frequencies)
    shaken = np.sqrt(np.stack([spectrum.at(frequencies) for spectrum in floor.values()], axis=-1))
    return seen.loops.sense @ moved * shaken[:, None, :]


def _heard(seen: View) -> Array:
    """Amplitude density (k,) of gauge noise and quantisation in each loop."""
    step, plant = seen.step or 0.0, seen.plant
    sensors = [plant.hardware.sensors.get(name) for name in plant.gauges]
    squares = [0.0 if each is None else (each.noise_density or 0.0) ** 2 + each.resolution**2 * step / 6.0 for each in sensors]
    rows = seen.loops.sense @ plant.coordinates.pose
    return np.sqrt(np.sum(rows**2 * np.array(squares), axis=1))


@dataclass(frozen=True, eq=False)
class SearchResult:
    """Search result: each loop's shape, its parameter point, and the target frequency [Hz] that it `reached` (0: no target).

    `noises` are the rms errors of the loops in regulation, if known, with the loops of other groups open.
    """

    shapes: tuple[Shape, ...]
    points: tuple[Array, ...]
    reached: tuple[float, ...]
    noises: tuple[float, ...] = ()

    def responses(self, frequencies: Array) -> Array:
        """Compute the responses (..., k) of the controllers of k loops at frequencies (...) [Hz]."""
        every = [shape.value(point, frequencies) for shape, point in zip(self.shapes, self.points, strict=True)]
        return np.stack(every, axis=-1)

    @property
    def laws(self) -> tuple[PI | PID, ...]:
        """Laws by loop."""
        return tuple(map(Shape.law, self.shapes, self.points))

    @property
    def notches(self) -> tuple[tuple[Notch, ...], ...]:
        """Notches by loop. Notches of depth 1 are omitted, because they have no effect."""
        every = map(Shape.notches, self.shapes, self.points)
        return tuple(tuple(each for each in notches if each.depth < 1.0) for notches in every)


def search(within: Field, family: Family) -> SearchResult | None:
    """Search for the best loops: first each group of coupled loops, then all loops at once. Returns `None` without a stable result.

    The search for PID loops starts from the PI result. The search is deterministic, with starts on a grid.
    """
    found = _by_blocks(within, _shapes(within, PI_FAMILY), _best)
    if found is not None and family == PID_FAMILY:
        found = _by_blocks(within, _shapes(within, family), partial(_on_from, found))
    return found and tighten(within, found)


def advance(within: Field, known: Decentralised) -> SearchResult | None:
    """Improve the loops of a known controller: first each group of coupled loops, then all loops at once."""
    begun = known_loops(within, known)
    found = _by_blocks(within, begun.shapes, partial(_advanced, begun))
    return found and tighten(within, found)


def _advanced(begun: SearchResult, within: Field, shapes: tuple[Shape, ...], block: tuple[int, ...]) -> SearchResult:
    """Loops of a block, improved from the known ones."""
    own, aim = SearchResult(shapes, tuple(begun.points[loop] for loop in block), (0.0,) * len(block)), within.spec.objective
    if aim is TuningObjective.BALANCE:
        within = replace(within, allowed=_noise_limits(within, own))
    starts = [own, *_calmed(within, [own], _BACK)]
    if aim is TuningObjective.SETTLING:  # high rejection implies fast settling
        balanced = replace(within, spec=replace(within.spec, objective=TuningObjective.BALANCE))
        starts.insert(0, raise_targets(balanced, starts, _frequencies_of_aim(balanced, own)))
    return raise_targets(within, starts, _frequencies_of_aim(within, starts[0]))


def resume(within: Field, known: Decentralised) -> SearchResult:
    """Optimise all loops at once from a known controller. The result must reach the frequencies that the known controller reaches."""
    begun = known_loops(within, known)
    return tighten(within, replace(begun, reached=tuple(_frequencies_of_aim(within, begun))))


def known_loops(within: Field, known: Decentralised) -> SearchResult:
    """Convert the loops of a controller to a search result. Equal loops get the point of the first loop among them."""
    count = len(within.alike)
    notches = known.notches or ((),) * count
    every = [_known_loop(within, cast("PI | PID", known.laws[first]), notches[first]) for first in within.alike]
    return SearchResult(
        tuple(shape for shape, _ in every), _shared(within, tuple(point for _, point in every)), (0.0,) * count, (np.inf,) * count
    )


def _known_loop(within: Field, law: PI | PID, notches: tuple[Notch, ...]) -> tuple[Shape, Array]:
    """Shape and point of a loop; zero gains become tiny, because logarithms are searched."""
    fast = 2.0 * np.pi * within.fast
    plain = PI(max(law.proportional, _LEAST * law.integral / fast), law.integral)
    corner = law.filter if isinstance(law, PID) else None
    shape = Shape(len(notches), within.seen.step, corner, min(_SLOWEST_OF_FAST * fast, plain.integral / plain.proportional))
    if not isinstance(law, PID):
        return shape, shape.point(plain, notches)
    derivative = max(law.derivative, _FIRST_DERIVATIVE * plain.proportional**2 / plain.integral)
    return shape, shape.point(PID(plain.proportional, plain.integral, derivative, law.filter), notches)


def tighten(within: Field, found: SearchResult) -> SearchResult:
    """Optimise all loops at once: the largest common share of their results, and with it the least noise.

    The result `found` belongs to the same field or to a less strict one.
    """
    tried = found
    for share in _SHARES:
        looser = replace(within, allowed=tuple(one / share for one in found.noises))
        tried, last = _fit_together(looser, tried, _all_bounds(looser, [share * one for one in found.reached]), _LAST)
        if keeps(last):
            break
    return tried


def _by_blocks(
    within: Field, shapes: tuple[Shape, ...], solve: Callable[[Field, tuple[Shape, ...], tuple[int, ...]], SearchResult | None]
) -> SearchResult | None:
    """Loops solved by coupled blocks, the others open; equal loops have equal results."""
    solved = dict[int, tuple[Array, float, float]]()
    for block in _blocks(within):
        part = _part(within, block)
        found = solve(part, tuple(shapes[loop] for loop in block), block)
        if found is None:
            return None
        results = zip(found.points, found.reached, [each.rms for each in one_loops(part, found)], strict=True)
        solved |= zip([within.alike[loop] for loop in block], results, strict=True)
    return SearchResult(shapes, *zip(*(solved[first] for first in within.alike), strict=True))


def _on_from(begun: SearchResult, within: Field, shapes: tuple[Shape, ...], block: tuple[int, ...]) -> SearchResult:
    """Loops continued from a PI result, with a tiny derivative."""
    points = tuple(_with_derivative(shape, begun.shapes[loop], begun.points[loop]) for shape, loop in zip(shapes, block, strict=True))
    reached, noises = (tuple(each[loop] for loop in block) for each in (begun.reached, begun.noises))
    return raise_targets(replace(within, allowed=noises), [SearchResult(shapes, _shared(within, points), reached)], list(reached))


def _shared(within: Field, points: tuple[Array, ...]) -> tuple[Array, ...]:
    """Shared array for equal loops; restarts are counted by it."""
    return tuple(points[first] for first in within.alike)


def _with_derivative(shape: Shape, plain: Shape, point: Array) -> Array:
    law = plain.law(point)
    derivative = _FIRST_DERIVATIVE * law.proportional**2 / law.integral
    return shape.point(PID(law.proportional, law.integral, derivative, shape.corner or 0.0), plain.notches(point))


def beside_one_another(grids: list[list[Array]]) -> list[tuple[Array, ...]]:
    """Combine the starts of loops that are optimised together. If a loop has fewer starts, some of them are used several times."""
    most = max(map(len, grids))
    return list(zip(*([grid[place * len(grid) // most] for place in range(most)] for grid in grids), strict=True))


def _blocks(within: Field) -> list[tuple[int, ...]]:
    """Strongly coupled loops, one set of each group of equal sets."""
    own = np.einsum("vfkk->vfk", within.plants)
    both = np.abs(within.plants * within.plants.mT / (own[..., :, None] * own[..., None, :]))
    count, owners = scipy.sparse.csgraph.connected_components(np.max(both, axis=(0, 1)) > _COUPLED)
    blocks = [tuple(np.flatnonzero(owners == owner).tolist()) for owner in range(count)]
    kinds = {tuple(sorted(within.alike[loop] for loop in block)): block for block in reversed(blocks)}
    return list(kinds.values())


def _part(within: Field, block: tuple[int, ...]) -> Field:
    """Field of some loops, the others open."""
    chosen = list(block)
    firsts = [within.alike[loop] for loop in block]
    return replace(
        within,
        plants=within.plants[..., chosen, :][..., chosen],
        slow=within.slow[..., chosen, :][..., chosen],
        disturbed=within.disturbed[:, chosen],
        heard=within.heard[:, chosen],
        alike=tuple(firsts.index(first) for first in firsts),
    )


def _best(within: Field, shapes: tuple[Shape, ...], block: tuple[int, ...]) -> SearchResult | None:
    """Best of a grid of starts: those of highest rejection are damped, and the first successful one is improved."""
    seen, balanced = within.seen, within.spec.objective is TuningObjective.BALANCE
    first = [_first_place(seen, loop) for loop in block]
    grids = [list(_grid(*each)) for each in zip(shapes, [_places(seen, loop) for loop in block], first, strict=True)]
    begun = (_highest_stable(within, SearchResult(shapes, points, (0.0,) * len(block))) for points in beside_one_another(grids))
    far = sorted((each for each in begun if each is not None), key=lambda each: -_far(within, each))[:_STARTS]
    if not far:
        return None
    calm = _calmed(within, far, 0.0)
    if balanced and _far(within, calm[0]) < _LAME * _far(within, far[0]):
        calm = _calmed(within, far, _BACK)
    if balanced and excess(within, calm[0]) <= _NEARLY:
        within = replace(within, allowed=_noise_limits(within, calm[0]))
    wanted = [max(_BACK * own, _AMBITION * place) for own, place in zip(rejections(within, calm[0]), first, strict=True)]
    return raise_targets(within, [*calm, *far], wanted)


def _calmed(within: Field, starts: list[SearchResult], share: float) -> list[SearchResult]:
    """Quiet starts with a share of their rejection; first those that meet the bounds, by rejection."""
    calm = [
        _fit_together(within, each, _all_bounds(within, [share * far for far in rejections(within, each)]), _CALM)[0] for each in starts
    ]
    return sorted(calm, key=lambda each: (excess(within, each) > _NEARLY, -_far(within, each)))


def rejections(within: Field, found: SearchResult) -> list[float]:
    """Compute the sensitivity crossover of each loop [Hz]."""
    return [each.rejection for each in one_loops(within, found)]


def _frequencies_of_aim(within: Field, found: SearchResult) -> list[float]:
    """Objective frequency [Hz] already reached by each loop: of rejection, or of settling within six periods."""
    loops, aim = one_loops(within, found), within.spec.objective
    far, soon = [each.rejection for each in loops], [SETTLED / each.settling for each in loops]
    return soon if aim is TuningObjective.SETTLING else list(map(min, far, soon)) if aim is TuningObjective.BALANCE else far


def _noise_limits(within: Field, found: SearchResult) -> tuple[float, ...]:
    """Highest rms in regulation of each loop, relative to a quiet result."""
    return tuple(_NOISIER * each.rms for each in one_loops(within, found))


def _far(within: Field, found: SearchResult) -> float:
    """Geometric mean of the loops' rejection."""
    return float(np.exp(np.mean(np.log(rejections(within, found)))))


def raise_targets(within: Field, starts: list[SearchResult], targets: list[float]) -> SearchResult:
    """Increase the frequency targets of all loops, then of single loops, by decreasing ratios.

    The search begins with the first of `starts` that meets the `targets`. A target of zero is first replaced by the frequency that this
    start reaches.
    """
    within, best = loud_enough(within, starts, targets)
    for _ in range(_LEVELS - 1):
        if best is not None:
            break
        targets = [one / _RATIO for one in targets]
        best = _first_kept(within, starts, targets)
    if best is None or within.spec.objective is TuningObjective.NOISE:
        return replace(best or starts[0], reached=(0.0,) * len(targets))
    ratio, groups = _RATIO, sorted(set(within.alike))
    reached = [one or own for one, own in zip(targets, _frequencies_of_aim(within, best), strict=True)]
    while ratio > _FINEST:
        for moved in [groups, *([[group] for group in groups] if len(groups) > 1 else [])]:
            farther = [one * (ratio if first in moved else 1.0) for one, first in zip(reached, within.alike, strict=True)]
            there = _first_kept(within, _around(best), farther) if farther != reached else None
            if there is not None:
                best, reached = there, farther
                break
        else:
            ratio = np.sqrt(ratio)
    return replace(best, reached=tuple(reached))


def loud_enough(within: Field, starts: list[SearchResult], wanted: list[float]) -> tuple[Field, SearchResult | None]:
    """Fit the starts in turn until a result meets the frequency targets; return the field used and this result.

    If only the noise limit prevents a result, the returned field has a higher limit.

    A loop with a tiny gain may have a high sensitivity crossover and low noise, but it never settles. Therefore its noise is not a useful
    limit for a balance.
    """
    best = _first_kept(within, starts, wanted)
    if best is not None or not within.allowed:
        return within, best
    free = replace(within, allowed=())
    found = _first_kept(free, starts, wanted)
    if found is None:
        return within, None
    calm = _fit_together(free, found, _all_bounds(free, wanted), _CALM)[0]
    louder = replace(within, allowed=_noise_limits(free, calm))
    return louder, _first_kept(louder, [calm, found], wanted)


def _first_kept(within: Field, starts: Iterable[SearchResult], wanted: list[float]) -> SearchResult | None:
    """First start that meets the frequency targets."""
    for start in starts:
        found, passed = _fit_together(within, start, _all_bounds(within, wanted), _KEEP)
        if keeps(passed):
            return found
    return None


def _around(found: SearchResult) -> Iterator[SearchResult]:
    """A point and some around it, which may converge if the point does not."""
    yield found
    for number in range(1, _KICKS // len(set(map(id, found.points))) + 1):
        yield replace(found, points=tuple(point + _KICK * np.sin(_TURN * number * np.arange(1, len(point) + 1)) for point in found.points))


def _all_bounds(within: Field, frequencies: Iterable[float]) -> list[Bounds]:
    allowed = within.allowed or (np.inf,) * len(within.alike)
    return [replace(_bounds(within.spec, frequency), noise=noise) for frequency, noise in zip(frequencies, allowed, strict=True)]


def _fit_together(within: Field, found: SearchResult, bounds: list[Bounds], effort: SearchSettings) -> tuple[SearchResult, float]:
    """Fit all loops' parameters at once from the given ones, and return the worst violation of bounds."""
    joint = Joint(within, found, tuple(bounds), effort.quiet)
    start = np.concatenate([found.points[loop] for loop in joint.parts])
    limits = [found.shapes[loop].bounds(found.points[loop]) for loop in joint.parts]
    low, high = (np.concatenate([pair[side] for pair in limits]) for side in (0, 1))
    within.work.report()
    best = joint.moved(descend(joint.at, start, (low, high), within.work.affordable(effort.tries, within.size), effort.enough))
    return best, joint.passed(best)


@dataclass(frozen=True, eq=False)
class Joint:
    """Joint optimisation of all loops: the residuals are violated bounds, noise, and excesses of the coupled sensitivity over its limit.

    Equal loops share their parameters.
    """

    within: Field
    found: SearchResult
    bounds: tuple[Bounds, ...]
    quiet: float

    @cached_property
    def parts(self) -> Mapping[int, slice]:
        """Slices of the parameter vector by loop; of equal loops, only the first has a slice."""
        different = [loop for loop, first in enumerate(self.within.alike) if first == loop]
        ends = np.cumsum([0, *(len(self.found.points[loop]) for loop in different)])
        return {loop: slice(int(ends[place]), int(ends[place + 1])) for place, loop in enumerate(different)}

    @cached_property
    def loops(self) -> Mapping[int, tuple[OneLoop, float]]:
        """All different loops, each with its noise weight: the common weight divided by the loop's rms noise at the start."""
        begun = one_loops(self.within, self.found)
        return {loop: (begun[loop], self.quiet / begun[loop].rms) for loop in self.parts}

    def moved(self, point: Array) -> SearchResult:
        """Return the loops at a parameter point."""
        return replace(self.found, points=tuple(point[self.parts[first]] for first in self.within.alike))

    def at(self, point: Array) -> Squares | None:
        """Compute half the sum of squares of the residuals, its gradient and curvature at a point; `None` if a plant is unstable."""
        within, found = self.within, self.moved(point)
        within.work.count(within.size)
        values, slopes = self._responses(found, within.frequencies)
        whole = closed_by(within.plants, values)
        if not _is_stable(whole):
            return None
        slow_values, slow_slopes = self._responses(found, within.lines[None, 1:])
        slow = closed_by(within.slow[:, 1:], slow_values)
        terms = [_coupled(within, whole, slopes)]
        for loop, (one, quiet) in self.loops.items():
            following = np.pad(1.0 - slow[..., loop, loop], ((0, 0), (1, 0)), constant_values=1.0)
            bounds, count = self.bounds[loop], self.bounds[loop].plants
            own = _by_all(whole[:count], {first: each[:, :count] for first, each in slopes.items()}, loop, within.alike)
            late = partial(_by_all, slow, slow_slopes, loop, within.alike)
            terms += one.misfits(bounds, quiet, (whole[:count, :, loop, loop], own), (following, late))
        return sum_squares(terms, len(point))

    def _responses(self, found: SearchResult, frequencies: Array) -> tuple[Array, Mapping[int, Array]]:
        """Responses C (v, f, k) of all loops and, for each different one, d ln C (p, v, f) by its parameters."""
        each = {loop: found.shapes[loop].response(found.points[loop], frequencies) for loop in self.parts}
        return np.stack([each[first][0] for first in self.within.alike], axis=-1), {loop: slopes for loop, (_, slopes) in each.items()}

    def passed(self, found: SearchResult) -> float:
        """Compute the largest relative violation of a bound."""
        within = self.within
        whole = coupled_sensitivities(within.plants, found, within.frequencies)
        if not _is_stable(whole):
            return np.inf
        loops = one_loops(within, found, whole)
        return max(*(loops[loop].excess(self.bounds[loop]) for loop in self.parts), _coupled_peak(within, whole) / _INSIDE - 1.0)


def _by_all(whole: Array, slopes: Mapping[int, Array], loop: int, alike: tuple[int, ...]) -> Array:
    """Equivalent of d ln C (p, ...) for a loop if all controllers change: dS_ii = -sum_j T_ij S_ji dlnC_j."""
    rest = (np.arange(whole.shape[-1]) == loop) - whole[..., loop, :]
    shares = rest * whole[..., :, loop]
    return np.concatenate([each * (_of_first(shares, first, alike) / shares[..., loop]) for first, each in slopes.items()])


def _of_first(values: Array, first: int, alike: tuple[int, ...]) -> Array:
    """Sum of values (..., k) over loops equal to the first one."""
    same = [loop for loop, each in enumerate(alike) if each == first]
    return values[..., first] if len(same) == 1 else np.sum([values[..., loop] for loop in same], axis=0)


def _is_stable(whole: Array) -> bool:
    """Nyquist criterion for all loops: det(I + L) rotates by the integrators' initial phase, each loop isolated at the lowest frequency."""
    turned = np.unwrap(-np.angle(_determinant(whole)), axis=-1)
    begun = np.sum(np.angle(1.0 / np.einsum("vkk->vk", whole[:, 0])), axis=-1)
    return bool(np.all(np.abs(turned[:, -1] - turned[:, 0] + begun) < 3.0))


def one_loops(within: Field, found: SearchResult, whole: Array | None = None) -> list[OneLoop]:
    """Evaluate each loop with the others closed.

    With the sensitivity S of all loops together, the open-loop response of loop i is 1/S_ii - 1. A disturbance of loop j acts on loop i
    multiplied by S_ij/S_ii, which does not depend on the controller of loop i.
    """
    whole = coupled_sensitivities(within.plants, found, within.frequencies) if whole is None else whole
    slow = coupled_sensitivities(within.slow[:, 1:], found, within.lines[1:])
    responses, slow_responses = found.responses(within.frequencies), found.responses(within.lines[1:])
    loops = []
    for loop, (shape, point) in enumerate(zip(found.shapes, found.points, strict=True)):
        own = whole[..., loop, loop]
        shaken = np.einsum("fj,fjd->fd", whole[0, :, loop] / own[0, :, None], within.disturbed)
        one = OneLoop(
            shape=shape,
            point=point,
            frequencies=within.frequencies,
            plants=(1.0 / own - 1.0) / responses[..., loop],
            lines=within.lines,
            slow=(1.0 / slow[..., loop, loop] - 1.0) / slow_responses[:, loop],
            disturbed=np.sum(np.abs(shaken) ** 2, axis=-1),
            heard=np.abs(within.heard[:, loop]) ** 2,
        )
        loops.append(one)
    return loops


def _coupled(within: Field, whole: Array, slopes: Mapping[int, Array]) -> tuple[Array, Array]:
    """Excess of singular values of S: d sigma = -Re(sum_j u^H T_j S_j v dlnC_j), u and v its directions."""
    limits = np.array([each.limit for each in within.variants])[:, None] * _INSIDE * np.ones(whole.shape[:2])
    over = np.linalg.norm(whole, axis=(-2, -1)) > limits  # the sum of all squared is above the largest
    _, gains, right = np.linalg.svd(whole[over])
    values, right = gains[:, 0], np.conj(right[:, 0, :])
    high = values > limits[over]
    chosen, limit, value, v = whole[over][high], limits[over][high], values[high], right[high]
    u = np.conj(np.einsum("rij,rj->ri", chosen, v)) / value[:, None]
    gains = (u - np.einsum("ri,rij->rj", u, chosen)) * np.einsum("rji,ri->rj", chosen, v)
    chosen_slopes = [each[:, over][:, high] * _of_first(gains, first, within.alike) for first, each in slopes.items()]
    changes = -np.real(np.concatenate(chosen_slopes)) / limit
    return STIFF * (value / limit - 1.0), STIFF * changes


def _shapes(within: Field, family: Family) -> tuple[Shape, ...]:
    """Shapes of all loops with laws of a family."""
    seen, fast, corner = within.seen, within.fast, None
    if family == PID_FAMILY:
        corner = min(_CORNER * max(last_mode(seen), fast), np.inf if seen.step is None else _OF_RATE / seen.step)
    slowest = (max(_SLOWEST * _first_place(seen, loop), _SLOWEST_OF_FAST * fast) for loop in range(len(within.alike)))
    return tuple(Shape(len(_places(seen, loop)), seen.step, corner, 2.0 * np.pi * each) for loop, each in enumerate(slowest))


def _places(seen: View, loop: int) -> list[float]:
    """Start frequencies [Hz] of notches: the first significant modes of a loop; for a single mode also a place above it."""
    highest = _NEAR * last_mode(seen)
    found = [each.frequency for each in resonances(seen, loop) if each.frequency < highest]
    near = [each for each in found if each < _NEAR * found[0]][:_MOST_NOTCHES]
    return [*near, _ABOVE * near[0]] if len(near) == 1 and (seen.step is None or _ABOVE * near[0] < _OF_RATE / seen.step) else near


def _first_place(seen: View, loop: int) -> float:
    return next(iter(_places(seen, loop)), float(seen.modes[0]))


def _grid(shape: Shape, places: list[float], first: float) -> Iterator[Array]:
    for zero in _ZEROS:
        for poles in _POLE_DAMPINGS if places else (1.0,):
            for zeros in _ZERO_DAMPINGS if places else (1.0,):
                notches = tuple(
                    Notch(place, zeros / poles, poles) if not number else Notch(place, 0.6, 0.05) for number, place in enumerate(places)
                )
                turning = 2.0 * np.pi * first
                law = PI(1.0, zero * turning) if shape.corner is None else PID(1.0, zero * turning, 0.5 / turning, shape.corner)
                yield shape.point(law, notches)


def _highest_stable(within: Field, found: SearchResult) -> SearchResult | None:
    """Loops at the highest gains with a common factor, near the peak limit; `None` without any.

    Searched from above: gains beyond a mode may be stable where lower ones are not.
    """
    for scale in _SCALES[::-1]:
        moved = replace(found, points=tuple(point + np.log(scale) * (np.arange(len(point)) == 0) for point in found.points))
        whole = coupled_sensitivities(within.plants, moved, within.frequencies)
        if np.max(np.abs(whole[0])) <= _LOOSE * within.spec.sensitivity and _is_stable(whole) and _coupled_peak(within, whole) <= _LOOSE:
            return moved
    return None


def _bounds(spec: TuningSpec, frequency: float) -> Bounds:
    """Bounds of a loop: the objective at a frequency, and the specified requirements."""
    far = frequency if spec.objective in (TuningObjective.BALANCE, TuningObjective.REJECTION) else 0.0
    soon = SETTLED / frequency if spec.objective in (TuningObjective.BALANCE, TuningObjective.SETTLING) and frequency else np.inf
    return Bounds(
        max(far, spec.rejection or 0.0), min(soon, spec.settling or np.inf), spec.overshoot - _LEFT, plants=2 if spec.spread else 1
    )


def coupled_sensitivities(plants: Array, found: SearchResult, frequencies: Array) -> Array:
    """Compute the sensitivity (v, f, k, k) of k coupled loops, for v plants at their f frequencies."""
    return closed_by(plants, found.responses(frequencies))


def closed_by(plants: Array, responses: Array) -> Array:
    """Compute the sensitivity (v, f, k, k) of plants with controllers (v, f, k); for one or two loops by Cramer's rule, which is faster."""
    returned = np.eye(plants.shape[-1]) + plants * responses[..., None, :]
    if plants.shape[-1] > 2:
        return np.linalg.inv(returned)
    return _adjugate(returned) / _determinant(returned)[..., None, None]


def _adjugate(given: Array) -> Array:
    if given.shape[-1] == 1:
        return np.ones_like(given)
    return given[..., ::-1, ::-1].mT * np.array([[1.0, -1.0], [-1.0, 1.0]])


def _determinant(given: Array) -> Array:
    if given.shape[-1] == 1:
        return given[..., 0, 0]
    if given.shape[-1] == 2:
        return given[..., 0, 0] * given[..., 1, 1] - given[..., 0, 1] * given[..., 1, 0]
    return np.linalg.det(given)


def _coupled_peak(within: Field, whole: Array) -> float:
    """Highest singular value of S over all plants, relative to its limit."""
    return max(highest_gain(each)[0] / one.limit for each, one in zip(whole, within.variants, strict=True))


def excess(within: Field, found: SearchResult) -> float:
    """Compute the largest relative violation of the requirements."""
    return Joint(within, found, tuple(_all_bounds(within, [0.0] * len(within.alike))), 0.0).passed(found)
