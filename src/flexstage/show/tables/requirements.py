"""Tables of verdicts on requirements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.analysis.assessment.requirements import Verdict
from flexstage.base.units.quantity import Quantity
from flexstage.parts.profile import single
from flexstage.show.display import DIGITS, field_unit, format_value, percent
from flexstage.show.table import Cell, Column, Mark, Table, make_table

_LEAST = 0.01


def verdict_table(verdicts: Sequence[Verdict], *, explained: bool = False) -> Table | None:
    """Tabulate requirements with limit, value, margin and verdict; if `explained`, also with their meaning. `None` without requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import judge
    >>> verdict_table(judge(double_triangle())).texts()[7]
    ['frequency.platform.1', 'at least 100 Hz', '106.01 Hz', '+6.01 %', 'met']
    """
    if not verdicts:
        return None
    rows = [_row(verdict) for verdict in verdicts]
    heads: list[Column | str] = ["requirement", "demand", Column("value"), Column("margin"), "verdict"]
    if explained:  # the value next to the name
        meanings = [Cell(each.requirement.kind.meaning) for each in verdicts]
        rows = [(name, value, demand, *rest, text) for (name, demand, value, *rest), text in zip(rows, meanings, strict=True)]
        heads = [heads[0], heads[2], heads[1], *heads[3:], "meaning"]
    notes = [f"{verdict.requirement.key}: {verdict.reason}" for verdict in verdicts if verdict.reason]
    return make_table("Requirements", heads, rows, notes=notes)


def is_met(verdict: Verdict) -> bool:
    """Return whether every design meets a requirement.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import judge
    >>> all(is_met(verdict) for verdict in judge(double_triangle()))
    True
    """
    return bool(np.all(verdict.passed))


def verdict_text(verdicts: Sequence[Verdict]) -> str:
    """Describe the verdict: the number of requirements that are met, and the smallest margin or the failed requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import judge
    >>> verdict_text(judge(double_triangle()))
    'All 8 requirements are met; the smallest margin is 6.01 %, for frequency.platform.1.'
    """
    failed = [verdict for verdict in verdicts if not is_met(verdict)]
    if failed:
        names = ", ".join(f"{each.requirement.key} ({'unknown' if each.value is None else margin_text(each)})" for each in failed)
        return f"{len(verdicts) - len(failed)} of {len(verdicts)} requirements are met. Not met: {names}."
    least = min(verdicts, key=rank)
    which = f"All {len(verdicts)} requirements are met" if len(verdicts) > 1 else "The requirement is met"
    return f"{which}; the smallest margin is {margin_text(least).removeprefix('+')}, for {least.requirement.key}."


def rank(verdict: Verdict) -> tuple[bool, bool, float]:
    """Return a sort key: first unknown, then failed, then met; smallest margin first; margins to limits of zero last, as they are absolute.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import judge
    >>> rank(judge(double_triangle())[6])[:2]
    (True, False)
    """
    known = verdict.value is not None
    return is_met(verdict), known and verdict.requirement.limit == 0.0, single(verdict.margin) if known else -np.inf


def value_text(verdict: Verdict) -> str:
    """Format the value of a requirement's measure in display units (first design of a batch).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import judge
    >>> value_text(judge(double_triangle())[6])
    '106.01 Hz'
    """
    if verdict.value is None:
        return "unknown"
    return quantity_text(single(verdict.value), verdict.requirement.quantity)


def quantity_text(value: float, quantity: Quantity, digits: int = DIGITS) -> str:
    """Format an SI value in the display unit of its quantity, or in a smaller unit if the number would be below 0.01.

    >>> from flexstage.base.units.quantity import STIFFNESS
    >>> quantity_text(17e6, STIFFNESS), quantity_text(420.0, STIFFNESS)
    ('17 N/um', '420 N/m')
    """
    form = field_unit(quantity)
    if 0.0 < abs(value * form.factor) < _LEAST:
        return format_value(value, quantity.si, digits)
    return form.format(value, digits)


def margin_text(verdict: Verdict) -> str:
    """Format the margin with its sign, in per cent of the limit.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import judge
    >>> margin_text(judge(double_triangle())[6])
    '+6.01 %'
    """
    if verdict.value is None:
        return "-"
    margin = single(verdict.margin)
    if verdict.requirement.limit == 0.0:
        return quantity_text(margin, verdict.requirement.quantity)
    return f"{'+' if margin >= 0.0 else ''}{percent(margin, 3)}"


def _row(verdict: Verdict) -> tuple[Cell, ...]:
    good = is_met(verdict)
    mark = Mark.PASS if good else Mark.FAIL
    return (
        Cell(verdict.requirement.key, Mark.STRONG),
        Cell(verdict.requirement.text),
        Cell(value_text(verdict)),
        Cell(margin_text(verdict), mark),
        Cell(answer_text(verdict), mark),
    )


def answer_text(verdict: Verdict) -> str:
    """Format a verdict as text, such as "met".

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import judge
    >>> answer_text(judge(double_triangle())[6])
    'met'
    """
    return "met" if is_met(verdict) else "withheld" if verdict.reason.startswith("withheld") else "not met"
