"""The errors stated of beam theory: right within 1 % of the compliance, here and there 1.5 %, on hinges that no law was fitted to."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.beams.validity import hinge_dimensions, validity
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular, Profile, Straight
from flexstage.solid.fea.hinges.hinge import hinge_compliance
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.spatial.frame import COMPONENTS
from tools.validation.beam_errors import COUNTS, sampled

SEED = 2026
WITHIN = 1.5
QUICK = ("notch circular", "notch straight", "leaf")
CASES = [*((kind, 1) for kind in QUICK), *(pytest.param(kind, 6, marks=pytest.mark.full) for kind in COUNTS)]


@pytest.mark.parametrize(("kind", "count"), CASES)
def test_errors_stated_are_right(kind: str, count: int) -> None:
    """Beside what the elements themselves leave open: half of the last change of their order."""
    told = 0
    for part, poisson in sampled(kind, count, SEED):
        material = Material(young=1.0, poisson=poisson, density=1.0)
        stated = validity(part, material=material).errors
        told += len(stated)
        found = hinge_compliance(part, material, Accuracy(error=0.0, orders=(3, 5), meshes=1, freedoms=40_000 if count == 1 else 130_000))
        beam = hinge_dimensions(part, poisson).beam
        for axis, error in stated.items():
            index = COMPONENTS.index(axis)
            true = beam[index] / found.compliance[index, index] - 1.0
            left = 0.5 * float(np.nan_to_num(found.changes[index], posinf=0.01))
            assert float(error) == pytest.approx(true, abs=0.01 * WITHIN + left), (part, poisson, axis)
    assert told >= 2 * count


@pytest.mark.full
@pytest.mark.parametrize(
    ("profile", "thickness", "width"), [(Circular(3.0), 0.1, 14.0), (Circular(1.5), 0.3, 20.0), (Straight(2.0), 0.2, 12.0)]
)
def test_the_error_of_very_wide_hinges_is_right(profile: Profile, thickness: float, width: float) -> None:
    """Bending about z, wider than what the law was fitted to: 25 times the root of t R and more, 6 times the length."""
    material = Material(young=1.0, poisson=0.33, density=1.0)
    part = Notch("m", thickness, width, profile)
    found = hinge_compliance(part, material, Accuracy(error=0.01, orders=(2, 3), meshes=1))
    true = hinge_dimensions(part, 0.33).beam[5] / found.compliance[5, 5] - 1.0
    assert float(validity(part, material=material).errors["rz"]) == pytest.approx(true, abs=0.01 * WITHIN)
