"""Laws of links with inner coordinates: two leaves and the body between them are one link with that body's freedoms as its modes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh

from flexstage.beams.compliance import Law
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.models import lumped as models
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.spatial.frame import COMPONENTS, FORCES

STEEL = Material(young=200e9, poisson=0.3, density=7800.0)
LEAF = Leaf("steel", length=0.04, thickness=0.001, width=0.02)
ROUND = Inertia(2e-5, 3e-5, 4e-5)


def chain():
    """Ground, leaf, a body, leaf, platform, in a bow."""
    bodies = {
        "platform": Body(mass=0.3, centre=(0.0, 0.0, 0.0), inertia=ROUND),
        "inner": Body(mass=0.1, centre=(-0.05, 0.01, 0.0), inertia=ROUND),
    }
    links = {
        "first": Link(("ground", "inner"), "leaf", at=(-0.08, 0.03, 0.0), along=(1.0, 0.3, 0.0), bends=(0.0, 0.0, 1.0)),
        "second": Link(("inner", "platform"), "leaf", at=(-0.02, 0.0, 0.0), along=(1.0, 0.0, 0.2), bends=(0.0, 1.0, 0.0)),
    }
    return Mechanism("chain", materials={"steel": STEEL}, parts={"leaf": LEAF}, bodies=bodies, links=links)


def reduced(model):
    """Law and mass (18, 18) of all but the platform as one link at its reference, by the modes of the inner body (Craig-Bampton)."""
    stiffness, inertia = model.stiffness_matrix, model.inertia_matrix - np.pad(model.inertia["platform"].law, (0, 6))
    follow = -np.linalg.solve(stiffness[6:, 6:], stiffness[6:, :6])
    squares, modes = eigh(stiffness[6:, 6:], inertia[6:, 6:])
    basis = np.block([[np.eye(6), np.zeros((6, 6))], [follow, modes]])
    mass = np.pad(basis.T @ inertia @ basis, ((6, 0), (6, 0)))  # the end on the ground: what it weighs is not asked here
    return Law(stiffness[:6, :6] + stiffness[:6, 6:] @ follow, inner=squares), mass


@pytest.fixture
def whole():
    return lumped(chain())


@pytest.fixture
def single(monkeypatch, whole):
    """The same stage with one link in place of the leaves and the body between them."""
    law, mass = reduced(whole)
    monkeypatch.setattr(models, "law", lambda *_: law)
    monkeypatch.setattr(models, "mass", lambda *_: mass)
    link = Link(("ground", "platform"), "leaf", at=(0.0, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))
    return lumped(
        Mechanism(
            "single",
            materials={"steel": STEEL},
            parts={"leaf": LEAF},
            bodies={"platform": chain().bodies["platform"]},
            links={"link": link},
        )
    )


def test_a_link_has_its_inner_coordinates_after_those_of_the_bodies(single):
    assert single.coordinates[6:] == tuple(f"link.mode{number}" for number in range(1, 7))
    assert not np.any(single.rigid[6:])


def test_all_frequencies_and_the_statics_are_those_of_the_chain(whole, single):
    np.testing.assert_allclose(eigen(single).values, eigen(whole).values, rtol=1e-8)
    twist, wrench = (tuple(f"platform.{name}" for name in names) for names in (COMPONENTS, FORCES))
    gains = [static_gain(each, twist, wrench).values for each in (single, whole)]
    np.testing.assert_allclose(gains[0], gains[1], rtol=1e-8, atol=1e-9 * np.max(np.abs(gains[1])))


def test_its_forces_are_those_of_its_ends_alone(single):
    rows = single.output_index(tuple(f"link.{name}" for name in FORCES))
    np.testing.assert_allclose(single.output[rows, :6], single.stiffness_matrix[:6, :6])
    assert not np.any(single.output[rows, 6:])
