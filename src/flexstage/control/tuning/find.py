"""Optimisation-based tuning: the best controller for a specification, evaluated on the whole sampled loop."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from flexstage.base.finding import DesignError, Finding, require
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.law import Law
from flexstage.control.controllers.loops import Loops, platform_loops
from flexstage.control.controllers.lqg import LQG, Disturbances
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.prefilter import Prefilter
from flexstage.control.plant_models.plants import Plant
from flexstage.control.tuning.fit import OneLoop
from flexstage.control.tuning.judge import closed_growth, closed_system, judge_loop
from flexstage.control.tuning.laws import LQG_FAMILY, PI_FAMILY, PID_FAMILY
from flexstage.control.tuning.outcome import Outcome, outcome
from flexstage.control.tuning.search import (
    Field,
    SearchResult,
    advance,
    excess,
    farthest,
    field,
    known_loops,
    last_mode,
    one_loops,
    resume,
    search,
    tighten,
    variants,
)
from flexstage.control.tuning.spec import Judgement, Tuning, TuningSpec, spec_findings
from flexstage.control.tuning.tune import tune
from flexstage.control.tuning.view import View, view
from flexstage.control.tuning.weigh import RegulatorSpace, merit, weigh, worth

_TIGHTER = (1.0, 0.97, 0.93)
"""Target peaks of S in successive rounds, as fractions of the limit's excess over 1: peaks may occur between frequencies."""
_LOOKS = 2
"""Number of passes over all rounds, the second with frequencies dense around missed peaks."""
_MORE = 0.1
"""Work after each rejected result, as a fraction of that of the whole search."""
_FACTORS = (0.98, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5)
"""Factors on the gains of search results that are unstable with the largest mode shifts, or exceed the peak of S between frequencies."""
_UNMET = 0.02
"""Relative violation of a requirement that still counts as met."""
_CORNERS, _DAMPINGS, _LEADS = np.geomspace(0.3, 12.0, 14), (0.6, 0.8, 1.0, 1.4, 2.0, 3.5), (0.7, 1.2, 2.0, 4.0, np.inf)
_CALM, _BAND = 1.03, 0.019
"""Grid of prefilters: corners over 0.3 of the rejection, damping ratios, leads over corners; overshoot of 2 %, settled within 1.9 %."""
_EXPECTED = 1e-9
"""Default density [m/Hz^0.5] of stroke noise assumed by an observer."""


def find(plant: Plant, loops: Loops, spec: TuningSpec, known: tuple[Tuning, ...] = ()) -> Tuning:
    """Optimise a controller for the objective of a specification.

    The variables are the control law of every loop, and the frequencies, widths and depths of its notches. A crossover beyond a mode is
    possible if margins hold for all mode shifts. The search first continues `known` tunings of a plant with fewer modes. If these tunings
    give no result, the search starts from a grid around the modes. The grid is omitted if the controller of highest bandwidth (`tune`) has
    its crossover beyond the modes. If that controller is better than the result, the search also starts from that controller. The result
    is at least as good for the objective (`merit`) as the controller of highest bandwidth, if that controller meets all requirements.
    Stability is determined by eigenvalues. Robustness is determined by the peak sensitivity of all sampled loops together, for mode shifts
    within the spread. Raises `DesignError` for an unstable open loop, and for contradictory or unmet requirements.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.objective import TuningObjective
    >>> plant = integral_loop().plant
    >>> found = find(plant, platform_loops(plant.coordinates), TuningSpec(PI_FAMILY, objective=TuningObjective.BALANCE))
    >>> found.judgement.stable, bool(found.judgement.peak <= 2.0)
    (True, True)
    """
    require(_findings(plant, spec))
    loops = platform_loops(loops.coordinates) if spec.family == LQG_FAMILY else loops
    between = (-0.5 * spec.spread, 0.5 * spec.spread)
    seen = view(plant, loops, spec.spread, tuple(sorted({*(each.offset for each in variants(spec)), *between}, key=abs)))
    require(_growth_findings(seen))
    plainly = [each for each in known if each.spec.objective is None and each.spec.spread == spec.spread]
    begun, refused = (plainly[0], ()) if plainly else _highest(seen, spec)
    within = field(seen, spec, fast=0.0 if begun is None else begun.bandwidth)
    plain = None if begun is None else _begun(within, begun.controller)
    found = [] if plain is None else [plain]
    try:
        for each in _searched(within, None if begun is None else begun.controller, known):
            found += [] if each is None else [each]
    except KeyboardInterrupt:
        best = _best_of(spec, plain, found)
        reason = "none" if begun is None else begun.reason if best is None else best.tuning.reason
        raise KeyboardInterrupt(f"Nothing was written. The best controller so far: {reason}.") from None
    best = _best_of(spec, plain, found)
    if best is None and begun is not None and not any((spec.rejection, spec.settling, spec.delay_margin)):
        return replace(begun, reason=f"{begun.reason}; no controller found is stable with mode shifts up to {100.0 * farthest(spec):g} %")
    if best is None:
        raise DesignError([_none_found(spec, refused)])
    require(best.unmet)
    return best.tuning


def _searched(within: Field, first: Decentralised | LQG | None, known: tuple[Tuning, ...]) -> Iterator[_Candidate | None]:
    """Results of the searches in turn: on from a result for fewer modes, from a grid of starts, on from the `first` controller."""
    if isinstance(first, LQG):
        yield _weighed(within, first)
        return
    last, before = None, known[-1].controller if known and known[-1].spec.objective is not None else None
    if isinstance(before, Decentralised):
        yield (last := _sought(within, lambda each: resume(each, before)))
    if last is None and within.fast <= last_mode(within.seen):
        yield (last := _sought(within, lambda each: search(each, within.spec.family)))
    if first is not None and not _is_beaten(within, first, last):
        yield _sought(within, lambda each: advance(each, first))


def _is_beaten(within: Field, known: Decentralised, sought: _Candidate | None) -> bool:
    """Whether a candidate serves the objective better than a known controller."""
    return sought is not None and sought.merit > merit(within.spec, outcome(within, known.system(within.seen.step)))


def _best_of(spec: TuningSpec, plain: _Candidate | None, candidates: list[_Candidate]) -> _Candidate | None:
    """Best candidate that meets the requirements; none with less merit than the plain one.

    Overshoot beyond the usual value does not exclude the plain one; overshoot beyond the specification does.
    """
    is_bound = plain is not None and not plain.unmet and (plain.overshoot <= spec.overshoot or spec.overshoot == TuningSpec.overshoot)
    least = plain.merit if plain is not None and is_bound else -np.inf
    return _better(each for each in candidates if each.merit >= least)


@dataclass(frozen=True, eq=False)
class _Candidate:
    """Controller within the limit of the peak of S, its merit, and its unmet requirements."""

    tuning: Tuning
    merit: float
    worth: float
    overshoot: float
    unmet: tuple[Finding, ...]


def _candidate(within: Field, controller: Decentralised | LQG, judged: Judgement, missed: float = 0.0, note: str = "") -> _Candidate | None:
    """Candidate for an evaluated controller; None if it violates the peak of S, or stability with larger mode shifts."""
    spec = within.spec
    if not judged.stable or judged.peak > spec.sensitivity:
        return None
    found = outcome(within, controller.system(within.seen.step))
    overshoot = float(np.max(found.overshoot))
    high = f"; steps overshoot by {100.0 * overshoot:.0f} % ({100.0 * spec.overshoot:g} % allowed)"
    reason = f"{_sentence(within, found, judged)}{note}{high if overshoot > spec.overshoot + _UNMET else ''}"
    unmet = tuple(_missed(within, found, missed)) or tuple(_unmet(spec, found))
    return _Candidate(Tuning(spec, controller, judged, reason), merit(spec, found), worth(within, found), overshoot, unmet)


def _highest(seen: View, spec: TuningSpec) -> tuple[Tuning | None, tuple[Finding, ...]]:
    """Controller of highest bandwidth, the start of the search, or the reason of its failure."""
    try:
        return tune(seen.plant, seen.loops, spec), ()
    except DesignError as error:
        return None, error.findings


def _begun(within: Field, controller: Decentralised | LQG) -> _Candidate | None:
    """Start controller of the search."""
    if within.spec.prefilter and isinstance(controller, Decentralised):
        controller = replace(controller, prefilters=prefilters(within, known_loops(within, controller)))
    return _candidate(
        within, controller, _judge(within, controller), note="; this is the controller of highest bandwidth: no better controller was found"
    )


def _sought(within: Field, seek: Callable[[Field], SearchResult | None]) -> _Candidate | None:
    """First search result that keeps the peak of S also between frequencies and is stable with all mode shifts.

    Or a rejected result with lower gains, if it serves the objective better: S is then lower also between frequencies and shifts.
    """
    begun: SearchResult | None = None
    places: tuple[float, ...] = ()
    rejected = list[Decentralised]()
    for _ in range(_LOOKS):
        for tried, found in _rounds(within, places, begun, seek):
            controller = _controller(tried, found)
            judged = _judge(within, controller)
            if np.isfinite(missed := excess(tried, found)) and (kept := _candidate(within, controller, judged, missed)) is not None:
                calmer = reduce_gains(within, rejected)
                return kept if calmer is None or calmer.unmet or calmer.merit <= kept.merit else calmer
            rejected.append(controller)
            within.work.allow(_MORE)
            begun, places = found, (*places, judged.frequency / (1.0 + judged.offset), *instability_frequencies(within, controller))
        if begun is None:
            break
    return reduce_gains(within, rejected)


def _better(candidates: Iterable[_Candidate | None]) -> _Candidate | None:
    """The candidate of most worth, of those without unmet requirements if there are any."""
    return max((each for each in candidates if each is not None), key=lambda each: (not each.unmet, each.worth), default=None)


def reduce_gains(within: Field, rejected: list[Decentralised]) -> _Candidate | None:
    """Reduce the gains of all rejected controllers until at least one is acceptable; return the best acceptable controller."""
    distinct = {(each.laws, each.notches): each for each in rejected}.values()
    for factor in _FACTORS:
        slowed = [replace(each, laws=tuple(_scaled(law, factor) for law in each.laws)) for each in distinct]
        if best := _better(_candidate(within, each, _judge(within, each)) for each in slowed):
            return best
    return None


def _scaled(law: Law, factor: float) -> Law:
    gains = {name: factor * getattr(law, name) for name in ("proportional", "integral", "derivative") if hasattr(law, name)}
    return replace(cast("PI | PID", law), **gains)


def _rounds(
    within: Field, places: tuple[float, ...], begun: SearchResult | None, seek: Callable[[Field], SearchResult | None]
) -> Iterator[tuple[Field, SearchResult]]:
    """Results within the peak of S, then within lower ones: continued from the last, and restarted on failure.

    Frequencies are dense around `places` [Hz], where an earlier result, `begun`, exceeded the peak between frequencies.
    """
    found = begun
    for spec in _tighter(within.spec, _TIGHTER):
        tried = field(within.seen, spec, places, within.fast, within.work)
        if found is not None:
            yield tried, tighten(tried, found)
        found = seek(tried)
        if found is None:
            return
        yield tried, found


def _weighed(within: Field, known: LQG) -> _Candidate | None:
    """First linear-quadratic control that keeps the peak of S also between frequencies, searched with decreasing limits."""
    spec = within.spec
    against = outcome(within, known.system(within.seen.step))
    for tighter in _tighter(spec, (_TIGHTER[0], _TIGHTER[-1])):
        tried = replace(within, spec=tighter, variants=variants(tighter))
        regulated = RegulatorSpace(tried, spec.expected or Disturbances(_EXPECTED, {}), spec.feedforward)
        controller = weigh(regulated, against, known, within.fast)
        if (kept := _candidate(within, controller, _judge(within, controller))) is not None:
            return kept
    return None


def _tighter(spec: TuningSpec, shares: tuple[float, ...]) -> Iterator[TuningSpec]:
    return (replace(spec, sensitivity=1.0 + share * (spec.sensitivity - 1.0)) for share in shares)


def _none_found(spec: TuningSpec, refused: tuple[Finding, ...]) -> Finding:
    """Finding for a failed search, with the failure of the highest-bandwidth design before it."""
    wanted = [
        *([] if spec.rejection is None else [f"rejects disturbances up to {spec.rejection:g} Hz"]),
        *([] if spec.settling is None else [f"settles within {1e3 * spec.settling:g} ms"]),
        *([f"has a delay margin of {1e3 * spec.delay_margin:g} ms"] if spec.delay_margin else []),
    ]
    advice = "allow a higher peak of S or a smaller mode spread, or use another kind of controller"
    beyond = f", stable with mode shifts up to {100.0 * farthest(spec):g} %," if spec.spread else ""
    that = f" that {' and '.join(wanted)}" if wanted else ""
    before = "".join(f"; tuning without search also failed: {each.what}" for each in refused)
    what = f"no {spec.family.name} controller found with a peak of S up to {spec.sensitivity:g}{beyond}{that}{before}"
    return Finding("controller.goal", what, f"Relax the requirements, {advice}" if wanted else f"{advice[0].upper()}{advice[1:]}")


def _missed(within: Field, found: Outcome, far: float) -> Iterator[Finding]:
    """Finding for requirements that conflict, `far` being the excess."""
    spec = within.spec
    stated = {"rejection": spec.rejection, "settling": spec.settling, "delay margin": spec.delay_margin}
    wanted = [name for name, value in stated.items() if value]
    if far > _UNMET and wanted:
        reached = ", ".join(f"{name} {each:.4g} Hz" for name, each in zip(within.seen.loops.names, found.rejection[0], strict=True))
        kept = f"{', '.join(wanted)} and an overshoot of at most {100.0 * spec.overshoot:g} % conflict"
        what = f"{kept}: the nearest design violates these limits by {100.0 * far:.2g} %, with sensitivity crossover {reached}"
        yield Finding("controller.goal", what, "Relax one requirement, allow a higher peak of S, or sample faster")


def _unmet(spec: TuningSpec, found: Outcome) -> Iterator[Finding]:
    """Findings for unmet requirements, at the worst of the loops."""
    reached = {
        "rejection": (spec.rejection, float(np.min(found.rejection[0])), "Hz", 1.0),
        "settling": (spec.settling, float(np.max(found.settling)), "ms", 1e3),
        "delay margin": (spec.delay_margin, float(np.min(found.delay_margin)), "ms", 1e3),
    }
    for name, (wanted, value, unit, factor) in reached.items():
        if wanted and (value > wanted if name == "settling" else value < wanted) and abs(value / wanted - 1.0) > _UNMET:
            what = f"the nearest design has {factor * value:.4g} {unit} (expected {factor * wanted:.4g} {unit})"
            yield Finding(f"controller.goal.{name}", what, "Relax this requirement, allow a higher peak of S, or sample faster")


def _findings(plant: Plant, spec: TuningSpec) -> Iterator[Finding]:
    yield from spec_findings(spec, plant.hardware.step)
    if spec.family not in (PI_FAMILY, PID_FAMILY, LQG_FAMILY):
        what = f"optimisation does not support {spec.family.name}"
        yield Finding("controller.goal", what, "Use pi, pid or lqg, or omit the goal to tune for the highest bandwidth")
    if spec.family == LQG_FAMILY and spec.prefilter:
        what = "LQG has its own reference shaping and does not support a prefilter"
        yield Finding("controller.goal.prefilter", what, "Omit the prefilter, or use pi or pid")


def _growth_findings(seen: View) -> Iterator[Finding]:
    growth = seen.systems[0].growth
    if growth >= 0.0:
        what = f"the stage is unstable in open loop (growth rate {growth:.3g} 1/s)"
        yield Finding("plant", what, "Stabilise the stage, or specify the gains: optimisation needs a stable open loop")


def _judge(within: Field, controller: Decentralised | LQG) -> Judgement:
    """Peak and bandwidths within the spread; stability also beyond it."""
    seen, system = within.seen, controller.system(within.seen.step)
    near = len(seen.responses)
    judged = judge_loop(replace(seen, systems=seen.systems[:near], offsets=seen.offsets[:near]), system)
    far = [closed_growth(each, system) for each in seen.systems[near:]]
    return replace(judged, growth=max(judged.growth, *far)) if far else judged


def instability_frequencies(within: Field, controller: Decentralised) -> Iterator[float]:
    """Yield the frequency [Hz] of the fastest growth, divided by 1 + shift, for each destabilising mode shift beyond the spread."""
    seen, system = within.seen, controller.system(within.seen.step)
    for offset, plant in zip(seen.offsets, seen.systems, strict=True):
        poles = closed_system(plant, system).poles.astype(complex)
        pole = poles[np.argmax(np.real(poles) if system.step is None else np.abs(poles))]
        rate = pole if system.step is None else np.log(pole) / system.step  # poles of delays are 0: only the fastest one has a rate
        if abs(offset) > within.spec.spread and rate.real >= 0.0:
            yield abs(rate.imag) / (2.0 * np.pi) / (1.0 + offset)


def _controller(within: Field, found: SearchResult) -> Decentralised:
    notches = found.notches if any(found.notches) else ()
    filters = prefilters(within, found) if within.spec.prefilter else ()
    return Decentralised(within.seen.loops, found.laws, notches, within.spec.feedforward, filters)


def prefilters(within: Field, found: SearchResult) -> tuple[Prefilter, ...]:
    """Select a prefilter per loop from a grid: least overshoot for all mode shifts (up to 2 % counts as none), then fastest settling."""
    loops = one_loops(within, found)
    chosen = {first: _soonest(loops[first]) for first in {*within.alike}}
    return tuple(chosen[first] for first in within.alike)


def _soonest(loop: OneLoop) -> Prefilter:
    highest = loop.rejection
    grid = ((float(0.3 * ratio * highest), damping, lead) for ratio in _CORNERS for damping in _DAMPINGS for lead in _LEADS)
    tried = (Prefilter(corner, damping, None if np.isinf(lead) else float(lead * corner)) for corner, damping, lead in grid)
    return min(tried, key=lambda each: _settling(loop, each))


def _settling(loop: OneLoop, tried: Prefilter) -> tuple[float, float]:
    """Overshoot of steps, and settling times [s]."""
    s = 2j * np.pi * loop.lines
    omega = 2.0 * np.pi * tried.frequency
    response = (1.0 + (0.0 if tried.lead is None else s / (2.0 * np.pi * tried.lead))) / (
        1.0 + 2.0 * tried.damping * s / omega + (s / omega) ** 2
    )
    steps = np.cumsum(np.fft.irfft(loop.following * response, axis=-1), axis=-1)
    outside = np.flatnonzero(np.any(np.abs(steps - 1.0) > _BAND, axis=0))
    return max(float(np.max(steps)), _CALM - 0.01), float(outside[-1]) if len(outside) else 0.0


def _sentence(within: Field, found: Outcome, judged: Judgement) -> str:
    spec = within.spec
    reached = ", ".join(f"{name} {value:.3g}" for name, value in zip(within.seen.loops.names, found.rejection[0], strict=True))
    shifts = f" with mode shifts up to {100.0 * spec.spread:g} %; stable with shifts to {100.0 * farthest(spec):g} %" if spec.spread else ""
    peak = f"the peak of S is {judged.peak:.3g}{shifts}"
    objective = "" if spec.objective is None else f" for {spec.objective.value}"
    return f"{spec.family.name} optimised{objective}: sensitivity crossover {reached} Hz; {peak}"
