"""Actuators: parts with an input, which is a stroke that they impose or a force that they exert between their two faces."""

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
    """A part with an input, of which `input` is the quantity.

    A stroke actuator (`input` a displacement) deforms freely by `free_deformation` per unit of stroke and resists all else: its force is
    k (dx - s u). A force actuator (`input` a force or a current) exerts `wrench` per unit of input on its second face and the opposite
    on its first, whatever their motion, and leaves all freedoms free; what stiffness it has of its own adds to that. Positive pushes
    the faces apart.
    """

    input: ClassVar[Quantity] = DISPLACEMENT

    @property
    def takes_stroke(self) -> bool:
        """Whether its input is a stroke; else it is a force, or what makes one."""
        return self.input is DISPLACEMENT

    @property
    def step(self) -> Number | None:
        """The least step of its input; 0: it follows continuously, None: it is not stated."""
        return 0.0

    @property
    def free_deformation(self) -> Array:
        """Deformation (..., 6) of the second face against the first per unit of stroke if nothing holds it, in the link's frame.

        Zero of a force actuator.
        """
        return np.zeros(6)

    @property
    def wrench(self) -> Array:
        """What the second face feels (..., 6) per unit of input, in the link's frame at its centre; zero of a stroke actuator."""
        return np.zeros(6)


@dataclass(frozen=True, eq=False)
class ForceLimit:
    """What bounds a force actuator's input, by `name`: the largest that it may be `held` for ever, and in `short` use (None: not known).

    `clips`: it cannot be passed for a moment, as heat can.
    """

    name: str
    held: Number | None
    short: Number | None
    clips: bool = True


class ThrustActuator(Actuator):
    """An actuator that exerts a force along x, positive pushing its faces apart, or a torque about x.

    `axis` is the place of its force or torque in its `wrench`.
    """

    axis: ClassVar[int] = 0
    travel: Number | None = None

    @property
    def thrust(self) -> Number:
        """Force along x or torque about x per unit of input: N/N, N/A or N m/A."""
        raise NotImplementedError

    @property
    def cutoff(self) -> Number | None:
        """Frequency [Hz] of the lag of its input behind what its amplifier imposes; None: there is none."""
        return None

    def slew(self, limit: Number) -> Number | None:  # noqa: ARG002  (kinds that know one need it)
        """How fast its input can rise from zero to a `limit`, in the mean [1/s]; None: no limit is known."""
        return None

    def in_series(self, count: int) -> ThrustActuator:  # noqa: ARG002  (coils need it)
        """As many of them in one circuit, as their amplifier sees them; force or torque is that of one."""
        return self

    def loss(self, rms: Number) -> Number | None:  # noqa: ARG002  (kinds that know it need it)
        """The power [W] that an input of this rms turns into heat; None: it is not known."""
        return None

    def warming(self, rms: Number) -> Number | None:  # noqa: ARG002
        """By how much an input of this rms, held for ever, warms it [K]; None: it is not known."""
        return None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """All six: it holds nothing."""
        return ALL

    @property
    def mirrored(self) -> ThrustActuator:
        """Itself: a line has no sides."""
        return self

    @property
    def wrench(self) -> Array:
        """Its thrust along x, or torque about x."""
        return np.asarray(self.thrust)[..., None] * np.eye(6)[self.axis]

    @property
    def limits(self) -> Iterator[ForceLimit]:
        """What bounds its input."""
        yield from ()


class StrokeActuator(Actuator):
    """An actuator that imposes a stroke; a kind states the full free `stroke` and what its force is as it is blocked.

    What it bears is not known where a kind does not state it.
    """

    stroke: Number
    maximum_load: Number | None = None
    tensile_limit: Number | None = None
    preload: Number | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """No passive freedom: what moves is its stroke."""
        return ()

    @property
    def free_deformation(self) -> Array:
        """Along x."""
        return np.eye(6)[0]

    @property
    def blocking_force(self) -> Number:
        """Force of the fully driven actuator held at its length [N]."""
        raise NotImplementedError

    @property
    def below_rest(self) -> Number:
        """The share of its stroke that lies below where it rests: half."""
        return 0.5

    @property
    def below_zero(self) -> Number:
        """The share of its stroke that lies below where it is without volts: none."""
        return 0.0


class ChargedActuator(StrokeActuator):
    """A stroke actuator of piezo ceramic: volts between `voltage_low` and `voltage_high` give the stroke; it rests at its `bias`."""

    voltage_low: Number | None
    voltage_high: Number | None
    bias: Number | None
    capacitance: Number | None

    @property
    def below_rest(self) -> Number:
        """The share of its stroke below its bias; half where none is stated."""
        if self.bias is None or self.voltage_low is None or self.voltage_high is None:
            return 0.5
        return (self.bias - self.voltage_low) / (self.voltage_high - self.voltage_low)

    @property
    def below_zero(self) -> Number:
        """The share of its stroke below no voltage (negative: the range begins above it); none where no range is stated."""
        if self.voltage_low is None or self.voltage_high is None:
            return 0.0
        return -self.voltage_low / (self.voltage_high - self.voltage_low)

    @property
    def orders(self) -> Iterator[Order]:
        """Its bias is within its voltages."""
        yield Order("voltage_low", self.voltage_low, self.voltage_high, "voltage_high", "Exchange them", VOLTAGE)
        advice = "Give a bias within the range of the stack"
        yield Order("bias", self.bias, self.voltage_high, "voltage_high", advice, VOLTAGE, strict=False)
