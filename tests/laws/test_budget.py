"""The lost-motion budget is exact: on random mechanisms the shares add up to every entry of Lambda."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given

import flexstage as fs
from flexstage.models.linear.eigen import eigen
from flexstage.parts.part import Restricted
from tests.conftest import examples
from tests.laws.shared import ideal, lumped
from tests.laws.strategies import actuated_platforms


def _defect(stage: fs.Mechanism) -> tuple[float, float]:
    result = fs.lost_motion(ideal(stage), lumped(stage))
    total = sum((share.values for share in result.budget.values()), np.zeros_like(result.loss.values))
    loss = result.loss.values
    return float(np.max(np.abs(total - loss))), max(1.0, float(np.linalg.norm(loss)))


@examples(12)
@given(actuated_platforms())
def test_shares_add_up_on_random_stages(stage: fs.Mechanism) -> None:
    defect, norm = _defect(stage)
    assert defect <= 1e-12 * norm


def imposed(stage: fs.Mechanism) -> fs.Mechanism:
    """The stage with stacks that nothing stretches: their strokes are imposed."""
    parts = {name: Restricted(part, ()) if isinstance(part, fs.Piezo) else part for name, part in stage.parts.items()}
    return replace(stage, parts=parts)


@examples(12)
@given(actuated_platforms())
def test_shares_add_up_with_imposed_strokes(stage: fs.Mechanism) -> None:
    defect, norm = _defect(imposed(stage))
    assert defect <= 1e-11 * norm


@examples(12)
@given(actuated_platforms())
def test_imposed_strokes_are_the_limit_of_stiff_stacks(stage: fs.Mechanism) -> None:
    """Static gains of platform and gauges, and their response, tend to those of stacks locked along their axes."""
    stiff = {
        name: Restricted(replace(part, stiffness=1e7 * part.stiffness), (fs.Freedom.X,)) if isinstance(part, fs.Piezo) else part
        for name, part in stage.parts.items()
    }
    limit, model = fs.lumped(imposed(stage)), fs.lumped(replace(stage, parts=stiff))
    grid = np.sqrt(eigen(limit).values[0]) / (2.0 * np.pi) * np.array([0.0, 0.5, 1.7])
    found, expected = (
        fs.response(each, ["platform", *stage.gauges], each.strokes, grid, damping=fs.ModalDamping(0.0)).values for each in (limit, model)
    )
    assert np.allclose(found, expected, rtol=0.0, atol=1e-4 * np.abs(expected).max())


@given(actuated_platforms())
def test_corrected_commands_reach_the_wanted_motion(stage: fs.Mechanism) -> None:
    kinematics, model = ideal(stage), lumped(stage)
    result = fs.lost_motion(kinematics, model)
    reached = kinematics.projection @ result.gain.values @ result.correction.values
    np.testing.assert_allclose(reached, np.eye(kinematics.mobility), atol=1e-7)
