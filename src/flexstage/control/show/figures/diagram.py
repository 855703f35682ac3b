"""Block diagram of a loop, from the commanded to the true pose; blocks of the computer are shaded."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flexstage.show.display import to_typography
from flexstage.show.figures.style import FULL, GAUGE, INK, MUTED, PAPER, SERIES, canvas, style_context

_HEIGHT = 2.5
_UPPER, _LOWER = 1.6, 0.62
_HIGH = 0.56
_LEFT, _RIGHT = 0.62, 6.62
_SUM = 0.085
_SHADE = 0.08
_SPELLED = {"R_a": "R\u2090", "R_s^-1": "R\u209b⁻¹"}


@dataclass(frozen=True)
class Block:
    """Block of a diagram: its name, its text (lines of a few words), and whether it runs on the computer."""

    name: str
    detail: str = ""
    digital: bool = False


@dataclass(frozen=True)
class Diagram:
    """Content of a block diagram: blocks `forward` from the error to the pose, and `back` from the pose to its estimate, in signal order.

    `onto` are external signals, each with the name of the block that it enters. If `fed_forward`, the reference also bypasses the
    controller. If not `closed`, the diagram ends at the pose.
    """

    forward: tuple[Block, ...]
    back: tuple[Block, ...]
    onto: tuple[tuple[str, str], ...] = ()
    fed_forward: bool = False
    closed: bool = True


def loop_diagram(diagram: Diagram) -> Any:
    """Plot the block diagram as a matplotlib Figure, with the forward path above the feedback path, and the blocks of the computer shaded.

    >>> blocks = (Block("controller", "PI", True), Block("stage"))
    >>> len(loop_diagram(Diagram(blocks, (Block("gauges"), Block("R_s^-1", digital=True)))).axes)
    1
    """
    with style_context():
        figure = canvas(FULL, _HEIGHT)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_xlim(0.0, FULL)
        axes.set_ylim(0.0, _HEIGHT)
        axes.set_axis_off()
        pitch = (_RIGHT - _LEFT - 0.1) / len(diagram.forward)
        edge = _LEFT + 0.1 + sum(block.digital for block in diagram.forward) * pitch
        width = min(0.8 * pitch, 0.95)
        upper, lower = _places(diagram.forward, edge), _places(diagram.back[::-1], edge)
        _computer(axes, edge)
        _forward(axes, diagram, upper, width)
        if diagram.closed:
            _back(axes, diagram, lower, width)
        _disturbances(axes, diagram, {**_by_name(diagram.forward, upper, _UPPER), **_by_name(diagram.back[::-1], lower, _LOWER)})
    return figure


def _places(blocks: Sequence[Block], edge: float) -> list[float]:
    """Centres of blocks: the computer's spaced evenly left of the edge, the others right of it."""
    inside = sum(block.digital for block in blocks)
    ranges = ((_LEFT + 0.1, edge, inside), (edge, _RIGHT, len(blocks) - inside))
    return [start + (index + 0.5) * (end - start) / count for start, end, count in ranges for index in range(count)]


def _by_name(blocks: Sequence[Block], places: Sequence[float], level: float) -> dict[str, tuple[float, float]]:
    return {block.name: (place, level) for block, place in zip(blocks, places, strict=True)}


def _computer(axes: Any, edge: float) -> None:
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle((0.4, 0.18), edge - 0.4, _HEIGHT - 0.22, facecolor=SERIES[0], alpha=_SHADE, edgecolor="none", zorder=0))
    axes.text(0.46, _HEIGHT - 0.08, "computer", fontsize=6.5, color=MUTED, va="top")


def _forward(axes: Any, diagram: Diagram, places: Sequence[float], width: float) -> None:
    from matplotlib.patches import Circle

    _arrow(axes, (0.1, _UPPER), (_LEFT - _SUM, _UPPER))
    axes.text(0.08, _UPPER + 0.07, "x*", fontsize=8.0, fontweight="bold")
    axes.add_patch(Circle((_LEFT, _UPPER), _SUM, facecolor=PAPER, edgecolor=INK, linewidth=0.9, zorder=3))
    axes.text(_LEFT - 0.16, _UPPER + 0.07, "+", fontsize=7.0, ha="center")
    start = _chain(axes, diagram.forward, places, (_LEFT + _SUM, _UPPER), 0.5 * width)
    _arrow(axes, (start, _UPPER), (7.12, _UPPER))
    axes.text(7.12, _UPPER + 0.07, "x", fontsize=8.0, fontweight="bold", ha="right")
    if diagram.fed_forward:
        _feed_forward(axes, places, width)


def _chain(axes: Any, blocks: Sequence[Block], places: Sequence[float], start: tuple[float, float], half: float) -> float:
    """Draw blocks of a half width in series, to the left if it is negative; returns the end position."""
    x, level = start
    for block, place in zip(blocks, places, strict=True):
        _arrow(axes, (x, level), (place - half, level))
        _block(axes, block, (place, level), 2.0 * abs(half))
        x = place + half
    return x


def _feed_forward(axes: Any, places: Sequence[float], width: float) -> None:
    """Draw the feedforward path over the first block, to a sum behind it."""
    behind = 0.5 * (places[0] + places[1]) if len(places) > 1 else places[0] + 0.6 * width
    over = _UPPER + 0.44
    axes.plot([0.28, 0.28, behind], [_UPPER, over, over], color=INK, linewidth=0.8)
    _arrow(axes, (behind, over), (behind, _UPPER + 0.045))
    axes.plot([0.28], [_UPPER], ".", color=INK, markersize=3.0)
    axes.plot([behind], [_UPPER], "o", color=PAPER, markeredgecolor=INK, markersize=4.5, markeredgewidth=0.8, zorder=4)
    axes.text(0.5 * (0.28 + behind), over + 0.03, "feedforward", fontsize=6.0, color=MUTED, ha="center")


def _back(axes: Any, diagram: Diagram, places: Sequence[float], width: float) -> None:
    turn = 0.5 * (_RIGHT + 7.12)
    axes.plot([turn], [_UPPER], ".", color=INK, markersize=3.0)
    axes.plot([turn, turn], [_UPPER, _LOWER], color=INK, linewidth=0.8)
    start = _chain(axes, diagram.back, places[::-1], (turn, _LOWER), -0.5 * width)
    axes.plot([start, _LEFT], [_LOWER, _LOWER], color=INK, linewidth=0.8)
    _arrow(axes, (_LEFT, _LOWER), (_LEFT, _UPPER - _SUM))
    axes.text(_LEFT + 0.05, _UPPER - 0.22, "−", fontsize=8.0)
    axes.text(_LEFT - 0.05, 0.5 * (_UPPER + _LOWER), "estimated pose", fontsize=6.0, color=MUTED, rotation=90, ha="right", va="center")


def _disturbances(axes: Any, diagram: Diagram, places: dict[str, tuple[float, float]]) -> None:
    seen: Counter[str] = Counter()
    for text, name in diagram.onto:
        if name not in places:
            continue
        x, level = places[name]
        sign, side = (1.0, "bottom") if level == _UPPER else (-1.0, "top")
        near, far = level + sign * 0.5 * _HIGH, level + sign * (0.5 * _HIGH + 0.2)
        x += 0.22 * seen[name]
        seen[name] += 1
        _arrow(axes, (x, far), (x, near), colour=GAUGE)
        axes.text(x, far + sign * 0.03, to_typography(text), fontsize=6.0, color=GAUGE, ha="center", va=side)


def _block(axes: Any, block: Block, place: tuple[float, float], width: float) -> None:
    from matplotlib.patches import FancyBboxPatch

    x, y = place
    shape = FancyBboxPatch(
        (x - 0.5 * width + 0.03, y - 0.5 * _HIGH + 0.03),
        width - 0.06,
        _HIGH - 0.06,
        boxstyle="round,pad=0.03,rounding_size=0.05",
        facecolor=PAPER,
        edgecolor=SERIES[0] if block.digital else INK,
        linewidth=0.9,
        zorder=3,
    )
    axes.add_patch(shape)
    lines = [each for each in block.detail.split("\n") if each]
    title = _SPELLED.get(block.name, to_typography(block.name)), {"fontsize": 6.8, "fontweight": "bold"}
    for number, (text, font) in enumerate([title, *((to_typography(line), {"fontsize": 5.6, "color": MUTED}) for line in lines)]):
        axes.text(x, y + 0.055 * len(lines) - 0.11 * number, text, ha="center", va="center", zorder=4, **font)


def _arrow(axes: Any, start: tuple[float, float], end: tuple[float, float], colour: str = INK) -> None:
    style = {"arrowstyle": "-|>,head_length=0.28,head_width=0.13", "color": colour, "linewidth": 0.8, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", end, start, arrowprops=style, zorder=2)
