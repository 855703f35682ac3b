"""Models of hysteresis side by side, for laws about axes that differ."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.base.number import Array
from flexstage.control.hysteresis.models.envelope import Envelope
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii


def stack_models(models: Sequence[PrandtlIshlinskii]) -> PrandtlIshlinskii:
    """Models as one with all their axes, for actuators that differ; those with fewer plays get further ones of weight 0."""
    count = max(each.thresholds.shape[1] for each in models)
    return PrandtlIshlinskii(
        np.concatenate([_extra_plays(each.thresholds, count) for each in models]),
        np.concatenate([np.pad(each.weights, ((0, 0), (0, count - each.weights.shape[1]))) for each in models]),
        stack_envelopes([broadcast(each.before, each.axes) for each in models]),
        stack_envelopes([broadcast(each.after, each.axes) for each in models]),
    )


def _extra_plays(thresholds: Array, count: int) -> Array:
    last = thresholds[:, -1:]
    return np.concatenate([thresholds, last + (1.0 + last) * np.arange(1, count - thresholds.shape[1] + 1)], axis=1)


def broadcast(envelope: Envelope, axes: int) -> Envelope:
    """An envelope that tells `axes` axes apart, be they alike."""
    shape = (axes, envelope.knots.shape[1])
    return Envelope(np.broadcast_to(envelope.knots, shape), np.broadcast_to(envelope.values, shape))


def stack_envelopes(envelopes: Sequence[Envelope]) -> Envelope:
    """Envelopes as one with all their axes; those with fewer knots get further ones on their last piece."""
    count = max(each.knots.shape[1] for each in envelopes)
    pairs = [_extend(each, count - each.knots.shape[1]) for each in envelopes]
    knots, values = (np.concatenate(group) for group in zip(*pairs, strict=True))
    return Envelope(knots, values)


def _extend(envelope: Envelope, more: int) -> tuple[Array, Array]:
    beyond = np.arange(1, more + 1) * (envelope.knots[:, -1:] - envelope.knots[:, -2:-1])
    knots = np.concatenate([envelope.knots, envelope.knots[:, -1:] + beyond], axis=1)
    values = np.concatenate([envelope.values, envelope.values[:, -1:] + envelope.slopes[:, -1:] * beyond], axis=1)
    return knots, values
