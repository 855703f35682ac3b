"""Plants of another kind: Bouc-Wen and Preisach obey the laws of their theories, which differ."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.control.hysteresis.models.bouc_wen import BoucWen, bouc_wen
from flexstage.control.hysteresis.models.shape import major_loop
from tests.conftest import examples
from tests.laws.hystereses import VOLTS, fractions, levels, on_grid, turns, walked
from tests.laws.preisach import Preisach, preisach

SIZE = 1e-4


@st.composite
def bouc_wens(draw):
    beta = draw(st.floats(1e-3, 2e-2))
    gamma = beta * draw(st.one_of(st.floats(-0.8, 1.0), st.sampled_from([0.0, 1.0])))
    lag = draw(st.floats(1e-8, 1e-7))
    return BoucWen([2.0 * lag * beta / (beta + gamma) + draw(st.floats(1e-8, 2e-7))], [lag], [beta], [gamma], 1e-6)


@st.composite
def preisachs(draw):
    tilt = draw(st.floats(-0.7, 0.7))
    bulge = draw(st.floats(0.0, 1.0)) * (1.0 - abs(tilt))
    density, decay = draw(st.floats(0.0, 4e-10)), draw(st.floats(100.0, 2000.0))
    return Preisach([draw(st.floats(1e-8, 1e-7))], [density], [decay], [tilt], [bulge], [0.0], [VOLTS])


plants = st.one_of(bouc_wens(), preisachs())


def nearly(found, wanted, tolerance=1e-11):
    return np.max(np.abs(np.asarray(found) - wanted), initial=0.0) <= tolerance * SIZE


@examples(8)
@given(plants, turns)
def test_speed_does_not_matter(plant, points):
    volts, places = walked(points)
    assert nearly(plant.run(volts)[places], plant.run(points))


@examples(8)
@given(plants, turns)
def test_the_stroke_moves_with_the_volts(plant, points):
    volts, _ = walked(points)
    risen = np.diff(plant.run(volts)) * np.sign(np.diff(volts))
    assert np.all(risen >= -1e-12 * SIZE)


@examples(8)
@given(plants, turns)
def test_steps_are_pure_and_add_up_to_runs(plant, points):
    state, strokes = plant.start(points[:1]), []
    for value in points:
        before = state.copy()
        after, stroke = plant.step(state, np.array([value]))
        assert np.array_equal(state, before)
        state = after
        strokes.append(float(stroke[0]))
    assert np.array_equal(strokes, plant.run(points))


@examples(7)
@given(bouc_wens(), turns)
def test_bouc_wen_dissipates(plant, points):
    """Integral of h dv = stored energy gained, h^2/(2 A), and what is lost along any path, which is 0 or more as |gamma| <= beta."""
    volts, _ = walked(points, 150)
    lagging = plant.offset + plant.gain * volts - plant.run(volts)
    supplied = np.sum(0.5 * (lagging[1:] + lagging[:-1]) * np.diff(volts))
    stored = (lagging[-1] ** 2 - lagging[0] ** 2) / (2.0 * plant.lag[0])
    assert supplied - stored >= -1e-4 * SIZE * VOLTS


@examples(8)
@given(preisachs(), turns, st.lists(fractions, min_size=1, max_size=8))
def test_preisach_wipes_out(plant, points, wiggles):
    low, high = np.min(points), np.max(points)
    inner = low + (high - low) * np.array(wiggles)
    with_loops = np.array([*points, low, high, *inner, high, low, high])
    assert nearly(plant.run(with_loops)[-3:], plant.run(np.array([*points, low, high, low, high]))[-3:])


@examples(8)
@given(preisachs(), turns, turns, fractions, fractions)
def test_preisach_loops_are_congruent(plant, past, other, one, two):
    low, high = VOLTS * min(one, two), VOLTS * max(one, two)
    loop, _ = walked(np.array([low, high, low, high]))
    shapes = [plant.run(np.concatenate([history, loop]))[len(history) + 7 :] for history in (past, other)]
    assert nearly(shapes[0] - shapes[0][0], shapes[1] - shapes[1][0])


@examples(8)
@given(preisachs(), levels)
def test_preisach_loops_dissipate(plant, places):
    volts = on_grid(places)
    strokes = plant.run(np.concatenate([volts, volts]))[len(volts) :]
    assert -np.sum(0.5 * (strokes[1:] + strokes[:-1]) * np.diff(volts)) >= -1e-12 * SIZE * VOLTS


@examples(8)
@given(preisachs(), st.integers(1, 60))
def test_preisach_remembers_as_much_as_there_is(plant, nested):
    """Extremes nested one in another, more of them than a state has room for at first, are all remembered; noise leaves none behind."""
    inward = 500.0 + 500.0 * (-1.0) ** np.arange(nested) * (1.0 - np.arange(nested) / (nested + 1.0))
    outward = inward[::-1]
    up, down = plant.run(np.concatenate([inward, outward]))[[0, -1]], plant.run(inward[:1])
    assert nearly(up, down[0])


def test_loops_of_the_wanted_width_are_made():
    for plant in (bouc_wen(2e-4, (-100.0, 900.0), 0.15), preisach(2e-4, (-100.0, 900.0), 0.15)):
        loop = major_loop(plant, (-100.0, 900.0), count=251, cycles=4)
        assert loop.stroke[0] == pytest.approx(2e-4, rel=1e-5)
        assert loop.width[0] == pytest.approx(0.15, rel=1e-4)


def test_six_axes_are_six_times_one():
    rng = np.random.default_rng(1)
    volts = np.cumsum(rng.normal(0.0, 60.0, (300, 3)), axis=0) % VOLTS
    three = Preisach([5e-8] * 3, [2e-10] * 3, [300.0, 500.0, 900.0], [0.4, 0.0, -0.3], [0.5, 0.2, 0.0], [0.0] * 3, [VOLTS] * 3)
    other = BoucWen([2e-7] * 3, [4e-8] * 3, [4e-3] * 3, [0.0, 2e-3, 4e-3])
    for plant, names in ((three, ("slope", "density", "decay", "tilt", "bulge", "low", "high")), (other, ("gain", "lag", "beta", "gamma"))):
        together = plant.run(volts)
        for axis in range(3):
            alone = type(plant)(*([getattr(plant, name)[axis]] for name in names))
            assert nearly(together[:, axis], alone.run(volts[:, axis]), 1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: BoucWen([1.0], [0.1], [1.0], [1.1]), "gamma is 1.1 1/V (expected above -1 and at most beta, 1)"),
        (lambda: BoucWen([1.0], [0.1], [1.0], [-1.0]), "would not dissipate"),
        (lambda: BoucWen([1.0], [0.8], [1.0], [0.0]), "changes by 1.6 m/V, more than the gain 1 m/V"),
        (lambda: bouc_wen(1e-4, (0.0, 1000.0), 0.6), "Choose a smaller lag"),
        (lambda: bouc_wen(1e-4, (1000.0, 0.0), 0.1), "invalid loop"),
        (lambda: preisach(1e-4, (0.0, 1000.0), 0.8), "more than 0.0001 m"),
        (lambda: preisach(-1e-4, (0.0, 1000.0), 0.1), "no loop"),
        (lambda: Preisach([0.0], [1.0], [1.0], [0.7], [0.6], [0.0], [1.0]), "its density falls to -0.3 of its middle"),
        (lambda: Preisach([0.0], [1.0], [1.0], [0.0], [0.0], [1.0], [1.0]), "volts that ascend"),
    ],
)
def test_plants_that_are_none_are_refused(make, words):
    with pytest.raises(DesignError) as error:
        make()
    assert words in str(error.value)
