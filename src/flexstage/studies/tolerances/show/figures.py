"""Figures of tolerance studies: distributions with their limits, yields, contributions, crosstalk."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.analysis.assessment.requirements import Requirement, Sense
from flexstage.base.number import Array
from flexstage.show.display import display_unit_of, number
from flexstage.show.figures.style import FAIL, FULL, INK, MUTED, PASS, SERIES, WARN, Margins, canvas, panels, style_context, text_width
from flexstage.spatial.frame import COMPONENTS
from flexstage.studies.tolerances.crosstalk import OPEN
from flexstage.studies.tolerances.run import Toleranced
from flexstage.studies.tolerances.summary import Crosstalk

_ACROSS = 3
_BINS = 40
_FEWEST = 12


def distributions_figure(found: Toleranced) -> Any:
    """A histogram of each response, the design as drawn and the limits on it; what misses a limit is red."""
    names = list(found.study.measures)
    rows = -(-len(names) // _ACROSS)
    with style_context():
        figure = canvas(FULL, 0.3 + 1.35 * rows)
        axes = separate_panels(figure, rows)
        for ax, name in zip(axes, names, strict=False):
            _distribution(ax, found, name)
        for ax in axes[len(names) :]:
            ax.set_visible(False)
    return figure


def separate_panels(figure: Any, rows: int) -> list[Any]:
    """Panels in rows of three, each with axes of its own.

    >>> len(separate_panels(canvas(7.0, 3.0), 2))
    6
    """
    width, height = figure.get_size_inches()
    grid = figure.subplots(rows, _ACROSS, squeeze=False)
    figure.subplots_adjust(
        left=0.15 / width, right=1.0 - 0.15 / width, bottom=0.42 / height, top=1.0 - 0.18 / height, wspace=0.12, hspace=0.75
    )
    return [ax for row in grid for ax in row]


def _distribution(ax: Any, found: Toleranced, name: str) -> None:
    column = list(found.study.columns).index(name)
    values = found.results.responses[found.results.designs < found.study.copies, column]
    values = values[np.isfinite(values)]
    nominal = float(found.slopes.values[column])
    form = display_unit_of(found.study.measures[name].quantity.si, max(float(np.max(np.abs(values), initial=0.0)), abs(nominal)))
    limits = [line for own, line in found.study.lines if own == name]
    count = int(np.clip(np.sqrt(len(values)), _FEWEST, _BINS))
    _, edges, bars = ax.hist(values * form.factor, bins=count, color=SERIES[0], linewidth=0.0)
    for left, right, bar in zip(edges[:-1], edges[1:], bars, strict=True):
        if any(_misses(line, 0.5 * (left + right) / form.factor) for line in limits):
            bar.set_facecolor(FAIL)
    ax.axvline(nominal * form.factor, color=INK, linewidth=0.9)
    for line in limits:
        _limit(ax, line.limit * form.factor, edges)
    ax.set_yticks([])
    ax.grid(visible=False)
    ax.spines["left"].set_visible(False)
    ax.set_xlabel(name if form.unit == "1" else f"{name} [{form.unit}]", labelpad=1.0)
    ax.tick_params(labelsize=6.5, pad=1.5)
    ax.locator_params(axis="x", nbins=5)


def _misses(line: Requirement, value: float) -> bool:
    return value < line.limit if line.sense is Sense.AT_LEAST else value > line.limit


def _limit(ax: Any, limit: float, edges: Array) -> None:
    """A limit that is near enough to be seen; else an arrow to where it is."""
    low, high = edges[0], edges[-1]
    room = 0.6 * (high - low)
    if low - room <= limit <= high + room:
        ax.axvline(limit, color=FAIL, linewidth=0.9, linestyle=(0, (4, 2)))
        return
    side = 0.0 if limit < low else 1.0
    text = f"\N{LEFTWARDS ARROW} {number(limit, 4)}" if side == 0.0 else f"{number(limit, 4)} \N{RIGHTWARDS ARROW}"
    ax.text(side, 1.0, text, transform=ax.transAxes, ha="left" if side == 0.0 else "right", va="bottom", fontsize=6.5, color=FAIL)


def yields_figure(found: Toleranced) -> Any:
    """The yield of every line and of all together, with its interval."""
    said = found.summary
    entries = [(line.column, line.kept) for line in said.lines]
    entries += [("all together", said.together)] if said.together is not None else []
    with style_context():
        figure = canvas(FULL, 0.55 + 0.2 * len(entries))
        ax = panels(figure, 1, 1, Margins(left=0.25 + text_width(name for name, _ in entries), right=0.35, bottom=0.4))[0, 0]
        for place, (_, kept) in enumerate(reversed(entries)):
            colour = PASS if kept.share >= found.study.wanted else WARN if kept.share > 0.9 else FAIL
            ax.barh(place, 100.0 * kept.share, height=0.6, color=colour)
            ax.plot([100.0 * kept.low, 100.0 * kept.high], [place, place], color=INK, linewidth=1.0)
        ax.axvline(100.0 * found.study.wanted, color=MUTED, linewidth=0.7, linestyle=(0, (4, 2)))
        ax.set_yticks(range(len(entries)), [name for name, _ in reversed(entries)])
        lowest = min((kept.low for _, kept in entries), default=0.0)
        ax.set_xlim(max(0.0, 100.0 * lowest - 5.0), 100.0)
        ax.set_xlabel("yield [%]")
        ax.grid(visible=False, axis="y")
    return figure


def shares_figure(found: Toleranced) -> Any:
    """Which scatter each response's variance is from, as one bar a response."""
    spread, names = found.summary.spread, list(found.study.measures)
    entries = [each.name for each in found.study.scatters]
    with style_context():
        figure = canvas(FULL, 0.75 + 0.2 * len(names))
        margins = Margins(left=0.25 + text_width(names), right=0.25 + text_width(entries) + 0.3, bottom=0.4, top=0.1)
        ax = panels(figure, 1, 1, margins)[0, 0]
        left = np.zeros(len(names))
        for number_, entry in enumerate(entries):
            share = np.where(spread.trusted, spread.by_slope[number_], spread.by_sample[number_])[: len(names)]
            share = np.nan_to_num(share)
            colour = SERIES[number_ % len(SERIES)]
            hatch = None if number_ < len(SERIES) else "///"
            ax.barh(range(len(names))[::-1], 100.0 * share, left=100.0 * left, height=0.65, color=colour, hatch=hatch, label=entry)
            left = left + share
        ax.set_yticks(range(len(names))[::-1], names)
        ax.set_xlim(0.0, max(100.0, 100.0 * float(left.max(initial=0.0))))
        ax.set_xlabel("share of the variance [%]")
        ax.grid(visible=False, axis="y")
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.02), handlelength=1.0)
    return figure


def crosstalk_figure(crosstalk: Crosstalk) -> Any:
    """Means and deviations of the pose error per command as a matrix; the darker, the larger against the others of its kind."""
    shade = _relative_size(crosstalk)
    count = len(crosstalk.coordinates)
    with style_context():
        figure = canvas(FULL, 0.45 + 0.36 * len(COMPONENTS))
        ax = panels(figure, 1, 1, Margins(left=0.85, right=0.1, bottom=0.1, top=0.3))[0, 0]
        ax.imshow(shade, cmap="Blues", vmin=0.0, vmax=1.6, aspect="auto")
        for row in range(len(COMPONENTS)):
            for column in range(count):
                mean, deviation = (1e3 * float(values[row, column]) for values in (crosstalk.mean, crosstalk.deviation))
                ax.text(column, row, _pair(mean, deviation), ha="center", va="center", fontsize=6.8)
        ax.set_xticks(range(count), [_axis(name, "um", "urad") for name in crosstalk.coordinates])
        ax.set_yticks(range(len(COMPONENTS)), [_axis(name, "nm", "nrad") for name in COMPONENTS])
        ax.xaxis.tick_top()
        ax.tick_params(length=0)
        ax.grid(visible=False)
        for side in ax.spines.values():
            side.set_visible(False)
    return figure


def _pair(mean: float, deviation: float) -> str:
    """A mean and a deviation to the deviation's second digit."""
    if not deviation > 1e-3:
        return "0"
    digits = max(0, 1 - int(np.floor(np.log10(deviation))))
    return f"{round(mean, digits) + 0.0:.{digits}f} \N{PLUS-MINUS SIGN} {deviation:.{digits}f}"


def _relative_size(crosstalk: Crosstalk) -> Array:
    """Deviations over the largest of the same kind: motion along or about an axis, per command along or about one."""
    shade = np.zeros_like(crosstalk.deviation)
    turns = np.array([name.startswith("r") for name in crosstalk.coordinates])
    for rows in (np.arange(3), np.arange(3, 6)):
        for columns in (np.flatnonzero(~turns), np.flatnonzero(turns)):
            block = np.ix_(rows, columns)
            largest = float(np.max(np.nan_to_num(crosstalk.deviation[block]), initial=0.0))
            shade[block] = np.nan_to_num(crosstalk.deviation[block]) / largest if largest > 0.0 else 0.0
    return shade


def _axis(name: str, along: str, about: str) -> str:
    return f"{name} [{about if name.startswith('r') else along}]"


def crosstalk_title(crosstalk: Crosstalk) -> str:
    """What a matrix of crosstalk is about."""
    return "commanded by the nominal R_a" if crosstalk.kind == OPEN else "kept by gauges through the nominal R_s^-1"
