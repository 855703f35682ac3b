"""White noise sources of a loop as inputs of one linear system, and mean squares from Lyapunov's equation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.control.plant_models.electronics import Amplifier, Sensor
from flexstage.control.plant_models.plants import Plant, sensor_filter
from flexstage.control.systems.closed import Loop
from flexstage.control.systems.system import System, connect, reachable, select
from flexstage.models.linear.model import Channel


class Kind(Enum):
    """Kind of disturbance."""

    FLOOR = "floor"
    GAUGE = "gauge noise"
    ROUNDING = "gauge rounding"
    AMPLIFIER = "amplifier noise"
    CONVERTER = "converter rounding"


@dataclass(frozen=True)
class Source:
    """Noise source: its kind, and the gauge, actuator or ground motion at which it acts."""

    kind: Kind
    channel: str


def mean_squares(system: System) -> Array:
    """Compute the mean square (p, m) of each output for each unit white input.

    The mean square e^2 of one output for one input follows from their system matrices A, b, c and d. The inputs of a sampled system have
    variance 1: e^2 = b^T X b + d^2, where X solves X = A^T X A + c^T c. The inputs of a continuous system have two-sided density 1: e^2 =
    b^T X b, where X solves A^T X + X A + c^T c = 0; e^2 is infinite if d is not zero. The system must be stable.

    >>> metre = (Channel("u", "m"),), (Channel("y", "m"),)
    >>> lag = System(-np.eye(1), np.eye(1), np.eye(1), np.zeros((1, 1)), *metre)
    >>> mean_squares(lag).tolist()  # 1/(2 pi) times the integral of 1/(1 + omega^2)
    [[0.5]]
    """
    A, B, C, _ = system.balanced
    found = system.D**2 if system.step is not None else np.where(system.D == 0.0, 0.0, np.inf)
    for row, output in enumerate(C):
        weight = np.outer(output, output)
        gramian = (
            scipy.linalg.solve_continuous_lyapunov(A.T, -weight)
            if system.step is None
            else scipy.linalg.solve_discrete_lyapunov(A.T, weight, "bilinear")
        )
        found[row] += np.sum(B * (np.real(gramian) @ B), axis=0)
    return found


def held_noise(A: Array, B: Array, step: float) -> Array:
    """Compute a factor L (n, k) of the state covariance Q = L L^T that white noise of density 1 causes within a step of length T.

    For a system with the matrices A and B, Q(T) = int_0^T e^{As} B B^T e^{A^T s} ds. A Taylor series gives Q(t) for a small fraction t of
    the step. The fraction t is then doubled repeatedly: Q(2t) = Q(t) + e^{At} Q(t) e^{A^T t}. For a stable system, no exponential grows.

    >>> factor = held_noise(-np.eye(1), np.eye(1), 0.5)
    >>> round(float(factor[0, 0] ** 2), 12), round(float(0.5 * (1.0 - np.exp(-1.0))), 12)
    (0.316060279414, 0.316060279414)
    """
    balanced, (scale, _) = scipy.linalg.matrix_balance(A, permute=False, separate=True)
    driven = B / scale[:, None]
    doublings = max(0, int(np.ceil(np.log2(max(2.0 * np.linalg.norm(balanced, 2) * step, 1.0)))))
    part = step / 2**doublings
    term = driven @ driven.T * part
    total = term
    for order in range(2, 24):
        term = (balanced @ term + term @ balanced.T) * (part / order)
        total = total + term
    moved = scipy.linalg.expm(balanced * part)
    for _ in range(doublings):
        total, moved = total + moved @ total @ moved.T, moved @ moved
    size = np.sqrt(np.maximum(np.diag(total), 1e-300))
    values, vectors = np.linalg.eigh(total / size / size[:, None])
    return scale[:, None] * size[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))


def white_system(closed: Loop, outputs: tuple[str, ...]) -> tuple[System, tuple[Source, ...]]:
    """Return the closed loop driven by unit white inputs, and the source of each input.

    Gauge noise is white before lag and filter; the filtered noise is sampled exactly, with aliasing. For a gauge without lag and filter,
    the noise is assumed to end at half the sampling rate. Rounding noise is white with variance step^2/12. Amplifier noise also drives the
    stage between the samples; noise of an amplifier without lag is omitted here.

    >>> from flexstage.control.example import integral_loop
    >>> system, sources = white_system(integral_loop(), ("relative.x",))
    >>> [source.kind.value for source in sources], system.output_names
    (['gauge noise', 'gauge rounding'], ('relative.x',))
    """
    given, systems, links, inputs, sources = closed.plant, [], {}, [], []
    for name in given.gauges:
        sensor, terms = given.hardware.sensors.get(name, Sensor()), {}
        if sensor.noise_density:
            systems.append(gauge_noise(given, name, sensor.noise_density))
            inputs += systems[-1].inputs
            sources += [Source(Kind.GAUGE, name)] * len(systems[-1].inputs)
            terms[f"coloured.{name}"] = 1.0
        if sensor.resolution:
            inputs.append(Channel(f"rounding.{name}", "1"))
            sources.append(Source(Kind.ROUNDING, name))
            terms[f"rounding.{name}"] = sensor.resolution / np.sqrt(12.0)
        links[f"noise.{name}"] = terms
    for name in given.actuators:
        size = given.hardware.amplifiers.get(name, Amplifier()).step
        links[f"noise.{name}"] = {f"converted.{name}": size / np.sqrt(12.0)} if size else {}
        inputs += [Channel(f"converted.{name}", "1")] if size else []
        sources += [Source(Kind.CONVERTER, name)] if size else []
    whole = connect([select(closed.system, tuple(links), outputs), *systems], links, tuple(inputs), outputs)
    return _with_amplifiers(whole, closed, outputs, tuple(sources))


def gauge_noise(given: Plant, gauge: str, density: float) -> System:
    """Return a system from unit white inputs to the gauge noise of a sampled loop; the noise has a white `density` before lag and filter.

    >>> from flexstage.control.example import integral_loop
    >>> found = gauge_noise(integral_loop().plant, "S", 1e-12)
    >>> bool(found.step), round(float(mean_squares(found).sum() / (1e-24 * 0.5 * np.pi * 3000.0)), 6)  # density^2 pi/2 f of a lag f
    (True, 1.0)
    """
    used, step = reachable(select(sensor_filter(given), [f"noise.{gauge}"], [f"filtered.{gauge}"])), given.hardware.step or 0.0
    outputs = (Channel(f"coloured.{gauge}", used.outputs[0].unit),)
    if not len(used.A):
        return System(used.A, used.B, used.C, used.D * density / np.sqrt(2.0 * step), (Channel(f"white.{gauge}", "1"),), outputs, step)
    factor = held_noise(used.A, used.B * density / np.sqrt(2.0), step)  # x[k+1] = e^{AT} x[k] + L w[k], unit w
    inputs = tuple(Channel(f"white.{gauge}.{number + 1}", "1") for number in range(factor.shape[1]))
    return System(scipy.linalg.expm(used.A * step), factor, used.C, np.zeros((1, len(inputs))), inputs, outputs, step)


def _with_amplifiers(
    whole: System, closed: Loop, outputs: tuple[str, ...], sources: tuple[Source, ...]
) -> tuple[System, tuple[Source, ...]]:
    """Amplifier noise as its contribution to the plant's states, the first of all, after each step."""
    given, step = closed.plant, closed.step
    for name in bounded_amplifiers(closed, outputs):
        density = given.hardware.amplifiers[name].noise_density or 0.0
        column = given.system.B[:, [given.system.input_names.index(name)]]
        factor = held_noise(given.system.A, column * density / np.sqrt(2.0), step or 0.0)
        entry = np.pad(factor, ((0, len(whole.A) - len(factor)), (0, 0)))
        inputs = tuple(Channel(f"amplified.{name}.{number + 1}", "1") for number in range(factor.shape[1]))
        direct = np.zeros((len(whole.outputs), len(inputs)))
        whole = replace(whole, B=np.hstack([whole.B, entry]), D=np.hstack([whole.D, direct]), inputs=(*whole.inputs, *inputs))
        sources = (*sources, *[Source(Kind.AMPLIFIER, name)] * len(inputs))
    return whole, sources


def bounded_amplifiers(closed: Loop, outputs: tuple[str, ...]) -> tuple[str, ...]:
    """Find actuators whose amplifier noise passes a lag before it acts on gauges and outputs: its mean square is then finite.

    >>> from flexstage.control.example import integral_loop
    >>> bounded_amplifiers(integral_loop(), ("relative.x",))  # no noise is stated
    ()
    """
    given = closed.plant
    observed = [*(f"gap.{name}" for name in given.gauges), *(name for name in outputs if name in given.system.output_names)]
    noisy = [name for name in given.actuators if name in given.hardware.amplifiers and given.hardware.amplifiers[name].noise_density]
    return tuple(name for name in noisy if not np.any(select(given.system, [name], observed).D))
