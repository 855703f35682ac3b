"""Search for one architecture with one actuator: optimisation within the requirements, corrected by better models."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Annotated

from flexstage.analysis.assessment.judge import required_values
from flexstage.analysis.assessment.requirements import Sense, requirement, requirements
from flexstage.analysis.caveats import check
from flexstage.base.finding import DesignError, refuse
from flexstage.base.record import INNER, Heading
from flexstage.base.storage.store import temporary_folder
from flexstage.base.units.quantity import FREQUENCY, RATIO
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import loads
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.optimisation.result import Binding, Optimum
from flexstage.studies.optimisation.search.front import pareto_front
from flexstage.studies.optimisation.search.optimum import optimise
from flexstage.studies.optimisation.stage_text import write_optimum
from flexstage.studies.optimisation.values import values_of
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.run import Run
from flexstage.studies.sweeps.file import loads_study
from flexstage.studies.synthesis import bounds
from flexstage.studies.synthesis.architecture import DESIGN, draw, specified_goals, study_text, tolerance_text
from flexstage.studies.synthesis.corrections import Estimator, displaced_values, elastic_values, missed_limits
from flexstage.studies.synthesis.pairs import CandidatePair, energy_groups
from flexstage.studies.synthesis.specification import Specification
from flexstage.studies.tolerances.file import loads_tolerance
from flexstage.studies.tolerances.run import tolerance

_ROUNDS = 4
"""Largest number of searches of a pair until better models meet the requirements: one, and three with corrected limits."""
_LARGE = 0.1
"""Ratio of displacement to thickness of the thinnest flexure beyond which the model of large displacements is used."""


@dataclass(frozen=True)
class Relaxation:
    """The best value [SI] of a required quantity if all other requirements are met; `required` is the requirement as text."""

    measure: str
    required: str
    value: float
    unit: str


@dataclass(frozen=True)
class FailedPair:
    """A pair without a design that meets all requirements.

    `violation` is the smallest possible value of the largest relative violation. `requirements` are those that contradict each other.
    `relaxed` are the best values of single requirements if all others are met. If no pair has an answer, these values are computed for the
    pairs with the least violations. `corrected` are stricter limits of the lumped model, set because better models missed requirements.
    """

    architecture: str
    actuator: str
    violation: Annotated[float | None, RATIO]
    requirements: Mapping[str, str]
    reason: str = ""
    relaxed: tuple[Relaxation, ...] = ()
    corrected: Annotated[Mapping[str, str], INNER] = field(default_factory=dict)


@dataclass(frozen=True)
class FrontPoint:
    """A design of the front of two goals: the values of both goals [SI], the `unit` of the second goal, and the varied `numbers` [SI]."""

    goal: float
    second: float
    unit: str
    numbers: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Answer:
    """A stage that meets all requirements: the text of its design file and study, its goal [SI] and the active requirements.

    `values` are the required quantities by the lumped model. `elastic` are these quantities with elastic bodies (flexibility estimated from
    outlines). `displaced` are the worst values at the corners of the required displacements. `verified` are values by finite elements with
    estimated relative `errors`, if requested; `unverified` is the reason why these values are missing. `rounds` is the number of searches
    until all models met the requirements.

    `manufactured` is the production yield by the lumped model, if requested: the fraction of stages that meet all requirements when their
    dimensions scatter. `crossover` is the lowest sensitivity crossover of the control loop with the default controller, if requested.
    `front` are the Pareto-optimal designs, if there are two goals. `binding` contains the active requirements and ends of variables'
    ranges with their sensitivities, before dimensions are rounded.

    `efficiency` is the fraction of the actuators' stroke energy that the stage uses (at most 1, see `bounds.efficiency`; `None` for coils).
    `warnings` are the warnings of `flexstage check`.
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
    elastic: Mapping[str, float] = field(default_factory=dict)
    displaced: Mapping[str, float] = field(default_factory=dict)
    verified: Mapping[str, float] = field(default_factory=dict)
    errors: Mapping[str, float] = field(default_factory=dict)
    unverified: str = ""
    manufactured: Annotated[float | None, RATIO] = None
    crossover: Annotated[float | None, FREQUENCY] = None
    front: tuple[FrontPoint, ...] = ()
    binding: tuple[Binding, ...] = ()
    rounds: int = 1
    design: Annotated[str, INNER] = ""
    study: Annotated[str, INNER] = ""
    scatter: Annotated[str, INNER] = ""

    @property
    def stage(self) -> Annotated[Mechanism, INNER]:
        """The stage."""
        return loads(self.design)

    @property
    def pair(self) -> Annotated[str, INNER]:
        """Name of the pair: architecture and actuator."""
        return f"{self.architecture} with {self.actuator}"

    @property
    def file(self) -> str:
        """Name of the answer's files, without ending."""
        sign = "".join(each if each.isalnum() else "-" for each in self.actuator.lower()).strip("-")
        return f"{self.architecture}-{sign}"


def search(
    spec: Specification,
    pair: CandidatePair,
    progress: Callable[[str], None] | None = None,
    *,
    answer: Answer | None = None,
    verify: Estimator | None = None,
) -> Answer | FailedPair:
    """Optimise one pair, and repeat the optimisation with corrected limits as long as a better model misses a requirement.

    Better models include elastic bodies (with `verify`, finite elements) and large displacements. The search may continue from an earlier
    `answer`. For an architecture that cannot be drawn or analysed, the result is a failed pair with the reason.

    >>> from flexstage.studies.synthesis.architecture import architectures, catalogue_actuators
    >>> from flexstage.studies.synthesis.specification import example
    >>> pair = CandidatePair(architectures()["carriages"], catalogue_actuators(example())["piezo"][0])
    >>> search(example(), pair).architecture
    'carriages'
    """
    names = (pair.architecture.name, pair.actuator.name)
    limits, known, searches = dict[str, str](), answer, 0 if answer is None else answer.rounds
    goal = specified_goals(pair.architecture, spec)[0]
    for _ in range(_ROUNDS):
        try:
            if known is None:
                searches += 1
                found = optimum(spec, pair, goal, limits, progress)
                if found.final is None:
                    return _failed(spec, pair, found, limits)
                known = replace(_answer(spec, pair, found, limits), rounds=searches)
            known = _estimated(known, spec, pair, verify)
            missed = _missed(known)
        except DesignError as error:
            return FailedPair(*names, None, {}, str(error))
        if not missed:
            return known if known.front or spec.second_goal is None else replace(known, front=front(spec, pair, limits, progress))
        limits, known = _missed(known, {goal[1]}) or missed, None  # a goal needs no stricter limit until the others are met
    models = "elastic bodies" if verify is None else "finite elements"
    return FailedPair(
        *names, None, {}, f"with {models} and large displacements, {'; '.join(f'{key} must be {text}' for key, text in limits.items())}"
    )


def _missed(answer: Answer, without: Collection[str] = ()) -> dict[str, str]:
    """Stricter limits of the lumped model if better models miss a requirement; some requirements may be left out."""
    required = {key: text for key, text in answer.stage.requirements.items() if key not in without}
    better = ({**answer.elastic, **answer.verified}, answer.displaced)
    return missed_limits(replace(answer.stage, requirements=required), answer.values, better)


def _estimated(answer: Answer, spec: Specification, pair: CandidatePair, verify: Estimator | None) -> Answer:
    """The answer with values of better models; all requirements are known with elastic bodies."""
    stage = answer.stage
    travel = max((value for axis, value in spec.displacements.items() if axis in "xyz"), default=0.0)
    large = pair.actuator.kind == "voice_coil" or travel > _LARGE * spec.make.thinnest
    elastic = answer.elastic or elastic_values(stage).values
    if unknown := [key for key in stage.requirements if key not in elastic]:
        raise refuse(unknown[0], "it has no value with elastic bodies", "Leave the requirement out")
    displaced = answer.displaced or (displaced_values(stage).values if large else {})
    answer = replace(answer, elastic=elastic, displaced=displaced)
    if verify is None:
        return answer
    try:
        verified = verify(stage)
    except DesignError as error:
        return replace(answer, unverified=str(error))
    return replace(answer, verified=verified.values, errors=verified.errors)


def manufacturing_yield(answer: Answer) -> float | None:
    """Return the production yield of an answer, from its tolerance study."""
    with temporary_folder() as folder:
        (folder / DESIGN).write_text(answer.design, encoding="utf-8")
        found = tolerance(loads_tolerance(answer.scatter, folder=folder), how=Run(workers=1))
    together = found.summary.together
    return None if together is None else together.share


def relaxations(
    spec: Specification, pair: CandidatePair, failed: FailedPair, progress: Callable[[str], None] | None = None
) -> Iterator[Relaxation]:
    """Yield the best value of each contradicting requirement if all others are met; requirements along x and y are relaxed together.

    Each value is from one start, with the limits of the other requirements corrected until better models meet these requirements. The value
    of the lumped model is multiplied by the ratios of the better models' values to it, if the result is stricter.
    """
    lines = {line.key: line for line in requirements(loads(draw(pair.architecture, spec, pair.actuator)))}
    done = set[str]()
    for key in failed.requirements:
        kind, _, axis = key.rpartition(".")
        group = {f"{kind}.x", f"{kind}.y"} if axis in ("x", "y") and not pair.architecture.turns else {key}
        if group & done:
            continue
        done |= group
        line = lines[key]
        is_least = line.sense is Sense.AT_LEAST
        goal = ("maximise" if is_least else "minimise", key)
        limits = failed.corrected
        with suppress(DesignError):
            for _ in range(_ROUNDS):
                found = optimum(replace(spec, starts=1), pair, goal, {**limits, **dict.fromkeys(group)}, progress)
                if found.final is None:
                    break
                known = _estimated(_answer(spec, pair, found, limits), spec, pair, None)
                limits = _missed(known, group)
                if not limits:
                    lumped = known.values[key]
                    ratios = [each[key] / (lumped or 1.0) for each in (known.elastic, known.displaced) if key in each]
                    value = (min if is_least else max)(lumped, lumped * math.prod(ratios))
                    yield Relaxation(key, line.text, value, line.quantity.si)
                    break


def optimum(
    spec: Specification,
    pair: CandidatePair,
    goal: tuple[str, str],
    replaced: Mapping[str, str | None],
    progress: Callable[[str], None] | None = None,
) -> Optimum:
    """Return the optimum of a pair for a goal; `replaced` contains changed limits. Raises `DesignError` if the analysis fails."""
    study = _study(spec, pair, [goal], replaced)
    found = optimise(study, load_optimisation(study), progress, contradictory=1)
    if found.interrupted:
        raise KeyboardInterrupt
    return found


def front(
    spec: Specification, pair: CandidatePair, replaced: Mapping[str, str], progress: Callable[[str], None] | None = None
) -> tuple[FrontPoint, ...]:
    """Return the Pareto front of a pair for both goals of a specification; `replaced` contains changed limits of requirements."""
    study = _study(spec, pair, specified_goals(pair.architecture, spec), replaced)
    found = pareto_front(study, load_optimisation(study), progress)
    if found.interrupted:
        raise KeyboardInterrupt
    unit = found.definition.objectives[1].measure.quantity.si
    return tuple(FrontPoint(each.objectives["goal"], each.objectives["second"], unit, each.variables) for each in found.front)


def _study(spec: Specification, pair: CandidatePair, goals: Sequence[tuple[str, str]], replaced: Mapping[str, str | None]) -> Study:
    with temporary_folder() as folder:
        (folder / DESIGN).write_text(draw(pair.architecture, spec, pair.actuator, replaced), encoding="utf-8")
        text = study_text(pair.architecture, spec, pair.actuator, goals)
        return loads_study(text, where=f"{folder}/study.toml", folder=folder)


def _failed(spec: Specification, pair: CandidatePair, found: Optimum, corrected: Mapping[str, str]) -> FailedPair:
    names = (pair.architecture.name, pair.actuator.name)
    if not found.contradictions:
        return FailedPair(*names, None, {}, found.failure, corrected=corrected)
    first = found.contradictions[0]
    stated = loads(draw(pair.architecture, spec, pair.actuator)).requirements
    return FailedPair(*names, first.overall, {each.key: stated[each.key] for each in first.limits}, corrected=corrected)


def _answer(spec: Specification, pair: CandidatePair, found: Optimum, corrected: Mapping[str, str]) -> Answer:
    point = found.final
    assert point is not None  # noqa: S101  the caller has checked it
    text = write_optimum(draw(pair.architecture, spec, pair.actuator), found.study, found.definition, values_of(found.study, point.shares))
    stage = loads(text)
    values = required_values(stage)
    binding = tuple(_as_specified(each, stage, corrected) for each in found.binding)
    first, coil = values.get("frequency.1"), pair.actuator.kind == "voice_coil"
    used = None if coil or first is None else max(bounds.efficiency(first, *each, spec.masses) for each in energy_groups(spec, pair))
    return Answer(
        pair.architecture.name,
        pair.actuator.name,
        float(point.values[0]),
        found.definition.objectives[0].measure.quantity.si,
        values,
        tuple(each.name for each in binding),
        used,
        found.agreeing,
        len(found.starts),
        found.evaluated,
        tuple(map(str, check(stage))),
        binding=binding,
        design=text,
        study=study_text(pair.architecture, spec, pair.actuator, specified_goals(pair.architecture, spec)),
        scatter=tolerance_text(pair.architecture, spec, pair.actuator, stage.requirements),
    )


def _as_specified(binding: Binding, stage: Mechanism, corrected: Mapping[str, str]) -> Binding:
    """A binding limit as specified: that of the search may be a corrected one, in a constant ratio to it."""
    key = binding.name.partition(" ")[0]
    if key not in corrected:
        return binding
    line = requirement(stage, key, str(stage.requirements[key]), key)
    return replace(binding, name=f"{key} {line.text}", limit=line.limit, price=binding.price * binding.limit / line.limit)
