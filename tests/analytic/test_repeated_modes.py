"""Modes that repeat: a platform of six frequencies beside many equal oscillators, every answer known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.dynamics.random_response import Spectrum, random_response
from flexstage.analysis.dynamics.response import default_frequencies
from flexstage.mechanism.mechanism import ModalDamping
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.model import Channel, Contribution, LinearModel
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

PLATFORM = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
"""Frequencies of the platform's six freedoms, in rad/s."""


def beside_oscillators(count: int, rate: float, turn: np.ndarray | None = None) -> LinearModel:
    """Unit masses: a platform on six springs of its own, and `count` oscillators that are all alike.

    With `turn` (n, n) orthogonal, the same system in coordinates q = turn q'.
    """
    size = 6 + count
    change = np.eye(size) if turn is None else turn
    bodies = {"platform": slice(0, 6)} | {f"post {number + 1}": slice(6 + number, 7 + number) for number in range(count)}
    rates = np.concatenate([PLATFORM, np.full(count, rate)])
    return LinearModel(
        coordinates=tuple(f"q{number}" for number in range(size)),
        stiffness={name: Contribution(change[rows], np.diag(rates[rows] ** 2)) for name, rows in bodies.items()},
        inertia={name: Contribution(change[rows], np.eye(len(rates[rows]))) for name, rows in bodies.items()},
        inputs=(),
        force=np.zeros((size, 0)),
        imposed={},
        outputs=tuple(Channel(f"platform.{part}", unit) for part, unit in zip(COMPONENTS, TWIST_UNITS, strict=True)),
        output=change[:6],
        feedthrough=np.zeros((6, 0)),
        rigid=np.zeros((size, 6)),
        rigid_output=np.zeros((6, 6)),
        base_inertia=np.zeros((size, 6)),
        damping=None,
        idle=(),
        provenance="by hand",
    )


@pytest.mark.parametrize("count", [2, 5, 6, 7, 12])
@pytest.mark.parametrize("rate", [4.0, 3.5])  # one of the platform's own frequencies, and none of them
def test_clusters_of_any_size(count: int, rate: float) -> None:
    """More equal modes than the platform has motions leave the platform's six as they are, and every shape an eigenvector."""
    turn, _ = np.linalg.qr(np.random.default_rng(count).normal(size=(6 + count, 6 + count)))
    model = beside_oscillators(count, rate, turn)
    found = modes(model)
    expected = np.sort(np.concatenate([PLATFORM, np.full(count, rate)])) / (2.0 * np.pi)
    np.testing.assert_allclose(found.frequencies, expected, rtol=1e-9)
    np.testing.assert_allclose(found.shapes.T @ model.inertia_matrix @ found.shapes, np.eye(6 + count), atol=1e-9)
    squares = (2.0 * np.pi * expected) ** 2
    np.testing.assert_allclose(found.shapes.T @ model.stiffness_matrix @ found.shapes, np.diag(squares), atol=1e-8)
    np.testing.assert_allclose(found.share.sum(), 6.0, rtol=1e-9)  # the platform's energy over all modes: it has six freedoms


@pytest.mark.parametrize("count", [7, 12])
def test_the_platforms_modes_are_told_from_many_equal_ones(count: int) -> None:
    """Seven and more posts at 3.5 rad/s hide none of the platform's six modes, nor lend them their names."""
    found = modes(beside_oscillators(count, 3.5))
    np.testing.assert_allclose(found.platform_frequencies, PLATFORM / (2.0 * np.pi), rtol=1e-9)
    assert [found.names[index] for index in found.platform] == ["x", "y", "z", "tilt", "tilt", "yaw"]
    assert len(found.local) == count
    assert all("local" in found.names[index] for index in found.local)


def test_small_clusters_follow_the_platforms_axes() -> None:
    """A platform of equal frequencies in x and y, turned by an arbitrary basis, is shown along x and along y."""
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(8, 8)))
    model = beside_oscillators(2, 9.0, turn)
    stiffness = dict(model.stiffness)
    stiffness["platform"] = Contribution(turn[:6], np.diag([1.0, 1.0, 9.0, 16.0, 25.0, 36.0]))
    found = modes(replace(model, stiffness=stiffness))
    np.testing.assert_allclose(np.abs(found.platform_shapes[:2, :2]), np.eye(2), atol=1e-9)


@pytest.mark.parametrize("count", [2, 5, 12])
def test_repeated_modes_are_named_as_a_set_whatever_their_basis(count: int) -> None:
    """Equal posts swing in any mixture: their modes bear the names of all, and shapes follow the posts in order."""
    for seed in range(5):
        turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(6 + count, 6 + count)))
        found = modes(beside_oscillators(count, 3.5, turn))
        assert [found.names[index] for index in found.local] == [f"post 1-post {count} local"] * count
        assert not any(found.in_plane[index] for index in found.local)
        posts = [found.bodies.index(f"post {number + 1}") for number in range(count)]
        assert np.linalg.matrix_rank(found.energies[np.ix_(posts, list(found.local))], tol=1e-6) == count
        plain = modes(beside_oscillators(count, 3.5))
        np.testing.assert_allclose(plain.energies[np.ix_(posts, list(plain.local))], np.eye(count), atol=1e-9)


@pytest.mark.parametrize("rate", [3.5, 4.0])
def test_frequencies_to_respond_at_do_not_count_rounding(rate: float) -> None:
    """Modes that repeat but for rounding are passed once, at their mean: as many lines as where one of them is."""
    lines = [default_frequencies(beside_oscillators(4, rate, turn), (0.1, 2.0), damping=ModalDamping(0.01)) for turn in _turns(10)]
    for found in lines[1:]:
        np.testing.assert_allclose(found, lines[0], rtol=1e-9)
    one = default_frequencies(beside_oscillators(1, rate), (0.1, 2.0), damping=ModalDamping(0.01))
    np.testing.assert_allclose(lines[0], one, rtol=1e-9)


def _turns(size: int) -> list[np.ndarray]:
    return [np.linalg.qr(np.random.default_rng(seed).normal(size=(size, size)))[0] for seed in range(5)]


def test_bodies_that_share_a_mode_equally_are_both_named() -> None:
    """Two equal posts tied by a spring swing together and against each other: both are named, whatever rounding says of their halves."""
    for turn in _turns(8):
        model = beside_oscillators(2, 3.5, turn)
        stiffness = {**model.stiffness, "tie": Contribution(turn[6:7] - turn[7:8], np.ones((1, 1)))}
        found = modes(replace(model, stiffness=stiffness))
        rates = 2.0 * np.pi * found.frequencies[list(found.local)]
        np.testing.assert_allclose(rates, [3.5, np.sqrt(3.5**2 + 2.0)], rtol=1e-9)
        assert [found.names[index] for index in found.local] == ["post 1-post 2 local"] * 2


def test_modes_that_nearly_repeat_are_passed_once() -> None:
    """Frequencies that differ by 1e-8 of themselves are responded to at their mean; no two lines differ by rounding."""
    model = beside_oscillators(2, 3.5)
    second = np.eye(8)[7:]
    near = replace(model, stiffness={**model.stiffness, "more": Contribution(second, np.full((1, 1), 2e-8 * 3.5**2))})
    one, both = (default_frequencies(each, (0.1, 2.0), damping=ModalDamping(0.01)) for each in (beside_oscillators(1, 3.5), near))
    np.testing.assert_allclose(both, one, rtol=1e-7)
    alone = default_frequencies(model, (1.0 / (20.0 * np.pi), 10.0 / (2.0 * np.pi)), damping=ModalDamping(0.01))
    assert np.min(np.diff(np.log(alone))) > 1e-9


def test_modes_that_repeat_are_integrated_over_once() -> None:
    """As many panels for equal posts as for one, whatever their basis; and the same motion of the platform."""
    posts = [beside_oscillators(1, 3.5), *(beside_oscillators(4, 3.5, turn) for turn in _turns(10))]
    push, band, law = {"platform.fx": Spectrum(1.0)}, (0.01, 2.0), ModalDamping(0.01)
    found = [random_response(each, ("platform.x",), push, band, damping=law) for each in posts]
    for each in found[1:]:
        np.testing.assert_allclose(each.frequencies, found[0].frequencies, rtol=1e-9)
        np.testing.assert_allclose(each.rms, found[0].rms, rtol=1e-9)


def test_modes_of_one_model_are_solved_once_and_cannot_be_written_to() -> None:
    model = beside_oscillators(4, 10.0)
    found = eigen(model)
    assert eigen(model) is found
    assert eigen(replace(model)) is not found
    with pytest.raises(ValueError, match="read-only"):
        found.shapes[0, 0] = 0.0
