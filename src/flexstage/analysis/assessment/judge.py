"""Evaluation of the requirements of a design file; only values with a requirement are computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from flexstage.analysis.assessment.measures import Measure, corner, safety_at_strokes, stroke, value_or_bound
from flexstage.analysis.assessment.requirements import Requirement, Sense, Verdict, requirements
from flexstage.analysis.bench import StageResults
from flexstage.analysis.workspace.stops import single_strokes
from flexstage.base.finding import DesignError, LowerBoundError
from flexstage.base.number import Array
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel


@dataclass(frozen=True)
class Estimate:
    """Values of requirements [SI] by key, and their estimated relative errors if known."""

    values: Mapping[str, float]
    errors: Mapping[str, float] = field(default_factory=dict)


def judge(mechanism: Mechanism, bench: StageResults | None = None) -> tuple[Verdict, ...]:
    """Evaluate every `[requirements]` line of a description by the lumped model; reuse the results of `bench` if present.

    If the permanent load changes stiffness or frequencies by 1 % or more, stiffness, frequencies, lost motion, corrected strokes and drift
    are those of the loaded stage. A requirement with an unknown value (e.g. a safety factor if no yield stress is specified) is not met,
    and its verdict contains the reason. Raises `DesignError` for unreadable requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [bool(verdict.passed) for verdict in judge(double_triangle())]
    [True, True, True, True, True, True, True, True]
    """
    bench = bench or bench_of(mechanism)
    return tuple(_verdict(bench, line) for line in requirements(mechanism))


def measure_all(mechanism: Mechanism, measures: tuple[Measure, ...]) -> tuple[Array | str, ...]:
    """Compute SI values (...) of measures by the lumped model, for one design or a batch. A missing value is replaced by the reason.

    Measures of simultaneous required strokes (corner, gauge.range) use the strokes in the `[requirements]` lines.

    >>> from flexstage.analysis.assessment.requirements import measure
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> round(float(measure_all(stage, (measure(stage, "frequency.platform.1", "here"),))[0]), 1)
    106.0
    """
    bench = bench_of(mechanism)
    return tuple(value_or_reason(bench, each) for each in measures)


def bench_of(mechanism: Mechanism) -> StageResults:
    """Create the results collector (bench) of one design or a batch.

    Measures of simultaneous strokes use the strokes in `[requirements]`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> bench_of(double_triangle()).command["x"]
    5e-05
    """
    lines = (line for line in requirements(mechanism) if line.kind is stroke and line.sense is Sense.AT_LEAST)
    return StageResults(mechanism, {line.name: line.limit for line in lines})


def required_values(mechanism: Mechanism, model: LinearModel | None = None) -> dict[str, float]:
    """Return the values of a stage's requirements [SI], computed by a linear model (default: lumped). Unknown values are omitted.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> {key: round(value) for key, value in required_values(parallelogram()).items() if key.startswith("frequency")}
    {'frequency.platform.1': 875}
    """
    bench = bench_of(mechanism)
    if model is not None:
        bench = bench.with_model(model)
    found = ((line.key, value_or_reason(bench, line)) for line in requirements(mechanism))
    return {key: float(np.real(value)) for key, value in found if not isinstance(value, str)}


def value_or_reason(bench: StageResults, asked: Measure) -> Array | str:
    """Compute the value (...) of one measure; if it is missing, return the reason.

    >>> from flexstage.analysis.assessment.requirements import measure
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> round(float(value_or_reason(bench_of(stage), measure(stage, "mass", "here"))), 2)
    14.0
    """
    try:
        return value_or_bound(asked.kind.value, bench, asked)
    except DesignError as error:
        return str(error)


def _verdict(bench: StageResults, line: Requirement) -> Verdict:
    load_dependent = line.kind.softening > 0.0 or line.kind.load_dependent
    try:
        drawn = Verdict(line, line.kind.value(bench.under_load if load_dependent else bench, line))
    except LowerBoundError as error:
        least = Verdict(line, np.asarray(error.bound))
        decided = bool(least.passed) is (line.sense is Sense.AT_LEAST)
        return least if decided else Verdict(line, None, str(error))
    except DesignError as error:
        return Verdict(line, None, str(error))
    weighed = load_dependent and bench.under_load is not bench
    doubt = ("" if weighed else _loaded_doubt(bench, drawn)) or _large_doubt(bench, drawn)
    return Verdict(line, None, doubt) if doubt else drawn


def _large_doubt(bench: StageResults, drawn: Verdict) -> str:
    """Reason why a fulfilled line on motion is unknown: the motion exceeds small displacements; empty if it does not."""
    line = drawn.requirement
    if drawn.value is None or np.ndim(drawn.value) or not drawn.passed:
        return ""
    if line.kind is stroke and line.sense is Sense.AT_LEAST:
        requested: Mapping[str, float] = {line.name: line.limit}
    elif line.kind in (corner, safety_at_strokes):
        requested = bench.box()
    elif line.kind.over_strokes and bench.kinematics.actuated:
        single = single_strokes(bench.mechanism, bench.kinematics)
        requested = dict(zip(single.coordinates, (float(each) for each in single.symmetric), strict=True))
    else:
        return ""
    doubt = bench.small_motion.doubt(requested)
    return f"withheld: {doubt}" if doubt else ""


def _loaded_doubt(bench: StageResults, drawn: Verdict) -> str:
    """Reason why the softened loaded stage may violate a line that the nominal stage fulfils; empty if it does not."""
    line = drawn.requirement
    power = line.kind.softening
    if not power or drawn.value is None or np.ndim(drawn.value) or not drawn.passed:
        return ""
    factor = float(np.real(bench.stability.dead))
    loaded = Verdict(line, drawn.value * (1.0 - 1.0 / factor) ** power)
    if loaded.passed:
        return ""
    return (
        f"withheld: the nominal value is {float(drawn.value):.4g} {line.quantity.si}, but weight softens the stage (load factor "
        f"{factor:.3g}), and the value may be only {float(np.asarray(loaded.value)):.4g} {line.quantity.si}"
    )
