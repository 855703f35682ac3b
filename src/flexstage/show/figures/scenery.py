"""Areas and lines of a scene on matplotlib axes: pages get them as SVG of our own, many times faster than matplotlib writes thousands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import PathCollection
from matplotlib.path import Path

from flexstage.base.number import Array
from flexstage.show.figures.export import SCENERY, theme_colour

Colour: TypeAlias = tuple[float, ...]
"""Red, green, blue and opacity from 0 to 1."""

_NONE: Colour = (0.0, 0.0, 0.0, 0.0)
_DASHES = (3.7, 1.6)
_UNITS = 10.0
"""Units of a picture's numbers in a point: steps of a tenth, 0.035 mm on paper, are less than what a printer or a screen resolves."""


@dataclass(frozen=True)
class Style:
    """How a stroke is filled and edged; `width` in points."""

    fill: Colour = _NONE
    edge: Colour = _NONE
    width: float = 0.0
    dashed: bool = False

    @property
    def rule(self) -> str:
        """The same in a style sheet, lengths in tenths of a point."""
        said = [f"fill:{_colour(self.fill)}"]
        if 0.0 < self.fill[3] < 1.0:
            said.append(f"fill-opacity:{self.fill[3]:g};shape-rendering:crispEdges")  # or the seams between neighbours show
        if self.edge[3] > 0.0:
            said.append(f"stroke:{_colour(self.edge)};stroke-width:{_UNITS * self.width:g}")
        if self.dashed:
            said.append("stroke-dasharray:" + ",".join(f"{_UNITS * each * self.width:g}" for each in _DASHES))
        return ";".join(said)


@dataclass(frozen=True, eq=False)
class Stroke:
    """A closed area with these points (n, 2), or, with `ends`, lines between pairs of them."""

    points: Array
    style: Style
    ends: Sequence[tuple[int, int]] | None = None


class Scenery(Artist):
    """Strokes in the axes' data units, drawn in their order, under everything else of a page's picture."""

    def __init__(self, strokes: Sequence[Stroke]) -> None:
        super().__init__()
        self.strokes = strokes
        self.set_gid(SCENERY)

    def draw(self, renderer: Any) -> None:
        """Draw the strokes as matplotlib does: for PNG and PDF."""
        if not self.get_visible():
            return
        styles = [each.style for each in self.strokes]
        drawn = PathCollection(
            [_path(each) for each in self.strokes],
            facecolors=[each.fill for each in styles],
            edgecolors=[each.edge for each in styles],
            linewidths=[each.width for each in styles],
            linestyles=[(0.0, _DASHES if each.dashed else None) for each in styles],
            clip_on=False,
        )
        axes: Any = self.axes
        drawn.axes = axes
        drawn.set_figure(axes.figure)
        drawn.set_transform(self.get_transform())
        drawn.draw(renderer)

    def markup(self, name: str) -> str:
        """The strokes as SVG, in tenths of a point; those of one style share a class, whose name begins with `name`."""
        axes: Any = self.axes
        counts = [len(each.points) for each in self.strokes]
        inch = 72.0 * _UNITS
        points = axes.transData.transform(np.concatenate([each.points for each in self.strokes])) * inch / axes.figure.dpi
        points[:, 1] = inch * axes.figure.get_figheight() - points[:, 1]
        places, start = np.rint(points).astype(int).tolist(), 0
        names: dict[Style, str] = {}
        drawn: list[str] = []
        for each, count in zip(self.strokes, counts, strict=True):
            course = _course(places[start : start + count], each.ends)
            drawn.append(f'<path class="{names.setdefault(each.style, f"{name}-{len(names)}")}" d="{course}"/>')
            start += count
        rules = "".join(f".{own}{{{style.rule}}}" for style, own in names.items())
        return f'<style>{rules}</style><g transform="scale(.1)" stroke-linejoin="round">{"".join(drawn)}</g>'


def _path(stroke: Stroke) -> Path:
    if stroke.ends is None:
        return Path(np.vstack([stroke.points, stroke.points[:1]]), closed=True)
    return Path(stroke.points[np.ravel(stroke.ends)], [Path.MOVETO, Path.LINETO] * len(stroke.ends))


def _course(points: Sequence[Sequence[int]], ends: Sequence[tuple[int, int]] | None) -> str:
    """An area, or lines between pairs of points, as steps; a line that begins where the last one ended goes on.

    >>> _course([(0, 0), (10, -10), (10, 20)], None), _course([(0, 0), (10, -10), (10, 20)], [(0, 1), (1, 2)])
    ('M0 0l10-10 0 30z', 'M0 0l10-10 0 30')
    """
    if ends is None:
        steps = " ".join(f"{after[0] - here[0]} {after[1] - here[1]}" for here, after in pairwise(points))
        return f"M{points[0][0]} {points[0][1]}l{steps}z".replace(" -", "-")
    pieces: list[str] = []
    last = -1
    for first, second in ends:
        here, after = points[first], points[second]
        begun = " " if first == last else f"M{here[0]} {here[1]}l"
        pieces.append(f"{begun}{after[0] - here[0]} {after[1] - here[1]}")
        last = second
    return "".join(pieces).replace(" -", "-")


def _colour(channels: Colour) -> str:
    return theme_colour("#" + "".join(f"{round(255.0 * each):02x}" for each in channels[:3])) if channels[3] > 0.0 else "none"
