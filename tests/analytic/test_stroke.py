"""A stage over its stroke: what is told of every point agrees with the points beside it, and with the drawn stage at its middle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.cases.parallelogram import parallelogram
from flexstage.models.nonlinear.state import Status
from flexstage.show.command.displaced import OperatingPointOptions, command_stage
from tests.analytic.test_large_displacements import vee
from tests.laws.test_nonlinear import guide


def test_stiffness_is_the_slope_of_force():
    found = fs.stroke(fs.load_path(fs.nonlinear(guide()), "platform.y", np.linspace(0.019, 0.021, 21))).along
    force, stiffness = (found.values[:, found.columns.index(name)] for name in ("force", "stiffness"))
    slope = np.gradient(force, 1e-4, edge_order=2)[1:-1]
    assert stiffness[1:-1] == pytest.approx(slope, rel=1e-4)
    assert stiffness[-1] > 1.02 * 2.0 * 12.0 * 200e9 * 0.02 * 0.5e-3**3 / 12.0 / 0.1**3


def test_at_rest_its_stiffness_and_frequencies_are_those_of_the_drawn_stage():
    stage = parallelogram()
    found = fs.stroke(fs.load_path(fs.nonlinear(stage), "platform.x", np.array([0.0, 1e-4]), weight=0.0)).along
    small = fs.lumped(stage)
    assert found.at("1", "f1") == pytest.approx(fs.modes(small).frequencies[0], rel=1e-4)
    compliance = fs.statics(small).compliance
    assert found.at("1", "stiffness") == pytest.approx(1.0 / compliance.at("platform.x", "platform.fx"), rel=1e-4)


def test_what_the_drawn_stage_cannot_tell_of_long_travel():
    """Weight W on four leaves: 6 W / (5 L) softer; 3 u^2 / (5 L) lower after u; and stiffer there, as its wide leaves curve across."""
    stage = fs.case("long-travel-xy")
    found = fs.stroke(fs.load_path(fs.nonlinear(stage), "platform.x", np.array([0.0, 5e-3]))).along
    drawn = 1.0 / fs.statics(fs.lumped(stage)).compliance.at("platform.x", "platform.fx")
    weight = 9.80665 * (1.0 + 2810.0 * (0.08 * 0.114 + 2.0 * (0.156 + 0.124) * 0.014) * 0.012 + 0.37)  # load, table, frame, coils
    assert found.at("1", "stiffness") == pytest.approx(drawn - 1.2 * weight / 0.08, rel=0.02)
    assert found.at("2", "stiffness") > 1.04 * found.at("1", "stiffness")
    assert found.at("2", "platform.z") == pytest.approx(-0.6 * 5e-3**2 / 0.08, rel=0.03)


def test_what_is_beyond_theory_is_told():
    told = fs.stroke(fs.load_path(fs.nonlinear(guide()), "platform.y", np.array([0.0, 0.08]))).warnings
    assert told[0].where == "left"
    assert "strain" in told[0].what


@pytest.mark.parametrize("limits", [{"yield_stress": 1e8}, {"yield_stress": 1e9, "fatigue_limit": 1e8}])
def test_stress_above_the_limit_of_the_material_is_told(limits: dict[str, float]):
    whole = guide()
    weak = replace(whole, materials={name: replace(each, **limits) for name, each in whole.materials.items()})
    found = fs.stroke(fs.load_path(fs.nonlinear(weak), "platform.y", np.array([1e-4, 4e-3])))
    assert found.along.at("1", "stress") < 1e8 < found.along.at("2", "stress")
    assert "expected 100 MPa" in found.warnings[0].what


def test_weight_is_a_load_that_grows():
    """The guide upright, 1 kg on two leaves: 2 pi^2 E I / (L^2 m g), but for what plate action adds."""
    found = fs.critical_load(fs.nonlinear(guide(gravity=(-9.80665, 0.0, 0.0))), {"weight": 1.0}, weight=0.0)
    slender = 2.0 * np.pi**2 * 200e9 * 0.02 * 0.5e-3**3 / 12.0 / 0.1**2 / 9.80665
    assert 1.0 < found.factor / slender < 1.1


def test_options_bring_a_stage_where_it_is_to_be():
    stage = parallelogram()
    about = command_stage(stage, OperatingPointOptions(["platform.x=0.2 mm"], ["platform.fy=5 N"])).operating_point
    model = fs.nonlinear(stage)
    sag = float(fs.equilibrium(model, {"platform.fy": 5.0}).displacement()[0])
    same = fs.linearise(fs.equilibrium(model, {"platform.fy": 5.0}, hold={"platform.x": sag + 2e-4}))
    assert about is not None
    assert about.linear.stiffness_matrix == pytest.approx(same.stiffness_matrix, rel=1e-6, abs=1e-3)


@pytest.mark.parametrize(
    ("at", "load"), [(["platform.q=1 mm"], []), ([], ["platform.fq=1 N"]), (["platform.x=1 kg"], []), ([], ["platform.fy"])]
)
def test_options_that_mean_nothing_are_refused(at: list[str], load: list[str]):
    with pytest.raises(fs.DesignError):
        command_stage(parallelogram(), OperatingPointOptions(at, load))


def test_loads_past_what_a_stage_bears_are_told_with_how_far_it_stays():
    """Two slender leaves buckle at 2 pi^2 E I / L^2; a fifth of five times that is the limit."""
    slender = 2.0 * np.pi**2 * 200e9 * 0.02 * 0.5e-3**3 / 12.0 / 0.1**2
    with pytest.raises(fs.DesignError, match=r"at 0\.20\d* of the loads the stage snaps or buckles"):
        fs.operating_point(guide(), loads={"platform.fx": -5.0 * slender})


def test_what_stays_locked_is_said_once():
    with pytest.raises(fs.DesignError, match="given twice"):
        command_stage(parallelogram(), OperatingPointOptions(["platform.x=1 um"], fixed=["platform.x", "platform.x"]))


def test_what_is_bent_beyond_the_theory_is_told():
    told = " ".join(each.what for each in fs.operating_point(guide(), {"platform.y": 90e-3}).warnings)
    assert "strain beyond linear elasticity" in told
    assert "too large for two shape functions across the width" in told


def test_a_stage_beyond_its_limit_load_is_unstable_when_its_drive_is_free():
    """Just beyond the limit, a fixed drive keeps the vee stable; released, it snaps through and has no frequencies."""
    path = fs.load_path(vee(), "platform.y", np.array([-6.5e-4]))
    found = fs.stroke(path)
    assert path.motions.tolist() == [0]
    assert np.isnan(found.along.at("1", "f1"))
    assert found.along.at("1", "unstable") == 1.0
    assert "the free stage is unstable at 1 of 1 points" in found.warnings[0].what


def test_a_missing_equilibrium_of_a_stage_without_flexures_is_told():
    """Without flexures there is no strain to be unknown; the number of unstable modes is unknown."""
    path = fs.load_path(fs.nonlinear(fs.case("spiral-stage")), "platform.x", np.array([0.0, 1e-4]))
    lost = replace(path, state=replace(path.state, status=np.array([path.state.status[0], Status.SINGULAR])))
    assert [each.what.partition(",")[0] for each in fs.stroke(lost).warnings] == ["no equilibrium found at 1 of 2 points"]
