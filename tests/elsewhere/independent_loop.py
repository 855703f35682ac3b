"""The same loop written once more, plainly, for programs that integrate or step it: nothing of the simulation's own code."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from scipy.optimize import brentq

from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.plant_models.plants import Plant
from flexstage.control.simulation.machine import Machine


def moved(model: PrandtlIshlinskii, plays: np.ndarray, volts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Plays after these volts, and their weighted sum; no envelopes."""
    plays = np.clip(plays, volts[:, None] - model.thresholds, volts[:, None] + model.thresholds)
    return plays, np.sum(model.weights * plays, axis=1)


def sought(model: PrandtlIshlinskii, plays: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The volts that make a stroke, by search for a root, axis by axis."""
    found = np.empty_like(wanted)
    for axis in range(len(wanted)):
        one = PrandtlIshlinskii(model.thresholds[axis], model.weights[axis])
        found[axis] = brentq(
            lambda volts, one=one, axis=axis: moved(one, plays[axis : axis + 1], np.array([volts]))[1][0] - wanted[axis],
            -1e4,
            1e4,
            xtol=1e-12,
            rtol=1e-15,
        )
    return found


@dataclass
class Computer:
    """Gauges, controller, amplifiers and stacks of a machine: one call a sample. States: controller, last strokes, plays, model's plays."""

    machine: Machine

    def start(self) -> tuple[np.ndarray, ...]:
        given = self.machine
        bias = given.amplifiers.bias
        plays = [np.zeros((len(bias), 0)) if model is None else model.start(bias) for model in (given.hysteresis, given.compensation)]
        return np.zeros(len(given.controller.A)), np.zeros(len(bias)), *plays, np.zeros(len(given.gauges))

    def sample(self, state: tuple[np.ndarray, ...], reference: np.ndarray, gaps: np.ndarray):
        """The next state, free strokes, and what was found on the way; `gaps` are the readings before they are rounded."""
        given, (z, last, plays, model_plays, seen) = self.machine, state
        steps, amplifiers = given.resolution, given.amplifiers
        read = [gap if not (step and np.isfinite(gap)) else step * round(gap / step) for gap, step in zip(gaps, steps, strict=True)]
        ends = np.full(len(gaps), np.inf) if given.half_range is None else given.half_range
        good = [np.isfinite(one) and abs(one) - end <= 0.5 * step for one, end, step in zip(read, ends, steps, strict=True)]
        readings = np.array([one if known else kept for one, known, kept in zip(read, good, seen, strict=True)])
        pose = given.pose @ readings
        error = reference - pose
        signals = {f"pose.{name}": value for name, value in zip(given.names, pose, strict=True)}
        signals |= {f"reference.{name}": value for name, value in zip(given.names, reference, strict=True)}
        signals |= {f"error.{name}": value for name, value in zip(given.names, error, strict=True)}
        signals |= dict.fromkeys((f"applied.{name}" for name in given.actuators), 0.0)
        control = given.controller
        entry = np.array([signals[name] for name in control.input_names])
        order = [control.output_names.index(f"command.{name}") for name in given.actuators]
        command = (control.C @ z + control.D @ entry)[order]
        asked = command if given.compensation is None else self._inverted(model_plays, command)
        asked = np.array([one if not step else step * round(one / step) for one, step in zip(asked, amplifiers.step, strict=True)])
        out = np.clip(
            np.clip(asked, amplifiers.low, amplifiers.high), last - amplifiers.slew * given.step, last + amplifiers.slew * given.step
        )
        for index, name in enumerate(control.input_names):
            if name.startswith("applied."):
                entry[index] = (out - asked)[given.actuators.index(name.removeprefix("applied."))]
        volts, stroke = amplifiers.bias + out / amplifiers.gain, out
        if given.hysteresis is not None:
            plays, stroke = moved(given.hysteresis, plays, volts)
            stroke = stroke - moved(given.hysteresis, given.hysteresis.start(amplifiers.bias), amplifiers.bias)[1]
        if given.compensation is not None:
            model_plays = moved(given.compensation, model_plays, volts)[0]
        following = control.A @ z + control.B @ entry, out, plays, model_plays, readings
        return following, stroke, {"pose": pose, "command": command, "asked": asked, "given": out, "readings": readings}

    def _inverted(self, plays: np.ndarray, command: np.ndarray) -> np.ndarray:
        model, amplifiers = self.machine.compensation, self.machine.amplifiers
        at_rest = moved(model, model.start(amplifiers.bias), amplifiers.bias)[1]
        return (sought(model, plays, command + at_rest) - amplifiers.bias) * amplifiers.gain


class Stepped:
    """The whole loop as one nonlinear difference equation x+ = f(x, u), y = g(x, u), as python-control takes it; no disturbances."""

    def __init__(self, given: Machine) -> None:
        self.computer, self.given = Computer(given), given
        self.start = self.computer.start()
        self.shapes = [each.shape for each in self.start]
        plant = given.plant
        self.columns = [plant.input_names.index(name) for name in given.actuators]
        self.rows = [plant.output_names.index(f"gap.{name}") for name in given.gauges]
        self.initial = self.packed(np.zeros(len(plant.A)), self.start)

    def packed(self, x: np.ndarray, state: tuple[np.ndarray, ...]) -> np.ndarray:
        return np.concatenate([x, *(each.ravel() for each in state)])

    def unpacked(self, values: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
        sizes = np.cumsum([len(self.given.plant.A), *(int(np.prod(shape)) for shape in self.shapes)])
        parts = np.split(values, sizes[:-1])
        return parts[0], tuple(part.reshape(shape) for part, shape in zip(parts[1:], self.shapes, strict=True))

    def update(self, _time, values, reference, _parameters=None) -> np.ndarray:
        x, state = self.unpacked(values)
        plant = self.given.plant
        following, stroke, _ = self.computer.sample(state, reference, plant.C[self.rows] @ x)
        return self.packed(plant.A @ x + plant.B[:, self.columns] @ stroke, following)

    def output(self, _time, values, reference, _parameters=None) -> np.ndarray:
        x, state = self.unpacked(values)
        found = self.computer.sample(state, reference, self.given.plant.C[self.rows] @ x)[2]
        return np.concatenate([found["pose"], found["given"]])


def integrated(given: Machine, whole: Plant, reference: np.ndarray, named: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The loop by variable steps: the continuous plant between samples, strokes held and arriving late within one; all else on samples."""
    system, step, delay = whole.system, given.step, whole.hardware.delay
    assert delay < step
    names, count = system.input_names, len(reference)
    constant = {name: named.get(name, np.zeros(count)) for name in names if name not in given.actuators}
    computer = Computer(given)
    state, x = computer.start(), np.zeros(len(system.A))
    stroke = np.zeros(len(given.actuators))
    rows = [system.output_names.index(f"gap.{name}") for name in given.gauges]
    found: dict[str, list[np.ndarray]] = {}

    def entering(k: int, strokes: np.ndarray) -> np.ndarray:
        values = dict(zip(given.actuators, strokes, strict=True))
        return np.array([values[name] if name in values else constant[name][k] for name in names])

    shakes = np.array([name.startswith("ground.") for name in names])

    def passed(x: np.ndarray, k: int, strokes: np.ndarray, times: tuple[float, float]) -> np.ndarray:
        """From one time within the sample to another; the ground moves straight to its next value."""
        if times[0] == times[1]:
            return x
        drive = system.B @ entering(k, strokes)
        ramp = system.B @ np.where(shakes, (entering(min(k + 1, count - 1), strokes) - entering(k, strokes)) / step, 0.0)
        solve = scipy.integrate.solve_ivp
        return solve(lambda t, x: system.A @ x + drive + ramp * t, times, x, method="DOP853", rtol=1e-11, atol=1e-18).y[:, -1]

    for k in range(count):
        now = entering(k, stroke)
        seen = system.C @ x + system.D @ now
        gaps = seen[rows] + [named.get(f"noise.{name}", np.zeros(count))[k] for name in given.gauges]
        state, ahead, told = computer.sample(state, reference[k], gaps)
        ahead = ahead + [named.get(f"noise.{name}", np.zeros(count))[k] for name in given.actuators]
        for key, value in {**told, "stroke": ahead, "motions": np.delete(seen, rows)}.items():
            found.setdefault(key, []).append(value)
        x = passed(x, k, stroke, (0.0, delay))
        stroke = ahead
        x = passed(x, k, stroke, (delay, step))
    return {key: np.array(values) for key, values in found.items()}
