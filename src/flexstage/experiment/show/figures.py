"""Figures of a test: responses with fit and data, coherence, the stabilisation diagram."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.records.record import Channel, Responses, names_of
from flexstage.experiment.spectral.lines import in_band
from flexstage.show.display import to_typography
from flexstage.show.figures.style import FULL, INK, MUTED, SERIES, Margins, canvas, panels, style_context

LARGEST = 6
"""Maximum number of rows and of columns of responses in a figure."""

_BINS, _FINE = 110, 90
_POINTS = 3500
_ABOVE, _BELOW = 1.8, 0.4
_DATA, _FIT = "#9aa5b1", SERIES[0]
_PERIOD = 360.0
_MANY = 4000


def response_matrix_figure(found: Identified) -> Any:
    """Plot the response matrix of the first outputs and inputs: magnitude above phase, data grey and fit coloured, as a matplotlib Figure.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> len(response_matrix_figure(identify(one_mode_record())).axes)
    2
    """
    rows, columns = found.outputs[:LARGEST], found.inputs[:LARGEST]
    band = focus(found)
    inside = in_band(found.responses.frequencies, band)
    lines, values = found.responses.frequencies[inside], found.responses.values[inside]
    fine = _fine_lines(found, band)
    fitted = found.response(fine).values if len(found.frequencies) else None
    bins = min(_BINS, max(40, _POINTS // (len(rows) * len(columns))))
    height = 1.35 if len(columns) > 2 else 2.0
    with style_context():
        figure = canvas(FULL, 0.75 + height * len(rows))
        margins = Margins(left=0.75, top=0.3, bottom=0.42, across=0.1, down=0.06)
        grid = panels(figure, 2 * len(rows), len(columns), margins, heights=[2.1, 1.0] * len(rows))
        for row, column in np.ndindex(len(rows), len(columns)):
            own = None if fitted is None else fitted[:, row, column]
            _response(grid[2 * row : 2 * row + 2, column], (lines, values[:, row, column]), (fine, own), bins)
        for row in range(len(rows)):
            _same_scale(grid[2 * row], np.abs(values[:, row, : len(columns)]))
        _matrix_labels(grid, rows, columns)
        for axes in grid.flat:
            axes.minorticks_off()
            axes.set_xlim(*band)
    return figure


def density_figure(found: Identified) -> Any:
    """Plot the outputs' amplitude densities for a test without recorded inputs, with the identified modes, as a matplotlib Figure."""
    lines = found.responses.frequencies
    inside = in_band(lines, focus(found))
    with style_context():
        figure = canvas(FULL, 2.6)
        axes = panels(figure, 1, 1, Margins(left=0.75, top=0.3))[0, 0]
        for index, channel in enumerate(found.outputs[:LARGEST]):
            x, size = _extremes(lines[inside], np.abs(found.responses.values[inside, index, 0]), 4 * _BINS)
            axes.semilogy(x, size, color=SERIES[index % len(SERIES)], linewidth=0.7, label=channel.name)
        _mark_modes(axes, found)
        units = {channel.unit for channel in found.outputs}
        axes.set_xlim(*focus(found))
        axes.set_xlabel("frequency [Hz]")
        axes.set_ylabel(f"density [{to_typography(units.pop())}/√Hz]" if len(units) == 1 else "density")
        axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=LARGEST, borderaxespad=0.2)
    return figure


def focus(found: Identified) -> tuple[float, float]:
    """Choose the frequency range of figures [Hz]: from below the lowest mode to well above the highest mode, within the searched band.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> [round(each, 1) for each in focus(identify(one_mode_record()))]
    [4.0, 18.0]
    """
    low, high = found.band
    if not len(found.frequencies):
        return low, high
    return max(low, _BELOW * float(np.min(found.frequencies))), min(high, _ABOVE * float(np.max(found.frequencies)))


def _response(pair: Any, data: tuple[Array, Array], fit: tuple[Array, Array | None], bins: int) -> None:
    """Draw magnitude and phase on two axes; `fit` may be empty."""
    (upper, lower), (lines, values), (fine, fitted) = pair, data, fit
    upper.semilogy(*_extremes(lines, np.abs(values), bins), color=_DATA, linewidth=1.6)
    step = max(1, len(lines) // bins)
    marks = np.rad2deg(np.angle(values[::step]))[:, None] + np.array([-4.0, 4.0, np.nan])  # one path: each marker is an element
    lower.plot(np.repeat(lines[::step], 3), marks.ravel(), color=_DATA, linewidth=1.5)
    if fitted is not None:
        angle = np.rad2deg(np.angle(fitted))
        jumps = np.flatnonzero(np.abs(np.diff(angle)) > 0.5 * _PERIOD) + 1
        upper.semilogy(fine, np.abs(fitted), color=_FIT, linewidth=0.8)
        lower.plot(np.insert(fine, jumps, np.nan), np.insert(angle, jumps, np.nan), color=_FIT, linewidth=0.8)
    lower.set_ylim(-200.0, 200.0)
    lower.set_yticks([-180.0, 0.0, 180.0])


def _same_scale(row: Any, sizes: Array) -> None:
    """Set a common magnitude scale for all responses of an output, without very low values."""
    if np.any(sizes > 0.0):
        high = float(np.max(sizes))
        low = max(float(np.quantile(sizes[sizes > 0.0], 0.005)), 1e-6 * high)
        for axes in row:
            axes.set_ylim(0.5 * low, 2.5 * high)


def _matrix_labels(grid: Any, rows: Sequence[Channel], columns: Sequence[Channel]) -> None:
    for column, channel in enumerate(columns):
        grid[0, column].set_title(channel.name, fontsize=7.5)
        grid[-1, column].set_xlabel("frequency [Hz]", fontsize=7.0)
    units = {each.unit for each in columns}
    below = units.pop() if len(units) == 1 else ""
    for row, channel in enumerate(rows):
        unit = f" [{to_typography(channel.unit)}/{to_typography(below)}]" if channel.unit and below else ""
        for axes, text in zip(grid[2 * row : 2 * row + 2, 0], (f"{channel.name}{unit}", "phase [°]"), strict=True):
            axes.set_ylabel(text, fontsize=6.5)
            axes.yaxis.set_label_coords(-0.62 / (FULL / len(columns)), 0.5)
        for axes in grid[2 * row]:
            _decades(axes)
    for axes in grid.flat:
        axes.tick_params(labelsize=6.0)
        axes.label_outer()


def _decades(axes: Any) -> None:
    """Set a few ticks at powers of ten on a logarithmic axis, as plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: to_typography(f"{value:g}" if 1e-2 <= value < 1e3 else f"{value:.0e}")))
    axes.yaxis.set_minor_locator(NullLocator())


def estimator_figure(first: Responses, others: Sequence[Responses], band: tuple[float, float]) -> Any:
    """Plot the response of each output to its dominant input in the `band` [Hz], by the estimates H1 (`first`) and `others` (e.g. H2).

    >>> from flexstage.experiment.spectral.cross_spectra import example_spectra
    >>> from flexstage.experiment.spectral.transfer import h1, h2
    >>> len(estimator_figure(h1(example_spectra()), [h2(example_spectra())], (1.0, 8.0)).axes)
    1
    """
    inside = in_band(first.frequencies, band)
    largest = np.argmax(np.sum(np.abs(first.values[inside]) ** 2, axis=0), axis=1)

    def draw(axes: Any, row: int) -> None:
        for index, each in enumerate((first, *others)):
            own = in_band(each.frequencies, band)  # estimates may have other lines than the first
            x, size = _extremes(each.frequencies[own], np.abs(each.values[own, row, largest[row]]))
            axes.semilogy(x, size, color=SERIES[index], linewidth=1.6 - 0.5 * index, label=each.name)
        _decades(axes)

    titles = [f"{output.name} / {first.inputs[column].name}" for output, column in zip(first.outputs, largest, strict=True)]
    return _by_output(titles, band, draw, 1.6)


def coherence_figure(found: Identified, multiple: Array | None, lines: Array | None = None) -> Any:
    """Plot the multiple coherence of the first outputs, and the ordinary coherence with every input, as a matplotlib Figure.

    `multiple` (f, p) is the multiple coherence at the frequencies `lines` [Hz]; the default is the frequencies of the identified responses.
    For responses from an analyser, `multiple` is None.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> len(coherence_figure(identify(one_mode_record()), None).axes)
    1
    """
    data, band = found.responses, focus(found)
    own = data.frequencies if lines is None else lines
    ordinary = data.values[:, :, :0] if data.coherence is None else data.coherence[:, :, :LARGEST]

    def draw(axes: Any, row: int) -> None:
        for column in range(ordinary.shape[2]):
            x, share = _means(data.frequencies, ordinary[:, row, column], band)
            axes.plot(x, share, color=SERIES[column % len(SERIES)], linewidth=0.7, label=f"with {found.inputs[column].name}")
        if multiple is not None:
            axes.plot(*_means(own, multiple[:, row], band), color=INK, linewidth=1.3, label="multiple")
        axes.set_ylim(0.0, 1.04)

    return _by_output(names_of(found.outputs), band, draw, 1.25)


def _by_output(titles: Sequence[str], band: tuple[float, float], draw: Callable[[Any, int], None], height: float) -> Any:
    """Figure with a panel of a height [in] for each of the first outputs, three per row, and one legend above all."""
    count = min(LARGEST, len(titles))
    across = min(3, count)
    down = -(-count // across)
    with style_context():
        figure = canvas(FULL, 0.75 + height * down)
        grid = panels(figure, down, across, Margins(left=0.6, top=0.5, across=0.45, down=0.4))
        for row, axes in enumerate(grid.flat):
            if row < count:
                draw(axes, row)
                axes.set_title(titles[row], fontsize=7.5)
            axes.set_visible(row < count)
            axes.set_xlim(*band)
            axes.tick_params(labelsize=6.5, labelbottom=True)
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper left", ncols=7, handlelength=1.2, columnspacing=1.2, borderaxespad=0.2, fontsize=7.0)
        for axes in grid[-1]:
            axes.set_xlabel("frequency [Hz]")
    return figure


def _mark_modes(axes: Any, found: Identified, label: str | None = None) -> None:
    for index, frequency in enumerate(found.frequencies.tolist()):
        axes.axvline(frequency, color=MUTED, linewidth=0.6, linestyle=":", label=None if index else label)


def stabilisation_figure(found: Identified) -> Any:
    """Plot the stabilisation diagram: poles by order and frequency, their stability, identified modes, and the sum of all responses.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> len(stabilisation_figure(identify(one_mode_record())).axes)
    2
    """
    kinds = (
        ("new", ".", "#b8c1cc", 2.0),
        ("frequency stable", "x", SERIES[1], 2.6),
        ("also damping", "^", SERIES[4], 2.6),
        ("also participation", "o", SERIES[2], 2.6),
    )
    with style_context():
        figure = canvas(FULL, 3.1)
        axes = panels(figure, 1, 1, Margins(left=0.5, right=0.55, top=0.4))[0, 0]
        _envelope(axes, found)
        for stable, (label, marker, colour, size) in enumerate(kinds):
            style = {"color": colour, "markersize": size, "markeredgewidth": 0.6, "linestyle": "none"}
            axes.plot(*_poles(found, stable), marker, label=label, **style)
        _mark_modes(axes, found, "mode found")
        axes.set_xlim(*focus(found))
        axes.set_xlabel("frequency [Hz]")
        axes.set_ylabel("order")
        axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=5, handletextpad=0.3, columnspacing=1.2, borderaxespad=0.2)
    return figure


def _poles(found: Identified, stable: int) -> Array:
    """Frequencies and orders (2, n) of the poles of one kind within the band."""
    every = np.concatenate([np.stack([each.frequencies, each.orders, each.stable]) for each in found.stabilisation], axis=1)
    chosen = every[:2, (every[2] == stable) & in_band(every[0], focus(found))]
    return chosen[:, :: max(1, -(-chosen.shape[1] // _MANY))]


def _envelope(axes: Any, found: Identified) -> None:
    """Draw the root sum of squares of all responses, each output over its own mean, on a separate axis."""
    data = found.responses
    inside = in_band(data.frequencies, focus(found))
    power = np.sum(np.abs(data.values[inside]) ** 2, axis=2)
    total = np.sqrt(np.sum(power / np.maximum(np.mean(power, axis=0), 1e-300), axis=1))
    behind = axes.twinx()
    behind.semilogy(*_extremes(data.frequencies[inside], total), color=_DATA, linewidth=0.9, zorder=0)
    behind.set_ylabel("all responses, relative", color=MUTED)
    behind.tick_params(labelsize=6.5, colors=MUTED)
    _decades(behind)
    behind.grid(visible=False)
    axes.set_zorder(behind.get_zorder() + 1)


def _fine_lines(found: Identified, band: tuple[float, float]) -> Array:
    """Frequencies of the fit: evenly over the band, and finely within some half-widths of each mode."""
    offsets = np.array([-8.0, -4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0])
    around = (found.frequencies[:, None] * (1.0 + offsets * found.damping[:, None])).ravel()
    lines = np.unique(np.concatenate([np.linspace(*band, _FINE), around]))
    return lines[in_band(lines, band)]


def _extremes(x: Array, y: Array, bins: int = _BINS) -> tuple[Array, Array]:
    """Curve reduced to the pixels of a picture: the minimum and the maximum of each bin."""
    if len(x) <= 3 * bins:
        return x, y
    kept: list[int] = []
    for part in np.array_split(np.arange(len(x)), bins):
        kept += sorted({int(part[np.argmin(y[part])]), int(part[np.argmax(y[part])])})
    return x[kept], y[kept]


def _means(x: Array, y: Array, band: tuple[float, float]) -> tuple[Array, Array]:
    """Curve within a band, averaged over bins."""
    inside = np.flatnonzero(in_band(x, band))
    parts = np.array_split(inside, min(len(inside), 2 * _BINS))
    return np.array([np.mean(x[part]) for part in parts]), np.array([np.mean(y[part]) for part in parts])
