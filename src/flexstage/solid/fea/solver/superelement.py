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

    `motion` (v, 3, n) of the vertices and `stress` (v, 6, n) at them as xx, yy, zz, xy, yz, zx [Pa], per coordinate.
    """

    vertices: Array
    triangles: Array
    motion: Array
    stress: Array
    owner: Array


@dataclass(frozen=True, eq=False)
class Superelement:
    """A reduced component, in its own axes: six coordinates for each interface (its twist, at its own point), `warps`, internal ones.

    `stiffness` and `inertia` (n, n) are for each piece group (links and bodies by position in the component). `bodies` (6, n) are mean
    twists and `body_inertia` (6, 6) their inertia (`inertia` then contains only elastic motion within the body).
    `resultants` (6, n) are at links' centres in their frames. `strokes` (n,) are forces of a unit free stroke, with the `free` coordinates
    of the unconstrained stroke and its `stroke_resultants` (6,) to subtract. `rigid` (n, 6) is a rigid motion about the component's origin
    (only without fixed joints), `carried` (n, 6) the inertial forces of a unit rigid acceleration. `seats` (6, n) are the twists, at their
    points, of the surface around the ends of parts without a shape. A floating component has one interface: itself, moved rigidly about
    the reference of its first body.
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
    """A superelement with zero warps of the `held` ones of its yielding faces, in order.

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
