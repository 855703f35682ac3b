"""Active damping of a set-up: force feedback in the legs, inside the pose loop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from flexstage.base.finding import Finding, refuse, require
from flexstage.control.damping.damped_plant import (
    ActiveDamping,
    close_damping,
    describe_damping,
    dominant_modes,
    gain_for,
    with_damped_modes,
    with_series_stiffness,
)
from flexstage.control.damping.force_feedback import ForceFeedback
from flexstage.control.damping.legs import Leg, pair_zeros
from flexstage.control.plant_models.plants import Plant
from flexstage.control.plant_models.reduction import reduce_modes
from flexstage.control.study.setup import DampingSetup
from flexstage.models.linear.model import LinearModel

_USUAL = 0.5
_CORNER = 0.1
_WHOLE = 1e-9


def damp(plant: Plant, whole: Plant, model: LinearModel, legs: tuple[Leg, ...], asked: DampingSetup) -> tuple[Plant, Plant, ActiveDamping]:
    """Close the force-feedback loops of a set-up around `plant` and `whole`; return both plants, and a description of the loops.

    Both plants must have outputs for link forces. Raises `DesignError` for a rate that is not a multiple of the loop's sampling rate. The
    error is also raised if the force feedback is unstable, with all modes or with the retained modes.
    """
    require(_rate_findings(asked.rate, plant.hardware.rate))
    pairs = pair_zeros(model, legs)
    sensed = tuple(replace(each, noise=asked.noise) for each in legs) if asked.noise is not None else legs
    legs = with_series_stiffness(reduce_modes(plant, np.zeros(len(plant.frequencies), bool)), sensed)
    lags = [each for each in (asked.lag, *(leg.lag for leg in sensed)) if each is not None]
    corner = (
        asked.corner
        if asked.corner is not None
        else _CORNER * float(np.min(pairs.nearest(plant.frequencies[dominant_modes(plant)]).others))
    )
    law = ForceFeedback(asked.gain or 1.0, corner, asked.order, min(lags, default=np.inf), _delay(asked))
    if asked.gain is None:
        law = replace(law, gain=gain_for(plant, law, legs, asked.ratio or _USUAL))
    closed, both = close_damping(plant, law, legs), close_damping(whole, law, legs)
    growth = max(closed.system.growth, both.system.growth)
    if growth >= 0.0:
        what = f"force feedback with a gain of {law.gain:.4g} 1/s is unstable (growth rate {growth:.3g} 1/s)"
        raise refuse("damping", what, "Specify less damping, or use faster amplifiers, a higher lag corner and a shorter delay")
    found = replace(describe_damping(plant, closed, law, legs, pairs), rate=asked.rate)
    return with_damped_modes(closed, found), both, found


def _delay(asked: DampingSetup) -> float:
    """Delay from tension to stroke [s]; for a computer by default one sample, plus half a sample of the hold."""
    if asked.rate is None:
        return asked.delay or 0.0
    return (1.0 / asked.rate if asked.delay is None else asked.delay) + 0.5 / asked.rate


def _rate_findings(inner: float | None, outer: float | None) -> Iterator[Finding]:
    if inner is None or outer is None:
        return
    turns = max(round(inner / outer), 1)
    if abs(inner / (turns * outer) - 1.0) > _WHOLE:
        what = f"must be a multiple of the loop's sampling rate (got {inner:.6g} Hz, {inner / outer:.6g} times {outer:.6g} Hz)"
        yield Finding("damping.rate", what, f"Use {turns * outer:.6g} Hz")
