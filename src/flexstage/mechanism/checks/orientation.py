"""Checks of directions: nonzero, perpendicular in a frame, and specified for parts that are not axisymmetric."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Vector, stack
from flexstage.mechanism.assembly.pattern import Pattern, Pose
from flexstage.mechanism.grammar.node import LARGEST, first_failing
from flexstage.mechanism.mechanism import Mechanism, every_body, every_link, posed
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.part import Part, Restricted, ports_of
from flexstage.parts.stated import is_even

_TOLERANCE = np.deg2rad(0.1)
"""Tolerance of perpendicular directions (three digits); frames are then orthogonalised."""


def orientation_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of directions of links, patterns and solids.

    >>> from flexstage.mechanism.mechanism import Link
    >>> link = Link(("ground", "platform"), "wire", at=(0.0, 0.0, 0.0), along=(0.0, 0.0, 0.0))
    >>> print(*orientation_findings(Mechanism("", links={"strut": link})))
    links.strut.along: the direction is zero. Use one of x, -x, y, -y, z, -z, or three numbers.
    """
    yield from _links(mechanism)
    yield from _solids(mechanism)
    for name, part in mechanism.parts.items():
        for port, placed in ports_of(part).items():
            yield from _pair(f"parts.{name}.ports.{port}.along", placed.along, f"parts.{name}.ports.{port}.up", placed.up)
    for name, placement in mechanism.placements.items():
        yield from _pattern(f"placements.{name}", placement.pattern)
    for name, probe in posed(mechanism.gauges).items():
        yield from _pattern(f"gauges.{name}", probe.pattern, has_up=False)
    for name, stop in mechanism.stops.items():
        yield from _pattern(f"stops.{name}", stop.pattern, has_up=False)


def _links(mechanism: Mechanism) -> Iterator[Finding]:
    for where, link in every_link(mechanism):
        yield from _pair(f"{where}.{'to' if link.along is None else 'along'}", link.direction, f"{where}.bends", link.bends)
        part = mechanism.parts.get(link.part)
        if part is not None and link.bends is None and not is_axisymmetric(part, link.free):
            what = f'bends missing: part "{link.part}" is not axisymmetric'
            advice = 'Specify the axis of its compliant rotation, e.g. bends = "y"'
            if ports_of(part):
                what, advice = f'bends (z axis of the link) missing: part "{link.part}" has ports', 'Use e.g. bends = "z"'
            yield Finding(where, what, advice)


def is_axisymmetric(part: Part, free: tuple[Freedom, ...] | None = None) -> bool:
    """Return whether a part is axisymmetric, so that its link requires no `bends`.

    >>> is_axisymmetric(Joint((Freedom.RZ,))), is_axisymmetric(Joint((Freedom.RY, Freedom.RZ)))
    (False, True)
    """
    if free is not None and not is_even(free):
        return False
    if isinstance(part, Restricted):
        return is_even(part.elastic) and is_even(part.free) and part.part.is_axisymmetric
    return is_even(part.free) if isinstance(part, Joint) else part.is_axisymmetric


def _solids(mechanism: Mechanism) -> Iterator[Finding]:
    for where, body in every_body(mechanism):
        for name, solid in body.solids.items():
            here = f"{where}.solids.{name}"
            along, up = getattr(solid, "along", None), getattr(solid, "up", None)
            if along is not None:
                yield from _pair(f"{here}.along", along, f"{here}.up", up)


def _pattern(where: str, pattern: Pattern, *, has_up: bool = True) -> Iterator[Finding]:
    """Errors of a pattern; without `has_up` (a gauge, symmetric about its line) `up` is optional."""
    if not isinstance(pattern, Pose):
        return
    here, usual = f"{where}.pose", Pose()
    ends = [name for name, point in (("from", pattern.start), ("to", pattern.end)) if point is not None]
    if len(ends) == 1:
        yield Finding(here, f"{ends[0]} specified without the other end", "Specify both from and to, or at and along")
    elif ends and (pattern.at != usual.at or pattern.along != usual.along):
        yield Finding(here, "the ends and the position are both specified", "Specify either from and to, or at and along")
    up = None if not has_up and pattern.up == usual.up else pattern.up
    yield from _pair(f"{here}.{'to' if ends else 'along'}", pattern.direction, f"{here}.up", up)


def _pair(where: str, along: Vector, other_where: str, other: Vector | None) -> Iterator[Finding]:
    """Errors of two directions: zero, or not perpendicular."""
    zeros = [*_zero(where, along), *(_zero(other_where, other) if other is not None else ())]
    yield from zeros
    if zeros or other is None:
        return
    one, two = np.broadcast_arrays(np.real(stack(along)), np.real(stack(other)))
    lengths = np.sqrt(np.sum(one * one, -1) * np.sum(two * two, -1))
    angle = np.arccos(np.clip(np.sum(one * two, -1) / lengths, -1.0, 1.0))
    skew = np.abs(angle - 0.5 * np.pi) > _TOLERANCE
    if np.any(skew):
        at, (result,) = first_failing(skew, angle)
        what = f"wrong angle to {where.rpartition('.')[2]} (got {np.rad2deg(result):.4g} deg, expected 90 deg)"
        yield Finding(f"{other_where}{at}", what, "Use two perpendicular directions")


def _zero(where: str, direction: Vector) -> Iterator[Finding]:
    largest = np.max(np.abs(np.real(stack(direction))), axis=-1)
    useless = (largest < 1.0 / LARGEST) | (largest > LARGEST)
    if np.any(useless):
        at, (length,) = first_failing(useless, largest)
        yield Finding(
            f"{where}{at}",
            f"the direction is {f'of length {length:.3g}' if length else 'zero'}",
            "Use one of x, -x, y, -y, z, -z, or three numbers",
        )
