"""The plant as a controller sees it: from its commands to the pose that the gauges tell."""

from __future__ import annotations

from dataclasses import replace

from flexstage.control.plant_models.plants import Plant, zero_order_hold
from flexstage.control.systems.system import System, reachable, select


def pose_plant(plant: Plant) -> System:
    """From `command.<actuator>` [m] to `pose.<c>` [m, rad]: stage, amplifiers, gauges, hold and delay; continuous where the loop is.

    >>> from flexstage.control.example import integral_loop
    >>> found = pose_plant(integral_loop().plant)
    >>> found.input_names, found.output_names, found.step
    (('command.B',), ('pose.x',), 0.0001)
    """
    whole = reachable(select(zero_order_hold(plant), plant.actuators, [f"gap.{name}" for name in plant.gauges]))
    pose = plant.coordinates.pose
    commands = plant.coordinates.commands("command.")
    return replace(whole, C=pose @ whole.C, D=pose @ whole.D, inputs=commands, outputs=plant.coordinates.motions("pose."))
