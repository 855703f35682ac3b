"""Laws of pairing modes: a model pairs with itself; any basis of repeated modes is as good; what differs inside is told apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.modes import modal_assurance
from flexstage.analysis.dynamics.pairing import RELIABLE, Moving, Pair, pair_modes
from flexstage.base.number import Array
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.models.linear.model import Channel, Contribution, LinearModel

SEEN = ("platform.x", "platform.y", "platform.z", "platform.rx", "platform.ry", "platform.rz")
UNITS = ("m", "m", "m", "rad", "rad", "rad")


def of(stage: fs.Mechanism) -> Moving:
    model = fs.lumped(stage)
    return Moving(platform_modes(stage, model), model)


@pytest.mark.parametrize("stage", [case("bridge"), double_triangle(), case("hexapod"), parallelogram()], ids=lambda stage: stage.name)
def test_a_model_pairs_with_itself(stage: fs.Mechanism) -> None:
    own = of(stage)
    found = pair_modes(own, own)
    assert tuple(found) == own.modes.platform
    for index, pair in found.items():
        assert pair.index == index
        assert pair.assurance == pytest.approx(1.0, abs=1e-6)


def test_every_basis_of_repeated_modes_is_as_good() -> None:
    """The tilts and the two translations of a threefold stage, turned within their planes."""
    own = of(double_triangle())
    shapes = np.array(own.modes.shapes)
    for first, second in ((0, 1), (4, 5)):
        turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
        shapes[:, [first, second]] = shapes[:, [first, second]] @ turn
    turned = replace(own, modes=replace(own.modes, shapes=shapes))
    assert all(pair.assurance == pytest.approx(1.0, abs=1e-6) for pair in pair_modes(own, turned).values())


def test_a_single_mode_is_compared_with_all_of_a_pair() -> None:
    """Modes that errors of manufacture set apart, and a model in which they repeat: any basis of the pair is as good, from either side."""
    one = of(double_triangle())
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    shapes, frequencies = np.array(one.modes.shapes), np.array(one.modes.frequencies)
    shapes[:, :2] = shapes[:, :2] @ turn
    frequencies[0] *= 0.97
    apart = replace(one, modes=replace(one.modes, shapes=shapes, frequencies=frequencies))
    assert np.diff(frequencies[:2]) > 0.01 * frequencies[0]
    for first, second in ((apart, one), (one, apart)):
        pairs = pair_modes(first, second)
        assert {pairs[index].index for index in (0, 1)} == {0, 1}
    assert min(pair_modes(apart, one)[index].assurance for index in (0, 1)) == pytest.approx(1.0, abs=1e-6)


def chain(stiffness: Array, masses: Array) -> Moving:
    """Bodies in a row from the ground that move along x only; the platform is the first, all other motions are stiff."""
    count = len(masses)
    size = 6 + count - 1
    along = np.zeros((count, size))
    along[0, 0] = 1.0
    along[range(1, count), range(6, size)] = 1.0
    differences = along - np.vstack([np.zeros(size), along[:-1]])
    held = np.eye(size)[1:6]
    springs = {f"k{index}": Contribution(differences[[index]], np.array([[value]])) for index, value in enumerate(stiffness)}
    inertia = {f"m{index}": Contribution(along[[index]], masses[[index]][None]) for index in range(1, count)}
    platform = Contribution(np.eye(size)[:6], np.diag([*([masses[0]] * 3), 1e-3, 1e-3, 1e-3]))
    outputs = [*(Channel(name, unit) for name, unit in zip(SEEN, UNITS, strict=True)), *(Channel(f"b{i}.x", "m") for i in range(1, count))]
    model = LinearModel(
        coordinates=tuple(channel.name for channel in outputs),
        stiffness={**springs, "held": Contribution(held, 1e9 * np.eye(5))},
        inertia={"platform": platform, **inertia},
        inputs=(),
        force=np.zeros((size, 0)),
        imposed={},
        outputs=tuple(outputs),
        output=np.eye(size),
        feedthrough=np.zeros((size, 0)),
        rigid=np.zeros((size, 6)),
        rigid_output=np.zeros((size, 6)),
        base_inertia=np.zeros((size, 6)),
        damping=None,
        idle=(),
        provenance="chain",
    )
    return Moving(replace(fs.modes(model), platform=tuple(range(count))), model)


def test_modes_that_look_alike_at_the_platform_are_told_apart() -> None:
    """Two bodies on one axis: in both modes the platform moves along x; a softer first spring changes neither which is which."""
    first, second = chain(np.array([2e6, 3e6]), np.array([1.0, 0.8])), chain(np.array([1.8e6, 3.1e6]), np.array([1.05, 0.78]))
    one, two = (each.modes.platform_shapes[:, :2] for each in (first, second))
    alike = modal_assurance(one, two, np.diag([1.0, 1.0, 1.0, 0.1, 0.1, 0.1]))
    assert np.min(alike.values) > 0.999  # by the platform alone all are alike
    pairs = pair_modes(first, second)
    assert [pairs[index].index for index in (0, 1)] == [0, 1]
    assert min(pairs[index].assurance for index in (0, 1)) > 0.95


def test_a_mode_that_the_other_model_has_not_is_not_reliable() -> None:
    """Four bodies here, two there: whatever is nearest to the higher modes is no partner, and two of four have none at all."""
    rich, poor = chain(np.full(4, 1e6), np.full(4, 1.0)), chain(np.full(2, 1e6), np.array([1.0, 3.0]))
    pairs = pair_modes(rich, poor)
    assert not all(pair.reliable for pair in pairs.values())
    assert all(pair.reliable == (pair.assurance >= RELIABLE) for pair in pairs.values())


def test_what_no_output_sees_is_not_alike() -> None:
    """The second body is hidden: a mode that is mostly its motion is no partner of the platform's, however alike the platform moves."""
    whole = chain(np.array([2e6, 1e5]), np.array([1.0, 1.0]))
    alone = chain(np.array([2e6]), np.array([1.0]))
    for found in (pair_modes(alone, whole)[0], pair_modes(whole, alone)[1]):
        assert found.assurance > RELIABLE
        assert found.assurance < 0.999
    assert pair_modes(alone, whole)[0].index == 1


def test_the_masses_may_differ_a_little() -> None:
    """The kinetic energy is compared: by as much as the masses differ, no more."""
    first, second = chain(np.array([2e6]), np.array([1.0])), chain(np.array([2e6]), np.array([1.03]))
    for pairs in (pair_modes(first, second), pair_modes(second, first)):
        assert 1.0 / 1.03 - 1e-9 < pairs[0].assurance < 1.0 + 1e-9


def test_a_pair_is_reliable_from_four_fifths_on() -> None:
    assert not Pair(0, 100.0, 0.79).reliable
    assert Pair(0, 100.0, 0.81).reliable
