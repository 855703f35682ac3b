"""The linear parts of a machine as two matrices: one from readings to commands, one from a sample to the next."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from flexstage.base.number import Array
from flexstage.control.simulation.machine import Machine
from flexstage.control.systems.system import System


@dataclass(frozen=True, eq=False)
class Parts:
    """The matrices of plant and controller, by what goes in and out.

    Of the plant, with strokes f, disturbances w, readings y, motions m: x+ = A x + `stroke` f + `disturbed` w, y = `reading` x +
    `reading_w` w, m = `motion` x + `motion_f` f + `motion_w` w. Of the controller, with reference r, pose q, applied a:
    z+ = `controller` z + `from_reference` r + `from_pose` q + `from_applied` a, command = `command` z + `command_r` r + `command_q` q.
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
    """The matrices of a machine; the error is taken apart into reference less pose.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> found = parts(machine(example.plant, example.controller))
    >>> bool(np.all(found.from_reference == -found.from_pose))
    True
    """
    plant, controller = given.plant, given.controller
    others = tuple(channel.name for channel in given.disturbances)
    motions = tuple(channel.name for channel in given.motions)
    of_error, of_reference, of_pose = (
        _columns(controller, tuple(f"{kind}.{name}" for name in given.names)) for kind in ("error", "reference", "pose")
    )
    rows = [controller.output_names.index(name) for name in given.commands]
    return Parts(
        A=plant.A,
        stroke=_columns(plant, given.actuators)[0],
        disturbed=_columns(plant, others)[0],
        reading=plant.C[_rows(plant, given.readings)],
        reading_w=_columns(plant, others)[1][_rows(plant, given.readings)],
        motion=plant.C[_rows(plant, motions)],
        motion_f=_columns(plant, given.actuators)[1][_rows(plant, motions)],
        motion_w=_columns(plant, others)[1][_rows(plant, motions)],
        controller=controller.A,
        from_reference=of_error[0] + of_reference[0],
        from_pose=of_pose[0] - of_error[0],
        from_applied=_columns(controller, tuple(f"applied.{name}" for name in given.actuators))[0],
        command=controller.C[rows],
        command_r=(of_error[1] + of_reference[1])[rows],
        command_q=(of_pose[1] - of_error[1])[rows],
    )


def _columns(system: System, names: tuple[str, ...]) -> tuple[Array, Array]:
    """Columns of B and D, nought for inputs it does not have."""
    known = system.input_names
    found = [np.zeros((len(matrix), len(names))) for matrix in (system.B, system.D)]
    for column, name in enumerate(names):
        if name in known:
            found[0][:, column] = system.B[:, known.index(name)]
            found[1][:, column] = system.D[:, known.index(name)]
    return found[0], found[1]


def _rows(system: System, names: tuple[str, ...]) -> list[int]:
    return [system.output_names.index(name) for name in names]


@dataclass(frozen=True, eq=False)
class Row:
    """Where what stands in the row of numbers of a sample: first what the step before computed, then what this one adds."""

    reading: slice
    base: slice
    plant: slice
    controller: slice
    rounded: slice
    applied: slice
    stroke: slice
    command: slice
    asked: slice
    given: slice
    width: int

    @property
    def next_values(self) -> slice:
        """What the step before computes."""
        return slice(0, self.controller.stop)

    @property
    def bounded_states(self) -> slice:
        """What of it is bounded in a stable loop: all but readings, which may be lost."""
        return slice(self.base.start, self.controller.stop)

    @property
    def carried_over(self) -> slice:
        """What the next step is computed from."""
        return slice(self.plant.start, self.stroke.stop)


@dataclass(frozen=True, eq=False)
class Fused:
    """`step` takes a row's `carried_over` to the next row's `next_values`, `proportional` rounded readings to what they add to commands.

    Readings are counted in `scale` (g,), the gauges' resolution (1 m where they have none).
    """

    row: Row
    scale: Array
    step: Array
    proportional: Array


def fuse(given: Machine, linear: Parts) -> Fused:
    """A machine's linear parts, multiplied out: what is seen next is computed with the states.

    y+ = C x+ and command+ = C z+ take part as further rows, so that one product a sample does for all.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> known = machine(example.plant, example.controller)
    >>> found = fuse(known, parts(known))
    >>> found.step.shape == (found.row.next_values.stop, found.row.carried_over.stop - found.row.carried_over.start)
    True
    """
    row = _row(given, linear)
    scale = np.where(given.resolution > 0.0, given.resolution, 1.0)
    seen = given.pose * scale
    matrix = np.zeros((row.next_values.stop, row.width))
    matrix[row.plant, row.plant] = linear.A
    matrix[row.plant, row.stroke] = linear.stroke
    matrix[row.controller, row.controller] = linear.controller
    matrix[row.controller, row.rounded] = linear.from_pose @ seen
    matrix[row.controller, row.applied] = linear.from_applied
    matrix[row.reading] = linear.reading @ matrix[row.plant] / scale[:, None]
    matrix[row.base] = linear.command @ matrix[row.controller]
    return Fused(row, scale, np.ascontiguousarray(matrix[:, row.carried_over]), np.ascontiguousarray(linear.command_q @ seen))


def _row(given: Machine, linear: Parts) -> Row:
    gauges, actuators = len(given.gauges), len(given.actuators)
    sizes = (gauges, actuators, len(linear.A), len(linear.controller), gauges, actuators, *(actuators,) * 4)
    ends = np.cumsum((0, *sizes)).tolist()
    return Row(*(slice(start, stop) for start, stop in pairwise(ends)), width=ends[-1])
