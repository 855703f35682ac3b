"""Error budget: its sources are what they are called, add up to the whole static error, and the gains remove what they can."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.budget import budget
from flexstage.analysis.assessment.error_budget import SOURCES, command_strokes
from flexstage.analysis.linear_statics.drift import drift
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.workspace.gauging import pose_resolution
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.models.finite import forward_kinematics
from flexstage.models.linear.static import static_gain
from flexstage.spatial.frame import COMPONENTS
from tests.laws.shared import ideal, lumped

NAMES = ("double-triangle", "parallelogram", "xy-stage", "bridge", "hexapod", "tip-tilt", "tip-tilt-four")


def commanded(stage, size=5e-6):
    kinematics = ideal(stage)
    return {name: (size * 10.0 if name.startswith("r") else size) for name in kinematics.coordinates}


def noisy(stage):
    sensors = {name: replace(sensor, noise_density=0.1e-9, bandwidth=1000.0, resolution=2e-9) for name, sensor in stage.sensors.items()}
    return replace(stage, sensors=sensors)


@pytest.mark.parametrize("name", NAMES)
def test_every_corner_lies_within_the_budget(name):
    """Elastic motion at any corner of the box, less what was asked, is at most lost motion plus crosstalk; with the gains, what is left."""
    stage = case(name)
    kinematics, model = ideal(stage), lumped(stage)
    command = commanded(stage)
    found = budget(stage, command)
    strokes = command_strokes(kinematics, command)
    gain = static_gain(model, tuple(f"platform.{part}" for part in COMPONENTS), kinematics.actuators).values
    asked = strokes @ kinematics.jacobian.values.T
    errors = np.abs(strokes @ gain.T - asked)
    bound = found.ideal.values[:, 0] + found.ideal.values[:, 1]
    assert np.all(errors <= bound * (1.0 + 1e-9) + 1e-18)
    own = [kinematics.jacobian.values[:, [each]] @ kinematics.mapping.values[[each]] for each in range(len(kinematics.actuators))]
    lost = sum(part * loss for part, loss in zip(own, np.diag(lost_motion(kinematics, model).loss.values), strict=True))
    np.testing.assert_allclose(found.ideal.values[:, 0], np.abs(lost) @ np.array(list(command.values())), rtol=1e-9, atol=1e-18)
    wanted = np.linalg.lstsq(kinematics.mapping.values, strokes.T, rcond=None)[0]
    corrected = (gain @ lost_motion(kinematics, model).correction.values @ wanted).T
    left = np.abs(corrected - asked)
    np.testing.assert_allclose(np.max(left, axis=0), found.corrected.values[:, 1], rtol=1e-6, atol=1e-15)
    np.testing.assert_array_equal(found.corrected.values[:, 0], 0.0)


@pytest.mark.parametrize("name", NAMES)
def test_the_gains_leave_only_motion_outside_the_ideal(name):
    """With six ideal motions nothing is left; with fewer, no more than before along the ideal coordinates."""
    stage = case(name)
    kinematics = ideal(stage)
    found = budget(stage, commanded(stage))
    if kinematics.mobility == 6:
        np.testing.assert_allclose(found.corrected.values[:, 1], 0.0, atol=1e-15)
    assert np.all(np.nansum(found.corrected.values[:, :2], axis=1) <= np.nansum(found.ideal.values[:, :2], axis=1) * 1.02 + 1e-12)


@pytest.mark.parametrize("name", ["double-triangle", "hexapod", "bridge"])
def test_linear_map_is_the_worst_of_the_corners(name):
    stage = case(name)
    kinematics, command = ideal(stage), commanded(stage)
    strokes = command_strokes(kinematics, command)
    errors = [forward_kinematics(stage, kinematics, single).pose.vector - kinematics.jacobian.values @ single for single in strokes]
    found = budget(stage, command).ideal.values[:, SOURCES.index("linear map")]
    np.testing.assert_allclose(found, np.max(np.abs(errors), axis=0), rtol=1e-6, atol=1e-15)


def test_noise_and_steps_of_the_gauges():
    """Three standard deviations of the noise; half a step of every gauge with the worst signs."""
    stage = noisy(case("double-triangle"))
    found = budget(stage, {"z": 1e-6})
    seen = pose_resolution(stage, ideal(stage))
    np.testing.assert_allclose(found.ideal.values[:, 3], 3.0 * seen.noise, rtol=1e-9)
    assert found.ideal.at("z", "gauge noise") == pytest.approx(3.0 * 0.1e-9 * np.sqrt(1000.0 / 3.0), rel=1e-9)  # the mean of three
    np.testing.assert_allclose(found.ideal.values[:, 4], 0.5 * seen.worst, rtol=1e-9)
    assert found.missing == ()
    assert budget(case("double-triangle"), {"z": 1e-6}).missing == ("gauge noise",)
    wide = budget(stage, {"z": 1e-6}, coverage=1.0)
    np.testing.assert_allclose(wide.ideal.values[:, 3], seen.noise, rtol=1e-9)


def test_drift_and_sums():
    """0.1 K of the uniform drift, and the sums of one line by hand."""
    stage = noisy(case("hexapod"))
    found = budget(stage, {"x": 5e-6, "z": 5e-6}, temperature=-0.1)
    per_kelvin = drift(stage, lumped(stage), ground="steel").of("platform").values[:, 0]
    np.testing.assert_allclose(found.ideal.values[:, 5], 0.1 * np.abs(per_kelvin), rtol=1e-9)
    line = found.ideal.values[0]
    np.testing.assert_allclose(found.sums.at("x", "linear"), np.sum(line), rtol=1e-12)
    np.testing.assert_allclose(found.sums.at("x", "rss"), np.sqrt(np.sum(line**2)), rtol=1e-12)
    np.testing.assert_allclose(found.sums.at("x", "linear corrected"), np.sum(found.corrected.values[0]), rtol=1e-12)
    own = budget(stage, {"x": 5e-6}, temperature=0.1, drifted=drift(stage, lumped(stage), ground="none"))
    assert own.ideal.at("z", "drift") != pytest.approx(found.ideal.at("z", "drift"), rel=1e-3)


def test_commands_scale_the_static_sources():
    stage = case("double-triangle")
    one, two = budget(stage, {"x": 5e-6, "rx": 1e-5}), budget(stage, {"x": 10e-6, "rx": 2e-5})
    np.testing.assert_allclose(two.ideal.values[:, :2], 2.0 * one.ideal.values[:, :2], rtol=1e-9, atol=1e-18)
    np.testing.assert_allclose(two.ideal.values[:, 2], 4.0 * one.ideal.values[:, 2], rtol=0.01, atol=1e-12)


def test_a_point_above_feels_the_tilts():
    """At a point h above the reference x errs by what tilting about y adds: within |ex| + h |ery|, source by source."""
    stage = noisy(case("hexapod"))
    here = budget(stage, {"x": 5e-6, "ry": 50e-6}).ideal.values
    there = budget(stage, {"x": 5e-6, "ry": 50e-6}, at="sample").ideal.values
    arm = stage.bodies["platform"].points["sample"][2] - 0.014
    assert np.all(there[0, :5] <= here[0, :5] + arm * here[4, :5] + 1e-15)
    np.testing.assert_allclose(there[3:, :5], here[3:, :5], rtol=1e-9, atol=1e-18)
    assert there[0, 0] != pytest.approx(here[0, 0], rel=1e-6)


def test_what_cannot_be_commanded_is_named():
    with pytest.raises(fs.DesignError, match=r"command w: unknown ideal motion \(expected x"):
        budget(case("double-triangle"), {"w": 1e-6})
    with pytest.raises(fs.DesignError, match=r"Use .*sample"):
        budget(case("hexapod"), {"x": 1e-6}, at="sampl")


def test_a_batch_is_the_loop():
    """Two designs at once, each as alone; a command of two coordinates has as many corners as designs times two."""
    lengths = np.array([0.05, 0.06])
    together = budget(noisy(case("hexapod", {"head_radius": lengths})), {"x": 5e-6}, temperature=0.1)
    for index, radius in enumerate(lengths):
        alone = budget(noisy(case("hexapod", {"head_radius": float(radius)})), {"x": 5e-6}, temperature=0.1)
        np.testing.assert_allclose(together.ideal.values[index], alone.ideal.values, rtol=1e-6, atol=1e-14)
        np.testing.assert_allclose(together.sums.values[index], alone.sums.values, rtol=1e-6, atol=1e-14)


def test_drift_may_be_given():
    """The same numbers as with the drift that the budget computes itself."""
    stage, command = case("hexapod"), {"z": 5e-6}
    found = budget(stage, command, temperature=1.0, drifted=drift(stage, lumped(stage), ground="steel"))
    np.testing.assert_allclose(found.ideal.values, budget(stage, command, temperature=1.0).ideal.values, rtol=1e-9, atol=1e-18)


def test_what_states_no_expansion_leaves_drift_out_with_its_reason():
    """Where no temperature is asked for; all other columns stand as they are. Asked for, it is refused as before."""
    stage = case("double-triangle")
    cold = replace(stage, materials={name: replace(material, expansion=None) for name, material in stage.materials.items()})
    whole, left = (budget(each, {"z": 10e-6}, temperature=None) for each in (stage, cold))
    np.testing.assert_array_equal(left.ideal.values[:, :-1], whole.ideal.values[:, :-1])
    assert np.all(np.isnan(left.ideal.part(left.ideal.rows, ("drift",)).values))
    assert "drift" in left.missing
    assert "materials.steel: thermal expansion coefficient missing" in left.reasons["drift"]
    assert float(whole.temperature) == 1.0
    with pytest.raises(fs.DesignError, match="thermal expansion coefficient missing"):
        budget(cold, {"z": 10e-6}, temperature=0.1)


def stepping(stage, resolution):
    """The stage with its vertical stacks in steps."""
    stiff = (3.5e7, 1e7, 1e7, 1e3, 1e3, 1e3)
    drive = fs.SteppingDrive(travel=200e-6, diagonal=stiff, resolution=resolution)
    return replace(stage, parts={**stage.parts, "stack_vertical": drive})


def test_steps_of_actuators_are_the_worst_of_their_signs():
    stage = stepping(case("double-triangle"), 40e-9)
    platform = stage.bodies["platform"]
    tool = tuple(np.add(expand(stage).bodies["platform"].reference, (0.0, 0.0, 0.2)))
    stage = replace(stage, bodies={**stage.bodies, "platform": replace(platform, points={**platform.points, "tool": tool})})
    found, there = budget(stage, {"z": 1e-6}), budget(stage, {"z": 1e-6}, at="tool")
    gain = static_gain(lumped(stage), tuple(f"platform.{part}" for part in COMPONENTS), ideal(stage).actuators).values
    corners = np.array(np.meshgrid(*[(-20e-9, 20e-9)] * 3)).reshape(3, -1)
    worst = np.max(np.abs(gain[:, 3:] @ corners), axis=1)
    np.testing.assert_allclose(found.ideal.values[:, found.ideal.columns.index("actuator steps")], worst, rtol=1e-9, atol=1e-18)
    tilted = gain[0] + 0.2 * gain[4]  # x at the tool, 0.2 m above the reference
    assert there.ideal.values[0, there.ideal.columns.index("actuator steps")] == pytest.approx(
        np.max(np.abs(tilted[3:] @ corners)), rel=1e-9
    )
    assert found.sums.values[2, 0] == pytest.approx(np.nansum(found.ideal.values[2]), rel=1e-12)


def test_steps_that_are_not_stated_are_missing_and_none_have_no_column():
    assert "actuator steps" in budget(stepping(case("double-triangle"), None), {"z": 1e-6}).missing
    assert budget(case("double-triangle"), {"z": 1e-6}).ideal.columns == SOURCES
