"""Optimisation-based tuning: the best controller for a specification, judged on the whole sampled loop."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexstage.analysis.dynamics.random_response import Spectrum
from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.number import Array
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.loops import Loops, platform_loops
from flexstage.control.controllers.lqg import LQG, Disturbances
from flexstage.control.controllers.prefilter import Prefilter
from flexstage.control.plant_models.plants import Plant
from flexstage.control.tuning.attempt import Task
from flexstage.control.tuning.judge import closed_growth, judge_loop
from flexstage.control.tuning.outcome import Bench, Outcome, bench, outcome
from flexstage.control.tuning.search import (
    Field,
    Found,
    advance,
    coupled_sensitivities,
    excess,
    field,
    known_loops,
    last_mode,
    rejects_to,
    search,
    tighten,
    variants,
)
from flexstage.control.tuning.search_spec import STABLE, SearchSpec, search_findings
from flexstage.control.tuning.spec import Judgement, Kind, Tuning, TuningSpec
from flexstage.control.tuning.tune import tune
from flexstage.control.tuning.view import View, view
from flexstage.control.tuning.weigh import Regulated, merit, weigh, worth

_KINDS = (Kind.PI, Kind.PID, Kind.LQG)
_TIGHTER = (1.0, 0.97, 0.93)
"""Peaks of S that rounds aim at, above 1, as shares of the one allowed: peaks stand between frequencies too."""
_LOOKS = 2
"""How often all rounds are done, the second time with frequencies dense where peaks were missed."""
_UNMET = 0.02
"""What is asked for and missed by less counts as reached."""
_CORNERS, _DAMPINGS, _LEADS = np.geomspace(0.3, 12.0, 14), (0.6, 0.8, 1.0, 1.4, 2.0, 3.5), (0.7, 1.2, 2.0, 4.0, np.inf)
_CALM, _BAND = 1.03, 0.019
"""Grid of prefilters: corners over 0.3 of what is rejected, dampings, leads over corners; overshoot of 2 %, settled within 1.9 %."""
_EXPECTED = 1e-9
"""Density [m/Hz^0.5] of strokes' noise that an observer expects where nothing is stated."""


@dataclass(frozen=True, eq=False)
class Asked:
    """The search: kind and specification `spec`, the floor's spectra by input, and the strokes (n, f) by which references are fed forward.

    `expected` is what the observer of linear-quadratic control expects.
    """

    kind: Kind
    spec: SearchSpec
    floor: Mapping[str, Spectrum]
    feedforward: Array | None = None
    expected: Disturbances | None = None


def find(plant: Plant, loops: Loops, asked: Asked) -> Tuning:
    """Optimise a controller for a specification.

    Law and notches of every loop are free, width and depth too, and a loop may pass 1 beyond a mode where margins hold with it moved.
    Starts are a grid around the modes, and the controller of highest bandwidth (`tune`): alone where it passes 1 beyond the modes, and
    where it is better than what the grid leads to. What is found serves the aim no worse than it (`merit`). It is judged by eigenvalues
    and by the coupled peak of S of the sampled loop, with all modes off by the spread. Raises `DesignError` for a plant that is unstable
    by itself, requirements that contradict one another, and what is not reached, with what is.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> found = find(plant, platform_loops(plant.coordinates), Asked(Kind.PI, SearchSpec(), {}))
    >>> found.judgement.stable, bool(found.judgement.peak <= 2.0)
    (True, True)
    """
    require(_findings(plant, asked))
    spec = asked.spec
    loops = platform_loops(loops.coordinates) if asked.kind is Kind.LQG else loops
    between = (-0.5 * spec.spread, 0.5 * spec.spread)
    seen = view(plant, loops, spec.spread, tuple(dict.fromkeys([*(each.offset for each in variants(spec)), *between])))
    require(_growth_findings(seen))
    if asked.kind is Kind.LQG:
        return _find_weights(seen, asked)
    begun, refused = _highest(seen, asked)
    tried = bench(seen, field(seen, spec, asked.floor, fast=0.0 if begun is None else begun.bandwidth))
    plain = None if begun is None else _begun(tried, asked, begun)
    beyond = begun is not None and begun.bandwidth > last_mode(seen)
    sought = None if beyond else _sought(tried, asked, lambda within: search(seen, within, asked.kind))
    advanced = None
    if begun is not None and isinstance(known := begun.controller, Decentralised) and not _is_beaten(tried, known, sought):
        advanced = _sought(tried, asked, lambda within: advance(seen, within, known))
    best = _best_of(spec, plain, [each for each in (plain, sought, advanced) if each is not None])
    if best is None:
        raise DesignError([_none_found(asked, refused)])
    require(best.unmet)
    return best.tuning


def _is_beaten(tried: Bench, known: Decentralised, sought: _Candidate | None) -> bool:
    """Whether a candidate serves the aim better than a known controller."""
    return sought is not None and sought.merit > merit(tried.field.spec, outcome(tried, known.system(tried.seen.step)))


def _best_of(spec: SearchSpec, plain: _Candidate | None, candidates: list[_Candidate]) -> _Candidate | None:
    """The candidate of most worth, of those that reach what is asked for; none that the aim is served worse by than by the plain one.

    That it overshoots more than is usual does not rule the plain one out; that it does so more than is stated does.
    """
    is_bound = plain is not None and not plain.unmet and (plain.overshoot <= spec.overshoot or spec.overshoot == SearchSpec.overshoot)
    least = plain.merit if plain is not None and is_bound else -np.inf
    return max((each for each in candidates if each.merit >= least), key=lambda each: (not each.unmet, each.worth), default=None)


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A controller that keeps the peak of S, how good it is, and what was asked for and it does not reach."""

    tuning: Tuning
    merit: float
    worth: float
    overshoot: float
    unmet: tuple[Finding, ...]


def _highest(seen: View, asked: Asked) -> tuple[Tuning | None, tuple[Finding, ...]]:
    """The controller of highest bandwidth, from which a search begins; or why there is none."""
    task = Task(asked.kind, _tuning_spec(asked.spec), expected=asked.expected, feedforward=asked.feedforward)
    try:
        return tune(seen.plant, seen.loops, task), ()
    except DesignError as error:
        return None, error.findings


def _tuning_spec(spec: SearchSpec) -> TuningSpec:
    return TuningSpec(None, spec.sensitivity, spec.spread)


def _begun(tried: Bench, asked: Asked, begun: Tuning) -> _Candidate | None:
    """The controller that the search begins from; `None` where it does not keep the peak of S, or stable with modes farther off."""
    seen, spec = tried.seen, asked.spec
    controller = begun.controller
    if spec.prefilter and isinstance(controller, Decentralised):
        controller = replace(controller, prefilters=prefilters(tried.field, known_loops(seen, tried.field, controller)))
    judged = _judge(seen, spec, controller)
    if not judged.stable or judged.peak > spec.sensitivity:
        return None
    reason = "the one of highest bandwidth, as no better one was found"
    found = outcome(tried, controller.system(seen.step))
    said = f"{_said(seen, spec, found.rejection[0], judged, asked.kind)}; {reason}"
    tuning = Tuning(asked.kind, _tuning_spec(spec), controller, judged, begun.notches, said)
    return _candidate(tried, tuning, found, tuple(_unmet_of(spec, found)))


def _candidate(tried: Bench, tuning: Tuning, found: Outcome, unmet: tuple[Finding, ...]) -> _Candidate:
    spec, overshoot = tried.field.spec, float(np.max(found.overshoot))
    high = f"; steps go {100.0 * overshoot:.0f} % too far, {100.0 * spec.overshoot:g} % allowed"
    said = f"{tuning.reason}{high}" if overshoot > spec.overshoot + _UNMET else tuning.reason
    return _Candidate(replace(tuning, reason=said), merit(spec, found), worth(tried, found), overshoot, unmet)


def _sought(tried: Bench, asked: Asked, seek: Callable[[Field], Found | None]) -> _Candidate | None:
    """What is found that keeps the peak of S between frequencies too."""
    seen, spec = tried.seen, asked.spec
    begun: Found | None = None
    places: tuple[float, ...] = ()
    for _ in range(_LOOKS):
        for within, found in _rounds(tried, asked, places, begun, seek):
            controller = _controller(seen.loops, within, found, asked)
            judged = _judge(seen, spec, controller)
            if judged.stable and judged.peak <= spec.sensitivity and np.isfinite(far := excess(within, found)):
                reason = _sentence(seen, within, found, asked.kind, judged)
                tuning = Tuning(asked.kind, _tuning_spec(spec), controller, judged, found.notches, reason)
                reached = outcome(tried, controller.system(seen.step))
                return _candidate(tried, tuning, reached, tuple(_unmet(seen, within, found, far)) or tuple(_unmet_of(spec, reached)))
            begun, places = found, (*places, judged.frequency / (1.0 + judged.offset))
        if begun is None:
            break
    return None


def _rounds(
    tried: Bench, asked: Asked, places: tuple[float, ...], begun: Found | None, seek: Callable[[Field], Found | None]
) -> Iterator[tuple[Field, Found]]:
    """What is found within the peak of S, then within lower ones: on from the last, and where that does not do, anew.

    Frequencies lie dense around `places` [Hz], where what was found before, `begun`, passed the peak between those looked at.
    """
    found = begun
    for tighter in _TIGHTER:
        spec = replace(asked.spec, sensitivity=1.0 + tighter * (asked.spec.sensitivity - 1.0))
        within = field(tried.seen, spec, asked.floor, places, tried.field.fast)
        if found is not None:
            yield within, tighten(within, found)
        found = seek(within)
        if found is None:
            return
        yield within, found


def _find_weights(seen: View, asked: Asked) -> Tuning:
    """Linear-quadratic control that is better than the one of the highest bandwidth, whose bandwidths are all the same."""
    spec = asked.spec
    begun, refused = _highest(seen, asked)
    if begun is None or not isinstance(begun.controller, LQG):
        raise DesignError([_none_found(asked, refused)])
    tried = bench(seen, field(seen, spec, asked.floor, fast=begun.bandwidth))
    plain = _begun(tried, asked, begun)
    best = _best_of(spec, plain, [each for each in (plain, _weighed(tried, asked, begun, begun.controller)) if each is not None])
    if best is None:
        raise DesignError([_none_found(asked, ())])
    require(best.unmet)
    return best.tuning


def _weighed(tried: Bench, asked: Asked, begun: Tuning, known: LQG) -> _Candidate | None:
    """What is found within the peak of S, or where it passes it between frequencies, then within a lower one."""
    seen, spec = tried.seen, asked.spec
    searched = Regulated(tried, asked.expected or Disturbances(_EXPECTED, {}), asked.feedforward)
    against = outcome(tried, known.system(seen.step))
    for tighter in (_TIGHTER[0], _TIGHTER[-1]):
        sharper = replace(tried, field=_limited(tried.field, replace(spec, sensitivity=1.0 + tighter * (spec.sensitivity - 1.0))))
        controller = weigh(replace(searched, tried=sharper), against, known, begun.bandwidth)
        judged = _judge(seen, spec, controller)
        if judged.stable and judged.peak <= spec.sensitivity:
            found = outcome(tried, controller.system(seen.step))
            reason = _said(seen, spec, found.rejection[0], judged)
            tuning = Tuning(asked.kind, _tuning_spec(spec), controller, judged, ((),) * len(seen.loops.names), reason)
            return _candidate(tried, tuning, found, tuple(_unmet_of(spec, found)))
    return None


def _limited(within: Field, spec: SearchSpec) -> Field:
    """The same plants held to another peak of S."""
    return replace(within, spec=spec, variants=variants(spec))


def _none_found(asked: Asked, refused: tuple[Finding, ...]) -> Finding:
    """What was tried: a search, and before it the highest bandwidth, with why that was refused."""
    spec = asked.spec
    wanted = [
        *([] if spec.rejection is None else [f"rejects up to {spec.rejection:g} Hz"]),
        *([] if spec.settling is None else [f"settles within {1e3 * spec.settling:g} ms"]),
        *([f"bears a delay of {1e3 * spec.delay_margin:g} ms"] if spec.delay_margin else []),
    ]
    advice = "allow a higher peak of S or a smaller spread of the modes, or take another kind"
    beyond = f", stable with modes up to {100.0 * STABLE * spec.spread:g} % off," if spec.spread else ""
    that = f" that {' and '.join(wanted)}" if wanted else ""
    before = "".join(f"; without a search {each.what}" for each in refused)
    what = f"no {asked.kind.value} within a peak of S of {spec.sensitivity:g}{beyond}{that} was found{before}"
    return Finding("controller.goal", what, f"Ask for less of it, {advice}" if wanted else f"{advice[0].upper()}{advice[1:]}")


def _unmet_of(spec: SearchSpec, found: Outcome) -> Iterator[Finding]:
    """What was asked for and is not reached, at the worst of the loops."""
    reached = {
        "rejection": (spec.rejection, float(np.min(found.rejection[0])), "Hz", 1.0),
        "settling": (spec.settling, float(np.max(found.settling)), "ms", 1e3),
        "delay margin": (spec.delay_margin or None, float(np.min(found.delay_margin)), "ms", 1e3),
    }
    for name, (wanted, value, unit, factor) in reached.items():
        worse = wanted is not None and (value > wanted if name == "settling" else value < wanted)
        if wanted is not None and worse and abs(value / wanted - 1.0) > _UNMET:
            what = f"the nearest comes to {factor * value:.4g} {unit}, and {factor * wanted:.4g} {unit} is asked for"
            yield Finding(f"controller.goal.{name}", what, "Ask for less of it, allow a higher peak of S, or sample faster")


def _findings(plant: Plant, asked: Asked) -> Iterator[Finding]:
    yield from search_findings(asked.spec, plant.hardware.step)
    if asked.kind not in _KINDS:
        what = f"there is no search for {asked.kind.value}"
        yield Finding("controller.goal", what, "Take pi, pid or lqg, or leave the goal out: then it is tuned to the highest bandwidth")
    if asked.kind is Kind.LQG and asked.spec.prefilter:
        what = "linear-quadratic control shapes references itself, and takes no prefilter"
        yield Finding("controller.goal.prefilter", what, "Leave it out, or take pi or pid")


def _growth_findings(seen: View) -> Iterator[Finding]:
    growth = seen.systems[0].growth
    if growth >= 0.0:
        what = f"the stage by itself is unstable: it grows by {growth:.3g} 1/s"
        yield Finding("plant", what, "A search begins with loops that are stable when open: support what gives way, or state the gains")


def _judge(seen: View, spec: SearchSpec, controller: Decentralised | LQG) -> Judgement:
    """Peak and bandwidths within the spread; stability also beyond it."""
    near = [place for place, offset in enumerate(seen.offsets) if abs(offset) <= 1.001 * spec.spread]
    system = controller.system(seen.step)
    systems = tuple(seen.systems[place] for place in near)
    judged = judge_loop(
        replace(seen, systems=systems, offsets=tuple(seen.offsets[each] for each in near), responses=seen.responses[near]), system
    )
    far = [closed_growth(each, system) for place, each in enumerate(seen.systems) if place not in near]
    return replace(judged, growth=max(judged.growth, *far)) if far else judged


def _controller(loops: Loops, within: Field, found: Found, asked: Asked) -> Decentralised:
    notches = found.notches if any(found.notches) else ()
    filters = prefilters(within, found) if asked.spec.prefilter else ()
    return Decentralised(loops, found.laws, notches, asked.feedforward, filters)


def prefilters(within: Field, found: Found) -> tuple[Prefilter, ...]:
    """By loop, the prefilter of a grid whose step settles soonest at the worst of the modes' offsets, with at most 3 % of overshoot."""
    lines = within.lines[1:]
    whole = coupled_sensitivities(within.slow[:, 1:], found, lines)
    chosen: dict[int, Prefilter] = {}
    for loop, first in enumerate(within.alike):
        chosen[loop] = chosen[first] if first in chosen else _soonest(within, 1.0 - whole[..., loop, loop], rejects_to(within, found, loop))
    return tuple(chosen.values())


def _soonest(within: Field, following: Array, frequency: float) -> Prefilter:
    best, least = Prefilter(frequency), (np.inf, np.inf)
    for ratio in _CORNERS:
        for damping in _DAMPINGS:
            for lead in _LEADS:
                corner = float(0.3 * ratio * frequency)
                tried = Prefilter(corner, damping, None if np.isinf(lead) else float(lead * corner))
                score = _settling(within, following, tried)
                if score < least:
                    best, least = tried, score
    return best


def _settling(within: Field, following: Array, tried: Prefilter) -> tuple[float, float]:
    """How much too high steps go, and when they are settled [s]."""
    s = 2j * np.pi * within.lines[1:]
    omega = 2.0 * np.pi * tried.frequency
    response = (1.0 + (0.0 if tried.lead is None else s / (2.0 * np.pi * tried.lead))) / (
        1.0 + 2.0 * tried.damping * s / omega + (s / omega) ** 2
    )
    steps = np.cumsum(np.fft.irfft(np.pad(following * response, ((0, 0), (1, 0)), constant_values=1.0), axis=-1), axis=-1)
    outside = np.flatnonzero(np.any(np.abs(steps - 1.0) > _BAND, axis=0))
    return max(float(np.max(steps)), _CALM - 0.01), float(outside[-1]) if len(outside) else 0.0


def _unmet(seen: View, within: Field, found: Found, far: float) -> Iterator[Finding]:
    """What was asked for and is not reached, `far` being the excess."""
    spec = within.spec
    stated = {"rejection": spec.rejection, "settling": spec.settling, "delay margin": spec.delay_margin or None}
    wanted = [name for name, value in stated.items() if value is not None]
    if far > _UNMET and wanted:
        reached = ", ".join(f"{name} {rejects_to(within, found, loop):.4g} Hz" for loop, name in enumerate(seen.loops.names))
        kept = f"{' and '.join(wanted)} with an overshoot of {100.0 * spec.overshoot:g} % at most are not kept at once"
        what = f"{kept}: the nearest misses by {100.0 * far:.2g} %, and rejects to {reached}"
        yield Finding("controller.goal", what, "Ask for less of them, allow a higher peak of S, or sample faster")


def _sentence(seen: View, within: Field, found: Found, kind: Kind, judged: Judgement) -> str:
    far = np.array([rejects_to(within, found, loop) for loop in range(len(seen.loops.names))])
    return _said(seen, within.spec, far, judged, kind)


def _said(seen: View, spec: SearchSpec, far: Array, judged: Judgement, kind: Kind = Kind.LQG) -> str:
    reached = ", ".join(f"{name} {value:.3g}" for name, value in zip(seen.loops.names, far, strict=True))
    peak = (
        f"the peak of S with modes up to {100.0 * spec.spread:g} % off is {judged.peak:.3g}"
        if spec.spread
        else f"the peak of S is {judged.peak:.3g}"
    )
    beyond = f", stable up to {100.0 * STABLE * spec.spread:g} %" if spec.spread else ""
    return f"{kind.value} by search for {spec.objective.value}: disturbances are rejected up to {reached} Hz; {peak}{beyond}"
