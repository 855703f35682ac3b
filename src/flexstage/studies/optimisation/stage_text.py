"""The design file of an optimised stage: the original text and its comments, with the new values and their source."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.addresses.address import get
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import dumps, patch
from flexstage.mechanism.store.file import parse_toml, read_text
from flexstage.mechanism.store.retag import set_tags
from flexstage.studies.optimisation.problem import OptimisationProblem
from flexstage.studies.sweeps.definition import Study

_DIGITS = 12
_SAME = 1e-11


def design_path(study: Study, folder: Path) -> Path | None:
    """Return the path of a study's design file, or `None` for a shipped case.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> design_path(leaf_study()[0], Path()) is None
    True
    """
    named = parse_toml(study.text, "study").get("design") if study.text else None
    return None if named is None else folder / str(named)


def design_text(study: Study, folder: Path) -> str:
    """Return the text of a study's design file; for a shipped case, the text of a new design file.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> design_text(leaf_study()[0], Path()).splitlines()[0]
    '# The initial stage of the study "thicker leaves".'
    """
    path = design_path(study, folder)
    return read_text(path) if path is not None else dumps(study.design, {"": f'The initial stage of the study "{study.name}".'})


def write_optimum(text: str, study: Study, definition: OptimisationProblem, values: Array | Sequence[float], *, where: str = "text") -> str:
    """Write `values` (d,) of the study's variables into the text of a design file, with the tag `derived optimise STUDY, OBJECTIVE`.

    Raises `DesignError` if the layout of the file does not allow the changes.

    >>> from flexstage.mechanism.store import dumps, loads
    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> study, wanted = leaf_study()
    >>> text = write_optimum(dumps(study.design), study, wanted, [0.00123])
    >>> loads(text).parts["leaf"].thickness, loads(text).tags["parts.leaf.thickness"]
    (0.00123, 'derived optimise thicker leaves, maximise f1')
    """
    changed = dict(_changes(study, np.asarray(values, dtype=float)))
    aims = ", ".join(f"{each.direction.value} {each.name}" for each in definition.objectives)
    tags = dict.fromkeys(changed, f"derived optimise {study.name}, {aims}")
    return set_tags(patch(text, changed, where=where), tags, where=where)


def _changes(study: Study, values: Array) -> Iterator[tuple[str, float]]:
    """The changed numbers by address: those of one address each, and all that depend on parameters of a case."""
    final = study.mechanism_for(values)
    addresses = [address for each in study.variables if each.variant is None for address in each.addresses]
    if any(each.variant is not None for each in study.variables):
        addresses += [address for address, _, _ in node_of(Mechanism).numbers(study.design)]
    for address in dict.fromkeys(addresses):
        before, after = get(study.design, address), get(final, address)
        if isinstance(before, float) and abs(after - before) > _SAME * abs(before):
            yield address, float(f"{after:.{_DIGITS}g}")
