"""The dimensioned plan: the stage from above as a workshop drawing, with radii, angles, names and sizes in mm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.number import Array, first_design
from flexstage.mechanism.assembly.expand import copy_names, expand
from flexstage.mechanism.assembly.pattern import Normal, Polar
from flexstage.mechanism.geometry.outline import outlines
from flexstage.mechanism.mechanism import Mechanism, posed
from flexstage.show.display import number
from flexstage.show.figures.hull import hull
from flexstage.show.figures.style import FULL, INK, MUTED, PAPER, SERIES, canvas, style_context
from flexstage.show.scene.primitives import first_value
from flexstage.show.scene.skin import Kind
from flexstage.show.scene.view import Side, edges_of, fit, solid_parts, view, write
from flexstage.show.viewer.data import StageData

_FILLS = {Kind.GROUND: "#56606b", Kind.BODY: "#8d99a6", Kind.DRIVE: "#f2a33c", Kind.HINGE: "#0f8a7e", Kind.GAUGE: "#c2395a"}
"""Fill colours of the kinds of parts, from the lowest layer to the highest."""
_OPACITY = 0.55
_ARROW = {"arrowstyle": "<|-|>", "color": INK, "lw": 0.5, "mutation_scale": 5, "shrinkA": 0.0, "shrinkB": 0.0}
_LABEL = {
    "ha": "center",
    "va": "center",
    "fontsize": 7,
    "bbox": {"boxstyle": "round,pad=0.15", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.85},
}


@dataclass(frozen=True)
class Ring:
    """Instances on a circle: names, radius [mm], position angle of the first instance [deg] and angular step [deg]."""

    names: tuple[str, ...]
    radius: float
    first: float
    step: float


def rings(mechanism: Mechanism) -> tuple[Ring, ...]:
    """Find the circles on which instances of units and gauges are placed.

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


def plan_figure(mechanism: Mechanism, data: StageData) -> Any:
    """Draw the stage from above with dimensions in mm, as a matplotlib Figure.

    The drawing shows envelope, aperture, outlines of bodies and parts, and circles of units and gauges with radius and position angles.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.show.viewer.data import still_data
    >>> len(plan_figure(case("parallelogram"), still_data(case("parallelogram"))).axes)
    1
    """
    middle = _outline_middle(mechanism)
    reach = _reach(mechanism, data, middle)
    margin = 0.2 * float(reach.max())
    low, high = -reach - margin, reach + 0.65 * margin  # dimensions are on the left and below
    with style_context():
        figure = canvas(FULL, min(1.1, float((high - low)[1] / (high - low)[0])) * FULL)
        axes = fit(figure.add_axes((0.0, 0.0, 1.0, 1.0)), low, high)
        _outlines(axes, data)
        _axes_of_symmetry(axes, reach)
        _rings(axes, rings(mechanism))
        _rectangles(axes, mechanism, middle)
        write(axes, data.labels, view(Side.TOP))
        _sizes(axes, data, reach)
    return figure


def _reach(mechanism: Mechanism, data: StageData, middle: Array) -> Array:
    """Half sizes (x, y) [mm] of the drawing about the stage's z axis."""
    reach = np.abs(1e3 * data.mesh.points[:, :2]).max(axis=0, initial=0.0) if len(data.mesh.points) else np.full(2, 50.0)
    if mechanism.envelope is not None:
        reach = np.maximum(reach, np.abs(middle) + [500.0 * first_value(size) for size in mechanism.envelope[:2]])
    return np.maximum(reach, 0.2 * reach.max())


def _outlines(axes: Any, data: StageData) -> None:
    """Every part as the convex outline of its plan; of the platform only its edges, including holes."""
    from matplotlib.collections import PolyCollection

    mesh, flat = data.mesh, 1e3 * data.mesh.points[:, :2]
    for kind, colour in _FILLS.items():
        plans = [hull(flat[mesh.part == part]) for part in solid_parts(data, kind)]
        axes.add_collection(PolyCollection(plans, facecolors=colour, edgecolors=INK, linewidths=0.45, alpha=_OPACITY))
    axes.plot(*edges_of(data, view(Side.TOP), Kind.PLATFORM).T, color=SERIES[0], linewidth=1.0)


def _rectangle(axes: Any, size: Sequence[float], colour: str, centre: Sequence[float] = (0.0, 0.0)) -> None:
    x, y = centre[0] + 0.5 * size[0] * np.array([-1, 1, 1, -1, -1]), centre[1] + 0.5 * size[1] * np.array([-1, -1, 1, 1, -1])
    axes.plot(x, y, linestyle="--", color=colour, linewidth=1.0)


def _rectangles(axes: Any, mechanism: Mechanism, middle: Array) -> None:
    """Envelope and aperture with their names: the aperture is centred on the stage's axis, the envelope on all outlines."""
    if mechanism.envelope is not None:
        size, (x, y) = [1e3 * first_value(value) for value in mechanism.envelope[:2]], middle
        _rectangle(axes, size, MUTED, (x, y))
        place = (x + 0.495 * size[0], y + 0.5 * size[1] + 1.0)
        axes.text(*place, _size_text("envelope", size), ha="right", va="bottom", fontsize=6.5, color=MUTED)
    if mechanism.opening is not None:
        size = [1e3 * first_value(value) for value in mechanism.opening.size]
        _rectangle(axes, size, SERIES[3])
        axes.text(0.0, -0.48 * size[1], _size_text("clear opening", size), ha="center", va="bottom", fontsize=6.5, color=SERIES[3])


def _size_text(name: str, size: Sequence[float]) -> str:
    return f"{name} {number(size[0])} × {number(size[1])}"


def _outline_middle(mechanism: Mechanism) -> Array:
    """Middle (x, y) [mm] of the box around all outlines: an envelope has a size but no position."""
    found = outlines(expand(mechanism)) if mechanism.envelope is not None else ()
    if not found:
        return np.zeros(2)
    ends = [[first_design(np.asarray(outline.reach(turn * axis)), 0) for outline in found] for axis in np.eye(3)[:2] for turn in (1, -1)]
    x, back, y, down = (500.0 * float(max(each)) for each in ends)
    return np.array([x - back, y - down])


def _axes_of_symmetry(axes: Any, reach: Array) -> None:
    for x, y in ((1.06 * reach[0], 0.0), (0.0, 1.06 * reach[1])):
        axes.plot([-x, x], [-y, y], color=MUTED, linewidth=0.5, linestyle=(0, (10, 3, 2, 3)))
    axes.text(1.07 * reach[0], 0.0, "x", ha="left", va="center", fontsize=8, color=MUTED, style="italic")
    axes.text(0.0, 1.07 * reach[1], "y", ha="center", va="bottom", fontsize=8, color=MUTED, style="italic")


def _rings(axes: Any, found: tuple[Ring, ...]) -> None:
    """Circles with their radii, and a ray to the first instance of each with its position angle."""
    circle = np.linspace(0.0, 2.0 * np.pi, 121)
    for angle in sorted({round(ring.first % 360.0, 6) for ring in found} - {0.0}):
        _ray(axes, np.deg2rad(angle), max(ring.radius for ring in found if round(ring.first % 360.0, 6) == angle))
    for radius in sorted({round(ring.radius, 6) for ring in found}):
        axes.plot(radius * np.cos(circle), radius * np.sin(circle), color=MUTED, linewidth=0.5, linestyle=(0, (8, 3, 1.5, 3)))
        between = np.deg2rad(next(ring.first + 0.5 * ring.step for ring in found if round(ring.radius, 6) == radius))
        axes.text(radius * np.cos(between), radius * np.sin(between), f"R {number(radius)}", **_LABEL)


def _ray(axes: Any, angle: float, radius: float) -> None:
    """A ray from the centre at a position angle, its arc from x and its value."""
    axes.plot([0.0, radius * np.cos(angle)], [0.0, radius * np.sin(angle)], color=INK, linewidth=0.5)
    turned = angle if angle <= np.pi else angle - 2.0 * np.pi
    arc = np.linspace(0.0, turned, 31)
    inner = 0.2 * radius
    axes.plot(inner * np.cos(arc), inner * np.sin(arc), color=INK, linewidth=0.5)
    middle = 0.5 * turned
    text = f"{number(float(np.rad2deg(turned)))}°".replace("-", "−")
    axes.text(1.35 * inner * np.cos(middle), 1.35 * inner * np.sin(middle), text, **_LABEL)


def _sizes(axes: Any, data: StageData, reach: Array) -> None:
    """Dimension lines of the platform: its width below, its depth on the left."""
    own = 1e3 * data.mesh.points[np.isin(data.mesh.part, solid_parts(data, Kind.PLATFORM))][:, :2]
    if not len(own):
        return
    (left, low), (right, high) = own.min(axis=0), own.max(axis=0)
    x, y = -reach - 0.1 * float(reach.max())
    for start, end in (((left, y), (right, y)), ((x, low), (x, high))):
        axes.annotate("", xy=start, xytext=end, arrowprops=_ARROW)
    for side in (left, right):
        axes.plot([side, side], [low, y - 4.0], color=INK, linewidth=0.4)
    for level in (low, high):
        axes.plot([left, x - 4.0], [level, level], color=INK, linewidth=0.4)
    style = _LABEL | {"fontsize": 7.5}
    axes.text(0.5 * (left + right), y, number(float(right - left)), **style)
    axes.text(x, 0.5 * (low + high), number(float(high - low)), rotation=90, **style)
