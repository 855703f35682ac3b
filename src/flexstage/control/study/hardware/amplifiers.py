"""Voltage and charge amplifiers of a set-up file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, TypeAlias

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding
from flexstage.base.units.quantity import (
    CURRENT,
    CURRENT_NOISE,
    FREQUENCY,
    NOT_NEGATIVE,
    POSITIVE,
    RATIO,
    RESISTANCE,
    SLEW,
    VOLTAGE_NOISE,
    Bound,
)
from flexstage.control.plant_models.electronics import AmplifierSettings, ChargeHold

Frequency: TypeAlias = Annotated[float, FREQUENCY, POSITIVE]
_COUPLED, _LEFT = Bound(low=0.0, high=1.0, open_high=True), Bound(low=0.0, high=1.0)


class AmplifierForm(CheckedFields):
    """Interface of an amplifier kind: a frozen dataclass, with the keys of its table as fields (see `amplifier_kinds`)."""

    kind: ClassVar[str]

    @property
    def settings(self) -> AmplifierSettings:
        """Amplifier settings of the loop: bandwidth, limits, noise, converter."""
        raise NotImplementedError

    @property
    def faults(self) -> Iterator[Finding]:
        """Findings on the amplifier's table that do not depend on the stage; each finding names its key."""
        yield from ()


@dataclass(frozen=True)
class AmplifierSetup(AmplifierForm):
    """Amplifiers with a digital-to-analogue converter and a first-order lag; ideal by default.

    The corner of the lag is `bandwidth`, or 1/(2 pi R C) with the output `resistance` R and the stack's capacitance C. `current` is the
    maximum output current and `slew` the maximum voltage rate; both limit the stroke rate. `noise` is the density of white noise at the
    output. `bits` is the resolution of the converter for the full voltage range. The voltage range and the stroke of each stack determine
    the free stroke per volt. Voice coil amplifiers control the current: only `bandwidth`, `current`, `current_noise` and `bits` apply.
    """

    kind: ClassVar[str] = "voltage"
    bandwidth: Frequency | None = None
    resistance: Annotated[float, RESISTANCE, POSITIVE] | None = None
    current: Annotated[float, CURRENT, POSITIVE] | None = None
    slew: Annotated[float, SLEW, POSITIVE] | None = None
    noise: Annotated[float, VOLTAGE_NOISE, NOT_NEGATIVE] | None = None
    bits: Annotated[int, Bound(low=1.0, high=32.0)] | None = None
    current_noise: Annotated[float, CURRENT_NOISE, NOT_NEGATIVE] | None = None

    @property
    def settings(self) -> AmplifierSettings:
        """Convert to amplifier settings."""
        named = {name: getattr(self, name) for name in ("bandwidth", "resistance", "current", "slew", "bits", "current_noise")}
        return AmplifierSettings(noise_density=self.noise, **named)

    @property
    def faults(self) -> Iterator[Finding]:
        """Check that bandwidth and resistance are not both specified."""
        if self.bandwidth is not None and self.resistance is not None:
            yield Finding(
                "amplifier",
                "bandwidth and resistance are both specified",
                "Remove bandwidth or resistance: the resistance determines the bandwidth",
            )


@dataclass(frozen=True)
class ChargeSetup(AmplifierSetup):
    """Charge amplifiers for stacks. They have the keys of voltage amplifiers (`AmplifierSetup`), and further keys.

    A voltage in a key of `AmplifierSetup` stands for a charge: the charge of an unloaded stack at this voltage.

    `coupling` is the electromechanical coupling k of the stack, at most the coupling k33 of its ceramic (0.7 for soft PZT). At constant
    charge the stack is stiffer by the factor 1/(1 - k^2). Below the frequency `corner`, the drive acts as a voltage drive. With a `leakage`
    resistance R parallel to the stack's capacitance C, the corner is 1/(2 pi R C). `residual_hysteresis` is the fraction of hysteresis and
    creep that remains above the corner. The default is one fifth (Ge & Jouaneh, IEEE Transactions on Control Systems Technology 4 (1996)
    209, cited by Fleming & Leang, Design, Modeling and Control of Nanopositioning Systems, 2014, chapter 12).
    """

    kind: ClassVar[str] = "charge"
    coupling: Annotated[float, RATIO, _COUPLED] | None = None
    corner: Frequency | None = None
    leakage: Annotated[float, RESISTANCE, POSITIVE] | None = None
    residual_hysteresis: Annotated[float, RATIO, _LEFT] = 0.2

    @property
    def settings(self) -> AmplifierSettings:
        """Convert to amplifier settings, with charge drive."""
        held = ChargeHold(self.coupling or 0.0, self.residual_hysteresis, self.corner, self.leakage)
        return replace(super().settings, charge=held)

    @property
    def faults(self) -> Iterator[Finding]:
        """Check the data of the voltage amplifier, the presence of the coupling, and that either corner or leakage is specified."""
        yield from super().faults
        if self.coupling is None:
            advice = "Use e.g. coupling = 0.7. An estimate from stroke per volt, stiffness and capacitance is too large"
            yield Finding("amplifier.coupling", "charge drive needs the electromechanical coupling of the stack", advice)
        if (self.corner is None) == (self.leakage is None):
            given = "are both specified" if self.corner is not None else "are both missing"
            advice = 'Specify corner or leakage, e.g. corner = "0.1 Hz": every charge drive has leakage'
            yield Finding("amplifier", f"corner and leakage {given}", advice)
