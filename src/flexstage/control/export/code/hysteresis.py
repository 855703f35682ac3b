"""Hysteresis models as C functions: plays between envelopes, their inverse, and Bouc-Wen."""

from __future__ import annotations

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.control.export.code.program import State
from flexstage.control.export.code.text import indent, table
from flexstage.control.hysteresis.models.bouc_wen import BoucWen
from flexstage.control.hysteresis.models.envelope import IDENTITY, Envelope
from flexstage.control.hysteresis.models.inverse import inverse
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.models.protocol import Hysteresis


def hysteresis_step(name: str, model: Hysteresis, bias: Array) -> tuple[list[str], State]:
    """Generate `double <name>_move(double *state, int axis, double value)`, which advances one axis, and the initial state at the bias.

    Raises `DesignError` for a model without a C form.

    >>> lines, state = hysteresis_step("stack", PrandtlIshlinskii([0.0, 2.0], [1.0, 0.5]), np.zeros(1))
    >>> state.sizes, lines[-1]
    ((1, 2), '}')
    """
    start = model.start(bias)
    head = [*table(f"{name}_rest", start)]
    if isinstance(model, PrandtlIshlinskii):
        every = f"i = 0; i < {model.thresholds.shape[1]}; i++"
        lines = _plays(name, model, f"{name}_move(", head=every, play="plays[i]")
    elif isinstance(model, BoucWen):
        lines = _bouc_wen(name, model)
    else:
        advice = "Export a loop with a Prandtl-Ishlinskii or Bouc-Wen hysteresis, or simulate this loop without a compiler"
        raise refuse("hysteresis", f"{type(model).__name__} cannot be exported as C", advice)
    return [*head, *lines], State(name, start.shape, f"{name}_rest")


def _plays(name: str, model: PrandtlIshlinskii, call: str, *, head: str, play: str, loop: tuple[str, ...] = ()) -> list[str]:
    """Tables of a model, and a function that sums its plays between its envelopes; its loop names the plays `play`."""
    before, after = (_envelope(f"{name}_{which}", each, model.axes) for which, each in (("before", model.before), ("after", model.after)))
    return [
        *table(f"{name}_thresholds", model.thresholds),
        *table(f"{name}_weights", model.weights),
        *before[0],
        *after[0],
        f"static double {call}double *plays, int axis, double value)",
        "{",
        *indent(
            [
                f"const double *thresholds = {name}_thresholds[axis], *weights = {name}_weights[axis];",
                f"const double u = {before[1].format('value')};",
                "double sum = 0.0;",
                *loop[:1],
                "int i;",
                f"for ({head}) {{",
                *indent([*loop[1:], *_CLAMPED.format(play).splitlines()]),
                f"    sum += weights[i] * {play};",
                "}",
                f"return {after[1].format('sum')};",
            ]
        ),
        "}",
    ]


_CLAMPED = """if (u + thresholds[i] < {0}) {0} = u + thresholds[i];
if (u - thresholds[i] > {0}) {0} = u - thresholds[i];"""


def _envelope(name: str, envelope: Envelope, axes: int) -> tuple[list[str], str]:
    """Tables and function of an envelope, and its value expression; nothing for the identity."""
    if envelope is IDENTITY:
        return [], "{}"
    changes = np.broadcast_to(envelope.changes, (axes, envelope.changes.shape[1]))
    lines = [
        *table(f"{name}_knots", np.broadcast_to(envelope.knots[:, :-1], changes.shape)),
        *table(f"{name}_changes", changes),
        *table(f"{name}_start", np.broadcast_to(envelope.values[:, 0], (axes,))),
        f"static double {name}(int axis, double x)",
        "{",
        *indent(
            [
                f"const double *knots = {name}_knots[axis], *changes = {name}_changes[axis];",
                "double sum = changes[0] * (x - knots[0]);",
                "int i;",
                f"for (i = 1; i < {changes.shape[1]}; i++)",
                "    if (x > knots[i]) sum += changes[i] * (x - knots[i]);",
                f"return {name}_start[axis] + sum;",
            ]
        ),
        "}",
    ]
    return lines, f"{name}(axis, {{}})"


def hysteresis_inverse(name: str, model: PrandtlIshlinskii) -> list[str]:
    """Generate `double <name>_invert(const double *plays, int axis, double value)`: the input for the output `value` at the given plays.

    The function does not change the model's state. The inverse model's play output j is P_j z_j plus the sum of p_i z_i over all i > j (see
    `inverse_state`). z_i are the model's plays, p_i their weights, and P_j is the sum of the weights up to j.

    >>> hysteresis_inverse("model", PrandtlIshlinskii([0.0, 2.0], [1.0, 0.5]))[-1]
    '}'
    """
    loop = (
        "double behind = 0.0, play;",
        f"play = {name}_partial[axis][i] * plays[i] + behind;",
        f"behind += {name}_weights[axis][i] * plays[i];",
    )
    head = f"i = {model.thresholds.shape[1]} - 1; i >= 0; i--"
    partial = table(f"{name}_partial", np.cumsum(model.weights, axis=1))
    return [*partial, *_plays(f"{name}_inverse", inverse(model), f"{name}_invert(const ", head=head, play="play", loop=loop)]


def _bouc_wen(name: str, model: BoucWen) -> list[str]:
    tables = {"gain": model.gain, "lag": model.lag, "beta": model.beta, "gamma": model.gamma, "offset": model.offset}
    shaped = {key: np.broadcast_to(value, (model.axes,)) for key, value in tables.items()}
    return [*(line for key, value in shaped.items() for line in table(f"{name}_{key}", value)), *_BOUC_WEN.format(name=name).splitlines()]


_BOUC_WEN = """static double {name}_relaxed(double start, double rate, double way, double lag)
{{
    const double gained = rate == 0.0 ? way : -expm1(-rate * way) / rate;
    return start * exp(-rate * way) + lag * gained;
}}
static double {name}_move(double *state, int axis, double value)
{{
    const double lag = {name}_lag[axis];
    const double slow = {name}_beta[axis] - {name}_gamma[axis], fast = {name}_beta[axis] + {name}_gamma[axis];
    const double sign = value < state[0] ? -1.0 : 1.0, way = fabs(value - state[0]);
    double g = sign * state[1], rest = way, before;
    if (way > 0.0) {{
        if (g < 0.0) {{
            before = slow == 0.0 ? -g / lag : log1p(-slow * g / lag) / slow;
            if (before >= way) {{
                g = {name}_relaxed(g, slow, way, lag);
                rest = -1.0;
            }} else {{
                g = 0.0;
                rest = way - before;
            }}
        }}
        if (rest >= 0.0) g = {name}_relaxed(g, fast, rest, lag);
        state[1] = sign * g;
    }}
    state[0] = value;
    return {name}_offset[axis] + ({name}_gain[axis] * value - state[1]);
}}"""
