"""Evaluation of a study's designs in batches, with isolation of failed designs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.number import Array
from flexstage.mechanism.checks import require_valid
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.engine import Engine, engine_of
from flexstage.studies.sweeps.loaded import unstable_designs

_LONGEST_REASON = 400
_MOST = 256
"""Number of designs evaluated at once; the matrices of more designs do not fit into a processor's cache."""

Reasons = dict[int, str]
"""Reasons for the failures of designs, by row number."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Designs from number `start`: variables (n, d) and responses (n, r) in SI.

    `failures` contains the reasons for failed designs by row; their responses are NaN. `made` contains the versions of the programs; with
    different versions, the last digits may differ.
    """

    start: int
    variables: Array
    responses: Array
    failures: Mapping[int, str]
    made: str = ""


def piece(study: Study, start: int, stop: int, engine: Engine | None = None) -> Piece:
    """Compute the designs `start` to `stop` (excluded) of a study's plan. If `engine` is absent, the study's own engine is made.

    For an invalid design, or a design without a value, the responses are NaN, and `failures` contains the reason.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> found = piece(neck_study(), 0, 2)
    >>> found.responses.shape, dict(found.failures)
    ((2, 1), {})
    """
    values = study.sample(start, stop)
    engine = engine_of(study) if engine is None else engine
    with np.errstate(all="ignore"):
        responses, failures = _compute(study, values, engine)
    return Piece(start, values, responses, failures, engine.provenance)


def nominal(study: Study) -> Array:
    """Compute responses (r,) of the nominal design. Raises `DesignError` for measures that this stage does not have.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> nominal(neck_study()).round(0).tolist()
    [106.0]
    """
    found = study.evaluate(require_valid(study.design))
    named = zip(study.columns, found, strict=True)
    require(Finding(f"responses.{name}", value, "Use measures of this stage") for name, value in named if isinstance(value, str))
    return np.array([float(np.real(value)) for value in found if not isinstance(value, str)])


def _compute(study: Study, values: Array, engine: Engine) -> tuple[Array, Reasons]:
    """Responses (n, r) and failures. Designs without a certain result of the engine are evaluated separately."""
    columns = tuple(study.columns)
    others = tuple(name for name in columns if name not in engine.modes)
    result = np.full((len(values), len(columns)), np.nan)
    failures = _bisect(values, 0, lambda part: _check(study, part))[1]
    sound = np.setdiff1d(np.arange(len(values)), list(failures))
    if engine.loaded:
        failures |= {int(sound[row]): reason for row, reason in unstable_designs(study, values[sound]).items()}
        sound = np.setdiff1d(sound, list(failures))
    # measures along paths are sequential also in a batch, and slowest without an equilibrium
    apart = any(study.columns[name].kind.along or study.columns[name].path for name in others)
    found, reasons = _bisect(values[sound], len(others), lambda part: _batch(study, part, others), apart=apart)
    frequencies, sure = engine.answers(values[sound])
    for names, part in ((others, found), (engine.modes, frequencies)):
        result[np.ix_(sound, np.array([columns.index(name) for name in names], dtype=int))] = part
    for place in np.flatnonzero(~sure):
        result[sound[place]], reason = _bisect(values[sound[[place]]], len(columns), lambda part: _batch(study, part, columns))
        reasons |= {int(place): text for text in reason.values()}
    failures |= {int(sound[place]): reason for place, reason in reasons.items()}
    lost = np.flatnonzero(~np.all(np.isfinite(result), axis=-1))
    reasons = {int(row): failures.get(int(row)) or _missing_values(study, result[row]) for row in lost}
    result[lost] = np.nan
    return result, reasons


def _bisect(values: Array, width: int, batch: Callable[[Array], Array | str], *, apart: bool = False) -> tuple[Array, Reasons]:
    """Results of a batch (n, width), and failures; a failed batch is halved until failures are isolated, or divided at once if `apart`.

    Large batches of full evaluations (`width` responses) are halved first, because of the memory of their matrices.
    """
    whole = width == 0 or len(values) <= _MOST
    found = batch(values) if whole else ""
    if not isinstance(found, str):
        return found, {}
    if len(values) == 1:
        return np.full((1, width), np.nan), {0: found[:_LONGEST_REASON]}
    starts = np.arange(len(values)) if apart and whole else np.array([0, len(values) // 2])
    parts = [_bisect(part, width, batch, apart=apart) for part in np.split(values, starts[1:])]
    reasons = {int(start + row): reason for start, (_, each) in zip(starts, parts, strict=True) for row, reason in each.items()}
    return np.concatenate([part for part, _ in parts]), reasons


def _check(study: Study, values: Array) -> Array | str:
    """Reason why these designs cannot be evaluated; (n, 0) otherwise. A single design has no position in a batch."""
    try:
        require_valid(study.mechanism_for(values if len(values) > 1 else values[0]))
    except DesignError as error:
        return str(error)
    return np.zeros((len(values), 0))


def _batch(study: Study, values: Array, names: tuple[str, ...]) -> Array | str:
    """Responses (n, r) of these designs by name, or the reason of a failure."""
    if not names or not len(values):
        return np.zeros((len(values), len(names)))
    try:
        mechanism = study.mechanism_for(values)
        found = study.evaluate(mechanism) if len(names) == len(study.columns) else study.evaluate(mechanism, names)
    except (DesignError, np.linalg.LinAlgError) as error:
        return str(error)
    reasons = [value for value in found if isinstance(value, str)]
    if reasons:
        return "; ".join(dict.fromkeys(reasons))
    return np.stack([np.broadcast_to(np.real(value), len(values)) for value in found if not isinstance(value, str)], axis=-1)


def _missing_values(study: Study, values: Array) -> str:
    missing = [measure.key for measure, value in zip(study.columns.values(), values, strict=True) if not np.isfinite(value)]
    return f"{', '.join(missing)}: no finite value"
