"""Physical quantities: metadata that give the dimension, SI unit and display unit of a field.

A description field is written `thickness: Annotated[Number, LENGTH, POSITIVE]`. File parsing, JSON Schema, tables and sign checks use this
metadata.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Quantity:
    """Physical quantity: name, coherent SI unit and display unit.

    `example` is an example for a design file. `also` lists equivalent units of another form (m/(N m) for rad/N).
    """

    name: str
    si: str
    shown: str
    example: str
    also: tuple[str, ...] = ()

    @property
    def noun(self) -> str:
        """Name of the quantity, with an article.

        >>> ANGLE.noun, LENGTH.noun
        ('an angle', 'a length')
        """
        return f"{'an' if self.name[0] in 'aeiou' else 'a'} {self.name}"


@dataclass(frozen=True)
class Bound:
    """Interval of a number from `low` to `high`. With `open_low` or `open_high`, the limit itself is excluded."""

    low: float = float("-inf")
    high: float = float("inf")
    open_low: bool = False
    open_high: bool = False

    def text(self) -> str:
        """Return the interval in words.

        >>> POSITIVE.text()
        'greater than 0'
        """
        words: list[str] = []
        if self.low != float("-inf"):
            words.append(f"{'greater than' if self.open_low else 'at least'} {self.low:g}")
        if self.high != float("inf"):
            words.append(f"{'less than' if self.open_high else 'at most'} {self.high:g}")
        return " and ".join(words)

    def whole(self) -> str:
        """Return the interval in words, for whole numbers.

        >>> Bound(low=2.0).whole(), Bound(low=2.0, high=9.0).whole()
        ('2 or more', '2 to 9')
        """
        return f"{self.low:g} or more" if self.high == float("inf") else f"{self.low:g} to {self.high:g}"


POSITIVE = Bound(low=0.0, open_low=True)
NOT_NEGATIVE = Bound(low=0.0)
POISSON_RANGE = Bound(low=-1.0, high=0.5, open_low=True, open_high=True)

RATIO = Quantity("ratio", "1", "1", "0.3")
SHARE = Quantity("share", "1", "%", "30 %")
LENGTH = Quantity("length", "m", "mm", "2 mm")
DISPLACEMENT = Quantity("displacement", "m", "um", "150 um")
ANGLE = Quantity("angle", "rad", "deg", "30 deg")
ROTATION = Quantity("rotation", "rad", "urad", "100 urad")
MASS = Quantity("mass", "kg", "kg", "2 kg")
INERTIA = Quantity("moment of inertia", "kg m^2", "kg m^2", "0.13 kg m^2")
DENSITY = Quantity("density", "kg/m^3", "kg/m^3", "7750 kg/m^3")
PRESSURE = Quantity("stress", "Pa", "MPa", "1360 MPa")
MODULUS = Quantity("modulus", "Pa", "GPa", "200 GPa")
FORCE = Quantity("force", "N", "N", "5000 N")
MOMENT = Quantity("moment", "N m", "N m", "1 N m")
STIFFNESS = Quantity("stiffness", "N/m", "N/um", "17 N/um")
ROTATIONAL_STIFFNESS = Quantity("rotational stiffness", "N m/rad", "N m/rad", "217 N m/rad")
COUPLING_STIFFNESS = Quantity("coupling stiffness", "N/rad", "N/rad", "12 N/rad", also=("N m/m",))
BENDING_RIGIDITY = Quantity("bending rigidity", "N m^2", "N m^2", "180 N m^2")
EXPANSION = Quantity("thermal expansion", "1/K", "1/K", "10.3e-6 1/K")
CURVATURE = Quantity("curvature", "1/m", "1/m", "2 1/m")
TEMPERATURE = Quantity("temperature difference", "K", "K", "0.1 K")
FREQUENCY = Quantity("frequency", "Hz", "Hz", "4 kHz")
VOLTAGE = Quantity("voltage", "V", "V", "1000 V")
PIEZO_GAIN = Quantity("stroke per volt", "m/V", "nm/V", "150 nm/V")
CAPACITANCE = Quantity("capacitance", "F", "uF", "0.5 uF")
RESISTANCE = Quantity("resistance", "ohm", "ohm", "50 ohm")
CURRENT = Quantity("current", "A", "A", "0.2 A")
INDUCTANCE = Quantity("inductance", "H", "mH", "2 mH")
POWER = Quantity("power", "W", "W", "5 W")
FORCE_CONSTANT = Quantity("force constant", "N/A", "N/A", "20 N/A")
TORQUE_CONSTANT = Quantity("torque constant", "N m/A", "N m/A", "0.2 N m/A")
THERMAL_RESISTANCE = Quantity("thermal resistance", "K/W", "K/W", "4 K/W")
VISCOUS_DAMPING = Quantity("viscous damping", "N s/m", "N s/m", "2 N s/m")
ROTATIONAL_DAMPING = Quantity("rotational damping", "N m s/rad", "N m s/rad", "0.02 N m s/rad")
NOISE_DENSITY = Quantity("noise density", "m/Hz^0.5", "nm/Hz^0.5", "0.05 nm/Hz^0.5")
ROTATION_NOISE = Quantity("angular noise density", "rad/Hz^0.5", "nrad/Hz^0.5", "5 nrad/Hz^0.5")
VOLTAGE_NOISE = Quantity("voltage noise density", "V/Hz^0.5", "uV/Hz^0.5", "2 uV/Hz^0.5")
CURRENT_NOISE = Quantity("current noise density", "A/Hz^0.5", "uA/Hz^0.5", "1 uA/Hz^0.5")
FORCE_NOISE = Quantity("force noise density", "N/Hz^0.5", "mN/Hz^0.5", "1 mN/Hz^0.5")
ACCELERATION_NOISE = Quantity("acceleration density", "m/s^2/Hz^0.5", "um/s^2/Hz^0.5", "3 um/s^2/Hz^0.5")
VELOCITY_NOISE = Quantity("velocity density", "m/s/Hz^0.5", "um/s/Hz^0.5", "0.5 um/s/Hz^0.5")
SPEED = Quantity("speed", "m/s", "mm/s", "2 mm/s")
SLEW = Quantity("slew rate", "V/s", "V/ms", "100 V/ms")
ACCELERATION = Quantity("acceleration", "m/s^2", "m/s^2", "9.80665 m/s^2")
JERK = Quantity("jerk", "m/s^3", "m/s^3", "2 m/s^3")
TIME = Quantity("time", "s", "s", "0.1 s")
SHORT_TIME = Quantity("short time", "s", "ms", "5 ms")
RATE = Quantity("rate", "1/s", "1/s", "0.5 1/s")
COMPLIANCE = Quantity("compliance", "m/N", "um/N", "2.91 um/N")
COUPLING = Quantity("coupling compliance", "rad/N", "urad/N", "4.59 urad/N", also=("m/(N m)",))
ROTATIONAL_COMPLIANCE = Quantity("rotational compliance", "rad/(N m)", "urad/(N m)", "4590 urad/(N m)")

DIRECTION = Quantity("direction", "1", "1", "x")
"""Direction vector of any length: three numbers without unit, or `"x"`, `"-y"`, ... in a file."""

DIRECTIONS: Mapping[str, tuple[float, float, float]] = {
    "x": (1.0, 0.0, 0.0),
    "-x": (-1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-z": (0.0, 0.0, -1.0),
}
"""Named directions in files."""

COMPLIANCE_MATRIX = Quantity("compliance matrix", "mixed", "mixed", "2.91 um/N")
"""Quantity of a 6x6 matrix with blocks `COMPLIANCE`, `COUPLING` and `ROTATIONAL_COMPLIANCE`."""

ANY = Quantity("number", "mixed", "mixed", "26 mm")
"""Quantity of a number whose actual quantity is specified in another field."""

STIFFNESS_MATRIX = Quantity("stiffness matrix", "mixed", "mixed", "17 N/um")
"""Quantity of a 6x6 matrix with blocks `STIFFNESS`, `COUPLING_STIFFNESS` and `ROTATIONAL_STIFFNESS`."""
