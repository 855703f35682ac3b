"""Substructures against the same stage in one mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.modes import modes
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.readings.linear.static import static_gain
from flexstage.readings.solid.monolithic import monolithic
from flexstage.spatial.frame import COMPONENTS
from tests.readings.solids import COARSE, read

TWIST = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)


@pytest.fixture(scope="module")
def whole():
    stage, solid = read("parallelogram")
    return solid.model, monolithic(stage, replace(COARSE, modes=18), cache=None)


def test_modes_agree_and_the_cut_stiffens(whole):
    """Frequencies of the guide within 1 %: the cut at the drive's neck, a rigid face on the platform's block, stiffens the second mode."""
    cut, one = (modes(model).frequencies[:6] for model in whole)
    np.testing.assert_allclose(cut, one, rtol=0.01)
    assert cut[0] == pytest.approx(one[0], rel=1e-3)


def test_gain_of_the_stroke_agrees(whole):
    """The stroke's static gain does not care where the stage was cut, to 1e-3."""
    cut, one = (static_gain(model, TWIST, model.strokes).values[0, 0] for model in whole)
    assert cut == pytest.approx(one, rel=1e-3)
