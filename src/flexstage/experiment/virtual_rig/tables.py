"""Table of a virtual test."""

from __future__ import annotations

from flexstage.experiment.virtual_rig.inputs import RECORDED_UNITS, InputQuantity
from flexstage.experiment.virtual_rig.samples import Simulated
from flexstage.show.display import format_value, number
from flexstage.show.table import Cell, Mark, Table, make_table


def rig_table(test: Simulated) -> Table:
    """Tabulate the channels of a virtual test with their units, expected rms values, and quantisation steps of the gauges.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.experiment.virtual_rig.rig import simulate_test
    >>> from flexstage.experiment.virtual_rig.setup import RigSetup
    >>> stage = double_triangle()
    >>> rig_table(simulate_test(stage, mapped(stage), RigSetup(seconds=1.0))).texts()[-1]
    ['S6', 'output', 'um', '19.53 um', '10 nm']
    """
    plan = test.plan
    driven = [
        (Cell(name, Mark.STRONG), "input", RECORDED_UNITS[quantity], _rms(rms, scale, quantity), "")
        for name, quantity, rms, scale in zip(plan.actuators, plan.recorded, test.chain.input_rms, test.input_scale, strict=True)
    ]
    read = [
        (Cell(name, Mark.STRONG), "output", f"u{read}", format_value(rms, read, 4), f"{1e9 * step:.4g} n{read}" if step else "")
        for name, read, rms, step in zip(plan.gauges, plan.units, test.chain.output_rms, plan.steps, strict=True)
    ]
    clock = f"{test.length} samples at {number(plan.rate, 6)} Hz"
    noise = f"expected rms without drift; noise from {number(plan.band[0], 4)} to {number(plan.band[1], 4)} Hz"
    slowest = min(*plan.bandwidths, *plan.lags)
    lag = f"; lowest bandwidth of amplifiers and gauges {number(slowest, 4)} Hz" if slowest < float("inf") else ""
    note = f"{clock}; {noise}{lag}; highest platform mode {number(plan.highest, 4)} Hz. {test.chain.note[0].upper()}{test.chain.note[1:]}."
    return make_table(
        "Virtual test", ["channel", "role", "unit", "expected rms", "step"], [*driven, *read], notes=[note], provenance=test.source
    )


def _rms(rms: float, scale: float, quantity: InputQuantity) -> str:
    own = quantity is InputQuantity.STROKE
    return format_value(rms if own else rms * scale, "m" if own else RECORDED_UNITS[quantity], 4)
