"""Pictures of solids: deformed surfaces with colours for a value, faces sorted by depth."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np

from flexstage.base.number import Array
from flexstage.show.display import number
from flexstage.show.figures.export import to_png
from flexstage.show.figures.style import HALF, INK, canvas, style_context
from flexstage.show.page import Picture
from flexstage.show.scene.view import Side, View, view

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flexstage.solid.results.surface import Surface

_DARKEST = 0.55
_TALLEST = 1.0
_BAR = 0.35
_DIVISIONS, _COARSEST = 4, 0.03


def skin_figure(surfaces: Sequence[Surface], label: str, *, exponent: float = 1.0, side: Side = Side.ISOMETRIC) -> Any:
    """Surfaces from one side as a matplotlib Figure; colours from zero to the largest value, its unit in `label`.

    Colours follow the value to the power of `exponent`: below one, small values are told apart.

    >>> from flexstage.solid.results.surface import Surface
    >>> one = Surface(np.eye(3), np.array([[0, 1, 2]]), np.ones(3))
    >>> len(skin_figure([one], "MPa").axes)
    2
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import PowerNorm

    seen = view(side)
    corners, values = _faces(surfaces, seen)
    flat = seen.project(corners.reshape(-1, 3)).reshape(-1, 3, 2)
    highest = max((float(np.max(surface.values)) for surface in surfaces), default=0.0)
    scale = PowerNorm(exponent, 0.0, highest or 1.0)
    with style_context():
        from matplotlib import colormaps

        colours = np.array(colormaps["viridis"](scale(values)))
        colours[:, :3] *= _shade(corners, seen)[:, None]
        axes = _axes(flat)
        axes.add_collection(PolyCollection(list(flat), facecolors=colours, edgecolors=colours, linewidths=0.2))
        _colour_bar(axes, scale, label)
    return axes.figure


def _faces(surfaces: Sequence[Surface], seen: View) -> tuple[Array, Array]:
    """Corners (t, 3, 3) of the faces, farthest first, and their mean values (t,); large ones divided, for depth and for colour."""
    corners = np.concatenate([surface.places[surface.triangles] for surface in surfaces])
    values = np.concatenate([surface.values[surface.triangles] for surface in surfaces])
    size = float(np.max(np.ptp(corners.reshape(-1, 3), axis=0)))
    for _ in range(_DIVISIONS):
        corners, values = _divide(corners, values, _COARSEST * size)
    order = np.argsort(corners.mean(axis=1) @ seen.axes[2], kind="stable")
    return corners[order], values[order].mean(axis=1)


def _divide(corners: Array, values: Array, limit: float) -> tuple[Array, Array]:
    """Faces with an edge above the limit replaced by four, at the middles of their edges."""
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    large = edges.max(axis=1) > limit
    split = [_quarters(item[large]) for item in (corners, values)]
    return np.concatenate([corners[~large], split[0]]), np.concatenate([values[~large], split[1]])


def _quarters(items: Array) -> Array:
    a, b, c = items[:, 0], items[:, 1], items[:, 2]
    d, e, f = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
    return np.concatenate([np.stack(each, axis=1) for each in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])


def _shade(corners: Array, seen: View) -> Array:
    """Brightness (t,) of faces by their slope: full where they look at the viewer from above."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
    light = seen.axes[2] + np.array([0.2, 0.5, 0.9])
    return _DARKEST + (1.0 - _DARKEST) * np.abs(normal @ (light / np.linalg.norm(light)))


def _axes(flat: Array) -> Any:
    low, high = flat.reshape(-1, 2).min(axis=0), flat.reshape(-1, 2).max(axis=0)
    gap = 0.03 * float(max(high - low))
    extent = high - low + 2.0 * gap
    figure = canvas(HALF, _BAR + HALF * min(_TALLEST, float(extent[1] / extent[0])))
    share = _BAR / figure.get_size_inches()[1]
    axes = figure.add_axes((0.0, share, 1.0, 1.0 - share))
    axes.set_xlim(low[0] - gap, high[0] + gap)
    axes.set_ylim(low[1] - gap, high[1] + gap)
    axes.set_aspect("equal")
    axes.set_axis_off()
    return axes


def _colour_bar(axes: Any, scale: Any, label: str) -> None:
    from matplotlib.cm import ScalarMappable

    figure = axes.figure
    share = _BAR / figure.get_size_inches()[1]
    middle = float(f"{scale.vmax * 0.5 ** (1.0 / scale.gamma):.1g}")
    ticks = [0.0, middle, scale.vmax]
    place = figure.add_axes((0.25, 0.62 * share, 0.5, 0.18 * share))
    bar = figure.colorbar(ScalarMappable(scale, "viridis"), cax=place, orientation="horizontal", ticks=ticks)
    bar.outline.set_visible(False)
    place.set_xticklabels(["0", number(middle, 3), f"{number(float(scale.vmax), 3)} {label}".strip()])
    place.tick_params(length=0, labelsize=7, labelcolor=INK, pad=1)


def png_picture(figure: Any, caption: str, *, dots_per_inch: int = 130) -> Picture:
    """A figure as a picture of a page, drawn in dots: thousands of faces would make a heavy SVG.

    >>> from flexstage.show.figures.style import canvas
    >>> png_picture(canvas(1.0, 1.0), "nothing").svg[:31]
    '<img src="data:image/png;base64'
    """
    data = base64.b64encode(to_png(figure, dots_per_inch=dots_per_inch)).decode("ascii")
    alt = caption.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return Picture(f'<img src="data:image/png;base64,{data}" alt="{alt}" style="max-width:100%">', caption)
