"""Every shipped case: sound, readable both ways, elastic close to ideal, and the same in a batch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.dynamics.response import transmissibility
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.base.finding import DesignError
from flexstage.cases.registry import CASES, case
from flexstage.mechanism.checks import check
from flexstage.mechanism.store import dumps, loads
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped

EXPECTED = {
    "double-triangle": (6, 6),
    "double-triangle-a": (6, 6),
    "double-triangle-refitted": (6, 6),
    "parallelogram": (1, 1),
    "xy-stage": (2, 2),
    "xy-stage-floating": (2, 1),
    "bridge": (1, 1),
    "hexapod": (6, 6),
    "tip-tilt": (3, 3),
    "tip-tilt-four": (3, 4),
    "mirror-mount": (0, 0),
    "telescope-mount": (0, 0),
    "tilt-stage": (1, 0),
    "voice-coil-stage": (1, 0),
    "leaf-guide": (1, 0),
    "resonator": (1, 0),
    "quad-suspension": (1, 0),
    "voice-coil-xy": (2, 0),
    "long-travel-xy": (2, 0),
    "three-rrr": (3, 3),
    "stewart": (6, 6),
    "scott-russell": (1, 1),
    "scanner": (1, 1),
    "pointing-stage": (1, 1),
    "spiral-stage": (1, 0),
    "steering-mirror": (2, 0),
    "z-stage": (1, 0),
}
"""Mobility and number of strokes that each case is meant to have."""

LOSS = {"bridge": 0.08, "double-triangle": 0.1, "double-triangle-a": 0.1, "double-triangle-refitted": 0.1}
LOSS |= {"three-rrr": 0.05, "stewart": 0.05, "scott-russell": 0.05, "scanner": 0.08}
"""Lost motion beyond 2 %: an amplifier's output is soft against its guide."""

every = pytest.mark.parametrize("name", CASES)


@every
def test_checks_find_nothing(name):
    assert [str(finding) for finding in check(case(name))] == []


@every
def test_file_and_back(name):
    assert loads(dumps(case(name))) == case(name)


@every
def test_mobility_and_actuators(name):
    found = ideal(case(name))
    assert (found.mobility, len(found.actuators)) == EXPECTED[name]
    assert len(found.gauges) >= 1 or not found.actuators


@every
def test_elastic_reading_is_positive_definite(name):
    model = lumped(case(name))
    K, M = model.stiffness_matrix, model.inertia_matrix
    scale = np.sqrt(np.diag(K))
    assert np.linalg.eigvalsh(K / scale / scale[:, None])[0] > 1e-9
    assert np.linalg.eigvalsh(M)[0] > -1e-12 * np.abs(M).max()
    assert model.idle == ()


@every
def test_lost_motion_is_small(name):
    kinematics = ideal(case(name))
    if not kinematics.actuated:
        return
    found = lost_motion(kinematics, lumped(case(name)))
    feasible = kinematics.actuation @ kinematics.inverse
    assert np.max(np.abs(feasible - found.transfer.values)) < LOSS.get(name, 0.02)


@every
def test_parasitic_motion_is_listed_and_small(name):
    """Below six freedoms, what the platform does besides its ideal motions: less than a tenth of a radian a metre times the arm."""
    kinematics = ideal(case(name))
    if not kinematics.actuated:
        return
    parasitic = lost_motion(kinematics, lumped(case(name))).parasitic.values
    weight = np.array([1.0, 1.0, 1.0, *[kinematics.length] * 3])[:, None]
    assert parasitic.shape == (6, len(kinematics.actuators))
    assert np.max(np.abs(weight * parasitic)) < 0.02
    if kinematics.mobility == 6:
        assert np.max(np.abs(weight * parasitic)) < 1e-9


@every
def test_modes_meet_the_requirement(name):
    """Unless it is the calculation set, whose massless units have no local modes to speak of."""
    stage = case(name)
    found = modes(lumped(stage), limit=stage.max_mode_frequency)
    lowest = float(stage.requirements["frequency.platform.1"].split()[2])
    assert found.platform_frequencies[0] > lowest
    assert np.all(np.diff(found.frequencies) >= 0.0)


@every
def test_floor_motion_is_followed_at_low_frequency(name):
    found = transmissibility(lumped(case(name)), frequencies=np.array([0.001]))
    np.testing.assert_allclose(found.values[0], np.eye(6), atol=1e-5)


BATCHES = {
    "parallelogram": {"spacing": 0.05},
    "xy-stage": {"edge": 0.05},
    "bridge": {"angle": 0.1},
    "hexapod": {"slope": 0.8, "head_radius": 0.055},
    "tip-tilt": {"post_radius": 0.02},
}


@pytest.mark.parametrize("name", BATCHES)
def test_a_batch_is_a_loop(name):
    sizes = np.array([0.9, 1.0, 1.1])
    batch = case(name, {key: value * sizes for key, value in BATCHES[name].items()})
    kinematics, values = ideal(batch), eigen(lumped(batch)).values
    for number, size in enumerate(sizes):
        single = case(name, {key: value * float(size) for key, value in BATCHES[name].items()})
        np.testing.assert_allclose(kinematics.actuation[number], ideal(single).actuation, atol=1e-12)
        np.testing.assert_allclose(values[number], eigen(lumped(single)).values, rtol=1e-7)


def test_a_misspelt_case_names_the_nearest():
    with pytest.raises(DesignError, match=r"hexpod: unknown case. .*hexapod"):
        case("hexpod")


def test_overrides_of_one_copy_reach_one_strut():
    stage = case("hexapod")
    changed = replace(stage, overrides={"A1/front.thickness": 2.5e-3})
    before, after = lumped(stage).stiffness, lumped(changed).stiffness
    different = [name for name in before if not np.allclose(before[name].law, after[name].law, rtol=1e-12)]
    assert different == ["A1/front"]
