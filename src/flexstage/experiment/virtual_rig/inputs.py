"""Inputs of a virtual rig: the recorded quantity, and the signal it is taken from."""

from enum import Enum


class InputQuantity(Enum):
    """Physical quantity of the recorded inputs."""

    STROKE = "stroke"
    """Free stroke in um."""
    VOLTAGE = "voltage"
    """Voltage in V, counted from the bias."""
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
    """Signal that the recorded inputs are taken from."""

    MONITOR = "monitor"
    """Behind the amplifier and through the same filter as the gauges: amplifier and filter cancel in the frequency response."""
    COMMAND = "command"
    """Before the amplifier, not filtered: amplifier and filter are part of the frequency response."""
