"""Profiles of flexure hinges: thickness of the cross-section along the hinge.

A profile gives the half length a of the hinge and the height w(s) >= 0 added on each side. The station s in [-1, 1] is at x = a s. The
thickness at the station is t + 2 w.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, ClassVar, TypeAlias

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.base.storage.digest import Description
from flexstage.base.units.quantity import ANGLE, LENGTH, NOT_NEGATIVE, POSITIVE, RATIO, Bound


@dataclass(frozen=True, eq=False)
class Circular(Description):
    """Circular profile of two half-circle cuts of radius R; at x = R sin p, -90 <= p <= 90 degrees, the height is w = R (1 - cos p)."""

    radius: Annotated[Number, LENGTH, POSITIVE]


@dataclass(frozen=True, eq=False)
class Elliptic(Description):
    """Elliptic profile of two half-ellipse cuts, height w = c (1 - cos p) at x = a sin p: `along` = a, `across` = c (c = 0: leaf)."""

    along: Annotated[Number, LENGTH, POSITIVE]
    across: Annotated[Number, LENGTH, POSITIVE]


@dataclass(frozen=True, eq=False)
class Filleted(Description):
    """Corner-filleted profile: a straight middle with quarter-circle end fillets; total `length` l, fillet `radius` r, 2 r <= l."""

    length: Annotated[Number, LENGTH, POSITIVE]
    radius: Annotated[Number, LENGTH, POSITIVE]


@dataclass(frozen=True, eq=False)
class Straight(Description):
    """Straight profile: a prismatic hinge of constant section, `length` l."""

    length: Annotated[Number, LENGTH, POSITIVE]


class Contour(Description):
    """Profile specified by the height of its cuts as a function of the station, symmetric about the middle.

    `TOLD_BY` contains the key and the name that identify the profile's class in files. At both ends, the profile meets the adjacent blocks
    at an angle.
    """

    TOLD_BY: ClassVar[tuple[str, str]]

    @property
    def span(self) -> Number:
        """Total length [m]."""
        raise NotImplementedError

    @property
    def rise(self) -> Number:
        """Height of the cuts at both ends [m]."""
        raise NotImplementedError

    @property
    def radius_at_throat(self) -> Number | None:
        """Radius of curvature at the thinnest point [m]; `None` if there is no unique thinnest point."""
        return None

    @property
    def has_arc(self) -> bool:
        """Whether the thickness is smallest only in the middle."""
        return True

    @property
    def knots(self) -> tuple[float, ...]:
        """Boundaries [m] of the profile's smooth pieces, from the middle to an end (both included), for the first design."""
        return 0.0, 0.5 * single(self.span)

    def height(self, station: Array) -> Array:
        """Return the height of the cuts [m] at stations [m] from the middle, for the first design; zero beyond the ends."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class _Conic(Contour):
    """Curve of half length `along` and height `across`."""

    along: Annotated[Number, LENGTH, POSITIVE]
    across: Annotated[Number, LENGTH, POSITIVE]

    @property
    def span(self) -> Number:
        """Twice `along` [m]."""
        return 2.0 * self.along

    @property
    def rise(self) -> Number:
        """`across` [m]."""
        return self.across

    def _share(self, station: Array) -> Array:
        return np.abs(station) / single(self.along)


@dataclass(frozen=True, eq=False)
class Parabolic(_Conic):
    """Parabolic profile of height w = c (x/a)^2: `along` = a is half the length, `across` = c (Lobontiu et al., Precis. Eng. 26, 2002)."""

    TOLD_BY: ClassVar[tuple[str, str]] = ("shape", "parabolic")

    @property
    def radius_at_throat(self) -> Number:
        """Radius of curvature at the thinnest point, a^2 / (2 c) [m], with a = `along` and c = `across`."""
        return self.along * self.along / (2.0 * self.across)

    def height(self, station: Array) -> Array:
        """Return the height of the cuts, c (x/a)^2 [m]."""
        return single(self.across) * self._share(station) ** 2


@dataclass(frozen=True, eq=False)
class Hyperbolic(_Conic):
    """Hyperbolic profile of height w = (q^2 + c (c + 2 q) (x/a)^2)^(1/2) - q: half length `along` = a, `across` = c, `semi_axis` = q.

    The semi-axis q of the hyperbola is perpendicular to the hinge's axis. If q is half the thickness, both cuts are branches of one
    hyperbola (Lobontiu et al., Precision Engineering 26, 2002). A large q gives a parabola; a small q gives straight flanks with a corner.
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("shape", "hyperbolic")
    semi_axis: Annotated[Number, LENGTH, POSITIVE]

    @property
    def steepness(self) -> Number:
        """Squared ratio of half the length to the hyperbola's semi-axis along x: c (c + 2 q) / q^2, c = `across`, q = `semi_axis`."""
        share = self.across / self.semi_axis
        return share * (share + 2.0)

    @property
    def radius_at_throat(self) -> Number:
        """Radius of curvature at the thinnest point, a^2 q / (c (c + 2 q)) [m], with a = `along`, c = `across`, q = `semi_axis`."""
        return self.along * self.along / (self.semi_axis * self.steepness)

    def height(self, station: Array) -> Array:
        """Return the height of the cuts, q ((1 + (c (c + 2 q) / q^2) (x/a)^2)^(1/2) - 1) [m]."""
        inside = single(self.steepness) * self._share(station) ** 2
        return single(self.semi_axis) * inside / (np.sqrt(1.0 + inside) + 1.0)


@dataclass(frozen=True, eq=False)
class Power(_Conic):
    """Power-function profile of height w = c |x/a|^n: `along` = a is half the length, `across` = c, `exponent` = n.

    n = 1 gives straight flanks with a corner, n = 2 gives a parabola, and a large n gives nearly a leaf. Reference: Linss, Henning &
    Zentner (Modeling and design of flexure hinge-based compliant mechanisms, in Kinematics, 2019).
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("shape", "power")
    exponent: Annotated[Number, RATIO, Bound(low=1.0, high=16.0)]

    def height(self, station: Array) -> Array:
        """Return the height of the cuts, c |x/a|^n [m]."""
        return single(self.across) * self._share(station) ** single(self.exponent)


@dataclass(frozen=True, eq=False)
class Vee(Contour):
    """V-shaped profile: straight flanks with the `angle` between them, and a tip of `radius` r; `length` is from end to end.

    The slope of a flank is e = (180 degrees - angle)/2. On the arc of the tip, the height at x = r sin p is w = r (1 - cos p), from p = 0
    to p = e; the flank begins at the end of the arc.
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("shape", "v")
    length: Annotated[Number, LENGTH, POSITIVE]
    radius: Annotated[Number, LENGTH, POSITIVE]
    angle: Annotated[Number, ANGLE, Bound(low=0.0, high=np.pi, open_low=True, open_high=True)]

    @property
    def slope(self) -> Number:
        """Angle e between a flank and the hinge's axis [rad]."""
        return 0.5 * (np.pi - self.angle)

    @property
    def tip(self) -> Number:
        """Distance of the end of the tip's arc from the middle, r sin e [m]."""
        return self.radius * np.sin(self.slope)

    @property
    def span(self) -> Number:
        """Total length [m]."""
        return self.length

    @property
    def rise(self) -> Number:
        """Height of the cuts at both ends: r (1 - cos e) plus the height of the flank [m]."""
        return 2.0 * self.radius * np.sin(0.5 * self.slope) ** 2 + (0.5 * self.length - self.tip) * np.tan(self.slope)

    @property
    def radius_at_throat(self) -> Number:
        """Radius of curvature at the thinnest point [m]: the radius of the tip."""
        return self.radius

    @property
    def knots(self) -> tuple[float, ...]:
        """Boundaries [m] of the smooth pieces: the middle, the end of the arc, and the end of the flank if there is one."""
        tip, half = single(self.tip), 0.5 * single(self.length)
        return (0.0, tip, half) if tip < half else (0.0, half)

    def height(self, station: Array) -> Array:
        """Return the height of the cuts [m], on the arc or the flank."""
        radius, tip, slope = single(self.radius), single(self.tip), np.tan(single(self.slope))
        on_arc = np.minimum(np.abs(station), tip)
        return radius - np.sqrt(radius * radius - on_arc * on_arc) + slope * (np.abs(station) - on_arc)


@dataclass(frozen=True, eq=False)
class FreeForm(Contour):
    """Free-form profile from a table: `heights` of the cuts at the distances `stations` from the middle. The least height is zero.

    Between stations, the profile is a cubic Hermite spline with the slopes of Fritsch & Butland (SIAM J. Sci. Stat. Comput. 5, 1984). The
    spline is the PCHIP interpolation of the table together with its mirror image. The profile is therefore smooth, and each height is
    between the heights of the two adjacent stations.
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("shape", "free")
    stations: tuple[Annotated[Number, LENGTH, NOT_NEGATIVE], ...]
    heights: tuple[Annotated[Number, LENGTH, NOT_NEGATIVE], ...]

    @property
    def span(self) -> Number:
        """Total length: twice the last station [m]."""
        return 2.0 * self.stations[-1]

    @property
    def rise(self) -> Number:
        """Height at both ends: the last height [m]."""
        return self.heights[-1]

    @property
    def has_arc(self) -> bool:
        """Whether the height is zero only in the middle."""
        return single(self.heights[0]) == 0.0 < min(single(height) for height in self.heights[1:])

    @property
    def knots(self) -> tuple[float, ...]:
        """Boundaries [m] of the smooth pieces: the stations."""
        return tuple(single(station) for station in self.stations)

    @property
    def slopes(self) -> tuple[Number, ...]:
        """Slope at every station: zero in the middle and at extremes, else a weighted harmonic mean of the two adjacent secant slopes."""
        steps = [right - left for left, right in pairwise(self.stations)]
        rates = [(high - low) / step for (low, high), step in zip(pairwise(self.heights), steps, strict=True)]
        inner = [_mean_slope(*each) for each in zip(pairwise(steps), pairwise(rates), strict=True)]
        return 0.0, *inner, _end_slope(steps, rates)

    def pieces(self) -> Iterator[tuple[Number, Number, tuple[Number, Number, Number, Number]]]:
        """Yield start [m], length [m] and coefficients (constant first) of each cubic piece, a polynomial in (x - start) / length."""
        for (left, right), (low, high), (start, end) in zip(*map(pairwise, (self.stations, self.heights, self.slopes)), strict=True):
            step, change = right - left, high - low
            yield left, step, (low, step * start, 3.0 * change - step * (2.0 * start + end), step * (start + end) - 2.0 * change)

    def height(self, station: Array) -> Array:
        """Return the height of the cuts [m] at stations [m] from the middle."""
        result, away = np.zeros(np.shape(station)), np.abs(station)
        for left, step, cubic in self.pieces():
            share = (away - single(left)) / single(step)
            here = np.polynomial.polynomial.polyval(share, [single(each) for each in cubic])
            result = np.where(share >= 0.0, here, result)
        return result


def _mean_slope(steps: tuple[Number, Number], rates: tuple[Number, Number]) -> Number:
    """Weighted harmonic mean of two rates of one sign, else zero."""
    (one, two), (first, second) = steps, rates
    alike = np.real(first) * np.real(second) > 0.0
    left, right = (np.where(alike, rate, 1.0) for rate in rates)
    mean = 3.0 * (one + two) / ((2.0 * two + one) / left + (two + 2.0 * one) / right)
    return np.where(alike, mean, 0.0)


def _end_slope(steps: list[Number], rates: list[Number]) -> Number:
    """Slope at the end: of the parabola through three points, limited to the last rate's sign, and to three times it at an extreme."""
    last = rates[-1]
    before, step = (rates[-2], steps[-2]) if len(rates) > 1 else (-last, steps[-1])
    slope = ((2.0 * steps[-1] + step) * last - steps[-1] * before) / (steps[-1] + step)
    turned = np.real(slope) * np.real(last) <= 0.0
    steep = (np.real(last) * np.real(before) <= 0.0) & (np.abs(np.real(slope)) > 3.0 * np.abs(np.real(last)))
    return np.where(turned, 0.0, np.where(steep, 3.0 * last, slope))


_ARC = np.deg2rad([0.0, 45.0, 90.0])
_SHARES = np.linspace(0.0, 1.0, 5)

Profile: TypeAlias = Circular | Elliptic | Filleted | Straight | Parabolic | Hyperbolic | Power | Vee | FreeForm


def length(profile: Profile) -> Number:
    """Return the total length of the hinge from end to end of the profile [m].

    >>> length(Circular(0.005)), length(Straight(0.013))
    (0.01, 0.013)
    """
    if isinstance(profile, Circular):
        return 2.0 * profile.radius
    if isinstance(profile, Elliptic):
        return 2.0 * profile.along
    return profile.span if isinstance(profile, Contour) else profile.length


def rise(profile: Profile) -> Number:
    """Return the height of the profile's cuts at its ends, w(+-1) [m].

    >>> rise(Circular(0.005))
    0.005
    """
    if isinstance(profile, Circular):
        return profile.radius
    if isinstance(profile, Elliptic):
        return profile.across
    if isinstance(profile, Contour):
        return profile.rise
    return profile.radius if isinstance(profile, Filleted) else 0.0


def closing(profile: Profile, thickness: Number) -> float:
    """Return the angle [rad] of rotation at which the faces of a cut touch, 2 atan(a / (w + t/2)); infinite for a straight profile.

    Here a is half the hinge's length, w is the height of the cuts at the ends, and t is the `thickness`.

    >>> round(closing(Circular(0.005), 0.0) / np.pi, 9), closing(Straight(0.005), 0.001)
    (0.5, inf)
    """
    if isinstance(profile, Straight):
        return np.inf
    return 2.0 * float(np.arctan2(0.5 * single(length(profile)), single(rise(profile)) + 0.5 * single(thickness)))


def stations_of(profile: Profile) -> tuple[Array, Array]:
    """Return stations x (s,) from end to end and the added height w (s,) on each side [m], for the first design.

    >>> stations, heights = stations_of(Circular(0.005))
    >>> float(stations[0]), heights.round(6).tolist()
    (-0.005, [0.005, 0.001464, 0.0, 0.001464, 0.005])
    """
    half = 0.5 * single(length(profile))
    if isinstance(profile, Contour):
        right = np.unique(np.concatenate([start + (end - start) * _SHARES for start, end in pairwise(profile.knots)]))
        heights = profile.height(right)
    elif isinstance(profile, (Circular, Elliptic)):
        right, heights = half * np.sin(_ARC), single(rise(profile)) * (1.0 - np.cos(_ARC))
    elif isinstance(profile, Filleted):
        radius = single(profile.radius)
        arc = _ARC[int(half <= radius) :]
        right, heights = half - radius + radius * np.sin(arc), radius * (1.0 - np.cos(arc))
    else:
        right, heights = np.array([half]), np.array([0.0])
    away = right > 0.0
    return np.concatenate([-right[away][::-1], right]), np.concatenate([heights[away][::-1], heights])


def single(value: Number) -> float:
    """Return the value of the first design, as a float.

    >>> single(np.array([1.0, 2.0]))
    1.0
    """
    return float(np.real(np.ravel(value)[0]))
