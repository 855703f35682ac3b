"""Axes of a figure drawn with one tick each: matplotlib's own take five artists a tick, and half of a figure's time."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from matplotlib.artist import Artist

from flexstage.base.number import Array


class Ruler(Artist):
    """What an axis of straight axes draws, drawn by the first tick of each kind, which goes from place to place."""

    def __init__(self, axis: Any) -> None:
        super().__init__()
        self.axis = axis
        self.set_zorder(axis.get_zorder())

    def draw(self, renderer: Any) -> None:
        """Grid and marks as one line each, numbers, and the axis' name beside the longest of them."""
        axis, reach = self.axis, self.axis.axes.bbox.min
        for tick, places, texts in self._ticks():
            _lines(tick, places, along=axis.axis_name, renderer=renderer)
            if tick.label1.get_visible() and any(texts):
                _write(tick, places, texts, renderer)
                reach = np.minimum(reach, _reach(tick, texts, renderer)) if axis.label.get_text() else reach
        pad = axis.labelpad * renderer.points_to_pixels(1.0)
        axis.label.set(**({"y": reach[1] - pad} if axis.axis_name == "x" else {"x": reach[0] - pad}))
        axis.label.draw(renderer)

    def _ticks(self) -> list[tuple[Any, Array, Sequence[str]]]:
        """The first tick of either kind, the places in view where it is to stand, and what it says there."""
        axis = self.axis
        kinds = (
            (axis.get_majorticklocs(), axis.get_major_formatter(), axis.get_major_ticks),
            (axis.get_minorticklocs(), axis.get_minor_formatter(), axis.get_minor_ticks),
        )
        found = []
        for places, formatter, ticks in kinds:
            if len(places):
                texts = formatter.format_ticks(places)
                seen = _are_between(axis.get_transform().transform(places), axis.get_transform().transform(axis.get_view_interval()))
                found.append((ticks(1)[0], np.asarray(places)[seen], [text for text, own in zip(texts, seen, strict=True) if own]))
        return found


def _are_between(places: Array, ends: Array) -> Array:
    low, high = np.sort(ends)
    slack = 1e-10 * (high - low)
    return (places >= low - slack) & (places <= high + slack)


def _lines(tick: Any, places: Array, *, along: str, renderer: Any) -> None:
    """Grid and marks of all places; the tick is left as it was."""
    gaps = np.full(len(places), np.nan)
    lines = ((tick.gridline, [0.0, 1.0, np.nan], np.stack([places, places, gaps], axis=1)), (tick.tick1line, [0.0], places[:, None]))
    for drawn, across, here in lines:
        before = drawn.get_data()
        data = (here.ravel(), np.tile(across, len(places)))
        drawn.set_data(*(data if along == "x" else data[::-1]))
        drawn.draw(renderer)
        drawn.set_data(*before)


def _write(tick: Any, places: Array, texts: Sequence[str], renderer: Any) -> None:
    for place, text in zip(places, texts, strict=True):
        tick.update_position(place)
        tick.label1.set_text(text)
        tick.label1.draw(renderer)


def _reach(tick: Any, texts: Sequence[str], renderer: Any) -> Array:
    """How far to the left and down texts reach, of which those about as long as the longest are measured."""
    long = 0.7 * max(map(len, texts))
    extents: list[Array] = []
    for text in {text for text in texts if len(text) > long}:
        tick.label1.set_text(text)
        extents.append(tick.label1.get_window_extent(renderer).min)
    return np.min(extents, axis=0)


@contextmanager
def ruled(figure: Any) -> Generator[None]:
    """A figure while its axes are drawn by rulers: all that are straight, with marks and names on the left and below.

    >>> from flexstage.show.figures.style import canvas
    >>> figure = canvas(1.0, 1.0)
    >>> axes = figure.add_subplot()
    >>> with ruled(figure):
    ...     len(axes.artists), axes.xaxis.get_visible()
    (2, False)
    >>> len(axes.artists), axes.xaxis.get_visible()
    (0, True)
    """
    rulers = [axes.add_artist(Ruler(axis)) for axes in figure.axes if axes.axison for axis in (axes.xaxis, axes.yaxis) if _is_plain(axis)]
    for each in rulers:
        each.axis.set_visible(False)
    try:
        yield
    finally:
        for each in rulers:
            each.axis.set_visible(True)
            each.remove()


def _is_plain(axis: Any) -> bool:
    """Whether an axis has its marks and its name on the left or below, and no power of ten apart from its numbers."""
    if axis.axes.name != "rectilinear" or not axis.get_visible():
        return False
    axis.get_major_formatter().set_locs(axis.get_majorticklocs())
    known = axis.get_tick_params()
    beyond = any(known.get(side) for side in ("right", "top", "labelright", "labeltop"))
    return not beyond and axis.get_label_position() in {"left", "bottom"} and not axis.get_major_formatter().get_offset()
