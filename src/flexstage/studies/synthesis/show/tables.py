"""Tables of the answers to a specification."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import show
from flexstage.show.display import format_value
from flexstage.show.table import Cell, Column, Mark, Table, make_table
from flexstage.studies.synthesis.search import Answer, Answers, FailedPair, Shortfall

_DIGITS = 4


def answer_tables(found: Answers) -> Iterator[Table]:
    """Answers from the best on, pairs that failed, and pairs that a bound excludes.

    >>> from flexstage.studies.synthesis.specification import example
    >>> from flexstage.studies.synthesis.search import Answers
    >>> list(answer_tables(Answers(example(), (), (), ())))[0].title
    'No stage meets the specification "scanner"'
    """
    yield _answer_table(found)
    if found.failed:
        rows = [
            (Cell(each.architecture, Mark.STRONG), each.actuator, _violation(each), _reason(each), _relaxed_text(each))
            for each in found.failed
        ]
        notes = [
            "Least violation: the smallest share by which the worst requirement is missed, within all ranges.",
            "Possible with one relaxed: its best value with all other requirements met, found by search.",
        ]
        heads = ["architecture", "actuator", Column("least violation", "%"), "contradicting requirements", "possible with one relaxed"]
        yield make_table("Failed", heads, rows, notes=notes)
    if found.impossible:
        rows = [(Cell(each.architecture, Mark.STRONG), each.actuator, *_shortfall_cells(each.shortfall)) for each in found.impossible]
        notes = ["Bounds, exact for any values: with these actuators (any mechanism), or with the architecture alone."]
        columns = ["architecture", "actuator", "requirement", Column("at most"), Column("required"), "holds for", "reason"]
        yield make_table("Impossible", columns, rows, notes=notes)


def _answer_table(found: Answers) -> Table:
    spec = found.specification
    way, key = spec.goal
    if not found.answers:
        counts = [("failed", str(len(found.failed))), ("impossible", str(len(found.impossible)))]
        return make_table(f'No stage meets the specification "{spec.name}"', ["pairs", Column("number")], counts)
    rows = [(str(number), *_answer_cells(each)) for number, each in enumerate(found.answers, 1)]
    numbers = map(Column, (f"{key}, {way}d", "elastic bodies", "size", "efficiency"))
    columns = ["", "architecture", "actuator", *numbers, "active requirements", "warnings"]
    notes = [
        "Efficiency: stroke energy that the first frequency needs for the payload alone, over that of the actuators; at most 100 %.",
        "Warnings: number of those that flexstage check prints.",
        "Elastic bodies: the required frequency with the flexibility of bodies, estimated from their outlines.",
        "Displacements are small in the search. Check answers with flexstage verify and stroke.",
    ]
    return make_table(f'Stages for "{spec.name}"', columns, rows, notes=notes)


def _answer_cells(answer: Answer) -> tuple[str | Cell, ...]:
    size = " x ".join(f"{1e3 * answer.values[f'envelope.{axis}']:.0f}" for axis in "xyz")
    used = "-" if answer.efficiency is None else f"{100.0 * answer.efficiency:.0f} %"
    elastic = next((value for key, value in answer.elastic.items() if key in ("frequency.1", "frequency.unwanted")), None)
    goals = (format_value(answer.goal, answer.unit, _DIGITS), "-" if elastic is None else format_value(elastic, "Hz", _DIGITS))
    active, warnings = ", ".join(answer.active), str(len(answer.warnings))
    return Cell(answer.architecture, Mark.STRONG), answer.actuator, *goals, f"{size} mm", used, active, warnings


def _violation(pair: FailedPair) -> str:
    return "-" if pair.violation is None else f"{100.0 * pair.violation:.3g}"


def _reason(pair: FailedPair) -> str:
    return "; ".join(f"{key} {text}" for key, text in pair.requirements.items()) or pair.reason


def _relaxed_text(pair: FailedPair) -> str:
    return "; ".join(f"{each.measure} {format_value(each.value, each.unit, _DIGITS)}" for each in pair.relaxed)


def _shortfall_cells(fault: Shortfall) -> tuple[str, ...]:
    quantity = Quantity(fault.requirement, fault.unit, {"m": "um"}.get(fault.unit, fault.unit), "1")
    holds = "any mechanism" if fault.universal else "this architecture"
    return fault.requirement, *(show(each, quantity, digits=_DIGITS) for each in (fault.best, fault.required)), holds, fault.reason
