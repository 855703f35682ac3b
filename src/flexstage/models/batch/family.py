"""Families of designs that differ in some numbers: their descriptions, and the input of the kernel."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.beams.mass import law_and_mass
from flexstage.mechanism.addresses.address import get, quantity_of, set_value
from flexstage.mechanism.addresses.locate import Place, locate
from flexstage.mechanism.addresses.path import MATRICES, replace_member
from flexstage.mechanism.assembly.expand import expand, lay_out
from flexstage.mechanism.assembly.moving_mass import moving_inertia
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.models.batch.graph import SHAPES, Topology, distinct_links, topology

INERTIA_ENTRIES = np.array([0, 1, 2, 0, 3, 4, 4, 5, 5, 5]), np.array([0, 5, 3, 4, 3, 3, 4, 3, 4, 5])
"""Rows and columns of the 6x6 inertia matrix from which the kernel's ten inertia numbers are taken."""

Draw = Callable[[tuple[Array, ...]], Mechanism]
"""Function that returns the description for given numbers; each number is an array (...)."""


@dataclass(frozen=True, eq=False)
class Family:
    """Designs that differ in P numbers from a nominal design, `mechanism`; `nominal` (P,) are the numbers of the nominal design.

    `points` contains the nominal reference point (3,) of each body that does not specify one. All designs use these points.
    """

    mechanism: Mechanism
    addresses: tuple[str, ...]
    nominal: Array
    topology: Topology
    points: Mapping[str, Array]
    draw: Draw | None = None

    @cached_property
    def located(self) -> tuple[Place, ...]:
        """Locations of the addresses in the description."""
        return tuple(locate(self.mechanism, address) for address in self.addresses)


def family(mechanism: Mechanism, addresses: tuple[str, ...]) -> Family:
    """Build the family of designs that differ in the numbers at the `addresses`; raises `DesignError` for unknown addresses.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> family(double_triangle(), ("parts.neck.thickness",)).nominal.round(6).tolist()
    [0.00154]
    """
    nominal = np.array([_number(mechanism, address) for address in addresses])
    plain = replace(mechanism, requirements={})
    for address, value in zip(addresses, nominal, strict=True):
        plain = set_value(plain, address, float(value))
    return _family(plain, addresses, nominal)


def _number(mechanism: Mechanism, address: str) -> Any:
    """The number at an address; refuses vectors, and what is not a number."""
    quantity_of(mechanism, address)
    value = get(mechanism, address)
    if np.ndim(value):
        raise refuse(address, "the value has several components", "Use the address of one component")
    return value


def drawn_family(draw: Draw, names: tuple[str, ...], nominal: Array) -> Family:
    """Build a family from a function `draw` that returns the description for P numbers, which have the names `names`.

    `nominal` (P,) are the numbers of the nominal design.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> def leaves(columns):
    ...     return set_value(double_triangle(), "parts.neck.thickness", 2.0 * columns[0])
    >>> numbers_of(drawn_family(leaves, ("half",), np.array([0.77e-3])), np.array([[0.77e-3], [0.8e-3]])).shape[1]
    2
    """
    plain = replace(draw(tuple(np.asarray(float(value)) for value in nominal)), requirements={})
    return replace(_family(plain, names, np.asarray(nominal, float)), draw=draw)


def _family(plain: Mechanism, names: tuple[str, ...], nominal: Array) -> Family:
    assembly = expand(plain)
    free = {name: body for name, body in assembly.bodies.items() if body.body.reference is None}
    points = {name: body.frame.rotation.T @ (body.reference - body.frame.position) for name, body in free.items()}
    return Family(plain, names, nominal, topology(assembly), points)


def describe(family_: Family, values: Array) -> Mechanism:
    """Return one description of all designs, with arrays as values; `values` (b, P) are the numbers of the designs.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = family(double_triangle(), ("parts.neck.thickness",))
    >>> describe(stage, np.array([[1.5e-3], [1.6e-3]])).parts["neck"].thickness.tolist()
    [0.0015, 0.0016]
    """
    if family_.draw is not None:
        return family_.draw(tuple(values.T))
    mechanism = family_.mechanism
    for address, place, value in zip(family_.addresses, family_.located, values.T, strict=True):
        plain = not place.owners and not place.number and not set(MATRICES) & set(place.path)
        mechanism = replace_member(mechanism, place.path, value) if plain else set_value(mechanism, address, value)
    return mechanism


def numbers_of(family_: Family, values: Array) -> Array:
    """Compute the kernel input (numbers, b) of the designs with the numbers `values` (b, P), in the order of `graph.SHAPES`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> numbers_of(family(double_triangle(), ("parts.neck.thickness",)), np.array([[1.5e-3], [1.6e-3]])).shape
    (1675, 2)
    """
    mechanism = describe(family_, values)
    assembly = lay_out(mechanism)
    bodies = {
        name: body if (point := family_.points.get(name)) is None else replace(body, body=replace(body.body, reference=tuple(point)))
        for name, body in assembly.bodies.items()
    }
    laws = [law_and_mass(link.part, link.material) for link in distinct_links(assembly).values()]
    links = assembly.links.values()
    kernel_rows: list[Array] = [*(law.stiffness for law, _ in laws), *(mass for _, mass in laws), *(link.frame.rotation for link in links)]
    for side in (0, 1):
        ends = [(link.joins[side], link.frame.position) for link in links]
        kernel_rows += [np.zeros(3) if body == GROUND else bodies[body].reference - place for body, place in ends]
    for name in family_.topology.bodies:
        inertia = moving_inertia(mechanism, bodies[name])
        kernel_rows.append(np.zeros(10) if inertia is None else inertia[..., *INERTIA_ENTRIES])
    shapes = [SHAPES[kind] for kind, count in family_.topology.counts.items() for _ in range(count)]
    rows = [array.reshape(-1, int(np.prod(shape))).T for array, shape in zip(kernel_rows, shapes, strict=True)]
    return np.concatenate([np.broadcast_to(row, (len(row), len(values))) for row in rows])
