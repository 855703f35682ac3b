"""Charge drive of piezo stacks: higher stiffness than at constant voltage, above the leakage corner frequency."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.number import Array
from flexstage.base.record import INNER, Along, Heading, Layout
from flexstage.base.units.quantity import FREQUENCY, SHARE
from flexstage.control.damping.damped_plant import around_legs
from flexstage.control.damping.legs import Leg, pair_modes
from flexstage.control.plant_models.electronics import ChargeDrive
from flexstage.control.plant_models.plants import Plant
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel, LinearModel


@dataclass(frozen=True, eq=False)
class ChargedStacks:
    """Stacks of `actuators` at constant charge: above the corner frequency they are stiffer than at constant voltage.

    `stiffer` (n,) is the stiffness at constant charge divided by the stiffness at constant voltage: 1/(1 - k^2), with the electromechanical
    coupling factor k of a stack. Below the corner frequencies `corners` (n,) [Hz], the drive acts as a voltage drive. Above the corner
    frequencies, the fractions `residual_hysteresis` (n,) of hysteresis and creep remain. `by_volts` (m,) and `by_charge` (m,) [Hz] are the
    plant's modal frequencies at constant voltage and at constant charge.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Charge drive",
        "stiffer corners residual_hysteresis",
        notes=("Above the corner frequency, a stack with the coupling factor k is 1/(1 - k^2) times as stiff as at constant voltage.",),
    )

    actuators: tuple[str, ...]
    stiffer: Annotated[Array, Along("actuators"), Heading("stiffness ratio", digits=4)]
    corners: Annotated[Array, FREQUENCY, Along("actuators"), Heading("corner frequency", digits=4)]
    residual_hysteresis: Annotated[Array, SHARE, Along("actuators"), Heading("residual hysteresis", digits=3)]
    by_volts: Annotated[Array, FREQUENCY, Heading("mode, voltage drive", digits=4)]
    by_charge: Annotated[Array, FREQUENCY, Heading("mode, charge drive", digits=4)]

    @property
    def rise(self) -> Annotated[Array, INNER, Heading("change", digits=3, unit="%")]:
        """Relative change (m,) of the modal frequencies, from constant voltage to constant charge."""
        return self.by_charge / self.by_volts - 1.0


def at_constant_charge(model: LinearModel, legs: tuple[Leg, ...], drives: Mapping[str, ChargeDrive]) -> LinearModel:
    """Return the model with the stacks of `legs` at constant charge, which increases their stiffness.

    A stack with elongation u, tension F, voltage V and charge Q has the stiffness k at constant voltage, the free stroke d per volt, and
    the capacitance C without load: u = F/k + d V and Q = d F + C V (Preumont, Vibration Control of Active Structures, 2018, ch. 4).
    Elimination of V gives u = (1 - kappa^2) F/k + (d/C) Q, with the coupling factor kappa, kappa^2 = d^2 k / C. The stiffness at constant
    charge is therefore k / (1 - kappa^2). The free stroke (d/C) Q equals d V for the voltage V that charges the unloaded stack to Q.
    """
    stiffness, output, through = dict(model.stiffness), np.array(model.output, dtype=float), np.array(model.feedthrough, dtype=float)
    for each in legs:
        part = stiffness[each.link]
        law = np.array(part.law, dtype=float)
        added = np.zeros(law.shape[-1])
        added[0] = law[0, 0] * (drives[each.actuator].stiffening - 1.0)
        law[0, 0] += added[0]
        stiffness[each.link] = replace(part, law=law)
        row = model.output_index((f"{each.link}.fx",))[0]
        output[row] += added @ np.asarray(part.operator)
        through[row] -= added @ np.asarray(model.imposed[each.link])
    return replace(model, stiffness=stiffness, output=output, feedthrough=through)


def leak_charge(given: Plant, legs: tuple[Leg, ...], drives: Mapping[str, ChargeDrive], kept: tuple[str, ...] = ()) -> Plant:
    """Add charge leakage to a plant with stacks at constant charge: below a corner frequency, they behave as at constant voltage.

    The result is exact at every frequency. Symbols are those of `at_constant_charge`. The drive imposes the current (s C + 1/R) v that a
    voltage v would cause in the unloaded stack with the leakage resistance R (Fleming & Leang, Design, Modeling and Control of
    Nanopositioning Systems, 2014, ch. 12). With the corner w_0 = 1/(R C), the elongation is u = (1 - kappa^2 s/(s + w_0)) F/k + d v. This
    is the elongation at constant charge plus kappa^2 (w_0/(s + w_0)) (F/k). `legs` have the stiffness k at constant voltage. The result
    has only the link forces named in `kept`.
    """
    inner = [_leak(each, drives[each.actuator]) for each in legs]
    gone = {f"{each.link}.fx" for each in legs} - {f"{name}.fx" for name in kept}
    return replace(
        given,
        system=around_legs(given, legs, inner, [name for name in given.system.output_names if name not in gone]),
        states=(*given.states, *(f"charge.{each.actuator}" for each in legs)),
        note=f"{given.note}; stacks of {', '.join(each.actuator for each in legs)} at constant charge above the leakage corner",
    )


def _leak(leg: Leg, drive: ChargeDrive) -> System:
    """Leakage: from tension [N] to added stroke [m], kappa^2 w_0 / (s + w_0) / k."""
    rate = 2.0 * np.pi * drive.corner
    gain = np.full((1, 1), drive.coupling**2 * rate / leg.stiffness)
    entry, exit_ = Channel(f"tension.{leg.actuator}", "N"), Channel(f"leaked.{leg.actuator}", "m")
    return System(np.full((1, 1), -rate), np.eye(1), gain, np.zeros((1, 1)), (entry,), (exit_,))


def describe_charge(given: Plant, model: LinearModel, charged: LinearModel, drives: Mapping[str, ChargeDrive]) -> ChargedStacks:
    """Compare the modes of a plant at constant voltage (`model`) and at constant charge (`charged`)."""
    pairs = pair_modes(charged, model).nearest(given.frequencies)
    every = drives.values()
    return ChargedStacks(
        actuators=tuple(drives),
        stiffer=np.array([each.stiffening for each in every]),
        corners=np.array([each.corner for each in every]),
        residual_hysteresis=np.array([each.residual_hysteresis for each in every]),
        by_volts=pairs.others,
        by_charge=pairs.frequencies,
    )
