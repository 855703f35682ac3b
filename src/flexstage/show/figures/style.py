"""The common style of all figures: colours for colour-blind readers, light axes, fonts of the page."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

INK = "#1f2a37"
MUTED = "#667382"
GRID = "#dde3ea"
PAPER = "#fefefe"
DRIVE = "#8a5200"
GAUGE = "#9c1f42"
ALONG, ABOUT = "#1d5fd1", "#b3261e"
"""Colours of translations along an axis and rotations about one."""
THEME = {INK: "ink", MUTED: "muted", GRID: "rule", PAPER: "paper", DRIVE: "drive", GAUGE: "gauge", ALONG: "along", ABOUT: "about"}
"""Colours that an HTML page replaces by its CSS variables, with the names of the variables."""
SERIES = ("#0077bb", "#ee7733", "#009988", "#cc3311", "#33bbee", "#ee3377", "#997700", "#bbbbbb")
"""Paul Tol's vibrant scheme (personal.sron.nl/~pault), with a dark yellow added."""

PASS, FAIL, WARN = "#2e8540", "#cc3311", "#b7791f"
FULL, HALF, THIRD = 7.2, 3.5, 3.0
"""Widths of figures in inches."""

_RC: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": 8.0,
    "text.color": INK,
    "text.parse_math": False,  # names of users may contain dollar signs
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.facecolor": "none",
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlecolor": INK,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "figure.facecolor": "none",
    "savefig.facecolor": "none",
    "svg.fonttype": "none",
    "path.simplify": True,
    "path.simplify_threshold": 0.4,  # of a point: curves of thousands of points
    "axes.unicode_minus": True,
    "image.composite_image": False,
    "axes.formatter.use_mathtext": False,
}


@contextmanager
def style_context(salt: str = "flexstage") -> Generator[None]:
    """Apply the style while a figure is drawn and written; matplotlib's settings are restored afterwards.

    Identifiers in SVG files depend on `salt`.

    >>> with style_context():
    ...     from matplotlib import rcParams
    ...     rcParams["svg.fonttype"]
    'none'
    """
    import matplotlib as mpl

    with mpl.rc_context({**_RC, "svg.hashsalt": salt}):
        yield


def canvas(width: float, height: float) -> Any:
    """Create an empty `matplotlib.figure.Figure` with a width and a height in inches.

    >>> canvas(2.0, 1.0).get_size_inches().tolist()
    [2.0, 1.0]
    """
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height))


@dataclass(frozen=True)
class Margins:
    """Margins around and between the panels of a figure, in inches. Margins are fixed: an automatic layout would draw figures twice."""

    left: float = 0.5
    right: float = 0.1
    bottom: float = 0.42
    top: float = 0.1
    across: float = 0.55
    down: float = 0.2


def panels(figure: Any, rows: int, columns: int, margins: Margins, *, heights: Sequence[float] | None = None) -> Any:
    """Create axes (rows, columns) of a figure within margins. Axes of a column share the x axis; `heights` are relative row heights.

    >>> panels(canvas(3.0, 3.0), 2, 1, Margins()).shape
    (2, 1)
    """
    width, height = figure.get_size_inches()
    margins = _limit_margins(margins, (width, height), (rows, columns))
    inner_width = (width - margins.left - margins.right - (columns - 1) * margins.across) / columns
    inner_height = (height - margins.bottom - margins.top - (rows - 1) * margins.down) / rows
    figure.subplots_adjust(
        left=margins.left / width,
        right=1.0 - margins.right / width,
        bottom=margins.bottom / height,
        top=1.0 - margins.top / height,
        wspace=margins.across / inner_width,
        hspace=margins.down / inner_height,
    )
    return figure.subplots(rows, columns, squeeze=False, height_ratios=heights, sharex="col" if rows > 1 else False)


def _limit_margins(margins: Margins, size: tuple[float, float], count: tuple[int, int]) -> Margins:
    """Margins that leave the panels at least a fifth of the figure: longer names are cut off."""
    wide = margins.left + margins.right + (count[1] - 1) * margins.across
    high = margins.bottom + margins.top + (count[0] - 1) * margins.down
    x, y = min(1.0, 0.8 * size[0] / wide), min(1.0, 0.8 * size[1] / high)
    return Margins(x * margins.left, x * margins.right, y * margins.bottom, y * margins.top, x * margins.across, y * margins.down)


def text_width(texts: Iterable[str], size: float = 8.0) -> float:
    """Estimate the width of the longest text in inches, at a font `size` in points.

    >>> round(text_width(["B1", "pivot.rz"]), 2)
    0.53
    """
    return max((len(text) for text in texts), default=0) * 0.6 * size / 72.0
