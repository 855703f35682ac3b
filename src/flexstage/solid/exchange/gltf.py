"""GLB files (binary glTF 2.0): the surface of a stage, with a coloured node for each body or link and animated motions.

Lengths are in metres; the stage's z axis is glTF's y axis (up). Every node has one morph target for each motion. The weight of a target
follows a sine with a period of one second.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pygltflib as gl

from flexstage.base.number import Array
from flexstage.base.text import printable
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.solid.exchange.paint import Colour, palette
from flexstage.solid.fea.solver.assemble import Placed
from flexstage.solid.fea.solver.component import groups
from flexstage.solid.fea.solver.surface import vertex_places

_KEYS = 33
"""Number of keyframes in one period: the error of linear interpolation is below 0.5 % of the amplitude."""
_SECONDS = 1.0
_LARGEST = 0.05
"""Largest displacement of an animation, divided by the diagonal of the stage."""
_UPRIGHT = [-float(np.sqrt(0.5)), 0.0, 0.0, float(np.sqrt(0.5))]
"""Quaternion of the rotation from z up to y up."""
_LINK: Colour = (0.80, 0.81, 0.83)


@dataclass(frozen=True, eq=False)
class Motion:
    """A motion to animate: its name (`mode 1: tilt, 106.0 Hz`) and coordinates (N,) of the stage's linear model."""

    name: str
    coordinates: Array


@dataclass(frozen=True, eq=False)
class Surface:
    """Surface of a body or link: `vertices` (v, 3) [m] in the stage's frame, `triangles` (t, 3), displacements `shifts` (k, v, 3) [m]."""

    vertices: Array
    triangles: Array
    shifts: Array
    is_body: bool


def surfaces(placed: Sequence[Placed], motions: Sequence[Motion]) -> Mapping[str, Surface]:
    """Return the surface of every elastic body and link of a stage by name; rigid bodies without outlines have no surface.

    Displacements are scaled: the largest displacement of each motion is 5 % of the diagonal of the box around the stage.

    >>> surfaces([], [])
    {}
    """
    found: dict[str, Surface] = {}
    for item in placed:
        still, skin = vertex_places(item, np.zeros(item.operator.shape[1]), 0.0), item.element.skin
        shifts = np.array([vertex_places(item, motion.coordinates, 1.0) - still for motion in motions]).reshape(-1, *still.shape)
        for name, numbers in groups(item.component).items():
            triangles = skin.triangles[np.isin(skin.owner, numbers)]
            if len(triangles):
                found[name] = surface_of(triangles, still, shifts, is_body=name in item.component.bodies)
    if not found:
        return found
    everything = np.vstack([each.vertices for each in found.values()])
    diagonal = float(np.linalg.norm(np.ptp(everything, axis=0)))
    largest = np.max([np.linalg.norm(each.shifts, axis=2).max(axis=1) for each in found.values()], axis=0)
    scale = (_LARGEST * diagonal / np.where(largest > 0.0, largest, 1.0))[:, None, None]
    return {name: Surface(each.vertices, each.triangles, scale * each.shifts, each.is_body) for name, each in found.items()}


def surface_of(triangles: Array, vertices: Array, shifts: Array, *, is_body: bool) -> Surface:
    """Return the surface of some triangles of a mesh, with the vertices that they use.

    >>> found = surface_of(np.array([[1, 2, 3]]), np.eye(4, 3), np.zeros((2, 4, 3)), is_body=True)
    >>> found.triangles.tolist(), found.shifts.shape
    ([[0, 1, 2]], (2, 3, 3))
    """
    used, corners = np.unique(triangles, return_inverse=True)
    return Surface(vertices[used], corners.reshape(-1, 3), shifts[:, used], is_body)


def gltf(stage: str, shown: Mapping[str, Surface], motions: Sequence[Motion]) -> bytes:
    """Return the content of a GLB file with the surfaces `shown` of a stage, and one animation for each motion.

    Bodies have different colours, links are grey. Normals are omitted, so viewers shade every triangle flat.

    >>> gltf("nothing", {}, [])[:4]
    b'glTF'
    """
    document = gl.GLTF2(asset=gl.Asset(version="2.0", generator="flexstage"), scene=0)
    buffer = _Buffer(document)
    colours = palette(sorted((name for name, each in shown.items() if each.is_body), key=lambda name: name != PLATFORM))
    targets = [printable(motion.name) for motion in motions]
    for name, surface in shown.items():
        _add_node(document, buffer, printable(name), surface, colour=colours.get(name, _LINK), targets=targets)
    if shown and motions:
        _add_animations(document, buffer, motions)
    members = list(range(len(document.nodes)))
    document.nodes.append(gl.Node(name=printable(stage), children=members, rotation=_UPRIGHT))
    document.scenes = [gl.Scene(name=printable(stage), nodes=[len(members)])]
    document.buffers = [gl.Buffer(byteLength=len(buffer.data))] if buffer.data else []
    document.set_binary_blob(bytes(buffer.data))
    return b"".join(document.save_to_bytes())


class _Buffer:
    """The file's binary data."""

    def __init__(self, document: gl.GLTF2) -> None:
        self.data = bytearray()
        self._document = document

    def put(self, values: Array, kind: str, target: int | None = None) -> int:
        """Append an array and describe it; the number of its accessor."""
        start = len(self.data)
        self.data += values.tobytes()
        self._document.bufferViews.append(gl.BufferView(buffer=0, byteOffset=start, byteLength=values.nbytes, target=target))
        rows = values.reshape(len(values), -1)
        self._document.accessors.append(
            gl.Accessor(
                bufferView=len(self._document.bufferViews) - 1,
                componentType=gl.FLOAT if values.dtype == np.float32 else gl.UNSIGNED_INT,
                count=len(values),
                type=kind,
                min=rows.min(axis=0).tolist(),
                max=rows.max(axis=0).tolist(),
            )
        )
        return len(self._document.accessors) - 1


def _add_node(document: gl.GLTF2, buffer: _Buffer, name: str, surface: Surface, *, colour: Colour, targets: list[str]) -> None:
    indices = buffer.put(surface.triangles.astype(np.uint32).ravel(), gl.SCALAR, gl.ELEMENT_ARRAY_BUFFER)
    places = buffer.put(surface.vertices.astype(np.float32), gl.VEC3, gl.ARRAY_BUFFER)
    shifts = [gl.Attributes(POSITION=buffer.put(shift.astype(np.float32), gl.VEC3, gl.ARRAY_BUFFER)) for shift in surface.shifts]
    paint = gl.PbrMetallicRoughness(baseColorFactor=[*colour, 1.0], metallicFactor=0.2, roughnessFactor=0.6)
    document.materials.append(gl.Material(name=name, pbrMetallicRoughness=paint, doubleSided=True, alphaCutoff=None))
    material = len(document.materials) - 1
    primitive = gl.Primitive(attributes=gl.Attributes(POSITION=places), indices=indices, material=material, targets=shifts or None)
    weights = [0.0] * len(shifts) or None
    document.meshes.append(gl.Mesh(name=name, primitives=[primitive], weights=weights, extras={"targetNames": targets}))
    document.nodes.append(gl.Node(name=name, mesh=len(document.meshes) - 1))


def _add_animations(document: gl.GLTF2, buffer: _Buffer, motions: Sequence[Motion]) -> None:
    times = np.linspace(0.0, _SECONDS, _KEYS)
    start = buffer.put(times.astype(np.float32), gl.SCALAR)
    nodes = range(len(document.nodes))
    for number, motion in enumerate(motions):
        weights = np.zeros((_KEYS, len(motions)))
        weights[:, number] = np.sin(2.0 * np.pi * times / _SECONDS)
        sampler = gl.AnimationSampler(input=start, output=buffer.put(weights.astype(np.float32).ravel(), gl.SCALAR), interpolation="LINEAR")
        channels = [gl.AnimationChannel(sampler=0, target=gl.AnimationChannelTarget(node=node, path="weights")) for node in nodes]
        document.animations.append(gl.Animation(name=printable(motion.name), samplers=[sampler], channels=channels))
