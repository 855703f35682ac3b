"""Tables of an update: parameters before and after, identifiability, and agreement of model and test."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.experiment.updating.update import Updated
from flexstage.show.display import number
from flexstage.show.table import Table, matrix_table, result_table

_MOST_GAINS = 12


def update_tables(found: Updated) -> Iterator[Table | None]:
    """List all tables of an update."""
    yield result_table(found.parameters, notes=found.notes, provenance=found.provenance)
    yield residual_table(found)
    if len(found.addresses) > 1:
        yield matrix_table("Correlations after the test", found.correlations)
        yield result_table(found.combinations)


def residual_table(found: Updated) -> Table | None:
    """Tabulate measured data with values of the initial and the updated model: all frequencies, and the gains with the largest misfit."""
    modes = [each for each in found.residuals if each.unit == "Hz"]
    gains = sorted((each for each in found.residuals if each.unit != "Hz"), key=lambda each: -abs(each.misfit_before))
    before, after = number(found.chi_square_before, 3), number(found.chi_square, 3)
    notes = [
        f"Chi-square of {found.freedoms} data: {before} before, {after} after (with priors); probability of more: {found.probability:.2g}."
    ]
    if len(gains) > _MOST_GAINS:
        notes.append(f"The table lists the {_MOST_GAINS} gains with the largest initial misfit (of {len(gains)} gains).")
    return result_table([*modes, *gains[:_MOST_GAINS]], notes=notes)
