"""Controllers of one stage side by side: what each reaches, what it costs, and which wins for what."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexstage.analysis.stance import Stance
from flexstage.base.finding import DesignError, refuse
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, Table
from flexstage.base.quantity import FREQUENCY, TIME
from flexstage.base.record import VIEW, Along
from flexstage.control.controllers.kinds import CONTROLLERS
from flexstage.control.noise import Kind, NoiseBudget
from flexstage.control.study.choices import ControllerKind, OfferedKind
from flexstage.control.study.setup import ControllerSetup, DampingSetup, LoopSetup, StepMotion
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.experiment.pipeline import Identification, Told
from flexstage.mechanism.expand import expand
from flexstage.mechanism.mechanism import Mechanism

_OWN = (ControllerKind.PI, ControllerKind.PID, ControllerKind.RESONANT, ControllerKind.LQG)
_SEARCHED = (ControllerKind.PI, ControllerKind.PID)


@dataclass(frozen=True, eq=False)
class Rival:
    """What one controller comes to, by the loop's `coordinates`, whose `units` those of noise are.

    `peak` is the coupled peak of S, `rejection` where |S| first rises through 1, `noise` the rms at rest, `settling` the time
    to 2 % of a step (infinite: it does not settle), `overshoot` a share of the step, `delay_margin` the least of the loops, `gauge_share`
    the largest share of the gauges' noise and steps in a mean square (absent: nothing disturbs). `tuned` says how it was found.
    """

    coordinates: tuple[str, ...]
    units: tuple[str, ...]
    tuned: str
    peak: float
    rejection: Annotated[Array, FREQUENCY, Along("coordinates")]
    noise: Annotated[Array, Along("coordinates")]
    settling: Annotated[Array, TIME, Along("coordinates")]
    overshoot: Annotated[Array, Along("coordinates")]
    delay_margin: Annotated[float, TIME]
    gauge_share: float | None

    @property
    def figures(self) -> Mapping[str, float]:
        """What counts, each such that less is better: the worst of all coordinates; noise as the mean of logarithms, absent of none."""
        return {
            "rejection": -float(np.min(self.rejection)),
            **({"noise": float(np.mean(np.log(self.noise)))} if np.all(self.noise > 0.0) else {}),
            "settling": float(np.max(self.settling)),
            "overshoot": float(np.max(self.overshoot)),
            "delay margin": -self.delay_margin,
            "peak of S": self.peak,
        }


@dataclass(frozen=True, eq=False)
class Comparison(InNotebook):
    """Controllers by name, on the same stage, clock, floor and gauges; those that could not be had have their `reasons`."""

    controllers: Mapping[str, Rival]
    reasons: Mapping[str, str]

    @property
    def wins(self) -> Annotated[Mapping[str, str], VIEW]:
        """Which controller is best at what; what none has is left out."""
        every = {name: each.figures for name, each in self.controllers.items()}
        aims = dict.fromkeys(aim for figures in every.values() for aim in figures)
        return {aim: min((name for name in every if aim in every[name]), key=lambda name: every[name][aim]) for aim in aims}

    @property
    def front(self) -> Annotated[tuple[str, ...], VIEW]:
        """Controllers that no other beats in rejection, noise, settling and delay margin at once."""
        points = {name: [each.figures.get(aim, 0.0) for aim in _TRADED] for name, each in self.controllers.items()}
        return tuple(name for name, own in points.items() if not any(_beats(other, own) for other in points.values()))


_TRADED = ("rejection", "noise", "settling", "delay margin")


def _beats(one: list[float], other: list[float]) -> bool:
    return all(a <= b for a, b in zip(one, other, strict=True)) and one != other


def compare_controllers(
    mechanism: Mechanism,
    setup: LoopSetup | None = None,
    *,
    there: Stance | None = None,
    test: Identification | None = None,
    tell: Told | None = None,
) -> Comparison:
    """PI, PID, integral resonant control, LQG and the kinds of `CONTROLLERS`: each tuned to the same set-up, and what steps come to.

    With a goal PI and PID are searched for; the others are tuned to the highest bandwidth within the same peak of S. Raises `DesignError`
    where none of them can be had, or where the set-up states gains, which belong to one kind.
    """
    asked = replace(setup or LoopSetup(), trajectory=StepMotion())
    found: dict[str, Rival] = {}
    missed: dict[str, str] = {}
    last: DesignError | None = None
    rivals = _rivals(mechanism, asked, tested=test is not None)
    for number, (name, one) in enumerate(rivals.items()):
        if tell is not None:
            tell(f"tuning {name}", number / len(rivals))
        try:
            found[name] = rival(loop_study(mechanism, one, there=there, test=test))
        except DesignError as error:
            missed[name], last = "; ".join(str(each) for each in error.findings), error
    if last is not None and not found:
        raise last
    return Comparison(Table(found), Table(missed))


def _rivals(mechanism: Mechanism, asked: LoopSetup, *, tested: bool) -> dict[str, LoopSetup]:
    """The set-up with each kind of controller, and PI on legs that force feedback damps, where stacks are in them."""
    kinds = (*_OWN, *map(OfferedKind, CONTROLLERS))
    found = {kind.value: replace(asked, controller=_of_kind(asked, kind)) for kind in kinds}
    if asked.damping is None and not tested and expand(mechanism).strokes:
        found[f"{ControllerKind.PI.value}, damped"] = replace(found[ControllerKind.PI.value], damping=DampingSetup())
    return found


def _of_kind(asked: LoopSetup, kind: ControllerKind | OfferedKind) -> ControllerSetup:
    goal = asked.controller.goal if kind in _SEARCHED else None
    notches = () if kind is ControllerKind.LQG else asked.controller.notches
    return replace(asked.controller, kind=kind, goal=goal, notches=notches)


def rival(study: LoopStudy) -> Rival:
    """What a closed loop, simulated in steps of all its motions, comes to."""
    names = study.plant.coordinates.names
    steps = {run.course.moved[0]: run.step for run in study.runs if run.step is not None}
    if study.peaks is None or study.bandwidths is None or study.margins is None:
        raise refuse("controller", "the loop is open", "Compare controllers that close it")
    return Rival(
        coordinates=names,
        units=study.noise.units,
        tuned=study.controller.tuned or "",
        peak=study.peaks.sensitivity.value,
        rejection=study.bandwidths.rejection,
        noise=study.noise.rms,
        settling=np.array([steps[name].settling for name in names]),
        overshoot=np.array([steps[name].overshoot for name in names]),
        delay_margin=min(each.delay.value for each in study.margins.channels),
        gauge_share=_gauge_share(study.noise),
    )


def _gauge_share(noise: NoiseBudget) -> float | None:
    total = np.sum(noise.squares, axis=1)
    if not np.all(total > 0.0):
        return None
    heard = [source.kind in (Kind.GAUGE, Kind.ROUNDING) for source in noise.sources]
    return float(np.max(np.sum(noise.squares[:, heard], axis=1) / total))
