"""Plant of a loop: a stage of any model between its amplifiers' inputs and its gauges' filtered readings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest, unknown_names
from flexstage.base.number import Array, Table
from flexstage.base.record import INNER
from flexstage.base.units.quantity import FREQUENCY
from flexstage.control.plant_models.coordinates import Coordinates, coordinates
from flexstage.control.plant_models.electronics import Amplifier, Hardware, Sensor
from flexstage.control.systems.sampling import discretise, first_order_hold
from flexstage.control.systems.system import System, connect, from_state_space, lag, names_of, rename, select, static
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Damping
from flexstage.models.linear.damping import damping_law
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import Channel, LinearModel
from flexstage.models.linear.port import ports
from flexstage.models.linear.state_space import state_space
from flexstage.spatial.frame import COMPONENTS, FORCES

SENSED = "sensed"
"""Name prefix of the inputs that add noise to the sensors of inner loops."""
ADDED = "added"
"""Name prefix of the outputs that are the strokes of inner loops, added before the amplifiers."""
_REPEATED = 1e-3


@dataclass(frozen=True, eq=False)
class Plant:
    """Continuous plant between hold and sampler: a stage with amplifiers and gauges.

    Inputs of `system`: `<actuator>`, the free stroke [m] or current [A] (between hold and amplifiers); `ground.<c>`, the ground motions [m,
    rad]; `platform.fx` ..., the wrenches [N, N m]. Outputs are the readings `gap.<gauge>` [m, rad] (after lag and filter, before noise and
    rounding), absolute motions `platform.<c>` and `<point>.<c>` [m, rad], and motions relative to the ground, `relative.<c>` and
    `relative.<point>.<c>`. `states` names the states of `system`. `frequencies` [Hz] and `ratios` belong to the retained modes; `left_out`
    counts the omitted modes, whose compliance is a static term. `note` lists the simplifications. `heard` contains the noise densities of
    further inputs: the noise of sensors in inner loops.
    """

    system: Annotated[System, INNER]
    states: Annotated[tuple[str, ...], INNER]
    coordinates: Coordinates
    hardware: Hardware
    frequencies: Annotated[Array, FREQUENCY]
    ratios: Array
    left_out: int
    note: str
    provenance: str
    heard: Annotated[Mapping[str, float], INNER] = field(default_factory=lambda: Table({}))

    @property
    def actuators(self) -> tuple[str, ...]:
        """Names of the actuators."""
        return self.coordinates.actuators

    @property
    def gauges(self) -> tuple[str, ...]:
        """Names of the gauges."""
        return self.coordinates.gauges


@check_arguments
def plant(
    model: LinearModel,
    kinematics: Kinematics,
    given: Hardware,
    *,
    modes: int | None = None,
    points: tuple[str, ...] = (),
    damping: Damping | None = None,
    links: tuple[str, ...] = (),
) -> Plant:
    """Build the plant of a control loop from the model of a stage; `kinematics` defines the coordinates of the loop.

    `modes` is the number of modes to retain. By default, a sampled plant retains all modes below half the sampling rate, and a continuous
    plant retains all modes. At least as many modes as loop coordinates are retained, and modes of a pair (frequencies within 0.1 %) are
    retained together. The static compliance of omitted modes is kept. The motions of `points` (further bodies or points) become outputs.
    The axial forces `<link>.fx` [N] of `links` become outputs. Raises `DesignError` for a batch of designs, a design without damping,
    gauges that cannot observe the pose, and actuators that cannot produce the pose.

    >>> from flexstage.control.plant_models.electronics import sampling_chain
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> stage = parallelogram()
    >>> found = plant(lumped(stage), ideal(stage), sampling_chain(stage, rate=10e3), modes=2)
    >>> found.system.input_names[:3], found.system.output_names[:3], found.states
    (('B', 'ground.x', 'ground.y'), ('gap.S', 'platform.x', 'platform.y'), ('mode1', 'mode2', "mode1'", "mode2'", 'gauge.S'))
    """
    if model.stiffness_matrix.ndim != 2:
        raise refuse(
            "loop", f"wrong number of designs (got a batch of {model.stiffness_matrix.shape[:-2]}, expected one)", "Use one design"
        )
    loop = coordinates(kinematics, model)
    require(_findings(model, loop, given, points))
    law = damping_law(model, damping)
    solved = eigen(model)
    kept = _count(np.sqrt(solved.values) / (2.0 * np.pi), given, modes, len(loop.names))
    twists = tuple(f"{place}.{name}" for place in dict.fromkeys((PLATFORM, *points)) for name in COMPONENTS)
    grounds = tuple(f"{GROUND}.{name}" for name in COMPONENTS)
    wrenches = tuple(f"{PLATFORM}.{name}" for name in FORCES)
    forces = tuple(f"{name}.fx" for name in links)
    space = state_space(
        model,
        ports(model, (*loop.gauges, *twists, *forces), (*loop.actuators, *grounds, *wrenches)),
        law,
        None if kept == len(solved.values) else kept,
    )
    stage = _with_relative(from_state_space(space), model, twists)
    system, states = _with_sampling_chain(stage, space.states, loop, given)
    return Plant(
        system=system,
        states=states,
        coordinates=loop,
        hardware=given,
        frequencies=np.sqrt(solved.values[:kept]) / (2.0 * np.pi),
        ratios=space.ratios,
        left_out=len(solved.values) - kept,
        note=space.note,
        provenance=space.provenance,
    )


def zero_order_hold(given: Plant) -> System:
    """Discretise the plant by zero-order hold, exactly at the samples; the `delay` applies to strokes, but not to wrenches.

    Ground motion is linear between samples (`first_order_hold`): a hold would add jumps to the gauge readings. In each sample, the gauges
    are read before the new strokes are output; even without delay and lag, the readings are therefore due to the previous strokes. A
    continuous plant is returned unchanged. Inputs and outputs are as in `Plant.system`. The states of the result are those of the plant,
    then the delayed strokes.

    >>> from flexstage.control.plant_models.electronics import sampling_chain
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> stage = parallelogram()
    >>> one = plant(lumped(stage), ideal(stage), sampling_chain(stage, rate=10e3, delay=150e-6), modes=2)
    >>> len(one.system.A), len(zero_order_hold(one).A)  # plus two delayed strokes of the actuator
    (5, 7)
    """
    step = given.hardware.step
    if step is None:
        return given.system
    actuators = given.actuators
    ground = tuple(name for name in given.system.input_names if name.startswith(f"{GROUND}."))
    others = tuple(name for name in given.system.input_names if name not in (*actuators, *ground))
    outputs = given.system.output_names
    driven = discretise(select(given.system, actuators, outputs), step, given.hardware.delay, len(given.gauges))
    moved, loaded = first_order_hold(select(given.system, ground, outputs), step), discretise(select(given.system, others, outputs), step)
    entering = np.pad(np.hstack([moved.B, loaded.B]), ((0, len(driven.A) - len(moved.A)), (0, 0)))
    return replace(
        driven,
        B=np.hstack([driven.B, entering]),
        D=np.hstack([driven.D, moved.D, loaded.D]),
        inputs=(*driven.inputs, *moved.inputs, *loaded.inputs),
    )


def _count(frequencies: Array, given: Hardware, modes: int | None, least: int) -> int:
    """Number of retained modes: as requested, or those below half the sampling rate; whole pairs, at least the number of coordinates."""
    below = np.inf if given.rate is None else 0.5 * given.rate
    count = min(max(int(np.sum(frequencies < below)) if modes is None else modes, least), len(frequencies))
    while count < len(frequencies) and frequencies[count] < frequencies[count - 1] * (1.0 + _REPEATED):
        count += 1
    return count


def _with_relative(stage: System, model: LinearModel, twists: tuple[str, ...]) -> System:
    """Additional outputs: twists relative to the ground, including its direct motion."""
    rows = [stage.output_names.index(name) for name in twists]
    columns = [stage.input_names.index(f"{GROUND}.{name}") for name in COMPONENTS]
    direct = stage.D[rows].copy()
    direct[:, columns] -= model.rigid_output[model.output_index(twists)]
    names = tuple(f"relative.{name.removeprefix(f'{PLATFORM}.')}" for name in twists)
    further = tuple(Channel(name, stage.outputs[row].unit) for name, row in zip(names, rows, strict=True))
    return replace(stage, C=np.vstack([stage.C, stage.C[rows]]), D=np.vstack([stage.D, direct]), outputs=(*stage.outputs, *further))


def _with_sampling_chain(stage: System, states: tuple[str, ...], loop: Coordinates, given: Hardware) -> tuple[System, tuple[str, ...]]:
    """Amplifiers before the stage, lags and filters behind its gauges; the names of all states."""
    amplifiers = _lags(loop.commands(), given.amplifiers, loop.commands("stroke."))
    lags, *filters = _gauge_chain(loop, given)
    others = tuple(channel for channel in stage.inputs if channel.name not in loop.actuators)
    body = rename(stage, {name: f"stroke.{name}" for name in loop.actuators})
    motions = tuple(name for name in stage.output_names if name not in loop.gauges)
    inputs = (*loop.commands(), *others)
    outputs = (*loop.gaps, *motions)
    names = [*states, *_slow("amplifier", loop.actuators, amplifiers), *_slow("gauge", loop.gauges, lags)]
    names += [f"filter.{name}.{number + 1}" for name, each in zip(loop.gauges, filters, strict=True) for number in range(len(each.A))]
    return connect([body, amplifiers, lags, *filters], {}, inputs, outputs), tuple(names)


def _slow(kind: str, names: tuple[str, ...], lags: System) -> list[str]:
    """Names of lags with a state."""
    return [f"{kind}.{name}" for name, gain in zip(names, np.diag(lags.D), strict=True) if gain == 0.0]


def _lags(inputs: tuple[Channel, ...], items: Mapping[str, Amplifier | Sensor], outputs: tuple[Channel, ...]) -> System:
    bandwidths = np.array([items[each.name].bandwidth if each.name in items else np.inf for each in inputs])
    return lag(inputs, bandwidths, outputs)


def _gauge_chain(loop: Coordinates, given: Hardware) -> list[System]:
    """Lags of all gauges, and the filter of each."""
    inputs = loop.readings()
    filters = (_filter(channel, given.sensors.get(channel.name, Sensor())) for channel in inputs)
    return [_lags(inputs, given.sensors, loop.readings("lagged.")), *filters]


def _filter(read: Channel, sensor: Sensor) -> System:
    """Butterworth low-pass filter of gain 1."""
    entry, exit_ = (Channel(f"lagged.{read.name}", read.unit),), (Channel(f"gap.{read.name}", read.unit),)
    if not sensor.filter_order:
        return static(np.eye(1), entry, exit_)
    order, turning = sensor.filter_order, 2.0 * np.pi * sensor.filter_corner
    angles = np.pi * (2.0 * np.arange(order) + order + 1.0) / (2.0 * order)
    A = np.diag(np.ones(order - 1), 1)
    A[-1] = -np.real(np.poly(np.exp(1j * angles)))[:0:-1]
    last, first = np.eye(order)[:, -1:], np.eye(order)[:1]
    return System(A * turning, last * turning, first, np.zeros((1, 1)), entry, exit_)


def sensor_filter(given: Plant) -> System:
    """Return lags and filters of the gauges: from noise `noise.<gauge>` [m] at the gauge to `filtered.<gauge>` [m] at the sampler.

    >>> from flexstage.control.plant_models.electronics import GaugeSettings, sampling_chain
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> stage = parallelogram()
    >>> filtered = sampling_chain(stage, gauges=GaugeSettings(filter_order=2, filter_corner=1000.0))
    >>> found = sensor_filter(plant(lumped(stage), ideal(stage), filtered, modes=2))
    >>> round(float(abs(found.transfer(np.array([1000.0]))[0, 0, 0])), 4)  # 0.7071 / (1 + (1/3)^2)^(1/2), the gauge has 3 kHz
    0.6708
    """
    chain = _gauge_chain(given.coordinates, given.hardware)
    whole = connect(chain, {}, given.coordinates.readings(), given.coordinates.gaps)
    old = {name: f"noise.{name}" for name in given.gauges} | {f"gap.{name}": f"filtered.{name}" for name in given.gauges}
    return rename(whole, old)


def _findings(model: LinearModel, loop: Coordinates, given: Hardware, points: tuple[str, ...]) -> Iterator[Finding]:
    outputs = names_of(model.outputs)
    both = set(loop.actuators) & set(loop.gauges)
    for name in sorted(both):
        yield Finding(name, "an actuator and a gauge have this name", "Rename the actuator or the gauge")
    for name in points:
        if f"{name}.x" not in outputs:
            places = {each.rpartition(".")[0] for each in outputs if each.endswith(".rz")}
            yield Finding(name, "unknown point of the model", suggest_nearest(name, places))
    yield from unknown_names(given.amplifiers, loop.actuators, "actuator")
    yield from unknown_names(given.sensors, loop.gauges, "gauge")
