"""Superelements: a component reduced to its interfaces and a few internal motions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.solid.fea.meshing.fineness import WARPS


@dataclass(frozen=True, eq=False)
class Skin:
    """The surface for pictures: `vertices` (v, 3) [m] and `triangles` (t, 3), with the piece (index) behind each triangle.

    For each of n coordinates, `motion` (v, 3, n) contains the displacement of the vertices, `stress` (v, 6, n) the stress at them as xx,
    yy, zz, xy, yz, zx [Pa].
    """

    vertices: Array
    triangles: Array
    motion: Array
    stress: Array
    owner: Array


@dataclass(frozen=True, eq=False)
class Superelement:
    """A reduced component in its own axes. Its n coordinates: a twist of each interface (at its own point), `warps`, internal coordinates.

    `stiffness` and `inertia` (n, n) have an entry for each link and body, by position in the component. `bodies` (6, n) are mean twists of
    bodies, `body_inertia` (6, 6) the inertia for these twists, which `inertia` includes. `resultants` (6, n) are wrenches at links' centres
    in their frames. `strokes` (n,) are forces of a unit free stroke, `free_strokes` (n,) the coordinates of this stroke without constraint.
    `rigid` (n, 6) is a rigid motion about the component's origin (only without fixed joints), `carried` (n, 6) the inertial forces of a
    unit rigid acceleration. `seats` (6, n) are the twists, at their points, of the surface around the ends of parts without a shape. A
    floating component has one interface: its own rigid motion about the reference of its first body.
    """

    interfaces: int
    warps: int
    stiffness: Mapping[str, Array]
    inertia: Mapping[str, Array]
    bodies: Mapping[str, Array]
    body_inertia: Mapping[str, Array]
    resultants: Mapping[str, Array]
    strokes: Mapping[str, Array]
    free_strokes: Mapping[str, Array]
    rigid: Array
    carried: Array
    skin: Skin
    freedoms: int
    elements: int
    seats: Mapping[str, Array] = field(default_factory=dict)

    @property
    def boundary_coordinates(self) -> int:
        """Number of coordinates shared with neighbours: all but the internal ones."""
        return 6 * self.interfaces + self.warps

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.rigid.shape[0]


def hold_faces(element: Superelement, held: Sequence[bool]) -> Superelement:
    """Return a superelement with zero warps of some deformable faces; `held` marks these faces, in order.

    >>> bare = Skin(*[np.zeros((0, 20))] * 5)
    >>> whole = Superelement(1, 12, {"a": np.eye(20)}, {}, {}, {}, {}, {}, {}, np.zeros((20, 6)), np.zeros((20, 6)), bare, 3, 1)
    >>> plane = hold_faces(whole, [True])
    >>> plane.warps, plane.size, plane.stiffness["a"].shape
    (0, 8, (8, 8))
    """
    if not any(held):
        return element
    kept = np.ones(element.size, dtype=bool)
    kept[6 * element.interfaces : element.boundary_coordinates] = ~np.repeat(np.asarray(held, dtype=bool), WARPS)
    last = ("bodies", "resultants", "strokes", "free_strokes", "seats")
    return replace(
        element,
        warps=element.warps - WARPS * sum(held),
        **{name: {key: law[np.ix_(kept, kept)] for key, law in getattr(element, name).items()} for name in ("stiffness", "inertia")},
        **{name: {key: rows[..., kept] for key, rows in getattr(element, name).items()} for name in last},
        rigid=element.rigid[kept],
        carried=element.carried[kept],
        skin=replace(element.skin, motion=element.skin.motion[..., kept], stress=element.skin.stress[..., kept]),
    )
