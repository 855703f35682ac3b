"""Closed loops: interconnection of plant and controller, and loop-breaking points for margins."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest, unknown_names
from flexstage.base.number import Array
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.plant_models.plants import Plant, zero_order_hold
from flexstage.control.systems.system import System, connect, names_of, rename, select, static
from flexstage.models.linear.model import Channel


class LoopBreak(Enum):
    """Loop-breaking point: the loop is opened at the pose (output of the plant) or at the commands (input of the plant)."""

    POSE = "pose"
    COMMAND = "command"

    def channels(self, given: Plant) -> tuple[Channel, ...]:
        """Return the channels at the loop-breaking point: the coordinates of the pose, or the commands."""
        return given.coordinates.motions("pose.") if self is LoopBreak.POSE else given.coordinates.commands("command.")


@dataclass(frozen=True, eq=False)
class Loop:
    """Interconnected plant and controller: the basis of margins, stability, budgets and simulations.

    `plant` is the continuous plant, and `held` is the same plant discretised by `zero_order_hold`. `controller` is the specified controller
    without its inputs `applied.<actuator>`, which a linear loop does not use. `states` names the states of `system`.

    `system` is the closed loop. Inputs: `reference.<c>` [m, rad]; `noise.<gauge>` [m] added to a reading, `noise.<actuator>` [m] added to a
    command; ground motions `ground.<c>`; wrenches such as `platform.fx`, constant between samples. Outputs: motions `platform.<c>`,
    `<point>.<c>` and `relative.<c>`; readings such as `S1` with their noise; the estimated pose `pose.<c>`; `error.<c>` = reference - pose;
    `command.<actuator>` from the controller; `<actuator>`, the command with noise at the input of the hold.
    """

    plant: Plant
    held: System
    controller: System
    system: System
    states: tuple[str, ...]

    @property
    def step(self) -> float | None:
        """Time between samples [s]; None for a continuous loop."""
        return self.system.step


@check_arguments
def loop(given: Plant, controller: System) -> Loop:
    """Connect a controller to a plant.

    For each coordinate c of the loop, the controller can have the inputs `error.<c>`, `reference.<c>` and `pose.<c>`. It can also have
    inputs `applied.<actuator>`, which remain unconnected, because a linear loop has no saturation. Its outputs must be the commands
    `command.<actuator>` of all actuators. The controller's time step must equal the hardware's step (a continuous controller has none).
    Raises `DesignError` if channels or steps do not match, and for an algebraic loop without solution.

    >>> from flexstage.control.plant_models.electronics import sampling_chain
    >>> from flexstage.control.plant_models.plants import plant
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> stage = parallelogram()
    >>> one = plant(lumped(stage), ideal(stage), sampling_chain(stage, rate=10e3, delay=50e-6), modes=3)
    >>> channels = (Channel("error.x", "m"),), (Channel("command.B", "m"),)
    >>> integral = System(np.eye(1), np.eye(1), 0.05 * np.eye(1), np.zeros((1, 1)), *channels, step=1e-4)
    >>> found = loop(one, integral)
    >>> gain = select(found.system, ["reference.x"], ["error.x"]).transfer(np.array([0.0]))
    >>> found.system.growth < 0.0, float(abs(gain[0, 0, 0])) < 1e-9  # stable, and without error at rest
    (True, True)
    """
    require(_findings(given, controller))
    wanted = [name for name in controller.input_names if not name.startswith("applied.")]
    at, commands = given.coordinates, names_of(LoopBreak.COMMAND.channels(given))
    wired = select(controller, wanted, commands)
    plant_held = zero_order_hold(given)
    poses = names_of((*at.motions("pose."), *at.motions("error.")))
    outputs = (*plant_held.output_names[len(given.gauges) :], *given.gauges, *poses, *commands, *given.actuators)
    system = connect(*_wiring(given, plant_held, wired), _entries(given), outputs)
    return Loop(given, plant_held, wired, system, _states(given, plant_held, wired))


def pose_controller(controller: System, coordinates: Coordinates, sense: Array | None = None) -> System:
    """Return the controller with two groups of inputs: feedback errors, then references.

    Each feedback error replaces the controller's inputs `error` and, with the opposite sign, `pose`. If a matrix `sense` (k, c) maps the
    pose to loop coordinates, both groups of inputs are in loop coordinates.
    """
    names, known = coordinates.names, controller.input_names
    entry = np.zeros((2, len(known), len(names)))
    for kind, signs in (("error", (1.0, 1.0)), ("pose", (-1.0, 0.0)), ("reference", (0.0, 1.0))):
        for number, name in enumerate(names):
            if f"{kind}.{name}" in known:
                entry[:, known.index(f"{kind}.{name}"), number] = signs
    whole = np.hstack([*entry]) if sense is None else np.hstack([*entry]) @ np.kron(np.eye(2), np.linalg.inv(sense))
    inputs = tuple(Channel(f"{kind}.{number}", "m") for kind in ("error", "reference") for number in range(len(names)))
    return replace(controller, B=controller.B @ whole, D=controller.D @ whole, inputs=inputs)


def open_at(closed: Loop, cut: LoopBreak, channel: str | None = None) -> System:
    """Return the open loop L from the input at the break to the negative of the returned signal, so that S = (I + L)^-1.

    The loop is opened at the pose or at the commands: in all channels, or only in a single `channel`. Inputs are `cut.<name>`, with the
    names of coordinates or actuators. Raises `DesignError` for an unknown channel.

    >>> from flexstage.control.example import integral_loop
    >>> one = integral_loop()
    >>> at_pose, at_command = open_at(one, LoopBreak.POSE), open_at(one, LoopBreak.COMMAND)
    >>> at_pose.input_names, at_pose.output_names
    (('cut.x',), ('pose.x',))
    >>> far = np.array([10.0, 500.0])
    >>> bool(np.allclose(at_pose.transfer(far), at_command.transfer(far)))  # one input, one output: the same loop at both breaks
    True
    """
    outer = {each.name.removeprefix(f"{cut.value}."): each for each in cut.channels(closed.plant)}
    if channel is not None and channel not in outer:
        raise refuse(channel, f"the loop has no such {cut.value}", suggest_nearest(channel, outer))
    return _loop_cut(closed, outer.values() if channel is None else [outer[channel]])


def open_everywhere(closed: Loop) -> System:
    """Return the loop opened simultaneously at all poses and commands (channels in this order), for gain and phase factors in both.

    >>> from flexstage.control.example import integral_loop
    >>> found = open_everywhere(integral_loop())
    >>> found.input_names, found.output_names
    (('cut.x', 'cut.B'), ('pose.x', 'command.B'))
    """
    return _loop_cut(closed, [*LoopBreak.POSE.channels(closed.plant), *LoopBreak.COMMAND.channels(closed.plant)])


def _loop_cut(closed: Loop, chosen: Iterable[Channel]) -> System:
    """Loop opened at these signals, with inverted sign: the returned signal is subtracted."""
    given = closed.plant
    systems, links = _wiring(given, closed.held, closed.controller)
    entries = {each.name: replace(each, name=f"cut.{each.name.partition('.')[2]}") for each in chosen}
    swapped, zero = {name: each.name for name, each in entries.items()}, names_of(_entries(given))
    changed = {
        entry: {swapped.get(term, term): factor for term, factor in terms.items() if term not in zero} for entry, terms in links.items()
    }
    found = connect(systems, changed, tuple(entries.values()), swapped)
    return replace(found, C=-found.C, D=-found.D)


def _wiring(given: Plant, plant: System, controller: System) -> tuple[tuple[System, ...], dict[str, dict[str, float]]]:
    """Inputs of plant, estimate and controller; only poses and commands connect them."""
    entry = rename(controller, {name: f"to.{name}" for name in controller.input_names})
    links: dict[str, dict[str, float]] = {name: {name: 1.0} for name in plant.input_names if name not in given.actuators}
    links |= {f"entry.{name}": {f"command.{name}": 1.0, f"noise.{name}": 1.0} for name in given.actuators}
    links |= {f"gap.{name}": {f"gap.{name}": 1.0, f"noise.{name}": 1.0} for name in given.gauges}
    links |= {f"difference.{name}": {f"reference.{name}": 1.0, f"pose.{name}": -1.0} for name in given.coordinates.names}
    for name in controller.input_names:
        kind, _, axis = name.partition(".")
        links[f"to.{name}"] = links[f"difference.{axis}"] if kind == "error" else {name: 1.0}
    return (plant, _estimate(given), _sums(given), entry), links


def _estimate(given: Plant) -> System:
    """Readings with their noise, the pose from them, and the error."""
    gauges, entry = given.coordinates.readings(), given.coordinates.readings("gap.")
    gain = np.vstack([np.eye(len(gauges)), given.coordinates.pose])
    return static(gain, entry, (*gauges, *given.coordinates.motions("pose.")), given.hardware.step)


def _sums(given: Plant) -> System:
    """Inputs of the hold, and the error."""
    entry = (*given.coordinates.commands("entry."), *given.coordinates.motions("difference."))
    exit_ = (*given.coordinates.commands(), *given.coordinates.motions("error."))
    return static(np.eye(len(entry)), entry, exit_, given.hardware.step)


def _entries(given: Plant) -> tuple[Channel, ...]:
    """References, noise of gauges and actuators, disturbances."""
    at = given.coordinates
    disturbances = (channel for channel in given.system.inputs if channel.name not in given.actuators)
    return (*at.motions("reference."), *at.readings("noise."), *at.commands("noise."), *disturbances)


def _states(given: Plant, plant: System, controller: System) -> tuple[str, ...]:
    """State names of the plant, the delayed strokes (newest first), and the controller."""
    late = len(plant.A) - len(given.states)
    width = len(given.actuators)
    registers = (f"held.{given.actuators[number % width]}.{number // width + 1}" for number in range(late))
    return (*given.states, *registers, *(f"controller.{number + 1}" for number in range(len(controller.A))))


def _findings(given: Plant, controller: System) -> Iterator[Finding]:
    own, other = controller.step, given.hardware.step
    if own is None or other is None:
        differs, kinds = own is not other, ["continuous" if step is None else f"sampled every {step:g} s" for step in (own, other)]
    else:
        differs, kinds = abs(own / other - 1.0) > 1e-9, [f"{own:g} s", f"{other:g} s"]
    if differs:
        what = f"different sampling (got {kinds[0]}, expected {kinds[1]}, like the hardware)"
        yield Finding("controller", what, "Use one sampling rate for both")
    at = given.coordinates
    known = names_of((*at.motions("error."), *at.motions("reference."), *at.motions("pose."), *at.commands("applied.")))
    yield from unknown_names(controller.input_names, known, "input of a controller")
    for name in names_of(LoopBreak.COMMAND.channels(given)):
        if name not in controller.output_names:
            yield Finding("controller", f"missing output {name}", "Add a command output for every actuator; it may be zero")
