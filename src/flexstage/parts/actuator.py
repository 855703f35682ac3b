"""Actuators: parts with an input, a stroke or a force between their two faces."""

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
    """Part with an input of the quantity `input`.

    A stroke actuator (`input` a displacement) has a `free_deformation` s per unit of stroke u and the force k (dx - s u). A force actuator
    (`input` a force or a current) exerts `wrench` per unit of input on its second face and the opposite on its first. All its degrees of
    freedom are free; its own stiffness is additional. Positive pushes the faces apart.
    """

    input: ClassVar[Quantity] = DISPLACEMENT

    @property
    def takes_stroke(self) -> bool:
        """Whether the input is a stroke; else a force, or a current."""
        return self.input is DISPLACEMENT

    @property
    def step(self) -> Number | None:
        """Least step of the input; 0: continuous, None: unspecified."""
        return 0.0

    @property
    def free_deformation(self) -> Array:
        """Free deformation (..., 6) of the second face against the first per unit of stroke, in the link's frame.

        Zero for a force actuator.
        """
        return np.zeros(6)

    @property
    def wrench(self) -> Array:
        """Wrench (..., 6) on the second face per unit of input, in the link's frame at its centre; zero for a stroke actuator."""
        return np.zeros(6)


@dataclass(frozen=True, eq=False)
class ForceLimit:
    """Limit of a force actuator's input: `held` is continuous, `short` in short use (None: unknown).

    `clips`: an instantaneous limit, unlike a thermal one.
    """

    name: str
    held: Number | None
    short: Number | None
    clips: bool = True


class ThrustActuator(Actuator):
    """Actuator with a force along x, positive pushing its faces apart, or a torque about x.

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
        """Cut-off frequency [Hz] between amplifier output and input; None: no lag."""
        return None

    def slew(self, limit: Number) -> Number | None:  # noqa: ARG002  (kinds that know one need it)
        """Mean slew rate of the input from zero to a `limit` [1/s]; None: no known limit."""
        return None

    def in_series(self, count: int) -> ThrustActuator:  # noqa: ARG002  (coils need it)
        """As many of them in one circuit, as their amplifier sees them; force or torque is that of one."""
        return self

    def loss(self, rms: Number) -> Number | None:  # noqa: ARG002  (kinds that know it need it)
        """Dissipated power [W] for an rms input; None: unknown."""
        return None

    def warming(self, rms: Number) -> Number | None:  # noqa: ARG002
        """Steady-state temperature rise for an rms input [K]; None: unknown."""
        return None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """All six."""
        return ALL

    @property
    def mirrored(self) -> ThrustActuator:
        """Itself, by symmetry."""
        return self

    @property
    def wrench(self) -> Array:
        """Thrust along x, or torque about x."""
        return np.asarray(self.thrust)[..., None] * np.eye(6)[self.axis]

    @property
    def limits(self) -> Iterator[ForceLimit]:
        """Limits of the input."""
        yield from ()


class StrokeActuator(Actuator):
    """Actuator with an imposed stroke; a kind specifies the full free `stroke` and the blocked force.

    Load limits are unknown unless a kind specifies them.
    """

    stroke: Number
    maximum_load: Number | None = None
    tensile_limit: Number | None = None
    preload: Number | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """No passive degree of freedom; the stroke moves."""
        return ()

    @property
    def free_deformation(self) -> Array:
        """Along x."""
        return np.eye(6)[0]

    @property
    def blocking_force(self) -> Number:
        """Blocked force at full stroke [N]."""
        raise NotImplementedError

    @property
    def below_rest(self) -> Number:
        """Share of the stroke below the rest position: half."""
        return 0.5

    @property
    def below_zero(self) -> Number:
        """Share of the stroke below zero voltage: none."""
        return 0.0


class ChargedActuator(StrokeActuator):
    """Piezo stroke actuator: a voltage from `voltage_low` to `voltage_high` controls the stroke; it rests at its `bias`."""

    voltage_low: Number | None
    voltage_high: Number | None
    bias: Number | None
    capacitance: Number | None

    @property
    def below_rest(self) -> Number:
        """Share of the stroke below the bias (default: half)."""
        if self.bias is None or self.voltage_low is None or self.voltage_high is None:
            return 0.5
        return (self.bias - self.voltage_low) / (self.voltage_high - self.voltage_low)

    @property
    def below_zero(self) -> Number:
        """Share of the stroke below zero voltage (negative: the range begins above it); zero without a range."""
        if self.voltage_low is None or self.voltage_high is None:
            return 0.0
        return -self.voltage_low / (self.voltage_high - self.voltage_low)

    @property
    def orders(self) -> Iterator[Order]:
        """Order: bias within the voltage range."""
        yield Order("voltage_low", self.voltage_low, self.voltage_high, "voltage_high", "Exchange them", VOLTAGE)
        advice = "Use a bias within the range of the stack"
        yield Order("bias", self.bias, self.voltage_high, "voltage_high", advice, VOLTAGE, strict=False)
