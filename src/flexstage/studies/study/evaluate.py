"""Designs of a study computed: a batch at once, failures found one by one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.analysis.requirements import Measure
from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.number import Array
from flexstage.mechanism.checks import checked
from flexstage.studies.study.definition import Study

_LONGEST_REASON = 400


@dataclass(frozen=True, eq=False)
class Piece:
    """Designs from `start` on: variables (n, d) and responses (n, r) in SI; `failures` gives reasons by row, their responses are NaN."""

    start: int
    variables: Array
    responses: Array
    failures: Mapping[int, str]


def piece(study: Study, start: int, stop: int) -> Piece:
    """Compute the designs from `start` to before `stop` of a study's plan.

    A design that cannot be read, or lacks a value, keeps its place: NaN and the reason.

    >>> from flexstage.studies.study.example import neck_study
    >>> found = piece(neck_study(), 0, 2)
    >>> found.responses.shape, dict(found.failures)
    ((2, 1), {})
    """
    values = study.drawn(start, stop)
    with np.errstate(all="ignore"):
        responses, failures = _computed(study, values)
    return Piece(start, values, responses, failures)


def nominal(study: Study) -> Array:
    """Responses (r,) of the design as it stands. Raises `DesignError` for measures that this stage does not have.

    >>> from flexstage.studies.study.example import neck_study
    >>> nominal(neck_study()).round(0).tolist()
    [106.0]
    """
    found = study.answered(checked(study.design))
    named = zip(study.columns, found, strict=True)
    require(Finding(f"responses.{name}", value, "Ask for what this stage has") for name, value in named if isinstance(value, str))
    return np.array([float(np.real(value)) for value in found if not isinstance(value, str)])


def _computed(study: Study, values: Array) -> tuple[Array, dict[int, str]]:
    """Responses (n, r) and failures; what fails as a batch is halved until the culprits stand alone."""
    found = _batch(study, values)
    count = len(values)
    if not isinstance(found, str):
        lost = np.flatnonzero(~np.all(np.isfinite(found), axis=-1))
        return found, {int(row): _unfinished(tuple(study.columns.values()), found[row]) for row in lost}
    if count == 1:
        return np.full((1, len(study.columns)), np.nan), {0: found[:_LONGEST_REASON]}
    half = count // 2
    first, early = _computed(study, values[:half])
    second, late = _computed(study, values[half:])
    return np.concatenate([first, second]), {**early, **{row + half: reason for row, reason in late.items()}}


def _batch(study: Study, values: Array) -> Array | str:
    """Responses (n, r) of all these designs, or why not."""
    try:
        found = study.answered(checked(study.described(values)))
    except (DesignError, np.linalg.LinAlgError) as error:
        return str(error)
    reasons = [value for value in found if isinstance(value, str)]
    if reasons:
        return "; ".join(dict.fromkeys(reasons))
    return np.stack([np.broadcast_to(np.real(value), len(values)) for value in found if not isinstance(value, str)], axis=-1)


def _unfinished(measures: tuple[Measure, ...], values: Array) -> str:
    missing = [measure.key for measure, value in zip(measures, values, strict=True) if not np.isfinite(value)]
    return f"{', '.join(missing)}: no finite value"
