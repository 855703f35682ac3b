"""GLB file of a stage with rigid bodies and bending links; animations show its modes by theory, without finite elements."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.scene.skin import Kind
from flexstage.show.viewer.data import StageData, stage_data
from flexstage.show.viewer.motions import Motion
from flexstage.show.viewer.parts import DrawnEntry

if TYPE_CHECKING:
    from flexstage.solid.exchange.gltf import Surface

_LARGEST = 0.05
_RIGID = (Kind.PLATFORM, Kind.BODY, Kind.GROUND)


@check_arguments
def to_glb(mechanism: Mechanism, *, modes: int = 12) -> bytes:
    """Return a GLB file (glTF 2.0) of a stage as bytes, with nodes for bodies, links and gauges.

    The file also contains animations of the `modes` lowest modes. Bodies move rigidly and links bend between them, as in the lumped model
    and in `flexstage.view`. For modes of elastic solids use `flexstage cad --gltf`. The largest displacement of an animation is 5 % of the
    stage's diagonal. Raises `DesignError` if the package pygltflib is missing or the stage cannot be drawn.

    >>> import flexstage as fs
    >>> fs.solid.to_glb(fs.case("parallelogram"), modes=1)[:4]
    b'glTF'
    """
    return glb_of(stage_data(mechanism, count=modes), modes)


def glb_of(data: StageData, modes: int = 12) -> bytes:
    """Return the content of a GLB file from a stage's viewer data, as `to_glb` does."""
    if find_spec("pygltflib") is None:
        raise refuse("GLB", "the package pygltflib is not installed", "Install it with: pip install 'flexstage[solid]'")
    from flexstage.solid.exchange.gltf import Motion as Animation
    from flexstage.solid.exchange.gltf import gltf

    shown = [motion for motion in data.motions if motion.frequency is not None][:modes]
    animations = [Animation(f"mode {motion.label}", np.zeros(0)) for motion in shown]
    return gltf(data.name, dict(_surfaces(data, shown)), animations)


def _surfaces(data: StageData, motions: Sequence[Motion]) -> Iterator[tuple[str, Surface]]:
    """The surface of each body, with all its drawn parts, and of each link and gauge, by name."""
    from flexstage.solid.exchange.gltf import surface_of

    mesh = data.mesh
    owners = [_owner(data, thing) for thing in data.things]
    names = list(dict.fromkeys(owners))
    own = np.array([names.index(owner) for owner in owners], dtype=int)[mesh.part]
    scale = [_LARGEST * data.size / (data.reach(motion) or 1.0) for motion in motions]
    moved = [factor * mesh.displacement(motion.twists) for factor, motion in zip(scale, motions, strict=True)]
    shifts = np.stack([np.zeros_like(mesh.points), *moved])[1:]
    for number, name in enumerate(names):
        triangles = mesh.triangles[own[mesh.triangles[:, 0]] == number]
        if len(triangles):
            yield name, surface_of(triangles, mesh.points, shifts, is_body=name in data.bodies)


def _owner(data: StageData, thing: DrawnEntry) -> str:
    """The body of a drawn entry, else the entry's own name."""
    first, second = thing.bodies
    return data.bodies[first] if first == second and thing.kind in _RIGID else thing.name
