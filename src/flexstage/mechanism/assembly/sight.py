"""Measured quantities of gauges: components of relative twists, also of links, and weighted sums."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from graphlib import CycleError, TopologicalSorter

import numpy as np

from flexstage.base.finding import Finding, suggest_nearest
from flexstage.base.number import Array, Number
from flexstage.mechanism.assembly.pattern import copy_names
from flexstage.mechanism.mechanism import GROUND, GaugePlace, GaugeSum, LinkProbe, Mechanism, Probe, Stop
from flexstage.parts.freedom import Freedom
from flexstage.parts.gauge import Instrument, SensorSense, combine_gauges
from flexstage.parts.part import Part, span
from flexstage.spatial.frame import Frame


@dataclass(frozen=True, eq=False)
class Sight:
    """One term of a gauge's reading: `weight` times a `component` of the twist of `body` relative to `base`.

    The relative component is the component of the twist of `body` at `frame`, minus the component of the twist of `base` at `foot`, each in
    the axes of its frame. `frame` and `foot` differ only for gauges on links.
    """

    body: str
    base: str
    frame: Frame
    foot: Frame
    component: int
    weight: Number


@dataclass(frozen=True, eq=False)
class PlacedGauge:
    """Gauge of the expanded stage: its reading is the sum of its `sights`. For a sum of gauges, `members` are the weights by name."""

    name: str
    gauge: Instrument
    sights: tuple[Sight, ...]
    members: Mapping[str, Number] = field(default_factory=dict[str, Number])

    @property
    def unit(self) -> str:
        """Unit of the reading: m or rad."""
        return self.gauge.quantity.si

    @property
    def single(self) -> Sight | None:
        """The only term of the reading; `None` for a sum of gauges."""
        return None if self.members else self.sights[0]


@dataclass(frozen=True, eq=False)
class PlacedStop:
    """Stop of the expanded stage: `low` and `high` (...) [m] limit the motion of its `sight`; an open side has an infinite limit."""

    sight: Sight
    low: Array
    high: Array


def place_stop(stop: Stop, frame: Frame) -> PlacedStop:
    """Return a stop at a frame. The stop limits the motion of its body relative to its base along x, measured as by a gap gauge."""
    seen = Sight(stop.body, stop.base, frame, frame, Freedom.X.index, 1.0)
    return PlacedStop(seen, np.asarray(-np.inf if stop.gap_negative is None else -stop.gap_negative), np.asarray(stop.gap))


def sight(probe: Probe, gauge: Instrument, frame: Frame) -> Sight:
    """Return the relative motion that a gauge at a frame measures."""
    sign = -1.0 if probe.positive is SensorSense.CLOSES else 1.0
    return Sight(probe.body, probe.base or GROUND, frame, frame, gauge.freedom.index, sign)


def sight_of_link(first: str, second: str, frame: Frame, part: Part, gauge: Instrument) -> Sight:
    """Return the relative motion that a gauge on a link measures: second body relative to first, each at its end of the link."""
    half = 0.5 * np.asarray(span(part))[..., None] * frame.rotation[..., :, 0]
    return Sight(
        second,
        first,
        Frame(frame.rotation, frame.position + half),
        Frame(frame.rotation, frame.position - half),
        gauge.freedom.index,
        1.0,
    )


def link_names(text: str) -> tuple[str, ...]:
    """Return the links named by the key `link` of a gauge.

    >>> link_names("B1-B3/pzt"), link_names("strut")
    (('B1/pzt', 'B2/pzt', 'B3/pzt'), ('strut',))
    """
    owner, slash, name = text.partition("/")
    return tuple(f"{copy}{slash}{name}" for copy in copy_names(owner))


def place_sum(name: str, place: GaugeSum, gauges: Mapping[str, GaugePlace], single: Mapping[str, PlacedGauge]) -> PlacedGauge:
    """Return a sum of gauges as a gauge with the weighted terms of all its members; nested sums are expanded."""
    members: dict[str, Number] = {}
    for member, weight in _members(place, gauges):
        members[member] = members.get(member, 0.0) + weight
    sights = tuple(replace(item, weight=item.weight * weight) for member, weight in members.items() for item in single[member].sights)
    return PlacedGauge(name, combine_gauges([(weight, single[member].gauge) for member, weight in members.items()]), sights, members)


def _members(place: GaugeSum, gauges: Mapping[str, GaugePlace]) -> Iterator[tuple[str, Number]]:
    for name, weight in place.sum.items():
        inner = gauges.get(name)
        if isinstance(inner, GaugeSum):
            yield from ((member, weight * part) for member, part in _members(inner, gauges))
        else:
            yield name, weight


# Checks


def gauge_findings(mechanism: Mechanism, links: Collection[str]) -> Iterator[Finding]:
    """Return errors in poses, links and sums of gauges with known sensors; `links` are the link names of the expanded stage."""
    for key, place in mechanism.gauges.items():
        if isinstance(place, GaugeSum):
            yield from _sum_findings(f"gauges.{key}", key, place, mechanism.gauges)
        elif place.gauge in mechanism.sensors:
            yield from _place_findings(f"gauges.{key}", key, place, mechanism.sensors[place.gauge], links)
    yield from _mixture_findings(mechanism)


def _place_findings(where: str, key: str, place: Probe | LinkProbe, gauge: Instrument, links: Collection[str]) -> Iterator[Finding]:
    if isinstance(place, LinkProbe):
        yield from _link_findings(f"{where}.link", key, place, links)
    elif gauge.inside:
        what = f"link missing for {place.gauge}, a gauge on a link"
        yield Finding(where, what, 'Use e.g. link = "B1/pzt" instead of body and pose')
    elif gauge.gap and place.positive is None:
        yield Finding(where, "positive missing", 'Use e.g. positive = "opens"')
    elif not gauge.gap and place.positive is not None:
        what = f"{place.gauge} does not measure a gap, but motion along or about its x axis"
        yield Finding(f"{where}.positive", what, "Remove positive; to change the sign, reverse the x axis of the gauge")


def _link_findings(where: str, key: str, place: LinkProbe, links: Collection[str]) -> Iterator[Finding]:
    named, gauges = link_names(place.link), copy_names(key)
    if len(named) != len(gauges):
        what = f"wrong number of links (got {_count(named, 'link')} for {_count(gauges, 'gauge')})"
        yield Finding(where, what, "Use one link per gauge")
    for name in named:
        if name not in links:
            yield Finding(where, f'unknown link "{name}"', suggest_nearest(name, links))


def _count(names: tuple[str, ...], noun: str) -> str:
    return f"{len(names)} {noun}{'' if len(names) == 1 else 's'}"


def _sum_findings(where: str, key: str, place: GaugeSum, gauges: Mapping[str, GaugePlace]) -> Iterator[Finding]:
    if len(copy_names(key)) > 1:
        yield Finding(where, f"a sum defines a single gauge (got several in {key})", "Use one table per sum")
    if not place.sum:
        yield Finding(f"{where}.sum", "members missing", "Use e.g. sum = { S1 = 0.5, S2 = -0.5 }")
    known = [name for other in gauges for name in copy_names(other) if other != key]
    for name in place.sum:
        if name not in known:
            yield Finding(f"{where}.sum.{name}", f'unknown gauge "{name}"', suggest_nearest(name, known))
    if key in _circle(gauges):
        yield Finding(f"{where}.sum", "circular sum", "Use other gauges")


def _circle(gauges: Mapping[str, GaugePlace]) -> list[str]:
    """First circle of nested sums."""
    try:
        TopologicalSorter({name: place.sum for name, place in gauges.items() if isinstance(place, GaugeSum)}).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def _mixture_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Sums of gauges that read different quantities."""
    if _circle(mechanism.gauges):
        return
    units = {
        name: mechanism.sensors[place.gauge].quantity.si
        for key, place in mechanism.gauges.items()
        if not isinstance(place, GaugeSum) and place.gauge in mechanism.sensors
        for name in copy_names(key)
    }
    for key, place in mechanism.gauges.items():
        if isinstance(place, GaugeSum):
            counted = Counter(units[name] for name, _ in _members(place, mechanism.gauges) if name in units)
            if len(counted) > 1:
                what = f"different quantities ({' and '.join(sorted(counted))})"
                yield Finding(f"gauges.{key}.sum", what, "Sum gauges of one quantity")
