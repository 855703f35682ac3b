"""Finite rotations: exponential and logarithm are inverse, orthogonal, analytic, and the rate is the derivative."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flexstage.spatial.frame import axes
from flexstage.spatial.rotation import exponential, logarithm, logarithm_rate, rotation_vector

angles = st.one_of(st.floats(0.0, 3.1), st.floats(-9.0, 0.0).map(lambda power: 10.0**power))
directions = st.integers(0, 2**32 - 1).map(lambda seed: _unit(np.random.default_rng(seed).normal(size=3)))
vectors = st.builds(lambda angle, direction: angle * direction, angles, directions)


def _unit(vector):
    return vector / np.linalg.norm(vector)


@given(vectors)
def test_logarithm_undoes_exponential(vector):
    found = logarithm(exponential(vector))
    np.testing.assert_allclose(found, vector, rtol=1e-12, atol=1e-15 + 4e-16 / (np.pi - np.linalg.norm(vector)))


@given(st.one_of(vectors, directions.map(lambda axis: np.pi * axis), st.sampled_from([*np.eye(3)]).map(lambda axis: np.pi * axis)))
def test_rotation_vector_is_that_of_another_code_up_to_half_a_turn(vector):
    rotation = exponential(vector)
    found = rotation_vector(rotation)
    np.testing.assert_allclose(exponential(found), rotation, atol=4e-15)
    np.testing.assert_allclose(found, Rotation.from_matrix(rotation).as_rotvec(), rtol=4e-15, atol=4e-15)


@given(vectors)
def test_exponential_is_a_rotation(vector):
    rotation = exponential(vector)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=2e-15)
    np.testing.assert_allclose(np.linalg.det(rotation), 1.0, atol=2e-15)
    np.testing.assert_allclose(rotation @ vector, vector, atol=4e-15)


@given(vectors.filter(lambda vector: np.linalg.norm(vector) < 2.9), directions)
def test_rate_is_the_derivative(vector, direction):
    step = 1e-30
    moved = logarithm(exponential(1j * step * direction) @ exponential(vector))
    np.testing.assert_allclose(moved.imag / step, logarithm_rate(vector) @ direction, rtol=1e-10, atol=1e-11)


@given(st.floats(1e-3, 1e-1), directions)
def test_series_and_closed_form_meet(angle, direction):
    """Across the switch from series to closed form nothing jumps: turning in two halves is turning once."""
    half = exponential(0.5 * angle * direction)
    np.testing.assert_allclose(half @ half, exponential(angle * direction), atol=1e-15)


def test_batch_is_the_loop():
    vectors_ = np.random.default_rng(1).normal(size=(3, 2, 3))
    looped = np.array([[exponential(vector) for vector in row] for row in vectors_])
    np.testing.assert_array_equal(exponential(vectors_), looped)
    np.testing.assert_allclose(logarithm(looped), [[logarithm(item) for item in row] for row in looped], rtol=1e-14)


@given(st.floats(0.0, np.pi), st.floats(-np.pi, np.pi))
def test_parts_lie_flat_unless_they_stand(tilt, azimuth):
    """Without a stated z axis a part's is the stage's made perpendicular; within 5 degrees of upright it is the stage's y axis."""
    along = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])
    stage = np.array([0.0, 1.0, 0.0] if min(tilt, np.pi - tilt) < np.deg2rad(5.0) else [0.0, 0.0, 1.0])
    found = axes(along)
    np.testing.assert_allclose(found.T @ found, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(found[:, 0], along, atol=1e-14)
    assert abs(found[:, 1] @ stage) < 1e-13
    assert found[:, 2] @ stage > 0.0
    assert np.linalg.det(found) > 0.0


@pytest.mark.parametrize(("degrees", "upright"), [(0.01, True), (4.99, True), (5.01, False), (15.0, False), (24.0, False)])
def test_upright_ends_at_five_degrees(degrees, upright):
    for azimuth in (0.3, 1.9, -2.5):
        tilt = np.deg2rad(degrees)
        found = axes(np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)]))
        assert bool(abs(found[1, 1]) < 1e-13) == upright
        assert bool(abs(found[2, 1]) < 1e-13) != upright
