"""Data for the cursor over a figure in an HTML page: the panels and curves of the figure."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from flexstage.show.display import to_typography
from flexstage.show.viewer.data import packed

_POINTS = 72.0
_DIGITS = 5


@dataclass(frozen=True)
class Spot:
    """A named point of a figure: its `text` appears if the cursor is close to (`x`, `y`) in panel number `panel`.

    If `y` is `None`, only the distance of the cursor from `x` matters. A button beside the text plays the motion `plays` in the page's
    viewer.
    """

    x: float
    text: str
    y: float | None = None
    panel: int = 0
    plays: str = ""


def reading(figure: Any, spots: Iterable[Spot] = ()) -> str:
    """Describe the panels of a drawn figure as JSON: positions in points, axes, and labelled curves.

    A curve without a label gets the label of a curve with equal style in the same column; curves that get no label are left out. A panel
    without a name gets the name of a panel in the same row. Equal arrays of abscissae are listed once, in `over`; the `x` of a curve is the
    index of its array in `over`.

    >>> from flexstage.show.figures.style import canvas
    >>> figure = canvas(1.0, 1.0)
    >>> _ = figure.add_subplot().plot([1.0, 2.0, 3.0], [3.0, 4.0, 1.0], label="x")
    >>> [each["name"] for each in json.loads(reading(figure))["panels"][0]["curves"]]
    ['x']
    """
    shown = [axes for axes in figure.axes if axes.get_visible()]
    names = {_look(axes, line): line.get_label() for axes in shown for line in axes.lines if _is_named(line)}
    along = next((axes.get_xlabel() for axes in reversed(shown) if axes.get_xlabel()), "")
    size = figure.get_size_inches() * _POINTS
    rows = {_row(axes): _title(axes) for axes in reversed(shown) if _title(axes)}
    over: dict[str, int] = {}
    panels = [
        _panel(axes, size) | {"name": _title(axes) or rows.get(_row(axes), ""), "curves": list(_curves(axes, names, over))}
        for axes in shown
    ]
    points = [{key: value for key, value in asdict(each).items() if value not in ("", None)} for each in spots]
    return json.dumps({"along": along, "over": list(over), "panels": panels, "spots": points}, separators=(",", ":"), ensure_ascii=False)


def _is_named(line: Any) -> bool:
    return not line.get_label().startswith("_")


def _look(axes: Any, line: Any) -> tuple[float, str, str]:
    """Style that distinguishes the curves of a column."""
    return round(float(axes.get_position().x0), 6), str(line.get_color()), str(line.get_linestyle())


def _row(axes: Any) -> float:
    return round(float(axes.get_position().y0), 6)


def _title(axes: Any) -> str:
    return axes.get_ylabel() or axes.get_title(loc="left") or axes.get_title()


def _panel(axes: Any, size: Any) -> dict[str, Any]:
    (left, low), (right, high) = axes.get_position().get_points()
    box = [left * size[0], (1.0 - high) * size[1], (right - left) * size[0], (high - low) * size[1]]
    return {
        "box": [round(float(each), 2) for each in box],
        "x": [_plain(each) for each in axes.get_xlim()],
        "y": [_plain(each) for each in axes.get_ylim()],
        "log": [axes.get_xscale() == "log", axes.get_yscale() == "log"],
    }


def _curves(axes: Any, names: dict[tuple[float, str, str], str], over: dict[str, int]) -> Iterator[dict[str, str | int]]:
    for line in axes.lines:
        name = line.get_label() if _is_named(line) else names.get(_look(axes, line), "")
        x, y = (np.asarray(each, dtype=float) for each in line.get_data())
        if name and len(x) > 2:
            number = over.setdefault(packed(x, "<f4"), len(over))
            yield {"name": to_typography(name), "colour": str(line.get_color()), "x": number, "y": packed(y, "<f4")}


def _plain(value: float) -> float:
    return float(f"{float(value):.{_DIGITS}g}")
