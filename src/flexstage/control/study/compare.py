"""Comparison of controllers on one stage: performance, trade-offs, and the best controller for each quantity."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, ClassVar, TypeAlias

import numpy as np

from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.analysis.loaded.operating_point import OperatingPoint
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, Table
from flexstage.base.processes.jobs import Line
from flexstage.base.processes.pool import CallError, results
from flexstage.base.record import INNER, VIEW, Along, Heading, Layout, UnitIn
from flexstage.base.units.quantity import DISPLACEMENT, FREQUENCY, RATIO, SHORT_TIME, TIME
from flexstage.control.controllers.kinds import CONTROLLERS
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.noise import Kind, NoiseBudget
from flexstage.control.study.choices import SEARCHED, ControllerKind, OfferedKind
from flexstage.control.study.setup import ControllerSetup, DampingSetup, LoopSetup, StepMotion
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.control.tuning.judge import closed_growth
from flexstage.control.tuning.laws import PI_FAMILY
from flexstage.control.tuning.outcome import outcome
from flexstage.control.tuning.search import field
from flexstage.control.tuning.spec import TuningSpec
from flexstage.control.tuning.view import view
from flexstage.experiment.pipeline import Identification
from flexstage.experiment.progress import ProgressCallback
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism

_OWN = (ControllerKind.PI, ControllerKind.PID, ControllerKind.RESONANT, ControllerKind.LQG)
_SEEN = 0.75
"""Fraction of the step length after which settling counts as not reached: frequency lines end slow responses early."""
_TURNED = np.geomspace(1.0, 0.1, 9)
"""Output gains of a controller for the trade-off curve: a tenth is ten times slower, with low noise."""


CROSSOVER = Heading("sensitivity crossover", digits=4)
SETTLING_TIME = Heading("settling time (2 %)", digits=4, infinite="not settled")
OVERSHOOT = Heading("overshoot", digits=3, unit="%")


@dataclass(frozen=True, eq=False)
class DetunedController:
    """Controller with its output multiplied by `gains` (g,); gains of unstable loops are omitted.

    All values (g,) are computed without amplifier limits, and with rounding treated as white noise. `rejection` is the lowest sensitivity
    crossover and `delay_margin` the smallest delay margin of all loops. `settling` is the longest settling time (NaN: longer than the
    simulated step). `noise` is the rms error in regulation with rotations converted to lengths: the geometric mean over all loops (empty:
    no disturbance).
    """

    gains: Annotated[Array, RATIO]
    rejection: Annotated[Array, FREQUENCY]
    noise: Annotated[Array, DISPLACEMENT]
    settling: Annotated[Array, TIME]
    delay_margin: Annotated[Array, TIME]


@dataclass(frozen=True, eq=False)
class ComparedController:
    """Result of one controller for the loop's `coordinates`; `units` are the units of `noise`.

    `peak` is the peak sensitivity of the coupled loops, `rejection` the first frequency where a coordinate's sensitivity rises through 1,
    `noise` the rms error of a coordinate in regulation. `settling` is the 2 % settling time (infinite: not settled). `overshoot` is a
    fraction of the step. `delay_margin` is the smallest delay margin of all loops. `gauge_share` is the largest fraction of a coordinate's
    mean-square noise that gauge noise and quantisation cause (absent: no disturbance). `tuned` describes the tuning, `detuned` is the same
    controller with reduced gain. `noise` assumes that rounding errors are white noise; `slowly_rounding` names the gauges for which this is
    wrong. `warnings` are those of the loop study.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Comparison of controllers",
        "crossover worst_noise slowest_settling largest_overshoot delay_margin peak gauge_share",
        head="controller",
        notes=(
            "Values are those of the worst coordinate. Noise of the gauges: fraction of mean-square noise from gauges and quantisation.",
            "{self.tuned}.",
        ),
    )

    coordinates: tuple[str, ...]
    units: tuple[str, ...]
    tuned: str
    peak: Annotated[float, Heading("peak sensitivity Ms", digits=4)]
    rejection: Annotated[Array, FREQUENCY, Along("coordinates"), CROSSOVER]
    noise: Annotated[Array, Along("coordinates"), UnitIn("units"), Heading("positioning noise", digits=3)]
    settling: Annotated[Array, SHORT_TIME, Along("coordinates"), SETTLING_TIME]
    overshoot: Annotated[Array, Along("coordinates"), OVERSHOOT]
    delay_margin: Annotated[float, SHORT_TIME, Heading(digits=4)]
    gauge_share: Annotated[float | None, Heading("noise of the gauges", digits=2, unit="%")]
    detuned: DetunedController | None = None
    slowly_rounding: tuple[str, ...] = ()
    warnings: Annotated[tuple[Finding, ...], INNER] = ()

    @property
    def crossover(self) -> Annotated[float, FREQUENCY, INNER, CROSSOVER]:
        """Lowest sensitivity crossover."""
        return float(np.min(self.rejection))

    @property
    def worst_noise(self) -> Annotated[tuple[str, ...], INNER, Heading("positioning noise")]:
        """Largest rms noise of a translation, and largest rms noise of a rotation."""
        largest = {unit: max(value for value, own in zip(self.noise, self.units, strict=True) if own == unit) for unit in self.units}
        return tuple(f"{1e9 * value:.3g} n{unit}" for unit, value in largest.items())

    @property
    def slowest_settling(self) -> Annotated[float, SHORT_TIME, INNER, SETTLING_TIME]:
        """Longest settling time."""
        return float(np.max(self.settling))

    @property
    def largest_overshoot(self) -> Annotated[float, INNER, OVERSHOOT]:
        """Largest overshoot."""
        return float(np.max(self.overshoot))

    @property
    def figures(self) -> Mapping[str, float]:
        """Values by criterion (smaller is better) of the worst coordinate; for noise (if any), the mean logarithm over all coordinates."""
        return {
            "rejection": -self.crossover,
            **({"noise": float(np.mean(np.log(self.noise)))} if np.all(self.noise > 0.0) else {}),
            "settling": self.slowest_settling,
            "overshoot": self.largest_overshoot,
            "delay margin": -self.delay_margin,
            "peak of S": self.peak,
        }


@dataclass(frozen=True, eq=False)
class Comparison(InNotebook):
    """Controllers by name, for the same stage, sampling, floor and gauges. `reasons` explain the failed designs by name."""

    controllers: Mapping[str, ComparedController]
    reasons: Mapping[str, str]

    @property
    def wins(self) -> Annotated[Mapping[str, str], VIEW]:
        """Best controller for each quantity; quantities without a value are omitted."""
        every = {name: each.figures for name, each in self.controllers.items()}
        aims = dict.fromkeys(aim for figures in every.values() for aim in figures)
        return {aim: min((name for name in every if aim in every[name]), key=lambda name: every[name][aim]) for aim in aims}

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings common to all controllers."""
        every = [each.warnings for each in self.controllers.values()]
        return tuple(each for each in dict.fromkeys(every[0] if every else ()) if all(each in others for others in every))

    @property
    def front(self) -> Annotated[tuple[str, ...], VIEW]:
        """Pareto front: controllers not dominated in rejection, noise, settling and delay margin."""
        points = {name: [each.figures.get(aim, 0.0) for aim in _TRADED] for name, each in self.controllers.items()}
        return tuple(name for name, own in points.items() if not any(_beats(other, own) for other in points.values()))


_TRADED = ("rejection", "noise", "settling", "delay margin")


def _beats(one: list[float], other: list[float]) -> bool:
    return all(a <= b for a, b in zip(one, other, strict=True)) and one != other


@check_arguments
def compare_controllers(
    mechanism: Mechanism,
    setup: LoopSetup | None = None,
    *,
    there: OperatingPoint | None = None,
    solid: FeaModes | None = None,
    test: Identification | None = None,
    tell: ProgressCallback | None = None,
    workers: int = 0,
) -> Comparison:
    """Tune one controller of each kind for the same set-up, and compare their step responses.

    The kinds are PI, PID, integral resonant control, LQG, and the entries of the register `CONTROLLERS`. PI and PID are optimised, unless
    the set-up disables optimisation; LQG is optimised only for a specified goal. All other kinds are tuned to the highest bandwidth within
    the same limit on the peak of the sensitivity. `workers` is the number of parallel processes (0: the calling process); the results do
    not depend on it. Raises `DesignError` if no design succeeds. A kind fails if the set-up specifies gains that this kind does not have.
    """
    asked = replace(setup or LoopSetup(), trajectory=StepMotion())
    rivals = _rivals(mechanism, asked, tested=test is not None)
    one = partial(_rival_of, partial(loop_study, mechanism, there=there, solid=solid, test=test))
    came: dict[str, _Came] = {}
    said = tell or (lambda _, __: None)
    said(f"tuning {', '.join(rivals)}", 0.0)
    for name, found in _every(one, rivals, workers):
        came[name] = found
        left = ", ".join(each for each in rivals if each not in came)
        said(f"tuning {left}" if left else "tuned", len(came) / len(rivals))
    found = {name: each for name in rivals if isinstance(each := came[name], ComparedController)}
    missed = {name: each for name in rivals if not isinstance(each := came[name], ComparedController)}
    if not found:
        raise DesignError(list(missed.values())[-1])
    return Comparison(Table(found), Table({name: "; ".join(map(str, findings)) for name, findings in missed.items()}))


_Came: TypeAlias = "ComparedController | tuple[Finding, ...]"


def _every(
    one: Callable[[Line | None, str, LoopSetup], _Came], rivals: Mapping[str, LoopSetup], workers: int
) -> Iterator[tuple[str, _Came]]:
    """Results of all kinds, as completed; optimised kinds first, because they take longest."""
    slowest = sorted(rivals, key=lambda name: rivals[name].controller.kind not in SEARCHED)
    if not workers:
        yield from ((name, one(None, name, rivals[name])) for name in slowest)
        return
    try:
        for (name, _), found in results(one, [(name, rivals[name]) for name in slowest], min(workers, len(rivals))):
            yield name, found
    except CallError as failed:
        if failed.error is not None:
            raise failed.error from None
        what = "processes terminated repeatedly"
        raise refuse(f"controller {failed.arguments[0]}", what, "Free memory, and run the command again") from None


def _rival_of(study: Callable[[LoopSetup], LoopStudy], _line: Line | None, _name: str, asked: LoopSetup) -> _Came:
    """Result of a kind, or the findings of its failure."""
    try:
        return rival(study(asked))
    except DesignError as error:
        return tuple(error.findings)


def _rivals(mechanism: Mechanism, asked: LoopSetup, *, tested: bool) -> dict[str, LoopSetup]:
    """Set-ups with each kind of controller, and PI with force feedback in the legs of stacks."""
    kinds = (*_OWN, *map(OfferedKind, CONTROLLERS))
    found = {kind.value: replace(asked, controller=_of_kind(asked, kind)) for kind in kinds}
    if asked.damping is None and not tested and expand(mechanism).strokes:
        found[f"{ControllerKind.PI.value}, damped"] = replace(found[ControllerKind.PI.value], damping=DampingSetup())
    return found


def _of_kind(asked: LoopSetup, kind: ControllerKind | OfferedKind) -> ControllerSetup:
    goal = asked.controller.goal if kind in SEARCHED else None
    if kind is ControllerKind.LQG and goal is not None:
        goal = replace(goal, prefilter=False)
    notches = () if kind is ControllerKind.LQG else asked.controller.notches
    return replace(asked.controller, kind=kind, goal=goal, notches=notches)


def rival(study: LoopStudy) -> ComparedController:
    """Summarise the study of a closed loop for a comparison; the study must contain steps of all coordinates."""
    names = study.plant.coordinates.names
    steps = {run.course.moved[0]: run.step for run in study.runs if run.step is not None}
    if study.peaks is None or study.bandwidths is None or study.margins is None:
        raise refuse("controller", "the loop is open", "Use a controller kind other than none")
    settling = np.array([steps[name].settling for name in names])
    return ComparedController(
        coordinates=names,
        units=study.noise.units,
        tuned=study.controller.tuned or "",
        peak=study.peaks.sensitivity.value,
        rejection=study.bandwidths.rejection,
        noise=study.noise.rms,
        settling=settling,
        overshoot=np.array([steps[name].overshoot for name in names]),
        delay_margin=min(each.delay.value for each in study.margins.channels),
        gauge_share=_gauge_share(study.noise),
        detuned=_detuned(study, float(np.max(settling))),
        slowly_rounding=study.noise.slowly_rounding,
        warnings=study.warnings,
    )


def _detuned(study: LoopStudy, settling: float) -> DetunedController:
    """Same controller with less gain; at full gain the `settling` [s] is known, of any length."""
    loops = platform_loops(study.plant.coordinates)
    seen = view(study.plant, loops, 0.0)
    within = field(seen, TuningSpec(PI_FAMILY, spread=0.0, floor=study.settled.floor))
    control = study.controller.system
    quieter = ((gain, replace(control, C=gain * control.C, D=gain * control.D)) for gain in _TURNED)
    stable = [gain for gain, system in quieter if closed_growth(seen.systems[0], system) < 0.0]
    found = [outcome(within, control, gain) for gain in stable]
    noises, settled = (np.array(each) for each in ([one.noise for one in found], [np.max(one.settling) for one in found]))
    settled = np.where(settled < _SEEN * (len(within.lines) - 1) / float(within.lines[-1]), settled, np.nan)
    settled = np.where(np.isnan(settled) & (np.array(stable) == 1.0), settling, settled)
    return DetunedController(
        gains=np.array(stable),
        rejection=np.array([np.min(each.rejection[0]) for each in found]),
        noise=np.exp(np.mean(np.log(noises), axis=1)) if found and np.all(noises > 0.0) else np.zeros(0),
        settling=settled,
        delay_margin=np.array([np.min(each.delay_margin) for each in found]),
    )


def _gauge_share(noise: NoiseBudget) -> float | None:
    total = np.sum(noise.squares, axis=1)
    if not np.all(total > 0.0):
        return None
    heard = [source.kind in (Kind.GAUGE, Kind.ROUNDING) for source in noise.sources]
    return float(np.max(np.sum(noise.squares[:, heard], axis=1) / total))
