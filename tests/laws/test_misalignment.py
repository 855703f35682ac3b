"""Laws of misalignment: a copy that stands elsewhere is the copy placed there; a gauge that is turned reads along its own line."""

from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.base.number import Table
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.misalignment import misalign
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Placement
from flexstage.mechanism.store import dumps, loads
from flexstage.mechanism.store.patch import patch
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.spatial.frame import Frame
from flexstage.spatial.rotation import exponential

SHIFT = (1e-3, -2e-3, 0.5e-3)
ROTATION = (0.02, -0.01, 0.03)


def misaligned(stage, name):
    return set_value(set_value(stage, f"{name}.shift", SHIFT), f"{name}.rotation", ROTATION)


def test_a_copy_that_stands_elsewhere_is_the_copy_placed_there():
    stage = parallelogram()
    turned = exponential(np.array(ROTATION))
    placed = Placement("drive", Pose(at=SHIFT, along=tuple(turned[:, 0]), up=tuple(turned[:, 2])))
    moved, there = misaligned(stage, "B"), replace(stage, placements=Table({"B": placed}))
    np.testing.assert_allclose(lumped(moved).stiffness_matrix, lumped(there).stiffness_matrix, rtol=1e-9, atol=1e-3)
    np.testing.assert_allclose(lumped(moved).inertia_matrix, lumped(there).inertia_matrix, rtol=1e-9, atol=1e-12)
    assert not np.allclose(lumped(moved).stiffness_matrix, lumped(stage).stiffness_matrix, rtol=1e-6)


def test_only_the_copy_that_is_named_moves():
    stage = double_triangle()
    before, after = expand(stage), expand(misaligned(stage, "B2"))
    for name, link in after.links.items():
        same = np.array_equal(link.frame.position, before.links[name].frame.position)
        assert same != name.startswith("B2/"), name


def test_a_gauge_reads_along_its_own_line():
    stage = double_triangle()
    frame = expand(stage).gauges["S1"].sights[0].frame
    reference = expand(stage).bodies["platform"].reference
    line = frame.rotation @ exponential(np.array(ROTATION)) @ np.array([1.0, 0.0, 0.0])
    point = frame.position + frame.rotation @ np.array(SHIFT)
    found = ideal(misaligned(stage, "S1")).sensing[0]
    sign = expand(stage).gauges["S1"].sights[0].weight
    np.testing.assert_allclose(found, sign * np.concatenate([line, np.cross(point - reference, line)]), atol=1e-12)


def test_files_say_it_and_nought_is_said_by_nothing():
    stage = misaligned(double_triangle(), "B2")
    assert loads(dumps(stage)) == stage
    text = patch(dumps(double_triangle()), {"B2.shift.x": "5 um", "S1.rotation.z": "20 urad"})
    assert (get(loads(text), "B2.shift.x"), get(loads(text), "S1.rotation.z")) == (5e-6, 2e-5)
    assert get(double_triangle(), "B2.shift") == (0.0, 0.0, 0.0)
    assert not check(stage)


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("B2.shfit.x", "Use shift"),
        ("B2.shift.w", "Use x, y or z"),
        ("B9.shift.x", 'unknown name "B9"'),
        ("horizontal.shift.x", "horizontal"),
    ],
)
def test_addresses_that_point_nowhere(address, said):
    with pytest.raises(DesignError) as caught:
        get(double_triangle(), address)
    assert said in str(caught.value)


def test_an_instance_is_shifted_along_its_own_axes():
    """In a frame that is turned by 90 degrees about z, x of the instance is y of the stage."""
    at = Frame(exponential(np.array([0.0, 0.0, 0.5 * np.pi])), np.array([1.0, 2.0, 3.0]))
    found = misalign(at, {"B2.shift.x": 1e-5}, "B2")
    np.testing.assert_allclose(found.position, [1.0, 2.0 + 1e-5, 3.0], rtol=0.0, atol=1e-15)
