"""Geometry of single parts and bodies: what cannot be made, and what is no mass."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, first_design, stack
from flexstage.base.units.quantity import LENGTH
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.locate import link_path, locate
from flexstage.mechanism.addresses.path import follow
from flexstage.mechanism.assembly.expand import NO_IMAGE, apply_overrides, placed_bodies
from flexstage.mechanism.assembly.likeness import drawn_units
from flexstage.mechanism.checks.value import first_failing
from flexstage.mechanism.grammar.node import join
from flexstage.mechanism.mechanism import Mechanism, every_body, every_link
from flexstage.parts.body import Body, Extrusion, Imported, Inertia, Solid, winding
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.condensation import superelement_findings
from flexstage.parts.mass import tensor
from flexstage.parts.part import Part, Restricted, inner
from flexstage.parts.shape import Elastic, Order, Shaped
from flexstage.parts.superelement import Superelement

_NEAR = 1e-6
"""How far the ends of a link may miss its part's length [m]: points are written with as many digits."""
_SLACK = 1e-9
"""Relative slack of comparisons that rounding may spoil: a thin plate has xx + yy = zz."""


_MOMENT_DIGITS = 5
"""Digits of moments of inertia below which rounding does not excuse what no mass has: a thin bar's least one is a difference of entries."""


def geometry_findings(mechanism: Mechanism, *, overrides: bool = True) -> Iterator[Finding]:
    """Findings about materials, parts, solids, stated masses and payloads; with `overrides` also about parts of single copies.

    >>> from flexstage.parts.leaf import Leaf
    >>> leaf = Leaf("steel", length=0.03, thickness=0.012, width=0.01)
    >>> print(*geometry_findings(Mechanism("", parts={"blade": leaf})))
    parts.blade.thickness: must be below the width, 10 mm (got 12 mm). Exchange them, or turn the link's bends.
    """
    for name, material in mechanism.materials.items():
        yield from (replace(fault, where=f"materials.{name}.{fault.where}") for fault in material.faults)
    for name, part in mechanism.parts.items():
        yield from _part(f"parts.{name}", part)
    if overrides:
        for owner, part in _departed_parts(mechanism):
            yield from _part(owner, part)
    stage = placed_bodies(mechanism)
    for where, body in every_body(mechanism):
        yield from _body(where, body) if body.of is None else _lent(where, body, stage.get(body.of))
    yield from _without_image(mechanism)
    yield from _lengths(mechanism)
    for name, payload in mechanism.payloads.items():
        if payload.point and payload.inertia is not None:
            yield Finding(f"payloads.{name}.point", "it states an inertia, and a point has none", "Leave one of them out")
        if payload.inertia is not None:
            yield from _inertia(f"payloads.{name}.inertia", payload.inertia)


def _lengths(mechanism: Mechanism) -> Iterator[Finding]:
    """Links between two points that are not as far apart as their part is long."""
    for where, link in every_link(mechanism):
        part = mechanism.parts.get(link.part)
        own = None if part is None else inner(part)
        if link.start is None or link.end is None or not isinstance(own, Shaped):
            continue
        apart = np.sqrt(np.sum(np.real(stack(link.direction)) ** 2, axis=-1))
        off = np.abs(apart - np.real(own.span)) > _NEAR
        if np.any(off):
            at, values = first_failing(off, apart, np.asarray(own.span))
            found, length = (show(value, LENGTH, digits=6) for value in values)
            what = f"from and to are {found} apart, and part {link.part} is {length} long"
            yield Finding(f"{where}{at}", what, "Move an end, or give the part that length")


def _without_image(mechanism: Mechanism) -> Iterator[Finding]:
    """Mirrored copies of what has no mirror image, or none that is known."""
    for key, placement in mechanism.placements.items():
        unit = drawn_units(mechanism).get(placement.unit)
        if placement.pattern.mirror is None or unit is None:
            continue
        for name, link in unit.links.items():
            part = mechanism.parts.get(link.part)
            if part is not None and part.mirrored is None:
                yield Finding(f"placements.{key}", f"{placement.unit}/{name}: {NO_IMAGE[0]}", NO_IMAGE[1])


def matrix_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Findings about the files of superelements: presupposes that what the description states of them is sound.

    >>> list(matrix_findings(Mechanism("")))
    []
    """
    for name, part in mechanism.parts.items():
        if isinstance(part, Superelement):
            yield from superelement_findings(part, f"parts.{name}")


def _departed_parts(mechanism: Mechanism) -> Iterator[tuple[str, Part]]:
    """The parts as they are after the overrides, by the link or the copy that departs."""
    places = [locate(mechanism, key) for key in mechanism.overrides]
    for owners in dict.fromkeys(place.owners for place in places if not place.misaligned):
        yield owners[-1], apply_overrides(mechanism, follow(mechanism, link_path(mechanism, owners[0])), owners)[1]


def _part(where: str, part: Part) -> Iterator[Finding]:
    if isinstance(part, Restricted):
        yield from _part(f"{where}.part", part.part)
        for freedom in set(part.elastic) & set(part.free):
            yield Finding(where, f"freedom {freedom.value} is both elastic and free", "Name it once")
        return
    yield from _orders(where, part.orders if isinstance(part, Elastic) else ())
    if isinstance(part, Elastic):
        yield from (replace(fault, where=join(where, fault.where) if fault.where else where) for fault in part.faults)
    if isinstance(part, ComplianceMatrix) and part.inertia is not None:
        yield from _inertia(f"{where}.inertia", part.inertia)


def _orders(where: str, orders: Iterable[Order]) -> Iterator[Finding]:
    """A number is less than another one, or at most as large."""
    for order in orders:
        if order.small is None or order.large is None:
            continue
        small, large = np.real(order.small), np.real(order.large)
        failing = small >= large if order.strict else small > large * (1.0 + _SLACK)
        if np.any(failing):
            at, values = first_failing(failing, small, large)
            found, other = (show(value, order.quantity, digits=6) for value in values)
            what = f"must be {'below' if order.strict else 'at most'} {order.other}, {other} (got {found})"
            yield Finding(f"{where}.{order.field}{at}", what, order.advice)


def _body(where: str, body: Body) -> Iterator[Finding]:
    stated = [name for name in ("mass", "centre", "inertia") if getattr(body, name) is not None]
    if stated and body.solids:
        yield Finding(where, f"it has solids and states its {', '.join(stated)}", "Leave one of them: mass comes from either")
    elif stated and body.mass is None:
        yield Finding(where, f"it states its {', '.join(stated)} without a mass", "State the mass too")
    if body.inertia is not None:
        yield from _inertia(f"{where}.inertia", body.inertia)
    if body.point and (body.mass is None or body.inertia is not None):
        yield Finding(f"{where}.point", "only a stated mass without inertia can be meant as a point", "Leave out point, or the inertia")
    for name, solid in body.solids.items():
        yield from _solid(f"{where}.solids.{name}", solid)


def _lent(where: str, body: Body, owner: Body | None) -> Iterator[Finding]:
    """A body of another one has outlines only, and its owner takes its mass from outlines too."""
    stated = [name for name in ("mass", "centre", "inertia", "reference") if getattr(body, name) is not None]
    if stated:
        what = f'it is of "{body.of}" and states its {", ".join(stated)}'
        yield Finding(where, what, f'Leave these out, or state them of "{body.of}"')
    if owner is not None and owner.mass is not None and body.solids:
        what = f'it lends solids to "{body.of}", which states its mass'
        yield Finding(where, what, f'Leave the mass out: that of "{body.of}" then comes from all its solids')
    for name, solid in body.solids.items():
        yield from _solid(f"{where}.solids.{name}", solid)


def _solid(where: str, solid: Solid) -> Iterator[Finding]:
    if isinstance(solid, Imported):
        yield from _inertia(f"{where}.inertia", solid.inertia)
    if isinstance(solid, Extrusion):
        yield from _polygon(f"{where}.outline", solid)
    yield from _orders(where, solid.orders)


def _polygon(where: str, solid: Extrusion) -> Iterator[Finding]:
    """A polygon has three corners or more, and its sides meet only there."""
    if len(solid.outline) < 3:
        yield Finding(where, f"it has {len(solid.outline)} corners", "Give three or more, one after the other round the polygon")
        return
    corners = first_design(np.real(solid.corners), 2)
    after = np.roll(corners, -1, axis=0)
    for here, there in itertools.combinations(range(len(corners)), 2):
        apart = there - here not in (1, len(corners) - 1)
        if np.all(corners[here] == corners[there]) or (apart and _cross((corners[here], after[here]), (corners[there], after[there]))):
            what = f"its sides from corner {here + 1} and from corner {there + 1} meet"
            yield Finding(where, what, "Give the corners one after the other round the polygon, each once")
            return
    if abs(winding(corners)) <= _SLACK * float(np.max(np.abs(corners))) ** 2:
        yield Finding(where, "its corners lie on a line", "Give a polygon that encloses an area")


def _cross(one: tuple[Array, Array], other: tuple[Array, Array]) -> bool:
    """Whether two sides of a polygon cross or touch."""
    beside = [winding(np.array([*line, point])) for line, points in ((one, other), (other, one)) for point in points]
    overlap = all(max(np.min(one, 0)[k], np.min(other, 0)[k]) <= min(np.max(one, 0)[k], np.max(other, 0)[k]) for k in (0, 1))
    return overlap and beside[0] * beside[1] <= 0.0 and beside[2] * beside[3] <= 0.0


def _inertia(where: str, inertia: Inertia) -> Iterator[Finding]:
    """No mass has a principal moment above the sum of the other two, or a negative one, by more than its digits are rounded."""
    matrix = np.real(tensor(inertia))
    principal = np.linalg.eigvalsh(matrix)
    total = functools.reduce(np.add, np.moveaxis(principal, -1, 0))
    rounded = 0.75 * 10.0 ** (1 - max(_MOMENT_DIGITS, *map(_digits, np.ravel(matrix))))  # three entries a row, each half of a digit
    slack = max(_SLACK, rounded) * np.abs(total)
    lacking = total - 2.0 * principal[..., 2] < -slack
    negative = principal[..., 0] < -slack
    failing = lacking | negative
    if np.any(failing):
        at, values = first_failing(failing, *np.moveaxis(principal, -1, 0))
        told = ", ".join(f"{value:.6g}" for value in values)
        what = f"its principal moments are {told} kg m^2: none may be negative or above the sum of the other two"
        yield Finding(f"{where}{at}", what, "Check the moments and the signs of the products")


def _digits(value: float) -> int:
    """With how many significant digits a number is written, at most twelve.

    >>> _digits(4.25e-7), _digits(130e-9)
    (3, 2)
    """
    return len(f"{abs(value):.11e}".partition("e")[0].replace(".", "").rstrip("0"))
