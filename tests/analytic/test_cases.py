"""The shipped cases' kinematics and simple stiffnesses by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.assessment.judge import judge
from flexstage.base.finding import DesignError
from flexstage.base.units.scale import GPa, deg, mm
from flexstage.beams.compliance import compliance
from flexstage.cases.registry import case
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.leaf import LeafSection
from tests.stock import ALUMINIUM, STEEL


def number(stage, name):
    """A named number of a stage [SI]."""
    return stage.numbers[name].value


def test_parallelogram_moves_along_x_as_its_stack_does():
    found = ideal(case("parallelogram"))
    assert found.coordinates == ("x",)
    np.testing.assert_allclose(found.actuation, [[1.0]], atol=1e-12)
    np.testing.assert_allclose(found.motion[:, 0], [1.0, 0, 0, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(found.sensing, [[1.0, 0, 0, 0, 0, 0]], atol=1e-12)
    assert [set(item.constraints) for item in found.redundant] == [{"left.ry", "right.ry"}]
    assert [item.bodies for item in found.idle] == [("B/base", "B/tip")]


def _strut_stiffness(stage):
    """A stack between two necks in series [N/m]."""
    return 1.0 / (1.0 / stage.parts["stack"].stiffness + 2.0 * compliance(stage.parts["neck"], STEEL)[0, 0])


def test_parallelogram_gain_is_that_of_two_springs_in_series():
    """1 - gain = k_g / (k + k_g), k that of the strut, k_g that of two leaves, where the platform does not yaw; here it does."""
    stage = case("parallelogram")
    found = static_gain(lumped(stage), ("platform.x",), ("B",)).values[0, 0]
    guide = 2.0 / compliance(stage.parts["leaf"], ALUMINIUM)[1, 1]
    expected = guide / (_strut_stiffness(stage) + guide)
    assert 1.0 - found == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("driven", [1, 2])
def test_xy_stage_axes_are_independent(driven):
    found = ideal(case("xy-stage" if driven == 2 else "xy-stage-floating"))
    assert found.coordinates == ("x", "y")
    np.testing.assert_allclose(found.actuation, np.eye(2)[:driven], atol=1e-12)
    np.testing.assert_allclose(found.motion, np.eye(6)[:, :2], atol=1e-12)
    assert found.actuated is (driven == 2)


def test_xy_stage_is_held_four_times():
    """A carriage on 4 leaves: 12 constraints for 5 freedoms; 2 coupling leaves: 6 for 5; the platform: 4 freedoms by 4 carriages."""
    assert len(ideal(case("xy-stage")).redundant) == 4 * (12 - 5) + 4 * (6 - 5) + 4 * 4 - 4


def test_an_under_actuated_stage_has_no_mapping():
    with pytest.raises(DesignError, match="1 stroke does not determine the platform's 2 ideal motions"):
        _ = ideal(case("xy-stage-floating")).mapping


def test_bridge_amplifies_by_the_cotangent():
    for angle in (2.0, 6.0, 10.0):
        found = ideal(case("bridge", {"angle": angle * deg}))
        assert found.coordinates == ("y",)
        np.testing.assert_allclose(found.actuation, [[-math.tan(math.radians(angle))]], rtol=1e-9)
        np.testing.assert_allclose(found.motion[:, 0], [0, 1.0, 0, 0, 0, 0], atol=1e-9)


def bridge_gain(across, axial, angle):
    """R = s c (c_t - c_a)/(c^2 c_a + s^2 c_t) of a quarter link between guided ends (Lobontiu & Garcia 2003; Ling et al. 2016)."""
    sine, cosine = math.sin(angle), math.cos(angle)
    return sine * cosine * (across - axial) / (cosine**2 * axial + sine**2 * across)


def _free_bridge(angle):
    """The worked example of reference B11: E = 70 GPa, leaves 5 x 0.5 x 10 mm, bars of 20 mm, and no guide stiffness."""
    sizes = {"leaf": 5 * mm, "leaf_thickness": 0.5 * mm, "rod": 20 * mm, "half_span": 40 * mm}
    material = replace(ALUMINIUM, young=70 * GPa)
    stage = case("bridge", {**sizes, "angle": angle})
    parts = {**stage.parts, "guide": Joint((Freedom.Y,))}
    return material, replace(stage, parts=parts, materials={"aluminium": material})


def _measured_gain(stage):
    """Platform motion over the spread of the two ends."""
    moved = static_gain(lumped(stage), ("platform.y", "left.x", "right.x"), ("pzt",)).values[:, 0]
    return -moved[0] / (moved[2] - moved[1])


@pytest.mark.parametrize("angle", [1.0, 3.0, 6.0, 10.0])
def test_bridge_gain_is_the_closed_form_with_the_leaves_own_compliances(angle):
    material, stage = _free_bridge(angle * deg)
    leaf = compliance(stage.parts["leaf"], material)
    arm = 0.5 * (number(stage, "rod") + number(stage, "leaf"))
    across, axial = 2.0 * (leaf[1, 1] + arm**2 * leaf[5, 5]), 2.0 * leaf[0, 0]
    assert _measured_gain(stage) == pytest.approx(bridge_gain(across, axial, angle * deg), rel=1e-7)


@pytest.mark.parametrize(("angle", "published"), [(1.0, 40.0056), (3.0, 18.2064), (6.0, 9.401136), (10.0, 5.6466)])
def test_bridge_gain_of_reference_b11(angle, published):
    """The published values are Euler-Bernoulli; leaves here have shear and plate action, which makes them up to 10 % stiffer across."""
    _, stage = _free_bridge(angle * deg)
    ideal_gain = 1.0 / math.tan(math.radians(angle))
    assert _measured_gain(stage) == pytest.approx(published, rel=0.1 * (ideal_gain - published) / published)


def test_hexapod_rows_are_direction_and_moment():
    stage = case("hexapod")
    rise, thickness, slope, radius, gap = (number(stage, name) for name in ("rise", "thickness", "slope", "head_radius", "gap"))
    found = ideal(stage)
    assert found.coordinates == ("x", "y", "z", "rx", "ry", "rz")
    centre = np.array([0.0, 0.0, rise + 0.5 * thickness])
    expected = []
    for side in (1.0, -1.0):
        for place in (90.0, 210.0, 330.0):
            turn = math.radians(place)
            outward, tangent = np.array([math.cos(turn), math.sin(turn), 0]), np.array([-math.sin(turn), math.cos(turn), 0])
            direction = -side * math.cos(slope) * tangent + np.array([0, 0, math.sin(slope)])
            head = radius * outward + 0.5 * side * gap * tangent
            expected.append([*direction, *np.cross(head - centre, direction)])
    np.testing.assert_allclose(found.mapping.values, expected, atol=1e-12)
    assert found.redundant == ()
    assert [item.bodies for item in found.idle] == [(f"{name}/base", f"{name}/tip") for name in found.actuators]


def test_hexapod_stiffness_is_that_of_its_struts():
    """K = R_a^T k R_a, axial springs; the necks' bending adds less than 2 %."""
    stage = case("hexapod")
    rows = ideal(stage).mapping.values
    axial = _strut_stiffness(stage) * rows.T @ rows
    model = lumped(stage)
    wrench = tuple(f"platform.{name}" for name in ("fx", "fy", "fz", "mx", "my", "mz"))
    full = np.linalg.inv(static_gain(model, tuple(f"platform.{name}" for name in ("x", "y", "z", "rx", "ry", "rz")), wrench).values)
    ratio = np.diag(full) / np.diag(axial)
    assert np.all((ratio > 1.0) & (ratio < 1.02))


@pytest.mark.parametrize("posts", [3, 4])
def test_tip_tilt_rows_are_lever_arms(posts):
    stage = case("tip-tilt" if posts == 3 else "tip-tilt-four")
    found, radius = ideal(stage), number(stage, "post_radius")
    assert found.coordinates == ("z", "rx", "ry")
    places = np.radians(90.0 + 360.0 / posts * np.arange(posts))
    expected = np.stack([np.ones(posts), radius * np.sin(places), -radius * np.cos(places)], axis=1)
    np.testing.assert_allclose(found.mapping.values, expected, atol=1e-12)
    assert len(found.redundant) == 6
    assert len(found.idle) == posts


def test_redundant_posts_share_a_command():
    """Four strokes for three freedoms: da = R_a dx is reached exactly, opposite pairs against one another not at all."""
    found = ideal(case("tip-tilt-four"))
    np.testing.assert_allclose(found.inverse @ found.actuation, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(found.inverse @ np.array([1.0, -1.0, 1.0, -1.0]), 0.0, atol=1e-12)


def test_piston_frequency_is_that_of_three_struts():
    """f = (3 k / m)^(1/2) / 2 pi without the struts' own masses; with them at most 10 % lower, leaves and necks add less than 2 %."""
    stage = case("tip-tilt")
    discs = [number(stage, name) ** 2 * number(stage, f"{name}_thickness") for name in ("holder", "mirror")]
    mass = math.pi / 4.0 * (discs[0] * ALUMINIUM.density + discs[1] * 2530.0)
    simple = math.sqrt(3.0 * _strut_stiffness(stage) / mass) / (2.0 * math.pi)
    model = lumped(stage)
    solved = eigen(model)
    row = model.output_index(("platform.z",))
    share = (model.output[row] @ solved.shapes)[0] ** 2
    piston = math.sqrt(solved.values[int(np.argmax(share))]) / (2.0 * math.pi)
    assert 0.9 * simple < piston < 1.02 * simple


def test_strut_reaches_from_neck_to_neck():
    stage = case("parallelogram")
    drive = stage.units["drive"].links
    assert number(stage, "strut") == pytest.approx(8 * mm + 10 * mm + 36 * mm)
    assert drive["front"].at[0] - drive["back"].at[0] == pytest.approx(54 * mm)


@pytest.mark.parametrize("crossing", [0.5, 0.25, 0.12732, 0.0])
def test_tilt_stage_turns_against_wittrick(crossing):
    """Two pivots of K0 = 8 (E I / L)(3 lambda^2 - 3 lambda + 1) each (Wittrick 1951); the force map is the coil's constant by its lever.

    The coil pushes aside too, which turns a hinge that crosses off its middle by (t/L)^2.
    """
    drawn = case("tilt-stage", {"crossing": crossing})
    hinge, coil = replace(drawn.parts["hinge"], section=LeafSection.BEAM), drawn.parts["coil"]
    stage = replace(drawn, parts={"hinge": hinge, "coil": coil})
    bending = STEEL.young * hinge.width * hinge.thickness**3 / 12.0 / hinge.length
    turned = static_gain(lumped(stage), ("platform.rz",), ("platform.mz", "motor")).values[0]
    assert 1.0 / turned[0] == pytest.approx(16.0 * bending * (3.0 * crossing**2 - 3.0 * crossing + 1.0), rel=1e-3)
    assert turned[1] / turned[0] == pytest.approx(coil.force_constant * number(stage, "lever"), rel=(hinge.thickness / hinge.length) ** 2)
    assert ideal(stage).coordinates == ("rz",)


def test_voice_coil_stage_is_as_stiff_as_two_leaves():
    """Each side has two pairs of leaves in series, 2 k / 2; both sides: 2 k, of leaves whose faces stay parallel."""
    stage = case("voice-coil-stage")
    moved = static_gain(lumped(stage), ("platform.x",), ("platform.fx", "motor")).values[0]
    assert 1.0 / moved[0] == pytest.approx(2.0 / compliance(stage.parts["leaf"], STEEL)[1, 1], rel=1e-3)
    assert moved[1] / moved[0] == pytest.approx(stage.parts["coil"].force_constant, rel=1e-9)


def test_voice_coil_stage_warms_by_the_current_that_holds_it():
    """i = K x / k_f, heat R i^2, and its rise over the surroundings."""
    stage = case("voice-coil-stage")
    coil = stage.parts["coil"]
    current = 2.0 / compliance(stage.parts["leaf"], STEEL)[1, 1] * 2 * mm / coil.force_constant
    heating = next(each for each in judge(stage) if each.requirement.key == "heating.x")
    assert heating.value == pytest.approx(current**2 * coil.resistance * coil.thermal_resistance, rel=2e-3)
