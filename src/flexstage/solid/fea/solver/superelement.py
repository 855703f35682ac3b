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

    For each of n coordinates, `motion` (v, 3, n) has the displacements of the vertices, and `stress` (v, 6, n) the stress at the vertices
    [Pa] as xx, yy, zz, xy, yz, zx.
    """

    vertices: Array
    triangles: Array
    motion: Array
    stress: Array
    owner: Array


@dataclass(frozen=True, eq=False)
class Superelement:
    """A reduced component in its own axes. Its n coordinates are the interface twists, the `warps` and the internal coordinates.

    The twist of an interface is at the interface's own point. `stiffness` and `inertia` contain a matrix (n, n) for each link and body. For
    each body, `bodies` (6, n) map the coordinates to the mean twist of the body. `body_inertia` (6, 6) is the inertia of the body for its
    mean twist, which is included in `inertia`. For each link, `resultants` (6, n) give the wrench at its centre, in its frame. For each
    stack, `strokes` (n,) are the forces due to a unit free stroke, and `free_strokes` (n,) are the coordinates after this stroke if nothing
    constrains the stack. `rigid` (n, 6) are the rigid motions about the component's origin (only without fixed joints); `carried` (n, 6)
    are the inertial forces of unit rigid accelerations. `seats` (6, n) give the twist of the surface around each end of a part without a
    shape. A component without joints has one interface, whose twist is the component's rigid motion about the reference point of its first
    body.
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
        """Number of coordinates shared with neighbours: all except the internal coordinates."""
        return 6 * self.interfaces + self.warps

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.rigid.shape[0]


def hold_faces(element: Superelement, held: Sequence[bool]) -> Superelement:
    """Return a superelement in which the faces marked in `held` have no warps and therefore remain plane.

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
