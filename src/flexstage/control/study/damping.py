"""Active damping of a set-up: force feedback in the legs, under the plants that the loop of the pose is closed around."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.finding import refuse
from flexstage.control.damping.damped_plant import ActiveDamping, as_felt, close_damping, describe_damping, gain_for, with_damped_modes
from flexstage.control.damping.force_feedback import ForceFeedback
from flexstage.control.damping.legs import Leg, Pairs, pair_zeros
from flexstage.control.plants import Plant
from flexstage.control.reduction import reduce_modes, resonances
from flexstage.control.study.setup import DampingSetup
from flexstage.models.linear.model import LinearModel

_USUAL = 0.5
_CORNER = 0.1


@dataclass(frozen=True, eq=False)
class Damped:
    """The plant that the loop feels and the whole one, with the inner loops closed, and what these do."""

    plant: Plant
    whole: Plant
    found: ActiveDamping


def damp(plant: Plant, whole: Plant, model: LinearModel, legs: tuple[Leg, ...], asked: DampingSetup) -> Damped:
    """Close the inner loops of a set-up around both plants, which have the links' forces.

    Raises `DesignError` where they are unstable, with all modes below half the sampling rate or with those that the loop feels.
    """
    pairs = pair_zeros(model, legs)
    sensed = tuple(replace(each, noise=asked.noise) for each in legs) if asked.noise is not None else legs
    felt = as_felt(reduce_modes(plant, np.inf), sensed)
    lags = [each for each in (asked.lag, *(leg.lag for leg in sensed)) if each is not None]
    corner = asked.corner if asked.corner is not None else _CORNER * _lowest_zero(plant, pairs)
    law = ForceFeedback(asked.gain or 1.0, corner, asked.order, min(lags, default=np.inf), asked.delay or 0.0)
    if asked.gain is None:
        law = replace(law, gain=gain_for(plant, law, felt, asked.ratio or _USUAL))
    closed, both = close_damping(plant, law, felt), close_damping(whole, law, felt)
    growth = max(closed.system.growth, both.system.growth)
    if growth >= 0.0:
        what = f"with a gain of {law.gain:.4g} 1/s the inner loops are unstable: they grow by {growth:.3g} 1/s"
        raise refuse("damping", what, "Ask for less damping; faster amplifiers, a higher lag and a shorter delay let it be more")
    found = describe_damping(plant, closed, law, felt, pairs)
    return Damped(with_damped_modes(closed, found), both, found)


def _lowest_zero(plant: Plant, pairs: Pairs) -> float:
    """The lowest frequency [Hz] without the legs' stiffness, of the modes that the loop feels most."""
    felt = np.argsort(-resonances(plant))[: len(plant.coordinates.names)]
    return float(min(pairs.others[np.argmin(np.abs(pairs.frequencies - each))] for each in plant.frequencies[felt]))
