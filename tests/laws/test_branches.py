"""What holds of any guide past the load at which it gives way: branches are equilibria, and mirror images where the stage is symmetric."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.finding import LowerBoundError
from flexstage.cases.parallelogram import parallelogram
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.paths.critical_load import Kind, critical_load, unstable_motions
from flexstage.models.nonlinear.paths.load_path import beyond, continuation
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from tests.laws.test_nonlinear import LEAF, UNIT, guide

STEP = 0.02


def random_guide(seed: int) -> tuple[Nonlinear, dict[str, float]]:
    """Two leaves beside one another, symmetric about both planes through their middle, and a load along them."""
    random = np.random.default_rng(seed)
    thickness, width = LEAF.thickness * random.uniform(0.5, 2.0), random.uniform(0.005, 0.03)
    stage = guide(mass=0.0)
    leaf = replace(LEAF, thickness=thickness, width=width)
    return nonlinear(replace(stage, parts={**stage.parts, "leaf": leaf})), {"platform.fx": -UNIT}


@pytest.mark.parametrize("seed", [0, *(pytest.param(each, marks=pytest.mark.full) for each in range(1, 40))])
def test_branches_are_equilibria_and_mirror_images(seed: int):
    model, load = random_guide(seed)
    found = critical_load(model, load, weight=0.0)
    assert found.kind is Kind.BIFURCATION
    both = [beyond(found, load, side=side, step=STEP, points=3) for side in (1.0, -1.0)]
    for one in both:
        again = equilibrium(model, {"platform.fx": one.values * load["platform.fx"]}, weight=0.0, start=one.state)
        assert again.iterations.max() <= 2
        assert again.twist() == pytest.approx(one.state.twist(), abs=1e-8)
        assert unstable_motions(again)[1:].tolist() == one.motions[1:].tolist()
    mine, other = (each.state.twist() for each in both)
    assert both[0].values == pytest.approx(both[1].values, rel=1e-9)
    assert np.abs(mine) == pytest.approx(np.abs(other), abs=1e-9)
    steps = np.diff(np.linalg.norm((mine - other) / np.array([model.size] * 3 + [1.0] * 3), axis=-1)) / 2.0
    assert (steps > 0.0).all()  # shorter where the path turns
    assert steps.max() == pytest.approx(STEP, rel=0.01)
    assert 2.5 * STEP * 0.99 < steps.sum() < 3.5 * STEP


def test_a_limit_is_not_told_as_a_branch():
    """A leaf buckles between its ends, where bodies nearly rest, and takes the platform along: equilibrium goes on by less load."""
    model, load = nonlinear(parallelogram()), {"platform.fy": 1e3}
    found = critical_load(model, load, weight=0.0, tolerance=1e-4)
    assert found.kind is Kind.LIMIT
    after = beyond(found, load, step=1e-4, points=3)
    assert (np.diff(after.values) < 0.0).all()
    assert after.values.max() == pytest.approx(found.factor, rel=1e-6)
    assert (after.motions[1:] == 1).all()


def test_an_imperfect_bifurcation_is_no_critical_load():
    """Weight across the load: no stiffness vanishes, the path is followed to the law's strain.

    Without its weight the stage branches at 11.063 times the load.
    """
    model, load = nonlinear(parallelogram()), {"platform.fx": -1e3}
    with pytest.raises(LowerBoundError, match="strain of 5% there") as error:
        critical_load(model, load)
    assert error.value.bound == pytest.approx(11.063, rel=5e-3)
    after = continuation(model, load, step=0.02, points=2)
    assert (np.diff(after.values) > 0.0).all()
    assert not after.motions.any()
    assert not after.events
