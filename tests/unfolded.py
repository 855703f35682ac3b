"""Meshes of the whole, made of the mesh of one side and its mirror images: what is computed by symmetry, computed without it."""

from __future__ import annotations

from dataclasses import replace

import ngsolve
import numpy as np
from netgen.meshing import Element2D, Element3D, FaceDescriptor, Mesh, MeshPoint, Pnt

from flexstage.solid.fea.geometry.mirror import MIRRORS, Mirrors
from flexstage.solid.fea.meshing.mesh import PieceMesh


def unfold(side: PieceMesh) -> PieceMesh:
    """The whole of what is flat on all sides: vertices on a mirror are shared, elements follow those they are images of."""
    mesh = side.mesh
    points = np.array([vertex.point for vertex in mesh.vertices])
    solids = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.Elements(ngsolve.VOL)])
    outside = [element for element in mesh.Elements(ngsolve.BND) if element.mat not in MIRRORS.values()]
    faces, names = np.array([[vertex.nr for vertex in element.vertices] for element in outside]), [element.mat for element in outside]
    for axis in side.mirrors.axes:
        apart = np.abs(points[:, axis]) > 1e-9 * np.max(np.abs(points))
        images = np.where(apart, len(points) + np.cumsum(apart) - 1, np.arange(len(points)))
        points = np.vstack([points, (points * np.where(np.arange(3) == axis, -1.0, 1.0))[apart]])
        solids, faces = (np.vstack([each, images[each][:, [1, 0, *range(2, each.shape[1])]]]) for each in (solids, faces))
        names = names * 2
    owner = np.concatenate([side.owner, *side.images])
    return replace(
        side,
        mesh=_mesh(points, solids, faces, names),
        owner=owner,
        finer=np.tile(side.finer, side.mirrors.copies),
        mirrors=Mirrors(),
        images=(),
    )


def _mesh(points, solids, faces, names):
    raw = Mesh(dim=3)
    numbers = [raw.Add(MeshPoint(Pnt(*point))) for point in points.tolist()]
    kinds = list(dict.fromkeys(names))
    for number, name in enumerate(kinds, start=1):
        raw.Add(FaceDescriptor(surfnr=number, domin=1, domout=0, bc=number))
        raw.SetBCName(number - 1, name)
    raw.SetMaterial(1, "medium 0")
    for corners in solids.tolist():
        raw.Add(Element3D(1, [numbers[corner] for corner in corners]))
    for corners, name in zip(faces.tolist(), names, strict=True):
        raw.Add(Element2D(kinds.index(name) + 1, [numbers[corner] for corner in corners]))
    return ngsolve.Mesh(raw)
