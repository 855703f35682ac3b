"""Views: parallel projection of a scene from a direction, and its drawing on matplotlib axes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache, lru_cache
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from flexstage.base.number import Array
from flexstage.show.figures.style import DRIVE, GAUGE, INK, MUTED, PAPER
from flexstage.show.scene.facet import SHARP, Facet, Kind
from flexstage.show.scene.hidden import are_visible
from flexstage.show.scene.order import sort_by_depth
from flexstage.show.scene.silhouette import silhouettes
from flexstage.show.scene.stage import Label, Scene

if TYPE_CHECKING:
    from flexstage.show.figures.scenery import Stroke, Style

_COLOURS = {
    Kind.PLATFORM: ("#6ea8d8", 0.42),
    Kind.BODY: ("#b9c2cc", 1.0),
    Kind.HINGE: ("#0f8a7e", 1.0),
    Kind.DRIVE: ("#f2a33c", 1.0),
    Kind.GAUGE: ("#c2395a", 1.0),
    Kind.GROUND: ("#56606b", 1.0),
}
NAMES = {
    Kind.PLATFORM: "platform",
    Kind.BODY: "bodies",
    Kind.HINGE: "hinges",
    Kind.DRIVE: "actuators",
    Kind.GAUGE: "gauges",
    Kind.GROUND: "ground",
}
_LABEL_COLOURS = {Kind.DRIVE: DRIVE, Kind.GAUGE: GAUGE}
_SHADES = 9
_ARROW = {"arrowstyle": "-|>", "color": MUTED, "lw": 0.8, "mutation_scale": 5, "shrinkA": 0.0, "shrinkB": 0.0}
_LIGHT = np.array([-0.35, 0.55, 0.76])


class Side(Enum):
    """From where the stage is seen; the value is the direction towards the viewer and the direction that is up in the picture."""

    TOP = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
    FRONT = ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
    RIGHT = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    ISOMETRIC = ((0.62, -0.88, 0.72), (0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class View:
    """A direction of sight: unit vectors to the right, up and towards the viewer, rows of `axes` (3, 3)."""

    axes: Array

    def project(self, points: Array) -> Array:
        """Points (..., 3) [m] in the picture (..., 2) [mm]."""
        return 1e3 * points @ self.axes[:2].T


@cache
def view(side: Side) -> View:
    """The view from a side.

    >>> view(Side.FRONT).project(np.array([0.001, 0.0, 0.002])).round(9).tolist()
    [1.0, 2.0]
    """
    eye, up = (np.array(direction) for direction in side.value)
    eye = eye / np.sqrt(eye @ eye)
    right = np.cross(up, eye)
    right = right / np.sqrt(right @ right)
    return View(np.stack([right, np.cross(eye, right), eye]))


@lru_cache(maxsize=len(Side))
def order_facets(scene: Scene, seen: View) -> list[Facet]:
    """The facets that face the viewer, from the farthest to the nearest; of a large scene its silhouettes.

    >>> from flexstage.mechanism.mechanism import Mechanism
    >>> from flexstage.show.scene.stage import scene
    >>> order_facets(scene(Mechanism("")), view(Side.TOP))
    []
    """
    if scene.is_large:
        return rejoin(silhouettes(scene.facets, seen.axes), seen)
    ordered = list(sort_by_depth(scene.order, seen.axes[2]))
    towards = np.array([facet.normal for facet in ordered]).reshape(-1, 3) @ seen.axes[2] > 1e-6
    return rejoin([facet for facet, faces in zip(ordered, towards.tolist(), strict=True) if faces or len(facet.points) == 2], seen)


def rejoin(facets: list[Facet], seen: View) -> list[Facet]:
    """The facets with translucent ones made whole again and drawn last, where nothing opaque stands before them: pieces show their seams.

    >>> rejoin([], view(Side.TOP))
    []
    """
    wholes = {id(facet.whole or facet): facet.whole or facet for facet in facets if _is_translucent(facet)}
    opaque = [facet for facet in facets if not _is_translucent(facet)]
    if not wholes or not opaque:
        return facets
    points = np.concatenate([facet.points for facet in opaque])
    starts = np.cumsum([0, *(len(facet.points) for facet in opaque)])[:-1]
    flat = seen.project(points)
    low, high = np.minimum.reduceat(flat, starts, axis=0), np.maximum.reduceat(flat, starts, axis=0)
    free = {key for key, whole in wholes.items() if not np.any(_are_in_front(whole, points, starts) & _is_box_met(whole, low, high, seen))}
    return [facet for facet in facets if id(facet.whole or facet) not in free] + [wholes[key] for key in wholes if key in free]


def _is_translucent(facet: Facet) -> bool:
    return _COLOURS[facet.paint.kind][1] < 1.0


def _are_in_front(whole: Facet, points: Array, starts: Array) -> Array:
    """Which of the facets whose points start at `starts` reach before a facet's plane."""
    return np.maximum.reduceat((points - whole.points[0]) @ whole.normal, starts) > 1e-5


def _is_box_met(whole: Facet, low: Array, high: Array, seen: View) -> Array:
    """Which boxes in the picture, from `low` to `high` (n, 2), meet the one around a facet; all meet a line."""
    own = seen.project(whole.points)
    return np.all((high > own.min(axis=0)) & (low < own.max(axis=0)), axis=1) | (len(own) < 3)


def draw(axes: Any, facets: Sequence[Facet], seen: View) -> None:
    """Draw facets in their order on matplotlib axes, in mm; those that others hide are left out.

    The platform is translucent, so that what is under it shows.

    >>> from flexstage.show.figures.style import canvas
    >>> axes = canvas(1.0, 1.0).add_subplot()
    >>> draw(axes, [], view(Side.TOP))
    >>> len(axes.artists)
    0
    """
    from flexstage.show.figures.scenery import Scenery  # loads matplotlib

    flats, edges, tones = _flats(facets, seen), _edges(facets, seen), _tones(facets, seen)
    shows = are_visible(flats, [not _is_translucent(facet) for facet in facets])
    drawn = (each for each, shown in zip(zip(facets, flats, edges, tones, strict=True), shows, strict=True) if shown)
    strokes = [stroke for facet, flat, ends, tone in drawn for stroke in _strokes(facet.paint.kind, flat, ends, tone)]
    if strokes:
        axes.add_artist(Scenery(strokes))


def _strokes(kind: Kind, flat: Array, ends: list[tuple[int, int]], tone: int) -> Iterator[Stroke]:
    """A facet's area and its drawn edges; where all of an opaque one are drawn they are the area's own."""
    from flexstage.show.figures.scenery import Stroke

    closed = len(ends) == len(flat) > 2 and _COLOURS[kind][1] == 1.0
    if len(flat) > 2:
        yield Stroke(flat, _fill_style(kind, tone, edged=closed))
    if ends and not closed:
        yield Stroke(flat, _line_style(), ends)


def _flats(facets: Sequence[Facet], seen: View) -> list[Array]:
    """Every facet's points in the picture (n, 2)."""
    flat = seen.project(np.concatenate([facet.points for facet in facets] or [np.zeros((0, 3))]))
    return [flat[start:stop] for start, stop in pairwise(accumulate((len(facet.points) for facet in facets), initial=0))]


def _edges(facets: Sequence[Facet], seen: View) -> list[list[tuple[int, int]]]:
    """The drawn edges of every facet, between which of its points."""
    edges = [SHARP if edge is None else edge for facet in facets for edge in facet.edges]
    away = iter((np.array(edges).reshape(-1, 3) @ seen.axes[2] <= 0.0).tolist())
    return [
        [(index, (index + 1) % len(facet.edges)) for index, edge in enumerate(facet.edges) if next(away) and edge is not None]
        for facet in facets
    ]


def _tones(facets: Sequence[Facet], seen: View) -> list[int]:
    """How light each facet is: less the more it turns away from a light above the viewer's left shoulder."""
    turned = np.array([facet.normal for facet in facets]).reshape(-1, 3) @ (_LIGHT @ seen.axes)
    return np.rint((0.62 + 0.38 * np.maximum(0.0, turned)) * _SHADES).astype(int).tolist()


@cache
def _fill_style(kind: Kind, tone: int, *, edged: bool) -> Style:
    """The kind's colour in a tone; opaque areas whose edges are not drawn have an edge of their own colour, or seams show."""
    from flexstage.show.figures.scenery import Style, channels

    colour, alpha = _COLOURS[kind]
    fill = (*(round(channel * tone / _SHADES, 3) for channel in channels(colour)[:3]), alpha)
    if edged:
        return replace(_line_style(), fill=fill)
    return Style(fill, fill, 0.45) if alpha == 1.0 else Style(fill)


@cache
def _line_style(colour: str = INK, width: float = 0.4, *, dashed: bool = False) -> Style:
    from flexstage.show.figures.scenery import DASHES, Style, channels

    return Style(edge=channels(colour), width=width, dashes=DASHES if dashed else ())


def outline(axes: Any, facets: Sequence[Facet], seen: View) -> None:
    """Draw the edges of facets only, as thin lines.

    >>> from flexstage.show.figures.style import canvas
    >>> outline(canvas(1.0, 1.0).add_subplot(), [], view(Side.TOP))
    """
    from flexstage.show.figures.scenery import Scenery, Stroke

    style = _line_style(MUTED, 0.5, dashed=True)
    lines = [Stroke(flat, style, ends) for flat, ends in zip(_flats(facets, seen), _edges(facets, seen), strict=True) if ends]
    if lines:
        axes.add_artist(Scenery(lines))


def write(axes: Any, labels: tuple[Label, ...], seen: View, per_point: float | None = None) -> None:
    """Write names beside their points, moved apart where they would cover one another.

    `per_point` is the length in the picture per point of paper, where it is known.

    >>> from flexstage.show.figures.style import canvas
    >>> axes = canvas(1.0, 1.0).add_subplot()
    >>> write(axes, (Label("B1", (0.0, 0.0, 0.0), Kind.DRIVE),), view(Side.TOP))
    >>> axes.texts[0].get_text()
    'B1'
    """
    sizes = np.array([(_LETTER * len(label.text) + _ROUND, _LINE) for label in labels]).reshape(-1, 2)
    places = _spread(seen.project(np.array([label.point for label in labels]).reshape(-1, 3)), (per_point or _per_point(axes)) * sizes)
    box = {"boxstyle": "round,pad=0.18", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.8}
    for label, (x, y) in zip(labels, places, strict=True):
        colour = _LABEL_COLOURS.get(label.kind, INK)
        axes.text(x, y, label.text, ha="center", va="center", fontsize=7, color=colour, fontweight="bold", bbox=box)


_LETTER, _ROUND, _LINE = 5.0, 4.0, 11.5
"""Width of a letter of a name, what its box adds, and the box's height [pt]."""


def _per_point(axes: Any) -> float:
    """Length per point of paper, both ways alike."""
    low, high = axes.viewLim.min, axes.viewLim.max
    paper = 72.0 * axes.get_figure().get_size_inches() * axes.get_position(original=True).size
    return float(np.max((high - low) / paper))


def _spread(places: Array, sizes: Array) -> Array:
    """Places (n, 2) pushed apart, a little a round, until boxes of those sizes (n, 2) no longer overlap."""
    places, size = np.array(places), 0.5 * (sizes[:, None] + sizes[None, :])
    for _ in range(60):
        gap = places[:, None] - places[None, :]
        overlap = np.clip(1.0 - np.abs(gap) / size, 0.0, None).prod(axis=-1)
        np.fill_diagonal(overlap, 0.0)
        if not np.any(overlap > 1e-9):
            break
        first = np.triu(np.ones_like(overlap))
        sense = np.where(gap[..., 1] == 0.0, first - first.T, np.sign(gap[..., 1]))
        places[:, 1] += 0.25 * sizes[:, 1] * np.sum(sense * (overlap > 1e-9), axis=1)
    return places


def triad(axes: Any, seen: View) -> None:
    """The stage's axes as a small sign in the lower left corner.

    >>> from flexstage.show.figures.style import canvas
    >>> axes = canvas(1.0, 1.0).add_subplot()
    >>> triad(axes, view(Side.TOP))
    >>> [text.get_text() for text in axes.texts if text.get_text()]
    ['x', 'y']
    """
    (left, right), bottom = axes.get_xlim(), axes.get_ylim()[0]
    length = 0.05 * (right - left)
    start = np.array([left, bottom]) + 0.5 * length + np.clip(-1.2 * length * seen.axes[:2], 0.0, None).max(axis=1)
    for name, direction in zip("xyz", seen.axes[:2].T, strict=True):
        if direction @ direction < 0.02:
            continue
        tip = start + length * direction
        axes.annotate("", xy=tuple(tip), xytext=tuple(start), arrowprops=_ARROW)
        axes.text(*(start + 1.3 * length * direction), name, ha="center", va="center", fontsize=6.5, color=MUTED, style="italic")


def legend(scene: Scene) -> tuple[tuple[str, str], ...]:
    """Colours and names of the kinds a scene shows.

    >>> from flexstage.mechanism.mechanism import Mechanism
    >>> from flexstage.show.scene.stage import scene
    >>> legend(scene(Mechanism("")))
    ()
    """
    shown = {facet.paint.kind for facet in scene.facets}
    return tuple((_COLOURS[kind][0], name) for kind, name in NAMES.items() if kind in shown)
