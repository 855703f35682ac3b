"""Loop study: controller, stability, margins, static errors, noise, simulations, from one set-up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.analysis.linear_statics.lost_motion import LostMotion, lost_motion
from flexstage.analysis.loaded.load_effect import LoadEffect
from flexstage.analysis.loaded.operating_point import OperatingPoint
from flexstage.analysis.workspace.small import SecondOrder, second_order
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, Table, first_design
from flexstage.base.processes.threads import one_thread
from flexstage.base.record import INNER, VIEW
from flexstage.base.units.quantity import FREQUENCY, RATE
from flexstage.control.damping.charge import ChargedStacks
from flexstage.control.damping.damped_plant import ActiveDamping
from flexstage.control.noise import NoiseBudget, noise_budget
from flexstage.control.plant_models.plants import Plant
from flexstage.control.plant_models.retention import Retention
from flexstage.control.robustness.disk import DiskMargin, disk_margins
from flexstage.control.robustness.measured_margins import MeasuredMargins, coherence_findings, measured_margins
from flexstage.control.robustness.stability import Verdict, require_stable, verdict
from flexstage.control.robustness.stability_margins import (
    Bandwidths,
    Margins,
    Peaks,
    ShiftedPeak,
    bandwidths,
    crosstalk,
    margins,
    peaks,
    shifted_peaks,
)
from flexstage.control.simulation.result import Simulated
from flexstage.control.study.choices import Compensation, ControllerKind
from flexstage.control.study.control import Control
from flexstage.control.study.resolve import ResolvedSetup, on_test, resolve
from flexstage.control.study.rest import RestErrors, rest_errors
from flexstage.control.study.retained import control_and_modes, stated_modes_warnings
from flexstage.control.study.runs import RestRms, Run, rest_rms, runs, simulate_rest
from flexstage.control.study.setup import LoopSetup
from flexstage.control.study.stacks import Stacks, Sweep, stacks_of, sweep_stacks
from flexstage.control.systems.closed import Loop, LoopBreak, loop
from flexstage.control.systems.curves import Curves, curves
from flexstage.experiment.pipeline import Identification
from flexstage.experiment.progress import ProgressCallback, followed, part
from flexstage.mechanism.mechanism import Mechanism

_LOWEST = 0.1
_ENOUGH = 0.98
"""Sufficient fraction of the requested damping."""
_NO_LOOP = "the stage is commanded in open loop"
_NO_TEST = "no test record is available"
_NO_STROKES = "a force-driven stage has no lost motion: its stiffness determines the static pose"


@dataclass(frozen=True, eq=False)
class LoopStudy(InNotebook):
    """Loop study: a loop and all its results.

    `closed` is the loop with the retained modes of the plant (see `retention`). `growth_all_modes` [1/s] is the growth rate of the loop
    with all modes of the model; it is negative if the loop is stable. `margins`, `peaks`, `disk_margin` (all loops varied together),
    `bandwidths` and `curves` are computed for the loops opened at the pose. Without a closed loop, these results are absent (see
    `reasons`). `static_errors` are open-loop errors of the stage. `noise` is the noise budget in regulation; `still` is a simulation in
    regulation, if there is noise. If rounding is not white noise, the budget is invalid; `resting` then summarises several simulations.
    `stacks` are the hysteretic stacks, if specified; `hysteresis` is their open-loop sweep. `runs` are the simulated trajectories.
    `warnings` list assumptions and limitations.
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("a loop study", "fs.control.loop_study(stage)")
    settled: Annotated[ResolvedSetup, INNER]
    lost: Annotated[LostMotion | None, INNER]
    controller: Control
    closed: Annotated[Loop, INNER]
    stability: Verdict
    growth_all_modes: Annotated[float, RATE]
    retention: Retention
    margins: Margins | None
    peaks: Peaks | None
    bandwidths: Bandwidths | None
    curves: Annotated[Curves | None, INNER]
    crosstalk: Matrix
    disk_margin: DiskMargin | None
    static_errors: RestErrors | None
    noise: NoiseBudget
    still: Annotated[Simulated | None, INNER]
    resting: Annotated[RestRms | None, INNER]
    stacks: Annotated[Stacks | None, INNER]
    hysteresis: Sweep | None
    runs: tuple[Run, ...]
    warnings: Annotated[tuple[Finding, ...], INNER]
    reasons: Mapping[str, str]
    measured: MeasuredMargins | None = None

    @property
    def setup(self) -> Annotated[LoopSetup, VIEW]:
        """Keys of the set-up file with the specified values in SI units. A null value means that the stage determines the default."""
        return self.settled.setup

    @property
    def model_name(self) -> Annotated[str, VIEW]:
        """Name of the plant's model: an analytical model, or finite elements with their order."""
        return self.settled.model_name

    @property
    def plant(self) -> Annotated[Plant, VIEW]:
        """Plant with the retained modes."""
        return self.settled.plant

    @property
    def damping(self) -> Annotated[ActiveDamping | None, VIEW]:
        """Force feedback in the legs, included in the plant; null without force feedback."""
        return self.settled.damping

    @property
    def charge(self) -> Annotated[ChargedStacks | None, VIEW]:
        """Charge amplifiers, included in the plant; null for voltage drive."""
        return self.settled.charge

    @property
    def loaded(self) -> Annotated[LoadEffect | None, VIEW]:
        """Effect of the permanent load on the nominal stage; if it is significant, the plant is the loaded stage."""
        return self.settled.loaded

    @property
    def second_order(self) -> Annotated[SecondOrder | None, VIEW]:
        """Error of the linear kinematics along the simulated trajectories; null at an operating point, or if no part rotates or bends."""
        given = self.settled
        if given.displaced or not self.runs:
            return None
        most = np.max([np.max(np.abs(run.simulated.reference), axis=0, initial=0.0) for run in self.runs], axis=0)
        return second_order(given.mechanism, given.kinematics, dict(zip(given.plant.coordinates.names, most, strict=True)))

    @cached_property
    def shifted_peaks(self) -> Annotated[tuple[ShiftedPeak, ...], VIEW]:
        """Peak sensitivities with all modes shifted in frequency; empty in open loop."""
        return () if self.peaks is None else shifted_peaks(self.closed)

    @property
    def highest_platform_mode(self) -> Annotated[float, FREQUENCY]:
        """Frequency [Hz] of the n-th lowest platform mode, where n is the number of coordinates of the loop."""
        return self.settled.highest

    @property
    def simulated_rms(self) -> Annotated[Array | None, VIEW]:
        """Simulated rms (f,) of the true motion of each of f coordinates in regulation; null without noise."""
        if self.resting is not None:
            return self.resting.rms
        return None if self.still is None else np.sqrt(np.mean(self.still.true_error**2, axis=0))

    @property
    def simulated_interval(self) -> Annotated[tuple[Array, Array] | None, VIEW]:
        """95 % confidence limits (low, high) (f,) of the simulated rms, if rounding is not white; null otherwise."""
        return None if self.resting is None else (self.resting.low, self.resting.high)


@check_arguments
@one_thread
def loop_study(
    mechanism: Mechanism,
    setup: LoopSetup | None = None,
    *,
    there: OperatingPoint | None = None,
    solid: FeaModes | None = None,
    test: Identification | None = None,
    tell: ProgressCallback | None = None,
) -> LoopStudy:
    """Analyse the control loop of a stage for a set-up. Missing keys have default values.

    The plant is linearised at an operating point `there`, if specified. Without an operating point, the plant is the set-up's model of the
    stage, or the lumped model under permanent load if this load is significant. If `solid` is specified, the plant is the finite-element
    model of the nominal stage. If `test` is specified, the plant is the identified plant from strokes to gauges (`measured_plant`); the
    field `measured` then contains margins computed from the measured responses.

    Raises `DesignError` in the same cases as `resolve`, `make_controller` and `runs`. Also raises `DesignError` for an unstable loop; the
    error names the cause.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.study.setup import ControllerSetup
    >>> found = loop_study(parallelogram(), LoopSetup(controller=ControllerSetup(quick=True)))
    >>> found.stability.stable, found.runs[0].course.name
    (True, 'x')
    """
    said = tell or (lambda _, __: None)
    said("reading the stage", 0.0)
    given = resolve(mechanism, setup or LoopSetup(), there, solid)
    given = given if test is None else on_test(given, test.found)
    lost = None if given.kinematics.thrusts else lost_motion(given.kinematics, given.model)
    with followed(said), part(0.05, 0.6):
        given, control, retained = control_and_modes(given, pose_gains(given, lost))
    closed = loop(given.plant, control.system)
    require_stable(closed, "margins, noise and simulations")
    found, growth = verdict(closed), _whole_growth(given, control)
    rest = None if lost is None else rest_errors(given, lost)
    if rest is not None and Compensation.LOAD in given.setup.compensate:
        given = replace(given, carried=rest.load_strokes)
    stacks = None if given.setup.hysteresis is None else stacks_of(mechanism, given.setup.hysteresis)
    is_closed = setup is None or setup.controller.law is not ControllerKind.NONE
    said("simulating", 0.6)
    tested = runs(given, control, closed, stacks)
    measured = None if test is None or not is_closed else measured_margins(closed, test, given.predicted or given.plant)
    require(() if test is None or measured is None else coherence_findings(test, measured))
    said("noise", 0.8)
    motions = tuple(f"relative.{name}" for name in given.plant.coordinates.names)
    noise = noise_budget(closed, given.floor, (_LOWEST, 0.5 * given.rate), motions)
    still = simulate_rest(given, control, closed)
    resting = rest_rms(given, control, closed) if noise.slowly_rounding else None
    said("margins", 0.9)
    seen = curves(closed, LoopBreak.POSE) if is_closed else None
    return LoopStudy(
        settled=given,
        lost=lost,
        controller=control,
        closed=closed,
        stability=found,
        growth_all_modes=growth,
        margins=margins(closed, LoopBreak.POSE, seen) if is_closed else None,
        peaks=peaks(closed, LoopBreak.POSE) if is_closed else None,
        bandwidths=bandwidths(closed, seen) if is_closed else None,
        curves=seen,
        crosstalk=crosstalk(closed),
        disk_margin=disk_margins(closed, LoopBreak.POSE) if is_closed else None,
        static_errors=rest,
        noise=noise,
        still=still,
        resting=resting,
        stacks=stacks,
        hysteresis=None if stacks is None else sweep_stacks(stacks),
        runs=tested,
        retention=retained,
        warnings=(
            *stated_modes_warnings(given, control, closed, retained),
            *_warnings(given),
            *_slow_rounding(noise),
            *(each for run in tested for each in run.warnings),
        ),
        reasons=Table(_reasons(is_closed=is_closed, forced=lost is None, tested=test is not None)),
        measured=measured,
    )


@check_arguments
def sensitivity_crossover(mechanism: Mechanism) -> float | None:
    """Return the lowest sensitivity crossover [Hz] of all coordinates with the default controller; raises errors as `loop_study` does.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> 300.0 < sensitivity_crossover(parallelogram()) < 1000.0
    True
    """
    found = loop_study(mechanism).bandwidths
    return None if found is None else float(np.nanmin(found.rejection))


def _reasons(*, is_closed: bool, forced: bool, tested: bool) -> dict[str, str]:
    open_loop = {} if is_closed else dict.fromkeys(("margins", "peaks", "disk_margin", "bandwidths", "curves", "measured"), _NO_LOOP)
    open_loop |= {} if tested else {"measured": _NO_TEST}
    return open_loop | ({"static_errors": _NO_STROKES} if forced else {})


def pose_gains(given: ResolvedSetup, lost: LostMotion | None) -> Array:
    """Compute gains (n, f) from commanded poses to strokes or forces; strokes are corrected for lost motion if specified."""
    if lost is not None and Compensation.LOST_MOTION in given.setup.compensate:
        return np.real(first_design(np.asarray(lost.correction.values), 2))
    return given.plant.coordinates.strokes


def _whole_growth(given: ResolvedSetup, control: Control) -> float:
    """Growth rate with all modes; raises `DesignError` if an omitted mode makes the loop unstable."""
    whole = loop(given.whole, control.system)
    if whole.system.growth >= 0.0:
        what = verdict(whole).sentence
        raise refuse("modes", f"with all modes {what}", "Retain more modes, or reduce the bandwidth")
    return float(whole.system.growth)


def _slow_rounding(noise: NoiseBudget) -> Iterator[Finding]:
    """Warnings for rounding that is not white noise."""
    if noise.slowly_rounding:
        what = f"readings of {', '.join(noise.slowly_rounding)} change by less than half a step per sample, so rounding is not white noise"
        advice = "Use the simulated rms and its interval. With a finer resolution, or noise of half a step, rounding becomes white noise"
        yield Finding("gauges", what, advice)


def _warnings(given: ResolvedSetup) -> Iterator[Finding]:
    """Warnings for missing data that are assumed ideal."""
    silent = [name for name, each in given.plant.hardware.sensors.items() if each.noise_density is None]
    if silent:
        what = f"no noise specified for {', '.join(silent)}: only quantisation is included"
        yield Finding("gauges", what, "Specify noise_density in the design, or gauges.noise in the set-up")
    if given.damping is not None:
        yielding = given.damping
        worst = int(np.argmin(yielding.softest))
        what = f"force feedback reduces the platform's dynamic stiffness to {100.0 * yielding.softest[worst]:.3g} %"
        advice = "The pose loop must supply the missing stiffness. For more stiffness, increase damping.corner or reduce damping.ratio"
        yield Finding("damping", f"{what} along {yielding.coordinates[worst]}, at {yielding.softest_at[worst]:.3g} Hz", advice)
        asked = None if given.setup.damping is None else given.setup.damping.ratio
        if asked is not None and yielding.reached < _ENOUGH * asked:
            what = f"damping ratio of a dominant mode too low (got {100.0 * yielding.reached:.3g} %, expected {100.0 * asked:.3g} %)"
            advice = "Use shorter delays, faster amplifiers and sensors, or a higher rate. Legs cannot damp modes that do not strain them"
            yield Finding("damping.ratio", what, advice)
        quiet = [each.actuator for each in yielding.sensed if each.noise is None]
        if quiet:
            yield Finding("damping", f"no noise specified for the leg sensors of {', '.join(quiet)}", "Specify damping.noise")
    if given.setup.hysteresis is not None and given.charge is not None:
        left, corner = 100.0 * float(np.max(given.charge.residual_hysteresis)), float(np.max(given.charge.corners))
        what = f"above {corner:.3g} Hz, charge drive reduces the simulated hysteresis to {left:.3g} %; far below, the drive has no effect"
        advice = "Specify amplifier.residual_hysteresis from a record with charge drive. Results of isolated stacks are for voltage drive"
        yield Finding("hysteresis", what, advice)
    if given.setup.hysteresis is not None:
        what = "margins, noise and poles do not include hysteresis and creep of the stacks"
        yield Finding("hysteresis", what, "Use the simulated trajectories to judge these effects")
