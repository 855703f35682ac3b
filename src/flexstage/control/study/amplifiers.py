"""Kinds of amplifiers that a set-up file may state. Other packages offer theirs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.finding import Finding
from flexstage.base.quantity import (
    CURRENT,
    CURRENT_NOISE,
    FREQUENCY,
    NOT_NEGATIVE,
    POSITIVE,
    RESISTANCE,
    SLEW,
    VOLTAGE_NOISE,
)
from flexstage.base.register import Register
from flexstage.control.electronics import AmplifierSettings

_MOST_BITS = 32


class AmplifierForm:
    """What every `kind` of amplifier has, a frozen dataclass whose fields are the keys of its table; `AMPLIFIERS` lists the kinds."""

    kind: ClassVar[str]

    @property
    def settings(self) -> AmplifierSettings:
        """What it is to the loop: bandwidth, limits, noise, converter."""
        raise NotImplementedError

    @property
    def faults(self) -> Iterator[Finding]:
        """What is wrong with it by itself, each with its key."""
        yield from ()


@dataclass(frozen=True)
class AmplifierSetup(AmplifierForm):
    """Amplifiers and their converter: first order on the stack's capacitance; absent all of this they are ideal.

    `bandwidth` as stated, or that of the output `resistance`, 1/(2 pi R C). `current` is the largest they give and `slew` their fastest
    change of voltage: they limit the rate of strokes. `noise` is white at their output, `bits` those of the converter over the full
    voltage. Voltages are turned into free strokes by each stack's range. Those of voice coils drive the current: `bandwidth`, `current`,
    `current_noise` and `bits` count.
    """

    kind: ClassVar[str] = "voltage"
    bandwidth: Annotated[float, FREQUENCY, POSITIVE] | None = None
    resistance: Annotated[float, RESISTANCE, POSITIVE] | None = None
    current: Annotated[float, CURRENT, POSITIVE] | None = None
    slew: Annotated[float, SLEW, POSITIVE] | None = None
    noise: Annotated[float, VOLTAGE_NOISE, NOT_NEGATIVE] | None = None
    bits: int | None = None
    current_noise: Annotated[float, CURRENT_NOISE, NOT_NEGATIVE] | None = None

    @property
    def settings(self) -> AmplifierSettings:
        """As stated."""
        return AmplifierSettings(
            bandwidth=self.bandwidth,
            resistance=self.resistance,
            current=self.current,
            slew=self.slew,
            noise_density=self.noise,
            bits=self.bits,
            current_noise=self.current_noise,
        )

    @property
    def faults(self) -> Iterator[Finding]:
        """A bandwidth and a resistance are two ways to say the same; converters have bits."""
        if self.bandwidth is not None and self.resistance is not None:
            yield Finding("amplifier", "both its bandwidth and its resistance are given", "Give one of them: the other follows")
        if self.bits is not None and not 1 <= self.bits <= _MOST_BITS:
            yield Finding("amplifier.bits", f"found {self.bits}", f"Give between 1 and {_MOST_BITS}")


AMPLIFIERS: Register[type[AmplifierForm]] = Register("flexstage.amplifiers", {AmplifierSetup.kind: AmplifierSetup})
"""Kinds of amplifiers by the `kind` of a set-up file; a table without one is that of voltage amplifiers."""
