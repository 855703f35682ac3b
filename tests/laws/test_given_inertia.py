"""A given part with inertia moves as the solid that it states; limits of stress beside yield."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.workspace.strength import hinge_stress
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.beams.mass import mass
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import dumps, loads
from flexstage.models.lumped import lumped
from flexstage.parts.body import Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.mass import tensor
from flexstage.spatial.frame import rigid_inertia

UNIT = tuple(map(tuple, np.eye(6).tolist()))
numbers = st.floats(0.1, 2.0)


@given(numbers, st.tuples(*[st.floats(-0.1, 0.1)] * 3), st.floats(-0.1, 0.1))
def test_a_rigid_motion_has_the_inertia_of_the_solid(weight, centre, product):
    inertia = Inertia(1.0, 1.1, 1.2, xy=product, yz=-0.5 * product)
    matrix = mass(ComplianceMatrix(UNIT, free=(), mass=weight, centre=centre, inertia=inertia), None)
    whole = sum(matrix[rows, columns] for rows in (slice(6), slice(6, 12)) for columns in (slice(6), slice(6, 12)))
    np.testing.assert_allclose(whole, rigid_inertia(weight, tensor(inertia), np.array(centre), np.zeros(3)), rtol=1e-12, atol=1e-15)
    assert np.min(np.linalg.eigvalsh(matrix)) > 0.0


def test_without_inertia_nothing_changes_and_with_it_files_hold_it():
    plain = ComplianceMatrix(UNIT, free=(), mass=2.0)
    np.testing.assert_array_equal(np.diag(mass(plain, None)), [1, 1, 1, 0, 0, 0] * 2)
    solid = replace(plain, centre=(0.01, 0.02, 0.0), inertia=Inertia(1e-3, 1e-3, 1e-3))
    stage = parallelogram()
    stage = replace(stage, parts={**stage.parts, "hinge": solid})
    assert loads(dumps(stage)) == stage
    np.testing.assert_array_equal(solid.mirrored.centre, (0.01, -0.02, 0.0))
    bad = Mechanism("bad", parts={"hinge": replace(solid, mass=0.0, inertia=Inertia(1.0, 1.0, 3.0))})
    told = [str(finding) for finding in check(bad)]
    assert any(text.startswith("parts.hinge.inertia: specified without a mass") for text in told)
    assert any(text.startswith("parts.hinge.inertia") and "3" in text for text in told)


def with_limits(**limits: float) -> Mechanism:
    stage = parallelogram()
    return replace(stage, materials={name: replace(each, **limits) for name, each in stage.materials.items()})


def test_the_least_limit_governs_and_is_named():
    plain, strict = with_limits(yield_stress=1e9), with_limits(yield_stress=1e9, fatigue_limit=4e8, allowable_stress=6e8)
    one, other = (hinge_stress(stage, lumped(stage), stroke_limits(stage)) for stage in (plain, strict))
    np.testing.assert_array_equal(other.yield_stress, one.yield_stress)
    np.testing.assert_allclose(other.safety, 0.4 * one.safety, rtol=1e-12)
    assert set(one.governing) == {"yield stress"}
    assert set(other.governing) == {"fatigue limit"}
    assert set(with_governing(allowable_stress=1e8)) == {"allowable stress"}


def with_governing(**limits: float) -> tuple[str, ...]:
    stage = with_limits(**limits)
    return hinge_stress(stage, lumped(stage), stroke_limits(stage)).governing
