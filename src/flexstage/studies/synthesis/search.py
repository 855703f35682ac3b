"""Search of stages for a specification: proofs of impossibility by bounds, then optimisation of every architecture and actuator."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from flexstage.analysis.assessment.judge import bench_of
from flexstage.analysis.assessment.requirements import requirements
from flexstage.analysis.caveats import check
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.base.notebook import InNotebook
from flexstage.base.record import INNER, Heading
from flexstage.base.units.expression import evaluate, parse_expression
from flexstage.base.units.quantity import RATIO
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import loads
from flexstage.models.flexible_bodies import body_flexibilities, with_flexible_bodies
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.optimisation.result import Optimum
from flexstage.studies.optimisation.search.optimum import optimise
from flexstage.studies.optimisation.stage_text import write_optimum
from flexstage.studies.optimisation.values import Point, values_of
from flexstage.studies.sweeps.file import loads_study
from flexstage.studies.synthesis import bounds
from flexstage.studies.synthesis.architecture import (
    DESIGN,
    Architecture,
    CatalogueActuator,
    catalogue_actuators,
    catalogue_entry,
    draw,
    find_architectures,
    measure_key,
    scope,
    specified_goal,
    study_text,
)
from flexstage.studies.synthesis.specification import FREQUENCY_KEYS, Specification

Progress = Callable[[str, float], None]
"""Reports what is computed, and the share that is done."""

_ROUNDS = 3
"""Searches of a pair until elastic bodies keep the required frequencies."""
_RELAXED = 3
"""Failed pairs whose requirements are relaxed."""


@dataclass(frozen=True)
class Shortfall:
    """A bound that a pair cannot meet: the requirement, the best value and the required one [SI], the reason, and who it holds for.

    `universal`: for every mechanism with these actuators, otherwise for the architecture alone.
    """

    requirement: str
    best: float
    required: float
    unit: str
    reason: str
    universal: bool = False

    @property
    def ratio(self) -> float:
        """Best value as a share of the required one."""
        return self.best / self.required


@dataclass(frozen=True)
class CandidatePair:
    """An architecture with an actuator."""

    architecture: Architecture
    actuator: CatalogueActuator

    @property
    def name(self) -> str:
        """Its name: architecture and actuator."""
        return f"{self.architecture.name} with {self.actuator.name}"


@dataclass(frozen=True)
class ImpossiblePair:
    """A pair that a bound excludes, with the smallest ratio of best to required value."""

    architecture: str
    actuator: str
    shortfall: Shortfall


@dataclass(frozen=True)
class Relaxation:
    """The best value [SI] of a requirement with all others kept, found by search; `required` are the words of the specification."""

    measure: str
    required: str
    value: float
    unit: str


@dataclass(frozen=True)
class FailedPair:
    """A pair without a design that keeps all requirements: the least violation, relative, and the requirements that contradict.

    `relaxed`: values at which one of them could be kept with all others; searched for the least violations if no pair has an answer.
    """

    architecture: str
    actuator: str
    violation: Annotated[float | None, RATIO]
    requirements: Mapping[str, str]
    reason: str = ""
    relaxed: tuple[Relaxation, ...] = ()


@dataclass(frozen=True, eq=False)
class Answer:
    """A stage that keeps all requirements in the lumped model: the text of its design file and study, goal [SI] and active requirements.

    `efficiency` is the stroke energy that it uses as a share of that of its actuators, at most 1 by `bounds.frequency_bound`; `None` of
    coils. `warnings` are printed by `flexstage check`; `elastic` has frequencies and stiffnesses with elastic bodies, estimated from their
    outlines, `rounds` the number of searches until these kept the requirements.
    """

    architecture: str
    actuator: str
    goal: Annotated[float, Heading(digits=5)]
    unit: str
    values: dict[str, float]
    active: tuple[str, ...]
    efficiency: float | None
    agreeing: int
    starts: int
    evaluated: int
    warnings: tuple[str, ...]
    elastic: dict[str, float]
    rounds: int = 1
    design: Annotated[str, INNER] = ""
    study: Annotated[str, INNER] = ""

    @property
    def stage(self) -> Annotated[Mechanism, INNER]:
        """The stage."""
        return loads(self.design)

    @property
    def file(self) -> str:
        """Name of its files, without ending."""
        sign = "".join(each if each.isalnum() else "-" for each in self.actuator.lower()).strip("-")
        return f"{self.architecture}-{sign}"


@dataclass(frozen=True, eq=False)
class Answers(InNotebook):
    """The outcome of a specification: `answers` from the best goal on, pairs that `failed`, and those that a bound makes `impossible`."""

    specification: Annotated[Specification, INNER]
    answers: tuple[Answer, ...]
    failed: tuple[FailedPair, ...]
    impossible: tuple[ImpossiblePair, ...]

    @property
    def best(self) -> Annotated[Answer | None, INNER]:
        """The first answer, if there is any."""
        return self.answers[0] if self.answers else None


@check_arguments
def design(specification: Specification, architectures: tuple[str, ...] = (), progress: Progress | None = None) -> Answers:
    """Design stages for a specification: every architecture that has its motions, with every allowed actuator of the catalogue.

    Bounds exclude pairs first (`flexstage.studies.synthesis.bounds`). The others are optimised within the requirements, as
    `studies.optimise` does. An empty `architectures` means all. Raises `DesignError` where no architecture has the motions.

    >>> from flexstage.studies.synthesis.specification import loads_specification
    >>> found = design(loads_specification('''
    ... format = "flexstage specification 1"
    ... name = "impossible"
    ... motion = { x = "0.5 mm", y = "0.5 mm" }
    ... payload = { mass = "1 kg", size = ["60 mm", "60 mm", "20 mm"] }
    ... box = { size = ["120 mm", "120 mm", "40 mm"] }
    ... actuators.kinds = ["piezo"]
    ... requirements.frequency = "at least 500 Hz"
    ... '''))
    >>> found.best is None, {each.shortfall.requirement for each in found.impossible}
    (True, {'frequency'})
    """
    known = catalogue_actuators(specification)
    pairs = [
        CandidatePair(each, actuator) for each in find_architectures(specification, architectures) for actuator in known.get(each.kind, ())
    ]
    screened = [(pair, list(shortfalls(specification, pair))) for pair in pairs]
    open_pairs = sorted((pair for pair, faults in screened if not faults), key=lambda pair: (_demand(specification, pair), pair.name))
    results: list[Answer | FailedPair] = []
    for number, pair in enumerate(open_pairs):
        said = f"{pair.name} ({number + 1} of {len(open_pairs)})"
        results.append(search(specification, pair, None if progress is None else _told(progress, said, number / len(open_pairs))))
    if not any(isinstance(each, Answer) for each in results):
        results = _with_relaxations(specification, open_pairs, results, progress)
    sign = -1.0 if specification.goal[0] == "maximise" else 1.0
    return Answers(
        specification,
        tuple(sorted((each for each in results if isinstance(each, Answer)), key=lambda each: (sign * each.goal, each.file))),
        tuple(sorted((each for each in results if isinstance(each, FailedPair)), key=lambda each: each.violation or math.inf)),
        tuple(
            ImpossiblePair(pair.architecture.name, pair.actuator.name, min(faults, key=lambda each: (not each.universal, each.ratio)))
            for pair, faults in screened
            if faults
        ),
    )


def _with_relaxations(
    spec: Specification, pairs: Sequence[CandidatePair], results: list[Answer | FailedPair], progress: Progress | None
) -> list[Answer | FailedPair]:
    """The failed pairs, those with the least violations with relaxed values."""
    failed = [(each, pair) for each, pair in zip(results, pairs, strict=True) if isinstance(each, FailedPair)]
    failed.sort(key=lambda each: math.inf if each[0].violation is None else each[0].violation)
    found: list[Answer | FailedPair] = []
    for number, (each, pair) in enumerate(failed):
        said = None if progress is None else _told(progress, f"{pair.name}, relaxed", number / len(failed))
        found.append(replace(each, relaxed=tuple(relaxations(spec, pair, each, said))) if number < _RELAXED else each)
    return found


def relaxations(
    spec: Specification, pair: CandidatePair, failed: FailedPair, progress: Callable[[str], None] | None = None
) -> Iterator[Relaxation]:
    """Yield the best value of each contradicting requirement with the others kept; those along x and y are relaxed together."""
    done = set[str]()
    for key, text in failed.requirements.items():
        kind, _, axis = key.rpartition(".")
        group = frozenset({f"{kind}.x", f"{kind}.y"} if axis in ("x", "y") and not pair.architecture.turns else {key})
        if group & done:
            continue
        done |= group
        found = _optimised(spec, pair, ("maximise" if text.startswith("at least") else "minimise", key), group, progress)
        if isinstance(found, Optimum) and found.final is not None:
            yield Relaxation(key, text, float(found.final.values[0]), found.definition.objectives[0].measure.quantity.si)


def _told(progress: Progress, pair: str, share: float) -> Callable[[str], None]:
    return lambda text: progress(f"{pair}: {text}", share)


def _energy(pair: CandidatePair) -> float | None:
    """Stroke energy of all actuators of a pair [J]; `None` of coils."""
    actuator = pair.actuator
    if actuator.kind == "voice_coil":
        return None
    return bounds.stroke_energy(actuator.stroke, actuator.stiffness, pair.architecture.count)


def _groups(spec: Specification, pair: CandidatePair) -> list[tuple[float, dict[str, float]]]:
    """Energies of actuators [J] with the displacements that they reach at once: of each axis on its own, or of all together."""
    energy, moved = _energy(pair) or math.inf, spec.displacements
    if pair.architecture.own:
        return [(energy / len(moved), {axis: value}) for axis, value in moved.items()]
    return [(energy, moved)] if spec.together else [(energy, {axis: value}) for axis, value in moved.items()]


def _demand(spec: Specification, pair: CandidatePair) -> float:
    """Required energy as a share of that of the actuators; the least demanding pairs are searched first."""
    frequency = spec.least(FREQUENCY_KEYS[0])
    return 0.0 if frequency is None else max(bounds.efficiency(frequency, *each, spec.masses) for each in _groups(spec, pair))


def shortfalls(spec: Specification, pair: CandidatePair) -> Iterator[Shortfall]:
    """Yield the bounds that a pair cannot meet.

    >>> from flexstage.studies.synthesis.architecture import architectures
    >>> from flexstage.studies.synthesis.specification import example
    >>> spec = example()
    >>> pairs = [CandidatePair(architectures()["carriages"], each) for each in catalogue_actuators(spec)["piezo"]]
    >>> [each.actuator.name for each in pairs if next(shortfalls(spec, each), None) is None]
    ['PSt 1000/10/150 VS18', 'PSt 1000/16/200 VS25']
    """
    frequency = spec.least(FREQUENCY_KEYS[0])
    if frequency is not None and pair.actuator.kind != "voice_coil":
        yield from _energy_shortfalls(spec, pair, frequency)
    elif frequency is not None:
        yield from _force_shortfalls(spec, pair, frequency)
    yield from _stroke_shortfalls(spec, pair)
    yield from _leaf_shortfalls(spec, pair)


def _energy_shortfalls(spec: Specification, pair: CandidatePair, frequency: float) -> Iterator[Shortfall]:
    whole = _energy(pair)
    for energy, moved in ((each, moved) for own, moved in _groups(spec, pair) for each in dict.fromkeys((whole, own)) if each):
        best = bounds.frequency_bound(energy, moved, spec.masses)
        if best < frequency:
            factor = bounds.displacement_factor(energy, moved, spec.masses, frequency)
            needed = bounds.required_energy(moved, spec.masses, frequency)
            reason = (
                f"{', '.join(moved)}: the actuators store {energy:.3g} J, and {needed:.3g} J is needed; "
                f"at most {100 * factor:.0f} % of the displacement, or {best:.4g} Hz"
            )
            yield Shortfall("frequency", best, frequency, "Hz", reason, universal=energy == whole)


def _force_shortfalls(spec: Specification, pair: CandidatePair, frequency: float) -> Iterator[Shortfall]:
    source = bounds.ForceSource(pair.actuator.force, float(pair.actuator.part.mass), pair.actuator.stroke, pair.architecture.count)
    for axis, value in spec.displacements.items():
        if axis.startswith("r"):
            continue  # the arm of the force is a matter of the box
        best = bounds.force_frequency_bound(source, value, spec.masses[axis])
        if best < frequency:
            reason = f"{source.count} coils of {source.force:.3g} N continuously, with the best lever"
            yield Shortfall("frequency", best, frequency, "Hz", reason, universal=True)


def _stroke_shortfalls(spec: Specification, pair: CandidatePair) -> Iterator[Shortfall]:
    stroke, moved = pair.actuator.stroke, spec.displacements
    if pair.architecture.direct:
        for axis, value in moved.items():
            if value > 0.5 * stroke:
                yield Shortfall(f"motion.{axis}", 0.5 * stroke, value, "m", "the actuator pushes the platform without a lever")
    if pair.architecture.struts:
        flat = max(moved["x"], moved["y"])
        least = 1.0 / math.hypot(0.5 / moved["z"], 0.5 / (flat * math.cos(math.pi / 6.0)))
        if stroke < least:
            reason = f"struts of {1e6 * stroke:.4g} um, whatever their slope: x and z need {1e6 * least:.4g} um"
            yield Shortfall("motion.z", moved["z"] * stroke / least, moved["z"], "m", reason)


def _leaf_shortfalls(spec: Specification, pair: CandidatePair) -> Iterator[Shortfall]:
    rule = pair.architecture.leaf
    if rule is None:
        return
    material = catalogue_entry(spec, "materials", spec.make.flexures)
    if material.yield_stress is None:
        return
    travel = rule.share * max(value for axis, value in spec.displacements.items() if axis in "xyz")
    stress = float(material.yield_stress) / (spec.least("safety", RATIO) or 2.0)
    needed = bounds.leaf_length(spec.make.thinnest, travel, float(material.young or 0.0), float(material.contraction), stress)
    room = float(evaluate(parse_expression(rule.room), scope(pair.architecture, spec, pair.actuator)).value)
    if needed > room:
        reason = f"the thinnest leaves must be {1e3 * needed:.3g} mm long to bend by {1e3 * travel:.3g} mm"
        yield Shortfall("box", room, needed, "m", reason)


def search(spec: Specification, pair: CandidatePair, progress: Callable[[str], None] | None = None) -> Answer | FailedPair:
    """Optimise one pair; an architecture that cannot be drawn or analysed is a failed pair with its reason.

    >>> from flexstage.studies.synthesis.architecture import architectures
    >>> from flexstage.studies.synthesis.specification import example
    >>> pair = CandidatePair(architectures()["carriages"], catalogue_actuators(example())["piezo"][0])
    >>> search(example(), pair).architecture
    'carriages'
    """
    raised, rounds = spec, 0
    while True:
        rounds += 1
        found = _optimised(raised, pair, specified_goal(pair.architecture, spec), frozenset(), progress)
        if isinstance(found, str):
            return FailedPair(pair.architecture.name, pair.actuator.name, None, {}, found)
        if found.final is None:
            return _failed(pair, found)
        answer = _answer(spec, pair, found, found.final, rounds)
        missed = dict(_missed(spec, pair, answer))
        if not missed:
            return answer
        if rounds == _ROUNDS:
            reason = ", ".join(f"{key} {answer.elastic[measure_key(pair.architecture, spec, key)]:.4g} Hz" for key in missed)
            return FailedPair(pair.architecture.name, pair.actuator.name, None, {}, f"with elastic bodies {reason}")
        raised = replace(raised, requirements={**raised.requirements, **missed})


def _missed(spec: Specification, pair: CandidatePair, answer: Answer) -> Iterator[tuple[str, str]]:
    """Required frequencies that elastic bodies miss, raised by the ratio of rigid to elastic (space mapping)."""
    for key in FREQUENCY_KEYS:
        measure_, required = measure_key(pair.architecture, spec, key), spec.least(key)
        if required is not None and answer.elastic[measure_] < required:
            yield key, f"at least {required * answer.values[measure_] / answer.elastic[measure_]:.9g} Hz"


def elastic_values(stage: Mechanism) -> dict[str, float]:
    """Return the required frequencies and stiffnesses of a stage with elastic bodies, estimated from their outlines.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> {key: round(value) for key, value in elastic_values(parallelogram()).items()}
    {'frequency.platform.1': 866}
    """
    bench = bench_of(stage)
    model = with_flexible_bodies(bench.model, stage, body_flexibilities(stage).found)
    soft = bench.with_model(model)
    lines = [each for each in requirements(stage) if each.key.startswith(("frequency", "stiffness"))]
    return {each.key: float(np.real(each.kind.value(soft, each))) for each in lines}


def _optimised(
    spec: Specification, pair: CandidatePair, goal: tuple[str, str], without: frozenset[str], progress: Callable[[str], None] | None
) -> Optimum | str:
    """The optimum of a pair for a goal, `without` some requirements; the reason where it cannot be drawn or analysed."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / DESIGN).write_text(draw(pair.architecture, spec, pair.actuator, without), encoding="utf-8")
            study = loads_study(study_text(pair.architecture, spec, pair.actuator, goal), where=f"{folder}/study.toml", folder=Path(folder))
            return optimise(study, load_optimisation(study), progress)
    except DesignError as error:
        return str(error)


def _failed(pair: CandidatePair, found: Optimum) -> FailedPair:
    names = (pair.architecture.name, pair.actuator.name)
    if not found.contradictions:
        return FailedPair(*names, None, {}, found.failure)
    first = found.contradictions[0]
    return FailedPair(*names, first.violation, {each.key: each.text for each in first.limits})


def _answer(spec: Specification, pair: CandidatePair, found: Optimum, point: Point, rounds: int) -> Answer:
    limits = found.design(point).limits
    first = next((each.value for each in limits if each.measure == "frequency.1"), None)
    coil = pair.actuator.kind == "voice_coil"
    used = None if coil or first is None else max(bounds.efficiency(first, *each, spec.masses) for each in _groups(spec, pair))
    text = write_optimum(draw(pair.architecture, spec, pair.actuator), found.study, found.definition, values_of(found.study, point.shares))
    stage = loads(text)
    return Answer(
        pair.architecture.name,
        pair.actuator.name,
        float(point.values[0]),
        found.definition.objectives[0].measure.quantity.si,
        {each.measure: each.value for each in limits},
        tuple(each.name for each in found.binding),
        used,
        found.agreeing,
        len(found.starts),
        found.evaluated,
        tuple(map(str, check(stage))),
        elastic_values(stage),
        rounds,
        design=text,
        study=found.study.text,
    )


def all_names(found: Sequence[Answer]) -> list[str]:
    """Return the file names of answers, numbered from 1.

    >>> all_names([])
    []
    """
    return [f"{number}-{each.file}" for number, each in enumerate(found, 1)]
