"""Controller of a set-up: tuned to its specification, or with specified gains."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.complete import platform_modes
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Heading, Layout
from flexstage.base.units.quantity import FREQUENCY
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.kinds import CONTROLLERS
from flexstage.control.controllers.law import Law
from flexstage.control.controllers.loops import Loops, actuator_loops, loop_modes, modal_loops, platform_loops
from flexstage.control.controllers.lqg import LQG, Disturbances
from flexstage.control.controllers.notch import Notch, notch_of_mode
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.prefilter import Prefilter
from flexstage.control.study.choices import Axes, Compensation, ControllerKind, Notching
from flexstage.control.study.resolve import ResolvedSetup
from flexstage.control.study.setup import GAINS, ControllerSetup, LoopNumbers, NotchSetup
from flexstage.control.systems.system import System, static
from flexstage.control.tuning.find import find
from flexstage.control.tuning.laws import FAMILIES
from flexstage.control.tuning.objective import SENSITIVITY
from flexstage.control.tuning.spec import Tuning, TuningSpec
from flexstage.control.tuning.tune import tune

_EXPECTED = 1e-9
"""Density [m/Hz^0.5] of stroke disturbances assumed by an observer without specified amplifier noise."""
_QUIETEST = 1e-13
"""Lowest gauge noise density [m/Hz^0.5] that an observer assumes, because it would rely entirely on a noiseless gauge."""
_FILTER = 1e3


@dataclass(frozen=True)
class SingleLoop:
    """Single loop: its control `law` with parameters, its `notches`, and the `prefilter` of its reference."""

    TABLE: ClassVar[Layout] = Layout(
        "Notch filters and prefilters", "notch_filters prefilter.frequency prefilter.damping prefilter.lead", head="loop"
    )

    law: Law
    notches: tuple[Notch, ...]
    prefilter: Prefilter | None = None

    @property
    def notch_filters(self) -> Annotated[tuple[str, ...], INNER, Heading("notch filters")]:
        """Text with the frequency of each notch, and its gain at this frequency."""
        return tuple(f"{each.frequency:.5g} Hz (gain {each.depth:.3g})" for each in self.notches)


@dataclass(frozen=True, eq=False)
class Control:
    """Controller as a `system`, with its components `made_of` and its `tuning` (`None` for specified gains).

    `gains` (n, f) map poses to strokes: by the ideal kinematics, or with a correction of lost motion.
    """

    system: System
    made_of: Annotated[Decentralised | LQG | None, INNER]
    tuning: Annotated[Tuning | None, INNER]
    gains: Annotated[Array, VIEW]

    @property
    def loops(self) -> Annotated[Mapping[str, SingleLoop], VIEW]:
        """Single loops by name; empty for LQG and in open loop."""
        made = self.made_of
        if not isinstance(made, Decentralised):
            return {}
        notches = made.notches or ((),) * len(made.laws)
        shaped = made.prefilters or (None,) * len(made.laws)
        pieces = zip(made.loops.names, made.laws, notches, shaped, strict=True)
        return {name: SingleLoop(law, group, prefilter) for name, law, group, prefilter in pieces}

    @property
    def notches(self) -> tuple[Notch, ...]:
        """Notch filters of all loops."""
        return tuple(notch for each in self.loops.values() for notch in each.notches)

    @property
    def tuned(self) -> Annotated[str | None, VIEW]:
        """Summary of the tuning; null without tuning."""
        return None if self.tuning is None else self.tuning.reason

    @property
    def bandwidth(self) -> Annotated[float | None, FREQUENCY]:
        """Tuned bandwidth of the slowest loop."""
        return None if self.tuning is None else self.tuning.bandwidth


def make_controller(given: ResolvedSetup, gains: Array, known: tuple[Tuning, ...] = ()) -> Control:
    """Design the controller of a set-up; `gains` (n, f) map poses to strokes.

    `known` are tunings of the same loops with fewer modes; the optimisation starts from them.

    Raises `DesignError` for invalid parameters, and for a bandwidth that is too high; the message states the highest bandwidth found.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.study.resolve import resolve
    >>> from flexstage.control.study.setup import LoopSetup
    >>> given = resolve(parallelogram(), LoopSetup(controller=ControllerSetup(integral=300.0)))
    >>> make_controller(given, given.plant.coordinates.strokes).loops["x"].law
    PI(proportional=0.0, integral=300.0, tracking=None)
    """
    asked = given.setup.controller
    forward = gains if Compensation.REFERENCE in given.setup.compensate else None
    if asked.law is ControllerKind.NONE:
        loop = given.plant.coordinates
        return Control(static(gains, loop.motions("reference."), loop.commands("command."), given.step), None, None, gains)
    loops = _loops(given, gains)
    if asked.stated:
        made_of = _of_numbers(given, loops, forward)
        return Control(made_of.system(given.step), made_of, None, gains)
    goal = {} if asked.search_goal is None else vars(asked.search_goal)
    spec = TuningSpec(
        family=FAMILIES.get(asked.law.value) or CONTROLLERS.all[asked.law.value],
        bandwidth=asked.bandwidth,
        sensitivity=asked.sensitivity or SENSITIVITY,
        notches=tuple(_notch(each, given) for each in asked.notches),
        automatic=asked.notching is Notching.AUTOMATIC,
        expected=_expected_noise(given) if asked.law is ControllerKind.LQG else None,
        floor=given.floor,
        feedforward=forward,
        **goal,
    )
    found = find(given.plant, loops, spec, known) if goal else tune(given.plant, loops, spec)
    return Control(found.controller.system(given.step), found.controller, found, gains)


def _loops(given: ResolvedSetup, gains: Array) -> Loops:
    loop = given.plant.coordinates
    if given.setup.controller.coordinates is Axes.ACTUATOR:
        return actuator_loops(loop)
    if given.setup.controller.coordinates is Axes.PLATFORM:
        return platform_loops(loop, gains)
    found = platform_modes(given.mechanism, given.model)
    return modal_loops(loop, np.asarray(found.platform_shapes)[:, list(loop_modes(found, loop))], gains)


def _of_numbers(given: ResolvedSetup, loops: Loops, forward: Array | None) -> Decentralised:
    """Specified laws, notches and prefilters, loop by loop."""
    asked = given.setup.controller
    require(_loop_findings(asked, loops.names))
    own = {name: each for each in asked.loops for name in each.axes}
    numbers = [own.get(name, LoopNumbers((name,))) for name in loops.names]
    notches = tuple(tuple(_notch(stated, given) for stated in (*asked.notches, *each.notches)) for each in numbers)
    stated = (each.prefilter or asked.prefilter for each in numbers)
    prefilters = tuple(each and Prefilter(**vars(each)) for each in stated)
    return Decentralised(
        loops=loops,
        laws=tuple(_law(asked, each) for each in numbers),
        notches=notches if any(notches) else (),
        feedforward=forward,
        prefilters=prefilters if any(prefilters) else (),
    )


def _loop_findings(asked: ControllerSetup, names: tuple[str, ...]) -> Iterator[Finding]:
    """Findings for parameters of unknown loops, and loops without parameters."""
    stated = [name for each in asked.loops for name in each.axes]
    for name in dict.fromkeys(stated):
        if name not in names:
            what = f"unknown loop (expected {', '.join(names)} in {asked.coordinates.value} coordinates)"
            yield Finding(f"controller.loops {name}", what, suggest_nearest(name, names))
    missing = [name for name in names if name not in stated]
    if missing and all(getattr(asked, name) is None for name in GAINS):
        what = f"{', '.join(missing)} {'has' if len(missing) == 1 else 'have'} no gains"
        yield Finding("controller.loops", what, "Specify gains for these loops too, or gains of all loops in [controller]")


def _law(asked: ControllerSetup, own: LoopNumbers) -> PI | PID:
    """Law of a loop by its `own` parameters, or the common ones."""
    proportional, integral, derivative, corner = (
        value if (value := getattr(own, name)) is not None else getattr(asked, name) for name in (*GAINS, "filter")
    )
    if asked.law is ControllerKind.PI:
        return PI(proportional or 0.0, integral or 0.0)
    return PID(proportional or 0.0, integral or 0.0, derivative or 0.0, corner or _FILTER)


def _notch(stated: NotchSetup, given: ResolvedSetup) -> Notch:
    """Notch as specified; without a depth it cancels the nearest mode."""
    width = {} if stated.damping is None else {"damping": stated.damping}
    if stated.depth is not None:
        return Notch(stated.frequency, stated.depth, **width)
    nearest = int(np.argmin(np.abs(given.plant.frequencies - stated.frequency)))
    return notch_of_mode(stated.frequency, float(given.plant.ratios[nearest]), **width)


def _expected_noise(given: ResolvedSetup) -> Disturbances:
    """Gauge noise with quantisation, white up to half the sampling rate, and stroke noise, as specified."""
    hardware = given.plant.hardware
    gauges = {
        name: max(float(np.hypot(each.noise_density or 0.0, each.resolution * np.sqrt(given.step / 6.0))), _QUIETEST)
        for name, each in hardware.sensors.items()
    }
    strokes = [each.noise_density for each in hardware.amplifiers.values() if each.noise_density]
    return Disturbances(max(strokes, default=_EXPECTED), gauges)
