"""Laws of parts that state their stiffness: it need not have an inverse, and where it has one it is that of a stated compliance."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given

from flexstage.base.finding import DesignError
from flexstage.beams import LAWS
from flexstage.beams.compliance import compliance, law, stiffness
from flexstage.beams.law import PartLaw
from flexstage.parts.freedom import Freedom
from flexstage.parts.part import Restricted
from flexstage.parts.shape import Elastic
from tests.laws.strategies import givens


@dataclass(frozen=True, eq=False)
class Stated(Elastic):
    kind = "stated"
    matrix: np.ndarray


@pytest.fixture(autouse=True)
def _known(monkeypatch):
    monkeypatch.setitem(LAWS.own, "stated", PartLaw(stiffness=lambda part: part.matrix, mass=lambda _: np.zeros((12, 12))))


@given(givens())
def test_a_stated_stiffness_does_what_its_inverse_as_a_stated_compliance_does(part):
    stated = Stated(stiffness(part, None))
    np.testing.assert_array_equal(law(stated, None).stiffness, law(part, None).stiffness)
    np.testing.assert_allclose(compliance(stated, None), compliance(part, None), rtol=1e-9, atol=1e-9 * np.max(part.compliance[0]))
    freedoms = (Freedom.X, Freedom.RZ)
    both = [law(Restricted(each, (Freedom.Y,), freedoms), None).stiffness for each in (stated, part)]
    np.testing.assert_allclose(both[0], both[1], rtol=1e-12)


def test_a_singular_stiffness_counts_as_it_is_and_has_no_compliance():
    part = Stated(np.diag([-3e3, 0.0, 2e5, 0.0, 1.0, 1.0]))
    np.testing.assert_array_equal(law(part, None).stiffness, part.matrix)
    with pytest.raises(DesignError, match="kind stated: singular stiffness in y, rx, so that"):
        compliance(part, None)
    tilted = np.diag([1e5, 1e5, 1e5, 1.0, 1.0, 1.0])
    tilted[0, 1] = tilted[1, 0] = 1e5
    with pytest.raises(DesignError, match="singular stiffness in x, y,"):
        compliance(Stated(tilted), None)


def test_freedoms_without_stiffness_are_free_already():
    part = Stated(np.diag([3e3, 0.0, 2e5, 0.0, 1.0, 1.0]))
    found = law(Restricted(part, (Freedom.X,), (Freedom.Y, Freedom.Z, Freedom.RX)), None)
    np.testing.assert_array_equal(found.stiffness, np.diag([3e3, 0, 0, 0, 0, 0]))


def test_a_later_design_without_stiffness_has_no_number():
    batch = np.array([1.0, 0.0, 2.0])[:, None, None] * np.eye(6) + 0.0
    batch[1] += np.diag([0.0, 1, 1, 1, 1, 1])
    found = compliance(replace(Stated(batch)), None)
    assert np.isnan(found[1]).all()
    np.testing.assert_array_equal(found[[0, 2]], [np.eye(6), 0.5 * np.eye(6)])
