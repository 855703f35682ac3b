"""Pictures of a stage: from three sides and isometric, undeformed or displaced."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.show.figures.style import ABOUT, ALONG, FULL, MUTED, style_context
from flexstage.show.scene.skin import Kind
from flexstage.show.scene.view import Side, View, arrows, draw, edges_of, name, picture_axes, triad, view, write
from flexstage.show.viewer.data import StageData
from flexstage.show.viewer.motions import Motion

_MOVED = (Kind.PLATFORM, Kind.BODY, Kind.HINGE, Kind.DRIVE)
_REACH = 0.11
"""Largest motion in the picture of a mode, relative to the stage's diagonal."""
_ARM, _ARROW, _SMALL, _ALONE = 0.25, 0.24, 0.4, 0.9
_IN_PLANE, _OUT_OF_PLANE = [0, 1, 5], [2, 3, 4]


def stage_picture(data: StageData, *, side: Side = Side.ISOMETRIC, width: float = FULL, names: bool = True) -> Any:
    """Draw the stage from one side, with the names of actuators and gauges, as a matplotlib Figure.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.show.viewer.data import still_data
    >>> len(stage_picture(still_data(case("parallelogram")), side=Side.TOP).axes[0].images)
    1
    """
    seen = view(side)
    with style_context():
        axes = picture_axes(data.mesh.points, seen, width)
        draw(axes, data, seen)
        write(axes, data.labels if names else (), seen)
        triad(axes, seen)
    return axes.figure


def mode_picture(data: StageData, motion: Motion, *, width: float = FULL) -> Any | None:
    """Draw a magnified motion of the stage over the outline of the undeformed platform, as a matplotlib Figure without gauges.

    The view is from above if the platform moves mainly in its plane, else isometric. Blue arrows show translation of the platform, red
    arrows show rotation. Returns `None` if nothing moves.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.show.viewer.data import stage_data
    >>> data = stage_data(case("parallelogram"))
    >>> [text.get_text() for text in mode_picture(data, data.motions[0]).axes[0].texts]
    ['x', 'y', 'z', 'z', 'rx']
    """
    reach = data.reach(motion)
    if reach == 0.0:
        return None
    start, twist = _platform_twist(data, motion)
    sizes = _sizes(twist, data.size)
    seen = view(Side.TOP if sizes[_IN_PLANE].max() > sizes[_OUT_OF_PLANE].max() else Side.ISOMETRIC)
    moved = data.mesh.points + _REACH * data.size / reach * data.mesh.displacement(motion.twists)
    shown = np.array([thing.kind in _MOVED for thing in data.things], dtype=bool)[data.mesh.part]
    with style_context():
        axes = picture_axes(np.concatenate([data.mesh.points[shown], moved[shown]]), seen, width)
        draw(axes, data, seen, moved, _MOVED)
        axes.plot(*edges_of(data, seen, Kind.PLATFORM).T, color=MUTED, linewidth=0.5, linestyle="--")
        triad(axes, seen)
        if np.any(sizes):
            _arrows(axes, start, twist, data.size, seen)
    return axes.figure


def _platform_twist(data: StageData, motion: Motion) -> tuple[Array, Array]:
    """The platform's reference point (3,) and its twist (6,) there; zeros without a platform."""
    if PLATFORM not in data.bodies:
        return np.zeros(3), np.zeros(6)
    start, twist = data.bones.references[PLATFORM], motion.twists[data.bodies.index(PLATFORM)]
    return start, np.concatenate([twist[:3] + np.cross(twist[3:], start), twist[3:]])


def _sizes(twist: Array, size: float) -> Array:
    """Displacements by a twist (6,) at an arm's length from its reference, on a stage of this size."""
    return np.abs(twist) * np.array([1.0] * 3 + [_ARM * size] * 3)


def _arrows(axes: Any, start: Array, twist: Array, size: float, seen: View) -> None:
    """The platform's translation and rotation, each if not small compared with the other, named if along one axis."""
    sizes, foot = _sizes(twist, size), seen.project(start)
    for part, names, colour in ((slice(0, 3), "xyz", ALONG), (slice(3, 6), ("rx", "ry", "rz"), ABOUT)):
        own = float(np.linalg.norm(sizes[part]))
        if own < _SMALL * sizes.max():
            continue
        direction = twist[part] / np.linalg.norm(twist[part])
        axis = names[int(np.argmax(np.abs(direction)))] if np.max(np.abs(direction)) > _ALONE else ""
        if colour == ABOUT and abs(direction @ seen.axes[2]) > _ALONE:
            _turn(axes, foot, 0.5e3 * _ARROW * size, float(direction @ seen.axes[2]), axis)
            continue
        reach = seen.project(_ARROW * size * direction * own / max(own, sizes.max()))
        arrows(axes, [foot], [reach], colour, 1.8)
        name(axes, foot + 1.2 * reach, axis, colour)


def _turn(axes: Any, middle: Array, radius: float, sense: float, axis: str) -> None:
    """A rotation about the direction of sight: an arc with an arrowhead."""
    angles = np.sign(sense) * np.linspace(-0.75 * np.pi, 0.5 * np.pi, 40)
    arc = middle + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    axes.plot(*arc.T, color=ABOUT, linewidth=1.8)
    arrows(axes, [arc[-2]], [0.4 * radius * (arc[-1] - arc[-2]) / np.linalg.norm(arc[-1] - arc[-2])], ABOUT, 1.8)
    name(axes, middle + np.array([0.0, 1.45 * radius]), axis, ABOUT)
