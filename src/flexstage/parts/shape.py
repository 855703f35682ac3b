"""Interface of parts: kind, degrees of freedom and, for parts with a shape, geometry.

Outlines, pictures, contact checks, buckling and finite elements use only this interface, for every kind of part. A new kind of part derives
from `Shaped`, or from `Profiled` if cuts reduce its thickness towards the middle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from functools import reduce
from itertools import pairwise
from typing import ClassVar, Self

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number
from flexstage.base.storage.digest import Description
from flexstage.base.units.quantity import LENGTH, RATIO, Bound, Quantity
from flexstage.parts.freedom import Freedom
from flexstage.parts.material import Material
from flexstage.parts.profile import (
    Circular,
    Contour,
    Elliptic,
    Filleted,
    FreeForm,
    Profile,
    Straight,
    Vee,
    closing,
    length,
    rise,
    single,
    stations_of,
)
from flexstage.parts.section import Section
from flexstage.parts.stated import Stated


@dataclass(frozen=True, eq=False)
class Order:
    """Required inequality between two values of a part: `small`, the value of `field`, must be below `large`, which `other` names.

    If not `strict`, the two values may be equal.
    """

    field: str
    small: Number | None
    large: Number | None
    other: str
    advice: str
    quantity: Quantity = LENGTH
    strict: bool = True


INNER_MODES = Bound(0.0, 20.0)
"""Allowed number of internal modes of a part for each degree of freedom."""


class Elastic(Description):
    """Elastic part; `kind` is the name of its kind in design files. `parts.PARTS` lists the kinds."""

    kind: ClassVar[str]
    inner_modes: int = 0
    """Number of fixed-interface modes for each ideal degree of freedom."""

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom of the part."""
        raise NotImplementedError

    @property
    def orders(self) -> Iterator[Order]:
        """Required inequalities between the part's values."""
        yield from ()

    @property
    def push(self) -> Number | None:
        """Preload [N] along x that pushes the part's ends apart; negative if it pulls the ends together."""
        return None

    @property
    def strut(self) -> Number | None:
        """Length [m] between the pivots of a part without a shape; `None` if the part acts at one point."""
        return None

    def stated(self, material: Material | None) -> Stated | None:  # noqa: ARG002  (kinds that are known by a material need it)
        """Return the specified matrices between the part's ends; `None` for a part with a shape."""
        return None

    @property
    def is_axisymmetric(self) -> bool:
        """Whether the part is axisymmetric; links with an axisymmetric part require no `bends`."""
        return True

    @property
    def mirrored(self) -> Elastic | None:
        """Mirror image in the x-z plane. If the mirror image is `None`, instances with this part cannot be mirrored."""
        return None

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors of the part's values, except violated inequalities (see `orders`)."""
        yield from ()


class Shaped(Elastic):
    """Part with a shape: x axis along the part, origin at its centre, symmetric about the three coordinate planes.

    Each kind of part implements `span` and `throat`. The other properties have defaults for a constant section; `Profiled` parts override
    these defaults. A `slender` part bends along its whole length: one end may shift sideways relative to the other.
    """

    material: str
    slender: ClassVar[bool] = False

    @property
    def is_axisymmetric(self) -> bool:
        """Whether the part's thinnest section is axisymmetric."""
        return self.throat.is_axisymmetric

    @property
    def bends_both_ways(self) -> bool:
        """Whether the ideal degrees of freedom of the part include rotations about both y and z."""
        return {Freedom.RY, Freedom.RZ} <= set(self.intended)

    @property
    def bent(self) -> dict[str, Number]:
        """Specified curvature about z and temperature difference of the faces, by field; empty if the free part is straight."""
        own = {name: getattr(self, name, None) for name in ("curvature", "face_temperature_difference")}
        return {name: value for name, value in own.items() if value is not None}

    @property
    def is_bent(self) -> bool:
        """Whether the part is curved when free."""
        return bool(self.bent)

    @property
    def straight(self) -> Self:
        """The same part, straight when free."""
        return replace(self, **dict.fromkeys(self.bent))  # type: ignore[type-var]

    @property
    def mirrored(self) -> Elastic | None:
        """The part with the opposite curvature; without curvature, the part itself, by symmetry."""
        return replace(self, **{name: -value for name, value in self.bent.items()}) if self.is_bent else self  # type: ignore[type-var]

    @property
    def span(self) -> Number:
        """Length from end to end [m]."""
        raise NotImplementedError

    @property
    def throat(self) -> Section:
        """Thinnest cross-section."""
        raise NotImplementedError

    @property
    def end(self) -> Section:
        """Section at both ends."""
        return self.throat

    @property
    def is_prismatic(self) -> bool:
        """Whether the section is constant."""
        return True

    @property
    def has_arc(self) -> bool:
        """Whether the part is thinnest at a single station, not over a length."""
        return False

    @property
    def closing(self) -> float:
        """Rotation [rad] at which the two faces of a cut touch, for the first design; infinite without a cut."""
        return np.inf

    @property
    def silhouette(self) -> tuple[tuple[float, Section], ...]:
        """Stations x [m] from end to end, at least two, with the section at each station, for the first design."""
        half = 0.5 * single(self.span)
        ends = ((-half, self.end.first), (half, self.end.first))
        return ends if self.is_prismatic else (ends[0], (0.0, self.throat.first), ends[1])

    def section_at(self, stations: Array) -> Section:
        """Return the section at stations [m], linearly interpolated between the sections of `silhouette`, for the first design."""
        places, sections = zip(*self.silhouette, strict=True)
        names = [item.name for item in fields(sections[0])]
        return replace(sections[0], **{name: np.interp(stations, places, [getattr(each, name) for each in sections]) for name in names})


class Profiled(Shaped):
    """Part with a `profile` of cuts that reduce its height on both sides; some kinds also reduce their width (see `grown`)."""

    thickness: Number
    profile: Profile

    def grown(self, up: Number) -> Section:
        """Return the section at a profile height `up` [m]."""
        raise NotImplementedError

    @property
    def span(self) -> Number:
        """Length from end to end of the profile [m]."""
        return length(self.profile)

    @property
    def throat(self) -> Section:
        """Section at the deepest point of the cuts."""
        return self.grown(0.0)

    @property
    def end(self) -> Section:
        """Section at the ends of the cuts."""
        return self.grown(rise(self.profile))

    @property
    def is_prismatic(self) -> bool:
        """Whether the part's profile is straight."""
        return isinstance(self.profile, Straight)

    @property
    def has_arc(self) -> bool:
        """Whether the profile is thinnest at a single station."""
        return self.profile.has_arc if isinstance(self.profile, Contour) else isinstance(self.profile, (Circular, Elliptic))

    @property
    def closing(self) -> float:
        """Rotation [rad] at which the two faces of a cut touch, computed from the cut's width and depth."""
        return closing(self.profile, self.thickness)

    @property
    def silhouette(self) -> tuple[tuple[float, Section], ...]:
        """Stations x [m] from end to end, denser on arcs, with the section at each station."""
        return tuple((float(x), self.grown(float(up)).first) for x, up in zip(*stations_of(self.profile), strict=True))

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the fillets or the arc of a V's tip fit into the length; the stations of a table increase from the middle outwards."""
        if isinstance(self.profile, Filleted):
            advice = "Two fillets require 2 r of the length: increase the length or reduce the radius"
            yield Order("profile.radius", self.profile.radius, 0.5 * self.profile.length, "half the length", advice, strict=False)
        if isinstance(self.profile, Vee):
            most = 0.5 * self.profile.length / np.sin(self.profile.slope)
            advice = "Increase the length or the angle, or reduce the radius"
            yield Order("profile.radius", self.profile.radius, most, "the radius of an arc over the whole length", advice, strict=False)
        if isinstance(self.profile, FreeForm):
            yield from _table_orders(self.profile)


def _table_orders(table: FreeForm) -> Iterator[Order]:
    """Order of a table: one height per station, two at least, ascending from the middle, heights relative to the least."""
    stations, heights = table.stations, table.heights
    counts = (float(len(stations)), float(len(heights)))
    both, few = "Specify one height per station", "Specify the middle, an end, and stations between"
    yield Order("profile.stations", counts[0], counts[1], "the number of heights", both, RATIO, strict=False)
    yield Order("profile.heights", counts[1], counts[0], "the number of stations", both, RATIO, strict=False)
    yield Order("profile.stations", 2.0, counts[0], "the number of stations", few, RATIO, strict=False)
    if stations:
        yield Order("profile.stations.0", stations[0], 0.0, "the middle of the hinge", "Begin with 0 mm", strict=False)
    for place, (near, far) in enumerate(pairwise(stations)):
        yield Order(f"profile.stations.{place}", near, far, "the next station", "List them from the middle outwards")
    if heights:
        least, advice = reduce(np.minimum, heights), "Use heights relative to the thinnest point, 0 mm"
        yield Order("profile.heights", least, 0.0, "the least height", advice, strict=False)
