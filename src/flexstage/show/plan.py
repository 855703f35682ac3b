"""The dimensioned plan: the stage from above as a workshop would draw it, with radii, angles, names and sizes in mm."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from flexstage.base.lazy import Late
from flexstage.base.number import Array, first_design
from flexstage.mechanism.assembly.expand import copy_names, expand
from flexstage.mechanism.assembly.pattern import Normal, Polar
from flexstage.mechanism.geometry.outline import outlines
from flexstage.mechanism.mechanism import PLATFORM, Mechanism, posed
from flexstage.parts.body import Block, Cylinder, Extrusion, Pierced, Solid
from flexstage.show.display import number
from flexstage.show.figures.style import FULL, INK, MUTED, PAPER, SERIES, canvas, style_context
from flexstage.show.scene.facet import Kind
from flexstage.show.scene.primitives import first_value
from flexstage.show.scene.silhouette import hull
from flexstage.show.scene.stage import Scene
from flexstage.show.scene.view import Side, view, write
from flexstage.spatial.frame import Frame

if TYPE_CHECKING:
    from flexstage.show.figures import scenery
else:
    scenery = Late("flexstage.show.figures.scenery")  # loads matplotlib

_FILLS = {Kind.BODY: "#8d99a6", Kind.HINGE: "#0f8a7e", Kind.DRIVE: "#f2a33c", Kind.GAUGE: "#c2395a", Kind.GROUND: "#56606b"}
_OPACITY = 0.55
_UPRIGHT = 1.0 - 1e-9
_LAYERS = (Kind.GROUND, Kind.BODY, Kind.DRIVE, Kind.HINGE, Kind.GAUGE)


@dataclass(frozen=True)
class Ring:
    """Copies on a circle: their names, radius [mm], position angle of the first [deg] and angular step [deg]."""

    names: tuple[str, ...]
    radius: float
    first: float
    step: float


def rings(mechanism: Mechanism) -> tuple[Ring, ...]:
    """The circles on which units and gauges stand.

    >>> rings(Mechanism(""))
    ()
    """
    placed = [(key, placement.pattern) for key, placement in mechanism.placements.items()]
    placed += [(key, probe.pattern) for key, probe in posed(mechanism.gauges).items()]
    return tuple(
        _ring(copy_names(key), pattern) for key, pattern in placed if isinstance(pattern, Polar) and first_value(pattern.radius) > 0.0
    )


def _ring(names: tuple[str, ...], pattern: Polar) -> Ring:
    step = 360.0 / len(names) if pattern.step is None else float(np.rad2deg(first_value(pattern.step)))
    first = float(np.rad2deg(first_value(pattern.first)))
    if pattern.mirror in (Normal.X, Normal.Y):
        first, step = (180.0 if pattern.mirror is Normal.X else 0.0) - first, -step
    return Ring(names, 1e3 * first_value(pattern.radius), first, step)


def plan_figure(mechanism: Mechanism, scene: Scene) -> Any:
    """The stage from above with dimensions in mm, as a matplotlib Figure.

    Drawn are outlines of bodies and parts, the circles units and gauges stand on with radius and position angles, envelope and opening.

    >>> from flexstage.show.scene.stage import scene
    >>> len(plan_figure(Mechanism(""), scene(Mechanism(""))).axes)
    1
    """
    sheet = _sheet(mechanism, scene)
    with style_context():
        figure = canvas(*(sheet.size / 72.0))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=sheet.get_xlim(), ylim=sheet.get_ylim(), aspect="equal")
        axes.set_axis_off()
        _draw(axes, mechanism, scene, sheet.per_point)
    return figure


def plan_picture(mechanism: Mechanism, scene: Scene) -> scenery.Paper:
    """The same as a picture of a page, at a fifth of the cost.

    >>> from flexstage.show.scene.stage import scene
    >>> plan_picture(Mechanism(""), scene(Mechanism(""))).svg("plan", "nothing")[:24]
    '<svg viewBox="0 0 518.4 '
    """
    sheet = _sheet(mechanism, scene)
    _draw(sheet, mechanism, scene, sheet.per_point)
    return sheet


def _sheet(mechanism: Mechanism, scene: Scene) -> scenery.Paper:
    low, high = _limits(_reach(mechanism, scene))
    return scenery.Paper(low, high, FULL, min(1.1, float((high - low)[1] / (high - low)[0])) * FULL)


def _draw(axes: Any, mechanism: Mechanism, scene: Scene, per_point: float) -> None:
    reach = _reach(mechanism, scene)
    _outlines(axes, scene)
    _platform(axes, mechanism, scene)
    _axes_of_symmetry(axes, reach)
    _rings(axes, rings(mechanism), [1e3 * np.array(label.point[:2]) for label in scene.labels])
    _rectangles(axes, mechanism)
    write(axes, scene.labels, view(Side.TOP), per_point)
    _sizes(axes, scene, reach)


def _reach(mechanism: Mechanism, scene: Scene) -> Array:
    """Half sizes (x, y) [mm] of the drawing about the stage's z axis."""
    points = [1e3 * facet.points[:, :2] for facet in scene.facets] or [np.full((1, 2), 50.0)]
    reach = np.abs(np.concatenate(points)).max(axis=0)
    if mechanism.envelope is not None:
        reach = np.maximum(reach, np.abs(_outline_middle(mechanism)) + [500.0 * first_value(size) for size in mechanism.envelope[:2]])
    return np.maximum(reach, 0.2 * reach.max())


def _limits(reach: Array) -> tuple[Array, Array]:
    """Lower left and upper right corner [mm], with room for dimensions on the left and below."""
    margin = 0.2 * float(reach.max())
    return -reach - margin, reach + 0.65 * margin


def _outlines(axes: Any, scene: Scene) -> None:
    """Every solid but the platform as the convex outline of its plan."""
    for kind in _LAYERS:
        fill, edge = ((*scenery.channels(colour)[:3], _OPACITY) for colour in (_FILLS[kind], INK))
        style = scenery.Style(fill, edge, 0.45)
        axes.add_artist(scenery.Scenery([scenery.Stroke(hull(points), style) for points in _plans(scene, kind)]))


def _plans(scene: Scene, kind: Kind) -> Iterator[Array]:
    by_name: dict[str, list[Array]] = {}
    for facet in scene.facets:
        if facet.paint.kind is kind and len(facet.points) > 2:
            by_name.setdefault(facet.paint.name, []).append(1e3 * facet.points[:, :2])
    return (np.concatenate(points) for points in by_name.values())


def _platform(axes: Any, mechanism: Mechanism, scene: Scene) -> None:
    """Outlines of the platform's solids, and of the holes in its blocks."""
    for outline in _plans(scene, Kind.PLATFORM):
        closed = hull(outline)
        axes.plot(*np.vstack([closed, closed[:1]]).T, color=SERIES[0], linewidth=1.0)
    for ring in _holes(mechanism):
        axes.plot(1e3 * ring[:, 0], 1e3 * ring[:, 1], color=SERIES[0], linewidth=1.0)


def _holes(mechanism: Mechanism) -> Iterator[Array]:
    """Closed outlines (k, 3) [m] of the upright holes in the platform's solids."""
    if PLATFORM not in mechanism.bodies:
        return
    for placed in expand(mechanism).bodies[PLATFORM].solids.values():
        whole = placed.solid.solid if isinstance(placed.solid, Pierced) else placed.solid
        holes = placed.solid.holes if isinstance(placed.solid, Pierced) else ()
        if isinstance(whole, Block) and whole.hole is not None:
            yield from _outline_of(Block(whole.material, (*whole.hole, whole.size[2])), placed.frame)
        elif isinstance(whole, Cylinder) and whole.bore is not None:
            yield from _outline_of(Cylinder(whole.material, whole.bore, whole.length), placed.frame)
        for hole in holes:
            yield from _outline_of(hole, hole.frame.within(placed.frame))


def _outline_of(hole: Solid, frame: Frame) -> Iterator[Array]:
    """The closed outline (k, 3) [m] of a hole that stands upright in a frame."""
    turn, place = first_design(np.real(frame.rotation), 2), first_design(np.real(frame.position), 1)
    angle = np.linspace(0.0, 2.0 * np.pi, 61)
    if isinstance(hole, Cylinder) and abs(turn[2, 0]) > _UPRIGHT:
        yield place + 0.5 * first_value(hole.diameter) * np.stack([0.0 * angle, np.cos(angle), np.sin(angle)], axis=-1) @ turn.T
    elif isinstance(hole, Block) and abs(turn[2, 2]) > _UPRIGHT:
        corners = 0.5 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 0]])
        yield place + (corners * [*(first_value(side) for side in hole.size[:2]), 0.0]) @ turn.T
    elif isinstance(hole, Extrusion) and abs(turn[2, 2]) > _UPRIGHT:
        corners = first_design(np.real(hole.corners), 2)
        yield place + np.vstack([corners, corners[:1]]) @ turn[:, :2].T


def _rectangle(axes: Any, size: Sequence[float], style: str, colour: str, centre: Sequence[float] = (0.0, 0.0)) -> None:
    x, y = centre[0] + 0.5 * size[0] * np.array([-1, 1, 1, -1, -1]), centre[1] + 0.5 * size[1] * np.array([-1, -1, 1, 1, -1])
    axes.plot(x, y, linestyle=style, color=colour, linewidth=1.0)


def _rectangles(axes: Any, mechanism: Mechanism) -> None:
    """Envelope and clear opening, with their names: the opening lies about the stage's axis, the envelope about all that takes up room."""
    if mechanism.envelope is not None:
        size, (x, y) = [1e3 * first_value(value) for value in mechanism.envelope[:2]], _outline_middle(mechanism)
        _rectangle(axes, size, "--", MUTED, (x, y))
        place = (x + 0.495 * size[0], y + 0.5 * size[1] + 1.0)
        axes.text(*place, _size_text("envelope", size), ha="right", va="bottom", fontsize=6.5, color=MUTED)
    if mechanism.opening is not None:
        size = [1e3 * first_value(value) for value in mechanism.opening.size]
        _rectangle(axes, size, "--", SERIES[3])
        axes.text(0.0, -0.48 * size[1], _size_text("clear opening", size), ha="center", va="bottom", fontsize=6.5, color=SERIES[3])


def _size_text(name: str, size: Sequence[float]) -> str:
    return f"{name} {number(size[0])} × {number(size[1])}"


@lru_cache(maxsize=4)
def _outline_middle(mechanism: Mechanism) -> Array:
    """Middle (x, y) [mm] of the box around all outlines: an envelope says how much room there is, not where."""
    found = outlines(expand(mechanism))
    if not found:
        return np.zeros(2)

    def farthest(direction: Array) -> float:
        return max(float(first_design(np.asarray(outline.reach(direction)), 0)) for outline in found)

    return np.array([500.0 * (farthest(axis) - farthest(-axis)) for axis in np.eye(3)[:2]])


def _axes_of_symmetry(axes: Any, reach: Array) -> None:
    for x, y in ((1.06 * reach[0], 0.0), (0.0, 1.06 * reach[1])):
        axes.plot([-x, x], [-y, y], color=MUTED, linewidth=0.5, linestyle=(0, (10, 3, 2, 3)))
    axes.text(1.07 * reach[0], 0.0, "x", ha="left", va="center", fontsize=8, color=MUTED, style="italic")
    axes.text(0.0, 1.07 * reach[1], "y", ha="center", va="bottom", fontsize=8, color=MUTED, style="italic")


def _rings(axes: Any, found: tuple[Ring, ...], taken: list[Array]) -> None:
    """Circles with their radii, and a ray to each first copy with its position angle; `taken` are places of other texts."""
    circle = np.linspace(0.0, 2.0 * np.pi, 121)
    for angle in sorted({round(ring.first % 360.0, 6) for ring in found} - {0.0}):
        _ray(axes, np.deg2rad(angle), max(ring.radius for ring in found if round(ring.first % 360.0, 6) == angle))
    for radius in sorted({round(ring.radius, 6) for ring in found}):
        axes.plot(radius * np.cos(circle), radius * np.sin(circle), color=MUTED, linewidth=0.5, linestyle=(0, (8, 3, 1.5, 3)))
        place = _free_place(radius, taken)
        taken = [*taken, place]
        axes.text(*place, f"R {number(radius)}", ha="center", va="center", fontsize=7, bbox=_PLATE)


def _free_place(radius: float, taken: list[Array]) -> Array:
    """The point of a circle, off the axes, that is farthest from what is written already."""
    angles = np.deg2rad(np.arange(2.5, 360.0, 5.0))
    points = radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    room = np.abs(points).min(axis=1)
    if taken:
        room = np.minimum(1.5 * room, np.sqrt(np.sum((points[:, None] - np.array(taken)[None]) ** 2, axis=-1)).min(axis=1))
    return points[int(np.argmax(np.round(room, 6)))]


def _ray(axes: Any, angle: float, radius: float) -> None:
    """A ray from the centre at a position angle, its arc from x and its value."""
    axes.plot([0.0, radius * np.cos(angle)], [0.0, radius * np.sin(angle)], color=INK, linewidth=0.5)
    turned = angle if angle <= np.pi else angle - 2.0 * np.pi
    arc = np.linspace(0.0, turned, 31)
    inner = 0.2 * radius
    axes.plot(inner * np.cos(arc), inner * np.sin(arc), color=INK, linewidth=0.5)
    middle = 0.5 * turned
    text = f"{number(float(np.rad2deg(turned)))}°".replace("-", "−")
    axes.text(1.35 * inner * np.cos(middle), 1.35 * inner * np.sin(middle), text, ha="center", va="center", fontsize=7, bbox=_PLATE)


_PLATE = {"boxstyle": "round,pad=0.15", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.85}


def _arrow(style: str) -> dict[str, Any]:
    return {"arrowstyle": style, "color": INK, "lw": 0.5, "mutation_scale": 5, "shrinkA": 0.0, "shrinkB": 0.0}


def _sizes(axes: Any, scene: Scene, reach: Array) -> None:
    """Dimension lines of the platform: its width below, its depth on the left."""
    outlines = list(_plans(scene, Kind.PLATFORM))
    if not outlines:
        return
    low, high = (function(np.concatenate(outlines), axis=0) for function in (np.min, np.max))
    gap = 0.1 * float(reach.max())
    _dimension(axes, low, np.array([high[0], low[1]]), -reach[1] - gap)
    _dimension_height(axes, low, float(high[1] - low[1]), -reach[0] - gap)


def _dimension(axes: Any, first: Array, second: Array, level: float) -> None:
    for x, y in (first, second):
        axes.plot([x, x], [y, level - 4.0], color=INK, linewidth=0.4)
    axes.annotate("", xy=(first[0], level), xytext=(second[0], level), arrowprops=_arrow("<|-|>"))
    text = number(float(second[0] - first[0]))
    axes.text(0.5 * (first[0] + second[0]), level, text, ha="center", va="center", fontsize=7.5, bbox=_PLATE)


def _dimension_height(axes: Any, low: Array, height: float, level: float) -> None:
    for y in (low[1], low[1] + height):
        axes.plot([low[0], level - 4.0], [y, y], color=INK, linewidth=0.4)
    axes.annotate("", xy=(level, low[1]), xytext=(level, low[1] + height), arrowprops=_arrow("<|-|>"))
    text = number(height)
    axes.text(level, low[1] + 0.5 * height, text, ha="center", va="center", fontsize=7.5, rotation=90, bbox=_PLATE)
