"""Planes of symmetry: the positive side of symmetric components, and motions that are even or odd about each plane.

The response of a symmetric component is even for even loads and odd for odd loads, so one side with matching constraints suffices.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from netgen import occ

from flexstage.base.number import Array

MIRRORS = {1: "across y", 2: "across z"}
"""Names of the cut faces in the planes y = 0 and z = 0, by the axis normal to the plane."""

_NEAR = 1e-6
"""Tolerance for points in a plane, divided by the drawing's size."""
_FAR = 4.0
"""Size of the half space that cuts a drawing, divided by the distance of the drawing's furthest corner."""


@dataclass(frozen=True)
class Mirrors:
    """Symmetry planes through the origin, given by their normal `axes` (1: y, 2: z). Only the positive side of each plane is drawn.

    The kind of a motion is a number with one bit for each of the `axes`, in their order. The bit of an axis is set if the motion is odd
    across the plane normal to the axis.

    >>> both = Mirrors((1, 2))
    >>> both.copies, both.twist_kinds(np.eye(3)).tolist()  # x, y, z, rx, ry, rz
    (4, [0, 1, 2, 3, 2, 1])
    """

    axes: tuple[int, ...] = ()

    @property
    def copies(self) -> int:
        """Number of sides that form the whole; the number of kinds of motion is the same."""
        return 2 ** len(self.axes)

    @property
    def images(self) -> Array:
        """Signs (copies - 1, 3) of x, y and z that mirror a point across the first plane, the second plane, and both planes."""
        odd = np.arange(1, self.copies)
        return np.stack([np.where(self.is_odd(odd, axis), -1.0, 1.0) if axis in self.axes else odd**0.0 for axis in range(3)], axis=1)

    def is_odd(self, kinds: Array, axis: int) -> Array:
        """Return a mask of the `kinds` that are odd across the plane normal to `axis`."""
        return (kinds >> self.axes.index(axis)) % 2 == 1

    def twist_kinds(self, rotation: Array) -> Array:
        """Return the kinds (6,) of the translations along the columns of `rotation` and of the rotations about these columns.

        Each column must be parallel or normal to each plane.
        """
        translations = self.kinds(np.abs(rotation[list(self.axes)]) > 0.5)
        return np.concatenate([translations, translations ^ (self.copies - 1)])

    def kinds(self, odd: Array) -> Array:
        """Return the kinds (k,) of motions; `odd` (m, k) has a row for each plane."""
        return np.sum(odd.astype(np.int64) << np.arange(len(self.axes))[:, None], axis=0)

    def whole(self, side: Array, rows: Array, columns: Array) -> Array:
        """Compute inner products (n, k) of motions over the whole from those over one `side`; products of different kinds are zero."""
        return np.where(rows[:, None] == columns, self.copies * side, 0.0)

    def within(self, points: Array) -> Array:
        """Select the points (n, 3) that are on the positive side."""
        return points[np.all(points[:, list(self.axes)] >= 0.0, axis=1)]


def cut_at_mirrors(solid: occ.TopoDS_Shape, mirrors: Mirrors) -> occ.TopoDS_Shape:
    """Cut a drawing at symmetry planes; return the positive side, with named cut faces and the material name `medium 0`.

    >>> quarter = cut_at_mirrors(occ.Box(occ.Pnt(0, -1, -1), occ.Pnt(1, 1, 1)), Mirrors((1, 2)))
    >>> round(quarter.mass, 9), sorted(face.name for face in quarter.faces if face.name)
    (1.0, ['across y', 'across z'])
    """
    far = _FAR * max(abs(each) for vertex in solid.vertices for each in (vertex.p.x, vertex.p.y, vertex.p.z))
    for axis in mirrors.axes:
        half = occ.Box(occ.Pnt(-far, *(0.0 if axis == each else -far for each in MIRRORS)), occ.Pnt(far, far, far))
        half.faces.Min(occ.Y if axis == 1 else occ.Z).name = MIRRORS[axis]
        solid = solid * half
    solid.mat("medium 0")
    return solid


def is_symmetric(solids: Iterable[occ.TopoDS_Shape], axis: int) -> bool:
    """Return whether solids are symmetric about the plane normal to an axis: every face has a mirrored face of equal area.

    >>> is_symmetric([occ.Box(occ.Pnt(0, -1, 0), occ.Pnt(1, 1, 1))], 1), is_symmetric([occ.Box(occ.Pnt(0, -1, 0), occ.Pnt(1, 1, 1))], 2)
    (True, False)
    """
    centres = [(face.center, face.mass) for solid in solids for face in solid.faces]
    faces = np.array([(centre.x, centre.y, centre.z, area) for centre, area in centres])
    mirrored = faces * np.where(np.arange(4) == axis, -1.0, 1.0)
    apart = np.abs(faces[:, None] - mirrored) / np.repeat([np.max(np.abs(faces[:, :3])), np.max(faces[:, 3])], (3, 1))
    return bool(np.all(np.min(np.max(apart, axis=2), axis=1) < _NEAR))
