"""Arc-length continuation of equilibria along a load: past limit points, and onto a branch at a bifurcation (docs/nonlinear.md, 27)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.models.nonlinear.elements.fixed_coordinates import FixedCoordinates
from flexstage.models.nonlinear.graph import System, advance, assemble, exerted_by
from flexstage.models.nonlinear.newton import EquilibriumSolution, lack, merge, search
from flexstage.models.nonlinear.paths.inertia import count_descents, lowest_stiffness, stiffness_scale, weakest_flexure
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Loads, Pose, SolverOptions, Status
from flexstage.models.nonlinear.walk import walk_tree
from flexstage.spatial.rotation import logarithm

_PROBE, _ONSET = 0.03, 1e-3
"""Relative step of the factor, and step from zero, for its derivative if other terms than inputs change: flexure weight is nonlinear."""
_STRIDE, _LEAST = 0.1, 1e-3
"""First and smallest step length towards a whole load, over the motion so far; reduced by factors of four."""
_FAR, _ROUGH = 1.0, 1e-3
"""Maximum length of a correction and of the last one, over the step length."""
_FINEST, _SHORTEST = 1e-7, 1e-16
"""Step length over the previous maximum below which a path ends; and absolute minimum."""
_SOFTER = 0.3
"""Slope over the steepest so far below which a path may turn."""
_TURN, _ASIDE, _MISFIT, _UNEVEN = 0.35, 0.2, 0.25, 0.1
"""Error bounds of a step.

- Rotation of the tangent [rad].
- Distance of the point from the tangent over the step length.
- Error of the predicted slope and stiffness over their size or predicted change.
- Trapezoidal error of the factor's change.
"""
_NOISE, _NONE = 1e-7, 1e-3
"""Rounding level of a factor (relative), and of slopes and stiffnesses relative to the largest."""
_AIM, _SHORTER, _LONGER, _AHEAD = 0.5, 1e-3, 8.0, 1.05
"""Target fraction of these bounds for the next step, limits of its length over the last one, and over the distance to zero stiffness."""


@dataclass(frozen=True, eq=False)
class ProportionalLoading:
    """Loads and fixed coordinates of one case, linear in a load factor: values at factor zero, and increments per unit of the factor.

    `options` are used for each equilibrium solution. Stability is evaluated with only the rows `kept` of the system of equations.
    """

    model: Nonlinear
    loads: Loads
    hold: FixedCoordinates
    gain: Loads
    moved: Array
    options: SolverOptions
    kept: list[int]

    def at(self, factor: float) -> tuple[Loads, FixedCoordinates]:
        """Return loads and fixed coordinates at a load factor."""
        return self.loads.plus(self.gain, factor), replace(self.hold, value=self.hold.value + factor * self.moved)

    @property
    def plain(self) -> bool:
        """Whether the factor changes only inputs, so that the residual is linear in the factor."""
        return not (np.any(self.gain.gravity) or np.any(self.gain.constant) or np.any(self.moved))

    @property
    def scale(self) -> Array:
        """Scale factors (n,) that make body motions comparable; reactions are not included."""
        model = self.model
        others = np.zeros(len(model.hinges.locked) + len(self.hold.body))
        return np.concatenate([np.tile([1.0 / model.size] * 3 + [1.0] * 3, len(model.bodies)), others])


@dataclass(frozen=True, eq=False)
class Reference:
    """Stiffnesses at the start of a path, for reference: of the stage with motions scaled by `scale` (n,), and of the weakest flexure."""

    scale: Array
    stage: float
    flexure: float


@dataclass(frozen=True, eq=False)
class Point:
    """Equilibrium on a load path: the pose `found`, the load `factor`, and the scaled `step` (n,) from the previous point.

    - `along` (n,): unit tangent of the path in scaled body motion; `slope`: derivative of the factor with respect to the path length;
      `steepest`: largest magnitude of the slope up to this point.
    - `motions`: number of independent motions that decrease the potential energy.
    - `stiffness`: product of the lowest stiffness of the stage and the stiffness of the weakest flexure between fixed ends, each divided by
      its value in `reference`. Where the flexure's stiffness is zero, the stage's stiffness has a pole, but the product has none. The
      product is negative for unstable states, and NaN without a reference.
    """

    found: EquilibriumSolution
    factor: float
    step: Array
    system: System
    along: Array
    slope: float
    motions: int
    stiffness: float
    steepest: float
    reference: Reference | None


def continue_path(loading: ProportionalLoading, begin: Point, length: float, points: int) -> Iterator[Point]:
    """Generate equilibria beyond `begin`, at most `length` apart in the norm of body motion.

    Translations are divided by the longest flexure length, rotations are in radians. The path ends at a distance of `points` times
    `length`. It ends earlier if there is no equilibrium even at a small fraction of `length` beyond the last one.
    """
    gone = 0.0
    for point in march(loading, begin, length, longest=length):
        yield point
        gone += float(np.linalg.norm(point.step))
        if gone > (points - 0.5) * length:
            return


def march(loading: ProportionalLoading, begin: Point, length: float, *, longest: float = np.inf) -> Iterator[Point]:
    """Generate equilibria beyond `begin`; the step length is controlled by the path curvature and the prediction errors.

    A step is repeated with a shorter length in three cases: the tangent rotates too far, the equilibrium is too far from the tangent, or
    the slope or the stiffness differs too much from its prediction. The repetition prevents a step from passing over two events. The path
    ends if the step is too small a fraction of the longest previous step.
    """
    before, last, most = None, begin, 0.0
    while length > max(_FINEST * most, _SHORTEST):
        after = step_along(loading, last, length)
        error = np.inf if after is None else misfit(loading.scale, before, last, after)
        if after is not None and error <= 1.0:
            yield after
            most, before, last = max(most, length), last, after
        length = min(length * (0.25 if after is None else _change(error)), longest, _ahead(before, last))


def _change(error: float) -> float:
    return float(np.clip(_AIM / max(error, 1e-9), _SHORTER, _LONGER))


def misfit(scale: Array, before: Point | None, last: Point, after: Point) -> float:
    """Return the largest ratio of a step's errors to their bounds; a step with a ratio up to 1 is accepted."""
    length = float(np.linalg.norm(after.step))
    turned, aside = (float(np.linalg.norm(each - scale * last.along)) for each in (scale * after.along, after.step / length))
    rise, steep = after.factor - last.factor, length * max(abs(last.slope), abs(after.slope))
    uneven = abs(rise - 0.5 * length * (last.slope + after.slope)) / (_UNEVEN * steep + _NOISE * abs(after.factor))
    errors = [turned / _TURN, aside / _ASIDE, uneven]
    errors.append(_unforeseen(before, last, after, "slope", last.steepest if last.steepest < np.inf else 0.0))
    if not last.motions:
        errors.append(_unforeseen(before, last, after, "stiffness", 1.0))
    return float(np.nanmax(errors))


def _unforeseen(before: Point | None, last: Point, after: Point, name: str, size: float) -> float:
    """Error of the prediction from the last two points over the bound; NaN at the start of a branch."""
    previous, current = getattr(last, name), getattr(after, name)
    expected = previous
    if before is not None:
        expected += (previous - getattr(before, name)) * np.linalg.norm(after.step) / np.linalg.norm(last.step)
    elif not previous:
        return np.nan
    return abs(current - expected) / (_MISFIT * max(abs(expected - previous), abs(previous), _NONE * size))


def _ahead(before: Point | None, last: Point) -> float:
    """Step length to slightly beyond the predicted zero of the lowest stiffness; infinite if it does not decrease."""
    if before is None or last.motions or not last.stiffness < before.stiffness:
        return np.inf
    return _AHEAD * float(np.linalg.norm(last.step)) * last.stiffness / (before.stiffness - last.stiffness)


def step_along(loading: ProportionalLoading, last: Point, length: float) -> Point | None:
    """Compute the next equilibrium at a step length, or `None` without convergence (Riks 1979, see `continuation`).

    If the slope is at least 0.3 of the steepest slope so far, corrections keep the load factor constant. On a flatter path, corrections are
    normal to the step, and the factor is an unknown.
    """
    scale, options, model = loading.scale, loading.options, loading.model
    whole, change, system, pose = length * last.along, length * last.slope, last.system, last.found.pose
    scaled = length * scale * last.along
    factor, step, turns = last.factor, whole, abs(last.slope) < _SOFTER * last.steepest
    enough, own = min(options.step, _ROUGH * length), abs(length * last.slope)
    with np.errstate(all="ignore"):
        for iteration in range(options.iterations):
            if iteration:
                system = assemble(model, pose, *loading.at(factor))
                step, change = _solved(system, -system.residual[0]), 0.0
                if turns:
                    along = _solved(system, load_rate(loading, pose, factor, system))
                    change = -float(scaled @ (scale * step) / (scaled @ (scale * along)))
                    step = step + change * along
            size = float(np.linalg.norm(scale * step))
            if not np.isfinite(size + change) or (iteration and size > _FAR * length):
                return None
            pose, inside = advance(model, pose, system.bent, step[None], np.ones(1))
            if not isinstance(system.matrix, np.ndarray):
                pose = walk_tree(model, pose, loading.at(factor + change)[0])
            factor, scaled = factor + change, scaled + (scale * step if iteration else 0.0)
            rest = max(float(np.max(np.abs(scale * step))), float(inside[0]))  # the largest: a norm grows with rounding of many bodies
            if iteration and rest < enough and abs(change) <= options.step * (own + abs(factor)):
                gap = float(lack(model, system)[0])
                if gap < options.gap:
                    return point_at(loading, _one(pose, iteration + 1, gap), factor, step=scaled, start=last)
    return None


def load_rate(loading: ProportionalLoading, pose: Pose, factor: float, system: System) -> Array:
    """Compute the derivative (n,) of loads and fixed coordinates with respect to the load factor, at a pose."""
    if loading.plain:
        return np.append(exerted_by(loading.model, pose, loading.gain)[0], np.zeros(len(loading.hold.body)))
    probe = _PROBE * abs(factor) or _ONSET
    return (system.residual[0] - assemble(loading.model, pose, *loading.at(factor + probe)).residual[0]) / probe


def _solved(system: System, right: Array) -> Array:
    return system.solved(right[None])[0]


def _one(pose: Pose, iterations: int, gap: float) -> EquilibriumSolution:
    return EquilibriumSolution(pose, np.array([Status.CONVERGED]), np.array([iterations]), np.array([gap]), np.ones(1))


def first_point(loading: ProportionalLoading, pose: Pose, factor: float) -> Point:
    """Build the first point of a path from a known equilibrium, with an increasing factor."""
    return point_at(loading, _one(pose, 0, 0.0), factor, step=0.0 * loading.scale)


def critical_point(loading: ProportionalLoading, pose: Pose, factor: float, into: Array | None) -> Point:
    """Build the first point of a path at a limit point, or at a bifurcation in the direction `into` (n,) of the branch.

    At a limit point, `pose` need only be close to the limit point. The factor increases along the path from a stable `pose`, and decreases
    along the path from an unstable `pose`.
    """
    point = first_point(loading, pose, factor)
    along = (-point.along if point.motions else point.along) if into is None else into / np.linalg.norm(loading.scale * into)
    return replace(point, along=along, slope=0.0, steepest=np.inf, stiffness=np.nan, reference=None)


def point_at(
    loading: ProportionalLoading, solution: EquilibriumSolution, factor: float, *, step: Array, start: Point | None = None
) -> Point:
    """Compute tangent, number of unstable motions and lowest stiffness at an equilibrium, given the previous point."""
    model = loading.model
    with np.errstate(all="ignore"):
        system = assemble(model, solution.pose, *loading.at(factor))
        rate = _solved(system, load_rate(loading, solution.pose, factor, system))
        slope = np.copysign(1.0 / np.linalg.norm(loading.scale * rate), 1.0 if start is None else step @ (loading.scale * rate))
        along = slope * rate
    motions, stiffness = int(count_descents(model, system, loading.kept)[0]), np.nan
    reference = None if start is None else start.reference
    if start is None or reference is not None:
        scale = stiffness_scale(model, system) if reference is None else reference.scale
        own, whole = weakest_flexure(model, system)[0], lowest_stiffness(model, system, loading.kept, scale)[0]
        stiffness = (-1.0 if motions else 1.0) * (abs(whole / reference.stage * own / reference.flexure) if reference else 1.0)
        reference = reference or Reference(scale, whole, own)
    steepest = max(abs(float(slope)), 0.0 if start is None else start.steepest)
    return Point(solution, factor, step, system, along, float(slope), motions, stiffness, steepest, reference)


def complete_paths(
    model: Nonlinear, loads: Loads, hold: FixedCoordinates, solution: EquilibriumSolution, options: SolverOptions
) -> EquilibriumSolution:
    """Continue by arc length all cases that reached only a fraction of their load; a path ends at the whole load or the limit point."""
    partly = np.flatnonzero((solution.status != Status.CONVERGED) & (solution.reached > 0.0))
    for case in partly if options.arcs else ():
        one = np.array([case])
        after = _completed_path(model, loads.of(one), hold.of(one), solution.of(one), options)
        solution = merge(solution, one, after)
    return solution


def _completed_path(
    model: Nonlinear, loads: Loads, hold: FixedCoordinates, solution: EquilibriumSolution, options: SolverOptions
) -> EquilibriumSolution:
    """One case: the load is continued from the fraction `reached`."""
    rows = [*range(model.freedoms + len(model.hinges.locked) + len(hold.body))]
    loading = ProportionalLoading(model, loads.times(np.zeros(1)), replace(hold, value=0.0 * hold.value), loads, hold.value, options, rows)
    last = first_point(loading, solution.pose, float(solution.reached[0]))
    stride = _STRIDE
    for _ in range(options.arcs):
        after = step_along(loading, last, stride * _moved(loading, last.found.pose))
        if after is None:
            stride *= 0.25
            if stride < _LEAST:
                break
        elif after.factor >= 1.0:
            whole = search(model, after.found.pose, loads, hold, options)
            return whole if whole.status[0] == Status.CONVERGED else solution
        elif after.factor < last.factor and not options.past:
            break
        else:
            last, stride = after, _STRIDE * (2.5 if options.past else 1.0)
            solution = replace(solution, pose=after.found.pose, reached=np.maximum(solution.reached, after.factor))
    return solution


def _moved(loading: ProportionalLoading, pose: Pose) -> float:
    """Displacement of bodies from the nominal position, over the stage size and in radians."""
    model = loading.model
    shift = (pose.position[0, :-1] - model.reference[:-1]) / model.size
    return float(np.linalg.norm(np.concatenate([shift, logarithm(pose.turn[0, :-1])]))) or 1.0
