"""Eq. 11 and Table 2 of the paper, from the lumped model of one vertical unit restricted to what the equations know."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.linear_statics.omitted import Restrictions, omitted
from flexstage.beams.compliance import compliance
from flexstage.cases.double_triangle import EQUATION_3, SM_REF_A, SM_REF_B, TABLE_2_FEA, double_triangle
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.restrict import isolate, restrict
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import variants
from flexstage.models.mapped import LeverStiffness, lever_stiffness
from flexstage.parts.freedom import Freedom

COMMANDS = np.array([0.0, 120.0, 240.0, 360.0, 480.0, 600.0])
THEORY = np.array([0.0, 117.0, 234.0, 351.0, 468.0, 585.0])
FEA = np.array([0.0, 116.3, 232.5, 348.8, 465.0, 581.3])
UP = (0.0, 0.0, 1.0)
BOTH = pytest.mark.parametrize("parameters", [SM_REF_A, SM_REF_B])


def _springs(parameters: str) -> LeverStiffness:
    return lever_stiffness(expand(double_triangle(parameters)), "B4/pzt")


def _unit(parameters: str, known: Restrictions) -> fs.LinearModel:
    unit = isolate(double_triangle(parameters), "B4", guide=UP)
    return fs.lumped(restrict(unit, {name: kept for name, kept in known.items() if name in unit.parts}))


@BOTH
def test_first_term_of_equation_11(parameters: str) -> None:
    gain = static_gain(_unit(parameters, EQUATION_3), ("platform.z",), ("B4",)).values[0, 0]
    assert gain == pytest.approx(_springs(parameters).gain, rel=1e-6)


@BOTH
def test_load_term_of_equation_11(parameters: str) -> None:
    compliance = static_gain(_unit(parameters, EQUATION_3), ("platform.z",), ("platform.fz",)).values[0, 0]
    assert compliance == pytest.approx(_springs(parameters).tip_compliance, rel=1e-6)


@BOTH
def test_loss_is_eps_over_one_plus_eps(parameters: str) -> None:
    unit = isolate(double_triangle(parameters), "B4", guide=UP)
    restricted = restrict(unit, EQUATION_3)
    result = fs.lost_motion(fs.ideal(restricted), fs.lumped(restricted))
    softness = _springs(parameters).softness
    assert result.loss.at("B4", "B4") == pytest.approx(softness / (1.0 + softness), rel=1e-9)


def test_theory_column_of_table_2_from_the_shipped_set() -> None:
    gain = static_gain(_unit(SM_REF_B, EQUATION_3), ("platform.z",), ("B4",)).values[0, 0]
    np.testing.assert_allclose(gain / 3.0 * COMMANDS, THEORY, atol=0.1)


@BOTH
def test_theory_column_of_table_2(parameters: str) -> None:
    gain = static_gain(_unit(parameters, EQUATION_3), ("platform.z",), ("B4",)).values[0, 0]
    np.testing.assert_allclose(gain / 3.0 * COMMANDS, THEORY, atol=0.1)


@BOTH
def test_fea_column_of_table_2_with_front_and_pole_bending(parameters: str) -> None:
    gain = static_gain(_unit(parameters, TABLE_2_FEA), ("platform.z",), ("B4",)).values[0, 0]
    np.testing.assert_allclose(gain / 3.0 * COMMANDS, FEA, atol=0.1)


@pytest.mark.parametrize("name", ["foot_notch", "lever_notch", "pole_neck"])
def test_variants_are_the_models_of_a_stage_that_is_restricted_anew(name: str) -> None:
    unit = isolate(double_triangle(), "B4", guide=UP)
    simple = restrict(unit, {part: kept for part, kept in EQUATION_3.items() if part in unit.parts})
    kept = {name: ((Freedom.X, Freedom.RY), (Freedom.RZ,))}
    anew = fs.lumped(restrict(simple, kept))
    one = next(variants(simple, [kept]))
    assert one.coordinates == anew.coordinates
    assert np.array_equal(one.stiffness_matrix, anew.stiffness_matrix)
    assert np.array_equal(one.inertia_matrix, anew.inertia_matrix)
    assert np.array_equal(one.input_matrix, anew.input_matrix)
    assert np.array_equal(one.output, anew.output)
    assert one.unknown == anew.unknown


@BOTH
@pytest.mark.parametrize("channel", [("platform.z", "B4"), ("platform.z", "platform.fz")])
def test_omitted_freedoms_explain_the_full_gain(parameters: str, channel: tuple[str, str]) -> None:
    unit = isolate(double_triangle(parameters), "B4", guide=UP)
    assert omitted(unit, EQUATION_3, channel).unexplained < 1e-3


@pytest.mark.parametrize(("neck_along", "share"), [(fs.X, 0.027), (fs.Z, 0.136)])
def test_the_pivots_own_springs_soften_the_load_term(neck_along: tuple[float, float, float], share: float) -> None:
    """9 C_x + C_y of SM-REF-A's lever hinge: 2.7 % of the load term with its neck along the stack, 13.6 % upright (reference values)."""
    stage = double_triangle(SM_REF_A)
    vertical = stage.units["vertical"]
    links = {**vertical.links, "pivot": replace(vertical.links["pivot"], along=neck_along)}
    turned = replace(stage, units={**stage.units, "vertical": replace(vertical, links=links)})
    costs = omitted(isolate(turned, "B4", guide=UP), EQUATION_3, ("platform.z", "platform.fz"))
    own = compliance(stage.parts["lever_notch"], stage.materials["steel"]).diagonal()
    pushed, lifted = (own[0], own[1]) if neck_along == fs.X else (own[1], own[0])
    assert (9.0 * pushed + lifted) / costs.simple == pytest.approx(share, abs=0.001)
    softness = _springs(SM_REF_A).softness
    found = costs.changes["lever_notch.x"] + costs.changes["lever_notch.y"]
    assert found == pytest.approx(9.0 * pushed / (1.0 + softness) ** 2 + lifted, rel=0.01)


@BOTH
def test_budget_adds_up(parameters: str) -> None:
    stage = double_triangle(parameters)
    result = fs.lost_motion(fs.ideal(stage), fs.lumped(stage))
    total = sum(share.values for share in result.budget.values())
    assert np.max(np.abs(total - result.loss.values)) <= 1e-12 * max(1.0, np.linalg.norm(result.loss.values))


def test_energy_is_half_the_force_of_each_stroke_times_the_stroke():
    """Clapeyron: what a stroke alone strains is half of what its stack is pressed with, times the stroke."""
    stage = double_triangle()
    model = fs.lumped(stage)
    energy = fs.lost_motion(fs.ideal(stage), model).energy
    for name, link in expand(stage).actuators.items():
        pressed = -float(static_gain(model, (f"{link}.fx",), (name,)).values[0, 0])
        total = float(np.sum(energy.values[:, energy.columns.index(name)]))
        assert total == pytest.approx(0.5 * pressed, rel=1e-9)


def test_shares_of_redundant_strokes_add_up_to_their_loss():
    """Four strokes for three motions, one of a softer stack: with what they lose against one another the budget is whole."""
    stage = replace(fs.case("tip-tilt-four"), overrides={"P1/pzt.stiffness": 12.5e6})
    found = fs.lost_motion(fs.ideal(stage), fs.lumped(stage))
    assert np.max(np.abs(found.budget["internal stress"].values)) > 0.2
    np.testing.assert_allclose(sum(each.values for each in found.budget.values()), found.loss.values, atol=1e-12)
