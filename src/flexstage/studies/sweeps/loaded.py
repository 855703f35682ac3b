"""Stability of a study's designs under their permanent load, and the smallest load factor over the ranges."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.loaded.load_effect import SIGNIFICANT
from flexstage.analysis.loaded.stability import DOUBTFUL, stability
from flexstage.analysis.loaded.standing import load_factors
from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.number import Array
from flexstage.base.session import SESSION
from flexstage.mechanism.checks import require_valid
from flexstage.models.lumped import lumped
from flexstage.studies.sweeps.definition import Study

_ENDS = 8
"""Largest number of variables for which all range ends are checked; for more variables, the first designs of the plan are checked."""
_FIRST = 16
_AT_ONCE = 64
_MARGIN = 2.0
"""Assumed ratio between the load factor at the range ends and that of a design between them."""


def needs_load_check(study: Study) -> bool:
    """Return whether the stability of each design must be checked, because the smallest load factor at the ends of the ranges is low.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> needs_load_check(neck_study())
    False
    """
    return _least(study)[0] < _MARGIN * DOUBTFUL


def unstable_designs(study: Study, values: Array) -> dict[int, str]:
    """Find which designs, with `values` (n, d) of the variables, are unstable under permanent load. Returns the reasons by row number.

    Designs without an elastic model are omitted.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> unstable_designs(neck_study(), np.array([[0.00154]]))
    {}
    """
    factors = _factors(study, values)
    return {
        int(row): f"stage: unstable under weight, payloads and forces (load factor {factors[row]:.3g})"
        for row in np.flatnonzero(factors < 1.0)
    }


def loaded_findings(study: Study) -> tuple[Finding, ...]:
    """Report the smallest load factor at the ends of the variables' ranges, if weight, payloads and forces are significant.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> loaded_findings(neck_study())
    ()
    """
    least, values = _least(study)
    if least >= 1.0 / SIGNIFICANT:
        return ()
    where = ", ".join(f"{each.name} {each.text(float(value))}" for each, value in zip(study.variables, values, strict=True))
    effect = f"stiffness is up to {100.0 / least:.2g} % lower than computed" if least >= 1.0 else "designs with a factor below 1 fail"
    what = f"weight, payloads and forces reduce stiffness: smallest load factor {least:.3g} ({where}); {effect}"
    advice = (
        'Add to [limits] e.g. buckling = "at least 20"'
        if least < DOUBTFUL
        else "Use measures over a path, which include these loads, e.g. stiffness.x over NAME"
    )
    return (Finding("variables", what, advice),)


def require_stable(study: Study, values: Array) -> tuple[Finding, ...]:
    """Return the warnings about the design with `values` (d,) under its permanent load. Raises `DesignError` if the design is unstable.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> require_stable(neck_study(), np.array([0.00154]))
    ()
    """
    factors = load_factors(study.mechanism_for(values))
    if factors is None:
        return ()
    advice = 'Add to [limits] e.g. buckling = "at least 2"'
    require(Finding("the best design", each.what, advice) for each in factors.refusals)
    return tuple(Finding("the best design", each.what, each.advice) for each in factors.warnings)


@SESSION.keep(2)
def _least(study: Study) -> tuple[float, Array]:
    """The smallest load factor among the ends of every range, others nominal, and the corner of the worse ends; and the values there."""
    probes = _probes(study)
    factors = _factors(study, probes)
    if len(study.variables) <= _ENDS:
        pairs = factors[1:].reshape(-1, 2)
        corner = np.where(pairs[:, 0] <= pairs[:, 1], *probes[1:].reshape(-1, 2, len(study.variables)).diagonal(axis1=0, axis2=2))[None]
        probes, factors = np.concatenate([probes, corner]), np.concatenate([factors, _factors(study, corner)])
    worst = int(np.argmin(factors))
    return float(factors[worst]), probes[worst]


def _probes(study: Study) -> Array:
    """The nominal design and the low and high end of each variable in turn; of many variables the first designs."""
    if len(study.variables) > _ENDS:
        return study.sample(0, min(_FIRST, study.plan.designs))
    drawn = np.array([np.clip(each.nominal(study.design), each.low, each.high) for each in study.variables])
    found = np.tile(drawn, (1 + 2 * len(drawn), 1))
    for place, each in enumerate(study.variables):
        found[1 + 2 * place, place], found[2 + 2 * place, place] = each.low, each.high
    return found


def _factors(study: Study, values: Array) -> Array:
    """Load factors (n,) of the permanent load; infinite without an elastic model."""
    if len(values) > _AT_ONCE:
        return np.concatenate([_factors(study, values[start : start + _AT_ONCE]) for start in range(0, len(values), _AT_ONCE)])
    try:
        mechanism = require_valid(study.mechanism_for(values))
        return np.broadcast_to(np.real(stability(mechanism, lumped(mechanism)).dead), len(values))
    except (DesignError, np.linalg.LinAlgError):
        if len(values) == 1:
            return np.full(1, np.inf)
        return np.concatenate([_factors(study, values[[row]]) for row in range(len(values))])
