"""Body of the document of a tolerance study."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.base.document import Document
from flexstage.base.number import Array
from flexstage.spatial.frame import COMPONENTS
from flexstage.studies.tolerances.run import Toleranced
from flexstage.studies.tolerances.scatter import Scatter
from flexstage.studies.tolerances.summary import PERCENTILES, Crosstalk, Line, Yield


def tolerance_body(found: Toleranced) -> Document:
    """What scatters, yields, distributions with their shares, what is allowed, crosstalk; the copies are in the results file."""
    study, said = found.study, found.summary
    return {
        "study": study.name,
        "sampling": study.plan.sampling.value,
        "seed": study.plan.seed,
        "copies": {"computed": said.copies, "failed": said.failed},
        "scatter": [_scatter(each) for each in study.scatters],
        "yield": None if said.together is None else {"all": _yield(said.together), "lines": [_line(each) for each in said.lines]},
        "responses": [_response(found, column, name) for column, name in enumerate(study.asked)],
        "allowed": _allowed(found) if said.lines else None,
        "crosstalk": [_crosstalk(each) for each in said.crosstalk],
        "failures": [{"copy": copy, "reason": reason} for copy, reason in found.results.failures.items()],
    }


def _scatter(each: Scatter) -> dict[str, Any]:
    distribution = each.distribution
    return {
        "name": each.name,
        "of": list(each.source),
        "each": each.each,
        "unit": each.quantity.si,
        "relative": each.relative,
        "shape": distribution.shape.value,
        "size": distribution.size,
        "within": distribution.within,
        "numbers": [list(member) for member in each.members],
    }


def _yield(kept: Yield) -> dict[str, Any]:
    return {"kept": kept.kept, "copies": kept.copies, "share": kept.share, "interval": [kept.low, kept.high]}


def _line(line: Line) -> dict[str, Any]:
    return {"line": line.column, "wanted": line.requirement.text, "nominal": line.nominal, "margin": line.margin, **_yield(line.kept)}


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _response(found: Toleranced, column: int, name: str) -> dict[str, Any]:
    spread, measure = found.summary.spread, found.study.asked[name]
    names = [each.name for each in found.study.scatters]
    return {
        "name": name,
        "measure": measure.key,
        "point": measure.point,
        "unit": measure.quantity.si,
        "nominal": _number(spread.nominal[column]),
        "mean": _number(spread.mean[column]),
        "deviation": _number(spread.deviation[column]),
        "percentiles": {str(at): _number(value) for at, value in zip(PERCENTILES, spread.percentiles[:, column], strict=True)},
        "linear_deviation": _number(spread.linear[column]),
        "linear": bool(spread.trusted[column]),
        "share_by_derivatives": {key: _number(value) for key, value in zip(names, spread.by_slope[:, column], strict=True)},
        "share_by_copies": {key: _number(value) for key, value in zip(names, spread.by_sample[:, column], strict=True)},
        "derivatives": {each.name: float(value) for each, value in zip(found.study.variables, found.slopes.gradient[column], strict=True)},
    }


def _allowed(found: Toleranced) -> dict[str, Any]:
    allowed = found.allowance
    return {
        "yield": allowed.wanted,
        "all_alike": _number(allowed.together),
        "decided_by": allowed.binding or None,
        "then": None if allowed.then is None else _yield(allowed.then),
        "entries": [
            {"name": each.name, "alone": _number(alone), "decided_by": binds or None, "equal_shares": _number(equal)}
            for each, alone, binds, equal in zip(found.study.scatters, allowed.alone, allowed.binds, allowed.equal, strict=True)
        ],
    }


def _crosstalk(each: Crosstalk) -> dict[str, Any]:
    values = {key: getattr(each, key) for key in ("nominal", "mean", "deviation", "usual", "worst")}
    return {
        "kind": each.kind,
        "point": each.point,
        "rows": list(COMPONENTS),
        "columns": list(each.coordinates),
        **{key: _matrix(value) for key, value in values.items()},
    }


def _matrix(values: Array) -> list[list[float | None]]:
    return [[_number(value) for value in row] for row in values]
