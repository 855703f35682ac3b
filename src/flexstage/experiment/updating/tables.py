"""Tables of an update: numbers before and after a test, what the test tells, and how theory agrees."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.experiment.updating.update import Residual, Told, Updated
from flexstage.show.display import format_value, number, percent
from flexstage.show.table import Cell, Column, Mark, Table, make_table, matrix_table

_MARKS = {Told.WELL: Mark.PASS, Told.WEAKLY: Mark.WARN, Told.NOT: Mark.FAIL, Told.WITHHELD: Mark.FAIL}
_MOST_GAINS = 12


def update_tables(found: Updated) -> Iterator[Table]:
    """All tables of an update."""
    yield update_table(found)
    yield residual_table(found)
    if len(found.addresses) > 1:
        yield matrix_table("Correlations after the test", found.correlations)
        yield combination_table(found)


def update_table(found: Updated) -> Table:
    """Numbers before and after, with prior and posterior standard deviations."""
    rows = [
        (
            Cell(each.address, Mark.STRONG),
            format_value(each.before, each.unit),
            format_value(each.after, each.unit),
            _signed(100.0 * each.change),
            number(100.0 * each.prior_deviation, 2),
            number(100.0 * each.deviation, 2),
            percent(each.prior_variance_left, 2),
            Cell(each.verdict.partition("; ")[0], _MARKS[each.told]),
        )
        for each in found.parameters
    ]
    heads = [
        *("number", Column("before"), Column("after"), Column("change", "%"), Column("prior +-", "%"), Column("after +-", "%")),
        *(Column("variance left"), "what the test tells"),
    ]
    known = found.assumed
    gains = "" if known.gain_error is None else f", gains {percent(known.gain_error, 3)}"
    errors = f"Stated or assumed errors: theory's frequencies {percent(known.model_error, 3)}{gains}; +- is one standard deviation."
    notes = ["Variance left: of the prior's. At most 10 % is identified, at most 20 % weakly, more is the prior's word.", errors]
    notes += [f"{each.address}: {rest}." for each in found.parameters if (rest := each.verdict.partition("; ")[2])]
    return make_table("Numbers after the test", heads, rows, notes=notes, provenance=found.provenance)


def residual_table(found: Updated) -> Table:
    """Data by test and theory before and after: all frequencies, and of gains the largest misfits."""
    modes = [each for each in found.residuals if each.unit == "Hz"]
    gains = sorted((each for each in found.residuals if each.unit != "Hz"), key=lambda each: -abs(each.misfit_before))
    heads = [
        *("datum", Column("measured"), Column("before"), Column("after"), Column("error", "%")),
        *(Column("misfit before", "sigma"), Column("misfit after", "sigma")),
    ]
    before, after = number(found.chi_square_before, 3), number(found.chi_square, 3)
    notes = [f"Chi-square of {found.freedoms} data: {before} before, {after} after (prior included), probability {found.probability:.2g}."]
    notes.append(f"Frequencies in Hz{', gains in metres at the gauge per metre of free stroke' if gains else ''}.")
    if len(gains) > _MOST_GAINS:
        notes.append(f"Of {len(gains)} gains the {_MOST_GAINS} that misfitted most; errors relative to the actuator's largest gain.")
    rows = [_residual(each) for each in (*modes, *gains[:_MOST_GAINS])]
    return make_table("Theory and test", heads, rows, notes=notes)


def combination_table(found: Updated) -> Table:
    """Combinations of numbers by how well the test tells them."""
    rows = [
        (
            Cell(", ".join(f"{part:+.2f} {name}" for name, part in each.direction.items() if abs(part) > 0.05)),
            number(each.singular_value, 3),
            percent(each.prior_variance_left, 2),
        )
        for each in found.combinations
    ]
    notes = ["In prior standard deviations. A singular value of 1 halves the prior variance; far below, the test tells nothing."]
    return make_table(
        "Combinations that the test tells", ["combination", Column("singular value"), Column("variance left")], rows, notes=notes
    )


def _residual(each: Residual) -> tuple[Cell | str, ...]:
    first, last = each.misfit_before, each.misfit_after
    mark = Mark.PASS if abs(last) < 2.0 else Mark.WARN if abs(last) < 3.0 else Mark.FAIL
    texts = (number(each.measured, 6), number(each.before, 6), number(each.after, 6), number(100.0 * each.deviation, 2))
    return (Cell(each.name, Mark.STRONG), *texts, _signed(first), Cell(_signed(last), mark))


def _signed(value: float) -> str:
    return f"{value:+.3g}" if value else "0"
