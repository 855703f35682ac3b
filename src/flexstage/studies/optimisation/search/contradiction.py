"""Limits that contradict each other within the ranges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flexstage.base.number import Array
from flexstage.studies.optimisation.result import Contradiction
from flexstage.studies.optimisation.search.problem import SPARE, Problem
from flexstage.studies.optimisation.search.search import run_searches, search
from flexstage.studies.optimisation.setting import Setting
from flexstage.studies.optimisation.values import Point

CountReport = Callable[[int], None]
_COUNTS = 1e-4


def contradictions(
    setting: Setting, starts: Sequence[Array], report: CountReport | None = None, *, most: int = 6
) -> tuple[Contradiction, ...]:
    """Find at most `most` irreducible infeasible sets of limits by searches from `starts`. Returns an empty tuple if all limits can be met.

    The largest relative violation is minimised. Then limits are removed as long as the remaining limits still contradict each other. The
    resulting set is irreducible: if any one of its limits is removed, the others can be met. The search is repeated for the limits that are
    in no set yet.
    """
    found, left = list[Contradiction](), tuple(range(len(setting.kept)))
    while len(found) < most and (least := _least_violation(setting, left, starts, report)) is not None and least.violation > SPARE:
        begins = [least.point.shares, starts[0]]
        held = tuple(number for number, weight in zip(left, least.weights, strict=True) if weight > _COUNTS)
        alone = _least_violation(setting, held, begins[:1], report)
        known = (held, alone) if alone is not None and alone.violation > SPARE else (left, least)
        chosen, ended = _irreducible_set(setting, *known, begins, report)
        found.append(Contradiction(tuple(setting.kept[number] for number in chosen), ended.violation, ended.point, least.violation))
        left = tuple(number for number in left if number not in chosen)
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Least:
    """The smallest largest violation of some limits, the design there, and the multiplier of each limit."""

    violation: float
    point: Point
    weights: tuple[float, ...]


def _irreducible_set(
    setting: Setting, suspects: tuple[int, ...], ended: _Least, starts: list[Array], report: CountReport | None
) -> tuple[tuple[int, ...], _Least]:
    """An irreducible infeasible subset of limits, whose least violation is known; halves are tried before single ones."""
    size = max(1, len(suspects) // 2)
    place = 0
    while place < len(suspects):
        others = (*suspects[:place], *suspects[place + size :])
        without = _least_violation(setting, others, starts, report) if others else None
        if without is not None and without.violation > SPARE:
            suspects, ended = others, without
            starts = [without.point.shares, *starts[1:]]
        elif size > 1:
            size = max(1, size // 2)
        else:
            place += 1
    return suspects, ended


def _least_violation(setting: Setting, chosen: tuple[int, ...], starts: Sequence[Array], report: CountReport | None) -> _Least | None:
    """The smallest largest violation, from any of the starts; `None` without limits or if no start can be evaluated."""
    if not chosen:
        return None
    problem = Problem(tuple(setting.side(number) for number in chosen), ())
    traces = run_searches([search(problem, start, enough=SPARE) for start in starts], setting.values, report)
    ended = [
        _Least(problem.worth(trace.point), trace.point, tuple(each.total for each in trace.weights) or (1.0,) * len(chosen))
        for trace in traces
        if trace.point is not None
    ]
    return min(ended, key=lambda item: item.violation, default=None)
