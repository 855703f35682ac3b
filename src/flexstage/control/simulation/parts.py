"""Matrices of plant and controller by inputs and outputs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.simulation.machine import Machine
from flexstage.control.systems.system import System, names_of, select


@dataclass(frozen=True, eq=False)
class Parts:
    """Matrices of plant and controller, by inputs and outputs.

    For strokes f, disturbances w, readings y and motions m, the plant's next state is x+ = A x + `stroke` f + `disturbed` w. Its outputs
    are y = `reading` x + `reading_w` w and m = `motion` x + `motion_f` f + `motion_w` w. For the reference r, the pose q and the amplifier
    limitation a (`applied`), the controller's next state is z+ = `controller` z + `from_reference` r + `from_pose` q + `from_applied` a.
    The command is `command` z + `command_r` r + `command_q` q.
    """

    A: Array
    stroke: Array
    disturbed: Array
    reading: Array
    reading_w: Array
    motion: Array
    motion_f: Array
    motion_w: Array
    controller: Array
    from_reference: Array
    from_pose: Array
    from_applied: Array
    command: Array
    command_r: Array
    command_q: Array


def parts(given: Machine) -> Parts:
    """Partition the matrices of a loop. The controller's input `error` is replaced by reference minus pose.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> found = parts(machine(example.plant, example.controller))
    >>> bool(np.all(found.from_reference == -found.from_pose))
    True
    """
    plant, command = given.plant, select(given.controller, given.controller.input_names, given.commands)
    outputs = (*given.readings, *names_of(given.motions))
    of_error, of_reference, of_pose = (_columns(command, kind, given.names) for kind in ("error", "reference", "pose"))
    driven = select(plant, given.actuators, outputs)
    shaken = select(plant, names_of(given.disturbances), outputs)
    count = len(given.readings)
    return Parts(
        A=plant.A,
        stroke=driven.B,
        disturbed=shaken.B,
        reading=driven.C[:count],
        reading_w=shaken.D[:count],
        motion=driven.C[count:],
        motion_f=driven.D[count:],
        motion_w=shaken.D[count:],
        controller=command.A,
        from_reference=of_error[0] + of_reference[0],
        from_pose=of_pose[0] - of_error[0],
        from_applied=_columns(command, "applied", given.actuators)[0],
        command=command.C,
        command_r=of_error[1] + of_reference[1],
        command_q=of_pose[1] - of_error[1],
    )


def _columns(system: System, kind: str, names: tuple[str, ...]) -> tuple[Array, Array]:
    """Columns of B and D for the inputs of a kind, zero for absent inputs."""
    known = system.input_names
    there = [column for column, name in enumerate(names) if f"{kind}.{name}" in known]
    entering, direct = (np.zeros((len(matrix), len(names))) for matrix in (system.B, system.D))
    only = select(system, [f"{kind}.{names[column]}" for column in there], system.output_names)
    entering[:, there], direct[:, there] = only.B, only.D
    return entering, direct
