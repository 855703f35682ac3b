"""The workspace: what the platform reaches, projected on pairs of coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.number import Array, Number
from flexstage.show.display import DisplayUnit, display_unit_of, to_typography
from flexstage.show.figures.style import FULL, MUTED, SERIES, Margins, canvas, panels, style_context
from flexstage.show.scene.silhouette import hull
from flexstage.show.table import first_design
from flexstage.show.tables.workspace import unit_of

_PAIRS = (("x", "y"), ("x", "z"), ("z", "rx"), ("rx", "ry"), ("y", "z"), ("x", "rz"))
_PANELS = 4


def workspace_figure(workspace: Workspace) -> Any | None:
    """Reachable poses, single-axis strokes and the commanded box, projected on pairs of coordinates, as a matplotlib Figure.

    `None` for stages of one freedom, or whose reachable poses are not known.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.analysis.workspace.workspace import workspace
    >>> stage = double_triangle()
    >>> len(workspace_figure(workspace(stage, ideal(stage), None)).axes)
    4
    """
    polytope = workspace.polytope
    if polytope is None or len(polytope.coordinates) < 2:
        return None
    pairs = _pairs(polytope.coordinates)
    with style_context():
        figure = canvas(FULL, 2.25 if len(pairs) > 2 else 2.6)
        row = panels(figure, 1, len(pairs), Margins(left=0.6, top=0.3, across=0.62))[0]
        for axes, pair in zip(row, pairs, strict=True):
            _panel(axes, workspace, pair)
        handles, labels = row[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper left", ncols=3, handlelength=1.3, borderaxespad=0.0)
    return figure


def _pairs(coordinates: tuple[str, ...]) -> list[tuple[str, str]]:
    known = [pair for pair in _PAIRS if set(pair) <= set(coordinates)]
    return known[:_PANELS] or list(combinations(coordinates, 2))[:_PANELS]


def _panel(axes: Any, workspace: Workspace, pair: tuple[str, str]) -> None:
    polytope = workspace.polytope
    if polytope is None:
        return
    indices = [polytope.coordinates.index(name) for name in pair]
    vertices = first_design(polytope.vertices, 2)[:, indices]
    vertices = vertices[np.all(np.isfinite(vertices), axis=1)]
    forms = [display_unit_of(unit_of(name), float(np.max(np.abs(vertices[:, side])))) for side, name in enumerate(pair)]
    outline = hull(vertices * [form.factor for form in forms])
    closed = np.vstack([outline, outline[:1]])
    axes.fill(*closed.T, color=SERIES[0], alpha=0.12, linewidth=0.0)
    axes.plot(*closed.T, color=SERIES[0], label="reachable, others free to follow", linewidth=1.0)
    _single(axes, workspace, pair, forms)
    _command(axes, workspace.command, pair, forms)
    axes.set_xlabel(to_typography(f"{pair[0]} [{forms[0].unit}]"))
    axes.set_ylabel(to_typography(f"{pair[1]} [{forms[1].unit}]"), labelpad=1.0)
    axes.locator_params(nbins=5)
    axes.tick_params(labelsize=7)


def _single(axes: Any, workspace: Workspace, pair: tuple[str, str], forms: list[DisplayUnit]) -> None:
    """The single-axis strokes as a cross."""
    low, high = (first_design(values, 1) for values in (workspace.single.low, workspace.single.high))
    for side, name in enumerate(pair):
        index = workspace.single.coordinates.index(name)
        ends = forms[side].factor * np.array([low[index], high[index]])
        points: list[Array] = [ends, np.zeros(2)]
        x, y = points if side == 0 else points[::-1]
        label = "one axis at a time" if side == 0 else None
        axes.plot(x, y, color=SERIES[1], marker="|" if side == 0 else "_", markersize=5, linewidth=1.2, label=label)


def _command(axes: Any, command: Mapping[str, Number], pair: tuple[str, str], forms: list[DisplayUnit]) -> None:
    if not set(pair) <= set(command):
        return
    half = [form.factor * float(np.real(np.ravel(command[name])[0])) for name, form in zip(pair, forms, strict=True)]
    x, y = half[0] * np.array([-1, 1, 1, -1, -1]), half[1] * np.array([-1, -1, 1, 1, -1])
    axes.plot(x, y, color=MUTED, linestyle="--", linewidth=0.9, label="commanded box")
