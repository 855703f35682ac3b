"""The plant between the controller's commands and the pose estimated from the gauges."""

from __future__ import annotations

from dataclasses import replace

from flexstage.control.plant_models.plants import Plant, zero_order_hold
from flexstage.control.systems.system import System, reachable, select


def pose_plant(plant: Plant, offset: float = 0.0) -> System:
    """Return the plant from `command.<actuator>` [m] to `pose.<c>` [m, rad]: stage, amplifiers, gauges, hold and delay.

    The plant of a continuous loop is continuous. A relative `offset` raises all modal frequencies by scaling time, so that lags become
    shorter too. Hold and delay of a sampled plant are unchanged.

    >>> from flexstage.control.example import integral_loop
    >>> found = pose_plant(integral_loop().plant)
    >>> found.input_names, found.output_names, found.step
    (('command.B',), ('pose.x',), 0.0001)
    """
    given, faster = plant.hardware, 1.0 + offset
    if given.rate is not None:
        plant = replace(plant, hardware=replace(given, rate=given.rate / faster, delay=given.delay * faster))
        faster = 1.0
    whole = reachable(select(zero_order_hold(plant), plant.actuators, [f"gap.{name}" for name in plant.gauges]))
    pose, inputs = plant.coordinates.pose, plant.coordinates.commands("command.")
    matrices = {"A": whole.A * faster, "B": whole.B * faster, "C": pose @ whole.C, "D": pose @ whole.D}
    return replace(whole, **matrices, inputs=inputs, outputs=plant.coordinates.motions("pose."), step=given.step)
