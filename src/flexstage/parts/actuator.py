"""Actuators: parts whose input is a stroke, a force or a current between their two faces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.base.units.quantity import DISPLACEMENT, VOLTAGE, Quantity
from flexstage.parts.freedom import ALL, Freedom
from flexstage.parts.shape import Elastic, Order


class Actuator(Elastic):
    """Part with an `input` of a physical quantity.

    A stroke actuator (`input` is a displacement) has a free deformation s per unit of stroke u. The force of a stroke actuator with the
    stiffness k is k (dx - s u) for a relative displacement dx of its faces. The `input` of a force actuator is a force or a current. The
    actuator exerts `wrench` per unit of input on its second face, and the opposite wrench on its first face. A force actuator leaves all
    degrees of freedom free; a specified stiffness acts in addition to the force. A positive input pushes the faces apart.
    """

    input: ClassVar[Quantity] = DISPLACEMENT

    @property
    def takes_stroke(self) -> bool:
        """Whether the input is a stroke; otherwise the input is a force or a current."""
        return self.input is DISPLACEMENT

    @property
    def step(self) -> Number | None:
        """Smallest step of the input; 0 for a continuous input, None if unspecified."""
        return 0.0

    @property
    def free_deformation(self) -> Array:
        """Free deformation (..., 6) of the second face relative to the first, per unit of stroke, in the link's frame.

        The free deformation of a force actuator is zero.
        """
        return np.zeros(6)

    @property
    def wrench(self) -> Array:
        """Wrench (..., 6) on the second face per unit of input, at the link's centre in the link's frame; zero for a stroke actuator."""
        return np.zeros(6)


@dataclass(frozen=True, eq=False)
class ForceLimit:
    """Limit of a force actuator's input: `held` is the continuous limit, `short` the short-time limit (None: unknown).

    If `clips`, the limit cuts off the input immediately (saturation), unlike a thermal limit.
    """

    name: str
    held: Number | None
    short: Number | None
    clips: bool = True


class ThrustActuator(Actuator):
    """Actuator with a force along x or a torque about x. A positive force pushes the actuator's faces apart.

    `axis` is the index of the force or torque in the wrench: 0 or 3.
    """

    axis: ClassVar[int] = 0
    travel: Number | None = None

    @property
    def thrust(self) -> Number:
        """Force along x or torque about x per unit of input: N/N, N/A or N m/A."""
        raise NotImplementedError

    @property
    def cutoff(self) -> Number | None:
        """Cut-off frequency [Hz] of the lag from the amplifier's output to the actuator's input; None: no lag."""
        return None

    def slew(self, limit: Number) -> Number | None:  # noqa: ARG002  (kinds that know one need it)
        """Return the mean rate [input unit/s] at which the input can rise from zero to `limit`; None if the rate is unknown."""
        return None

    def in_series(self, count: int) -> ThrustActuator:  # noqa: ARG002  (coils need it)
        """Return an actuator with the electrical load of `count` equal actuators in one circuit, but the force or torque of one of them."""
        return self

    def loss(self, rms: Number) -> Number | None:  # noqa: ARG002  (kinds that know it need it)
        """Return the dissipated power [W] for an rms input; None if unknown."""
        return None

    def warming(self, rms: Number) -> Number | None:  # noqa: ARG002
        """Return the steady-state temperature rise [K] for an rms input; None if unknown."""
        return None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom: all six."""
        return ALL

    @property
    def mirrored(self) -> ThrustActuator:
        """The actuator itself, by symmetry."""
        return self

    @property
    def wrench(self) -> Array:
        """Wrench (..., 6) per unit of input: a force along x, or a torque about x."""
        return np.asarray(self.thrust)[..., None] * np.eye(6)[self.axis]

    @property
    def limits(self) -> Iterator[ForceLimit]:
        """Limits of the input."""
        yield from ()


class StrokeActuator(Actuator):
    """Actuator with an imposed stroke. Each kind specifies the full free `stroke` and the blocked force.

    The load limits are unknown, unless a kind specifies them.
    """

    stroke: Number
    maximum_load: Number | None = None
    tensile_limit: Number | None = None
    preload: Number | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom: none, because only the stroke moves the faces."""
        return ()

    @property
    def free_deformation(self) -> Array:
        """Free deformation (6,) per unit of stroke: along x."""
        return np.eye(6)[0]

    @property
    def blocking_force(self) -> Number:
        """Blocked force at the full free stroke [N]."""
        raise NotImplementedError

    @property
    def below_rest(self) -> Number:
        """Fraction of the stroke below the rest position: one half."""
        return 0.5

    @property
    def below_zero(self) -> Number:
        """Fraction of the stroke at negative voltages: zero by default."""
        return 0.0


class ChargedActuator(StrokeActuator):
    """Piezo stroke actuator: a voltage from `voltage_low` to `voltage_high` controls the stroke; the rest position is at the `bias`."""

    voltage_low: Number | None
    voltage_high: Number | None
    bias: Number | None
    capacitance: Number | None

    @property
    def below_rest(self) -> Number:
        """Fraction of the stroke below the bias voltage (default: half)."""
        if self.bias is None or self.voltage_low is None or self.voltage_high is None:
            return 0.5
        return (self.bias - self.voltage_low) / (self.voltage_high - self.voltage_low)

    @property
    def below_zero(self) -> Number:
        """Fraction of the stroke at negative voltages; zero without a voltage range.

        The fraction is negative if the voltage range begins above zero.
        """
        if self.voltage_low is None or self.voltage_high is None:
            return 0.0
        return -self.voltage_low / (self.voltage_high - self.voltage_low)

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the lowest voltage is below the highest voltage, and the bias is between them."""
        yield Order("voltage_low", self.voltage_low, self.voltage_high, "voltage_high", "Exchange both values", VOLTAGE)
        advice = "Use a bias within the range of the stack"
        yield Order("bias", self.bias, self.voltage_high, "voltage_high", advice, VOLTAGE, strict=False)
        yield Order("voltage_low", self.voltage_low, self.bias, "the bias", advice, VOLTAGE, strict=False)
