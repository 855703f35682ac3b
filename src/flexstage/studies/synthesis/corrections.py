"""Values of required quantities with elastic bodies or large displacements, and the limits that the search then needs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.analysis.assessment.judge import Estimate, bench_of, required_values
from flexstage.analysis.assessment.measures import clearance, safety_at_strokes, stroke
from flexstage.analysis.assessment.requirements import Requirement, Sense, Verdict, requirements
from flexstage.analysis.bench import StageResults
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.units.unit import show
from flexstage.mechanism.geometry.contact import TOUCHING, Gap, least_gap
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.flexible_bodies import body_flexibilities, with_flexible_bodies
from flexstage.models.nonlinear.elements.strain import strains
from flexstage.models.nonlinear.equilibrium import State, equilibrium, require_equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.stage import nonlinear
from flexstage.spatial.frame import COMPONENTS

_DIGITS = 9
_STEPS = 12
_SPARE = 5e-4
"""Fraction by which corrected limits are stricter, because ratios of models change between designs."""
_CLOSE = 1e-4
"""Largest deviation from the required displacement, relative to this displacement."""


Estimator = Callable[[Mechanism], Estimate]
"""Function that computes the required quantities of a stage by another model."""


def elastic_values(stage: Mechanism) -> Estimate:
    """Return the required quantities of a stage with elastic bodies, whose flexibility is estimated from outlines.

    Raises `DesignError` if the flexibility of a body is unknown, for example because its outlines are not connected.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> round(elastic_values(parallelogram()).values["frequency.platform.1"])
    866
    """
    known = body_flexibilities(stage)
    require(Finding(f"bodies.{name}", f"unknown flexibility: {reason}", "Connect its outlines") for name, reason in known.reasons.items())
    return Estimate(required_values(stage, with_flexible_bodies(bench_of(stage).model, stage, known.found)))


def displaced_values(stage: Mechanism) -> Estimate:
    """Return the worst value of each required quantity over the corners of the required displacements, with geometric nonlinearity.

    With more than three required displacements, only displacements along single axes are computed.

    Frequencies and stiffnesses are multiplied by the ratio of their value in a model linearised at a corner to their value in a model
    linearised at rest. Stresses include stretch. The lumped model's stroke is multiplied by the smallest ratio, over the corners, of the
    inputs of the linear model to the inputs of the nonlinear model. The resulting stroke suffices if and only if the actuators reach the
    corners. Quantities that do not depend on the displacement are left out. Raises `DesignError` if a corner has no equilibrium, or if
    outlines overlap there.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> {key: round(value) for key, value in displaced_values(parallelogram()).values.items() if key.startswith("frequency")}
    {'frequency.platform.1': 875}
    """
    bench, lines = bench_of(stage), requirements(stage)
    reached = _at_corners(bench)
    about, rest = bench.with_model(linearise(reached.state, inner=False)), bench.with_model(linearise(reached.rest, inner=False))
    found, gap = dict[str, float](), _least_gap(bench.mechanism, reached)
    if gap is not None and gap.distance < -TOUCHING:
        raise refuse(
            "motion", f"{gap.first} and {gap.second} overlap at a corner of the required displacements", "Reduce the displacements"
        )
    for line in lines:
        if line.kind.softening:
            values = np.real(line.kind.value(about, line)) / np.real(line.kind.value(rest, line)) * np.real(line.kind.value(bench, line))
            found[line.key] = float(np.min(values) if line.sense is Sense.AT_LEAST else np.max(values))
        elif line.kind is safety_at_strokes:
            of = strains(reached.state)
            found[line.key] = float(np.min(of.limit / np.max(of.stress, axis=0), initial=np.inf))
        elif line.kind is clearance and gap is not None:
            found[line.key] = gap.distance
        elif line.kind is stroke:
            found[line.key] = float(np.real(line.kind.value(bench, line))) * reached.ratio
    if unknown := [key for key, value in found.items() if np.isnan(value)]:
        raise refuse(unknown[0], "has no value at the corners of the required displacements", "Reduce the displacements")
    return Estimate({key: value for key, value in found.items() if np.isfinite(value)})


def _least_gap(stage: Mechanism, reached: _Corners) -> Gap | None:
    """The smallest gap of outlines over all states, displaced from rest; deformation of links is left out."""
    moved = {body: reached.state.twist(body) - reached.rest.twist(body) for body in reached.state.model.bodies}
    found = [least_gap(stage, {body: each[case] for body, each in moved.items()}) for case in range(len(reached.state.converged))]
    return min((each for each in found if each is not None), key=lambda each: each.distance, default=None)


@dataclass(frozen=True, eq=False)
class _Corners:
    """States at rest and at the corners of the required displacements, and the least ratio of linear to nonlinear inputs."""

    rest: State
    state: State
    ratio: float


def _at_corners(bench: StageResults) -> _Corners:
    """Equilibria at the corners of the required displacements, by the inputs that reach them (with the lumped model's derivatives)."""
    mapping, (axes, wanted) = bench.per_motion, bench.corners()
    places = [COMPONENTS.index(axis) for axis in axes]
    gain = np.real(mapping.values[:, [mapping.columns.index(axis) for axis in axes]])
    model = nonlinear(bench.mechanism)
    rest = equilibrium(model)
    require_equilibrium(rest)
    linear = wanted @ gain.T
    inputs, away = linear, np.full_like(wanted, np.inf)
    for _ in range(_STEPS):
        state = equilibrium(model, dict(zip(mapping.rows, inputs.T, strict=True)), start=rest)
        if not np.all(state.converged):
            break
        away = wanted - (state.twist(PLATFORM) - rest.twist(PLATFORM))[:, places]
        if np.max(np.abs(away) @ np.diag(1.0 / np.max(wanted, axis=0))) < _CLOSE:
            moved = np.max(np.abs(linear), axis=0) > 0.0
            return _Corners(rest, state, float(np.min(np.max(np.abs(linear), axis=0)[moved] / np.max(np.abs(inputs), axis=0)[moved])))
        inputs = inputs + away @ gain.T
    raise refuse("motion", "no equilibrium found at the corners of the required displacements", "Reduce the displacements")


def missed_limits(stage: Mechanism, drawn: Mapping[str, float], better: tuple[Mapping[str, float], ...]) -> dict[str, str]:
    """Return limits for the lumped model so that better models also meet the requirements.

    The result is empty if the better models already meet the requirements. By space mapping, each limit is divided by the ratio of a better
    model's value to the lumped model's value, if the result is stricter. With several better models, each limit is divided by the product
    of these ratios. Raises `DesignError` if the lumped value of a missed requirement is zero.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> drawn = required_values(parallelogram())
    >>> missed_limits(parallelogram(), drawn, ({"frequency.platform.1": 0.25 * drawn["frequency.platform.1"]},))
    {'frequency.platform.1': 'at least 2001 Hz'}
    """
    lines = {line.key: line for line in requirements(stage) if line.key in drawn}
    for key, line in lines.items():
        if not drawn[key] and not all(Verdict(line, np.asarray(each.get(key, 0.0))).passed for each in better):
            raise refuse(key, "is zero in the lumped model with rigid bodies, so a stricter limit has no effect", "Relax the requirement")
    ratios = {key: float(np.prod([each[key] / drawn[key] for each in better if key in each])) for key in lines if drawn[key]}
    if all(Verdict(lines[key], np.asarray(drawn[key] * ratio)).passed for key, ratio in ratios.items()):
        return {}
    return dict(_stricter(lines, ratios))


def _stricter(lines: Mapping[str, Requirement], ratios: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    """Limits of the lumped model. Longer strokes raise the stress at them: the limit of its safety falls by as much."""
    longer = max((1.0 / ratios[key] for key, line in lines.items() if line.kind is stroke), default=1.0)
    for key, ratio in ratios.items():
        line = lines[key]
        strict = min(ratio, 1.0) if line.sense is Sense.AT_LEAST else max(ratio, 1.0)
        factor = strict * max(longer, 1.0) if line.kind is safety_at_strokes else strict
        if factor != 1.0:
            spare = 1.0 + _SPARE if line.sense is Sense.AT_LEAST else 1.0 - _SPARE
            yield key, f"{line.sense.value} {show(spare * line.limit / factor, line.quantity, digits=_DIGITS)}"
