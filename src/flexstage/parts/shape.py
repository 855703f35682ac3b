"""What a part is asked for: its kind, its freedoms and, if it has a shape, its geometry.

Outlines, pictures, contact, columns and finite elements ask the part; none of them knows its class. A new kind of part derives from
`Shaped`, or from `Profiled` where cuts thin it towards its middle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from functools import reduce
from itertools import pairwise
from typing import ClassVar

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
    """That the number in a `field`, the `small` one, is below the `large` one (`other` names it), or, if not `strict`, at most as large."""

    field: str
    small: Number | None
    large: Number | None
    other: str
    advice: str
    quantity: Quantity = LENGTH
    strict: bool = True


INNER_MODES = Bound(0.0, 20.0)
"""How many modes of its own a part may have in each freedom."""


class Elastic(Description):
    """A part with a stiffness of its own, of a `kind` by which files know it. `parts.PARTS` lists the kinds."""

    kind: ClassVar[str]
    inner_modes: int = 0
    """Modes that it has while its ends are held, in each freedom along or about which it is meant to give way: how many count."""

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the part is meant to have."""
        raise NotImplementedError

    @property
    def orders(self) -> Iterator[Order]:
        """Which of its numbers must be below which others."""
        yield from ()

    @property
    def push(self) -> Number | None:
        """The constant force with which it pushes its ends apart along x as drawn [N], negative where it pulls them together."""
        return None

    @property
    def strut(self) -> Number | None:
        """Length [m] over which a part without a shape turns about both of its ends; `None`: it acts in one point."""
        return None

    def stated(self, material: Material | None) -> Stated | None:  # noqa: ARG002  (kinds that are known by a material need it)
        """What it is stated to do between its ends; `None` of a part that is known by its shape."""
        return None

    @property
    def is_axisymmetric(self) -> bool:
        """Whether it is alike in all directions across its axis, so that links need not say which way it bends."""
        return True

    @property
    def mirrored(self) -> Elastic | None:
        """The part as its own mirror across its y axis shows it; `None` where a kind does not say: then no copy of it can be mirrored."""
        return None

    @property
    def faults(self) -> Iterator[Finding]:
        """What else is wrong with its numbers, by field."""
        yield from ()


def reversed_or_none(value: Number | None) -> Number | None:
    """A number that a mirror across y reverses, where it is stated."""
    return None if value is None else -value


class Shaped(Elastic):
    """A part with a shape: x along it, its centre at the origin, alike on both sides of its three planes.

    A kind states its `span` and its `throat`. All else follows for one section from end to end; `Profiled` parts have more. `slender`
    parts bend along their whole length, so that their ends may shift sideways.
    """

    material: str
    slender: ClassVar[bool] = False

    @property
    def is_axisymmetric(self) -> bool:
        """Whether its throat is."""
        return self.throat.is_axisymmetric

    @property
    def bends_both_ways(self) -> bool:
        """Whether it is meant to bend about y as about z."""
        return {Freedom.RY, Freedom.RZ} <= set(self.intended)

    @property
    def mirrored(self) -> Elastic | None:
        """Itself: it is alike on both sides."""
        return self

    @property
    def span(self) -> Number:
        """Length from end to end [m]."""
        raise NotImplementedError

    @property
    def throat(self) -> Section:
        """The thinnest section."""
        raise NotImplementedError

    @property
    def end(self) -> Section:
        """The section at both ends."""
        return self.throat

    @property
    def is_prismatic(self) -> bool:
        """Whether the section is the same from end to end."""
        return True

    @property
    def has_arc(self) -> bool:
        """Whether it is thinnest on a line alone, not over a length."""
        return False

    @property
    def closing(self) -> float:
        """The angle [rad] at which the faces of its cut touch, of the first design; infinite where it has none."""
        return np.inf

    @property
    def silhouette(self) -> tuple[tuple[float, Section], ...]:
        """Stations x [m] from end to end, at least two, and the sections there, of the first design: what it looks like."""
        half = 0.5 * single(self.span)
        ends = ((-half, self.end.first), (half, self.end.first))
        return ends if self.is_prismatic else (ends[0], (0.0, self.throat.first), ends[1])

    def section_at(self, stations: Array) -> Section:
        """The section at stations [m], of the first design: its numbers are straight between those of its silhouette."""
        places, sections = zip(*self.silhouette, strict=True)
        names = [item.name for item in fields(sections[0])]
        return replace(sections[0], **{name: np.interp(stations, places, [getattr(each, name) for each in sections]) for name in names})


class Profiled(Shaped):
    """A part whose `throat` grows by a `profile` of cuts on both sides of its height, and of its width too where it says so (`grown`)."""

    thickness: Number
    profile: Profile

    def grown(self, up: Number) -> Section:
        """The section where the cuts have risen by `up` [m]."""
        raise NotImplementedError

    @property
    def span(self) -> Number:
        """Length between the ends of its arcs [m]."""
        return length(self.profile)

    @property
    def throat(self) -> Section:
        """The section where the cuts are deepest, for arcs in its middle."""
        return self.grown(0.0)

    @property
    def end(self) -> Section:
        """The section where the cuts end."""
        return self.grown(rise(self.profile))

    @property
    def is_prismatic(self) -> bool:
        """Whether its profile is straight."""
        return isinstance(self.profile, Straight)

    @property
    def has_arc(self) -> bool:
        """Whether its profile is an arc."""
        return self.profile.has_arc if isinstance(self.profile, Contour) else isinstance(self.profile, (Circular, Elliptic))

    @property
    def closing(self) -> float:
        """The angle [rad] at which the faces of its cuts touch: a cut is as wide as the hinge is long, and as deep."""
        return closing(self.profile, self.thickness)

    @property
    def silhouette(self) -> tuple[tuple[float, Section], ...]:
        """Stations x [m] from end to end, more of them on arcs, and the sections there."""
        return tuple((float(x), self.grown(float(up)).first) for x, up in zip(*stations_of(self.profile), strict=True))

    @property
    def orders(self) -> Iterator[Order]:
        """Two fillets fit into its length, and a tip's arc; a table begins in the middle and ascends."""
        if isinstance(self.profile, Filleted):
            advice = "Two fillets take 2 r of the length: make it longer or the radius smaller"
            yield Order("profile.radius", self.profile.radius, 0.5 * self.profile.length, "half the length", advice, strict=False)
        if isinstance(self.profile, Vee):
            most = 0.5 * self.profile.length / np.sin(self.profile.slope)
            advice = "Make the length or the angle larger, or the radius smaller"
            yield Order("profile.radius", self.profile.radius, most, "that of an arc over the whole length", advice, strict=False)
        if isinstance(self.profile, FreeForm):
            yield from _table_orders(self.profile)


def _table_orders(table: FreeForm) -> Iterator[Order]:
    """A table has as many heights as stations, two at least, begins in the middle, ascends, and counts heights from the least."""
    stations, heights = table.stations, table.heights
    counts = (float(len(stations)), float(len(heights)))
    both, few = "State one height for each station", "State the middle, an end, and what lies between"
    yield Order("profile.stations", counts[0], counts[1], "the number of heights", both, RATIO, strict=False)
    yield Order("profile.heights", counts[1], counts[0], "the number of stations", both, RATIO, strict=False)
    yield Order("profile.stations", 2.0, counts[0], "the number of stations", few, RATIO, strict=False)
    if stations:
        yield Order("profile.stations.0", stations[0], 0.0, "the middle of the hinge", "Begin with 0 mm", strict=False)
    for place, (near, far) in enumerate(pairwise(stations)):
        yield Order(f"profile.stations.{place}", near, far, "the next station", "State them from the middle outwards")
    if heights:
        least, advice = reduce(np.minimum, heights), "Count the heights from the thinnest place, which has 0 mm"
        yield Order("profile.heights", least, 0.0, "the least height", advice, strict=False)
