"""Views: parallel projection of a stage, its image on matplotlib axes, and labels."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.show.figures.style import DRIVE, GAUGE, INK, MUTED, PAPER, canvas
from flexstage.show.scene.raster import nearest, normals, visible_lines
from flexstage.show.scene.skin import Kind
from flexstage.show.scene.stage import Label
from flexstage.show.viewer.data import StageData

_STYLES = {
    Kind.PLATFORM: ("platform", "#6ea8d8", 0.42),
    Kind.BODY: ("bodies", "#b9c2cc", 1.0),
    Kind.HINGE: ("hinges", "#0f8a7e", 1.0),
    Kind.DRIVE: ("actuators", "#f2a33c", 1.0),
    Kind.GAUGE: ("gauges", "#c2395a", 1.0),
    Kind.GROUND: ("ground", "#56606b", 1.0),
}
"""Name, colour and opacity of each kind of parts."""
_LABEL_COLOURS = {Kind.DRIVE: DRIVE, Kind.GAUGE: GAUGE}
_EDGE = "#323e4b"
_LIGHT = np.array([-0.35, 0.55, 0.76])
"""Towards a light above the viewer's left shoulder: right, up, towards the viewer."""
_DOTS = 160.0
"""Pixels per inch of an image: twice as many as on a screen."""


class Side(Enum):
    """Side from which the stage is seen. The value contains the direction towards the viewer, and the upward direction of the picture."""

    TOP = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
    FRONT = ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
    RIGHT = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    ISOMETRIC = ((0.62, -0.88, 0.72), (0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class View:
    """A view direction. The rows of `axes` (3, 3) are unit vectors to the right, up and towards the viewer, in the stage's frame."""

    axes: Array

    def project(self, points: Array) -> Array:
        """Project points (..., 3) [m] to the picture (..., 2) [mm]."""
        return 1e3 * points @ self.axes[:2].T


def view(side: Side) -> View:
    """Return the view from a side.

    >>> view(Side.FRONT).project(np.array([0.001, 0.0, 0.002])).round(9).tolist()
    [1.0, 2.0]
    """
    eye, up = (np.array(direction) for direction in side.value)
    eye = eye / np.linalg.norm(eye)
    right = np.cross(up, eye)
    right = right / np.linalg.norm(right)
    return View(np.stack([right, np.cross(eye, right), eye]))


def picture_axes(points: Array, seen: View, width: float, *, gap: float = 0.05, tallest: float = 1.1, below: float = 0.0) -> Any:
    """Create a figure with a `width` [inch] and frameless axes [mm] that contain all points (n, 3) [m] in this view.

    `gap` is the margin divided by the larger of the width and height of the box around the points. `tallest` is the largest ratio of the
    axes' height to their width. `below` is free space under the axes [inch].

    >>> picture_axes(np.zeros((1, 3)), view(Side.TOP), 2.0).viewLim.intervalx.tolist()
    [-1.0, 1.0]
    """
    flat = seen.project(points) if len(points) else np.zeros((1, 2))
    low, high = flat.min(axis=0), flat.max(axis=0)
    room = gap * float(max(high - low)) or 1.0
    across, up = high - low + 2.0 * room
    height = below + width * min(tallest, up / across)
    return fit(canvas(width, height).add_axes((0.0, below / height, 1.0, 1.0 - below / height)), low - room, high + room)


def fit(axes: Any, low: Array, high: Array) -> Any:
    """Set axes to equal scales around a box from `low` to `high` (2,) [mm], without a frame. Returns the axes.

    >>> fit(canvas(2.0, 1.0).add_axes((0.0, 0.0, 1.0, 1.0)), np.array([0.0, 0.0]), np.array([1.0, 1.0])).viewLim.intervalx.tolist()
    [-0.5, 1.5]
    """
    half = 0.5 * _paper(axes) * np.max((high - low) / _paper(axes))
    (left, bottom), (right, top) = 0.5 * (low + high) - half, 0.5 * (low + high) + half
    axes.set(xlim=(left, right), ylim=(bottom, top))
    axes.set_axis_off()
    return axes


def _paper(axes: Any) -> Array:
    """Size of axes on paper [pt]."""
    return 72.0 * axes.get_figure().get_size_inches() * axes.get_position(original=True).size


def _per_point(axes: Any) -> float:
    """Length per point of paper, equal in both directions."""
    return float(np.max(axes.viewLim.size / _paper(axes)))


def pixels(axes: Any, points: Array, seen: View) -> tuple[Array, tuple[int, int]]:
    """Convert points (n, 3) [m] to pixel coordinates in an image of the axes: to the right, down and towards the viewer.

    Returns the points, and the numbers of rows and columns of the image.

    >>> axes = fit(canvas(1.0, 1.0).add_axes((0.0, 0.0, 1.0, 1.0)), np.array([0.0, 0.0]), np.array([1.0, 1.0]))
    >>> pixels(axes, np.array([[1e-3, 0.0, 0.0]]), view(Side.TOP))
    (array([[160., 160.,   0.]]), (160, 160))
    """
    corner, scale = np.array([axes.viewLim.x0, axes.viewLim.y1, 0.0]), _DOTS / 72.0
    width, height = np.ceil(scale * _paper(axes)).astype(int).tolist()
    return (1e3 * points @ seen.axes.T - corner) * np.array([1.0, -1.0, 1.0]) * scale / _per_point(axes), (height, width)


def show_image(axes: Any, image: Array) -> None:
    """Show an image (h, w, 4) of red, green, blue and opacity, 0 to 255, on the whole area of axes. `pixels` gives h and w."""
    extent = (*axes.get_xlim(), *axes.get_ylim())
    axes.imshow(image, extent=extent, interpolation="none", aspect="auto")


def draw(axes: Any, data: StageData, seen: View, points: Array | None = None, kinds: Container[Kind] = tuple(Kind)) -> None:
    """Draw the parts of the `kinds` as an image on axes prepared by `fit`. `points` (n, 3) [m] are positions of displaced vertices.

    The platform is translucent, so that parts under it are visible.
    """
    from matplotlib.colors import to_rgba

    mesh = data.mesh
    places, shape = pixels(axes, mesh.points if points is None else points, seen)
    paints = np.array([to_rgba(*_STYLES[thing.kind][1:]) if thing.kind in kinds else (0.0,) * 4 for thing in data.things]).reshape(-1, 4)
    image, depth = np.zeros((*shape, 4), dtype=np.uint8), np.full(shape, -np.inf, dtype=np.float32)
    for layer in (paints[:, 3] == 1.0, (paints[:, 3] > 0.0) & (paints[:, 3] < 1.0)):
        faces, edges = (ends[layer[mesh.part[ends[:, 0]]]] for ends in (mesh.triangles, mesh.edges))
        normal = normals(places[faces])
        faces, normal = faces[normal[:, 2] > 1e-6], normal[normal[:, 2] > 1e-6]
        found, own = nearest(places[faces], shape)
        nearer = own > depth
        depth = np.maximum(depth, own)
        parts = np.append(mesh.part[faces[:, 0]], -1)
        colours = paints[parts[:-1]] * np.column_stack([_tones(normal)] * 3 + [np.ones(len(faces))])
        image[nearer] = _over((255.0 * colours).astype(np.float32)[found[nearer]], image[nearer])
        part = np.where(nearer, parts[found], -1)
        image[_lines(part, visible_lines(places[edges], depth))] = np.multiply(255, to_rgba(_EDGE))
    show_image(axes, image)


def _over(colours: Array, ground: Array) -> Array:
    """Colours (n, 4) up to 255 over an opaque or empty ground."""
    share = np.where(ground[:, 3:] > 0, colours[:, 3:] / 255.0, 1.0)
    return np.column_stack([share * colours[:, :3] + (1.0 - share) * ground[:, :3], np.maximum(colours[:, 3], ground[:, 3])])


def _lines(part: Array, edges: Array) -> Array:
    """The pixels (h, w) of edges, and those at the boundary of two parts."""
    drawn = edges.copy()
    drawn[:, :-1] |= part[:, :-1] != part[:, 1:]
    drawn[:-1] |= part[:-1] != part[1:]
    return drawn


def _tones(normal: Array) -> Array:
    """Brightness of faces by their normals (t, 3): lower for larger angles to the light."""
    return 0.62 + 0.38 * np.maximum(0.0, normal @ _LIGHT)


def edges_of(data: StageData, seen: View, kind: Kind) -> Array:
    """Project the e sharp edges of the solids of a kind to one line (3 e, 2) [mm], with NaN after each edge.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.show.viewer.data import still_data
    >>> edges_of(still_data(case("parallelogram")), view(Side.TOP), Kind.PLATFORM).shape
    (36, 2)
    """
    mesh = data.mesh
    edges = mesh.edges[np.isin(mesh.part[mesh.edges[:, 0]], solid_parts(data, kind))]
    return np.pad(seen.project(mesh.points[edges]), ((0, 0), (0, 1), (0, 0)), constant_values=np.nan).reshape(-1, 2)


def solid_parts(data: StageData, kind: Kind) -> list[int]:
    """Return the numbers of the parts of a kind that are drawn with triangles.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.show.viewer.data import still_data
    >>> len(solid_parts(still_data(case("parallelogram")), Kind.PLATFORM))
    1
    """
    return [part for part in np.unique(data.mesh.part[data.mesh.triangles[:, 0]]).tolist() if data.things[part].kind is kind]


def write(axes: Any, labels: tuple[Label, ...], seen: View) -> None:
    """Write names next to their points, moved apart to avoid overlaps.

    >>> axes = canvas(1.0, 1.0).add_subplot()
    >>> write(axes, (Label("B1", (0.0, 0.0, 0.0), Kind.DRIVE),), view(Side.TOP))
    >>> axes.texts[0].get_text()
    'B1'
    """
    sizes = np.array([(_LETTER * len(label.text) + _ROUND, _LINE) for label in labels]).reshape(-1, 2)
    places = _spread(seen.project(np.array([label.point for label in labels]).reshape(-1, 3)), _per_point(axes) * sizes)
    for label, place in zip(labels, places, strict=True):
        name(axes, place, label.text, _LABEL_COLOURS.get(label.kind, INK))


def name(axes: Any, place: Array, text: str, colour: str) -> None:
    """Write a name at a position (2,) [mm], on a light background."""
    box = {"boxstyle": "round,pad=0.18", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.8}
    axes.text(*place, text, ha="center", va="center", fontsize=7, color=colour, fontweight="bold", bbox=box if text else None)


_LETTER, _ROUND, _LINE = 5.0, 4.0, 11.5
"""Width of a letter of a name, additional width and height of its box [pt]."""


def _spread(places: Array, sizes: Array) -> Array:
    """Positions (n, 2) moved apart in small steps until boxes of those sizes (n, 2) no longer overlap."""
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
    """Draw the stage's coordinate axes as a small symbol in the lower left corner.

    >>> axes = canvas(1.0, 1.0).add_subplot()
    >>> triad(axes, view(Side.TOP))
    >>> [text.get_text() for text in axes.texts]
    ['x', 'y']
    """
    length = 0.05 * axes.viewLim.width
    start = axes.viewLim.min + 0.5 * length + np.clip(-1.2 * length * seen.axes[:2], 0.0, None).max(axis=1)
    shown = {axis: length * direction for axis, direction in zip("xyz", seen.axes[:2].T, strict=True) if direction @ direction > 0.02}
    arrows(axes, [start] * len(shown), list(shown.values()), MUTED, 0.8)
    for axis, reach in shown.items():
        axes.text(*(start + 1.3 * reach), axis, ha="center", va="center", fontsize=6.5, color=MUTED, style="italic")


def arrows(axes: Any, starts: Sequence[Array], reaches: Sequence[Array], colour: str, width: float) -> None:
    """Draw arrows from the points `starts` along the vectors `reaches` [mm], with shafts of this `width` in points."""
    (x, y), (across, up) = np.transpose(starts), np.transpose(reaches)
    axes.quiver(
        x,
        y,
        across,
        up,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        units="inches",
        width=width / 72.0,
        color=colour,
        headwidth=4.5,
        zorder=3,
    )


def legend(data: StageData) -> tuple[tuple[str, str], ...]:
    """Return pairs of a colour and a name for the kinds of parts in a stage.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.show.viewer.data import still_data
    >>> [name for _, name in legend(still_data(case("parallelogram")))]
    ['platform', 'bodies', 'hinges', 'actuators', 'gauges', 'ground']
    """
    shown = {thing.kind for thing in data.things}
    return tuple((colour, words) for kind, (words, colour, _) in _STYLES.items() if kind in shown)
