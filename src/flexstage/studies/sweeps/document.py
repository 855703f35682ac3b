"""Body of the document of a study of many designs."""

from __future__ import annotations

from itertools import combinations
from typing import Any

from flexstage.base.document import Document
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.effects import Effects
from flexstage.studies.sweeps.store import Results


def sweep_body(study: Study, results: Results, found: Effects) -> Document:
    """Variables, responses with their distributions, effects, failures; the designs themselves are in the results file."""
    plan = study.plan
    return {
        "study": study.name,
        "sampling": plan.sampling.value,
        "seed": plan.seed,
        "designs": {"planned": results.planned, "computed": len(results.designs), "failed": len(results.failures)},
        "variables": [
            {
                "name": each.name,
                "addresses": list(each.addresses) if each.variant is None else [],
                "parameters": [] if each.variant is None else list(each.addresses),
                "unit": each.quantity.si,
                "from": each.low,
                "to": each.high,
                "relative": each.relative,
            }
            for each in study.variables
        ],
        "responses": [_response(study, found, index, name) for index, name in enumerate(found.responses)],
        "failures": [{"design": design, "reason": reason} for design, reason in results.failures.items()],
        "method": found.method,
        "made": list(results.made),
    }


def _response(study: Study, found: Effects, index: int, name: str) -> dict[str, Any]:
    measure = study.columns[name]
    total = None if found.total is None else found.total[:, index]
    return {
        "name": name,
        "measure": measure.key,
        "point": measure.point,
        "unit": measure.quantity.si,
        "least": float(found.low[index]),
        "mean": float(found.mean[index]),
        "deviation": float(found.deviation[index]),
        "largest": float(found.high[index]),
        "first_order": dict(zip(found.variables, found.first[:, index].tolist(), strict=True)),
        "total_order": None if total is None else dict(zip(found.variables, total.tolist(), strict=True)),
        "standard_error": float(found.errors[0, index]),
        "pairs_standard_error": float(found.errors[1, index]),
        "pairs": [
            {"variables": [found.variables[first], found.variables[second]], "share": float(found.pairs[first, second, index])}
            for first, second in combinations(range(len(found.variables)), 2)
        ],
    }
