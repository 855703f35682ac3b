"""The lost-motion budget is exact: on random mechanisms the shares add up to every entry of Lambda."""

from __future__ import annotations

import numpy as np
from hypothesis import given

import flexstage as fs
from tests.laws.strategies import actuated_platforms


def _defect(stage: fs.Mechanism) -> tuple[float, float]:
    result = fs.lost_motion(fs.ideal(stage), fs.lumped(stage))
    total = sum((share.values for share in result.budget.values()), np.zeros_like(result.loss.values))
    loss = result.loss.values
    return float(np.max(np.abs(total - loss))), max(1.0, float(np.linalg.norm(loss)))


@given(actuated_platforms())
def test_shares_add_up_on_random_stages(stage: fs.Mechanism) -> None:
    defect, norm = _defect(stage)
    assert defect <= 1e-12 * norm


@given(actuated_platforms())
def test_corrected_commands_reach_the_wanted_motion(stage: fs.Mechanism) -> None:
    kinematics, model = fs.ideal(stage), fs.lumped(stage)
    result = fs.lost_motion(kinematics, model)
    reached = kinematics.projection @ result.gain.values @ result.correction.values
    np.testing.assert_allclose(reached, np.eye(kinematics.mobility), atol=1e-7)
