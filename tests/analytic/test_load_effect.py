"""Stages under their own weight: what is told of them is loaded where that is felt, against beam columns, and unchanged elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import judge
from flexstage.analysis.linear_statics.deflection import deflection
from flexstage.analysis.linear_statics.drift import _Thermal  # pyright: ignore[reportPrivateUsage]
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.loaded.load_effect import SIGNIFICANT, LoadEffect, load_effect, loaded_lumped_model
from flexstage.analysis.loaded.stability import Stability, prestress, stability
from flexstage.beams.compliance import stiffness
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.study.resolve import resolve
from flexstage.control.study.rest import rest_errors
from flexstage.control.study.setup import LoopSetup
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.expansion import expansion
from flexstage.models.nonlinear.linearise import linearise
from flexstage.show.report import _turning  # pyright: ignore[reportPrivateUsage]
from flexstage.show.viewer.data import stage_data
from flexstage.show.viewer.motions import PLATFORM_MODE, Group
from flexstage.spatial.frame import transport
from tests.analytic.test_stability import leaves


def upright(mass: float, down: float = 1.0) -> fs.Mechanism:
    """A platform on two upright leaves without mass of their own, or hanging from them."""
    found = leaves(mass)
    steel = replace(found.materials["steel"], density=1e-6)
    return replace(found, materials={"steel": steel}, gravity=(0.0, 0.0, -9.80665 * down), damping=fs.ModalDamping(0.01))


def column(force: float) -> float:
    """Stiffness [N/m] of two guided leaves that carry `force` (tension below zero): 2 P / (L (tan(u) / u - 1)), u = L/2 (P / 2 E I)^1/2."""
    length, rigidity = 0.06, 2.0 * 200e9 * 0.02 * 0.0003**3 / 12.0
    u = 0.5 * length * np.sqrt(complex(force / rigidity))
    return float(np.real(force / length / (np.tan(u) / u - 1.0)))


@pytest.mark.parametrize(("mass", "frequency", "error"), [(2.5, 2.26569, 1e-4), (5.0, 0.181067, 0.01)])
def test_analysis_of_a_stage_that_weight_softens_is_that_of_the_loaded_stage(mass: float, frequency: float, error: float):
    stage = replace(upright(mass), requirements={"frequency.1": "at least 3 Hz", "stiffness.x": "at most 1 kN/m"})
    found = fs.analyse(stage)
    assert found.modes is not None
    assert found.statics is not None
    assert found.modes.frequencies[0] == pytest.approx(frequency, rel=error)
    stiffness = 1.0 / found.statics.compliance.at("platform.x", "platform.fx")
    assert stiffness == pytest.approx(column(9.80665 * mass), rel=2.5 * error)
    values = [float(np.asarray(each.value)) for each in judge(stage)]
    assert values == pytest.approx([frequency, stiffness], rel=error)
    assert [bool(each.passed) for each in found.verdicts] == [False, True]
    assert found.loaded is not None
    assert "for the loaded stage" in found.loaded.text


def test_hanging_leaves_are_stiffer():
    found = load_effect(upright(2.5, down=-1.0))
    assert found is not None
    assert found.model is not None
    stiffness = 1.0 / fs.statics(found.model).compliance.at("platform.x", "platform.fx")
    assert stiffness == pytest.approx(column(-9.80665 * 2.5), rel=1e-4)


def test_calibrated_leaves_are_softened_as_drawn_ones():
    """A matrix that stands for a drawn leaf shortens by its bending as that leaf does: 6 P / (5 L) across, without inner bending."""
    stage, weight = upright(1.0), 9.80665
    leaf = stage.parts["leaf"]
    assert isinstance(leaf, fs.Leaf)
    matrix = np.linalg.inv(stiffness(leaf, stage.materials["steel"]))
    given = fs.ComplianceMatrix(tuple(map(tuple, (0.5 * (matrix + matrix.T)).tolist())), leaf.intended, replaces="drawn")
    found = load_effect(replace(stage, parts={**stage.parts, "leaf": given, "drawn": leaf}))
    assert found is not None
    assert found.change == pytest.approx(-1.2 * weight / 0.06 / column(1e-9), rel=5e-3)
    assert found.change == pytest.approx(column(weight) / column(1e-9) - 1.0, rel=5e-3)


def test_the_first_estimate_is_that_of_beam_columns():
    """Two inner shapes a leaf: 1 % of the change of stiffness."""
    for mass in (0.05, 2.5):
        stage = upright(mass)
        near = prestress(stage, fs.lumped(stage))
        stiff = 1.0 / fs.statics(near).compliance.at("platform.x", "platform.fx")
        drawn = column(1e-9)
        assert stiff - drawn == pytest.approx(column(9.80665 * mass) - drawn, rel=0.01)


def test_what_is_not_felt_changes_no_number():
    stage = parallelogram()
    found, drawn = fs.analyse(stage), fs.lumped(stage)
    assert found.loaded is not None
    assert found.loaded.model is None
    assert abs(found.loaded.change) < SIGNIFICANT
    assert found.under_load is found.linear
    assert found.modes is not None
    assert np.array_equal(found.modes.frequencies, fs.modes(drawn).frequencies)
    assert found.loaded.text.startswith("Weight, payloads and forces change no stiffness by more than 0.048 %")


def test_the_bound_is_one():
    """No stiffness changes by more than 1 / load factor, whatever is looked at."""
    stage = upright(0.04)
    found, bound = load_effect(stage), 1.0 / float(stability(stage, fs.lumped(stage)).dead)
    assert found is not None
    assert 0.5 * bound < abs(found.change) <= 1.001 * bound


@pytest.mark.parametrize("mass", [0.05, 0.0525])
def test_one_per_cent_is_felt(mass):
    """Results are of the loaded stage from a change of 1 % on, here by beam columns 0.98 % and 1.03 %."""
    found, change = load_effect(upright(mass)), 1.0 - column(9.80665 * mass) / column(1e-6)
    assert found is not None
    assert abs(found.change) == pytest.approx(change, rel=0.02)
    assert (found.model is not None) == (change >= 0.01)


@pytest.mark.parametrize("mass", [2.5, 4.0])
def test_a_deflection_is_that_of_the_beam_column(mass):
    """A push goes further under weight: at a load factor of 2 twice as far as in the drawn stage, and the requirement is judged by it."""
    stage = replace(upright(mass), forces={"push": fs.Force("platform", (0.0, 0.0, 0.0), (0.01, 0.0, 0.0))})
    expected = 0.01 / column(9.80665 * mass)
    assert expected > 1.9 * 0.01 / column(1e-6)
    effect = load_effect(stage)
    assert effect is not None
    assert effect.model is not None
    assert float(deflection(stage, effect.model).total[0]) == pytest.approx(expected, rel=0.02)
    assert float(deflection(stage, fs.lumped(stage)).total[0]) == pytest.approx(0.01 / column(1e-6), rel=0.02)
    for share in (0.95, 1.05):
        (verdict,) = judge(replace(stage, requirements={"deflection.x": f"at most {1e6 * share * expected:.9g} um"}))
        assert bool(verdict.passed) == (share > 1.0)


def test_a_bound_of_stiffness_is_twice_that_of_frequencies():
    """A frequency goes with the root of a stiffness."""
    said = LoadEffect(0.004, "", "").text
    assert "no stiffness by more than 0.4 %, and no frequency by more than 0.2 %" in said


def test_nothing_is_said_where_nothing_weighs():
    found = load_effect(replace(parallelogram(), gravity=(0.0, 0.0, 0.0)))
    assert found is not None
    assert not found.text


def test_the_second_order_of_a_stroke_is_told():
    """A parallelogram's leaves of length L bend by x: x^2 / (2 L^2), against what its exact kinematics leave out of x."""
    stage = replace(parallelogram(), requirements={"stroke.x": "at least 50 um"})
    found = fs.analyse(stage).second_order
    assert found is not None
    leaves_of = [part for part in stage.parts.values() if isinstance(part, fs.Leaf)]
    length = min(float(np.asarray(part.length)) for part in leaves_of)
    assert found.error == pytest.approx(0.5 * (50e-6 / length) ** 2, rel=1e-3)
    assert found.link in stage.links
    assert "bends by" in found.text


def pushed(payload: float) -> fs.Mechanism:
    """A soft stack against a platform on two thin leaves that a payload presses on; leaves as beams, without mass of their own."""
    stage = parallelogram()
    leaf, stack = stage.parts["leaf"], stage.parts["stack"]
    assert isinstance(leaf, fs.Leaf)
    assert isinstance(stack, fs.Piezo)
    leaf = replace(leaf, thickness=0.3e-3, section=fs.LeafSection.BEAM)
    stack = replace(stack, stiffness=5e4, preload=None, mass=0.0)
    light = {name: replace(each, density=1e-6) for name, each in stage.materials.items()}
    load = {"load": fs.Payload("platform", mass=payload, at=(0.0, 0.0, 0.0), point=True)}
    parts = {**stage.parts, "leaf": leaf, "stack": stack}
    return replace(stage, parts=parts, materials=light, payloads=load, gravity=(0.0, 9.80665, 0.0), requirements={"loss": "at most 8 %"})


def test_lost_motion_is_that_of_the_loaded_stage():
    """The guide's stiffness k against the stack's s: k / (k + s), k that of beam columns under the payload."""
    stage = pushed(6.0)
    still = fs.lost_motion(fs.ideal(stage), fs.lumped(stage)).loss.values[0, 0]
    length, rigidity, weight = 0.025, 2.0 * 71.7e9 * 0.025 * 0.0003**3 / 12.0, 6.0 * 9.80665
    u = 0.5 * length * np.sqrt(weight / rigidity)
    softened = weight / length / (np.tan(u) / u - 1.0) / (12.0 * rigidity / length**3)
    wanted = 1.0 / (1.0 + (1.0 / still - 1.0) / softened)
    found = fs.analyse(stage)
    assert found.lost_motion is not None
    lost = found.lost_motion.loss.values[0, 0]
    assert lost == pytest.approx(wanted, rel=2e-3)
    assert abs(lost / still - 1.0) > 0.3
    assert sum(found.lost_motion.of("B").values()) == pytest.approx(lost, rel=1e-12)
    assert float(np.asarray(found.verdicts[0].value)) == pytest.approx(lost, rel=1e-12)
    budget = found.error_budget
    assert budget is not None
    (stroke,) = budget.command.values()
    assert budget.ideal.at("x", "lost motion") == pytest.approx(lost * stroke, rel=1e-9)


def test_link_by_link_a_state_has_the_same_statics_and_at_rest_the_budget_of_the_lumped_model():
    stage = parallelogram()
    model = fs.nonlinear(stage)
    for loads in ({}, {"platform.fy": -3e4, "platform.fx": 200.0}):
        state = fs.equilibrium(model, loads, weight=0.0, stated=0.0)
        whole, links = (fs.statics(linearise(state, inner=inner)).compliance.values for inner in (True, False))
        size = np.sqrt(np.diagonal(whole))
        assert np.max(np.abs(links - whole) / np.outer(size, size)) < 1e-12
    still = linearise(fs.equilibrium(model, weight=0.0, stated=0.0), inner=False)
    drawn, rest = (fs.lost_motion(fs.ideal(stage), each) for each in (fs.lumped(stage), still))
    for name, share in drawn.of("B").items():
        assert rest.of("B")[name] == pytest.approx(share, rel=3e-3, abs=1e-9)  # Mindlin's clamp
    assert abs(rest.of("B")["geometric"]) < 1e-9


@pytest.fixture(scope="module")
def long_travel() -> fs.Mechanism:
    return fs.case("long-travel-xy")


def test_drift_of_a_loaded_stage_is_that_of_one_that_is_warmer(long_travel: fs.Mechanism):
    warm, cold = (fs.equilibrium(fs.nonlinear(long_travel, temperature=step)) for step in (1.0, -1.0))
    found = fs.drift(long_travel, loaded_lumped_model(long_travel)).motion
    for place in ("platform", "sample"):
        rate = 0.5 * (warm.displacement(place) - cold.displacement(place))
        drifted = [found.at(f"{place}.{axis}", "uniform") for axis in "xyz"]
        assert drifted == pytest.approx(rate.tolist(), rel=1e-4, abs=1e-4 * np.max(np.abs(rate)))


def test_drift_of_a_loaded_stage_is_what_its_flexures_do_to_a_small_load(long_travel: fs.Mechanism):
    """By reciprocity: how the forces on flexures change with a load, times what does not fit them, here by differences."""
    model, step = fs.nonlinear(long_travel), 1e-3
    ahead, back = (fs.equilibrium(model, {"platform.fy": load}) for load in (step, -step))
    thermal = _Thermal(expand(long_travel), expansion(long_travel, None), np.zeros(3))
    moved = np.zeros(4)
    for name, link in thermal.assembly.links.items():
        if isinstance(link.part, fs.Leaf):
            misfit = transport(np.array([0.5 * float(np.asarray(link.part.length)), 0.0, 0.0])) @ thermal.misfit(link)
            moved -= (ahead.wrench(name) - back.wrench(name)) / (2.0 * step) @ misfit
    found = fs.drift(long_travel, loaded_lumped_model(long_travel)).of().values[1]
    assert found == pytest.approx(moved, rel=1e-5, abs=1e-14)
    drawn = fs.drift(long_travel, fs.lumped(long_travel)).of().values[1]
    assert abs(found[2] / drawn[2]) > 10.0  # the load seeks its plumb line


def test_drift_about_rest_is_that_of_the_lumped_model():
    stage = parallelogram()
    still = linearise(fs.equilibrium(fs.nonlinear(stage), weight=0.0, stated=0.0), inner=False)
    drawn, rest = fs.drift(stage, fs.lumped(stage)), fs.drift(stage, still)
    size = np.max(np.abs(drawn.motion.values))
    assert rest.motion.values == pytest.approx(drawn.motion.values, abs=1e-4 * size)
    forces = rest.forces.part(drawn.forces.rows, drawn.forces.columns).values
    assert forces == pytest.approx(drawn.forces.values, abs=1e-3 * np.max(np.abs(drawn.forces.values)))
    with pytest.raises(fs.DesignError, match="Use the lumped model"):
        fs.drift(stage, linearise(fs.equilibrium(fs.nonlinear(stage))))


def test_what_bends_flexures_is_felt_like_a_load():
    """No weight; leaves that are bent when free, or warmer on one face, clamped straight: the change goes with the square."""
    stage = replace(upright(1e-6), gravity=(0.0, 0.0, 0.0))
    straight = load_effect(stage)
    assert straight is not None
    assert not straight.text
    steel = replace(stage.materials["steel"], expansion=1e-5)
    changes = []
    for warmth in (20.0, 60.0):
        leaf = stage.parts["leaf"]
        assert isinstance(leaf, fs.Leaf)
        bent = {**stage.parts, "leaf": replace(leaf, face_temperature_difference=warmth)}
        found = load_effect(replace(stage, parts=bent, materials={"steel": steel}))
        assert found is not None
        assert "initially curved flexures" in found.text
        assert (found.model is not None) == (abs(found.change) >= SIGNIFICANT)
        changes.append(abs(found.change))
    assert changes[1] / changes[0] == pytest.approx(9.0, rel=0.05)
    assert changes[0] < SIGNIFICANT < changes[1]


def test_a_loop_is_that_of_the_loaded_stage():
    stage = pushed(6.0)
    found = resolve(stage, LoopSetup())
    assert found.loaded is not None
    assert found.model is found.loaded.model
    sagged = rest_errors(found, fs.lost_motion(found.kinematics, found.model)).load
    assert sagged == pytest.approx(fs.equilibrium(fs.nonlinear(stage)).twist(), rel=1e-9)


def test_a_report_plays_modes_of_the_loaded_stage_and_all_else_as_drawn():
    """A deflection by the loaded model would count the weight twice; who sees a mode is told what it is of."""
    stage = upright(2.5)
    found = fs.analyse(stage)
    played, drawn = _turning(found), stage_data(stage)
    assert {each.remark for each in played.motions if each.group is Group.MODE} == {
        f"{PLATFORM_MODE}, small motions about the loaded stage"
    }
    assert played.motions[0].frequency == pytest.approx(2.26569, rel=1e-4)
    still = [[each for each in data.motions if each.group is not Group.MODE] for data in (played, drawn)]
    assert [each.name for each in still[0]] == [each.name for each in still[1]]
    assert all(np.array_equal(one.twists, other.twists) for one, other in zip(*still, strict=True))


def test_how_far_leaves_shorten_is_told():
    """Of a vertical axis on leaves, 0.6 u^2 / L: it goes aside by that, as its equilibrium at the end of its stroke says."""
    stage = fs.case("z-stage")
    found = fs.analyse(stage).second_order
    assert found is not None
    ends = fs.equilibrium(fs.nonlinear(stage), hold={"platform.z": 2e-3})
    assert found.shortening == pytest.approx(float(ends.displacement()[0]), rel=0.005)
    assert "not including the foreshortening of" in found.text


def test_the_error_over_strokes_is_that_of_kinematics_alone():
    """Along a stroke the stiffness of a double parallelogram's guide changes by more than its kinematics are off, and the text says so."""
    stage = fs.case("voice-coil-stage")
    found = fs.analyse(stage).second_order
    assert found is not None
    model = fs.nonlinear(stage)
    rates = [1.0 / statics(linearise(fs.equilibrium(model, hold={"platform.x": at}))).compliance.values[1, 1] for at in (0.0, 2e-3)]
    assert abs(rates[1] / rates[0] - 1.0) > found.error
    assert found.text.startswith("Over the strokes the error of linear kinematics is up to")
    assert "Stiffness and frequencies may change by more" in found.text


@pytest.mark.parametrize(("dead", "stiffens"), [(1.5, 0.0), (100.0, 0.5), (1.5, 0.5)])
def test_only_the_load_effect_says_which_stage_results_are_of(dead: float, stiffens: float):
    doubts = Stability(np.array(dead), np.array(dead), np.zeros(1), np.array(stiffens), ("platform",), "by hand").warnings
    assert doubts
    assert not any("told of" in str(each) or "results are for" in str(each) for each in doubts)


def test_stages_guided_by_given_matrices_have_a_stroke_and_no_second_order():
    stage = fs.case("spiral-stage")
    model = fs.nonlinear(stage)
    found = fs.stroke(fs.load_path(model, "platform.z", np.array([0.0, 1e-3])))
    assert found.warnings == ()
    assert fs.analyse(stage).second_order is None
