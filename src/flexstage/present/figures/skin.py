"""Pictures of solids: deformed surfaces with colours for a value, faces sorted by depth."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np

from flexstage.base.number import Array
from flexstage.present.display import number
from flexstage.present.figures.export import to_png
from flexstage.present.figures.style import HALF, INK, canvas, styled
from flexstage.present.page import Picture
from flexstage.present.scene.view import Side, View, view

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flexstage.studies.solid_surface import Surface

_DARKEST = 0.55
_TALLEST = 1.0
_BAR = 0.35


def skin_figure(surfaces: Sequence[Surface], label: str, *, highest: float | None = None, side: Side = Side.ISOMETRIC) -> Any:
    """Surfaces from one side as a matplotlib Figure; colours from zero to `highest` (the largest value, unless given), named by `label`.

    >>> from flexstage.studies.solid_surface import Surface
    >>> one = Surface(np.eye(3), np.array([[0, 1, 2]]), np.ones(3))
    >>> len(skin_figure([one], "MPa").axes)
    2
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import Normalize

    seen = view(side)
    corners, values = _faces(surfaces, seen)
    flat = seen.flat(corners.reshape(-1, 3)).reshape(-1, 3, 2)
    top = float(np.max(values)) if highest is None else highest
    scale = Normalize(0.0, top or 1.0)
    with styled():
        from matplotlib import colormaps

        colours = np.array(colormaps["viridis"](scale(values)))
        colours[:, :3] *= _shade(corners, seen)[:, None]
        axes = _axes(flat)
        axes.add_collection(PolyCollection(list(flat), facecolors=colours, edgecolors=colours, linewidths=0.2))
        _colour_bar(axes, scale, label)
    return axes.figure


def _faces(surfaces: Sequence[Surface], seen: View) -> tuple[Array, Array]:
    """Corners (t, 3, 3) of the faces that look towards the viewer, farthest first, and their mean values (t,)."""
    corners = np.concatenate([surface.places[surface.triangles] for surface in surfaces])
    values = np.concatenate([surface.values[surface.triangles].mean(axis=1) for surface in surfaces])
    order = np.argsort(corners.mean(axis=1) @ seen.axes[2], kind="stable")
    return corners[order], values[order]


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
    place = figure.add_axes((0.25, 0.62 * share, 0.5, 0.18 * share))
    bar = figure.colorbar(ScalarMappable(scale, "viridis"), cax=place, orientation="horizontal", ticks=[0.0, scale.vmax])
    bar.outline.set_visible(False)
    place.set_xticklabels(["0", f"{number(float(scale.vmax), 3)} {label}".strip()])
    place.tick_params(length=0, labelsize=7, labelcolor=INK, pad=1)


def png_picture(figure: Any, caption: str, *, dots_per_inch: int = 130) -> Picture:
    """A figure as a picture of a page, drawn in dots: thousands of faces would make a heavy SVG.

    >>> from flexstage.present.figures.style import canvas
    >>> png_picture(canvas(1.0, 1.0), "nothing").svg[:31]
    '<img src="data:image/png;base64'
    """
    data = base64.b64encode(to_png(figure, dots_per_inch=dots_per_inch)).decode("ascii")
    alt = caption.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return Picture(f'<img src="data:image/png;base64,{data}" alt="{alt}" style="max-width:100%">', caption)
