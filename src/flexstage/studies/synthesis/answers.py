"""Search of stages for a specification among pairs of architecture and actuator: answers, and reasons for failures."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.base.notebook import InNotebook
from flexstage.base.processes.jobs import Line, cores
from flexstage.base.processes.pool import results
from flexstage.base.record import INNER
from flexstage.base.storage.digest import digest
from flexstage.base.storage.record_store import RecordStore
from flexstage.base.version import __version__
from flexstage.mechanism.mechanism import Mechanism
from flexstage.studies.optimisation.result import Binding
from flexstage.studies.sweeps.execution.run import Run
from flexstage.studies.synthesis.architecture import catalogue_actuators, draw, specified_goals, study_text
from flexstage.studies.synthesis.corrections import Estimator
from flexstage.studies.synthesis.pairs import CandidatePair, ImpossiblePair, demand, shortfalls
from flexstage.studies.synthesis.search import Answer, FailedPair, FrontPoint, Relaxation, manufacturing_yield, relaxations, search
from flexstage.studies.synthesis.specification import Specification
from flexstage.studies.synthesis.synthesised import find_architectures

Progress = Callable[[str, float], None]
"""Function that is called with the name of the present computation and the completed fraction."""

_ALONE = Run(workers=1)
_RELAXED = 3
"""Number of failed pairs whose requirements are relaxed."""
FIRST = 3
"""Number of answers for which finite elements, yield and control loop are computed on request."""


@dataclass(frozen=True, eq=False)
class Answers(InNotebook):
    """The outcome of a specification: `answers` (best first), `failed` pairs, and `impossible` pairs, which a bound excludes.

    If `interrupted` is true, some pairs were not searched.
    """

    specification: Annotated[Specification, INNER]
    answers: tuple[Answer, ...]
    failed: tuple[FailedPair, ...]
    impossible: tuple[ImpossiblePair, ...]
    interrupted: bool = False

    @property
    def best(self) -> Annotated[Answer | None, INNER]:
        """The best answer, or None if there is no answer."""
        return self.answers[0] if self.answers else None


@check_arguments
def design(  # noqa: PLR0913 (its options)
    specification: Specification,
    architectures: tuple[str, ...] = (),
    progress: Progress | None = None,
    *,
    verify: Estimator | None = None,
    tolerance: bool = False,
    close_loop: Callable[[Mechanism], float | None] | None = None,
    keep: Path | None = None,
    how: Run = _ALONE,
    finished: Callable[[Answer | FailedPair], None] | None = None,
) -> Answers:
    """Design stages for a specification: every architecture that has the required motions, with every allowed actuator of the catalogue.

    First, pairs that cannot meet a bound are excluded (`flexstage.studies.synthesis.bounds`). The other pairs are optimised within the
    requirements by `studies.optimise`. As long as a design misses a requirement with elastic bodies or at large displacements, limits are
    corrected and optimisation is repeated. For the first three answers, `verify` (such as `solid.required_values`) repeats the search with
    finite elements, `tolerance` computes the yield, and `close_loop` (such as `control.sensitivity_crossover`) computes the sensitivity
    crossover of the control loop. If `architectures` is empty, all architectures are used.

    `finished` receives the result of each pair as soon as it is known, and again after each change.

    Results of pairs are written to the folder `keep`, and read from this folder if `how.resume` is true. Results do not depend on the
    number of processes. After a keyboard interrupt, the answers found so far are returned. Raises `DesignError` if no architecture has the
    required motions.

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
    open_pairs = sorted((pair for pair, faults in screened if not faults), key=lambda pair: (demand(specification, pair), pair.name))
    kept = None if keep is None else RecordStore(keep, ".answer", (Answer, FailedPair, FrontPoint, Binding, Relaxation))
    store = _Store(specification, kept, resume=how.resume, finished=finished)
    found, interrupted = dict[str, Answer | FailedPair](), False
    try:
        for pair, result in _searched(store, open_pairs, progress, cores() if how.workers is None else how.workers):
            found[pair.name] = result
        for name, compute in _steps(specification, verify, close_loop, tolerance=tolerance):
            _extend(store, open_pairs, found, (name, compute), progress)
        if not any(isinstance(each, Answer) for each in found.values()):
            found |= _relaxed(store, open_pairs, found, progress)
    except KeyboardInterrupt:
        interrupted = True
    excluded = (
        ImpossiblePair(pair.architecture.name, pair.actuator.name, min(faults, key=lambda each: (not each.universal, each.ratio)))
        for pair, faults in screened
        if faults
    )
    failed = sorted((each for pair in open_pairs if isinstance(each := found.get(pair.name), FailedPair)), key=_violation)
    return Answers(specification, tuple(_ranked(specification, found)), tuple(failed), tuple(excluded), interrupted)


def _ranked(spec: Specification, found: Mapping[str, Answer | FailedPair]) -> list[Answer]:
    sign = -1.0 if spec.goal[0] == "maximise" else 1.0
    return sorted((each for each in found.values() if isinstance(each, Answer)), key=lambda each: (sign * each.goal, each.file))


def _violation(failed: FailedPair) -> tuple[float, str, str]:
    return math.inf if failed.violation is None else failed.violation, failed.architecture, failed.actuator


@dataclass(frozen=True)
class _Store:
    """Results of pairs in `files`, if any, by the content that they depend on."""

    specification: Specification
    files: RecordStore | None
    resume: bool
    finished: Callable[[Answer | FailedPair], None] | None

    def key(self, pair: CandidatePair, what: str) -> str:
        """Key of a result; empty if the pair cannot be drawn."""
        try:
            drawn = draw(pair.architecture, self.specification, pair.actuator)
            study = study_text(pair.architecture, self.specification, pair.actuator, specified_goals(pair.architecture, self.specification))
        except DesignError:
            return ""
        return digest((__version__, what, pair.name, repr(self.specification), drawn, study))[:20]

    def kept(self, pair: CandidatePair, what: str) -> Answer | FailedPair | None:
        """An earlier result; `None` if there is none, or if its file is damaged."""
        if self.files is None or not self.resume:
            return None
        try:
            result = self.files.find(self.key(pair, what))
        except (FileNotFoundError, ValueError):
            return None
        return self._announced(result)

    def put(self, pair: CandidatePair, what: str, result: Answer | FailedPair) -> Answer | FailedPair:
        """Keep a result, and return it."""
        if self.files is not None and (key := self.key(pair, what)):
            self.files.keep(key, result)
        return self._announced(result)

    def _announced(self, result: Answer | FailedPair) -> Answer | FailedPair:
        if self.finished is not None:
            self.finished(result)
        return result


def _searched(
    store: _Store, pairs: Sequence[CandidatePair], progress: Progress | None, workers: int
) -> Iterator[tuple[CandidatePair, Answer | FailedPair]]:
    """Search all pairs, or take their kept results."""
    todo = list[CandidatePair]()
    for pair in pairs:
        kept = store.kept(pair, "search")
        if kept is None:
            todo.append(pair)
        else:
            yield pair, kept
    if min(workers, len(todo)) > 1:
        work = partial(_search_in_process, store.specification)
        for number, ((pair,), result) in enumerate(results(work, [(pair,) for pair in todo], min(workers, len(todo)))):
            _notify(progress, f"{pair.name} ({number + 1} of {len(todo)})")(number / len(todo), "finished")
            yield pair, store.put(pair, "search", result)
        return
    for number, pair in enumerate(todo):
        said = partial(_notify(progress, f"{pair.name} ({number + 1} of {len(todo)})"), number / len(todo))
        yield pair, store.put(pair, "search", search(store.specification, pair, said))


def _search_in_process(spec: Specification, _line: Line, pair: CandidatePair) -> Answer | FailedPair:
    return search(spec, pair)


def _notify(progress: Progress | None, subject: str) -> Callable[[float, str], None]:
    return lambda share, text: None if progress is None else progress(f"{subject}: {text}", share)


_Step = tuple[str, Callable[[CandidatePair, Answer, Callable[[str], None]], Answer | FailedPair]]
"""A computation for an answer of a pair, and its name."""


def _steps(
    spec: Specification, verify: Estimator | None, close_loop: Callable[[Mechanism], float | None] | None, *, tolerance: bool
) -> Iterator[_Step]:
    """The computations for the first answers."""
    if verify is not None:
        yield "finite elements", lambda pair, answer, said: search(spec, pair, said, answer=answer, verify=verify)
    if tolerance:
        yield "yield", lambda _pair, answer, _said: _with(answer, "manufactured", manufacturing_yield)
    if close_loop is not None:
        yield "loop", lambda _pair, answer, _said: _with(answer, "crossover", lambda each: close_loop(each.stage))


def _extend(
    store: _Store, pairs: Sequence[CandidatePair], found: dict[str, Answer | FailedPair], step: _Step, progress: Progress | None
) -> None:
    """Compute a step of the first answers. Where one of them falls behind or fails, the next one is computed too."""
    (name, compute), by_name, done = step, {pair.name: pair for pair in pairs}, set[str]()
    while left := [each for each in _ranked(store.specification, found)[:FIRST] if each.pair not in done]:
        answer, pair = left[0], by_name[left[0].pair]
        said = partial(_notify(progress, pair.name), len(done) / FIRST)
        said(name)
        what = f"{name} of {digest(dataclasses.asdict(answer))}"
        found[pair.name] = store.kept(pair, what) or store.put(pair, what, compute(pair, answer, said))
        done.add(pair.name)


def _with(answer: Answer, field: str, compute: Callable[[Answer], float | None]) -> Answer:
    """The answer with a result, or with a warning why there is none."""
    try:
        return replace(answer, **{field: compute(answer)})
    except DesignError as error:
        return replace(answer, warnings=(*answer.warnings, str(error)))


def _relaxed(
    store: _Store, pairs: Sequence[CandidatePair], found: Mapping[str, Answer | FailedPair], progress: Progress | None
) -> dict[str, Answer | FailedPair]:
    """The failed pairs of least violation with relaxed values."""
    every = ((each, pair) for pair in pairs if isinstance(each := found.get(pair.name), FailedPair))
    failed = sorted(every, key=lambda each: _violation(each[0]))[:_RELAXED]
    done = dict[str, Answer | FailedPair]()
    for number, (each, pair) in enumerate(failed):
        said = partial(_notify(progress, f"{pair.name}, relaxed"), number / len(failed))
        done[pair.name] = store.kept(pair, "relaxed") or store.put(
            pair, "relaxed", replace(each, relaxed=tuple(relaxations(store.specification, pair, each, said)))
        )
    return done


def joint_front(found: Answers) -> list[tuple[Answer, FrontPoint]]:
    """Return the designs of all pairs that no other design exceeds in both goals, sorted from the best in the first goal.

    >>> from flexstage.studies.synthesis.specification import example
    >>> joint_front(Answers(example(), (), (), ()))
    []
    """
    every = ((answer, point) for answer in found.answers for point in answer.front)
    points = sorted(every, key=lambda each: (-each[1].goal, each[1].second, each[0].file))
    best, kept = math.inf, list[tuple[Answer, FrontPoint]]()
    for answer, point in points:
        if point.second < best:
            kept.append((answer, point))
            best = point.second
    return kept


def all_names(found: Sequence[Answer]) -> list[str]:
    """Return the file names of answers, numbered from 1.

    >>> all_names([])
    []
    """
    return [f"{number}-{each.file}" for number, each in enumerate(found, 1)]
