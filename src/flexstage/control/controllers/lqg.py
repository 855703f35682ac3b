"""Linear-quadratic-Gaussian (LQG) control with integrators, and a Kalman filter designed with the gauges' noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.control.controllers.decentralised import with_feedforward
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel

DOUBLINGS, _SETTLED = 30, 1e-15
"""Maximum number of doublings (30 doublings give 2^30 samples, a day at 10 kHz), and the relative change at which doubling stops."""


@dataclass(frozen=True)
class Weights:
    """Weights of the regulator's cost, the integral of w^2 |z|^2 + p |y|^2 + |u|^2, where z is the integral of the loop's error.

    y is the pose in lengths (rotations times the stage's length), u are the strokes. w = 2 pi `bandwidth` [Hz] and p = `pose` [1] are
    common to all coordinates, or specified for each coordinate. For p = 0 and a static plant of gain 1, the controller is u' = w e with the
    error e; its crossover frequency is exactly `bandwidth`.
    """

    bandwidth: float | tuple[float, ...]
    pose: float | tuple[float, ...] = 0.0


@dataclass(frozen=True)
class Disturbances:
    """White-noise densities that the observer assumes: `strokes` [m/Hz^(1/2)] for every command, and `gauges` for each gauge, by name."""

    strokes: float
    gauges: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class LQG:
    """LQG controller with integrators, for a model: u = -K x^ + K_z z + N r.

    u are the commands, x^ the estimated states, z the integral of the error e, and r the reference. The matrices A, B and C belong to the
    sampled `model` from u = `command.<actuator>` to y = `pose.<c>`. The estimate is x^ = x- + M (y - C x-), with the prediction x- = A x^ +
    B u from the previous sample. The next z is z + T e, with the sampling period T. The gain matrices are `regulator` K (n, s), `integral`
    K_z (n, f) and `observer` M (s, f). `feedforward` (n, f) maps a reference to static strokes and determines N (default: no feedforward).
    `tracking` [s] is the anti-windup time of the integrators. The observer uses the applied strokes, and needs no anti-windup. `weights`
    are the design weights. `expected` are the disturbances that the observer assumes, if known.
    """

    model: System
    regulator: Array
    integral: Array
    observer: Array
    coordinates: Coordinates
    tracking: float
    feedforward: Array | None = None
    weights: Weights | None = None
    expected: Disturbances | None = None

    def system(self, step: float | None = None) -> System:
        """Return the controller: inputs `error.<c>`, `pose.<c>`, `reference.<c>` (with `feedforward`), `applied.<actuator>`.

        Raises `DesignError` for a step other than the model's.
        """
        if step != self.model.step:
            model, asked = ("continuous" if each is None else f"sampled every {each:g} s" for each in (self.model.step, step))
            raise refuse("LQG", f"the model is {model} (expected {asked})", "Design the controller with a model of the same sampling")
        return with_feedforward_states(_sampled_system(self), self)


def lqg(model: System, coordinates: Coordinates, weights: Weights, expected: Disturbances, feedforward: Array | None = None) -> LQG:
    """Design the minimum-cost regulator and the minimum-variance observer for a `model` from commands to pose (`pose_plant`).

    The gains K and K_z of `LQG` follow from the algebraic Riccati equation of the model with integrators of the error. The observer gain M
    follows from the Riccati equation of the model with its noise (Kwakernaak & Sivan, Linear Optimal Control Systems, 1972). Noise of
    one-sided density G is white up to half the sampling rate: with the sampling period T, a sample has the variance G^2/(2 T). Raises
    `DesignError` for a continuous model, gauges without noise, and an undamped mode that is not controllable or not observable.

    >>> from flexstage.control.controllers.pose_plant import pose_plant
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> found = lqg(pose_plant(plant), plant.coordinates, Weights(20.0), Disturbances(1e-9, {"S": 1e-12}))
    >>> found.regulator.shape, found.integral.round(0).tolist()  # 2 pi 20
    ((1, 8), [[125.0]])
    """
    return with_observer(model, coordinates, weights, observer_gain(model, coordinates, expected), feedforward)


def with_observer(model: System, coordinates: Coordinates, weights: Weights, observer: Array, feedforward: Array | None = None) -> LQG:
    """Design the minimum-cost regulator for a known observer gain (s, f).

    >>> from flexstage.control.controllers.pose_plant import pose_plant
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> with_observer(pose_plant(plant), plant.coordinates, Weights(20.0), np.zeros((8, 1))).tracking.__round__(5)  # 1/(2 pi 20)
    0.00796
    """
    regulator, integral = _regulator(model, coordinates, weights)
    tracking = max(1.0 / (2.0 * np.pi * float(np.min(weights.bandwidth))), model.step or 0.0)
    return LQG(model, regulator, integral, observer, coordinates, tracking, feedforward, weights)


def _regulator(model: System, coordinates: Coordinates, weights: Weights) -> tuple[Array, Array]:
    """K (n, s) and K_z (n, f)."""
    states, count = len(model.A), len(model.outputs)
    scale = np.diag(coordinates.scale)
    step = _step(model)
    A = np.block([[model.A, np.zeros((states, count))], [-step * scale @ model.C, np.eye(count)]])
    B = np.vstack([model.B, -step * scale @ model.D])
    seen, rates = scale @ model.C, 2.0 * np.pi * np.broadcast_to(weights.bandwidth, (count,))
    direct, poses = scale @ model.D, np.broadcast_to(weights.pose, (count,))[:, None]
    cross = np.vstack([seen.T @ (poses * direct), np.zeros((count, len(model.inputs)))])
    cost = np.asarray(scipy.linalg.block_diag(seen.T @ (poses * seen), np.diag(rates**2)))
    effort = np.eye(len(model.inputs)) + direct.T @ (poses * direct)
    solution = _riccati(A, B, cost, effort, cross)
    gain = np.linalg.solve(effort + B.T @ solution @ B, B.T @ solution @ A + cross.T)
    return gain[:, :states], -gain[:, states:] @ scale


def observer_gain(model: System, coordinates: Coordinates, expected: Disturbances) -> Array:
    """Compute the gain M (s, f) of the Kalman filter.

    Stroke noise acts on the states and, through the direct term D of the model, on the outputs. State and output noise are then correlated.

    >>> from flexstage.control.controllers.pose_plant import pose_plant
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> observer_gain(pose_plant(plant), plant.coordinates, Disturbances(1e-9, {"S": 1e-12})).shape
    (8, 1)
    """
    densities = np.array([expected.gauges[name] for name in coordinates.gauges])
    weight = np.diag(coordinates.scale)
    C, D = weight @ model.C, weight @ model.D
    entry = model.B * expected.strokes
    pose = weight @ coordinates.pose * densities
    state, cross = entry @ entry.T, entry @ (D * expected.strokes).T
    output = pose @ pose.T + expected.strokes**2 * D @ D.T
    # variances of about 1e-20 m^2 are scaled to 1 for the solver's tolerances; only their ratios affect the gain
    unit = np.trace(output) / len(output)
    state, output, cross = state / unit, output / unit, cross / unit
    solution = _riccati(model.A.T, C.T, state, output, cross)
    return np.linalg.solve(output + C @ solution @ C.T, C @ solution).T @ weight


def estimator(model: System, observer: Array) -> System:
    """Construct the Kalman filter: it estimates the states x^ of a model from the pose y and the commands u.

    >>> from flexstage.control.controllers.pose_plant import pose_plant
    >>> from flexstage.control.example import integral_loop
    >>> model = pose_plant(integral_loop().plant)
    >>> estimator(model, np.zeros((8, 1))).input_names
    ('pose.x', 'command.B')
    """
    states = len(model.A)
    inputs = (*model.outputs, *model.inputs)
    outputs = tuple(Channel(f"state.{number}", "1") for number in range(states))
    correct = np.eye(states) - observer @ model.C
    direct = np.hstack([observer, np.zeros((states, len(model.inputs)))])
    return System(model.A @ correct, np.hstack([model.A @ observer, model.B]), correct, direct, inputs, outputs, model.step)


def _step(model: System) -> float:
    if model.step is None:
        raise refuse("LQG", "the model is continuous", "Specify a sampling rate: LQG control must be sampled")
    return model.step


def _riccati(A: Array, B: Array, cost: Array, effort: Array, cross: Array) -> Array:
    if (doubled := _doubled(A, B, cost, effort, cross)) is not None:
        return doubled
    try:
        with np.errstate(invalid="ignore"):  # badly scaled weights can make the solution infinite
            found = scipy.linalg.solve_discrete_are(A, B, cost, effort, s=cross)
        if not np.all(np.isfinite(found)):
            raise np.linalg.LinAlgError
    except np.linalg.LinAlgError as error:
        what = "the Riccati equation has no stabilising solution: an undamped mode is not controllable or not observable"
        raise refuse("LQG", what, "Retain fewer modes, or damp all of them") from error
    return 0.5 * (found + found.T)


def _doubled(A: Array, B: Array, cost: Array, effort: Array, cross: Array) -> Array | None:
    """Doubling solution of the discrete Riccati equation; `None` without convergence.

    Four times as fast as a generalised Schur form. H after k rounds is the cost of 2^k samples (Anderson, International Journal of Control
    28 (1978) 295; Chu, Fan, Lin & Wang, International Journal of Control 77 (2004) 767). Converges quadratically if the best loop is
    stable.
    """
    back = np.linalg.solve(effort, np.hstack([B.T, cross.T]))
    through, moved, left = B @ back[:, : len(A)], A - B @ back[:, len(A) :], cost - cross @ back[:, len(A) :]
    identity = np.eye(len(A))
    for _ in range(DOUBLINGS):
        try:
            both = np.linalg.solve(identity + through @ left, np.concatenate((moved, through), axis=1))
        except np.linalg.LinAlgError:
            return None
        more = moved.T @ left @ both[:, : len(A)]
        left = left + more
        left = 0.5 * (left + left.T)
        size = np.max(np.abs(left))
        if not np.isfinite(size):
            return None
        if np.max(np.abs(more)) <= _SETTLED * size:
            return left
        through = through + moved @ both[:, len(A) :] @ moved.T
        through, moved = 0.5 * (through + through.T), moved @ both[:, : len(A)]
    return None


def _sampled_system(control: LQG) -> System:
    model, M, K, Z = control.model, control.observer, control.regulator, control.integral
    states, count, width = len(model.A), len(model.outputs), len(model.inputs)
    step, seen = _step(model), estimator(model, M)
    output = np.hstack([-K @ seen.C, Z])
    applied = np.hstack([np.zeros((width, count)), -K @ M, np.eye(width)])
    A = scipy.linalg.block_diag(seen.A, np.eye(count))
    A[:states] += model.B @ output
    error = np.hstack([np.eye(count), np.zeros((count, count)), np.linalg.pinv(Z) / control.tracking])
    B = np.vstack([model.B @ applied, step * error])
    B[:states, count:-width] += seen.B[:, :count]
    direct = np.hstack([applied[:, :-width], np.zeros((width, width))])
    return System(A, B, output, direct, control.coordinates.controller_inputs(), control.coordinates.commands("command."), model.step)


def with_feedforward_states(control: System, given: LQG) -> System:
    """Add feedforward to a controller: static strokes for the reference, plus the regulator gain times the states due to these strokes.

    >>> from flexstage.control.controllers.pose_plant import pose_plant
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> found = lqg(pose_plant(plant), plant.coordinates, Weights(20.0), Disturbances(1e-9, {"S": 1e-12}), np.eye(1))
    >>> found.system(1e-4).input_names
    ('error.x', 'pose.x', 'reference.x', 'applied.B')
    """
    if given.feedforward is None:
        return control
    model = given.model
    states = np.linalg.solve(np.eye(len(model.A)) - model.A, model.B)
    gain = (np.eye(len(model.inputs)) + given.regulator @ states) @ given.feedforward
    found = with_feedforward(control, gain, given.coordinates)
    columns = [number for number, name in enumerate(found.input_names) if name.startswith("reference.")]
    entry = found.B.copy()
    # the observer uses the whole command
    entry[: len(model.A), columns] += model.B @ gain
    return replace(found, B=entry)
