"""Gauges: common properties, and displacement gauges (capacitive gap sensors)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.number import Number, magnitude
from flexstage.base.storage.digest import DOCUMENT_ONLY, Description
from flexstage.base.units.quantity import DISPLACEMENT, FREQUENCY, NOISE_DENSITY, NOT_NEGATIVE, POSITIVE, ROTATION, Quantity
from flexstage.parts.freedom import ROTATIONS, Freedom


class SensorSense(Enum):
    """Sense of a displacement sensor: its reading increases when the gap opens or when the gap closes."""

    OPENS = "opens"
    CLOSES = "closes"


class Instrument(Description):
    """Common properties of every `kind` of gauge; `parts.GAUGES` lists the kinds.

    A gauge measures one `freedom` of a body's motion relative to its base, in the gauge's frame: a displacement [m] or a rotation [rad]. A
    gauge with `gap` measures the gap to a target along x and requires a sense (opening or closing gap). A gauge with `inside` is on a link.
    `range` is the total measuring span, `resolution` the quantisation step [m, rad]. The amplitude density of white noise, `noise_density`
    [m/Hz^0.5, rad/Hz^0.5], and the `bandwidth` [Hz] are `None` if unknown.
    """

    kind: ClassVar[str]
    freedom: ClassVar[Freedom] = Freedom.X
    gap: ClassVar[bool] = False
    inside: ClassVar[bool] = False
    range: Number
    resolution: Number
    noise_density: Number | None
    bandwidth: Number | None

    @property
    def quantity(self) -> Quantity:
        """Measured quantity.

        >>> Gauge(range=500e-6).quantity.si
        'm'
        """
        return ROTATION if self.freedom in ROTATIONS else DISPLACEMENT


class DisplacementGauge(Instrument):
    """Common properties of gauges that measure the gap to a target along their x axis."""

    gap: ClassVar[bool] = True


@dataclass(frozen=True, eq=False)
class Gauge(DisplacementGauge):
    """Displacement gauge: change of the gap to a target along the gauge's x axis.

    `range` is the total measuring span [m], `resolution` the quantisation step [m], `noise_density` the amplitude density of white noise
    [m/Hz^0.5], and `bandwidth` the measurement bandwidth [Hz].
    """

    kind: ClassVar[str] = "gauge"
    range: Annotated[Number, DISPLACEMENT, POSITIVE]
    resolution: Annotated[Number, DISPLACEMENT, NOT_NEGATIVE] = 0.0
    noise_density: Annotated[Number, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    bandwidth: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)


@dataclass(frozen=True, eq=False)
class Combination(Instrument):
    """Single gauge that is equivalent to a weighted sum of gauges; `read` is the measured quantity."""

    kind: ClassVar[str] = "sum"
    read: Quantity
    range: Number
    resolution: Number
    noise_density: Number | None
    bandwidth: Number | None

    @property
    def quantity(self) -> Quantity:
        """Measured quantity."""
        return self.read


def combine_gauges(members: Sequence[tuple[Number, Instrument]]) -> Combination:
    """Combine weighted gauges with independent errors into a single gauge.

    For gauges with the weights w_i, ranges r_i, resolutions q_i and noise densities n_i, the range is sum |w_i| r_i, the resolution is sum
    |w_i| q_i (worst signs), and the noise density is (sum w_i^2 n_i^2)^(1/2), or `None` if any n_i is unknown. The bandwidth is the common
    bandwidth of the gauges, or `None` if bandwidths differ or are unknown.

    >>> pair = combine_gauges([(0.5, Gauge(range=1e-4, noise_density=3e-11)), (-0.5, Gauge(range=1e-4, noise_density=4e-11))])
    >>> round(1e6 * float(pair.range), 6), round(1e12 * float(pair.noise_density), 6)
    (100.0, 25.0)
    """
    densities = [weight * gauge.noise_density for weight, gauge in members if gauge.noise_density is not None]
    first, *rest = (gauge.bandwidth for _, gauge in members)
    alike = first is not None and all(other is not None and np.all(first == other) for other in rest)
    return Combination(
        members[0][1].quantity,
        range=sum(magnitude(weight) * gauge.range for weight, gauge in members),
        resolution=sum(magnitude(weight) * gauge.resolution for weight, gauge in members),
        noise_density=sum(density**2 for density in densities) ** 0.5 if len(densities) == len(members) else None,
        bandwidth=first if alike else None,
    )
