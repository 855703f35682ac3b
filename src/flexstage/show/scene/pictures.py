"""Pictures of a stage: from three sides and above the corner, at rest or moved."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.show.figures.scenery import Paper
from flexstage.show.figures.style import ABOUT, ALONG, FULL
from flexstage.show.scene.facet import Facet, Kind
from flexstage.show.scene.stage import Scene, displace, largest_motion
from flexstage.show.scene.view import Side, View, draw, order_facets, outline, triad, view, write

_TALLEST = 1.1
_MOVED = (Kind.PLATFORM, Kind.BODY, Kind.DRIVE)
_REACH = 0.11
"""The largest motion in the picture of a mode, of the stage's diagonal."""
_ARM, _ARROW, _SMALL, _ALONE = 0.25, 0.24, 0.4, 0.9
_IN_PLANE, _OUT_OF_PLANE = [0, 1, 5], [2, 3, 4]
_SHAFT = {"arrowstyle": "-|>", "lw": 1.8, "mutation_scale": 9, "shrinkA": 0.0, "shrinkB": 0.0}


def stage_picture(scene: Scene, *, side: Side = Side.ISOMETRIC, width: float = FULL, names: bool = True) -> Paper:
    """The stage from one side, with the names of actuators and gauges.

    >>> from flexstage.mechanism.mechanism import Mechanism
    >>> from flexstage.show.scene.stage import scene
    >>> stage_picture(scene(Mechanism("")), side=Side.TOP).svg("top", "nothing")[:24]
    '<svg viewBox="0 0 518.4 '
    """
    seen = view(side)
    facets = order_facets(scene, seen)
    paper = _paper(facets, seen, width)
    draw(paper, facets, seen)
    write(paper, scene.labels if names else (), seen, paper.per_point)
    triad(paper, seen)
    return paper


def mode_picture(scene: Scene, twists: Mapping[str, Array], *, width: float = FULL) -> Paper | None:
    """The stage moved by its bodies' twists, as far as to be seen, over the platform's outline at rest; hinges and gauges left out.

    Seen from above where the platform stays in its plane, else from above a corner. Arrows are the platform's motion: blue along, red
    about; `None` where nothing moves.

    >>> from flexstage.mechanism.mechanism import Mechanism
    >>> from flexstage.show.scene.stage import scene
    >>> mode_picture(scene(Mechanism("")), {}) is None
    True
    """
    largest = largest_motion(scene, twists)
    if largest == 0.0:
        return None
    twist = np.real(twists.get(PLATFORM, np.zeros(6)))
    sizes = np.abs(twist) * np.array([1.0] * 3 + [_ARM * scene.size] * 3)
    seen = view(Side.TOP if sizes[_IN_PLANE].max() > sizes[_OUT_OF_PLANE].max() else Side.ISOMETRIC)
    still = [facet for facet in order_facets(scene, seen) if facet.paint.kind in _MOVED]
    moved = displace(still, scene, twists, _REACH * scene.size / largest)
    paper = _paper([*still, *moved], seen, width)
    draw(paper, moved, seen)
    outline(paper, [facet for facet in still if facet.paint.kind is Kind.PLATFORM], seen)
    triad(paper, seen)
    if np.any(sizes):
        _arrows(paper, scene, twist, sizes, seen)
    return paper


def _arrows(axes: Paper, scene: Scene, twist: Array, sizes: Array, seen: View) -> None:
    """The platform's translation and rotation, each where it is not small beside the other, named where it is along one axis."""
    start, largest = scene.references[PLATFORM], sizes.max()
    for part, names, colour in ((slice(0, 3), "xyz", ALONG), (slice(3, 6), ("rx", "ry", "rz"), ABOUT)):
        size = float(np.sqrt(np.sum(sizes[part] ** 2)))
        if size < _SMALL * largest:
            continue
        direction = twist[part] / np.sqrt(np.sum(twist[part] ** 2))
        name = names[int(np.argmax(np.abs(direction)))] if np.max(np.abs(direction)) > _ALONE else ""
        if colour == ABOUT and abs(direction @ seen.axes[2]) > _ALONE:
            _turn(axes, seen.project(start), 0.5e3 * _ARROW * scene.size, float(direction @ seen.axes[2]), name)
            continue
        tip = seen.project(start + _ARROW * scene.size * direction * size / max(size, largest))
        axes.annotate("", xy=tuple(tip), xytext=tuple(seen.project(start)), arrowprops={**_SHAFT, "color": colour})
        _write(axes, seen.project(start) + 1.2 * (tip - seen.project(start)), name, colour)


def _turn(axes: Paper, middle: Array, radius: float, sense: float, name: str) -> None:
    """A turn about the direction of sight: an arc with a head."""
    angles = np.sign(sense) * np.linspace(-0.75 * np.pi, 0.5 * np.pi, 40)
    arc = middle + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    axes.plot(*arc.T, color=ABOUT, linewidth=1.8)
    axes.annotate("", xy=tuple(arc[-1] + 0.35 * (arc[-1] - arc[-4])), xytext=tuple(arc[-2]), arrowprops={**_SHAFT, "color": ABOUT})
    _write(axes, middle + np.array([0.0, 1.45 * radius]), name, ABOUT)


def _write(axes: Paper, place: Array, name: str, colour: str) -> None:
    axes.text(float(place[0]), float(place[1]), name, fontsize=8, fontweight="bold", color=colour)


def _paper(facets: list[Facet], seen: View, width: float) -> Paper:
    """Paper that the facets fill, as high as they need."""
    flat = seen.project(np.concatenate([facet.points for facet in facets] or [np.zeros((1, 3))]))
    low, high = flat.min(axis=0), flat.max(axis=0)
    gap = 0.05 * float(max(high - low)) or 1.0
    extent = high - low + 2.0 * gap
    return Paper(low - gap, high + gap, width, width * min(_TALLEST, float(extent[1] / extent[0])))
