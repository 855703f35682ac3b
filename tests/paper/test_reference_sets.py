"""SM-REF-A and SM-REF-B: mappings, stiffness and frequencies of the mapped model (reference values to five digits)."""

from __future__ import annotations

import numpy as np
import pytest

import flexstage as fs
from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, double_triangle
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.restrict import isolate
from flexstage.models.mapped import lever_stiffness, unit_stiffness

THIRD = 1.0 / 3.0
COSINE = np.sqrt(3.0) / 2.0
A_MAPPING = np.array(
    [
        [1, 0, 0, 0, 0, 0.085],
        [-0.5, COSINE, 0, 0, 0, 0.085],
        [-0.5, -COSINE, 0, 0, 0, 0.085],
        [0, 0, THIRD, 0.13 / 3, 0, 0],
        [0, 0, THIRD, -0.065 / 3, 0.0375278, 0],
        [0, 0, THIRD, -0.065 / 3, -0.0375278, 0],
    ]
)
B_MAPPING = np.array(
    [
        [1, 0, 0, 0, -0.025, 0.085],
        [-0.5, COSINE, 0, 0.0216506, 0.0125, 0.085],
        [-0.5, -COSINE, 0, -0.0216506, 0.0125, 0.085],
        [0, 0, THIRD, 0.04, 0, 0],
        [0, 0, THIRD, -0.02, 0.034641, 0],
        [0, 0, THIRD, -0.02, -0.034641, 0],
    ]
)
A_FREQUENCIES = [123.473, 123.473, 131.435, 145.507, 167.215, 167.215]
B_FREQUENCIES = [110.910, 110.910, 135.148, 145.505, 176.690, 176.690]
A_STIFFNESS = [15.4501e6, 15.4501e6, 9.54559e6, 80660.3, 80660.3, 223254.0]
B_STIFFNESS = [15.4499e6, 15.4499e6, 10.09255e6, 82322.5, 82322.5, 223250.0]


@pytest.mark.parametrize(("parameters", "mapping", "determinant"), [(SM_REF_A, A_MAPPING, -3.59125e-4), (SM_REF_B, B_MAPPING, -3.0600e-4)])
def test_actuator_mapping(parameters: str, mapping: np.ndarray, determinant: float) -> None:
    found = fs.ideal(double_triangle(parameters)).mapping.values
    np.testing.assert_allclose(found, mapping, atol=1e-7)
    assert np.linalg.det(found) == pytest.approx(determinant, rel=1e-5)


@pytest.mark.parametrize(
    ("parameters", "determinant", "radius", "height"), [(SM_REF_A, -0.02278125, 0.15, 0.0), (SM_REF_B, -0.01482975, 0.13, 0.08)]
)
def test_gauge_mapping(parameters: str, determinant: float, radius: float, height: float) -> None:
    stage = double_triangle(parameters)
    kinematics = fs.ideal(stage)
    sensing = kinematics.gauge_mapping.values
    assert np.linalg.det(sensing) == pytest.approx(determinant, rel=1e-5)
    np.testing.assert_allclose(sensing[3], [0, 0, 1, radius, 0, 0], atol=1e-12)
    np.testing.assert_allclose(sensing[4, 2:5], [1, -radius / 2, radius * COSINE], atol=1e-12)
    depth = expand(stage).bodies["platform"].reference[2] - height
    np.testing.assert_allclose(sensing[0], [1, 0, 0, 0, -depth, radius], atol=1e-12)


@pytest.mark.parametrize(("parameters", "height"), [(SM_REF_A, 0.0), (SM_REF_B, 0.105)])
def test_the_platform_weighs_the_same_with_its_lugs(parameters: str, height: float) -> None:
    mass = expand(double_triangle(parameters)).bodies["platform"].mass
    assert mass is not None
    assert mass.mass == pytest.approx(13.9965, rel=1e-6)
    np.testing.assert_allclose(mass.centre, [0.0, 0.0, height], atol=1e-9)
    np.testing.assert_allclose(np.diag(mass.inertia), [0.134016, 0.134016, 0.267100], rtol=4e-6)
    np.testing.assert_allclose(mass.inertia, np.diag(np.diag(mass.inertia)), atol=1e-12)


def test_inverse_gauge_mapping_of_set_a() -> None:
    inverse = np.linalg.inv(fs.ideal(double_triangle(SM_REF_A)).gauge_mapping.values)
    expected = np.zeros((6, 6))
    expected[0, :3] = np.array([2, -1, -1]) / 3
    expected[1, :3] = np.array([0, 1, -1]) / np.sqrt(3)
    expected[2, 3:] = 1 / 3
    expected[3, 3:] = [4.4444, -2.2222, -2.2222]
    expected[4, 3:] = [0, 3.8490, -3.8490]
    expected[5, :3] = 2.2222
    np.testing.assert_allclose(inverse, expected, atol=5e-5)


@pytest.mark.parametrize(("parameters", "diagonal"), [(SM_REF_A, A_STIFFNESS), (SM_REF_B, B_STIFFNESS)])
def test_mapped_stiffness(parameters: str, diagonal: list[float]) -> None:
    stiffness = fs.mapped(double_triangle(parameters)).stiffness_matrix
    np.testing.assert_allclose(np.diag(stiffness), diagonal, rtol=1e-5)
    coupling = -386246.0 if parameters is SM_REF_B else 0.0
    np.testing.assert_allclose([stiffness[0, 4], -stiffness[1, 3]], coupling, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize(("parameters", "expected"), [(SM_REF_A, A_FREQUENCIES), (SM_REF_B, B_FREQUENCIES)])
def test_mapped_frequencies_out_of_plane_first(parameters: str, expected: list[float]) -> None:
    modes = fs.modes(fs.mapped(double_triangle(parameters)))
    np.testing.assert_allclose(modes.frequencies, expected, rtol=1e-5)
    assert modes.names[:4] == ("tilt", "tilt", "z", "yaw")
    assert sorted(modes.names[4:]) == ["x", "y"]
    assert modes.in_plane == (False, False, False, True, True, True)


@pytest.mark.parametrize(
    ("parameters", "drive", "pole", "tip", "output", "pivot"),
    [(SM_REF_A, 29.788e6, 50.79e6, 3.1819e6, 28.637e6, 389.611), (SM_REF_B, 30.996e6, 70.659e6, 3.3642e6, 30.2776e6, 537.548)],
)
def test_springs_of_the_vertical_unit(parameters: str, drive: float, pole: float, tip: float, output: float, pivot: float) -> None:
    assembly = expand(double_triangle(parameters))
    springs = lever_stiffness(assembly, "B4/pzt")
    assert springs.drive == pytest.approx(drive, rel=2e-5)
    assert springs.pole == pytest.approx(pole, rel=1e-4)
    assert springs.pivot == pytest.approx(pivot, rel=1e-5)
    assert 1.0 / springs.tip_compliance == pytest.approx(tip, rel=2e-5)
    assert springs.stiffness == pytest.approx(output, rel=2e-5)


@pytest.mark.parametrize("parameters", [SM_REF_A, SM_REF_B])
def test_unit_stiffness_of_the_horizontal_unit(parameters: str) -> None:
    stage = double_triangle(parameters)
    assert unit_stiffness(stage, expand(stage))["B1"] == pytest.approx(10.300e6, rel=5e-5)
    alone = fs.statics(fs.lumped(isolate(stage, "B1"))).stiffness.values
    assert alone[0, 0] == pytest.approx(10.300e6, rel=5e-5)
    assert alone[1, 1] == pytest.approx(0.00120e6, abs=0.000005e6)
