"""Random hystereses and the inputs they are tried on."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import strategies as st

from flexstage.control.hysteresis.models.envelope import IDENTITY, Envelope, straight
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii

VOLTS = 1000.0
GRID = 51

fractions = st.floats(0.0, 1.0)
turns = st.lists(fractions, min_size=2, max_size=12).map(lambda points: VOLTS * np.array(points))
levels = st.lists(st.integers(0, GRID - 1), min_size=2, max_size=10)


@st.composite
def envelopes(draw):
    """Ascending envelopes of volts, straight or bent."""
    count = draw(st.integers(0, 4))
    if not count:
        return IDENTITY
    gaps = draw(st.lists(st.floats(20.0, 300.0), min_size=count, max_size=count))
    slopes = draw(st.lists(st.floats(0.2, 3.0), min_size=count, max_size=count))
    start = draw(st.floats(-100.0, 100.0))
    knots = np.concatenate([[0.0], np.cumsum(gaps)]) + start
    return Envelope(knots, start + np.concatenate([[0.0], np.cumsum(np.multiply(gaps, slopes))]))


@st.composite
def models(draw, *, bent=True, least=0.0):
    """Models of one axis; weights of `least` 1e-8 m/V or more beyond the first, so that slopes never fall below 2e-8 m/V."""
    count = draw(st.integers(1, 6))
    gaps = draw(st.lists(st.floats(1.0, 150.0), min_size=count, max_size=count))
    first = draw(st.floats(2e-8, 2e-7)) - min(least, 0.0) * 1e-8 * count
    rest = draw(st.lists(st.floats(least * 1e-8, 5e-8), min_size=count, max_size=count))
    before = draw(envelopes()) if bent else IDENTITY
    after = straight([draw(st.floats(0.5, 2.0))], draw(st.floats(-1e-5, 1e-5)))
    return PrandtlIshlinskii(np.concatenate([[0.0], np.cumsum(gaps)]), [first, *rest], before, after)


def walked(points, pieces=7):
    """Inputs that go through `points` in small steps, and the places of the points among them."""
    steps = [np.linspace(start, stop, pieces + 1)[1:] for start, stop in pairwise(points)]
    return np.concatenate([points[:1], *steps]), pieces * np.arange(len(points))


def on_grid(places):
    """Inputs through levels of a grid one by one, from the first back to the first."""
    rungs = [np.arange(a, b, 1 if b > a else -1) for a, b in zip(places, [*places[1:], places[0]], strict=True)]
    return VOLTS * np.concatenate([*rungs, places[:1]]) / (GRID - 1)
