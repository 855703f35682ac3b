"""Tables of the answers to a specification."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import show
from flexstage.show.display import format_value
from flexstage.show.table import Cell, Column, Mark, Table, make_table
from flexstage.studies.synthesis.answers import Answers, joint_front
from flexstage.studies.synthesis.pairs import ImpossiblePair, Shortfall
from flexstage.studies.synthesis.search import Answer, FailedPair, FrontPoint

_DIGITS = 4


def answer_tables(found: Answers) -> Iterator[Table]:
    """Tabulate the answers, the best first, the pairs that failed, and the pairs that a bound excludes.

    >>> from flexstage.studies.synthesis.specification import example
    >>> list(answer_tables(Answers(example(), (), (), ())))[0].title
    'No stage meets the specification "scanner"'
    """
    yield _answer_table(found)
    if points := joint_front(found):
        goal, second = (f"{key}, {way}d" for way, key in (found.specification.goal, found.specification.second_goal or ("", "")))
        rows = [(Cell(answer.architecture, Mark.STRONG), answer.actuator, *_front_cells(answer, each)) for answer, each in points]
        notes = ["No design of any pair is better in both goals. Run the study of a design to compute the front of its pair."]
        yield make_table("Front of both goals", ["architecture", "actuator", Column(goal), Column(second)], rows, notes=notes)
    if found.failed:
        rows = [
            (Cell(each.architecture, Mark.STRONG), each.actuator, _violation(each), _reason(each), _relaxed_text(each))
            for each in found.failed
        ]
        notes = [
            "Least violation: if each requirement is relaxed by this percentage, a design meets all (lumped model, found by search).",
            "Possible if relaxed alone: the best value of this requirement that the search finds if all other requirements are met.",
        ]
        heads = ["architecture", "actuator", Column("least violation", "%"), "contradicting requirements", "possible if relaxed alone"]
        yield make_table("Failed", heads, rows, notes=notes)
    if found.impossible:
        rows = [(Cell(name, Mark.STRONG), actuators, *_shortfall_cells(best)) for name, actuators, best in _excluded(found.impossible)]
        notes = [
            'Values "at most" are rigorous upper limits. They hold for any mechanism with these actuators, or for one architecture.',
            "A row for several actuators shows the values of the first actuator, which is the closest to the requirement.",
        ]
        columns = ["architecture", "actuators", "requirement", Column("at most"), Column("required"), "holds for", "reason"]
        yield make_table("Impossible", columns, rows, notes=notes)


def pair_row(result: Answer | FailedPair) -> dict[str, str]:
    """Return texts on a pair: its names, its goal (or the reason for its failure), and the file and design of its answer.

    >>> pair_row(FailedPair("guide", "stack", 0.12, {"frequency.1": "at least 1 kHz"}))["reason"]
    'frequency.1 at least 1 kHz, missed by 12 %'
    """
    row = {"architecture": result.architecture, "actuator": result.actuator}
    if isinstance(result, Answer):
        return {**row, "goal": format_value(result.goal, result.unit, _DIGITS), "reason": "", "file": result.file, "design": result.design}
    missed = "" if result.violation is None else f", missed by {_violation(result)} %"
    return {**row, "goal": "", "reason": f"{_reason(result)}{missed}", "file": "", "design": ""}


def _answer_table(found: Answers) -> Table:
    spec = found.specification
    way, key = spec.goal
    if not found.answers:
        counts = [("failed", str(len(found.failed))), ("impossible", str(len(found.impossible)))]
        return make_table(f'No stage meets the specification "{spec.name}"', ["pairs", Column("number")], counts)
    more = [each for each in _MORE if any(each.cell(answer) is not None for answer in found.answers)]
    rows = [(str(number), *_answer_cells(each, more)) for number, each in enumerate(found.answers, 1)]
    numbers = map(Column, (f"{key}, {way}d", "elastic bodies", *(each.heading for each in more), "size", "efficiency"))
    columns = ["", "architecture", "actuator", *numbers, "active requirements", "warnings"]
    notes = [
        "Efficiency: stroke energy that the payload alone needs for the first frequency, as a fraction of the actuators' stroke energy.",
        "Warnings: number of warnings that flexstage check prints.",
        "Elastic bodies: first frequency (first unwanted frequency if only this is required), with flexibility estimated from outlines.",
        *(each.note for each in more),
        *(f"{each.pair} is not verified: {each.unverified}." for each in found.answers if each.unverified),
    ]
    return make_table(f'Stages for "{spec.name}"', columns, rows, notes=notes)


def _answer_cells(answer: Answer, more: Sequence[_Extra]) -> tuple[str | Cell, ...]:
    size = " x ".join(f"{1e3 * answer.values[f'envelope.{axis}']:.0f}" for axis in "xyz")
    used = "-" if answer.efficiency is None else f"{100.0 * answer.efficiency:.0f} %"
    goals = (format_value(answer.goal, answer.unit, _DIGITS), _frequency(answer.elastic) or "-")
    active, warnings = ", ".join(answer.active), str(len(answer.warnings))
    extra = (each.cell(answer) or "-" for each in more)
    return Cell(answer.architecture, Mark.STRONG), answer.actuator, *goals, *extra, f"{size} mm", used, active, warnings


@dataclass(frozen=True)
class _Extra:
    """A column of results that are computed on request, its note, and the cell of an answer, if it has one."""

    heading: str
    note: str
    cell: Callable[[Answer], str | None]


_MORE = (
    _Extra(
        "finite elements",
        "Finite elements: the frequency by finite elements; with these results, the stage meets all requirements. -: not verified.",
        lambda answer: _frequency(answer.verified),
    ),
    _Extra(
        "yield",
        "Yield: fraction of stages that meet all requirements if dimensions vary within the tolerance of the specification.",
        lambda answer: None if answer.manufactured is None else f"{100.0 * answer.manufactured:.3g} %",
    ),
    _Extra(
        "loop",
        "Loop: lowest sensitivity crossover of the control loop with the default controller and assumed sensors.",
        lambda answer: None if answer.crossover is None else format_value(answer.crossover, "Hz", 3),
    ),
)


def _front_cells(answer: Answer, point: FrontPoint) -> tuple[str, str]:
    return format_value(point.goal, answer.unit, _DIGITS), format_value(point.second, point.unit, _DIGITS)


def _frequency(values: Mapping[str, float]) -> str | None:
    found = next((values[key] for key in ("frequency.1", "frequency.unwanted") if key in values), None)
    return None if found is None else format_value(found, "Hz", _DIGITS)


def _violation(pair: FailedPair) -> str:
    return "-" if pair.violation is None else f"{100.0 * pair.violation:.3g}"


def _reason(pair: FailedPair) -> str:
    return "; ".join(f"{key} {text}" for key, text in pair.requirements.items()) or pair.reason


def _relaxed_text(pair: FailedPair) -> str:
    return "; ".join(f"{each.measure} {format_value(each.value, each.unit, _DIGITS)}" for each in pair.relaxed)


def _excluded(pairs: Sequence[ImpossiblePair]) -> Iterator[tuple[str, str, Shortfall]]:
    """Pairs of one architecture and one kind of bound, by their best actuator."""
    groups = dict[tuple[str, str, bool], list[ImpossiblePair]]()
    for each in pairs:
        groups.setdefault((each.architecture, each.shortfall.requirement, each.shortfall.universal), []).append(each)
    for (name, _, _), group in groups.items():
        best, *others = sorted(group, key=lambda each: -each.shortfall.ratio)
        yield name, f"{best.actuator} and {len(others)} others" if others else best.actuator, best.shortfall


def _shortfall_cells(fault: Shortfall) -> tuple[str, ...]:
    quantity = Quantity(fault.requirement, fault.unit, {"m": "um"}.get(fault.unit, fault.unit), "1")
    holds = "any mechanism" if fault.universal else "this architecture"
    return fault.requirement, *(show(each, quantity, digits=_DIGITS) for each in (fault.best, fault.required)), holds, fault.reason
