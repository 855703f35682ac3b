"""The modes on one line: where they lie and whose they are."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.analysis.dynamics.modes import Modes
from flexstage.show.figures.style import FULL, INK, MUTED, SERIES, Margins, canvas, panels, style_context
from flexstage.show.table import first_design
from flexstage.show.tables.modes import listed_modes


def spectrum_figure(modes: Modes) -> Any:
    """The listed modes over frequency, as high as the platform's share of their kinetic energy, as a matplotlib Figure.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(spectrum_figure(fs.modes(fs.lumped(double_triangle()))).axes)
    1
    """
    listed = listed_modes(modes)
    frequencies, share = first_design(modes.frequencies, 1), first_design(modes.share, 1)
    with style_context():
        figure = canvas(FULL, 1.75)
        axes = panels(figure, 1, 1, Margins())[0, 0]
        kinds = (("platform", modes.platform, SERIES[0]), ("local neighbours", modes.local, SERIES[1]))
        rest = tuple(index for index in listed if index not in modes.platform and index not in modes.local)
        for name, indices, colour in (*kinds, ("other local modes", rest, SERIES[7])):
            if indices:
                x, y = frequencies[list(indices)], 100.0 * np.maximum(share[list(indices)], 0.0)
                axes.vlines(x, 0.0, y, color=colour, linewidth=1.2)
                axes.plot(x, y, "o", color=colour, markersize=4.0, label=name)
        _names(axes, modes)
        axes.set_ylim(-4.0, 128.0)
        axes.set_yticks([0, 50, 100])
        axes.set_xlim(0.0, 1.06 * float(frequencies[listed[-1]]) if listed else 1.0)
        axes.set_xlabel("frequency [Hz]")
        axes.set_ylabel("platform's share [%]")
        axes.legend(loc="center right", handletextpad=0.2)
    return figure


def _names(axes: Any, modes: Modes) -> None:
    """Name and frequency above the platform's modes, repeated ones together."""
    frequencies, share = first_design(modes.frequencies, 1), first_design(modes.share, 1)
    marks: dict[str, list[int]] = {}
    for index in modes.platform:
        marks.setdefault(f"{frequencies[index]:.4g}", []).append(index)
    for frequency, indices in marks.items():
        names = ", ".join(dict.fromkeys(modes.names[index] for index in indices))
        times = f" ({len(indices)}×)" if len(indices) > 1 and "," not in names else ""
        height = 100.0 * float(max(share[index] for index in indices))
        axes.text(
            float(frequency),
            height + 5.0,
            f"{names}{times}\n{frequency}",
            ha="center",
            va="bottom",
            fontsize=6.5,
            color=INK,
            linespacing=1.15,
        )
    axes.axhline(0.0, color=MUTED, linewidth=0.5)
