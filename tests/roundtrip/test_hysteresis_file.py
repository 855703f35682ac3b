"""The hysteresis file: written and read to the bit; every mistake in one is named with its place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.control.hysteresis.creep import LogCreep
from flexstage.control.hysteresis.models.envelope import Envelope, straight
from flexstage.control.hysteresis.models.inverse import inverse
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.stack import dump_hysteresis, dumps_hysteresis, load_hysteresis, loads_hysteresis, stack_hysteresis
from tests.conftest import examples
from tests.laws.hystereses import models

HEAD = 'format = "flexstage hysteresis 1"\n'
PLAYS = 'thresholds = ["0 V", "50 V"]\nweights = ["100 nm/V", "20 nm/V"]\n'


def same(one, other):
    pairs = [(one.thresholds, other.thresholds), (one.weights, other.weights)]
    for name in ("before", "after"):
        pairs += [(getattr(one, name).knots, getattr(other, name).knots), (getattr(one, name).values, getattr(other, name).values)]
    return all(np.array_equal(mine, theirs) for mine, theirs in pairs)


def as_made(model):
    """The model without numbers so small that they are taken for mistakes."""
    weights, *tables = (
        np.where(np.abs(values) < 1e-15, 0.0, values)
        for values in (model.weights, model.before.knots, model.before.values, model.after.knots, model.after.values)
    )
    return replace(model, weights=weights, before=Envelope(*tables[:2]), after=Envelope(*tables[2:]))


@examples(20)
@given(models(least=-0.9), st.floats(-0.1, 0.1), st.floats(1e-3, 10.0))
def test_files_keep_every_bit(model, rate, reference):
    model, rate = as_made(model), round(rate, 9)
    written = stack_hysteresis(model, creep=LogCreep(rate, reference), volts=(0.0, 1e3 / 3.0), rms=rate**2, source='record "1".csv')
    found = loads_hysteresis(dumps_hysteresis(written))
    assert found == written
    assert same(found.model, model)
    assert found.log_creep == LogCreep(rate, reference)


def test_files_on_disk(tmp_path):
    for after in (straight([1.0], 0.1e-6 / 3.0), Envelope([0.0, 1e-4], [0.0, 0.9e-4])):
        model = PrandtlIshlinskii([0.0, 50.0], [1e-7, 2e-8], after=after)
        assert same(load_hysteresis(dump_hysteresis(stack_hysteresis(model), tmp_path / "stack.toml")).model, model)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (PLAYS, 'format = "flexstage hysteresis 1"'),
        (HEAD + 'thresholds = ["0 V"]', "weights missing"),
        (HEAD + PLAYS.replace("20 nm/V", "20 nm"), "weights"),
        (HEAD + PLAYS.replace('"50 V"', "50"), "thresholds"),
        (HEAD + PLAYS.replace("50 V", "-50 V"), "thresholds of axis 0 must ascend (got -50 after 0)"),
        (HEAD + PLAYS.replace('"0 V", ', ""), "got thresholds (1, 1), weights (1, 2)"),
        (HEAD + PLAYS + 'envelope = { volts = ["0 V", "9 V"], effective = ["0 V"] }', "Use equal numbers of knots and values"),
        (
            HEAD + PLAYS + 'offset = "1 um"\nouter = { plays = ["0 um", "1 um"], strokes = ["0 um", "1 um"] }',
            "conflicts with the outer envelope",
        ),
        (HEAD + PLAYS + 'creep = { rate = 0.02, reference = "0 s" }', "creep.reference"),
        (HEAD + PLAYS + "threshold = 3", ":4: threshold: unknown key"),
    ],
)
def test_mistakes_are_named(text, words):
    with pytest.raises(DesignError) as error:
        loads_hysteresis(text, where="stack.toml")
    assert "stack.toml" in str(error.value)
    assert words in str(error.value)


def test_a_file_holds_one_stack():
    with pytest.raises(DesignError, match=r"too many axes .got 2"):
        stack_hysteresis(PrandtlIshlinskii(np.zeros((2, 1)), np.array([[1e-7], [2e-7]])))


def test_what_is_read_can_be_inverted():
    found = loads_hysteresis(HEAD + PLAYS).model
    assert inverse(found).run(found.run(np.array([0.0, 300.0, 100.0]))) == pytest.approx([0.0, 300.0, 100.0], abs=1e-9)
