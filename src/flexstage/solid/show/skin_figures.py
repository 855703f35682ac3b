"""Pictures of solids: deformed surfaces, with colours that show a value."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from flexstage.show.display import number
from flexstage.show.figures.style import HALF, INK, style_context
from flexstage.show.scene.raster import nearest, normals, planes
from flexstage.show.scene.view import Side, picture_axes, pixels, show_image, view

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flexstage.solid.results.surface import Surface

_DARKEST = 0.55
_BAR = 0.35
_LIGHT = np.array([0.1, 0.4, 0.91])
"""Towards the light: right, up, towards the viewer."""


def skin_figure(surfaces: Sequence[Surface], label: str, *, exponent: float = 1.0, side: Side = Side.ISOMETRIC) -> Any:
    """Draw surfaces from one side as a matplotlib Figure. Colours show values from zero to the largest; `label` is the unit.

    Colours follow the value to the power of `exponent`: with an exponent below one, small values are easier to distinguish.

    >>> from flexstage.solid.results.surface import Surface
    >>> one = Surface(np.eye(3), np.array([[0, 1, 2]]), np.ones(3))
    >>> len(skin_figure([one], "MPa").axes)
    2
    """
    from matplotlib import colormaps
    from matplotlib.colors import PowerNorm

    seen = view(side)
    corners = np.concatenate([surface.places[surface.triangles] for surface in surfaces])
    values = np.concatenate([surface.values[surface.triangles] for surface in surfaces])
    scale = PowerNorm(exponent, 0.0, float(np.max(values, initial=0.0)) or 1.0)
    with style_context():
        axes = picture_axes(corners.reshape(-1, 3), seen, HALF, gap=0.03, tallest=1.0, below=_BAR)
        places, shape = pixels(axes, corners, seen)
        found, _ = nearest(places, shape)
        row, column = np.nonzero(found >= 0)
        face = found[row, column]
        across, down, level = planes(places, values)[face].T
        colours = np.array(colormaps["viridis"](scale(across * (column + 0.5) + down * (row + 0.5) + level)))
        colours[:, :3] *= (_DARKEST + (1.0 - _DARKEST) * np.abs(normals(places) @ _LIGHT))[face, None]
        image = np.zeros((*shape, 4), dtype=np.float32)
        image[row, column] = colours
        show_image(axes, image)
        _colour_bar(axes, scale, label)
    return axes.figure


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
