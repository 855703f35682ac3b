"""Displaced surfaces of a stage modelled as solids, with a value at each point, for pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import expand
from flexstage.solid.fea.solver.assemble import Placed
from flexstage.solid.fea.solver.surface import element_coordinates, stresses, vertex_places, von_mises
from flexstage.solid.results.read import SolidRead

_SHOWN = 0.06
"""Largest displacement in a picture, relative to the stage's size."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Surface of `triangles` (t, 3) between `places` (v, 3) [m] in the stage's frame, with a value (v,) at each place."""

    places: Array
    triangles: Array
    values: Array


def mode_surfaces(read: SolidRead, shape: Array) -> tuple[Surface, ...]:
    """Return the surfaces of a stage, displaced by the magnified `shape` (N,) of a mode; values are relative displacements, 0 to 1."""
    factor, largest = magnification(read, shape)
    return tuple(
        Surface(vertex_places(item, shape, factor), item.element.skin.triangles, _displacement(item, shape) / largest)
        for item in read.placed
    )


def stress_surfaces(read: SolidRead, motion: Array, strokes: Mapping[str, float]) -> tuple[Surface, ...]:
    """Return the surfaces of a stage, displaced by the magnified static `motion` (N,); values are von Mises stress [Pa].

    `strokes` maps each input to its stroke [m] in this motion.
    """
    assembly = expand(read.mechanism)
    factor, _ = magnification(read, motion)
    by_link = {assembly.actuators[name]: np.array([value]) for name, value in strokes.items()}
    found = [(item, von_mises(stresses(item, element_coordinates(item, motion[:, None], by_link))[:, :, 0])) for item in read.placed]
    return tuple(Surface(vertex_places(item, motion, factor), item.element.skin.triangles, values) for item, values in found)


def magnification(read: SolidRead, motion: Array) -> tuple[float, float]:
    """Compute the magnification of a motion (N,) for a picture, and the motion's largest displacement [m]."""
    places = np.concatenate([vertex_places(item, motion, 0.0) for item in read.placed])
    size = float(np.max(places.max(axis=0) - places.min(axis=0)))
    largest = max((float(np.max(_displacement(item, motion))) for item in read.placed), default=0.0) or 1.0
    return _SHOWN * size / largest, largest


def _displacement(item: Placed, motion: Array) -> Array:
    return np.linalg.norm(vertex_places(item, motion, 1.0) - vertex_places(item, motion, 0.0), axis=1)
