"""Static equilibrium of a stage under loads, strokes and its weight."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, Number
from flexstage.models.linear.channels import wrench_places
from flexstage.models.nonlinear.elements.fixed_coordinates import FixedCoordinates
from flexstage.models.nonlinear.newton import (
    RESULT_FIELDS,
    USUAL,
    EquilibriumSolution,
    Task,
    equilibrate,
    equilibrate_designs,
    merge,
    search,
)
from flexstage.models.nonlinear.paths.arc import complete_paths
from flexstage.models.nonlinear.paths.follow import continued
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Loads, Pose, SolverOptions, Status
from flexstage.spatial.frame import COMPONENTS
from flexstage.spatial.rotation import logarithm

LESS = "Reduce the load, or compute the buckling mode with flexstage buckle"


@dataclass(frozen=True, eq=False)
class State(InNotebook):
    """Static equilibria of a stage, for load cases of any shape (...).

    `status` is the outcome of each solution after `iterations`. The `residual` is the largest remaining error: gaps divided by flexure
    lengths, or forces divided by stiffnesses.

    The results of a case that did not converge are NaN. `reached` is the largest load fraction with an equilibrium, and `reasons` explains
    each failure.

    `reactions` (..., h) act on the `held` coordinates [N, N m].
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("an equilibrium state", "fs.equilibrium(fs.nonlinear(stage))")
    model: Nonlinear
    loads: Loads
    hold: FixedCoordinates
    pose: Pose
    shape: tuple[int, ...]
    status: Array
    iterations: Array
    residual: Array
    reached: Array
    held: tuple[str, ...]

    @property
    def converged(self) -> Array:
        """Whether each case (...) converged."""
        return self.status == Status.CONVERGED

    @property
    def reasons(self) -> tuple[str, ...]:
        """Failure reason of each case, in the order of `status.ravel()`; empty for a converged case."""
        return tuple(
            failure_reason(int(status), float(share)) for status, share in zip(self.status.ravel(), self.reached.ravel(), strict=True)
        )

    @property
    def reactions(self) -> Array:
        """Reaction forces and moments (..., h) on the stage at the fixed coordinates [N, N m]."""
        count = self.pose.held.shape[1] - len(self.held)
        return self._known(-self.pose.held[:, count:])

    def displacement(self, place: str = "platform") -> Array:
        """Return the displacement (..., 3) [m] of a body's reference point or of a named point from its nominal position."""
        body, arm = self.place(place)
        moved = self.pose.position[:, body] + (self.pose.turn[:, body] @ (self.model.growth[body] * arm)) - self.model.reference[body] - arm
        return self._known(moved)

    def rotation(self, body: str = "platform") -> Array:
        """Return the rotation vector (..., 3) [rad] of a body, or of the body of a named point."""
        return self._known(logarithm(self.pose.turn[:, self.place(body)[0]]))

    def twist(self, place: str = "platform") -> Array:
        """Return displacement and rotation vector (..., 6) [m, rad] of a body or a named point."""
        return np.concatenate([self.displacement(place), self.rotation(place)], axis=-1)

    def wrench(self, link: str) -> Array:
        """Return the wrench (..., 6) [N, N m] that the second body exerts on a flexure's end, about this end, in the frame of its start."""
        for number, group in enumerate(self.model.flexures):
            if link in group.names:
                place = group.names.index(link)
                unit = group.law.rigidity[place] / group.law.length[place] ** np.array([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
                return self._known(unit * self.pose.wrench[number][place])
        names = [name for group in self.model.flexures for name in group.names]
        raise refuse(link, "not a flexure of this stage", suggest_nearest(link, names))

    def case(self, number: int) -> State:
        """Return the state of one case by its index."""
        cases = np.array([number])
        status, iterations, residual, reached = (getattr(self, name).ravel()[number] for name in RESULT_FIELDS)
        loads, hold, pose = self.loads.of(cases), self.hold.of(cases), self.pose.of(cases)
        return State(self.model, loads, hold, pose, (), status, iterations, residual, reached, self.held)

    def place(self, name: str) -> tuple[int, Array]:
        """Return the number of a body, and the nominal arm of its reference point or of a named point on it."""
        return place(self.model, name)

    def _known(self, values: Array) -> Array:
        known = np.where((self.status == Status.CONVERGED).reshape(-1)[:, None], values, np.nan)
        return known.reshape(*self.shape, values.shape[-1])


def failure_reason(status: int, share: float) -> str:
    """Return the reason why a case has no result, with the largest load fraction that has an equilibrium; empty for a converged case."""
    if status == Status.CONVERGED:
        return ""
    if status == Status.CRITICAL:
        return f"at {share:.4g} of the loads the stage snaps or buckles; the path from the unloaded stage does not reach the full loads"
    if status == Status.NOT_FOLLOWED:
        return f"the path of equilibria from the unloaded stage ends at {share:.3g} of the loads and does not reach the full loads"
    what = "the stiffness is singular" if status == Status.SINGULAR else "Newton's method does not converge"
    progress = f"equilibrium was followed to {share:.3g} of the load" if share else "no equilibrium was found on the load path"
    return f"{what} under the full load; {progress}. The path may end there: use fs.continuation (by arc length) or fs.critical_load"


def require_equilibrium(solution: State) -> None:
    """Raise `DesignError` if a case has no equilibrium on the load path from the unloaded stage.

    The message contains the load of the critical point, or of the end of the path.
    """
    if not bool(solution.converged):
        status, share = int(solution.status), float(solution.reached)
        progress = f"; equilibrium was followed to {share:.3g} of the load" if share else ""
        has_reason = status in (Status.CRITICAL, Status.NOT_FOLLOWED)
        what = failure_reason(status, share) if has_reason else f"no equilibrium was found under weight and loads{progress}"
        raise refuse("stage", what, LESS)


def place(model: Nonlinear, name: str) -> tuple[int, Array]:
    """Return the body number and the nominal arm of a body's reference point or a named point; raises `DesignError` for other names."""
    if name in model.bodies:
        return model.body(name), np.zeros(3)
    known = wrench_places(model.assembly)
    if name not in known:
        raise refuse(name, "unknown body or point", suggest_nearest(name, [*model.bodies, *known]))
    body = model.body(known[name].body)
    return body, known[name].point - model.reference[body]


@check_arguments
def equilibrium(
    model: Nonlinear,
    loads: Mapping[str, Number] | None = None,
    *,
    hold: Mapping[str, Number] | None = None,
    weight: Number = 1.0,
    stated: Number = 1.0,
    start: State | None = None,
    options: SolverOptions = USUAL,
) -> State:
    """Compute the equilibrium under `loads`: strokes and forces by actuator, wrenches by component (`platform.fy`).

    A load is a number, or an array with one value per case. `hold` fixes coordinates of bodies and points: `platform.y` is a displacement
    [m], `platform.rz` a component of the rotation vector [rad]. The result includes the reactions at fixed coordinates. `weight` is the
    applied fraction of gravity, and `stated` the applied fraction of the description's forces and preloads. Wrenches keep their directions
    in space.

    The iteration of every case starts at the nominal position, or at `start`, under the full load. If the iteration does not converge, the
    load is increased in steps, then by arc length up to a limit point. A case without a result is NaN, with the reason in `status`.

    Without `start`, the result is on the path of equilibria from the unloaded stage, along which all loads and fixed coordinates grow in
    proportion. The result is NaN if the path reaches a limit point, a bifurcation or its end before the full load. Other equilibria are
    permitted if `options.past` is true, if `options.arcs` is 0, if the unloaded stage is unstable, and beyond an imperfect bifurcation.

    Raises `DesignError` for unknown names.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> result = equilibrium(nonlinear(parallelogram()), {"platform.fx": [100.0, 200.0]}, weight=0.0)
    >>> (result.displacement()[:, 0] * 1e6).round(1).tolist()
    [5.2, 10.3]
    """
    request = _request(model, loads or {}, hold or {}, weight, stated)
    first = _first(model, start, request.hold, len(request.loads.inputs))
    solution = complete_paths(model, request.loads, request.hold, equilibrate(model, first, request.loads, request.hold, options), options)
    if start is None:
        solution = _continued(model, request, solution, options)
    return state(model, request.loads, request.hold, solution, (request.shape, request.held))


def equilibria(
    models: Sequence[Nonlinear],
    loads: Mapping[str, Number] | None = None,
    *,
    hold: Mapping[str, Number] | Sequence[Mapping[str, Number]] | None = None,
    weight: Number = 1.0,
    stated: Number = 1.0,
    options: SolverOptions = USUAL,
) -> list[State]:
    """Compute the states of several designs of the same structure under the same loads, by the method of `equilibrium`.

    `hold` applies to all designs, or has one entry per design.

    Raises `DesignError` if bodies, links or their connections differ.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.addresses.address import set_value
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> designs = [nonlinear(set_value(parallelogram(), "materials.steel.young", value)) for value in (180e9, 210e9)]
    >>> [round(float(each.displacement()[0] * 1e6), 2) for each in equilibria(designs, {"platform.fx": 100.0}, weight=0.0)]
    [5.29, 5.1]
    """
    _require_alike(models)
    held = [hold or {}] * len(models) if isinstance(hold, Mapping | None) else hold
    requests = [_request(model, loads or {}, each, weight, stated) for model, each in zip(models, held, strict=True)]
    starts = [_first(model, None, each.hold, len(each.loads.inputs)) for model, each in zip(models, requests, strict=True)]
    tasks = [Task(model, start, each.loads, each.hold) for model, start, each in zip(models, starts, requests, strict=True)]
    solutions = equilibrate_designs(tasks, options)
    rescued = (complete_paths(each.model, each.loads, each.hold, one, options) for each, one in zip(tasks, solutions, strict=True))
    return [
        state(model, each.loads, each.hold, _continued(model, each, one, options), (each.shape, each.held))
        for model, each, one in zip(models, requests, rescued, strict=True)
    ]


def _continued(model: Nonlinear, request: _Request, solution: EquilibriumSolution, options: SolverOptions) -> EquilibriumSolution:
    """The result if it continues the unloaded stage; else the continuation, or the reason why there is none."""
    known = np.flatnonzero(solution.status == Status.CONVERGED)
    if not options.arcs or options.past or not known.size:
        return solution
    one, none = known[:1], np.zeros(1)
    loads, hold = request.loads.of(one).times(none), replace(request.hold.of(one), value=0.0 * request.hold.value[one])
    drawn = equilibrate(model, _first(model, None, hold, 1), loads, hold)
    if drawn.status[0] != Status.CONVERGED:
        return solution
    for case in known[:, None]:
        end = Task(model, solution.pose.of(case), request.loads.of(case), request.hold.of(case))
        on = continued(Task(model, drawn.pose, loads, hold), end)
        solution = merge(solution, case, replace(on, iterations=solution.iterations[case], residual=solution.residual[case]))
    return solution


def _require_alike(models: Sequence[Nonlinear]) -> None:
    """Refuse designs of different structure, naming the first difference."""
    first = models[0]
    for number, other in enumerate(models[1:], start=2):
        for what, of in _STRUCTURE.items():
            if of(first) != of(other):
                difference = f"{what} differ from the first design: {_first_difference(of(first), of(other))}"
                raise refuse(f"design {number}", difference, "Analyse designs with different structures separately")


_STRUCTURE: Mapping[str, Callable[[Nonlinear], list[object]]] = {
    "bodies": lambda model: list(model.bodies),
    "flexures": lambda model: [f"{name} of kind {group.law.signature}" for group in model.flexures for name in group.names],
    "links": lambda model: [f"{each.name} of {' and '.join(each.joins)}" for each in model.assembly.links.values()],
    "other links": lambda model: list(model.hinges.names),
    "locked degrees of freedom": lambda model: model.hinges.locked.tolist(),
    "superelements": lambda model: [each.name for each in model.elements],
    "inputs": lambda model: [each.name for each in model.inputs],
}


def _first_difference(one: list[object], other: list[object]) -> str:
    pairs = itertools.zip_longest(one, other, fillvalue="none")
    return next(f"{theirs} instead of {ours}" for ours, theirs in pairs if ours != theirs)


def corrected(
    model: Nonlinear,
    start: State,
    loads: Mapping[str, Number] | None = None,
    *,
    hold: Mapping[str, Number] | None = None,
    weight: Number = 1.0,
    stated: Number = 1.0,
) -> State:
    """Correct a state for a slightly different model by two Newton steps; the result is correct to first order in the model difference.

    One Newton step is not sufficient, because the stiffness equals the derivative of the residual only within 1e-6. The loads and fixed
    coordinates must be the same as for `start`. Cases without a state in `start` remain without a state.
    """
    request = _request(model, loads or {}, hold or {}, weight, stated)
    pose = _first(model, start, request.hold, len(request.loads.inputs))
    solution = search(model, pose, request.loads, request.hold, replace(USUAL, iterations=2))
    status = np.where(solution.status == Status.SINGULAR, solution.status, np.broadcast_to(start.status.ravel(), solution.status.shape))
    return state(model, request.loads, request.hold, replace(solution, status=status), (request.shape, request.held))


@dataclass(frozen=True, eq=False)
class _Request:
    """Loads and fixed coordinates of b cases, their shape, and the names of the coordinates."""

    loads: Loads
    hold: FixedCoordinates
    shape: tuple[int, ...]
    held: tuple[str, ...]


def _request(model: Nonlinear, loads: Mapping[str, Number], held: Mapping[str, Number], weight: Number, stated: Number) -> _Request:
    """Loads and fixed coordinates by name; raises for names that the stage does not have."""
    require([*_unknown_inputs(model, loads), *_unknown_coordinates(model, held)])
    arrays = np.broadcast_arrays(*(np.asarray(each, dtype=float) for each in (*loads.values(), *held.values(), weight, stated)))
    shape, flat = arrays[0].shape, [np.ravel(each) for each in arrays]
    cases = flat[0].size
    inputs = np.zeros((cases, len(model.inputs)))
    names = [channel.name for channel in model.inputs]
    for name, values in zip(loads, flat, strict=False):
        inputs[:, names.index(name)] = values
    whole = Loads(inputs, flat[-2][:, None] * model.gravity, flat[-1])
    return _Request(whole, _hold(model, held, flat[len(loads) : len(loads) + len(held)], cases), shape, tuple(held))


def state(
    model: Nonlinear, loads: Loads, hold: FixedCoordinates, solution: EquilibriumSolution, labels: tuple[tuple[int, ...], tuple[str, ...]]
) -> State:
    """Build the state of a solution; `labels` contains the shape of the cases and the names of the fixed coordinates."""
    shape, held = labels
    status, iterations, residual, reached = (getattr(solution, name).reshape(shape) for name in RESULT_FIELDS)
    return State(model, loads, hold, solution.pose, shape, status, iterations, residual, reached, held)


def _first(model: Nonlinear, start: State | None, hold: FixedCoordinates, cases: int) -> Pose:
    pose = model.nominal_pose(cases) if start is None else start.pose
    if len(pose.position) != cases:
        pose = pose.of(np.zeros(cases, dtype=int))
    reactions = np.zeros((cases, len(model.hinges.locked) + len(hold.body)))
    count = min(reactions.shape[1], pose.held.shape[1])
    reactions[:, :count] = pose.held[:, :count]
    return Pose(pose.position, pose.turn, pose.strain, pose.wrench, reactions)


def _hold(model: Nonlinear, held: Mapping[str, Number], values: list[Array], cases: int) -> FixedCoordinates:
    places = [name.rpartition(".") for name in held]
    coordinates = [place(model, owner) for owner, _, _ in places]
    body = np.array([number for number, _ in coordinates], dtype=int)
    arm = np.array([arm for _, arm in coordinates]).reshape(-1, 3)
    component = np.array([COMPONENTS.index(name) for _, _, name in places], dtype=int)
    return FixedCoordinates(
        body,
        arm * model.growth[body, None],
        component,
        model.reference[body] + arm,
        np.stack(values, axis=-1) if values else np.zeros((cases, 0)),
    )


def _unknown_inputs(model: Nonlinear, loads: Mapping[str, Number]) -> Iterator[Finding]:
    names = [channel.name for channel in model.inputs]
    for name in loads:
        if name not in names:
            yield Finding(name, "unknown load", suggest_nearest(name, names))


def _unknown_coordinates(model: Nonlinear, held: Mapping[str, Number]) -> Iterator[Finding]:
    places = [*model.bodies, *wrench_places(model.assembly)]
    for name in held:
        owner, _, component = name.rpartition(".")
        if owner not in places or component not in COMPONENTS:
            advice = suggest_nearest(name, [f"{each}.{component}" for each in places for component in COMPONENTS])
            yield Finding(name, "unknown coordinate", advice)
