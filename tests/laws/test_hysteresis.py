"""Hysteresis: what loops obey whatever their parameters, and inverses that undo."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.control.hysteresis.models.envelope import Envelope
from flexstage.control.hysteresis.models.inverse import inverse, inverse_state
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from tests.conftest import examples
from tests.laws.hystereses import VOLTS, fractions, levels, models, on_grid, turns, walked
from tests.laws.stacked_models import stack_models

SIZE = 1e-4
"""Metres: the order of a stroke. Rounding is judged against it."""


def nearly(found, wanted, size, tolerance=1e-12):
    """Whether two sequences agree to a part of a size."""
    return np.max(np.abs(np.asarray(found) - wanted), initial=0.0) <= tolerance * size


@examples(16)
@given(models(least=-0.9), turns)
def test_the_inverse_undoes_the_model(model, points):
    volts, _ = walked(points)
    assert nearly(inverse(model).run(model.run(volts)), volts, VOLTS)


@examples(16)
@given(models(least=-0.9), turns)
def test_the_model_undoes_the_inverse(model, points):
    """The other way round, for strokes anywhere the model can be asked for."""
    strokes = points * 1e-7
    assert nearly(model.run(inverse(model).run(strokes)), strokes, SIZE)


@examples(16)
@given(models(least=-0.9))
def test_the_inverse_of_the_inverse_is_the_model(model):
    twice = inverse(inverse(model))
    assert nearly(twice.thresholds, model.thresholds, VOLTS)
    assert nearly(twice.weights, model.weights, 1e-7)


@examples(16)
@given(models(least=-0.9), turns, turns)
def test_the_inverse_starts_anywhere(model, past, points):
    """Beside a model with a past, from the state that belongs to it."""
    states = model.start(past[:1])
    for value in past[1:]:
        states, _ = model.step(states, np.array([value]))
    volts, _ = walked(points)
    assert nearly(inverse(model).run(model.run(volts, states), inverse_state(model, states)), volts, VOLTS)


@examples(16)
@given(models(), turns)
def test_speed_does_not_matter(model, points):
    """Samples between the turning points change nothing at the turning points."""
    volts, places = walked(points)
    assert nearly(model.run(volts)[places], model.run(points), SIZE)


@examples(16)
@given(models(), turns)
def test_the_output_moves_with_the_input(model, points):
    volts, _ = walked(points)
    risen = np.diff(model.run(volts)) * np.sign(np.diff(volts))
    assert np.all(risen >= -1e-14 * SIZE)


@examples(16)
@given(models(), turns, st.lists(st.floats(0.0, 200.0), min_size=12, max_size=12))
def test_more_input_never_makes_less_output(model, points, more):
    lower, upper = model.run(points), model.run(points + np.array(more)[: len(points)])
    assert np.all(upper - lower >= -1e-14 * SIZE)


@examples(16)
@given(models(), turns, st.lists(fractions, min_size=1, max_size=8))
def test_a_larger_swing_wipes_out_the_smaller(model, points, wiggles):
    """Whatever happened between two extremes is forgotten when the later one is passed: inner loops close."""
    low, high = np.min(points), np.max(points)
    inner = low + (high - low) * np.array(wiggles)
    with_loops = [*points, low, high, *inner, high, low, high]
    without = [*points, low, high, low, high]
    assert nearly(model.run(np.array(with_loops))[-3:], model.run(np.array(without))[-3:], SIZE)


@examples(16)
@given(models(bent=False), turns, turns, fractions, fractions)
def test_equal_swings_make_congruent_loops(model, past, other, one, two):
    """Without a bent envelope, loops between the same inputs have one shape whatever was before: only their height differs."""
    low, high = VOLTS * min(one, two), VOLTS * max(one, two)
    loop, _ = walked(np.array([low, high, low, high]))
    shapes = [model.run(np.concatenate([history, loop]))[len(history) + 7 :] for history in (past, other)]
    assert nearly(shapes[0] - shapes[0][0], shapes[1] - shapes[1][0], SIZE)


@examples(16)
@given(models(), levels)
def test_closed_loops_dissipate(model, places):
    """The integral of volts over stroke around a periodic input, once settled, is 0 or more."""
    volts = on_grid(places)
    strokes = model.run(np.concatenate([volts, volts]))[len(volts) :]
    dissipated = -np.sum(0.5 * (strokes[1:] + strokes[:-1]) * np.diff(volts))
    assert dissipated >= -1e-13 * SIZE * VOLTS


@examples(16)
@given(st.lists(models(), min_size=1, max_size=6), turns)
def test_axes_side_by_side_are_the_axes_alone(each, points):
    """Stacked models of unlike sizes, stepped together, give each what it gives alone."""
    together = stack_models(each).run(np.tile(points[:, None], (1, len(each))))
    for column, model in zip(together.T, each, strict=True):
        assert nearly(column, model.run(points), SIZE, 1e-14)


@examples(16)
@given(models(), turns)
def test_steps_are_pure(model, points):
    state = model.start(points[:1])
    before = state.copy()
    model.step(state, points[1:2])
    assert np.array_equal(state, before)
    assert np.array_equal(model.step(state, points[1:2])[1], model.run(points[:2])[1:])


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (PrandtlIshlinskii([0.0, 10.0], [0.0, 1e-7]), "the weights up to 0 (threshold 0) sum to 0"),
        (PrandtlIshlinskii([0.0, 10.0], [1e-7, -1e-7]), "the weights up to 1 (threshold 10) sum to 0"),
        (PrandtlIshlinskii([0.0, 10.0, 20.0], [1e-7, -2e-7, 3e-7]), "the weights up to 1 (threshold 10) sum to -1e-07"),
        (
            PrandtlIshlinskii([0.0], [1e-7], Envelope([0.0, 5.0, 9.0], [0.0, 5.0, 4.0])),
            "between 5 and 9 on axis 0 the value changes from 5",
        ),
        (PrandtlIshlinskii([0.0], [1e-7], after=Envelope([0.0, 1e-5], [0.0, 0.0])), "between 0 and 1e-05 on axis 0"),
    ],
)
def test_what_has_no_inverse_is_refused(model, words):
    with pytest.raises(DesignError) as error:
        inverse(model)
    assert words in str(error.value)


def test_every_reason_is_told():
    both = stack_models([PrandtlIshlinskii([0.0], [-1.0]), PrandtlIshlinskii([0.0, 1.0], [1.0, -2.0])])
    with pytest.raises(DesignError) as error:
        inverse(both)
    assert [finding.where for finding in error.value.findings] == ["hysteresis of axis 0"] * 2 + ["hysteresis of axis 1"]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: PrandtlIshlinskii([1.0], [1.0]), "first threshold of axis 0 must be 0 (got 1)"),
        (lambda: PrandtlIshlinskii([0.0, 2.0, 2.0], [1.0, 1.0, 1.0]), "thresholds of axis 0 must ascend (got 2 after 2)"),
        (lambda: PrandtlIshlinskii([0.0, 2.0], [1.0]), "got thresholds (1, 2), weights (1, 1)"),
        (lambda: PrandtlIshlinskii([0.0], [np.nan]), "a threshold or a weight is not finite"),
        (
            lambda: PrandtlIshlinskii([0.0], [1.0], Envelope(np.tile([0.0, 1.0], (2, 1)), np.tile([0.0, 1.0], (2, 1)))),
            "wrong number of axes (got 2, expected 1",
        ),
        (lambda: Envelope([0.0, 0.0], [0.0, 1.0]), "got knot 1 of axis 0 at 0 after 0"),
        (lambda: Envelope([0.0], [0.0]), "at least two"),
        (lambda: Envelope([0.0, np.inf], [0.0, 1.0]), "a knot or a value is not finite"),
        (lambda: PrandtlIshlinskii([0.0], [1.0]).run(np.zeros((3, 2))), "got (3, 2)"),
        (lambda: PrandtlIshlinskii([0.0], [1.0]).run(np.array([np.nan])), "an input is not finite"),
    ],
)
def test_models_that_are_none_are_refused(make, words):
    with pytest.raises(DesignError) as error:
        make()
    assert words in str(error.value)
