"""Tuning: gains for a wanted bandwidth or the highest there is, and the reason where it cannot be reached."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from flexstage.base.finding import DesignError, Finding, require
from flexstage.control.controllers.family import Family
from flexstage.control.controllers.loops import Loops, platform_loops
from flexstage.control.controllers.notch import notch_findings
from flexstage.control.plant_models.plants import Plant
from flexstage.control.tuning.attempt import Attempt, Task, attempt, reach
from flexstage.control.tuning.spec import Judgement, Kind, Tuning, spec_findings
from flexstage.control.tuning.view import View, view

_SLOW = 0.1
"""Lowest bandwidth that is tried, over that of integral control alone with a gain of 1 at the highest resonance: stable by small gain."""
_FINE = 0.05
_STEPS = (1.3, 2.0)
_STEPS_OF: Mapping[Kind | Family, tuple[float, float]] = MappingProxyType({Kind.PID: (1.14, 2.0), Kind.LQG: (1.6, 4.0)})
"""Ratios of bandwidths tried in turn, above 0.05 of the first mode and below, where less depends on them.

A loop with lead may pass 1 between modes, in ranges that are narrow; LQG takes longer.
"""
_WITHIN = 1.003
"""Within which the highest bandwidth is found."""
_NOTICED = 20.0
"""Lag of hold and delay [deg] from which on faster samples are advised."""
_CALM = (0.9, 0.8, 0.7, 0.6)
"""Shares of the peak allowed that single loops may have while integrators get stronger: loops do something to one another."""


def tune(plant: Plant, loops: Loops, task: Task) -> Tuning:
    """Tune a controller to a specification, judged on the whole sampled loop.

    At the wanted bandwidth (absent: the highest found, by trial from fast to slow and then by halving) every loop's gain is 1; of the
    kind's laws the one with the lowest peak of S is taken, first without notches of its own, then with them. The loop as a whole has to
    be stable by its eigenvalues and its peak of S below that of `spec`, also with all modes off by its spread. Once the bandwidth
    stands, PI and PID take the strongest integrators that the same peak of S leaves room for (Astrom, Panagopoulos & Hagglund, Automatica
    34 (1998) 585). LQG is tuned by its weights, in platform coordinates. Raises `DesignError` where the bandwidth is not reached: with
    what stands in the way, the highest that is, and what would help.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.spec import TuningSpec
    >>> plant = integral_loop().plant
    >>> found = tune(plant, platform_loops(plant.coordinates), Task(Kind.PI, TuningSpec(bandwidth=5.0)))
    >>> print(found.reason)
    PI: all gains pass 1 at 5 Hz; the peak of S with modes up to 2 % off is 0.5 dB, 6.02 dB allowed
    """
    loops = platform_loops(loops.coordinates) if task.kind is Kind.LQG else loops
    require(_findings(plant, task))
    seen = view(plant, loops, task.spec.spread)
    wanted = task.spec.bandwidth
    top, best = highest_bandwidth(seen, task) if wanted is None else (wanted, attempt(seen, task, wanted))
    if best is None or not best.reaches(top, task.spec):
        raise DesignError([_no_bandwidth(seen, task) if wanted is None else _unreached(seen, task, best, wanted)])
    best = _stiffest(seen, task, top, best)
    return Tuning(task.kind, task.spec, best.controller, best.judgement, best.notches, _sentence(task, best, top))


def _stiffest(seen: View, task: Task, bandwidth: float, found: Attempt) -> Attempt:
    """At the same bandwidth, within the same peak of S, more gain at rest: the lowest peak alone leaves motions that creep.

    Part of the peak allowed is left to what the loops do to one another.
    """
    if task.kind not in (Kind.PI, Kind.PID):
        return found
    tried = [reach(seen, task, bandwidth, share * task.spec.sensitivity) for share in _CALM]
    return max([found, *(each for each in tried if each is not None)], key=_weakest)


def _weakest(found: Attempt) -> float:
    """The lowest of the loops' own gains at the lowest frequency."""
    return float(np.min(np.abs(np.diag(found.gains[0, 0]))))


def trial_bandwidths(seen: View, kind: Kind | Family) -> list[float]:
    """Bandwidths [Hz] that are tried in turn, descending: from what hold and delay allow to what roll-off and resonances allow any loop.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> places = trial_bandwidths(view(plant, platform_loops(plant.coordinates), 0.02), Kind.PI)
    >>> round(places[0]), len(places)
    (3000, 24)
    """
    calmest = _SLOW * float(np.min(seen.frequencies[:, None] / np.max(np.abs(seen.own), axis=0)))
    slowest = min(max(calmest, float(seen.frequencies[0])), 0.5 * seen.fastest)
    finer, coarser = _STEPS_OF.get(kind, _STEPS)
    places = [seen.fastest]
    while places[-1] > slowest:
        places.append(places[-1] / (finer if places[-1] > _FINE * seen.modes[0] else coarser))
    return places


def highest_bandwidth(seen: View, task: Task) -> tuple[float, Attempt | None]:
    """The highest bandwidth [Hz] found at which the specified margins are kept, within 0.3 %, and the controller; 0 and None: none is.

    It is the highest of `trial_bandwidths`, halved up to the next: no proof that no other controller reaches more.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.spec import TuningSpec
    >>> plant = integral_loop().plant
    >>> seen = view(plant, platform_loops(plant.coordinates), 0.02)
    >>> round(highest_bandwidth(seen, Task(Kind.PI, TuningSpec(), automatic=False))[0])
    56
    """
    places = trial_bandwidths(seen, task.kind)
    for number, place in enumerate(places):
        found = reach(seen, task, place)
        if found is not None:
            return _bisect(seen, task, (place, found), places[number - 1] if number else place)
    return 0.0, None


def _bisect(seen: View, task: Task, low: tuple[float, Attempt], high: float) -> tuple[float, Attempt]:
    while high > _WITHIN * low[0]:
        middle = float(np.sqrt(low[0] * high))
        found = reach(seen, task, middle)
        if found is not None:
            low = (middle, found)
        else:
            high = middle
    return low


def _findings(plant: Plant, task: Task) -> Iterator[Finding]:
    yield from spec_findings(task.spec, plant.hardware.step)
    if task.kind is not Kind.LQG:
        yield from notch_findings(task.notches, plant.frequencies)
    elif task.notches:
        yield Finding("notches", f"{len(task.notches)} are given for LQG, whose observer knows the modes", "Leave them out")
    if task.kind is Kind.LQG and task.expected is None:
        yield Finding("LQG", "the noise its observer shall expect is not stated", "State the gauges' noise and what disturbs the strokes")


def _no_bandwidth(seen: View, task: Task) -> Finding:
    places = trial_bandwidths(seen, task.kind)
    best, advice = attempt(seen, task, places[-1]), _help(seen, task, places[-1])
    what = f"no bandwidth is reached, {_tried(places)}; at the last {_reason(task, best, places[-1])}"
    return Finding("tuning", what, f"{advice[:1].upper()}{advice[1:]}")


def _unreached(seen: View, task: Task, best: Attempt | None, wanted: float) -> Finding:
    top, reached = highest_bandwidth(seen, task)
    tried = _tried(trial_bandwidths(seen, task.kind))
    rest = (
        f"{_three_digits(top)} Hz is the highest found with {_controller_name(task, reached)}, {tried}"
        if reached
        else f"no other is reached either, {tried}"
    )
    what = f"at {_three_digits(wanted)} Hz {_reason(task, best, wanted)}; {rest}"
    more = f"Ask for more, up to {_three_digits(top)} Hz" if wanted < top else f"Ask for {_three_digits(top)} Hz or less"
    ask = more if reached else "Allow a higher peak of S"
    return Finding("bandwidth", what, f"{ask}; {_help(seen, task, wanted)}")


def _tried(places: list[float]) -> str:
    return f"{len(places)} bandwidths tried from {_three_digits(places[0])} to {_three_digits(places[-1])} Hz"


def _reason(task: Task, best: Attempt | None, wanted: float) -> str:
    """What stands in the way of a bandwidth."""
    if best is None:
        return f"{task.kind.value} has no law whose gain is 1 there"
    found, called = best.judgement, _controller_name(task, best)
    if not found.stable:
        return f"the loop with {called} is unstable: it grows by {found.growth:.3g} 1/s{_offset_text(found)}"
    allowed = task.spec.sensitivity
    if found.peak > allowed:
        above = _decibel(found.peak / allowed)
        peak = f"{_decibel(found.peak):.1f} dB at {_three_digits(found.frequency)} Hz{_offset_text(found)}"
        return f"the peak of S with {called} is {peak}, {above:.1f} dB above the {_decibel(allowed):.1f} dB allowed"
    far = max(found.bandwidths, key=lambda each: abs(each / wanted - 1.0))
    return f"the gain of a loop with {called} first passes 1 at {_three_digits(far)} Hz already"


def _help(seen: View, task: Task, wanted: float) -> str:
    """What would help: notches, another kind, faster samples; with what it gives where that is computed."""
    found = []
    if not task.automatic and task.kind is not Kind.LQG:
        top, best = highest_bandwidth(seen, replace(task, automatic=True))
        if best is not None and any(best.notches):
            found.append(f"with {_notch_places(best)} {_three_digits(top)} Hz is reached")
    if seen.step is not None:
        acts = max(wanted, float(seen.modes[0])) if isinstance(task.kind, Family) and not task.kind.notched else wanted
        lag = 360.0 * acts * (seen.plant.hardware.delay + 0.5 * seen.step)
        if lag > _NOTICED:
            found.append(f"sample faster: hold and delay take {lag:.0f} deg at {_three_digits(acts)} Hz")
    others = {Kind.PI: "PID or LQG", Kind.PID: "LQG", Kind.RESONANT: "PI with notches, or LQG", Kind.LQG: "less noise of the gauges"}
    other = task.kind.others if isinstance(task.kind, Family) else others[task.kind]
    return "; ".join([*found, f"try {other}, more damping, or a smaller spread of the modes"])


def _sentence(task: Task, best: Attempt, bandwidth: float) -> str:
    spread = f" with modes up to {100.0 * task.spec.spread:g} % off" if task.spec.spread else ""
    peak = f"the peak of S{spread} is {_decibel(best.judgement.peak):.1f} dB, {_decibel(task.spec.sensitivity):.3g} dB allowed"
    return f"{_controller_name(task, best)}: all gains pass 1 at {_three_digits(bandwidth)} Hz; {peak}"


def _controller_name(task: Task, best: Attempt) -> str:
    return f"{task.kind.value} and {_notch_places(best)}" if any(best.notches) else task.kind.value


def _notch_places(best: Attempt) -> str:
    places = sorted({round(each.frequency, 1) for group in best.notches for each in group})
    return f"{'notches' if len(places) > 1 else 'a notch'} at {', '.join(f'{each:g}' for each in places)} Hz"


def _offset_text(found: Judgement) -> str:
    if not found.offset:
        return ""
    return f" with all modes {abs(100.0 * found.offset):g} % {'higher' if found.offset > 0.0 else 'lower'}"


def _three_digits(value: float) -> str:
    return f"{float(f'{value:.3g}'):g}"


def _decibel(ratio: float) -> float:
    return 20.0 * float(np.log10(ratio))
