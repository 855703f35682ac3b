"""The workspace: reachable poses of the platform, projected on pairs of coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.number import Array, Number
from flexstage.parts.profile import single
from flexstage.show.display import DisplayUnit, display_unit_of, to_typography
from flexstage.show.figures.hull import hull
from flexstage.show.figures.style import FULL, MUTED, SERIES, Margins, canvas, panels, style_context
from flexstage.show.table import first_design
from flexstage.spatial.frame import MOTION

_PAIRS = (("x", "y"), ("x", "z"), ("z", "rx"), ("rx", "ry"), ("y", "z"), ("x", "rz"))
_PANELS = 4
_CROSS: Mapping[str, Any] = {"color": SERIES[1], "markersize": 5, "linewidth": 1.2}


def workspace_figure(workspace: Workspace) -> Any | None:
    """Plot reachable poses, single-axis strokes and the commanded poses, projected on pairs of coordinates, as a matplotlib Figure.

    Returns `None` for stages with one DOF, or if the reachable poses are unknown.

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
            _panel(axes, workspace, *pair)
        handles, labels = row[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper left", ncols=3, handlelength=1.3, borderaxespad=0.0)
    return figure


def _pairs(coordinates: tuple[str, ...]) -> list[tuple[str, str]]:
    known = [pair for pair in _PAIRS if set(pair) <= set(coordinates)]
    return known[:_PANELS] or list(combinations(coordinates, 2))[:_PANELS]


@dataclass(frozen=True)
class _Shown:
    """A coordinate of a panel, and its display unit."""

    name: str
    unit: DisplayUnit

    @property
    def title(self) -> str:
        return to_typography(f"{self.name} [{self.unit.unit}]")


def _panel(axes: Any, workspace: Workspace, across: str, up: str) -> None:
    polytope = workspace.polytope
    if polytope is None:
        return
    indices = [polytope.coordinates.index(name) for name in (across, up)]
    vertices = first_design(polytope.vertices, 2)[:, indices]
    vertices = vertices[np.all(np.isfinite(vertices), axis=1)]
    x, y = (
        _Shown(name, display_unit_of(MOTION.unit(name), float(largest)))
        for name, largest in zip((across, up), np.max(np.abs(vertices), axis=0), strict=True)
    )
    outline = hull(vertices * [x.unit.factor, y.unit.factor])
    closed = np.vstack([outline, outline[:1]])
    axes.fill(*closed.T, color=SERIES[0], alpha=0.12, linewidth=0.0)
    axes.plot(*closed.T, color=SERIES[0], label="reachable, with any values of the other coordinates", linewidth=1.0)
    axes.plot(_strokes(workspace, x), [0.0, 0.0], marker="|", label="one axis at a time", **_CROSS)
    axes.plot([0.0, 0.0], _strokes(workspace, y), marker="_", **_CROSS)
    _command(axes, workspace.command, x, y)
    axes.set_xlabel(x.title)
    axes.set_ylabel(y.title, labelpad=1.0)
    axes.locator_params(nbins=5)
    axes.tick_params(labelsize=7)


def _strokes(workspace: Workspace, shown: _Shown) -> Array:
    """Both ends of the single-axis stroke of a coordinate."""
    index = workspace.single_axis.coordinates.index(shown.name)
    return shown.unit.factor * np.array([first_design(each, 1)[index] for each in (workspace.single_axis.low, workspace.single_axis.high)])


def _command(axes: Any, command: Mapping[str, Number], x: _Shown, y: _Shown) -> None:
    if not {x.name, y.name} <= set(command):
        return
    across, up = (each.unit.factor * single(command[each.name]) for each in (x, y))
    ends = across * np.array([-1, 1, 1, -1, -1]), up * np.array([-1, -1, 1, 1, -1])
    axes.plot(*ends, color=MUTED, linestyle="--", linewidth=0.9, label="commanded poses")
