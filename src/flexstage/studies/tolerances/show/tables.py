"""Tables of tolerance studies."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.show.display import display_unit_of, format_value, number
from flexstage.show.table import Cell, Column, Mark, Table, make_table, result_table
from flexstage.spatial.frame import COMPONENTS
from flexstage.studies.sweeps.show.tables import failure_table, share_cell
from flexstage.studies.tolerances.allowance import Allowance
from flexstage.studies.tolerances.crosstalk import OPEN
from flexstage.studies.tolerances.distribution import Distribution, Shape
from flexstage.studies.tolerances.run import Toleranced
from flexstage.studies.tolerances.scatter import Scatter
from flexstage.studies.tolerances.summary import Crosstalk

_FAR = 10.0
_FINE = 1e3
_COLUMNS = (
    "alone: other entries have the specified deviations. equal shares: each entry uses the same fraction of the margin. common factor: "
    "the deviations of all entries have the same factor. alone and equal shares are unknown (-) if any entry has an asymmetric interval."
)
_NO_YIELD = "No yield, because neither [requirements] of the design nor [limits] of the study define a specification."


def tolerance_tables(found: Toleranced) -> list[Table | None]:
    """Tabulate scatter, yield, distributions of responses, variance contributions, allowable tolerances and crosstalk."""
    tables: list[Table | None] = [scatter_table(found), yield_table(found), spread_table(found), share_table(found)]
    if found.summary.lines:
        tables.append(allowance_table(found))
    tables += [crosstalk_table(found, each) for each in found.summary.crosstalk]
    return [*tables, *([failure_table(found.results)] if found.results.failures else [])]


def scatter_table(found: Toleranced) -> Table:
    """Tabulate the deviations, and the addresses of the numbers that deviate."""
    rows = [
        (Cell(each.name, Mark.STRONG), ", ".join(each.source), distribution_text(each, each.distribution), _reach_text(each))
        for each in found.study.scatters
    ]
    plan = found.study.plan
    copies = f"{found.summary.copies} samples of {found.study.design.name}, {plan.sampling.value}, seed {plan.seed}"
    alone = getattr(plan, "alone", 0)
    notes = [f"{copies}." + (f" In addition, {alone} samples with the scatter of each entry alone." if alone else "")]
    return make_table("Scatter", ["", "number", "deviation", "applies to"], rows, notes=notes)


def _reach_text(scatter: Scatter) -> str:
    count = len(scatter.members)
    if scatter.independent:
        return f"each of {count}"
    reached = sum(len(member) for member in scatter.members)
    return f"common to {reached}" if reached > 1 else "one"


def distribution_text(scatter: Scatter, distribution: Distribution) -> str:
    """Format a distribution as text: `5 um (sigma), within 10 um`.

    >>> from flexstage.studies.tolerances.example import leaf_study
    >>> [distribution_text(each, each.distribution) for each in leaf_study().scatters]
    ['5 um (sigma)', '+-5 um']
    """
    text = _size(scatter, distribution.size)
    if distribution.offset:
        half = distribution.within or distribution.size
        low, high = (_size(scatter, distribution.offset + sign * half) for sign in (-1.0, 1.0))
        return f"{low} to {high}" + (f", {text} (sigma)" if distribution.shape is Shape.NORMAL else "")
    if distribution.shape is Shape.UNIFORM:
        return f"+-{text}"
    return f"{text} (sigma)" + (f", within +-{_size(scatter, distribution.within)}" if distribution.within is not None else "")


def _size(scatter: Scatter, value: float) -> str:
    return f"{number(100.0 * value, 4)} %" if scatter.relative else format_value(value, scatter.quantity.si, 4)


def yield_table(found: Toleranced) -> Table | None:
    """Tabulate each requirement with its nominal value and its yield. Without requirements, state why there is no yield."""
    together, failed = found.summary.together, found.summary.failed
    if together is None:
        return make_table("Yield", [""], [(_NO_YIELD,)])
    interval = f"95 % interval {_percent(together.low)} to {_percent(together.high)} %"
    notes = [f"All requirements: {_percent(together.share)} % ({interval})."]
    notes += [f"{failed} of {found.summary.copies} samples failed and count as violations."] if failed else []
    return result_table(found.summary.lines, notes=notes)


def _percent(share: float) -> str:
    return f"{100.0 * share:.2f}"


def spread_table(found: Toleranced) -> Table:
    """Tabulate the distributions of the responses."""
    spread, rows = found.summary.spread, []
    for column, (name, measure) in enumerate(found.study.measures.items()):
        values = [
            spread.nominal[column],
            spread.mean[column],
            spread.deviation[column],
            *spread.percentiles[:, column],
            spread.linear[column],
        ]
        largest = float(np.nanmax(np.abs(values[:-1]), initial=0.0))
        form = display_unit_of(measure.quantity.si, largest)
        cells = [number(float(value) * form.factor, 4) for value in values]
        if not spread.trusted[column]:
            cells[-1] = "-"
        rows.append((Cell(name, Mark.STRONG), "" if form.unit == "1" else form.unit, *cells))
    heads = ["nominal", "mean", "deviation", "1 %", "5 %", "median", "95 %", "99 %", "linear"]
    note = "linear: standard deviation to first order, with exact derivatives. -: the response is nonlinear, or not smooth."
    return make_table("Responses", ["response", "unit", *(Column(head) for head in heads)], rows, notes=[note])


def share_table(found: Toleranced) -> Table:
    """Tabulate the variance contributions of the entries to each response."""
    spread, rows, sampled = found.summary.spread, [], False
    for column, name in enumerate(found.study.measures):
        trusted = bool(spread.trusted[column])
        sampled |= not trusted
        shares = (spread.by_slope if trusted else spread.by_sample)[:, column]
        rows.append((Cell(name, Mark.STRONG), *(share_cell(float(value), "{:.1f}" if trusted else "~{:.1f}") for value in shares)))
    heads: list[Column | str] = ["response", *(Column(each.name, "%") for each in found.study.scatters)]
    about = "~: variance of samples in which only this entry deviates, relative to the sum of these variances over all entries."
    return make_table(
        "Variance contributions", heads, rows, notes=["Fractions of the variance, by exact derivatives.", *([about] if sampled else [])]
    )


def allowance_table(found: Toleranced) -> Table:
    """Tabulate the allowable deviation of each entry."""
    allowed = found.allowance
    rows = [
        (
            Cell(each.name, Mark.STRONG),
            _size(each, each.distribution.size),
            _scaled_size(each, float(allowed.alone[index])),
            allowed.binds[index],
            _scaled_size(each, float(allowed.equal[index])),
            _scaled_size(each, allowed.together),
        )
        for index, each in enumerate(found.study.scatters)
    ]
    heads = ["", Column("specified"), Column("alone"), "limited by", Column("equal shares"), Column("common factor")]
    return make_table("Allowable tolerances", heads, rows, notes=_allowed_notes(allowed))


def _scaled_size(scatter: Scatter, factor: float) -> Cell:
    if factor > _FAR:
        return Cell(f"> {_size(scatter, _FAR * scatter.distribution.size)}", Mark.FAINT)
    mark = Mark.FAIL if factor < 1.0 else Mark.PLAIN
    return Cell("none" if factor == 0.0 else _size(scatter, factor * scatter.distribution.size), mark)


def _allowed_notes(allowed: Allowance) -> list[str]:
    notes = [f"For a yield of {100.0 * allowed.wanted:g} % of each requirement, to first order. {_COLUMNS}"]
    if allowed.together == 0.0:
        return [
            *notes,
            f"{allowed.binding} leaves no tolerance: the nominal design has no margin to it, or too many samples have no value.",
        ]
    if allowed.then is not None and allowed.together <= _FAR:
        then = f"With all changes multiplied by this factor, the yield of the sample is {_percent(allowed.then.share)} %"
        notes.append(f"Common factor: {number(allowed.together, 3)}, limited by {allowed.binding}. {then}.")
    return notes


def crosstalk_table(found: Toleranced, crosstalk: Crosstalk) -> Table:
    """Tabulate standard deviations of the pose per unit of command. A note contains the largest crosstalk of all samples."""
    opened = crosstalk.kind == OPEN
    title = "Crosstalk in open loop, with the nominal R_a" if opened else "Crosstalk in closed loop, with the nominal R_s^-1"
    heads = [Column("", numeric=False), *(Column(name, "urad" if name.startswith("r") else "um") for name in crosstalk.coordinates)]
    rows = [
        [Cell(f"{row} [{'nrad' if row.startswith('r') else 'nm'}]", Mark.STRONG), *(_entry(value) for value in values)]
        for row, values in zip(COMPONENTS, crosstalk.deviation, strict=True)
    ]
    reference = ", ".join(number(round(1e3 * float(value), 6) + 0.0, 6) for value in _reference(found))
    where = f"At {crosstalk.point}, ({reference}) mm"
    note = f"{where}: standard deviation over the samples, in row unit per unit of command. Diagonal: standard deviation of the gain."
    how = "The command corrects the nominal lost motion, with voltages of the nominal stacks" if opened else "The loop is ideal"
    return make_table(title, heads, rows, notes=[note, f"{_worst(crosstalk)} {how}."])


def _reference(found: Toleranced) -> Array:
    return found.study.commanded.reference if found.study.commanded is not None else np.zeros(3)


def _entry(value: float) -> Cell:
    scaled = _FINE * float(value)
    return Cell("0", Mark.FAINT) if scaled <= 1e-3 else Cell(number(scaled, 3))


def _worst(crosstalk: Crosstalk) -> str:
    """The worst samples' motion along axes without a command, translations and rotations separately."""
    parts = []
    for rows, unit in ((slice(0, 3), "nm"), (slice(3, 6), "nrad")):
        for kind, per in (("", "um"), ("r", "urad")):
            columns = [index for index, name in enumerate(crosstalk.coordinates) if name.startswith("r") == bool(kind)]
            off = np.array([[row != crosstalk.coordinates[column] for column in columns] for row in COMPONENTS[rows]], dtype=bool)
            values = crosstalk.worst[rows][:, columns][off] if columns else np.zeros(0)
            if values.size and np.isfinite(values).all():
                parts.append(f"{number(_FINE * float(values.max()), 3)} {unit}/{per}")
    return f"Largest off-diagonal value of all samples: {', '.join(parts)}." if parts else ""
