"""Checks of trajectories against the stage's limits: its strokes, and the speed of its amplifiers."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.workspace.polytope import Polytope
from flexstage.base.finding import Finding
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS


def reach_findings(poses: Array, times: Array, polytope: Polytope) -> list[Finding]:
    """Check poses (n, f) against the `polytope` of reachable poses; the finding names the first and the worst time, and a remedy.

    The columns of `poses` are the polytope's coordinates. The boundary counts as reachable.

    >>> from flexstage.analysis.workspace.polytope import reachable
    >>> from flexstage.analysis.workspace.stroke import StrokeLimits
    >>> span = StrokeLimits(("B",), np.array([-1e-6]), np.array([1e-6]))
    >>> room = reachable(Matrix(np.eye(1), ("B",), ("x",), "1"), span)
    >>> print(reach_findings(np.array([[1e-6], [2e-6]]), np.array([0.0, 1.0]), room)[0].advice)
    Multiply the trajectory by 0.5, or move it towards the middle of the strokes
    """
    outside = np.flatnonzero(~polytope.contains(poses))
    if not len(outside):
        return []
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.nanmax(poses @ polytope.normals.T / (polytope.offsets + 0.0), axis=-1)  # -0 becomes 0
    worst = int(np.argmax(share))
    pose = ", ".join(f"{name} = {_show(value, name)}" for name, value in zip(polytope.coordinates, poses[worst], strict=True) if value)
    what = f"beyond the strokes from {times[outside[0]]:g} s on; at {times[worst]:g} s, {pose} needs {share[worst]:.3g} times the stroke"
    advice = f"Multiply the trajectory by {1.0 / share[worst]:.3g}, or move it towards the middle of the strokes"
    return [Finding("trajectory", what, advice)]


def _show(value: float, coordinate: str) -> str:
    return f"{1e6 * value:.4g} u{TWIST_UNITS[COMPONENTS.index(coordinate)]}"


def speed_findings(poses: Array, times: Array, mapping: Matrix, slew: Array, *, units: tuple[str, ...] = ()) -> list[Finding]:
    """Check the actuator speeds for sampled poses (n, f) against the amplifiers' rate limits `slew` (m,).

    The findings are warnings, because the simulation includes the saturation of the amplifiers. `mapping` (R_a) maps poses to inputs of
    actuators; its columns are the coordinates of the poses. `units` are the units of the actuators' inputs (default: m).

    >>> lever = Matrix(np.array([[2.0]]), ("B1",), ("x",), "1")
    >>> found = speed_findings(np.array([[0.0], [1e-6]]), np.array([0.0, 1e-3]), lever, np.array([1e-3]))
    >>> print(found[0])
    B1: the trajectory requires 2000 um/s at 0.001 s, but the amplifier's limit is 1000 um/s. Multiply the speed by 0.5.
    """
    rates = np.abs(np.diff(poses, axis=0) @ np.asarray(mapping.values).T) / np.diff(times)[:, None]
    found = []
    for actuator, unit, column, most in zip(mapping.rows, units or ("m",) * len(slew), rates.T, slew, strict=True):
        worst = int(np.argmax(column))
        if column[worst] > most * (1.0 + 1e-9):
            wanted, given = (f"{1e6 * value:.4g} um/s" if unit == "m" else f"{value:.4g} {unit}/s" for value in (column[worst], most))
            what = f"the trajectory requires {wanted} at {times[worst + 1]:g} s, but the amplifier's limit is {given}"
            found.append(Finding(actuator, what, f"Multiply the speed by {most / column[worst]:.3g}"))
    return found
