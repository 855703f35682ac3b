"""Margins of a loop: gain, phase, delay and disk margin of one loop at a time; peaks of S and T; bandwidths; crosstalk."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Along, Heading, Layout, Mark
from flexstage.base.units.quantity import ANGLE, FREQUENCY, RATIO, SHORT_TIME
from flexstage.control.robustness.disk import Edge, disk_margin
from flexstage.control.robustness.stability import require_stable
from flexstage.control.systems.closed import Loop, LoopBreak, loop, open_at
from flexstage.control.systems.curves import Curves, curves, roots, sensitivity
from flexstage.control.systems.norm import Peak, peak
from flexstage.control.systems.system import System, select
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

_AT_REST = 1e-8
_USUAL_DISK = 0.5


def _grade_disk(alpha: float) -> Mark:
    return Mark.PLAIN if alpha > _USUAL_DISK else Mark.WARN


@dataclass(frozen=True)
class ChannelMargins:
    """Stability margins of one loop, with the other loops closed.

    The loop is stable for gain factors between `gain_low` < 1 and `gain_high` > 1 (0 and infinite: no limit). The loop is also stable for
    phases up to `phase` [rad] of either sign, and for delays up to `delay` [s] (factors e^{-j omega tau} of a delay tau). `disk` is alpha
    of the balanced disk margin: the loop is stable with any complex factor (1 + d/2)/(1 - d/2), |d| < alpha, which changes gain and phase
    *together*.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Stability margins",
        "gain_low.value gain_high.value phase.value delay.value disk.value",
        head="coordinate",
        notes=(
            (
                "One loop at a time, opened at the pose with the others closed. Disk margin alpha <= 2: the loop is stable with any "
                "complex factor (1 + d/2)/(1 - d/2), |d| < alpha, which changes gain and phase together."
            ),
        ),
    )

    channel: Annotated[str, INNER]
    gain_low: Annotated[Edge, Heading("gain reduction margin", digits=3)]
    gain_high: Annotated[Edge, Heading("gain margin", digits=3)]
    phase: Annotated[Edge, ANGLE, Heading("phase margin", digits=4)]
    delay: Annotated[Edge, SHORT_TIME, Heading("delay margin", digits=4)]
    disk: Annotated[Edge, Heading("disk margin", digits=3, mark=_grade_disk)]


@dataclass(frozen=True)
class Margins(InNotebook):
    """Margins of the loops opened at `cut`, one at a time."""

    cut: LoopBreak
    channels: Annotated[tuple[ChannelMargins, ...], INNER]

    @property
    def loops(self) -> Annotated[Mapping[str, ChannelMargins], VIEW]:
        """Margins by channel."""
        return {each.channel: each for each in self.channels}

    def of(self, channel: str) -> ChannelMargins:
        """Return the margins of the loop with the name `channel`."""
        return self.loops[channel]


@check_arguments
def margins(closed: Loop, cut: LoopBreak, found: Curves | None = None) -> Margins:
    """Compute margins of one loop at a time: this loop is opened at `cut`, and all other loops are closed.

    `found` can contain the `curves` at `cut`, which are otherwise computed. Gain limits occur where the open loop L_i is real and negative:
    its sensitivity S_ii = 1/(1 + L_i) is then real, and below 0 or above 1. Phase and delay limits occur where |L_i| = 1: the real part of
    S_ii is then 1/2. All limits are exact to rounding error. The disk margin is alpha_i = 1/||S_ii - 1/2||; the norm is the largest
    magnitude over all frequencies (Seiler, Packard, Gahinet, IEEE Control Systems 40, 2020). Raises `DesignError` for an unstable loop.

    >>> from flexstage.control.example import integral_loop
    >>> found = margins(integral_loop(), LoopBreak.POSE).of("x")
    >>> round(found.gain_high.value, 2), round(found.phase.value, 2), found.gain_low.value
    (4.49, 1.56, 0.0)
    """
    require_stable(closed, "margins")
    found, whole = found or curves(closed, cut), sensitivity(open_at(closed, cut))
    return Margins(cut, tuple(_channel(found, whole, number) for number in range(len(found.names))))


def _channel(found: Curves, whole: System, number: int) -> ChannelMargins:
    low, high = _gains(found, number)
    phase, delay = _phases(found, number)
    name = whole.output_names[number]
    return ChannelMargins(found.names[number], low, high, phase, delay, disk_margin(select(whole, [name], [name])))


def _gains(found: Curves, number: int) -> tuple[Edge, Edge]:
    """Nearest gains below and above 1 at which L_i = -1/k, including both ends of the frequencies, where L_i is real."""
    places, own = found.crossings(np.imag, number)
    ends = np.array([0.0] if found.response.step is None else [0.0, 0.5 / found.response.step])
    places, own = np.append(places, ends), np.append(own, found.response.sweep(ends)[:, number, number])
    with np.errstate(divide="ignore", invalid="ignore"):
        gains = 1.0 / (1.0 - 1.0 / np.real(own))
    edges = [(float(gain), float(place)) for gain, place in zip(gains, places, strict=True) if _AT_REST < gain < np.inf]
    below = max((edge for edge in edges if edge[0] < 1.0), default=(0.0, np.nan))
    above = min((edge for edge in edges if edge[0] > 1.0), default=(np.inf, np.nan))
    return Edge(*below), Edge(*above)


def _phases(found: Curves, number: int) -> tuple[Edge, Edge]:
    """Smallest phase and delay that move L_i with |L_i| = 1 to -1."""
    places, own = found.crossings(lambda own: np.real(own) - 0.5, number)
    turns = np.angle(-(1.0 / own - 1.0))
    delays = (turns % (2.0 * np.pi)) / (2.0 * np.pi * places)
    limits = (zip(each.tolist(), places.tolist(), strict=True) for each in (np.abs(turns), delays))
    phase, delay = (Edge(*min(each, default=(np.inf, np.nan))) for each in limits)
    return phase, (Edge(0.0, np.inf) if _has_direct_gain(found.response.D[number, number], found.response.step) else delay)


def _has_direct_gain(own: complex, step: float | None) -> bool:
    """Whether the high-frequency gain of a continuous loop is 1 or more, with S = 1/(1 + L): then every delay destabilises it."""
    return step is None and abs(own) <= abs(1.0 - own)


@dataclass(frozen=True)
class Peaks(InNotebook):
    """Peaks of S = (I + L)^-1 and T = I - S at a `cut`, for the open loops L: the largest singular values over all frequencies.

    At the pose, rotations are multiplied by the stage's length; commands are not scaled.
    """

    cut: LoopBreak
    sensitivity: Peak
    complementary: Peak


def peaks(closed: Loop, cut: LoopBreak) -> Peaks:
    """Compute the H-infinity norms of S and T. Raises `DesignError` for an unstable loop.

    >>> from flexstage.control.example import integral_loop
    >>> peaks(integral_loop(), LoopBreak.POSE).sensitivity.value > 1.0
    True
    """
    require_stable(closed, "peaks of S and T")
    whole = sensitivity(open_at(closed, cut))
    scale = closed.plant.coordinates.scale if cut is LoopBreak.POSE else np.ones(len(closed.plant.actuators))
    scaled = replace(whole, B=whole.B / scale, C=whole.C * scale[:, None], D=whole.D * scale[:, None] / scale)
    rest = replace(scaled, C=-scaled.C, D=np.eye(len(scale)) - scaled.D)
    return Peaks(cut, peak(scaled), peak(rest))


@dataclass(frozen=True)
class ShiftedPeak:
    """Larger peak sensitivity Ms of two loops: all modes shifted up, or all down, by a relative `shift`; infinite if a loop is unstable."""

    TABLE: ClassVar[Layout] = Layout("Peak sensitivity Ms, all modes shifted up or down", "peak", head="shift")

    shift: Annotated[float, RATIO]
    peak: Annotated[float, Heading("peak sensitivity Ms", digits=4, infinite="unstable")]


def shifted_peaks(closed: Loop, shifts: Iterable[float] = (0.0, 0.02, 0.05, 0.1)) -> tuple[ShiftedPeak, ...]:
    """Compute the peak sensitivity at the pose of a sampled loop, with all modes shifted up and down by each of the relative `shifts`.

    Only the time scale of the plant changes, not the time scale of the controller.

    >>> from flexstage.control.example import integral_loop
    >>> [round(each.peak, 2) for each in shifted_peaks(integral_loop(), (0.0, 0.1))]
    [1.43, 1.52]
    """
    return tuple(ShiftedPeak(shift, max(_shifted_peak(closed, offset) for offset in {-shift, shift})) for shift in shifts)


def _shifted_peak(closed: Loop, offset: float) -> float:
    given, slower = closed.plant.hardware, 1.0 + offset
    hardware = replace(given, rate=None if given.rate is None else given.rate / slower, delay=given.delay * slower)
    moved = loop(replace(closed.plant, hardware=hardware), replace(closed.controller, step=hardware.step))
    return peaks(moved, LoopBreak.POSE).sensitivity.value if moved.system.growth < 0.0 else np.inf


@dataclass(frozen=True, eq=False)
class Bandwidths(InNotebook):
    """Bandwidths [Hz] (n,) by coordinate: the lowest frequencies at which magnitudes cross a limit (NaN: no crossing).

    At `tracking`, the true motion falls 3 dB below its reference. At `complementary`, the complementary sensitivity |T_ii| falls 3 dB below
    1. At `rejection`, the sensitivity |S_ii| rises through 1: above this frequency, the loop amplifies disturbances. At `half_rejection`,
    |S_ii| rises through -3 dB.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Bandwidth",
        "tracking rejection",
        notes=(
            (
                "Closed-loop bandwidth: where the true motion is 3 dB below its reference. Sensitivity crossover: where abs(S) = 1; above "
                "it, the loop amplifies disturbances."
            ),
        ),
    )

    coordinates: tuple[str, ...]
    tracking: Annotated[Array, FREQUENCY, Along("coordinates"), Heading("closed-loop bandwidth (-3 dB)", digits=4)]
    complementary: Annotated[Array, FREQUENCY, Along("coordinates")]
    rejection: Annotated[Array, FREQUENCY, Along("coordinates"), Heading("sensitivity crossover", digits=4)]
    half_rejection: Annotated[Array, FREQUENCY, Along("coordinates")]


def bandwidths(closed: Loop, found: Curves | None = None) -> Bandwidths:
    """Compute the bandwidths of all coordinates; `found` are the `curves` at the pose if already known.

    Raises `DesignError` for an unstable loop.

    >>> from flexstage.control.example import integral_loop
    >>> found = bandwidths(integral_loop(gain=100.0))
    >>> found.tracking.round(1).tolist(), found.complementary.round(1).tolist()  # about 100/(2 pi)
    ([15.9], [15.9])
    """
    require_stable(closed, "bandwidths")
    found = found or curves(closed, LoopBreak.POSE)
    level, loops = np.sqrt(0.5), range(len(found.names))
    risen: tuple[Callable[[Array], Array], ...] = (
        lambda own: level - np.abs(1.0 - own),
        lambda own: np.abs(own) - 1.0,
        lambda own: np.abs(own) - level,
    )
    tracking = np.array([_tracking(closed, found, number) for number in loops])
    return Bandwidths(found.names, tracking, *(np.array([_rise(found, number, of) for number in loops]) for of in risen))


def _rise(found: Curves, number: int, of: Callable[[Array], Array]) -> float:
    """First upward zero crossing of a function of S_ii."""
    values = of(found.sensitivity[:, number, number])
    return _first_rise(found.frequencies, values, lambda points: of(found.response.sweep(points)[:, number, number]))


def _first_rise(frequencies: Array, values: Array, of: Callable[[Array], Array]) -> float:
    if values[0] >= 0.0:
        return 0.0
    places = np.flatnonzero((values[1:] >= 0.0) & (values[:-1] < 0.0))[:1]
    if not len(places):
        return np.nan
    ends = frequencies[places], frequencies[places + 1]
    return float(roots(of, ends, (values[places], values[places + 1]))[0])


def _tracking(closed: Loop, found: Curves, number: int) -> float:
    name = found.names[number]
    response = select(closed.system, [f"reference.{name}"], [f"relative.{name}"])

    def below(points: Array) -> Array:
        return np.sqrt(0.5) - np.abs(response.sweep(points)[:, 0, 0])

    return _first_rise(found.frequencies, below(found.frequencies), below)


def crosstalk(closed: Loop) -> Matrix:
    """Compute static crosstalk: all six platform motions relative to the ground, per unit of each commanded coordinate.

    Motion in the commanded coordinate is tracking, all other motion is crosstalk. Raises `DesignError` for an unstable loop.

    >>> from flexstage.control.example import integral_loop
    >>> round(float(crosstalk(integral_loop()).at("x", "x")), 9)
    1.0
    """
    require_stable(closed, "crosstalk")
    names = closed.plant.coordinates.names
    chosen = select(closed.system, [f"reference.{name}" for name in names], [f"relative.{name}" for name in COMPONENTS])
    return Matrix(chosen.transfer(np.zeros(1))[0].real, COMPONENTS, names, ratio_units(TWIST_UNITS, closed.plant.coordinates.units))
