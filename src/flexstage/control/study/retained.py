"""Controller and retained modes of a set-up, which depend on each other."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np

from flexstage.base.finding import DesignError, Finding
from flexstage.base.number import Array
from flexstage.control.plant_models.retention import MARGIN_CHANGE, Retention, retention
from flexstage.control.robustness.stability_margins import margins, peaks
from flexstage.control.study.control import Control, make_controller
from flexstage.control.study.resolve import ResolvedSetup, retain_modes
from flexstage.control.systems.closed import Loop, LoopBreak, loop
from flexstage.control.tuning.spec import Tuning
from flexstage.experiment.progress import part


def control_and_modes(given: ResolvedSetup, gains: Array) -> tuple[ResolvedSetup, Control, Retention]:
    """Design the controller for the retained modes, add the modes that are significant with it, and repeat until no mode is added.

    Modes are never removed, because adding and removing could alternate endlessly. A number of modes specified in the set-up is not
    changed. `gains` (n, f) map poses to strokes. Raises `DesignError` as `make_controller` does.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.study.resolve import resolve
    >>> from flexstage.control.study.setup import ControllerSetup, LoopSetup
    >>> given = resolve(parallelogram(), LoopSetup(controller=ControllerSetup(quick=True)))
    >>> given, control, found = control_and_modes(given, given.plant.coordinates.strokes)
    >>> found.retained, found.total, found.complete
    (1, 18, True)
    """
    asked, known = given.setup.controller, list[Tuning]()
    if asked.goal is None and not np.all(given.plant.frequencies > 0.0):  # a motion without stiffness: optimisation needs stability
        asked = replace(asked, quick=True)
        given = replace(given, setup=replace(given.setup, controller=asked))
    if asked.search_goal is not None:  # optimisation is slow: start with the modes of the plain tuning
        plain = replace(given, setup=replace(given.setup, controller=replace(asked, goal=None, quick=True)))
        with suppress(DesignError), part(0.0, 0.2):
            begun, control, _ = control_and_modes(plain, gains)
            given = replace(begun, setup=given.setup)
            known += [control.tuning] if control.tuning is not None else []
    with part(0.2, 0.8):
        control = make_controller(given, gains, tuple(known))
    while True:
        found = retention(given.whole, loop(given.plant, control.system))
        if found.complete or given.setup.modes is not None:
            return given, control, found
        given = retain_modes(given, found.wanted)
        if found.retune:
            known += [control.tuning] if control.tuning is not None else []
            with part(0.8, 1.0, f"tuning with {len(given.plant.frequencies)} modes"):
                control = make_controller(given, gains, tuple(known))


def stated_modes_warnings(given: ResolvedSetup, control: Control, closed: Loop, found: Retention) -> list[Finding]:
    """Warn if so few modes are specified that the margins differ from those with all significant modes."""
    if given.setup.modes is None or found.complete:
        return []
    more = loop(retain_modes(given, found.wanted).plant, control.system)
    own, rest = _worst(closed), _worst(more)
    if np.allclose(own, rest, rtol=MARGIN_CHANGE, atol=0.0):
        return []
    texts = (f"the peak of S is {peak:.4g} and the lowest phase margin {phase:.4g} deg" for peak, phase in (own, rest))
    few, many = (len(each.plant.frequencies) for each in (closed, more))
    what = f"too few modes: with {few} modes, {next(texts)}; with {many} of the model's {found.total} modes, {next(texts)}"
    return [Finding("modes", what, "Remove this key: the significant modes are then retained")]


def _worst(closed: Loop) -> tuple[float, float]:
    """Peak of S and lowest phase margin [deg]; infinite and None for an unstable loop."""
    if closed.system.growth >= 0.0:
        return np.inf, 0.0
    least = min(each.phase.value for each in margins(closed, LoopBreak.POSE).channels)
    return peaks(closed, LoopBreak.POSE).sensitivity.value, float(np.degrees(least))
