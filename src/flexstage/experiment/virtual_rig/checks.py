"""Checks of a virtual test: of its set-up, and of its plan with known rms values."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.analysis.complete import platform_modes
from flexstage.base.finding import Finding, suggest_nearest
from flexstage.experiment.virtual_rig.chain import Chain
from flexstage.experiment.virtual_rig.inputs import RECORDED_UNITS, InputQuantity
from flexstage.experiment.virtual_rig.plan import TAPER, DrivenInput, Plan, drivable_actuators
from flexstage.experiment.virtual_rig.setup import RigSetup
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import number_findings
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel

_PEAK = 6.0
"""Peak over rms of Gaussian noise: exceeded twice in 1e9 samples."""
_FEWEST = 16
_HIGHEST_ORDER = 20
_MOST = 2**40


def setup_findings(mechanism: Mechanism, model: LinearModel, setup: RigSetup) -> Iterator[Finding]:
    """Find all errors in the numbers and names of a set-up.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> stage = double_triangle()
    >>> [str(each) for each in setup_findings(stage, mapped(stage), RigSetup(seconds=0.0))]
    ['seconds: must be greater than 0 s (got 0 s). Use e.g. "0.1 s".']
    """
    if model.stiffness_matrix.ndim > 2:
        yield Finding("stage", "it is a batch of several designs", "Test one design at a time")
        return
    for address, value, node in node_of(RigSetup).numbers(setup):
        yield from number_findings(address, value, node)
    yield from _clock_findings(mechanism, model, setup)
    yield from _channel_findings(mechanism, model, setup)
    drive, amplifier, order = setup.drive, setup.amplifier, setup.filter.order
    if len(drive.amounts) > 1:
        named = " and as a ".join(each.value for each in drive.amounts)
        yield Finding("drive", f"its rms is specified as a {named}", "Remove one of them")
    if drive.band is not None and not drive.band[0] < drive.band[1]:
        yield Finding("band", f"invalid band (got {drive.band[0]:g} Hz to {drive.band[1]:g} Hz)", "Use 0 <= low < high in Hz")
    if amplifier.bandwidth is not None and amplifier.resistance is not None:
        yield Finding(
            "amplifier", "both its bandwidth and its resistance are specified", "Specify only one of them: it determines the other"
        )
    if not 0 <= order <= _HIGHEST_ORDER:
        yield Finding("filter", f"wrong order (got {order})", f"Use an order from 0 (no filter) to {_HIGHEST_ORDER}")


def _clock_findings(mechanism: Mechanism, model: LinearModel, setup: RigSetup) -> Iterator[Finding]:
    if setup.seed < 0:
        yield Finding("seed", f"it is negative (got {setup.seed})", "Use a whole number of 0 or more")
    highest = platform_modes(mechanism, model).highest
    top = np.inf if setup.drive.band is None else (1.0 + TAPER) * setup.drive.band[1]
    if setup.rate is not None and 0.0 < setup.rate < 2.0 * min(highest, top):
        what = f"the sampling rate of {setup.rate:g} Hz is below twice the frequency of the highest platform mode, {highest:.4g} Hz"
        faster = f"Sample at {2.0 * highest:.4g} Hz at least, better at {10.0 * highest:.0f} Hz"
        yield Finding("rate", what, f"{faster}, or drive in a band up to {0.4 * setup.rate:g} Hz")


def _channel_findings(mechanism: Mechanism, model: LinearModel, setup: RigSetup) -> Iterator[Finding]:
    known = drivable_actuators(mechanism, model)
    asked = setup.drive.actuators
    if not known:
        yield Finding("actuators", "the stage has no piezo stack or force actuator to be driven", "Add one to the design")
    elif asked is not None and not asked:
        yield Finding("actuators", "no actuator is selected", f"Name at least one: {', '.join(known)}")
    for name in dict.fromkeys(asked or ()):
        if name not in known:
            yield Finding(f"actuator {name}", "unknown actuator", suggest_nearest(name, known))
        elif asked is not None and asked.count(name) > 1:
            yield Finding(f"actuator {name}", f"it is named {asked.count(name)} times", "Name it once")
    if not expand(mechanism).gauges:
        yield Finding("gauges", "the stage has no gauge to record", "Specify gauges in the design")


def plan_findings(plan: Plan) -> Iterator[Finding]:
    """Find actuators whose data do not suffice for the plan, and a wrong number of samples.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.experiment.virtual_rig.plan import plan_test
    >>> stage = double_triangle()
    >>> list(plan_findings(plan_test(stage, mapped(stage), RigSetup(seconds=1.0, input_quantity=InputQuantity.VOLTAGE))))
    []
    """
    setup = plan.setup
    for name, each in zip(plan.actuators, plan.inputs, strict=True):
        yield from (_stack_findings if each.own is InputQuantity.STROKE else _thrust_findings)(name, each, setup)
    if not _FEWEST <= plan.length < _MOST:
        what = f"wrong number of samples (got {plan.length:.3g}: {setup.seconds:g} s at {plan.rate:g} Hz)"
        yield Finding("seconds", what, f"Record between {_FEWEST} and {_MOST:.2g} samples")


def _stack_findings(name: str, driven: DrivenInput, setup: RigSetup) -> Iterator[Finding]:
    requested = {*setup.drive.amounts, setup.input_quantity} - {None}
    if requested - {InputQuantity.STROKE, InputQuantity.VOLTAGE}:
        yield Finding(name, "the input of its stack is a stroke or a voltage", 'Use one of these, for example --drive-rms "1 um"')
    if np.isnan(driven.factor(InputQuantity.VOLTAGE)) and (InputQuantity.VOLTAGE in requested or setup.amplifier.current is not None):
        yield Finding(name, "its stack has no voltage range", "Specify voltage_low and voltage_high, or use strokes")
    if np.isnan(driven.capacitance) and (setup.amplifier.resistance is not None or setup.amplifier.current is not None):
        yield Finding(name, "its stack has no capacitance", "Specify it, or specify the amplifier's bandwidth in Hz")


def _thrust_findings(name: str, driven: DrivenInput, setup: RigSetup) -> Iterator[Finding]:
    own = " or ".join(dict.fromkeys((driven.own.value, *(each.value for each in driven.factors))))
    example = f"1 {RECORDED_UNITS[driven.own]}"
    for quantity in filter(None, dict.fromkeys((*setup.drive.amounts, setup.input_quantity))):
        if np.isnan(driven.factor(quantity)):
            yield Finding(name, f"its input is a {own}, not a {quantity.value}", f'Use {own}, for example --drive-rms "{example}"')
    if not setup.drive.amounts and np.isnan(driven.full):
        yield Finding(name, "its sustained limit is unknown, so there is no default drive", f'Use for example --drive-rms "{example}"')
    if setup.amplifier.resistance is not None:
        yield Finding(name, "an output resistance requires the capacitance of a stack", "Specify the amplifier's bandwidth in Hz")


def range_findings(plan: Plan, chain: Chain) -> Iterator[Finding]:
    """Find signals whose peaks (six times rms) exceed a stroke, an amplifier's current or a gauge's range, or are below all resolutions.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.experiment.virtual_rig.chain import chain
    >>> from flexstage.experiment.virtual_rig.plan import plan_test
    >>> from flexstage.experiment.virtual_rig.setup import NoiseDrive
    >>> stage = double_triangle()
    >>> model = mapped(stage)
    >>> plan = plan_test(stage, model, RigSetup(seconds=1.0, drive=NoiseDrive(stroke=20e-6, actuators=("B1",))))
    >>> print(next(range_findings(plan, chain(model, plan, model.damping))))
    B1: peaks of 6 x 20 um rms exceed the stroke of -75 um to 75 um. Drive with 12.5 um rms at most.
    """
    limit = plan.setup.amplifier.current
    for name, driven, rms, rate in zip(plan.actuators, plan.inputs, plan.rms, chain.stroke_rate_rms, strict=True):
        scale = 1e6 if driven.own is InputQuantity.STROKE else 1.0
        unit, low, high = RECORDED_UNITS[driven.own], scale * driven.low, scale * driven.high
        if _PEAK * scale * rms > min(-low, high):
            what = f"peaks of 6 x {scale * rms:.4g} {unit} rms exceed the {driven.own.value} of {low:.4g} {unit} to {high:.4g} {unit}"
            yield Finding(name, what, f"Drive with {min(-low, high) / _PEAK:.4g} {unit} rms at most")
        if rms > driven.sustained:
            yield Finding(name, f"{rms:.4g} {unit} rms exceed the sustained limit of {driven.sustained:.4g} {unit}", "Reduce the drive")
        current = {InputQuantity.STROKE: driven.capacitance * driven.factor(InputQuantity.VOLTAGE) * rate, InputQuantity.CURRENT: rms}
        if limit is not None and _PEAK * (drawn := current.get(driven.own, 0.0)) > limit:
            what = f"peaks of 6 x {drawn:.4g} A rms exceed the amplifier's limit of {limit:.4g} A"
            yield Finding(name, what, "Reduce the drive or its band, or use a stronger amplifier")
    yield from _gauge_findings(plan, chain)


def _gauge_findings(plan: Plan, chain: Chain) -> Iterator[Finding]:
    seen = np.hypot(chain.output_rms, plan.walks * np.sqrt(plan.length / plan.rate / 60.0))
    for name, unit, rms, span in zip(plan.gauges, plan.units, seen, plan.ranges, strict=True):
        if _PEAK * rms > 0.5 * span:
            what = f"peaks of 6 x {1e6 * rms:.4g} u{unit} rms exceed half of its range, {1e6 * span:.4g} u{unit}"
            yield Finding(name, what, "Reduce the drive or the drift, or use a gauge of larger range")
    if np.all(_PEAK * seen < 0.5 * plan.steps):
        best = int(np.argmin(plan.steps / np.maximum(seen, 1e-300)))
        unit, also = plan.units[best], "as at all other gauges"
        what = f"peaks of 6 x {1e6 * seen[best]:.4g} u{unit} rms are below half of a step, {1e6 * plan.steps[best]:.4g} u{unit}, {also}"
        yield Finding(plan.gauges[best], what, "Increase the drive, or use gauges of finer resolution: all readings would be constant")
