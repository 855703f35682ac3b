"""Plant with creeping stacks: creep between the hold and the amplifiers' lag, as linear states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexstage.base.finding import refuse
from flexstage.control.hysteresis.creep import Creep
from flexstage.control.plant_models.electronics import ChargeDrive
from flexstage.control.plant_models.plants import Plant
from flexstage.control.systems.system import System, connect, rename
from flexstage.models.linear.model import Channel


def add_creep(given: Plant, creep: Creep) -> Plant:
    """Add the creep of the stacks to a plant: each free stroke u is first replaced by y = g_0 u + sum_i g_i s_i (see `Creep`).

    The rate-independent hysteresis acts before the creep (Hammerstein model); all components after the hold are therefore linear and
    exactly sampled. Creep and amplifier lag commute, because both are linear. For charge-driven stacks, the creep y - u passes the filter h
    + (1 - h) w_0/(s + w_0), where h is the residual hysteresis and w_0 [rad/s] the corner of the charge drive. Raises `DesignError` if axes
    and actuators differ in number.

    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> found = add_creep(plant, Creep([1.0], [0.1, 0.05], [2.0, 0.2]))
    >>> found.states[:2], round(float(found.system.transfer([0.0])[0, 0, 0].real / plant.system.transfer([0.0])[0, 0, 0].real), 9)
    (('creep.B.1', 'creep.B.2'), 1.15)
    """
    if creep.axes != len(given.actuators):
        raise refuse(
            "creep", f"wrong number of axes (got {creep.axes}, expected {len(given.actuators)}, the actuators)", "Use one axis per actuator"
        )
    entering = given.coordinates.commands()
    crept = {name: f"crept.{name}" for name in given.actuators}
    first = creep.system(entering, tuple(Channel(name, "m") for name in crept.values()))
    systems, links = [first, rename(given.system, crept)], {}
    states = [f"creep.{name}.{number + 1}" for name in given.actuators for number in range(creep.times.shape[1])]
    held = {name: each.charge for name, each in given.hardware.amplifiers.items() if each.charge is not None and name in crept}
    for name, drive in held.items():
        systems.insert(1, _relieve(name, drive))
        links |= {f"own.{name}": {crept[name]: 1.0, name: -1.0}, crept[name]: {name: 1.0, f"left.{name}": 1.0}}
    states += [f"relief.{name}" for name in reversed(held)]
    whole = connect(systems, links, given.system.inputs, given.system.output_names)
    note = f"{given.note}; creep by {creep.times.shape[1]} exponentials per actuator"
    return replace(given, system=whole, states=(*states, *given.states), note=note)


def _relieve(name: str, drive: ChargeDrive) -> System:
    """Reduction of a stack's creep [m] by a charge drive."""
    rate, left = 2.0 * np.pi * drive.corner, drive.residual_hysteresis
    one, entry, exit_ = np.eye(1), (Channel(f"own.{name}", "m"),), (Channel(f"left.{name}", "m"),)
    return System(-rate * one, one, (1.0 - left) * rate * one, left * one, entry, exit_)
