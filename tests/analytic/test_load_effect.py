"""Stages under their own weight: what is told of them is loaded where that is felt, against beam columns, and unchanged elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.judge import judge
from flexstage.analysis.load_effect import FELT, load_effect
from flexstage.analysis.stability import prestress, stability
from flexstage.cases.parallelogram import parallelogram
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
    assert "those of the loaded stage" in found.loaded.text


def test_hanging_leaves_are_stiffer():
    found = load_effect(upright(2.5, down=-1.0))
    assert found is not None
    assert found.model is not None
    stiffness = 1.0 / fs.statics(found.model).compliance.at("platform.x", "platform.fx")
    assert stiffness == pytest.approx(column(-9.80665 * 2.5), rel=1e-4)


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
    assert abs(found.loaded.change) < FELT
    assert found.felt is found.linear
    assert found.modes is not None
    assert np.array_equal(found.modes.frequencies, fs.modes(drawn).frequencies)
    assert found.loaded.text.startswith("Weight, payloads and forces change no stiffness by more than 0.042 %")


def test_the_bound_is_one():
    """No stiffness changes by more than 1 / load factor, whatever is looked at."""
    stage = upright(0.04)
    found, bound = load_effect(stage), 1.0 / float(stability(stage, fs.lumped(stage)).dead)
    assert found is not None
    assert 0.5 * bound < abs(found.change) <= 1.001 * bound


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
