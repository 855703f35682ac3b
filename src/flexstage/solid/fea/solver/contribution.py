"""Contributions: elastic forces and momenta of each group of elements.

Groups without a common DOF are assembled together, so that a whole stage needs few matrices.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import ngsolve
import numpy as np

from flexstage.base.number import Array
from flexstage.solid.fea.solver.field import Field, Inertia, degrees_of, inertia, rigid, stiffness, times
from flexstage.spatial.frame import Frame


@dataclass(frozen=True, eq=False)
class Contribution:
    """Elastic forces and momenta of a group of elements in k motions, at the group's m degrees of freedom, the `rows` (m,).

    `strained` (m, k) are the motions minus their rigid part, and `forces` (m, k) the elastic forces due to these motions. `momenta` (m, k)
    are the momenta of the complete `motions` (m, k) as velocities.
    """

    name: str
    rows: Array
    motions: Array
    strained: Array
    forces: Array
    momenta: Array


@dataclass(frozen=True, eq=False)
class Group:
    """A group's `elements` (mask), and the mask (n,) of its degrees of freedom."""

    name: str
    elements: Array
    degrees: Array


@dataclass(frozen=True, eq=False)
class Assembled:
    """Groups without a common degree of freedom, with the stiffness and the inertia of all their elements."""

    groups: tuple[Group, ...]
    stiffness: ngsolve.BilinearForm
    inertia: Inertia


def assemble_groups(space: Field, groups: Mapping[str, Array]) -> tuple[Assembled, ...]:
    """Assemble groups of elements (masks). Groups without a common degree of freedom are assembled together."""
    sets = _group_by_law([Group(name, elements, degrees_of(space, elements)) for name, elements in groups.items()])
    together = [np.any([group.elements for group in alike], axis=0) for alike in sets]
    return tuple(
        Assembled(tuple(alike), stiffness(space, elements), inertia(space, elements))
        for alike, elements in zip(sets, together, strict=True)
    )


def contributions(space: Field, sets: Sequence[Assembled], basis: Array) -> Iterator[Contribution]:
    """Yield the contributions of groups of elements in the motions `basis` (n, k); the sequence of the groups is arbitrary.

    Rigid motions of a group are subtracted before elastic forces are computed; otherwise rounding errors would exceed the forces of a thin
    leaf.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.solver.field import field
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> half = np.arange(space.meshed.mesh.ne) % 2 == 0
    >>> moved = rigid(space, Frame(np.eye(3), np.zeros(3)))[:, :1]
    >>> parts = list(contributions(space, assemble_groups(space, {"even": half, "odd": ~half}), moved))
    >>> round(sum(float((part.motions * part.momenta).sum()) for part in parts), 9)  # the bar's 10 g
    0.01
    """
    for alike in sets:
        strained = _strain_operator(space, alike.groups, basis)
        forces, momenta = times([alike.stiffness], strained), alike.inertia.times(basis)
        for group in alike.groups:
            rows = np.flatnonzero(group.degrees)
            yield Contribution(group.name, rows, basis[rows], strained[rows], forces[rows], momenta[rows])


def _group_by_law(groups: Sequence[Group]) -> list[list[Group]]:
    """The groups in few sets without a common degree of freedom within a set."""
    sets: list[list[Group]] = []
    for group in groups:
        apart = (each for each in sets if not any((other.degrees & group.degrees).any() for other in each))
        found = next(apart, None)
        if found is None:
            sets.append([group])
        else:
            found.append(group)
    return sets


def _strain_operator(space: Field, groups: Sequence[Group], basis: Array) -> Array:
    """The motions (n, k) on the groups' degrees of freedom, each less its nearest rigid motion; zero elsewhere."""
    result = np.zeros_like(basis)
    for group in groups:
        rows = np.flatnonzero(group.degrees)
        own = rigid(space, Frame(np.eye(3), _middle(space, group.degrees)))[rows]
        result[rows] = basis[rows] - own @ np.linalg.lstsq(own, basis[rows])[0]
    return result


def _middle(space: Field, degrees: Array) -> Array:
    """Mean position (3,) of the vertices of some degrees of freedom."""
    one, place = space.linear
    vertices = degrees.reshape(3, -1).any(axis=0) & (np.abs(one) > 0.5)
    return np.mean(place[vertices], axis=0)
