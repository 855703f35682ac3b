"""Tuning: gains for a required bandwidth, or for the highest bandwidth, and the reason for a failure."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from flexstage.base.finding import DesignError, Finding, require
from flexstage.control.controllers.loops import Loops, platform_loops
from flexstage.control.controllers.notch import notch_findings
from flexstage.control.plant_models.plants import Plant
from flexstage.control.tuning.attempt import Attempt, BandwidthTrial
from flexstage.control.tuning.laws import LQG_FAMILY, PI_FAMILY, PID_FAMILY
from flexstage.control.tuning.spec import Judgement, Tuning, TuningSpec, spec_findings
from flexstage.control.tuning.view import View, view
from flexstage.experiment.progress import report

_SLOW = 0.1
"""Lowest bandwidth tried, relative to integral control with a gain of 1 at the highest resonance (stable: small-gain theorem)."""
_FINE = 0.05
"""Fraction of the first mode's frequency above which bandwidths are tried in finer steps."""
_WITHIN = 1.003
"""Relative accuracy of the highest bandwidth."""
_NOTICED = 20.0
"""Phase lag of hold and delay [deg] above which faster sampling is advised."""
_CALM = (0.9, 0.8, 0.7, 0.6)
"""Fractions of the peak limit for single loops while integrators are strengthened: reserve for coupling."""


def tune(plant: Plant, loops: Loops, spec: TuningSpec) -> Tuning:
    """Tune a controller to a specification without objective, evaluated on all sampled loops together.

    Every loop has a gain of 1 at the required bandwidth. By default, the tuner tries bandwidths from fast to slow and refines the highest
    one by bisection. Within the family, the controller with the lowest peak of the sensitivity is selected: first without additional
    notches and, if that fails, with them. All loops together must be stable and have a peak below the limit, also for all mode shifts
    within the spread. Finally, PI and PID get the strongest integrators that keep the peak within the limit (Astrom, Panagopoulos &
    Hagglund, Automatica 34 (1998) 585). LQG is tuned by its weights, in platform coordinates. Raises `DesignError` for an unreachable
    bandwidth, with the reason, the highest bandwidth found, and a remedy.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.spec import TuningSpec
    >>> plant = integral_loop().plant
    >>> found = tune(plant, platform_loops(plant.coordinates), TuningSpec(PI_FAMILY, bandwidth=5.0))
    >>> print(found.reason)
    PI: gain crossover of all loops at 5 Hz; the peak of S with mode shifts up to 2 % is 0.5 dB (6.02 dB allowed)
    """
    loops = platform_loops(loops.coordinates) if spec.family == LQG_FAMILY else loops
    require(_findings(plant, spec))
    seen = view(plant, loops, spec.spread)
    best = highest_bandwidth(seen, spec) if spec.bandwidth is None else BandwidthTrial(seen, spec, spec.bandwidth).best()
    if best is None or not best.reaches():
        raise DesignError([_no_bandwidth(seen, spec) if spec.bandwidth is None else _unreached(seen, spec, best, spec.bandwidth)])
    best = _stiffest(best)
    return Tuning(spec, best.controller, best.judgement, _sentence(best))


def _stiffest(found: Attempt) -> Attempt:
    """Higher static gain at the same bandwidth, within the same peak of S: the lowest peak by itself leaves slow tails.

    Part of the peak limit is a reserve for coupling.
    """
    if found.trial.spec.family not in (PI_FAMILY, PID_FAMILY):
        return found
    tried = [found.trial.reach(share * found.trial.spec.sensitivity) for share in _CALM]
    return max([found, *(each for each in tried if each is not None)], key=_weakest)


def _weakest(found: Attempt) -> float:
    """Lowest of the loops' own gains at the lowest frequency."""
    return float(np.min(np.abs(np.diag(found.gains[0, 0]))))


def trial_bandwidths(seen: View, steps: tuple[float, float]) -> list[float]:
    """List bandwidths [Hz] to try, in descending order: from the limit due to hold and delay to that due to resonances.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> places = trial_bandwidths(view(plant, platform_loops(plant.coordinates), 0.02), PI_FAMILY.steps)
    >>> round(places[0]), len(places)
    (3000, 24)
    """
    calmest = _SLOW * float(np.min(seen.frequencies[:, None] / np.max(np.abs(seen.own), axis=0)))
    slowest = min(max(calmest, float(seen.frequencies[0])), 0.5 * seen.fastest)
    finer, coarser = steps
    places = [seen.fastest]
    while places[-1] > slowest:
        places.append(places[-1] / (finer if places[-1] > _FINE * seen.modes[0] else coarser))
    return places


def highest_bandwidth(seen: View, spec: TuningSpec) -> Attempt | None:
    """Find the controller of the highest bandwidth with the specified margins, within 0.3 %; None if no bandwidth is possible.

    The highest of the `trial_bandwidths` that succeeds is refined by bisection, up to the next higher trial bandwidth. Other controllers
    may reach higher bandwidths.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.spec import TuningSpec
    >>> plant = integral_loop().plant
    >>> seen = view(plant, platform_loops(plant.coordinates), 0.02)
    >>> round(highest_bandwidth(seen, TuningSpec(PI_FAMILY, automatic=False)).trial.frequency)
    56
    """
    places = trial_bandwidths(seen, spec.family.steps)
    for number, place in enumerate(places):
        report(number / len(places), "tuning")
        found = BandwidthTrial(seen, spec, place).reach()
        if found is not None:
            return _bisect(found, places[number - 1] if number else place)
    return None


def _bisect(best: Attempt, high: float) -> Attempt:
    while high > _WITHIN * best.trial.frequency:
        middle = replace(best.trial, frequency=float(np.sqrt(best.trial.frequency * high)))
        found = middle.reach()
        if found is None:
            high = middle.frequency
        else:
            best = found
    return best


def _findings(plant: Plant, spec: TuningSpec) -> Iterator[Finding]:
    yield from spec_findings(spec, plant.hardware.step)
    if spec.family != LQG_FAMILY:
        yield from notch_findings(spec.notches, plant.frequencies)
    elif spec.notches:
        yield Finding("notches", f"LQG models the modes in its observer, without notches (got {len(spec.notches)})", "Omit the notches")
    if spec.family == LQG_FAMILY and spec.expected is None:
        yield Finding("LQG", "the observer's noise is missing", "Specify the noise of gauges and strokes")


def _no_bandwidth(seen: View, spec: TuningSpec) -> Finding:
    places = trial_bandwidths(seen, spec.family.steps)
    best, advice = BandwidthTrial(seen, spec, places[-1]).best(), _help(seen, spec, places[-1])
    what = f"no bandwidth is reached ({_tried(places)}); at the lowest bandwidth, {_reason(spec, best, places[-1])}"
    return Finding("tuning", what, f"{advice[:1].upper()}{advice[1:]}")


def _unreached(seen: View, spec: TuningSpec, best: Attempt | None, wanted: float) -> Finding:
    reached = highest_bandwidth(seen, spec)
    tried = _tried(trial_bandwidths(seen, spec.family.steps))
    rest, ask = f"no other bandwidth succeeds either ({tried})", "Allow a higher peak of S"
    if reached is not None:
        top = _three_digits(reached.trial.frequency)
        rest = f"the highest bandwidth found is {top} Hz with {_controller_name(reached)} ({tried})"
        ask = f"Use a higher bandwidth, up to {top} Hz" if wanted < reached.trial.frequency else f"Use {top} Hz or less"
    what = f"at {_three_digits(wanted)} Hz, {_reason(spec, best, wanted)}; {rest}"
    return Finding("bandwidth", what, f"{ask}; {_help(seen, spec, wanted)}")


def _tried(places: list[float]) -> str:
    return f"{len(places)} bandwidths tried from {_three_digits(places[0])} to {_three_digits(places[-1])} Hz"


def _reason(spec: TuningSpec, best: Attempt | None, wanted: float) -> str:
    """Reason of failure at a bandwidth."""
    if best is None:
        return f"no gains of {spec.family.name} result in a loop gain of 1"
    found, called = best.judgement, _controller_name(best)
    if not found.stable:
        return f"the loop with {called} is unstable (growth rate {found.growth:.3g} 1/s{_offset_text(found)})"
    allowed = spec.sensitivity
    if found.peak > allowed:
        above = _decibel(found.peak / allowed)
        peak = f"{_decibel(found.peak):.1f} dB at {_three_digits(found.frequency)} Hz{_offset_text(found)}"
        return f"the peak of S with {called} is {peak}, {above:.1f} dB above the {_decibel(allowed):.1f} dB allowed"
    far = max(found.bandwidths, key=lambda each: abs(each / wanted - 1.0))
    return f"the gain of a loop with {called} first falls below 1 at {_three_digits(far)} Hz"


def _help(seen: View, spec: TuningSpec, wanted: float) -> str:
    """Remedies: notches, another kind, faster sampling; with the resulting bandwidth if computed."""
    found = []
    if not spec.automatic and spec.family != LQG_FAMILY:
        best = highest_bandwidth(seen, replace(spec, automatic=True))
        if best is not None and any(best.notches):
            found.append(f"add {_notch_places(best)} to reach a bandwidth of {_three_digits(best.trial.frequency)} Hz")
    if seen.step is not None:
        acts = wanted if spec.family.notched else max(wanted, float(seen.modes[0]))
        lag = 360.0 * acts * (seen.plant.hardware.delay + 0.5 * seen.step)
        if lag > _NOTICED:
            found.append(f"sample faster: zero-order hold and delay cause {lag:.0f} deg of phase lag at {_three_digits(acts)} Hz")
    return "; ".join([*found, f"try {spec.family.others}, more damping, or a smaller spread of the modes"])


def _sentence(best: Attempt) -> str:
    spec = best.trial.spec
    spread = f" with mode shifts up to {100.0 * spec.spread:g} %" if spec.spread else ""
    peak = f"the peak of S{spread} is {_decibel(best.judgement.peak):.1f} dB ({_decibel(spec.sensitivity):.3g} dB allowed)"
    return f"{_controller_name(best)}: gain crossover of all loops at {_three_digits(best.trial.frequency)} Hz; {peak}"


def _controller_name(best: Attempt) -> str:
    name = best.trial.spec.family.name
    return f"{name} and {_notch_places(best)}" if any(best.notches) else name


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
