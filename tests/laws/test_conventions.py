"""One test per line of docs/conventions.md."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.linear_statics.statics import directional
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import SM_REF_B, double_triangle
from flexstage.mechanism.addresses.address import get
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import Polar
from flexstage.mechanism.mechanism import ModalDamping, RayleighDamping, StructuralDamping
from flexstage.models.linear.eigen import sign_weights, solve
from flexstage.models.linear.static import static_gain
from flexstage.spatial.frame import COMPONENTS, transport


@pytest.fixture(scope="module")
def stage() -> fs.Mechanism:
    return double_triangle(SM_REF_B)


@pytest.fixture(scope="module")
def model(stage: fs.Mechanism) -> fs.LinearModel:
    return fs.lumped(stage)


def test_units_are_si_inside_and_stated_at_the_border(stage: fs.Mechanism) -> None:
    before, after = fs.dumps(stage).split("[parts.neck]")
    stated = re.compile(r'thickness = "[^"]* mm"')
    written = (before + "[parts.neck]" + stated.sub(new, after, count=1) for new in ('thickness = "1500 um"', "thickness = 1.5e-3"))
    assert get(fs.loads(next(written)), "parts.neck.thickness") == pytest.approx(1.5e-3, rel=1e-15)
    with pytest.raises(DesignError, match="thickness"):
        fs.loads(next(written))


def test_position_angles_count_from_x_towards_y(stage: fs.Mechanism) -> None:
    """30 degrees is 0.5236 inside, and lies at (cos, sin)."""
    turned = replace(stage, gauges={"S": replace(stage.gauges["S1-S3"], pattern=replace(_polar(stage), first=np.deg2rad(30.0)))})
    found = expand(turned).gauges["S"].sights[0].frame.position
    np.testing.assert_allclose(found[:2] / _polar(stage).radius, [np.sqrt(0.75), 0.5], atol=1e-12)


def _polar(stage: fs.Mechanism) -> Polar:
    pattern = stage.gauges["S1-S3"].pattern
    assert isinstance(pattern, Polar)
    return pattern


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
    closing = {name: replace(probe, positive=fs.SensorSense.CLOSES) for name, probe in stage.gauges.items()}
    np.testing.assert_allclose(fs.ideal(replace(stage, gauges=closing)).gauge_mapping.values, -opens.values)


def test_gauge_rows_are_readings_over_platform_coordinates(stage: fs.Mechanism) -> None:
    """R_s = ds/dx: the motion at the gauge, along its axis, of a platform that moves by a unit of one coordinate."""
    mapping, reference = fs.ideal(stage).gauge_mapping, expand(stage).bodies["platform"].reference
    assert (mapping.rows, mapping.columns) == (tuple(expand(stage).gauges), COMPONENTS)
    for row, gauge in enumerate(expand(stage).gauges.values()):
        moved = transport(gauge.sights[0].frame.position - reference)[:3]
        np.testing.assert_allclose(mapping.values[row], gauge.sights[0].frame.rotation[:, 0] @ moved, atol=1e-12)


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


def test_the_largest_component_of_a_shape_is_positive_an_angle_as_a_tenth_of_a_metre(model: fs.LinearModel) -> None:
    """0.5 m outweighs -1 rad, 0.05 m does not; and so do the stage's own shapes where they do not repeat."""
    for first, second in ((0.5, -1.0), (0.05, -1.0)):
        shapes = np.array([[first, 1.0], [second, 1.0]])
        inverse = np.linalg.inv(shapes)
        found = solve(inverse.T @ np.diag([1.0, 4.0]) @ inverse, inverse.T @ inverse, sign_weights(("arm.x", "arm.rz"))).shapes[:, 0]
        np.testing.assert_allclose(found, [first, second] if first > 0.1 else [-first, -second], atol=1e-12)
    modes = fs.modes(model)
    length = np.array([0.1 if name.split(".")[-1] in {"rx", "ry", "rz"} else 1.0 for name in modes.coordinates])
    alone = [index for index in (2, 3) if min(abs(modes.frequencies[index] - modes.frequencies[[index - 1, index + 1]])) > 1.0]
    assert alone == [2, 3]
    for index in alone:
        sized = length * modes.shapes[:, index]
        assert np.max(sized) >= (1.0 - 1e-6) * np.max(np.abs(sized))


def test_damped_responses_lag(model: fs.LinearModel) -> None:
    """e^{+j omega t}: what moves where it is pushed follows, Im H < 0."""
    for law in (ModalDamping(0.01), RayleighDamping(1.0, 1e-6), StructuralDamping()):
        found = fs.response(model, ("platform.x",), ("platform.fx",), np.array([1.0, 100.0, 173.0, 400.0]), damping=law)
        assert np.all(np.imag(found.values) < 0.0)


def test_responses_are_output_over_input(model: fs.LinearModel) -> None:
    outputs, inputs = ("platform.x", "S4"), ("B1", "B4", "platform.fz")
    found = fs.response(model, outputs, inputs, np.array([0.0]), damping=ModalDamping(0.01))
    assert found.values.shape == (1, 2, 3)
    np.testing.assert_allclose(np.real(found.values[0]), static_gain(model, outputs, inputs).values, rtol=1e-6, atol=1e-9)


def test_damping_is_stated_or_refused(stage: fs.Mechanism) -> None:
    bare = fs.lumped(replace(stage, damping=None))
    with pytest.raises(DesignError, match="damping"):
        fs.response(bare, ("platform.x",), ("platform.fx",), np.array([10.0]))


def test_position_angle_and_push_direction(stage: fs.Mechanism) -> None:
    """B1 sits at -90 degrees and pushes along +x, 90 degrees further."""
    frame = expand(stage).links["B1/pzt"].frame
    assert frame.position[1] == pytest.approx(-0.085)
    np.testing.assert_allclose(frame.rotation[:, 0], [1.0, 0.0, 0.0], atol=1e-12)


def test_stiffness_along_a_direction_is_force_over_displacement() -> None:
    """Springs of 1 and 4 under a force at 45 degrees: 1 / (0.5/1 + 0.5/4), not their mean."""
    found = directional(np.diag([1.0, 4.0]))
    np.testing.assert_allclose(found.along(np.array([0.0, 0.25, 0.5]) * np.pi), [1.0, 1.6, 4.0], rtol=1e-12)
    assert found.angle == pytest.approx(0.5 * np.pi)


def test_strain_energy_of_a_stroke_is_half_its_force(stage: fs.Mechanism, model: fs.LinearModel) -> None:
    """A stack k whose base and tip the stage moves by c per unit force strains by u (1 - k c): U = k u^2 (1 - k c) / 2."""
    energy = fs.lost_motion(fs.ideal(stage), model).energy
    for number, name in enumerate(energy.columns):
        own = model.stiffness[f"{name}/pzt"].law[0, 0]
        force = model.input_matrix[:, model.input_index((name,))[0]]
        expected = 0.5 * (own - force @ np.linalg.solve(model.stiffness_matrix, force))
        assert np.sum(energy.values[:, number]) == pytest.approx(expected, rel=1e-6)


def test_parasitic_motion_is_what_the_stage_does_beside_the_ideal_one() -> None:
    """Of a guide along x, all motion in the other coordinates, with its sign."""
    guide = fs.case("parallelogram")
    found = fs.lost_motion(fs.ideal(guide), fs.lumped(guide))
    assert fs.ideal(guide).coordinates == ("x",)
    others = found.gain.values[1:]
    assert np.max(np.abs(others)) > 1e-9
    np.testing.assert_allclose(found.parasitic.values[1:], others, rtol=1e-9, atol=1e-15)
