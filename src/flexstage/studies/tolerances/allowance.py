"""Allowable tolerances: deviations for which every requirement reaches the required yield."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import scipy

from flexstage.analysis.assessment.requirements import Sense
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Called
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.tolerances.definition import Tolerance
from flexstage.studies.tolerances.slopes import Slopes
from flexstage.studies.tolerances.summary import Line, Summary, Yield, binomial, squares_alone

_DRAWS = 20_000
_NEGLIGIBLE = 1e-9


@dataclass(frozen=True)
class AllowedEntry:
    """Allowable factors on the deviations of one entry. The factors are infinite if these deviations have no effect.

    The factor `alone` is valid if the other entries are unchanged; the requirement `decided_by` limits this factor. For `equal_shares`, all
    entries change, and each uses the same fraction of the margin. `alone` and `equal_shares` are NaN (unknown) if any entry has an
    asymmetric interval.
    """

    name: str
    alone: float
    decided_by: str | None
    equal_shares: float


@dataclass(frozen=True, eq=False)
class Allowance:
    """Factors on the specified deviations for which each requirement has at least the yield `wanted`, to first order.

    `names` are the names of the m entries. `lines` are the names of the l requirements. `reach` (l,) is the change of a requirement's value
    towards its limit; the fraction `wanted` of the samples does not exceed this change. `share` (m, l) is the fraction of the square of
    `reach` due to each entry. `together` is the factor on all deviations, limited by the requirement `binding`; it is 0 if the nominal
    design has no margin or too many samples fail. `alone` (m,) are factors on single entries with the others unchanged; the requirements
    `binds` (m,) limit these factors. `equal` (m,) are simultaneous factors on all entries, for which each entry uses the same fraction of
    the margin. A factor is infinite if the entry has no effect. `alone` and `equal` are NaN (unknown) if a distribution has a mean other
    than zero (asymmetric interval). `then` is the yield if the changes of all responses in the sample are multiplied by `together`.
    """

    wanted: Annotated[float, Called("yield")]
    names: Annotated[tuple[str, ...], INNER]
    lines: Annotated[tuple[str, ...], INNER]
    margin: Array
    reach: Array
    by_slope: Array
    share: Array
    together: Annotated[float, Called("all_alike")]
    binding: Annotated[str, INNER]
    alone: Array
    binds: Annotated[tuple[str, ...], INNER]
    equal: Array
    then: Yield | None

    @property
    def decided_by(self) -> Annotated[str | None, VIEW]:
        """The requirement that limits the common factor of all deviations."""
        return self.binding or None

    @property
    def entries(self) -> Annotated[tuple[AllowedEntry, ...], VIEW]:
        """The allowable deviations of each entry of `[scatter]`."""
        parts = zip(self.names, self.alone.tolist(), self.binds, self.equal.tolist(), strict=True)
        return tuple(AllowedEntry(name, alone, binds or None, equal) for name, alone, binds, equal in parts)


def allowance(study: Tolerance, results: Results, slope: Slopes, found: Summary) -> Allowance:
    """Compute the allowable deviations for the specification. Without requirements, deviations are unlimited.

    Responses are linearised in the deviations if derivatives and sample agree. For other responses, the quantile of the sample is used,
    with variance contributions from the samples in which only one entry deviates. All changes of responses are assumed to be proportional
    to the deviations, which is accurate for small deviations.
    """
    names = tuple(study.columns)
    columns = [names.index(line.column) for line in found.lines]
    values = results.responses[results.designs < study.copies]
    by_slope = np.array([bool(found.spread.trusted[column]) for column in columns], dtype=bool)
    squares = squares_alone(study, results, slope.values)
    reach, shares = [], []
    for line, column, smooth in zip(found.lines, columns, by_slope, strict=True):
        reach.append(_linear_reach(study, line, slope.gradient[column]) if smooth else _reach(study, line, values[:, column]))
        shares.append(_normalise((found.spread.by_slope if smooth else squares)[:, column]))
    margin = np.array([line.margin for line in found.lines])
    share = np.reshape(shares, (-1, len(study.scatters))).T
    room = _margin_ratio(margin, np.array(reach))
    labels = tuple(line.column for line in found.lines)
    unknown = np.nan if any(each.distribution.offset for each in study.scatters) else 0.0
    left = room**2 - (1.0 - share)
    with np.errstate(divide="ignore", invalid="ignore"):
        alone = np.where(share > _NEGLIGIBLE, np.sqrt(np.maximum(left, 0.0) / share), np.inf) + unknown
        equal = np.where(share > _NEGLIGIBLE, room / np.sqrt(len(share) * share), np.inf) + unknown
    together = float(np.min(room, initial=np.inf))
    return Allowance(
        wanted=study.wanted,
        names=tuple(each.name for each in study.scatters),
        lines=labels,
        margin=margin,
        reach=np.array(reach),
        by_slope=by_slope,
        share=share,
        together=together,
        binding=labels[np.argmin(room)] if np.isfinite(together) else "",
        alone=np.min(alone, axis=1, initial=np.inf),
        binds=tuple(labels[np.argmin(row)] if labels and np.isfinite(np.min(row)) else "" for row in alone),
        equal=np.min(equal, axis=1, initial=np.inf),
        then=_scaled_yield(found.lines, together, values[:, columns]),
    )


def _margin_ratio(margin: Array, reach: Array) -> Array:
    """Margins over changes; zero without a margin or with infinite changes (failed samples), infinite without an effect."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(margin <= 0.0, 0.0, np.where(reach > 0.0, margin / reach, np.inf))


def _normalise(parts: Array) -> Array:
    parts = np.nan_to_num(parts)
    whole = np.sum(parts)
    return parts / whole if whole > 0.0 else np.zeros_like(parts)


def _sign(line: Line) -> float:
    return 1.0 if line.requirement.sense is Sense.AT_LEAST else -1.0


def _reach(study: Tolerance, line: Line, values: Array) -> float:
    """Largest change towards the limit of the required share of the sample; failed samples are infinitely far."""
    worse = np.where(np.isfinite(values), -_sign(line) * (values - line.nominal), np.inf)
    return float(np.quantile(worse, study.wanted, method="higher"))


def _linear_reach(study: Tolerance, line: Line, gradient: Array) -> float:
    """The same for a response that is linear in the deviations: exact for normal ones, else by sampling of their distributions."""
    deviations = study.deviations
    if not any(each.bounded for each in deviations):
        size = np.array([each.deviation for each in deviations])
        return float(scipy.special.ndtri(study.wanted) * np.linalg.norm(gradient * size))
    at = np.random.default_rng(0).random((_DRAWS, len(deviations))).T
    worse = -_sign(line) * sum(slope * each.at(row) for each, slope, row in zip(deviations, gradient, at, strict=True))
    return float(np.quantile(worse, study.wanted))


def _scaled_yield(lines: tuple[Line, ...], factor: float, values: Array) -> Yield | None:
    """The sample's yield with all changes multiplied by a factor."""
    if not lines or not np.isfinite(factor):
        return None
    sign = np.array([_sign(line) for line in lines])
    nominal, margin = np.array([line.nominal for line in lines]), np.array([line.margin for line in lines])
    spare = margin + factor * sign * (values - nominal)
    return binomial(np.all(np.nan_to_num(spare, nan=-np.inf) >= -_NEGLIGIBLE * np.abs(nominal), axis=1))
