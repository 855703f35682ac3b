"""Design file of an updated stage: the original text with new values and their provenance; comments are kept."""

from __future__ import annotations

from flexstage.experiment.updating.update import Identifiability, Updated
from flexstage.mechanism.store import patch
from flexstage.mechanism.store.retag import set_tags

_DIGITS = 7


def updated_text(text: str, found: Updated, record: str, *, where: str = "text") -> str:
    """Format the stage's design file with the updated values, each tagged `derived update RECORD` with its standard deviation.

    Raises `DesignError` if the file's layout does not allow the change.
    """
    values = {name: float(f"{value:.{_DIGITS}g}") for name, value in zip(found.addresses, found.after.tolist(), strict=True)}
    tags = {name: _tag(found, index, record) for index, name in enumerate(found.addresses)}
    return set_tags(patch(text, values, where=where), tags, where=where)


def _tag(found: Updated, index: int, record: str) -> str:
    known = {Identifiability.NOT: f"not identifiable from {found.data}", Identifiability.WITHHELD: "theory and test contradict each other"}
    return f"derived update {record}, {known.get(found.identifiability[index], f'+- {100.0 * found.deviations[index]:.2g} %')}"
