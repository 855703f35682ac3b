"""Frequency responses of a stage between named inputs and outputs, and its transmissibility."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from flexstage.analysis.dynamics.modes import average, repeated_groups
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array, distinct_values, first_design
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Damping
from flexstage.models.linear.damping import damping_law, modal_ratios
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.frequency import Response, transfer
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.port import ports

_MODES_SHOWN = 12
_WITHOUT_RESONANCES = (1.0, 1000.0)
"""Default band [Hz] without resonances (a rigid body driven only by forces)."""
_ANGLES = np.linspace(-1.45, 1.45, 25)


@check_arguments
def response(
    model: LinearModel,
    outputs: str | Iterable[str],
    inputs: str | Iterable[str],
    frequencies: Array | None = None,
    *,
    damping: Damping | None = None,
) -> Response:
    """Compute the frequency response H (..., f, p, m) of named outputs to named inputs.

    Names can be:

    - channels (`platform.x`, gauge `S1`, stroke `B1`, `chuck.fz`);
    - wrench components on any body (`B4/lever.fz`);
    - absolute displacements of the ground (`ground.x` to `ground.rz`);
    - groups of six components (`platform`, `ground`).

    `frequencies` (f,) are in Hz (default: `default_frequencies`). `damping` replaces the damping law of the design. Structural damping
    requires one solution per frequency; all other damping laws require a single eigenvalue problem. Raises `DesignError` for unknown names
    and unspecified damping.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> result = response(lumped(parallelogram()), ["S"], ["B"], np.array([0.0, 100.0]))
    >>> result.values.shape, result.units
    ((2, 1, 1), (('1',),))
    """
    law = damping_law(model, damping)
    chosen = ports(model, outputs, inputs)
    grid = default_frequencies(model, damping=law) if frequencies is None else _check(frequencies)
    return Response(grid, chosen.outputs, chosen.inputs, transfer(model, chosen, grid, law), model.provenance)


@check_arguments
def transmissibility(
    model: LinearModel, outputs: str | Iterable[str] = (PLATFORM,), frequencies: Array | None = None, *, damping: Damping | None = None
) -> Response:
    """Compute the transmissibility (..., f, p, 6): absolute motion of the outputs per unit motion of the ground.

    T = C_r + omega^2 C (K + j omega D - omega^2 M)^-1 M_b, with the angular frequency omega. K, D and M are stiffness, damping and mass
    matrices. C gives the outputs for motion relative to the ground, and C_r gives the outputs for rigid motion with the ground. M_b is the
    inertia force per acceleration of the ground; the ground rotates about the platform's reference point. Damping acts on motion relative
    to the ground. At low frequency, T of the platform's twist tends to the unit matrix. T of gauges and stress resultants tends to zero,
    because these outputs depend only on relative motion.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> result = transmissibility(lumped(parallelogram()), frequencies=np.array([0.01]))
    >>> bool(np.allclose(result.values[0], np.eye(6), atol=1e-6))
    True
    """
    return response(model, outputs, (GROUND,), frequencies, damping=damping)


def default_frequencies(model: LinearModel, band: tuple[float, float] | None = None, *, damping: Damping | None = None) -> Array:
    """Return a frequency grid (f,) in Hz: 40 points per decade, and 25 additional points across every resonance.

    The points across a resonance are f_r (1 + zeta_r tan theta), with the natural frequency f_r and the damping ratio zeta_r; the angles
    theta are equally spaced from -83 to 83 degrees. The default `band` is from 1/50 of the first natural frequency to twice the twelfth
    natural frequency. For a batch, the resonances of the first design are used. Repeated modes have their mean frequency.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> grid = default_frequencies(lumped(parallelogram()), (10.0, 1000.0))
    >>> float(grid[0]), float(grid[-1])
    (10.0, 1000.0)
    """
    solved = eigen(model)
    natural = np.sqrt(first_design(solved.values, 1)) / (2.0 * np.pi)
    if not natural.size:
        raise refuse("stage", "the model has no mass, and so no resonances for a frequency grid", "Specify the frequencies")
    ratios = modal_ratios(model, solved, damping_law(model, damping))
    groups = repeated_groups(first_design(solved.values, 1))
    natural, width = average(natural, groups), np.maximum(average(first_design(ratios, 1), groups), 1e-6)
    natural, width = natural[natural > 0.0], width[natural > 0.0]
    if band is None and not natural.size:
        band = _WITHOUT_RESONANCES
    low, high = band if band is not None else (natural[0] / 50.0, 2.0 * natural[min(_MODES_SHOWN, len(natural)) - 1])
    around = (natural[:, None] * (1.0 + width[:, None] * np.tan(_ANGLES))).ravel()
    coarse = np.geomspace(low, high, 1 + max(2, round(40.0 * float(np.log10(high / low)))))
    inner = np.concatenate([natural, around])
    return distinct_values(np.concatenate([coarse, inner[(inner > low) & (inner < high * (1.0 - 1e-9))]]))


def _check(frequencies: Array) -> Array:
    grid = np.asarray(frequencies, dtype=float)
    if grid.ndim != 1 or not np.all(np.isfinite(grid)) or np.any(grid < 0.0):
        raise refuse(
            "frequencies",
            f"not one row of finite, non-negative numbers in Hz (got shape {grid.shape})",
            "Correct the list",
        )
    return grid
