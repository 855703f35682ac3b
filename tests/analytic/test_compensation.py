"""Lost-motion compensation: static errors of shipped stages with and without it, against static solves made here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.linear_statics.deflection import deflection
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import CASES, case
from flexstage.control.compensation import ideal_compensation, lost_motion_compensation, static_error
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.controllers.pi import PI
from flexstage.control.plant_models.electronics import Hardware
from flexstage.control.plant_models.plants import plant
from flexstage.control.systems.closed import loop
from flexstage.control.systems.system import select
from flexstage.mechanism.mechanism import Damping, ModalDamping
from flexstage.models.finite import FinitePose, forward_kinematics, inverse_kinematics
from flexstage.models.ideal import ideal
from flexstage.models.linear.model import LinearModel
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped
from flexstage.parts.body import Payload
from flexstage.spatial.frame import COMPONENTS
from tests.conftest import STROKELESS

STAGES = sorted(set(CASES) - {"double-triangle-a", "double-triangle-refitted"} - STROKELESS)
DAMPING: Damping = ModalDamping(0.01)


def _solved(model: LinearModel, strokes: np.ndarray, wrench: np.ndarray | None = None) -> np.ndarray:
    """The platform's twist under strokes and a wrench on it, from K and B directly."""
    load = model.input_matrix[:, : strokes.shape[0]] @ strokes
    rows = [next(k for k, each in enumerate(model.outputs) if each.name == f"platform.{name}") for name in COMPONENTS]
    if wrench is not None:
        load = load + model.output[rows].T @ wrench
    return model.output[rows] @ np.linalg.solve(model.stiffness_matrix, load)


@pytest.fixture(scope="module", params=STAGES)
def stage(request):
    """A shipped stage with its kinematics, lumped model and lost motion."""
    found = case(request.param)
    kinematics, model = ideal(found), lumped(found)
    return found, kinematics, model, lost_motion(kinematics, model)


def test_open_loop_errs_by_the_lost_motion(stage):
    """Commanded through R_a, the loop's own plant at rest misses R_a^+ Lambda R_a per axis, crosstalk included, to 1e-9."""
    _, kinematics, model, lost = stage
    given = ideal_compensation(kinematics)
    found = static_error(given, kinematics, lost.gain)
    predicted = kinematics.inverse @ lost.loss.values @ kinematics.actuation
    scale = _scale(kinematics)
    np.testing.assert_allclose(found.error.values * scale, predicted * scale, atol=1e-12)
    one = plant(model, kinematics, Hardware(), modes=len(kinematics.coordinates), damping=DAMPING)
    moved = select(one.system, one.actuators, [f"platform.{name}" for name in COMPONENTS]).transfer(np.zeros(1))[0].real
    reached = kinematics.projection @ moved @ given.gains.values
    np.testing.assert_allclose((np.eye(len(reached)) - reached) * scale, predicted * scale, atol=1e-9)
    assert found.largest > 1e-4


def test_gains_correct_it(stage):
    """With the gains of the lost-motion analysis the same plant misses less than 1e-9 of the command."""
    _, kinematics, model, lost = stage
    given = lost_motion_compensation(lost, kinematics)
    error = static_error(given, kinematics, lost.gain)
    assert np.max(np.abs(error.error.values * _scale(kinematics))) < 1e-9
    length = np.array([kinematics.length if name[0] == "r" else 1.0 for name in kinematics.coordinates])
    commands = np.diag(1e-6 / length)
    reached = _solved(model, given.strokes(commands).T)
    assert np.max(np.abs((commands.T - kinematics.projection @ reached) * length[:, None])) < 1e-9 * 1e-6


def _scale(kinematics) -> np.ndarray:
    length = np.array([kinematics.length if name[0] == "r" else 1.0 for name in kinematics.coordinates])
    return length[:, None] / length


def test_what_gains_by_another_model_leave():
    """Gains by the mapped model on the lumped stage, and the other way round: the numbers of a static solve made here."""
    stage = double_triangle()
    kinematics, plants = ideal(stage), {"mapped": mapped(stage), "lumped": lumped(stage)}
    losts = {name: lost_motion(kinematics, model) for name, model in plants.items()}
    scale = _scale(kinematics)
    left = {}
    for gains, on in (("mapped", "lumped"), ("lumped", "mapped"), ("lumped", "lumped")):
        found = static_error(lost_motion_compensation(losts[gains], kinematics), kinematics, losts[on].gain)
        solved = np.eye(6) - _solved(plants[on], losts[gains].correction.values)
        np.testing.assert_allclose(found.error.values * scale, solved * scale, atol=1e-12)
        assert found.largest == pytest.approx(np.max(np.abs(solved * scale)), abs=1e-12)
        left[gains, on] = found.largest
    # the mapped model loses nothing: its gains are R_a, and leave on the lumped stage all that is lost
    assert left["mapped", "lumped"] == pytest.approx(static_error(ideal_compensation(kinematics), kinematics, losts["lumped"].gain).largest)
    assert left["lumped", "lumped"] < 1e-9 < left["mapped", "lumped"]
    assert left["lumped", "mapped"] > 1e-3


def test_strokes_hold_up_a_payload():
    """Eq. 11's load term: with the strokes for an eccentric payload the loaded stage reaches its pose; without, it sinks as computed."""
    stage = replace(double_triangle(), payloads={"sample": Payload("platform", mass=3.0, at=(0.04, -0.02, 0.15))})
    kinematics, model = ideal(stage), lumped(stage)
    lost, sunk = lost_motion(kinematics, model), deflection(stage, model).total
    pose = np.array([3e-6, -2e-6, 5e-6, 1e-5, -2e-5, 3e-5])
    given = lost_motion_compensation(lost, kinematics, sunk)
    assert static_error(given, kinematics, lost.gain, sunk).offset == pytest.approx(np.zeros(6), abs=1e-15)
    np.testing.assert_allclose(
        static_error(lost_motion_compensation(lost, kinematics), kinematics, lost.gain, sunk).offset, sunk, rtol=1e-12
    )
    np.testing.assert_allclose(_solved(model, given.strokes(pose)) + sunk, pose, atol=1e-9 * 5e-6)
    assert abs(sunk[2]) > 1e-7


def test_a_push_is_taken_back_by_the_strokes_of_its_compliance():
    """The same for a wrench on the platform, its twist solved here."""
    stage = double_triangle()
    kinematics, model = ideal(stage), lumped(stage)
    wrench = np.array([3.0, -2.0, 10.0, 0.1, 0.2, -0.3])
    pushed = _solved(model, np.zeros(6), wrench)
    given = lost_motion_compensation(lost_motion(kinematics, model), kinematics, pushed)
    assert np.max(np.abs(_solved(model, given.strokes(np.zeros(6)), wrench))) < 1e-9 * np.max(np.abs(pushed))


def test_finite_strokes_leave_what_is_of_second_order():
    """At 50 um: linear gains leave the curvature of the paths; on top of finite ideal strokes less than a hundredth of that is left."""
    stage = double_triangle()
    kinematics = ideal(stage)
    lost = lost_motion(kinematics, lumped(stage))
    given = lost_motion_compensation(lost, kinematics)
    poses = 50e-6 * np.array([[1.0, 0.0, 0.0, 0.0, 0.0, 4.0], [0.0, 1.0, 0.5, 3.0, -3.0, 0.0]])
    moved = forward_kinematics(stage, kinematics, given.strokes(poses)).pose
    curved = moved.vector - given.strokes(poses) @ kinematics.jacobian.values.T
    left = poses - (given.strokes(poses) @ lost.gain.values.T + curved) @ kinematics.projection.T
    np.testing.assert_allclose(left, -curved, atol=1e-9 * 50e-6)
    wanted = FinitePose(poses[:, :3], poses[:, 3:])
    exact = inverse_kinematics(stage, kinematics, wanted).strokes
    strokes = exact @ (given.gains.values @ kinematics.inverse).T + given.offset
    reached = forward_kinematics(stage, kinematics, strokes).pose.vector + strokes @ (lost.gain.values - kinematics.jacobian.values).T
    assert np.max(np.abs(poses - reached)[:, :3]) < 0.1 * np.max(np.abs(left)[:, :3])
    without = poses - (poses @ kinematics.actuation.T) @ lost.gain.values.T
    assert np.max(np.abs(left)) < 0.1 * np.max(np.abs(without))


def test_fed_forward_gains_leave_nothing_to_the_controller():
    """In the closed loop the reference fed forward by these gains makes no error at rest, without any integrator."""
    stage = double_triangle()
    kinematics, model = ideal(stage), lumped(stage)
    one = plant(model, kinematics, Hardware(rate=10e3, delay=1e-4), modes=6, damping=DAMPING)
    gains = {"R_a": ideal_compensation(kinematics), "corrected": lost_motion_compensation(lost_motion(kinematics, model), kinematics)}
    errors = {}
    for name, given in gains.items():
        control = Decentralised(platform_loops(one.coordinates), (PI(0.01),) * 6, feedforward=given.gains.values)
        closed = loop(one, control.system(1e-4)).system
        names = one.coordinates.names
        found = select(closed, [f"reference.{each}" for each in names], [f"error.{each}" for each in names]).transfer(np.zeros(1))[0]
        errors[name] = np.max(np.abs(found * _scale(kinematics)))
    assert errors["R_a"] > 1e-3
    assert errors["corrected"] < 1e-9


def test_what_does_not_fit_is_said():
    """Deflections that are no twist, plants of other actuators."""
    stage, other = double_triangle(), case("xy-stage")
    kinematics = ideal(stage)
    lost = lost_motion(kinematics, lumped(stage))
    with pytest.raises(DesignError, match=r"deflection: not a twist \(got shape \(3,\)"):
        lost_motion_compensation(lost, kinematics, np.zeros(3))
    foreign = lost_motion(ideal(other), lumped(other))
    with pytest.raises(DesignError, match="plant: wrong actuators"):
        static_error(ideal_compensation(kinematics), kinematics, foreign.gain)
