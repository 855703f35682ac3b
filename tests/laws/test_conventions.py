"""One test per line of docs/conventions.md."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.cases.double_triangle import SM_REF_B, double_triangle
from flexstage.mechanism.expand import expand
from flexstage.readings.linear.static import static_gain
from flexstage.spatial.frame import COMPONENTS, transport


@pytest.fixture(scope="module")
def stage() -> fs.Mechanism:
    return double_triangle(SM_REF_B)


@pytest.fixture(scope="module")
def model(stage: fs.Mechanism) -> fs.LinearModel:
    return fs.lumped(stage)


def test_component_order() -> None:
    assert COMPONENTS == ("x", "y", "z", "rx", "ry", "rz")


def test_change_of_point() -> None:
    arm, twist = np.array([0.1, -0.2, 0.3]), np.arange(1.0, 7.0)
    moved = transport(arm) @ twist
    np.testing.assert_allclose(moved[:3], twist[:3] + np.cross(twist[3:], arm))
    wrench = np.arange(6.0, 0.0, -1.0)
    assert wrench @ moved == pytest.approx((transport(arm).T @ wrench) @ twist)


def test_platform_twist_is_given_at_its_own_centre_of_mass(stage: fs.Mechanism) -> None:
    loaded = replace(stage, payloads={"wafer": fs.Payload("platform", 2.0, (0.05, 0.0, 0.2))})
    for case in (stage, loaded):
        np.testing.assert_allclose(expand(case).bodies["platform"].reference, [0.0, 0.0, 0.105], atol=1e-12)


def test_a_notch_bends_about_its_z_axis(stage: fs.Mechanism) -> None:
    pivot = expand(stage).links["B4/pivot"]
    assert [freedom.value for freedom in pivot.part.intended] == ["rz"]
    unit = expand(stage).links["B4/pzt"].frame
    np.testing.assert_allclose(pivot.frame.rotation[:, 0], unit.rotation[:, 0], atol=1e-12)
    assert abs(pivot.frame.rotation[2, 2]) < 1e-12


def test_relative_twist_is_second_against_first(stage: fs.Mechanism) -> None:
    """A stack that expands pushes its second body (the tip) away from its first (the base)."""
    kinematics = fs.ideal(stage)
    assert kinematics.strains["B1/pzt"][0, 0] == pytest.approx(kinematics.mapping.at("B1", "x"))


def test_positive_stroke_expands_and_pushes_the_platform_along_facing(model: fs.LinearModel) -> None:
    assert static_gain(model, ("platform.x",), ("B1",)).values[0, 0] > 0.0
    assert static_gain(model, ("platform.z",), ("B4",)).values[0, 0] > 0.0


def test_gauge_grows_as_the_gap_opens(stage: fs.Mechanism) -> None:
    opens = fs.ideal(stage).gauge_mapping
    assert opens.at("S4", "z") == pytest.approx(1.0)
    closing = {name: replace(probe, positive=fs.Positive.CLOSES) for name, probe in stage.gauges.items()}
    np.testing.assert_allclose(fs.ideal(replace(stage, gauges=closing)).gauge_mapping.values, -opens.values)


def test_amplified_rows_of_the_mapping_carry_one_over_the_amplification(stage: fs.Mechanism) -> None:
    assert fs.ideal(stage).mapping.at("B4", "z") == pytest.approx(1.0 / 3.0)


def test_loss_is_one_minus_transfer(stage: fs.Mechanism, model: fs.LinearModel) -> None:
    result = fs.lost_motion(fs.ideal(stage), model)
    np.testing.assert_allclose(result.loss.values, np.eye(6) - fs.ideal(stage).mapping.values @ result.gain.values, atol=1e-14)


def test_modes_are_mass_normalised_and_ascend(model: fs.LinearModel) -> None:
    modes = fs.modes(model)
    lowest = modes.shapes[:, :12]
    np.testing.assert_allclose(lowest.T @ model.inertia_matrix @ lowest, np.eye(12), atol=1e-9)
    assert np.all(np.diff(modes.frequencies) >= -1e-6)


def test_position_angle_and_push_direction(stage: fs.Mechanism) -> None:
    """B1 sits at -90 degrees and pushes along +x, 90 degrees further."""
    frame = expand(stage).links["B1/pzt"].frame
    assert frame.position[1] == pytest.approx(-0.085)
    np.testing.assert_allclose(frame.rotation[:, 0], [1.0, 0.0, 0.0], atol=1e-12)
