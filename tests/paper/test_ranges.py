"""Strokes, ranges and limits of the paper's stage (reference.md A1, A5, A6, A7)."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.analysis.assessment.judge import judge
from flexstage.analysis.workspace.blocking import stack_lines
from flexstage.analysis.workspace.clearance import clearance
from flexstage.analysis.workspace.drive import drive
from flexstage.analysis.workspace.gauging import gauge_inverse, gauge_range, pose_resolution
from flexstage.analysis.workspace.load import load_share
from flexstage.analysis.workspace.map_error import linear_map_error
from flexstage.analysis.workspace.polytope import reachable
from flexstage.analysis.workspace.strength import hinge_stress
from flexstage.analysis.workspace.stroke import single_axis, stacks, stroke_limits, utilisation
from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, double_triangle
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped

STATED = {"x": 50e-6, "y": 50e-6, "z": 150e-6, "rx": 733e-6, "ry": 733e-6, "rz": 244e-6}


@pytest.fixture(scope="module", params=[SM_REF_A, SM_REF_B], ids=["A", "B"])
def stage(request):
    return double_triangle(request.param)


def test_single_axis_limits_of_set_a():
    mechanism = double_triangle(SM_REF_A)
    found = single_axis(ideal(mechanism).mapping, stroke_limits(mechanism)).symmetric
    np.testing.assert_allclose(1e6 * found, [75.0, 86.6, 300.0, 2308.0, 2665.0, 882.0], rtol=0.0, atol=0.5)


def test_single_axis_limits_of_set_b(stage):
    """The stated strokes are a part of what the stacks give, one axis at a time."""
    found = single_axis(ideal(stage).mapping, stroke_limits(stage))
    np.testing.assert_allclose(1e6 * found.symmetric[[0, 1, 2, 5]], [75.0, 86.6, 300.0, 882.35], rtol=0.0, atol=0.01)
    assert np.all(found.symmetric >= [STATED[name] for name in found.coordinates])
    np.testing.assert_allclose(found.table.values[:, 3], 2.0 * found.symmetric)


def test_stroke_use_of_the_rotations_of_set_a():
    """244 urad of yaw take 20.8 um; 733 urad of tilt move the first tip by 95.3 um, 31.8 um at its actuator."""
    mapping = ideal(double_triangle(SM_REF_A)).mapping
    assert 1e6 * mapping.at("B1", "rz") * 244.35e-6 == pytest.approx(20.8, abs=0.05)
    assert 1e6 * mapping.at("B4", "rx") * 733.04e-6 == pytest.approx(31.8, abs=0.05)
    assert 3e6 * mapping.at("B4", "rx") * 733.04e-6 == pytest.approx(95.3, abs=0.05)


def test_the_simultaneous_corner_cannot_be_reached(stage):
    """x, y 50 um and yaw 244 urad at once need 89 of 75 um (A7): the stated strokes are single-axis."""
    kinematics, limits = ideal(stage), stroke_limits(stage)
    corner = {name: STATED[name] for name in ("x", "y", "rz")}
    found = utilisation(kinematics.mapping, limits, corner)
    assert 1e6 * np.max(found.demand) == pytest.approx(89.0, abs=0.1)
    np.testing.assert_allclose(1e6 * found.available, [75, 75, 75, 100, 100, 100])
    assert not found.reachable
    worst = np.array([-50e-6, -50e-6, 0.0, 0.0, 0.0, -244e-6])
    worst = np.where(kinematics.mapping.values[1] < 0.0, np.abs(worst), -np.abs(worst))
    assert not reachable(kinematics.mapping, limits).contains(worst)
    assert reachable(kinematics.mapping, limits).contains(worst * found.scale)


def test_gauge_ranges(stage):
    """z +-150 um fits 500 um alone; with one tilt inside 136.4 mm radius; with both never beyond 96 mm."""
    kinematics = ideal(stage)
    upright = slice(3, 6)
    alone = gauge_range(stage, kinematics, {"z": STATED["z"]})
    assert np.all(alone.fits[upright])
    assert np.all(np.isinf(alone.largest_anywhere[upright]))
    one = gauge_range(stage, kinematics, {"z": 150e-6, "rx": 733.04e-6})
    assert 1e3 * np.min(one.largest_anywhere[upright]) == pytest.approx(136.4, abs=0.05)
    two = gauge_range(stage, kinematics, {"z": 150e-6, "rx": 733.04e-6, "ry": 733.04e-6})
    assert 96.0 < 1e3 * np.min(two.largest_anywhere[upright]) < 97.0
    assert not np.all(two.fits[upright])


def test_gauge_inverse_of_set_a():
    """R_s^-1 of A5 row by row."""
    found = gauge_inverse(ideal(double_triangle(SM_REF_A))).values
    third, root = 1.0 / 3.0, 1.0 / np.sqrt(3.0)
    np.testing.assert_allclose(found[0, :3], [2 * third, -third, -third], atol=1e-9)
    np.testing.assert_allclose(found[1, :3], [0.0, root, -root], atol=1e-9)
    np.testing.assert_allclose(found[2, 3:], [third] * 3, atol=1e-9)
    np.testing.assert_allclose(found[3, 3:], [4.4444, -2.2222, -2.2222], atol=5e-5)
    np.testing.assert_allclose(found[4, 3:], [0.0, 3.8490, -3.8490], atol=5e-5)
    np.testing.assert_allclose(found[5, :3], [2.2222] * 3, atol=5e-5)


def test_pose_resolution_of_set_a():
    """10 nm gauges: z and yaw by hand from R_s^-1."""
    found = pose_resolution(double_triangle(SM_REF_A), ideal(double_triangle(SM_REF_A)))
    assert 1e9 * found.worst[2] == pytest.approx(10.0)
    assert 1e9 * found.rms[2] == pytest.approx(10.0 / np.sqrt(3.0))
    assert 1e9 * found.worst[5] == pytest.approx(10.0 / 0.15)
    assert np.all(np.isnan(found.noise))


def test_stacks(stage):
    """Blocking force = stroke x stiffness, 2550 and 7000 N, below the maximum load; 0.15 and 0.2 um/V."""
    found = stack_lines(stage, lumped(stage))
    np.testing.assert_allclose(found.blocking, [2550.0] * 3 + [7000.0] * 3)
    limits = [piezo.maximum_load for piezo in stacks(stage).values()]
    assert np.all(found.blocking < limits)
    assert np.all(found.force < 0.1 * found.blocking)
    np.testing.assert_allclose(1e6 * drive(stage).gain, [0.15] * 3 + [0.2] * 3)


def test_hinges_bear_the_whole_stroke(stage):
    """At the full 200 um of the stacks (600 um tips) every hinge stays far below the yield stress of 1360 MPa (A1 item 4)."""
    found = hinge_stress(stage, lumped(stage), stroke_limits(stage).from_zero)
    assert not found.unknown
    assert found.min_safety > 2.0
    pivot = found.links.index("B4/pivot")
    assert 250e6 < found.nominal[pivot] < 550e6
    assert found.weakest.split("/")[1] in {"pivot", "lower"}


def test_lever_hinge_stress_of_set_a_is_that_of_its_rotation():
    """345 MPa in A1 is the lever hinge turned by 200 um / r1 without lost motion; the model's tips lose 3 % and more."""
    stage = double_triangle(SM_REF_A)
    found = hinge_stress(stage, lumped(stage), stroke_limits(stage).from_zero)
    stiffness, section = 389.611, 0.06 * 0.001**2 / 6.0
    assert stiffness * 200e-6 / 0.0226 / section == pytest.approx(345e6, rel=0.002)
    assert found.nominal[found.links.index("B4/pivot")] == pytest.approx(345e6, rel=0.05)


def test_the_shipped_stage_fits_its_envelope_and_opening():
    assert clearance(double_triangle(SM_REF_B)).findings == ()


def test_the_calculation_set_cannot_be_built():
    """A5: set A neither fits the envelope nor leaves the opening clear."""
    told = [finding.where for finding in clearance(double_triangle(SM_REF_A)).findings]
    assert "envelope.y" in told
    assert any(name.startswith("B") for name in told)


def test_dead_weight_is_a_small_load():
    """Three levers of 3 : 1 carry the platform: a third of its weight each at the pole, three times that at the stack."""
    stage = double_triangle(SM_REF_B)
    found = load_share(stage, lumped(stage))
    assert np.sum(found.share.values[3:, 2]) == pytest.approx(-3.0 * 0.969, rel=0.01)
    assert np.all(found.usage(found.range(stroke_limits(stage).from_zero)[1]) < 0.05)
    assert np.ptp(found.compression[3:]) < 1e-6


def test_map_error_over_the_workspace():
    """Yaw errs most: three direct units at 85 mm turn their lines of action; under 3 urad for the whole box."""
    stage = double_triangle(SM_REF_B)
    found = linear_map_error(stage, ideal(stage), stroke_limits(stage))
    assert found.residual < 1e-15
    assert np.all(found.worst[:3] < 0.5e-6)
    assert np.argmax(found.worst[3:]) == 2
    assert found.worst[5] < 3e-6


def test_the_shipped_requirements_hold():
    """The paper's strokes, 100 Hz and a safety of 2 are met by the shipped stage."""
    for verdict in judge(double_triangle(SM_REF_B)):
        assert bool(verdict.passed), verdict.requirement.key
