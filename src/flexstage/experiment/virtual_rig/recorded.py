"""What a virtual rig records of its inputs."""

from enum import Enum


class Recorded(Enum):
    """What the recorded inputs are numbers of."""

    STROKE = "stroke"
    """Free stroke in um."""
    VOLTAGE = "voltage"
    """Voltage in V, counted from the bias."""


class Tap(Enum):
    """Where the recorded inputs are taken from."""

    MONITOR = "monitor"
    """Behind the amplifier and through the same filter as the gauges: amplifier and filter cancel in the frequency response."""
    COMMAND = "command"
    """Before the amplifier, not filtered: amplifier and filter are part of the frequency response."""
