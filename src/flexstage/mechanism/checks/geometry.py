"""Checks of single parts and bodies: impossible geometry and mass properties."""

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
from flexstage.mechanism.grammar.node import first_failing, join
from flexstage.mechanism.mechanism import Mechanism, every_body, every_link
from flexstage.parts.body import Body, Extrusion, Imported, Inertia, Solid, winding
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.condensation import superelement_findings
from flexstage.parts.mass import tensor
from flexstage.parts.part import Part, Restricted, inner
from flexstage.parts.shape import Elastic, Order, Shaped
from flexstage.parts.superelement import Superelement

_NEAR = 1e-6
"""Tolerance between the distance of a link's ends and its part's length [m]: rounding of points in files."""
_SLACK = 1e-9
"""Relative tolerance for rounding: a thin plate has xx + yy = zz."""


_MOMENT_DIGITS = 5
"""Least number of digits of moments of inertia for the rounding tolerance: the least moment of a thin bar is a difference."""


def geometry_findings(mechanism: Mechanism, *, overrides: bool = True) -> Iterator[Finding]:
    """Return errors of materials, parts, solids, specified masses and payloads; with `overrides`, also of overridden parts.

    >>> from flexstage.parts.leaf import Leaf
    >>> leaf = Leaf("steel", length=0.03, thickness=0.012, width=0.01)
    >>> print(*geometry_findings(Mechanism("", parts={"blade": leaf})))
    parts.blade.thickness: must be below the width, 10 mm (got 12 mm). Exchange both values, or rotate the link's bends.
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
        for name, solid in body.solids.items():
            yield from _solid(f"{where}.solids.{name}", solid)
    yield from _without_image(mechanism)
    yield from _lengths(mechanism)
    for name, payload in mechanism.payloads.items():
        if payload.point and payload.inertia is not None:
            yield Finding(f"payloads.{name}.point", "a point has no inertia", "Remove point or the inertia")
        if payload.inertia is not None:
            yield from _inertia(f"payloads.{name}.inertia", payload.inertia)


def _lengths(mechanism: Mechanism) -> Iterator[Finding]:
    """Errors for links with ends not at the distance of their part's length."""
    for where, link in every_link(mechanism):
        part = mechanism.parts.get(link.part)
        own = None if part is None else inner(part)
        if link.start is None or link.end is None or not isinstance(own, Shaped):
            continue
        apart = np.sqrt(np.sum(np.real(stack(link.direction)) ** 2, axis=-1))
        off = np.abs(apart - np.real(own.span)) > _NEAR
        if np.any(off):
            at, values = first_failing(off, apart, np.asarray(own.span))
            result, length = (show(value, LENGTH, digits=6) for value in values)
            what = f"wrong distance between from and to (got {result}, expected the length of part {link.part}, {length})"
            yield Finding(f"{where}{at}", what, "Move an end, or change the part's length")


def _without_image(mechanism: Mechanism) -> Iterator[Finding]:
    """Errors for mirrored instances of parts without a known mirror image."""
    for key, placement in mechanism.placements.items():
        unit = drawn_units(mechanism).get(placement.unit)
        if placement.pattern.mirror is None or unit is None:
            continue
        for name, link in unit.links.items():
            part = mechanism.parts.get(link.part)
            if part is not None and part.mirrored is None:
                yield Finding(f"placements.{key}", f"{placement.unit}/{name}: {NO_IMAGE[0]}", NO_IMAGE[1])


def matrix_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors in the files of superelements whose descriptions are valid.

    >>> list(matrix_findings(Mechanism("")))
    []
    """
    for name, part in mechanism.parts.items():
        if isinstance(part, Superelement):
            yield from superelement_findings(part, f"parts.{name}")


def _departed_parts(mechanism: Mechanism) -> Iterator[tuple[str, Part]]:
    """Overridden parts, by link or instance."""
    places = [locate(mechanism, key) for key in mechanism.overrides]
    for owners in dict.fromkeys(place.owners for place in places if not place.misaligned):
        yield owners[-1], apply_overrides(mechanism, follow(mechanism, link_path(mechanism, owners[0])), owners)[1]


def _part(where: str, part: Part) -> Iterator[Finding]:
    if isinstance(part, Restricted):
        yield from _part(f"{where}.part", part.part)
        for freedom in set(part.elastic) & set(part.free):
            yield Finding(where, f"degree of freedom {freedom.value} both elastic and free", "List it once")
        return
    if isinstance(part, Elastic):
        yield from _orders(where, part.orders)
        yield from (replace(fault, where=join(where, fault.where) if fault.where else where) for fault in part.faults)
    if isinstance(part, ComplianceMatrix) and part.inertia is not None:
        yield from _inertia(f"{where}.inertia", part.inertia)


def _orders(where: str, orders: Iterable[Order]) -> Iterator[Finding]:
    """Errors in the order of two numbers."""
    for order in orders:
        if order.small is None or order.large is None:
            continue
        small, large = np.real(order.small), np.real(order.large)
        failing = small >= large if order.strict else small - large > _SLACK * np.abs(large)
        if np.any(failing):
            at, values = first_failing(failing, small, large)
            result, other = (show(value, order.quantity, digits=6) for value in values)
            what = f"must be {'below' if order.strict else 'at most'} {order.other}, {other} (got {result})"
            yield Finding(f"{where}.{order.field}{at}", what, order.advice)


def _body(where: str, body: Body) -> Iterator[Finding]:
    stated = [name for name in ("mass", "centre", "inertia") if getattr(body, name) is not None]
    if stated and body.solids:
        yield Finding(where, f"both solids and {', '.join(stated)} specified", "Remove one of the two")
    elif stated and body.mass is None:
        yield Finding(where, f"{', '.join(stated)} without a mass", "Specify the mass too")
    if body.inertia is not None:
        yield from _inertia(f"{where}.inertia", body.inertia)
    if body.point and (body.mass is None or body.inertia is not None):
        yield Finding(f"{where}.point", "a point requires a specified mass without inertia", "Specify only a mass, or remove point")


def _lent(where: str, body: Body, owner: Body | None) -> Iterator[Finding]:
    """Errors for a body `of` another one: both must have masses from outlines only."""
    stated = [name for name in ("mass", "centre", "inertia", "reference") if getattr(body, name) is not None]
    if stated:
        what = f'{", ".join(stated)} not allowed for a body of "{body.of}"'
        yield Finding(where, what, f'Remove these, or specify them for "{body.of}"')
    if owner is not None and owner.mass is not None and body.solids:
        what = f'its solids belong to "{body.of}", which has a specified mass'
        yield Finding(where, what, f'Remove the mass: the solids of both bodies then determine the mass of "{body.of}"')


def _solid(where: str, solid: Solid) -> Iterator[Finding]:
    if isinstance(solid, Imported):
        yield from _inertia(f"{where}.inertia", solid.inertia)
    if isinstance(solid, Extrusion):
        yield from _polygon(f"{where}.outline", solid)
    yield from _orders(where, solid.orders)


def _polygon(where: str, solid: Extrusion) -> Iterator[Finding]:
    """Errors of a polygon: fewer than three corners, or intersecting sides."""
    if len(solid.outline) < 3:
        yield Finding(
            where, f"too few corners (got {len(solid.outline)}, expected 3 or more)", "List the corners in order round the polygon"
        )
        return
    corners = first_design(np.real(solid.corners), 2)
    after = np.roll(corners, -1, axis=0)
    for here, there in itertools.combinations(range(len(corners)), 2):
        apart = there - here not in (1, len(corners) - 1)
        if np.all(corners[here] == corners[there]) or (apart and _cross((corners[here], after[here]), (corners[there], after[there]))):
            what = f"the sides that begin at corners {here + 1} and {there + 1} intersect"
            yield Finding(where, what, "List the corners in order round the polygon, each once")
            return
    if abs(winding(corners)) <= _SLACK * float(np.max(np.abs(corners))) ** 2:
        yield Finding(where, "its corners are collinear", "Use a polygon with an area")


def _cross(one: tuple[Array, Array], other: tuple[Array, Array]) -> bool:
    """Whether two sides of a polygon cross or touch."""
    beside = [winding(np.array([*line, point])) for line, points in ((one, other), (other, one)) for point in points]
    overlap = all(max(np.min(one, 0)[k], np.min(other, 0)[k]) <= min(np.max(one, 0)[k], np.max(other, 0)[k]) for k in (0, 1))
    return overlap and beside[0] * beside[1] <= 0.0 and beside[2] * beside[3] <= 0.0


def _inertia(where: str, inertia: Inertia) -> Iterator[Finding]:
    """Errors of principal moments: negative, or above the sum of the other two, beyond rounding."""
    matrix = np.real(tensor(inertia))
    principal = np.linalg.eigvalsh(matrix)
    total = functools.reduce(np.add, np.moveaxis(principal, -1, 0))
    rounded = 0.75 * 10.0 ** (1 - max(_MOMENT_DIGITS, *map(_digits, np.ravel(matrix))))  # three entries per row, each half a digit
    slack = max(_SLACK, rounded) * np.abs(total)
    lacking = total - 2.0 * principal[..., 2] < -slack
    negative = principal[..., 0] < -slack
    failing = lacking | negative
    if np.any(failing):
        at, values = first_failing(failing, *np.moveaxis(principal, -1, 0))
        text = ", ".join(f"{value:.6g}" for value in values)
        what = f"invalid principal moments (got {text} kg m^2, expected each between 0 and the sum of the other two)"
        yield Finding(f"{where}{at}", what, "Check the moments and the signs of the products")


def _digits(value: float) -> int:
    """Number of significant digits of a number, at most twelve.

    >>> _digits(4.25e-7), _digits(130e-9)
    (3, 2)
    """
    return len(f"{abs(value):.11e}".partition("e")[0].replace(".", "").rstrip("0"))
