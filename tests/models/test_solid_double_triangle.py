"""The shipped stage as a solid, from a cold cache: what symmetry demands, what the paper found, what beam theory may be off by.

In full only, as it takes half a minute of processor time: the parallelogram (`test_solid_stage`) goes the same way in the quick tests.
"""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modal_assurance, modes
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.spatial.frame import COMPONENTS, FORCES
from tests.models.solids import read

pytestmark = pytest.mark.full

TWIST = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)
WRENCH = tuple(f"{PLATFORM}.{name}" for name in FORCES)
WEIGHT = np.diag([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])


@pytest.fixture(scope="module")
def stage():
    """Lumped and solid models."""
    description, solid = read("double-triangle")
    return lumped(description), solid.model


def stiffness(model):
    return np.linalg.inv(static_gain(model, TWIST, WRENCH).values)


def test_in_plane_stiffness_is_isotropic(stage):
    """Three units 120 degrees apart: no principal axes in plane, to 0.5 % (what is left is the mesh's)."""
    block = stiffness(stage[1])[:2, :2]
    values = np.linalg.eigvalsh(block)
    assert values[1] / values[0] - 1.0 < 5e-3


def test_in_plane_stiffness_is_eq_2s_not_table_1s(stage):
    """14.5 N/um within 10 % of Eq. 2's 15.45; Table 1's 2.2 to 2.4 N/um are six times lower."""
    value = stiffness(stage[1])[0, 0] * 1e-6
    assert value == pytest.approx(15.45, rel=0.1)


def test_first_six_modes_are_the_platforms_out_of_plane_first(stage):
    """Order of Fig. 10: tilt twice, z, yaw, x and y; every one below the lumped model's, by less than 10 %."""
    theory, fea = (modes(model, cluster=5e-3) for model in stage)
    assert fea.names[:6] == ("tilt", "tilt", "z", "yaw", *fea.names[4:6])
    assert set(fea.names[4:6]) == {"x", "y"}
    assert fea.platform == tuple(range(6))
    ratio = fea.frequencies[:6] / theory.frequencies[:6]
    assert np.all(ratio < 1.0)
    assert np.all(ratio > 0.9)


def test_modes_pair_with_the_lumped_ones(stage):
    """By the modal assurance criterion of the platform's motion, repeated pairs as subspaces."""
    theory, fea = (modes(model, cluster=5e-3) for model in stage)
    assurance = modal_assurance(theory.platform_shapes[:, :6], fea.platform_shapes[:, :6], WEIGHT).values
    for group in ([0, 1], [2], [3], [4, 5]):
        assert np.all(assurance[np.ix_(group, group)].sum(axis=1) > 0.98), group


def test_vertical_gain_loses_more_than_with_rigid_blocks(stage):
    """dz/da of a vertical unit, 1 without lost motion: the loss grows by the blocks' own give, by less than a third of itself."""
    loss = [1.0 - static_gain(model, TWIST, ("B4",)).values[2, 0] for model in stage]
    assert loss[0] < loss[1] < 4.0 / 3.0 * loss[0]
