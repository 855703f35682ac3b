"""Recorded inputs of a virtual rig: quantity and signal."""

from enum import Enum


class InputQuantity(Enum):
    """Physical quantity of the recorded inputs."""

    STROKE = "stroke"
    """Free stroke in um."""
    VOLTAGE = "voltage"
    """Voltage in V, relative to the bias."""
    CURRENT = "current"
    """Current of a coil in A."""
    FORCE = "force"
    """Force in N."""
    TORQUE = "torque"
    """Torque in N m."""


RECORDED_UNITS = {
    InputQuantity.STROKE: "um",
    InputQuantity.VOLTAGE: "V",
    InputQuantity.CURRENT: "A",
    InputQuantity.FORCE: "N",
    InputQuantity.TORQUE: "N m",
}
"""Unit of the recorded inputs by quantity."""
OWN_QUANTITIES = {"m": InputQuantity.STROKE, "A": InputQuantity.CURRENT, "N": InputQuantity.FORCE}
"""Quantity of an actuator's input by its SI unit."""


class InputSignal(Enum):
    """Source signal of the recorded inputs."""

    MONITOR = "monitor"
    """Amplifier output, through the gauges' filter: amplifier and filter cancel in the frequency response."""
    COMMAND = "command"
    """Amplifier input, not filtered: amplifier and filter are part of the frequency response."""
