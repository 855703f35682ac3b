"""Virtual test rig: simulated record of a stage with any elastic model as the plant."""

from __future__ import annotations

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import require
from flexstage.experiment.records.record import Channel, Record, Role
from flexstage.experiment.virtual_rig.chain import chain
from flexstage.experiment.virtual_rig.checks import plan_findings, range_findings, setup_findings
from flexstage.experiment.virtual_rig.inputs import RECORDED_UNITS, InputQuantity
from flexstage.experiment.virtual_rig.plan import plan_test
from flexstage.experiment.virtual_rig.samples import Simulated
from flexstage.experiment.virtual_rig.setup import RigSetup
from flexstage.mechanism.mechanism import Damping, Mechanism
from flexstage.models.linear.damping import damping_law
from flexstage.models.linear.model import LinearModel

_MICROMETRE = 1e6


@check_arguments
def rig(mechanism: Mechanism, model: LinearModel, setup: RigSetup, *, damping: Damping | None = None) -> Record:
    """Simulate the record of a test: its inputs are strokes, voltages, currents or forces, and its outputs are gauge readings.

    `model` is any elastic model of the mechanism (lumped, mapped, solid); `damping` replaces the model's damping. The drive of each
    actuator is band-limited Gaussian noise, filtered by the amplifier's lag 1/(1 + j f/f_a) with the corner frequency f_a. Each gauge adds
    noise to the stage's motion. The sum passes through the gauge's lag and the anti-alias filter. Then drift is added, and the signal is
    quantised. The record starts in the steady state. Strokes are the stacks' free strokes, relative to the stroke at the bias voltage. The
    stage is linear; its response to the continuous-time noise is computed without discretisation error. Structural damping is converted to
    equivalent modal damping ratios, with a note in the record's name. Samples are computed on demand, in blocks; equal set-ups give equal
    samples.

    Raises `DesignError` with all errors. Examples are an invalid duration, a rate below twice the frequency of the highest platform mode,
    unknown actuators, missing gauges, and peaks that exceed strokes, currents or gauge ranges.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.experiment.virtual_rig.setup import RigSetup
    >>> stage = double_triangle()
    >>> record = rig(stage, mapped(stage), RigSetup(seconds=4.0, rate=1024.0))
    >>> record.length, [f"{each.name} {each.unit}" for each in record.channels][:2], [each.name for each in record.outputs][:2]
    (4096, ['B1 um', 'B2 um'], ['S1', 'S2'])
    """
    return as_record(simulate_test(mechanism, model, setup, damping=damping))


def simulate_test(mechanism: Mechanism, model: LinearModel, setup: RigSetup, *, damping: Damping | None = None) -> Simulated:
    """Prepare a virtual test: plan, measuring chain with expected rms values, and samples. Raises `DesignError` as `rig` does.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> stage = double_triangle()
    >>> simulate_test(stage, mapped(stage), RigSetup(seconds=1.0)).plan.band
    (0.0, 819.2)
    """
    require(setup_findings(mechanism, model, setup))
    law = damping_law(model, damping)
    plan = plan_test(mechanism, model, setup)
    require(plan_findings(plan))
    found = chain(model, plan, law)
    require(range_findings(plan, found))
    recorded = zip(plan.inputs, plan.recorded, strict=True)
    scale = np.array([_MICROMETRE if quantity is InputQuantity.STROKE else each.factor(quantity) for each, quantity in recorded])
    source = f"seed {setup.seed}; {found.note}; {mechanism.name or 'stage'}; {model.provenance}"  # truncated by formats: key data first
    return Simulated(plan, found, scale, _MICROMETRE, source)


def as_record(test: Simulated) -> Record:
    """Convert a simulated test to a record.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> stage = double_triangle()
    >>> as_record(simulate_test(stage, mapped(stage), RigSetup(seconds=1.0))).name.partition("; ")[0]
    'rig: seed 0'
    """
    plan = test.plan
    inputs = (Channel(name, RECORDED_UNITS[each], Role.INPUT) for name, each in zip(plan.actuators, plan.recorded, strict=True))
    outputs = (Channel(name, f"u{read}", Role.OUTPUT) for name, read in zip(plan.gauges, plan.units, strict=True))
    return Record((*inputs, *outputs), plan.rate, test, name=f"rig: {test.source}", source="virtual test rig")
