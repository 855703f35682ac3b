"""The exact inverse of a Prandtl-Ishlinskii model: the input for a required output."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.control.hysteresis.models.envelope import descent_findings, invert
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii


@check_arguments
def inverse(model: PrandtlIshlinskii) -> PrandtlIshlinskii:
    """Compute the Prandtl-Ishlinskii model that inverts `model` exactly, sample by sample.

    Both models consist of plays between two envelopes. The plays of `model` have the thresholds r_i and the weights p_i. The envelope a is
    before the plays, and the envelope b is after the plays. P_j = p_0 + ... + p_j is the slope of the virgin curve beyond r_j. The
    thresholds s_j, weights q_j and envelopes a' and b' of the inverse model are

        s_j = sum_{i<=j} p_i (r_j - r_i),   q_0 = 1/p_0,   q_j = -p_j / (P_j P_{j-1}),   a' = b^-1,   b' = a^-1

    (Kuhnen 2003, eqs. 17 to 19). The inverse exists if and only if every P_j > 0 and both envelopes ascend. Raises `DesignError` for each
    threshold with P_j <= 0, and for each envelope piece that does not ascend. Both models start from the unloaded state; for other states,
    `inverse_state` gives the inverse's state.

    >>> model = PrandtlIshlinskii([0.0, 100.0], [1e-7, 5e-8])
    >>> wanted = np.array([0.0, 70e-6, 60e-6, 5e-6])
    >>> inverse(model).run(wanted).round(9).tolist()
    [0.0, 500.0, 400.0, 0.0]
    """
    require(inverse_findings(model))
    partial = np.cumsum(model.weights, axis=1)
    steps = np.diff(model.thresholds) * partial[:, :-1]
    thresholds = np.concatenate([np.zeros((model.axes, 1)), np.cumsum(steps, axis=1)], axis=1)
    weights = np.concatenate([1.0 / partial[:, :1], -model.weights[:, 1:] / (partial[:, 1:] * partial[:, :-1])], axis=1)
    return PrandtlIshlinskii(thresholds, weights, invert(model.after), invert(model.before))


def inverse_state(model: PrandtlIshlinskii, state: Array) -> Array:
    """Compute the state (axes, n) of `inverse(model)`: z'_j = P_j z_j + sum_{i>j} p_i z_i, from the model's state z (see `inverse`).

    >>> model = PrandtlIshlinskii([0.0, 100.0], [1e-7, 5e-8])
    >>> state, there = model.step(model.start(np.array([500.0])), np.array([400.0]))
    >>> round(float(inverse(model).step(inverse_state(model, state), there)[1][0]), 9)
    400.0
    """
    weighted = np.cumsum((model.weights * state)[:, ::-1], axis=1)[:, ::-1]
    return np.cumsum(model.weights, axis=1) * state + weighted - model.weights * state


def inverse_findings(model: PrandtlIshlinskii) -> list[Finding]:
    """Find the reasons why a model has no inverse: thresholds beyond which its output does not rise, and falling envelope pieces.

    >>> inverse_findings(PrandtlIshlinskii([0.0, 50.0, 100.0], [1e-7, 5e-8, -2e-7]))[0].what
    'the weights up to 2 (threshold 100) sum to -5e-08: beyond it, the output does not rise with the input, and no inverse exists'
    """
    around = [*descent_findings(model.before, "envelope before the plays"), *descent_findings(model.after, "envelope after the plays")]
    return [*_slope_findings(model), *around]


def _slope_findings(model: PrandtlIshlinskii) -> Iterator[Finding]:
    partial = np.cumsum(model.weights, axis=1)
    for axis, place in np.argwhere(~(partial > 0.0)):
        threshold = model.thresholds[axis, place]
        what = f"the weights up to {place} (threshold {threshold:g}) sum to {partial[axis, place]:g}"
        reason = f"{what}: beyond it, the output does not rise with the input, and no inverse exists"
        advice = "Identify the model with weights of 0 or more and a positive first weight, or omit this play"
        yield Finding(f"hysteresis of axis {axis}", reason, advice)


hysteresis_inverse = inverse
"""`inverse` under its name in `flexstage`."""
