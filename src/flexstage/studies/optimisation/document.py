"""Bodies of the documents of optimisations."""

from __future__ import annotations

from typing import Any

from flexstage.analysis.requirements import Requirement, Verdict
from flexstage.base.document import Document
from flexstage.studies.optimisation.result import Front, Optimum, Start
from flexstage.studies.optimisation.rounding import values_of
from flexstage.studies.optimisation.values import Point
from flexstage.studies.optimisation.wanted import Wanted
from flexstage.studies.sweeps.definition import Study


def optimise_body(found: Optimum) -> Document:
    """The optimum with variables, limits, prices and starts, all in SI.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> from flexstage.studies.optimisation.optimum import optimise
    >>> optimise_body(optimise(*leaf_study()))["agreeing"]
    2
    """
    near = found.rounded
    return {
        **_common(found.study, found.wanted),
        "before": _design(found, found.before),
        "optimum": None if found.point is None else _design(found, found.point),
        "rounded": None if near is None or near.point is None else {**_design(found, near.point), "loss": near.loss, "tried": near.tried},
        "binding": [
            {"name": each.name, "limit": each.limit, "unit": each.unit, "price": each.price, "range": each.of_range}
            for each in found.binding
        ],
        "starts": [_start(each) for each in found.starts],
        "agreeing": found.agreeing,
        "idle": list(found.idle),
        "evaluated": found.evaluated,
        "interrupted": found.interrupted,
    }


def front_body(found: Front) -> Document:
    """The designs of a front, all in SI."""
    return {
        **_common(found.study, found.wanted),
        "before": _design(found, found.before),
        "front": [_design(found, point) for point in found.points],
        "idle": list(found.idle),
        "evaluated": found.evaluated,
        "interrupted": found.interrupted,
    }


def _common(study: Study, wanted: Wanted) -> dict[str, Any]:
    return {
        "study": study.name,
        "objectives": [
            {
                "name": each.name,
                "measure": each.measure.key,
                "point": each.measure.point,
                "unit": each.measure.quantity.si,
                "aim": each.aim.value,
            }
            for each in wanted.objectives
        ],
        "variables": [
            {
                "name": each.name,
                "addresses": list(each.addresses),
                "unit": each.quantity.si,
                "from": each.low,
                "to": each.high,
                "relative": each.relative,
                "step": each.step,
            }
            for each in study.variables
        ],
        "seed": wanted.seed,
    }


def _design(found: Optimum | Front, point: Point) -> dict[str, Any]:
    first = len(found.wanted.objectives)
    values = values_of(found.study, point.shares).tolist()
    return {
        "variables": dict(zip((each.name for each in found.study.variables), values, strict=True)),
        "objectives": {each.name: float(point.values[number]) for number, each in enumerate(found.wanted.objectives)},
        "limits": [_limit(each, float(point.values[first + number])) for number, each in enumerate(found.limits)],
    }


def _limit(limit: Requirement, value: float) -> dict[str, Any]:
    import numpy as np

    verdict = Verdict(limit, np.asarray(value))
    return {
        "measure": limit.key,
        "point": limit.point,
        "demand": limit.text,
        "value": value,
        "margin": float(verdict.margin),
        "passed": bool(verdict.passed),
    }


def _start(each: Start) -> dict[str, Any]:
    return {
        "begun": each.begun.tolist(),
        "ended": each.ended.tolist(),
        "objective": each.value,
        "violation": each.violation,
        "evaluated": each.evaluated,
        "converged": each.converged,
        "agrees": each.agrees,
        "history": [{"objective": value, "violation": violation} for value, violation in each.history.tolist()],
        "reason": each.reason,
    }
