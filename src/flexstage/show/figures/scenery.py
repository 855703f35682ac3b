"""Areas and lines of a scene: pages get them as SVG of our own, many times faster than by matplotlib, whose axes take them too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import PathCollection
from matplotlib.path import Path

from flexstage.base.number import Array
from flexstage.base.text import printable
from flexstage.show.figures.export import SCENERY, head
from flexstage.show.figures.style import INK, PAPER, theme_colour

Colour: TypeAlias = tuple[float, ...]
"""Red, green, blue and opacity from 0 to 1."""

_NONE: Colour = (0.0, 0.0, 0.0, 0.0)
DASHES = (3.7, 1.6)
"""Lengths of a dash and of the gap after it, of a stroke's width."""

_UNITS = 10.0
"""Units of a picture's numbers in a point: steps of a tenth, 0.035 mm on paper, are less than what a printer or a screen resolves."""
_LETTER = {"bold": 0.68, "normal": 0.6}
"""Width of a letter, of the height of a font."""
_ANCHORS = {"left": "start", "center": "middle", "right": "end"}
_FEET = {"baseline": 0.0, "center": 0.32, "bottom": -0.24}
"""How far the foot of letters lies below the place that they are written at, of the height of a font."""


@dataclass(frozen=True)
class Style:
    """How a stroke is filled and edged; `width` in points, `dashes` and the gaps between them in widths."""

    fill: Colour = _NONE
    edge: Colour = _NONE
    width: float = 0.0
    dashes: tuple[float, ...] = ()

    @property
    def rule(self) -> str:
        """The same in a style sheet, lengths in tenths of a point."""
        said = [f"fill:{_colour(self.fill)}"]
        if 0.0 < self.fill[3] < 1.0:
            said.append(f"fill-opacity:{self.fill[3]:g};shape-rendering:crispEdges")  # or the seams between neighbours show
        if self.edge[3] > 0.0:
            said.append(f"stroke:{_colour(self.edge)};stroke-width:{_UNITS * self.width:g}")
        if 0.0 < self.edge[3] < 1.0:
            said.append(f"stroke-opacity:{self.edge[3]:g}")
        if self.dashes:
            said.append("stroke-dasharray:" + ",".join(f"{_UNITS * each * self.width:g}" for each in self.dashes))
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
            linestyles=[(0.0, each.dashes or None) for each in styles],
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
        points = axes.transData.transform(_joined(self.strokes)) * 72.0 / axes.figure.dpi
        return _markup(self.strokes, points * [1.0, -1.0] + [0.0, 72.0 * axes.figure.get_figheight()], name)


class Paper:
    """What matplotlib's axes are to a picture of a scene, at a tenth of their cost: one scale both ways, no frame; it tells itself as SVG.

    `low` and `high` (2,) are the corners of what is to be seen, which stands in the middle of `width` and `height` inches.
    """

    def __init__(self, low: Array, high: Array, width: float, height: float) -> None:
        self.low, self.high, self.size = low, high, 72.0 * np.array([width, height])
        self.per_point = float(np.max((high - low) / self.size))
        """Length per point of paper."""
        self.strokes: list[Stroke] = []
        self.words: list[str] = []

    def get_xlim(self) -> tuple[float, float]:
        """From left to right."""
        return float(self.low[0]), float(self.high[0])

    def get_ylim(self) -> tuple[float, float]:
        """From below to above."""
        return float(self.low[1]), float(self.high[1])

    def add_artist(self, scenery: Scenery) -> None:
        """Draw strokes over what is there."""
        self.strokes += scenery.strokes

    def plot(self, x: Array, y: Array, *, color: str, linewidth: float, linestyle: str | tuple[float, tuple[float, ...]] = "-") -> None:
        """A line through points, whole, dashed ("--") or with other dashes, (0, dashes)."""
        ends = list(pairwise(range(len(x))))
        dashes = {"-": (), "--": DASHES}[linestyle] if isinstance(linestyle, str) else linestyle[1]
        self.strokes.append(Stroke(np.stack([x, y], axis=1), Style(edge=channels(color), width=linewidth, dashes=dashes), ends))

    def annotate(self, _: str, *, xy: tuple[float, float], xytext: tuple[float, float], arrowprops: Mapping[str, Any]) -> None:
        """An arrow with a filled head from `xytext` to `xy`, or one with two heads ("<|-|>")."""
        tip, start, look = np.array(xy), np.array(xytext), channels(arrowprops["color"])
        along = (tip - start) / np.sqrt((tip - start) @ (tip - start))
        back, side = self.per_point * arrowprops["mutation_scale"] * np.stack([-0.4 * along, 0.2 * along[::-1] * [1.0, -1.0]])
        heads = {"-|>": [(tip, back)], "<|-|>": [(tip, back), (start, -back)]}[arrowprops["arrowstyle"]]
        style = Style(edge=look, width=arrowprops["lw"])
        self.strokes.append(Stroke(np.stack([start - (len(heads) - 1) * back, tip + back]), style, [(0, 1)]))
        for end, foot in heads:
            self.strokes.append(Stroke(np.stack([end, end + foot + side, end + foot - side]), replace(style, fill=look)))

    def text(  # noqa: PLR0913 (what matplotlib's axes are told)
        self,
        x: float,
        y: float,
        text: str,
        *,
        fontsize: float,
        color: str = INK,
        ha: str = "center",
        va: str = "center",
        fontweight: str = "normal",
        style: str = "normal",
        rotation: float = 0.0,
        bbox: Mapping[str, Any] | None = None,
    ) -> None:
        """A name at a place, turned about it, on a lighter ground if it is to have a `bbox`."""
        across, up = self._points(np.array([[x, y]]))[0]
        turned = f' transform="rotate({-rotation:g} {across:.1f} {up:.1f})"' if rotation else ""
        if bbox is not None and text:
            wide, high = _LETTER[fontweight] * fontsize * len(text) + 2.5, 1.2 * fontsize
            place = f'x="{across - 0.5 * wide:.1f}" y="{up - 0.5 * high:.1f}" width="{wide:.1f}" height="{high:.1f}" rx="1.3"'
            self.words.append(f'<rect {place}{turned} style="fill:{theme_colour(PAPER)};fill-opacity:{bbox["alpha"]:g}"/>')
        look = f"font-size:{fontsize:g}px;fill:{theme_colour(color)};text-anchor:{_ANCHORS[ha]};font-weight:{fontweight};font-style:{style}"
        self.words.append(f'<text x="{across:.1f}" y="{up + _FEET[va] * fontsize:.1f}"{turned} style="{look}">{escape(text)}</text>')

    def svg(self, name: str, description: str) -> str:
        """The picture as an SVG element to stand inside a page; see `to_svg`."""
        drawn = _markup(self.strokes, self._points(_joined(self.strokes)), name) if self.strokes else ""
        return printable(f"{head(self.size.tolist(), description)}{drawn}{''.join(self.words)}</svg>", keep="\n\t")

    def _points(self, places: Array) -> Array:
        """Places (n, 2) on paper [pt], from its upper left corner."""
        return (places - 0.5 * (self.low + self.high)) * np.array([1.0, -1.0]) / self.per_point + 0.5 * self.size


def _joined(strokes: Sequence[Stroke]) -> Array:
    return np.concatenate([each.points for each in strokes])


def _markup(strokes: Sequence[Stroke], points: Array, name: str) -> str:
    """Strokes whose points lie at `points` (n, 2) on paper [pt]."""
    places, start = np.rint(_UNITS * points).astype(int).tolist(), 0
    names: dict[Style, str] = {}
    drawn: list[str] = []
    for each in strokes:
        count = len(each.points)
        course = _course(places[start : start + count], each.ends)
        drawn.append(f'<path class="{names.setdefault(each.style, f"{name}-{len(names)}")}" d="{course}"/>')
        start += count
    rules = "".join(f".{own}{{{style.rule}}}" for style, own in names.items())
    return f'<style>{rules}</style><g transform="scale(.1)" stroke-linejoin="round">{"".join(drawn)}</g>'


def channels(colour: str) -> Colour:
    """A colour like #ff8000, opaque.

    >>> channels("#ff0000")
    (1.0, 0.0, 0.0, 1.0)
    """
    return (*(int(colour[place : place + 2], 16) / 255.0 for place in (1, 3, 5)), 1.0)


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
