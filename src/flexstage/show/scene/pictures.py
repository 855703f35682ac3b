"""Pictures of a stage: from three sides and above the corner, at rest or moved."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.show.figures.style import FULL, canvas, style_context
from flexstage.show.scene.facet import Facet, Kind
from flexstage.show.scene.stage import Scene, displace
from flexstage.show.scene.view import Side, View, draw, order_facets, outline, triad, view, write

_TALLEST = 1.1
_MOVED = (Kind.PLATFORM, Kind.BODY, Kind.DRIVE)


def stage_picture(scene: Scene, *, side: Side = Side.ISOMETRIC, width: float = FULL, names: bool = True) -> Any:
    """The stage from one side, with the names of actuators and gauges, as a matplotlib Figure.

    >>> from flexstage.mechanism.mechanism import Mechanism
    >>> from flexstage.show.scene.stage import scene
    >>> len(stage_picture(scene(Mechanism("")), side=Side.TOP).axes)
    1
    """
    seen = view(side)
    facets = order_facets(scene, seen)
    labels = scene.labels if names else ()
    with style_context():
        axes = _axes(facets, seen, width)
        draw(axes, facets, seen)
        write(axes, labels, seen)
        triad(axes, seen)
    return axes.figure


def moved_picture(scene: Scene, twists: Mapping[str, Array], factor: float, *, side: Side = Side.ISOMETRIC, width: float = FULL) -> Any:
    """The stage with its bodies moved by `factor` times their twists, over the platform's outline at rest; hinges and gauges left out.

    >>> from flexstage.mechanism.mechanism import Mechanism
    >>> from flexstage.show.scene.stage import scene
    >>> len(moved_picture(scene(Mechanism("")), {}, 1.0).axes)
    1
    """
    seen = view(side)
    kept = [facet for facet in order_facets(scene, seen) if facet.paint.kind in _MOVED]
    moved = displace(kept, scene, twists, factor)
    with style_context():
        axes = _axes(kept, seen, width)
        outline(axes, [facet for facet in kept if facet.paint.kind is Kind.PLATFORM], seen)
        draw(axes, moved, seen)
    return axes.figure


def _axes(facets: list[Facet], seen: View, width: float) -> Any:
    """Axes that the facets fill, in a figure as high as they need."""
    points = [seen.project(facet.points) for facet in facets] or [np.zeros((1, 2))]
    flat = np.concatenate(points)
    low, high = flat.min(axis=0), flat.max(axis=0)
    gap = 0.05 * float(max(high - low)) or 1.0
    extent = high - low + 2.0 * gap
    figure = canvas(width, width * min(_TALLEST, float(extent[1] / extent[0])))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(low[0] - gap, high[0] + gap)
    axes.set_ylim(low[1] - gap, high[1] + gap)
    axes.set_aspect("equal")
    axes.set_axis_off()
    return axes
