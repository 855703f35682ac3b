"""Finite motion: inverse and forward are inverse, small motions are the linear ones, the stage may stand anywhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, double_triangle
from flexstage.cases.registry import CASES, case
from flexstage.models.finite import FinitePose, forward_kinematics, inverse_kinematics
from tests.conftest import STROKELESS, examples
from tests.laws.shared import ideal
from tests.laws.strategies import actuated_platforms, moved, turns

seeds = st.integers(0, 2**32 - 1)
ACTUATED = [name for name in CASES if name not in STROKELESS]


def wanted(kinematics, seed, size=1e-4):
    """A random pose of which only the stage's ideal coordinates are set."""
    values = size * np.random.default_rng(seed).uniform(-1.0, 1.0, len(kinematics.coordinates))
    pose = np.zeros(6)
    for name, value in zip(kinematics.coordinates, values, strict=True):
        pose[["x", "y", "z", "rx", "ry", "rz"].index(name)] = value
    return FinitePose(pose[:3], pose[3:])


def compare(found, pose, kinematics, tolerance=1e-12):
    index = [["x", "y", "z", "rx", "ry", "rz"].index(name) for name in kinematics.coordinates]
    np.testing.assert_allclose(found.pose.vector[index], pose.vector[index], rtol=0.0, atol=tolerance)


@examples(16)
@given(actuated_platforms(), seeds)
def test_forward_undoes_inverse(mechanism, seed):
    kinematics = ideal(mechanism)
    pose = wanted(kinematics, seed)
    there = inverse_kinematics(mechanism, kinematics, pose)
    back = forward_kinematics(mechanism, kinematics, there.strokes)
    assert there.consistent
    assert back.consistent
    compare(there, pose, kinematics)
    compare(back, pose, kinematics)


@pytest.mark.parametrize("name", ACTUATED)
def test_inverse_undoes_forward(name):
    mechanism = case(name)
    kinematics = ideal(mechanism)
    pose = wanted(kinematics, 7)
    strokes = inverse_kinematics(mechanism, kinematics, pose).strokes
    again = inverse_kinematics(mechanism, kinematics, forward_kinematics(mechanism, kinematics, strokes).pose)
    np.testing.assert_allclose(again.strokes, strokes, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("parameters", [SM_REF_A, SM_REF_B])
def test_inverse_undoes_forward_over_the_corners(parameters):
    mechanism = double_triangle(parameters)
    kinematics = ideal(mechanism)
    strokes = 1e-4 * np.random.default_rng(3).choice([-1.0, 1.0], (5, 2, 6))
    there = forward_kinematics(mechanism, kinematics, strokes)
    assert there.consistent.shape == (5, 2)
    assert there.consistent.all()
    np.testing.assert_allclose(inverse_kinematics(mechanism, kinematics, there.pose).strokes, strokes, rtol=0.0, atol=1e-15)


@examples(16)
@given(actuated_platforms(), seeds)
def test_error_of_the_linear_map_is_quadratic(mechanism, seed):
    kinematics = ideal(mechanism)
    size = np.max(np.abs(kinematics.actuation @ np.random.default_rng(seed).uniform(-1.0, 1.0, kinematics.mobility)))
    strokes = 1e-5 / size * (kinematics.actuation @ np.random.default_rng(seed).uniform(-1.0, 1.0, kinematics.mobility))
    errors = [
        forward_kinematics(mechanism, kinematics, scale * strokes).pose.vector - kinematics.jacobian.values @ (scale * strokes)
        for scale in (1.0, 0.5)
    ]
    np.testing.assert_allclose(4.0 * errors[1], errors[0], rtol=0.0, atol=0.02 * np.max(np.abs(errors[0])) + 1e-14)


@examples(16)
@given(actuated_platforms(), seeds)
def test_first_derivative_is_the_linear_map(mechanism, seed):
    """By complex step: forward kinematics is analytic."""
    kinematics = ideal(mechanism)
    strokes = kinematics.actuation @ np.random.default_rng(seed).uniform(-1.0, 1.0, kinematics.mobility)
    found = forward_kinematics(mechanism, kinematics, 1e-8j * strokes).pose.vector
    linear = kinematics.jacobian.values @ strokes
    np.testing.assert_allclose(found.imag / 1e-8, linear, rtol=0.0, atol=1e-6 * np.max(np.abs(linear)))


@examples(16)
@given(actuated_platforms(), turns(), seeds)
def test_moving_the_stage_only_turns_the_motion(mechanism, move, seed):
    turn, shift = move
    kinematics = ideal(mechanism)
    strokes = inverse_kinematics(mechanism, kinematics, wanted(kinematics, seed)).strokes
    here = forward_kinematics(mechanism, kinematics, strokes)
    elsewhere = moved(mechanism, turn, shift)
    there = forward_kinematics(elsewhere, ideal(elsewhere), strokes)
    np.testing.assert_allclose(there.pose.displacement, turn @ here.pose.displacement, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(there.pose.rotation_vector, turn @ here.pose.rotation_vector, rtol=0.0, atol=1e-11)


@examples(7)
@given(actuated_platforms(), seeds)
def test_a_batch_of_strokes_is_the_loop(mechanism, seed):
    kinematics = ideal(mechanism)
    poses = [wanted(kinematics, seed + number) for number in range(3)]
    strokes = np.stack([inverse_kinematics(mechanism, kinematics, pose).strokes for pose in poses])
    together = forward_kinematics(mechanism, kinematics, strokes)
    for index, single in enumerate(strokes):
        np.testing.assert_allclose(
            together.pose.vector[index], forward_kinematics(mechanism, kinematics, single).pose.vector, rtol=0.0, atol=1e-13
        )
