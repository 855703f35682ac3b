"""What a figure of matplotlib draws as elements of SVG: steps in tenths of a point, colours of the page, texts that stay texts."""

from __future__ import annotations

import base64
import io
from functools import lru_cache
from html import escape
from typing import Any

import numpy as np
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_hex
from matplotlib.font_manager import weight_dict
from matplotlib.path import Path
from matplotlib.textpath import text_to_path
from matplotlib.transforms import Affine2D

from flexstage.base.number import Array
from flexstage.show.figures.style import decimal, short, theme_colour

_HATCH = 72
_ANCHORS = {"left": "start", "center": "middle", "right": "end"}
_STEPS = {Path.MOVETO: ("M", 1), Path.LINETO: ("l", 1), Path.CURVE3: ("q", 2), Path.CURVE4: ("c", 3), Path.CLOSEPOLY: ("z", 1)}
"""Letters of SVG for codes of matplotlib's paths, and how many points they take."""


class Pen(RendererBase):
    """Writes what is drawn into `said`, in points from the upper left corner of `width` and `height` [pt]; identifiers begin with `name`.

    Texts are taken as they are, without formulas; looks, clips and marks are said once.
    """

    def __init__(self, width: float, height: float, name: str) -> None:
        super().__init__()
        self.width, self.height, self.name = width, height, name
        self.said: list[str] = []
        self._known: dict[Any, str] = {}

    def get_canvas_width_height(self) -> tuple[float, float]:
        """Size in points."""
        return self.width, self.height

    def get_image_magnification(self) -> float:
        """Pixels of images in a point."""
        return 2.0

    def get_text_width_height_descent(self, s: str, prop: Any, ismath: Any) -> tuple[float, float, float]:
        """Width, height and depth below the line of a text [pt]."""
        size, unit = prop.get_size_in_points(), prop.copy()
        unit.set_size(1.0)
        wide, high, deep = _extent(s, unit)
        return size * wide, size * high, size * deep

    def draw_path(self, gc: Any, path: Any, transform: Any, rgbFace: Any = None) -> None:
        """A line or an area, unless nobody would see it."""
        hatched, seen = gc.get_hatch() is not None, gc.get_linewidth() > 0.0 and gc.get_rgb()[3] > 0.0
        if rgbFace is None and not (hatched or seen):
            return
        look = _look(gc, f"url(#{self._hatch(gc, rgbFace)})" if hatched else _fill(rgbFace), rgbFace)
        window = None if hatched or rgbFace is not None else (0.0, 0.0, self.width, self.height)
        steps = course(path, transform, self.height, window=window, decimals=2 if "fill-opacity" in look else 1)
        self.said.append(f'<path d="{steps}"{self._clip(gc)} style="{look}"/>')

    def draw_markers(self, gc: Any, marker_path: Any, marker_trans: Any, path: Any, trans: Any, rgbFace: Any = None) -> None:
        """Equal marks as one path, at whose points they stand."""
        places = trans.transform(path.vertices)
        places = places[np.isfinite(places).all(axis=1)]
        if len(places) < 2:  # the only point of a path has two marks: as its first, and as its last
            for x, y in places:
                self.draw_path(gc, marker_path, marker_trans + Affine2D().translate(x, y), rgbFace)
            return
        mark = f'<path style="{_look(gc, _fill(rgbFace), rgbFace)}" d="{course(marker_path, marker_trans)}"/>'
        name = self._define("marker", ' overflow="visible" markerUnits="userSpaceOnUse"', mark)
        points = " ".join(f"{short(x)} {short(self.height - y)}" for x, y in places.tolist())
        self.said.append(f'<path d="M{points}"{self._clip(gc)} style="fill:none;marker:url(#{name})"/>')

    def draw_text(self, gc: Any, x: float, y: float, s: str, prop: Any, angle: float, ismath: Any = None, mtext: Any = None) -> None:
        """A line of text; its middle or end stands where the page's font has it, unless it is turned or one of several lines."""
        look = f"font-size:{short(prop.get_size_in_points(), 2)}px"
        weight = weight_dict.get(prop.get_weight(), prop.get_weight())
        look += "" if weight == 400 else f";font-weight:{weight}"
        look += "" if prop.get_style() == "normal" else f";font-style:{prop.get_style()}"
        place = f'transform="translate({short(x)} {short(y)}){f" rotate({-angle:g})" if angle else ""}"'
        if mtext is not None and (angle == 0.0 or mtext.get_rotation_mode() == "anchor"):
            look += f";text-anchor:{_ANCHORS[mtext.get_ha()]}"
            across, up = (short(each) for each in self._anchor(mtext, angle, np.array([x, y])))
            place = f'x="{across}" y="{up}"' + (f' transform="rotate({-angle:g} {across} {up})"' if angle else "")
        alpha = gc.get_alpha() if gc.get_forced_alpha() else gc.get_rgb()[3]
        look += f";fill:{_fill(gc.get_rgb())}" + ("" if alpha == 1.0 else f";opacity:{short(alpha, 2)}")
        self.said.append(f'<text style="{look}" {place}{self._clip(gc)}>{escape(s)}</text>')

    def draw_image(self, gc: Any, x: float, y: float, im: Any, transform: Any = None) -> None:
        """A raster, its first row below."""
        from PIL import Image

        Image.fromarray(np.ascontiguousarray(im[::-1])).save(buffer := io.BytesIO(), format="png")
        high, wide = (each / self.get_image_magnification() for each in im.shape[:2])
        place = f'x="{short(x)}" y="{short(self.height - y - high)}" width="{short(wide)}" height="{short(high)}"'
        data = base64.b64encode(buffer.getvalue()).decode()
        self.said.append(f'<image {place}{self._clip(gc)} href="data:image/png;base64,{data}"/>')

    def _anchor(self, text: Any, angle: float, start: Array) -> Array:
        """Where a text is tied to, moved across its line to where the line is."""
        tied = text.get_transform().transform(text.get_unitless_position()) * [1.0, -1.0] + [0.0, self.height]
        across = np.array([np.sin(np.deg2rad(angle)), np.cos(np.deg2rad(angle))])
        return tied + (across @ (start - tied)) * across

    def _clip(self, gc: Any) -> str:
        path, transform = gc.get_clip_path()
        box = gc.get_clip_rectangle()
        if path is None and box is None:
            return ""
        if path is not None:
            name = self._define("clipPath", "", f'<path d="{course(path, transform, self.height)}"/>')
        elif box not in self._known:
            x, y, wide, high = (short(each) for each in (box.x0, self.height - box.y1, box.width, box.height))
            name = self._known[box] = self._define("clipPath", "", f'<rect x="{x}" y="{y}" width="{wide}" height="{high}"/>')
        else:
            name = self._known[box]
        return f' clip-path="url(#{name})"'

    def _hatch(self, gc: Any, face: Any) -> str:
        lines = course(gc.get_hatch_path(), Affine2D().scale(_HATCH), _HATCH)
        colour = _fill(gc.get_hatch_color())
        drawn = f'<path d="{lines}" style="fill:{colour};stroke:{colour};stroke-width:{short(gc.get_hatch_linewidth(), 2)}"/>'
        ground = f'<rect width="{_HATCH}" height="{_HATCH}" style="fill:{_fill(face)}"/>'
        return self._define("pattern", f' patternUnits="userSpaceOnUse" width="{_HATCH}" height="{_HATCH}"', ground + drawn)

    def _define(self, kind: str, attributes: str, content: str) -> str:
        """The name of something that is referred to, said before it is for the first time."""
        if content not in self._known:
            self._known[content] = f"{self.name}-{len(self._known)}"
            self.said.append(f'<{kind} id="{self._known[content]}"{attributes}>{content}</{kind}>')
        return self._known[content]


@lru_cache(maxsize=1 << 12)
def _extent(text: str, font: Any) -> tuple[float, float, float]:
    return text_to_path.get_text_width_height_descent(text, font, False)


def _fill(colour: Any) -> str:
    return "none" if colour is None else theme_colour(to_hex(colour))


def _look(gc: Any, fill: str, face: Any) -> str:
    """How a path is filled and stroked, in a style sheet."""
    whole = gc.get_forced_alpha()
    said = [f"fill:{fill}"]
    if face is not None and len(face) == 4 and face[3] != 1.0 and not whole:
        said.append(f"fill-opacity:{short(face[3], 2)};shape-rendering:crispEdges")  # or the seams between neighbours show
    if whole and gc.get_alpha() != 1.0:
        said.append(f"opacity:{short(gc.get_alpha(), 2)}")
    if gc.get_linewidth() > 0.0:
        said.append(f"stroke:{_fill(gc.get_rgb())};stroke-width:{short(gc.get_linewidth(), 2)}")
        said += [] if whole or gc.get_rgb()[3] == 1.0 else [f"stroke-opacity:{short(gc.get_rgb()[3], 2)}"]
        said += [] if gc.get_capstyle() == "butt" else ["stroke-linecap:" + gc.get_capstyle().replace("projecting", "square")]
        offset, dashes = gc.get_dashes()
        said += [] if dashes is None else ["stroke-dasharray:" + ",".join(short(each, 2) for each in dashes)]
        said += [f"stroke-dashoffset:{short(offset, 2)}"] if offset else []
    return ";".join(said)


def course(path: Any, transform: Any, height: float = 0.0, *, window: tuple[float, ...] | None = None, decimals: int = 1) -> str:
    """A path as steps; a line that goes on from the last point needs no new start. Of lines what is beyond the `window` is cut off.

    >>> course(Path([[0, 0], [1, 1], [1, 3], [0, 0]], [1, 2, 2, 79]), Affine2D())
    'M0 0l1-1 0-2z'
    """
    found = path.cleaned(transform, remove_nans=True, clip=window, simplify=window is not None and path.should_simplify, curves=True)
    points = np.rint((found.vertices * [1.0, -1.0] + [0.0, height]) * 10**decimals).astype(int).tolist()
    codes: list[Any] = found.codes.tolist()
    pieces: list[str] = []
    here, begun, last, index = [0, 0], [0, 0], "", 0
    while (code := codes[index]) != Path.STOP:
        sign, count = _STEPS[code]
        ends = points[index : index + count]
        if sign == "z":
            pieces.append(sign)
            ends = [begun]
        elif sign != "M" or last in {"", "z"} or ends[0] != here:
            start = [0, 0] if sign == "M" else here
            steps = " ".join(decimal(each[way] - start[way], decimals) for each in ends for way in (0, 1))
            pieces.append(f" {steps}" if sign == last != "M" else f"{sign}{steps}")
        else:
            sign = last
        here, last, index = ends[-1], sign, index + count
        begun = here if sign == "M" else begun
    return "".join(pieces).replace(" -", "-")
