"""Inputs of a virtual rig: the recorded quantity, and the signal it is taken from."""

from enum import Enum


class InputQuantity(Enum):
    """Physical quantity of the recorded inputs."""

    STROKE = "stroke"
    """Free stroke in um."""
    VOLTAGE = "voltage"
    """Voltage in V, counted from the bias."""


class InputSignal(Enum):
    """Signal that the recorded inputs are taken from."""

    MONITOR = "monitor"
    """Behind the amplifier and through the same filter as the gauges: amplifier and filter cancel in the frequency response."""
    COMMAND = "command"
    """Before the amplifier, not filtered: amplifier and filter are part of the frequency response."""
