"""Disk margins: simultaneous gain and phase variations of one loop, or of all loops (Seiler, Packard, Gahinet 2020)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np
import scipy

from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, Heading, Layout
from flexstage.base.units.quantity import ANGLE, FREQUENCY
from flexstage.control.robustness.singular import balance, lower_bound, scaled, upper_bound
from flexstage.control.robustness.stability import require_stable
from flexstage.control.systems.closed import Loop, LoopBreak, open_at, open_everywhere
from flexstage.control.systems.curves import dense_frequencies, sensitivity
from flexstage.control.systems.norm import Plane, level_crossings, peak, to_plane
from flexstage.control.systems.system import System

_SLACK = 1e-3
_MOST = 400
_TOPS = 8
_NEAR = 0.02
_TRUE = 1e-4


@dataclass(frozen=True)
class Edge:
    """Stability limit: a variation that makes a loop marginally stable, and its oscillation frequency [Hz] (NaN: no limit)."""

    value: float
    frequency: Annotated[float, FREQUENCY]


@dataclass(frozen=True)
class DiskMargin(InNotebook):
    """Disk margin alpha of all loops, each multiplied by a factor f_i = (1 + (1 - s) d_i/2)/(1 - (1 + s) d_i/2); s is the `skew`.

    The complex numbers d_i are the variations of the loops. Stability is guaranteed for all |d_i| < `guaranteed`; the proof covers every
    frequency if `covered`, else only sampled frequencies. Some d_i of magnitude `reached` >= `guaranteed` make the loop marginally stable
    at `frequency` [Hz]. `loops` names the varied loops. Each loop tolerates any gain factor from `gain_low` to `gain_high`, or any phase up
    to `phase` [rad], independently of the other loops.
    """

    TABLE: ClassVar[Layout] = Layout("Disk margin, all loops at once", "guaranteed gain_low gain_high phase")

    loops: tuple[str, ...]
    skew: float
    guaranteed: Annotated[float, Heading("disk margin", digits=3)]
    reached: float
    frequency: Annotated[float, FREQUENCY]
    covered: bool

    @property
    def gain_low(self) -> Annotated[float, INNER, Heading("gain reduction margin", digits=3)]:
        """Lowest guaranteed gain factor of every loop."""
        return (2.0 - self.guaranteed * (1.0 - self.skew)) / (2.0 + self.guaranteed * (1.0 + self.skew))

    @property
    def gain_high(self) -> Annotated[float, INNER, Heading("gain margin", digits=3)]:
        """Largest guaranteed gain factor of every loop."""
        below = 2.0 - self.guaranteed * (1.0 + self.skew)
        return (2.0 + self.guaranteed * (1.0 - self.skew)) / below if below > 0.0 else np.inf

    @property
    def phase(self) -> Annotated[float, ANGLE, INNER, Heading("phase margin", digits=3)]:
        """Guaranteed phase variation phi [rad] of every loop, of either sign.

        With the gain limits g_low and g_high, cos phi = (1 + g_low g_high)/(g_low + g_high).
        """
        low, high = self.gain_low, self.gain_high
        cosine = low if np.isinf(high) else (1.0 + low * high) / (low + high)
        return float(np.arccos(np.clip(cosine, -1.0, 1.0)))


def disk_margin(own: System, skew: float = 0.0) -> Edge:
    """Compute the disk margin alpha = 1/||S + (skew - 1)/2|| of a single loop L from its sensitivity S = 1/(1 + L).

    >>> from flexstage.control.example import integral_loop
    >>> whole = sensitivity(open_at(integral_loop(), LoopBreak.POSE))
    >>> disk_margin(whole).value <= 2.0
    True
    """
    found = peak(_shift(own, skew))
    return Edge(1.0 / found.value, found.frequency)


def disk_margins(closed: Loop, cut: LoopBreak | None, skew: float = 0.0) -> DiskMargin:
    """Compute the disk margin of all loops at once. The factors are applied at the poses, at the commands, or at both if `cut` is None.

    The margin is alpha = 1/sup mu(M) over all frequencies for M = S + (skew - 1)/2. S is the sensitivity, and mu is the structured singular
    value for a complex factor in every loop. An upper bound of mu is the minimum over diagonal matrices D of sigma(D M D^-1), the largest
    singular value. A lower bound is the maximum over diagonal matrices U of phase factors of rho(U M), the spectral radius. The upper bound
    is proved for all frequencies: with a fixed D, a Hamiltonian matrix gives the intervals in which sigma is below a level. This level is
    0.1 % above the highest value of sigma found. Further matrices D are computed until the intervals cover all frequencies. Raises
    `DesignError` for an unstable loop.

    >>> from flexstage.control.example import integral_loop
    >>> one = integral_loop()
    >>> found, alone = disk_margins(one, LoopBreak.POSE), disk_margin(sensitivity(open_at(one, LoopBreak.POSE)))
    >>> found.covered, abs(found.reached / alone.value - 1.0) < 1e-4, abs(found.guaranteed / alone.value - 1.0) < 2e-3
    (True, True, True)
    """
    require_stable(closed, "disk margins")
    open_loop = open_everywhere(closed) if cut is None else open_at(closed, cut)
    moved = _shift(sensitivity(open_loop), skew)
    frequencies = dense_frequencies(moved.poles, moved.step)
    lowest, highest, place = _search_bounds(moved, frequencies)
    level, covered = _guaranteed_level(moved, frequencies, highest * (1.0 + _SLACK))
    return DiskMargin(open_loop.output_names, skew, 1.0 / level, 1.0 / lowest, place, covered)


def _shift(own: System, skew: float) -> System:
    return replace(own, D=own.D + 0.5 * (skew - 1.0) * np.eye(len(own.D)))


def _search_bounds(moved: System, frequencies: Array) -> tuple[float, float, float]:
    """Highest upper and lower bounds, and the frequency of the lower bound: local maxima over frequency, refined."""
    matrices = moved.sweep(frequencies)
    sizes = np.linalg.svd(scaled(matrices, balance(matrices)), compute_uv=False)[:, 0]
    padded = np.concatenate([[-1.0], sizes, [-1.0]])
    tops = np.flatnonzero((sizes >= padded[:-2]) & (sizes >= padded[2:]))
    lowest, highest, place = 0.0, 0.0, np.nan
    for top in tops[np.argsort(-sizes[tops])][:_TOPS]:
        if sizes[top] < highest * (1.0 - _NEAR):
            break
        ends = float(frequencies[max(top - 1, 0)]), float(frequencies[min(top + 1, len(frequencies) - 1)])
        at, above = _local_maximum(moved, ends)
        below = lower_bound(moved.sweep(np.array([at]))[0])
        highest = max(highest, above)
        if below > lowest:
            lowest, place = below, at
    return lowest, highest, place


def _local_maximum(moved: System, ends: tuple[float, float]) -> tuple[float, float]:
    """Local maximum of the upper bound between two frequencies, and its frequency."""

    def below(frequency: float) -> float:
        return -_bound(moved, frequency)[0]

    options = {"xatol": 1e-7 * ends[1], "maxiter": 40}
    found: Any = scipy.optimize.minimize_scalar(below, bounds=ends, method="bounded", options=options)
    places = [float(found.x), *ends]
    heights = [-below(place) for place in places]
    best = int(np.argmax(heights))
    return places[best], heights[best]


def _bound(moved: System, frequency: float) -> tuple[float, Array]:
    matrix = moved.sweep(np.array([frequency]))
    return upper_bound(matrix[0], balance(matrix)[0])


def _guaranteed_level(moved: System, frequencies: Array, level: float) -> tuple[float, bool]:
    """Level proved to exceed mu at all frequencies, and whether the proof is complete."""
    end = np.inf if moved.step is None else 0.5 / moved.step
    plane = to_plane(moved)
    open_: list[tuple[float, float]] = [(0.0, end)]
    for _ in range(_MOST):
        if not open_:
            return level, True
        low, high = open_.pop()
        middle = _next_frequency(low, high, frequencies)
        size, logs = _bound(moved, middle)
        if size >= level / (1.0 + 0.5 * _SLACK):
            level, open_ = size * (1.0 + _SLACK), [*open_, (low, high)]
            continue
        scale = np.exp(logs)
        system = replace(plane.system, B=plane.system.B / scale, C=plane.system.C * scale[:, None], D=scaled(plane.system.D, logs))
        crossings = _true_crossings(replace(plane, system=system), moved, logs, level)
        below, above = crossings[crossings < middle], crossings[crossings > middle]
        left, right = max(below, default=-np.inf), min(above, default=np.inf)
        open_ += [piece for piece in ((low, min(left, high)), (max(right, low), high)) if piece[1] > piece[0]]
    return level, False


def _true_crossings(plane: Plane, moved: System, logs: Array, level: float) -> Array:
    """Frequencies where a singular value equals the level; eigenvalues near the axis add false ones."""
    found = level_crossings(plane, level)
    sizes = np.linalg.svd(scaled(moved.sweep(found), logs), compute_uv=False)
    return found[np.min(np.abs(sizes / level - 1.0), axis=1) < _TRUE]


def _next_frequency(low: float, high: float, frequencies: Array) -> float:
    """Next frequency in an interval: the middle one of those that resolve the loop, else a mean."""
    inside = frequencies[(frequencies > low) & (frequencies < high)]
    if len(inside):
        return float(inside[len(inside) // 2])
    if np.isinf(high):
        return 2.0 * max(low, float(frequencies[-1]))
    return 0.5 * (low + high)
