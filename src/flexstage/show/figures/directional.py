"""Stiffness by direction in the plane, as a polar plot."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.analysis.linear_statics.statics import DirectionalStiffness, Statics
from flexstage.base.number import Array
from flexstage.parts.profile import single
from flexstage.show.display import number, to_typography
from flexstage.show.figures.style import HALF, INK, MUTED, SERIES, canvas, style_context
from flexstage.show.table import first_design

_ANGLES = np.deg2rad(np.arange(0.0, 361.0, 3.0))
_ISOTROPIC = 1e-6


def directional_figure(statics: Statics) -> Any:
    """Plot the in-plane stiffness [N/um] as a function of direction, with the other DOFs free and with them fixed, as a matplotlib Figure.

    The principal axes are shown too.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(directional_figure(fs.statics(fs.mapped(double_triangle()))).axes)
    1
    """
    from matplotlib.ticker import MaxNLocator

    with style_context():
        figure = canvas(HALF, 1.12 * HALF)
        axes = figure.add_axes((0.13, 0.2, 0.74, 0.74 / 1.12), projection="polar")
        both = (("others fixed", statics.held, SERIES[0]), ("others free", statics.free, SERIES[1]))
        curves = [curve for curve in both if not np.isnan(curve[1].principal).any()]  # no curve if the model locks the plane
        for name, stiffness, colour in curves:
            radius = 1e-6 * _along(stiffness)
            axes.plot(_ANGLES, radius, color=colour, label=f"{name}: {_values(stiffness)}")
            axes.fill(_ANGLES, radius, color=colour, alpha=0.07, linewidth=0.0)
            _principal_axes(axes, stiffness, colour)
        axes.set_rlabel_position(22.5)
        axes.tick_params(labelsize=7, pad=1)
        axes.spines["polar"].set_color(MUTED)
        axes.spines["polar"].set_linewidth(0.5)
        axes.set_ylim(0.0, 1.1e-6 * max((float(first_design(stiffness.principal, 1)[0]) for _, stiffness, _ in curves), default=1e6))
        axes.yaxis.set_major_locator(MaxNLocator(4))
        if curves:
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.08), handlelength=1.2, title=to_typography("N/um"), title_fontsize=7.5)
        axes.set_xticks(np.deg2rad(np.arange(0, 360, 45)), ["x", "45°", "y", "135°", "180°", "225°", "270°", "315°"])
        axes.grid(linewidth=0.5)
        axes.tick_params(labelcolor=INK)
    return figure


def _along(stiffness: DirectionalStiffness) -> Array:
    angles = _ANGLES.reshape(-1, *(1,) * (np.ndim(stiffness.principal) - 1))
    return np.real(stiffness.along(angles).reshape(len(_ANGLES), -1)[:, 0])


def _principal(stiffness: DirectionalStiffness) -> tuple[float, float, float | None]:
    """The largest and the least stiffness [N/um], and the direction of the largest [rad]; `None` if equal in all directions."""
    most, least = (float(value) for value in 1e-6 * first_design(stiffness.principal, 1))
    return most, least, None if most - least < _ISOTROPIC * most else single(stiffness.angle)


def _values(stiffness: DirectionalStiffness) -> str:
    most, least, angle = _principal(stiffness)
    if angle is None:
        return f"{number(most, 4)} in every direction"
    return f"{number(most, 4)} along {float(np.rad2deg(angle)):.0f}°, {number(least, 4)} across"


def _principal_axes(axes: Any, stiffness: DirectionalStiffness, colour: str) -> None:
    most, least, angle = _principal(stiffness)
    if angle is None:
        return
    for turn, reach in ((0.0, most), (0.5 * np.pi, least)):
        axes.plot([angle + turn, angle + turn + np.pi], [reach, reach], color=colour, linewidth=0.7, linestyle="--")
