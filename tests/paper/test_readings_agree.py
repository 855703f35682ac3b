"""Mapped against lumped: equal where both know the same, and the full difference part by part where they do not."""

from __future__ import annotations

import numpy as np
import pytest

import flexstage as fs
from flexstage.cases.double_triangle import EQUATION_18, SM_REF_A, SM_REF_B, double_triangle
from flexstage.mechanism.restrict import restrict
from flexstage.models.lumped import Masses

BOTH = pytest.mark.parametrize("parameters", [SM_REF_A, SM_REF_B])


@BOTH
def test_mapped_is_lumped_restricted_with_massless_units(parameters: str) -> None:
    stage = double_triangle(parameters)
    restricted = fs.lumped(restrict(stage, EQUATION_18), Masses.PLATFORM)
    simple = fs.mapped(stage)
    np.testing.assert_allclose(fs.modes(restricted).frequencies, fs.modes(simple).frequencies, rtol=1e-4)
    ours, theirs = fs.statics(restricted).stiffness.values, fs.statics(simple).stiffness.values
    np.testing.assert_allclose(ours, theirs, atol=1e-4 * np.max(np.abs(theirs)))


def test_the_platforms_six_are_the_lowest() -> None:
    modes = fs.modes(fs.lumped(double_triangle(SM_REF_B)))
    assert modes.platform == (0, 1, 2, 3, 4, 5)
    assert modes.names[:4] == ("tilt", "tilt", "z", "yaw")
    assert sorted(modes.names[4:6]) == ["x", "y"]
    assert modes.in_plane[:6] == (False, False, False, True, True, True)
    assert modes.share[list(modes.platform)].min() > 0.85
    assert modes.compliance_share[list(modes.platform)].min() > 0.9
    assert modes.compliance_share[6:].max() < 0.1


def test_every_local_mode_below_one_and_a_half_times_the_sixth_is_listed() -> None:
    modes = fs.modes(fs.lumped(double_triangle(SM_REF_B)))
    ceiling = 1.5 * modes.platform_frequencies[-1]
    below = [index for index in range(len(modes.names)) if modes.frequencies[index] < ceiling]
    assert set(below) == set(modes.platform) | set(modes.local)
    assert all(modes.names[index].endswith("local") for index in modes.local)


def test_local_modes_come_in_threes() -> None:
    """The units are equal, so what is local to one is repeated three times (the paper's Fig. 10 shows none among the first six)."""
    modes = fs.modes(fs.lumped(double_triangle(SM_REF_B)))
    assert len(modes.local) % 3 == 0
    assert min(modes.local, default=6) > 5
