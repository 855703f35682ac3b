"""The session: what is kept does not grow with the number of designs, can be listed, and clearing it changes no result."""

from __future__ import annotations

import gc

import numpy as np

import flexstage as fs
from flexstage.base.session import SESSION
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.mechanism import Mechanism
from tests.conftest import FULL

FIRST, DESIGNS = 80, 10_000 if FULL else 160
"""Designs until everything that is kept is as full as it gets, and in all."""
FEW = 200
"""Objects that come and go with the interpreter; a design and its models have thousands."""
ADDRESS = "parts.leaf.thickness"


def design(number: int) -> Mechanism:
    stage = parallelogram()
    return set_value(stage, ADDRESS, get(stage, ADDRESS) * (1.0 + 1e-5 * number))


def frequencies(number: int) -> np.ndarray:
    model = fs.lumped(design(number))
    return fs.statics(model).compliance.values.diagonal() * fs.modes(model).frequencies[0]


def living() -> int:
    gc.collect()
    return len(gc.get_objects())


def test_memory_stays_the_same_however_many_designs_are_analysed() -> None:
    for number in range(FIRST):
        frequencies(number)
    before, counted = living(), SESSION.held()
    for number in range(FIRST, DESIGNS):
        frequencies(number)
    assert living() - before < FEW
    assert SESSION.held() == counted


def test_what_is_kept_is_listed_and_cleared() -> None:
    before = frequencies(1)
    assert SESSION.held()["flexstage.mechanism.assembly.expand._assembly"] >= 1
    SESSION.clear()
    assert SESSION.held() == {}
    np.testing.assert_array_equal(frequencies(1), before)
