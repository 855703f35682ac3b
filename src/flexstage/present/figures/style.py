"""The one style of all figures: colours that the colour-blind can tell apart, quiet axes, fonts of the page they stand in."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from typing import Any

INK = "#1f2a37"
MUTED = "#667382"
GRID = "#dde3ea"
PAPER = "#fefefe"
DRIVE = "#8a5200"
GAUGE = "#9c1f42"
SERIES = ("#0077bb", "#ee7733", "#009988", "#cc3311", "#33bbee", "#ee3377", "#997700", "#bbbbbb")
"""Paul Tol's vibrant scheme (personal.sron.nl/~pault), one dark yellow added."""

PASS, FAIL, WARN = "#2e8540", "#cc3311", "#b7791f"
FULL, HALF, THIRD = 7.2, 3.5, 3.0
"""Widths of figures in inches."""

_RC: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": 8.0,
    "text.color": INK,
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
    "svg.hashsalt": "flexstage",
    "path.simplify": True,
    "axes.unicode_minus": True,
    "axes.formatter.use_mathtext": False,
}


@contextmanager
def styled() -> Generator[None]:
    """The style, while a figure is drawn and written; matplotlib's settings are as before afterwards.

    >>> with styled():
    ...     from matplotlib import rcParams
    ...     rcParams["svg.fonttype"]
    'none'
    """
    import matplotlib as mpl

    with mpl.rc_context(_RC):
        yield


def canvas(width: float, height: float, *, fitted: bool = True) -> Any:
    """An empty `matplotlib.figure.Figure` of that size in inches; `fitted`: its axes are laid out without overlaps.

    >>> canvas(2.0, 1.0).get_size_inches().tolist()
    [2.0, 1.0]
    """
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained" if fitted else None)
