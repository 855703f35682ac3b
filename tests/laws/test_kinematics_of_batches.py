"""Kinematics of a batch are those of its designs, to the last bit, whichever design begins it; designs of other mobility are refused."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.requirements import measure
from flexstage.base.finding import DesignError
from flexstage.base.number import Table
from flexstage.base.quantity import LENGTH
from flexstage.cases.registry import CASES
from flexstage.mechanism.address import get, set_value
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.elimination import eliminate, eliminate_each
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.evaluate import piece
from flexstage.studies.sweeps.plan import Plan, Sampling
from flexstage.studies.sweeps.variable import Variable

FACTORS = (1.0, 1.003, 0.998, 1.0007)


def told(case: str, address: str, factors: Sequence[float] | float) -> dict[str, np.ndarray]:
    """What depends on lengths and pivots, of one design or of several."""
    stage = scaled(case, address, factors)
    kinematics = fs.ideal(stage)
    lost = fs.lost_motion(kinematics, fs.lumped(stage))
    many = {"length": np.asarray(kinematics.length), "motion": kinematics.motion, "actuation": kinematics.actuation}
    many |= {"projection": kinematics.projection, "bodies": kinematics.bodies, "sensing": kinematics.sensing}
    return many | {"loss": lost.loss.values, "parasitic": lost.parasitic.values}


def scaled(case: str, address: str, factors: Sequence[float] | float) -> Mechanism:
    stage = CASES[case].build()
    return set_value(stage, address, get(stage, address) * np.asarray(factors))


MOVED = (
    ("tip-tilt", "bodies.platform.solids.holder.diameter"),
    ("double-triangle", "units.vertical.links.upper.at.z"),
    ("xy-stage", "units.pushed.links.left.at.y"),
    ("parallelogram", "links.left.at.x"),
)


@pytest.mark.parametrize(("case", "address"), MOVED)
def test_each_design_of_a_batch_is_itself_whichever_begins_it(case: str, address: str) -> None:
    many, back = told(case, address, FACTORS), told(case, address, FACTORS[::-1])
    for place, factor in enumerate(FACTORS):
        for name, alone in told(case, address, factor).items():
            axes = alone.ndim
            for batch, number in ((many, place), (back, len(FACTORS) - 1 - place)):
                found = batch[name] if batch[name].ndim == axes else batch[name][number]
                np.testing.assert_array_equal(found, alone, err_msg=name)


def study(case: str, address: str, key: str) -> Study:
    """Four designs within 0.3 % of a case's own, and one of their numbers."""
    stage = CASES[case].build()
    value = float(get(stage, address))
    low, high = sorted((0.997 * value, 1.003 * value))
    variable = Variable("place", (address,), LENGTH, low, high)
    columns = Table({"asked": measure(stage, key, "responses.asked")})
    return Study("moved", stage, (variable,), columns, (), Plan(Sampling.SOBOL, 1, count=4))


def test_a_sweep_does_not_depend_on_how_it_is_cut() -> None:
    asked = study(*MOVED[0], "loss.P1")
    whole = piece(asked, 0, 4).responses
    assert np.isfinite(whole).all()
    parts = [piece(asked, start, stop).responses for start, stop in ((0, 1), (1, 4))]
    np.testing.assert_array_equal(np.concatenate(parts), whole)


MOUNT = ("telescope-mount", "units.bipod.links.right_top.end.y")


def test_designs_of_another_mobility_are_told_apart() -> None:
    """A bipod whose strut leaves its plane has motions that the drawn one has not, and in turn."""
    drawn, moved = (fs.ideal(scaled(*MOUNT, factor)).mobility for factor in (1.0, 1.003))
    assert drawn != moved
    with pytest.raises(DesignError, match=r"design 2 of the batch has other motions than the first.*one by one"):
        fs.ideal(scaled(*MOUNT, (1.0, 1.003, 0.998)))
    assert fs.ideal(scaled(*MOUNT, (1.003, 0.998))).mobility == moved


def test_the_pivots_of_a_design_are_its_own() -> None:
    """A pivot of the first design that is nothing in the second made all of the second infinite, or worthless."""
    rows = np.array([[[1.0, 2.0, 0.0, 0.5]], [[1.0, 1e-12, 2.0, 0.5]], [[1.0, 0.3, 2.0, 0.1]]])
    found = eliminate_each(rows, np.ones((3, 4)), keep=(0,))
    assert np.max(np.abs(rows @ found.basis)) < 1e-15
    for place, row in enumerate(rows):
        np.testing.assert_array_equal(found.basis[place], eliminate(row, np.ones(4), keep=(0,)).basis)
    stepped = eliminate_each(rows + 1e-20j * rows[:, :, ::-1], np.ones(4), keep=(0,)).basis
    np.testing.assert_array_equal(np.real(stepped), found.basis)
    assert np.max(np.abs((rows + 1e-20j * rows[:, :, ::-1]) @ stepped)) < 1e-15
