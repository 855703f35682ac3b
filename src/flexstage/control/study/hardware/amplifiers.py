"""Voltage and charge amplifiers as a set-up file states them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

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

_COUPLED, _LEFT = Bound(low=0.0, high=1.0, open_high=True), Bound(low=0.0, high=1.0)


class AmplifierForm(CheckedFields):
    """What every `kind` of amplifier has, a frozen dataclass whose fields are the keys of its table; `amplifier_kinds` lists them."""

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
    bits: Annotated[int, Bound(low=1.0, high=32.0)] | None = None
    current_noise: Annotated[float, CURRENT_NOISE, NOT_NEGATIVE] | None = None

    @property
    def settings(self) -> AmplifierSettings:
        """As stated."""
        named = {name: getattr(self, name) for name in ("bandwidth", "resistance", "current", "slew", "bits", "current_noise")}
        return AmplifierSettings(noise_density=self.noise, **named)

    @property
    def faults(self) -> Iterator[Finding]:
        """A bandwidth and a resistance are two ways to say the same; converters have bits."""
        if self.bandwidth is not None and self.resistance is not None:
            yield Finding("amplifier", "both its bandwidth and its resistance are given", "Give one of them: the other follows")


@dataclass(frozen=True)
class ChargeSetup(AmplifierSetup):
    """Amplifiers that hold the charge of stacks: what voltage amplifiers have, counted in the volts that a stack free of load would have.

    `coupling` is k of the stack (k33 of its ceramic at most, 0.7 of soft PZT): at constant charge it is stiffer by 1/(1 - k^2). Below the
    `corner`, stated or that of the `leakage` resistance beside the stack, 1/(2 pi R C), the drive is one of volts. `residual_hysteresis` is
    the share of hysteresis and creep that the stroke keeps above it: one fifth (Ge & Jouaneh, IEEE Trans. Control Syst. Technol. 4 (1996)
    209, by Fleming & Leang, Design, Modeling and Control of Nanopositioning Systems, 2014, ch. 12).
    """

    kind: ClassVar[str] = "charge"
    coupling: Annotated[float, RATIO, _COUPLED] | None = None
    corner: Annotated[float, FREQUENCY, POSITIVE] | None = None
    leakage: Annotated[float, RESISTANCE, POSITIVE] | None = None
    residual_hysteresis: Annotated[float, RATIO, _LEFT] = 0.2

    @property
    def settings(self) -> AmplifierSettings:
        """As stated, charge held."""
        held = ChargeHold(self.coupling or 0.0, self.residual_hysteresis, self.corner, self.leakage)
        return replace(super().settings, charge=held)

    @property
    def faults(self) -> Iterator[Finding]:
        """No coupling, no corner, or two of them, besides what voltage amplifiers may have wrong."""
        yield from super().faults
        if self.coupling is None:
            advice = "Use e.g. coupling = 0.7: by strokes and capacitances of data sheets, d^2 k / C, it comes out too high"
            yield Finding("amplifier.coupling", "charge is held, and how far the stack couples it to its length is not stated", advice)
        if (self.corner is None) == (self.leakage is None):
            given = "are both given" if self.corner is not None else "are both missing"
            advice = 'Give one of them: no drive holds charge for ever. Use e.g. corner = "0.1 Hz"'
            yield Finding("amplifier", f"its corner and its leakage {given}", advice)
