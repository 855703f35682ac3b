"""Laws of superelements at large displacements: linear at rest, without force in a rigid motion, in no frame of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.workspace.load import dead_loads
from flexstage.base.processes.native import SWITCH
from flexstage.models.linear.static import displacement, static_gain
from flexstage.models.nonlinear.compiled import kernel
from flexstage.models.nonlinear.elements.corotated import port_motion, resist, stiffen_ports
from flexstage.models.nonlinear.graph import assemble
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.spatial.frame import COMPONENTS, FORCES
from flexstage.spatial.rotation import exponential
from tests.laws.test_superelement import elastic, part_of, stage

RIGID = exponential(np.array([0.7, -1.1, 0.4]))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> fs.Mechanism:
    return stage(part_of(elastic(3), tmp_path_factory.mktemp("part")), at=(0.1, 0.0, 0.02), along=(0.6, 0.8, 0.0))


@pytest.fixture(scope="module")
def model(whole: fs.Mechanism) -> Nonlinear:
    return fs.nonlinear(whole)


def placed(model: Nonlinear, turn: np.ndarray, shift: np.ndarray, bend: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Bodies of the ports (p, 3), (p, 3, 3) after a deformation and then a rigid motion."""
    (element,) = model.elements
    random = np.random.default_rng(1)
    own = exponential(bend * random.normal(size=(len(element.bodies), 3)))
    position = model.reference[element.bodies] + 0.1 * bend * random.normal(size=(len(element.bodies), 3))
    return (turn @ position[..., None])[..., 0] + shift, turn @ own


def test_at_rest_it_is_the_linear_one(whole: fs.Mechanism, model: Nonlinear) -> None:
    """Frequencies, inner modes among them, and all flexibilities of the platform."""
    near, linear = fs.linearise(fs.equilibrium(model, weight=0.0)), fs.lumped(whole)
    one, two = fs.modes(near).frequencies, fs.modes(linear).frequencies
    np.testing.assert_allclose(one, two, rtol=1e-9)
    names = tuple(f"platform.{each}" for each in COMPONENTS), tuple(f"platform.{each}" for each in FORCES)
    gains = [static_gain(each, *names).values for each in (near, linear)]
    np.testing.assert_allclose(gains[0], gains[1], atol=1e-9 * np.max(np.abs(gains[1])))


def test_beside_flexures_it_resists_in_c_too(whole: fs.Mechanism, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stage of flexures and superelements alone, nothing held."""
    leaf = fs.Link(("ground", "platform"), "leaf", at=(0.0, 0.0, 0.1), along=(0.0, 0.0, 1.0), bends=(1.0, 0.0, 0.0))
    steel = {"steel": fs.Material(young=200e9, poisson=0.3, density=7800.0)}
    parts = {**whole.parts, "leaf": fs.Leaf("steel", length=0.05, thickness=5e-4, width=0.01)}
    both = fs.nonlinear(replace(whole, materials=steel, parts=parts, links={**whole.links, "leaf": leaf}))
    load = {"platform.fx": np.array([1.0, 5.0])}
    fast = fs.equilibrium(both, load).twist()
    monkeypatch.setenv(SWITCH, "off")
    kernel.cache_clear()
    slow = fs.equilibrium(both, load).twist()
    monkeypatch.undo()
    kernel.cache_clear()
    np.testing.assert_allclose(fast, slow, atol=1e-11 * np.max(np.abs(slow)))


def test_a_rigid_motion_takes_no_force(model: Nonlinear) -> None:
    (element,) = model.elements
    force = resist(element, *placed(model, RIGID, np.array([0.3, -2.0, 1.0])), np.zeros(3))
    size = np.max(np.abs(stiffen_ports(element, *placed(model, np.eye(3), np.zeros(3)), np.zeros(3))[1]))
    assert np.max(np.abs(force)) < 1e-13 * size


def test_the_frame_does_not_matter(model: Nonlinear) -> None:
    """Turned with its gravity it resists with the turned force, and its rows are the slopes of its motions."""
    (element,) = model.elements
    gravity, shift = np.array([1.0, -9.0, 3.0]), np.array([0.3, -2.0, 1.0])
    still = resist(element, *placed(model, np.eye(3), np.zeros(3), 0.2), gravity).reshape(-1, 3)
    turned = resist(element, *placed(model, RIGID, shift, 0.2), RIGID @ gravity).reshape(-1, 3)
    np.testing.assert_allclose(turned, still @ RIGID.T, atol=1e-11 * np.max(np.abs(still)))
    position, turn = placed(model, RIGID, shift, 0.2)
    found, step, size = port_motion(element, position, turn), 1e-6, 6 * len(element.bodies)
    for column in range(size):
        by = step * np.eye(size)[column].reshape(-1, 6)
        ends = [port_motion(element, position + sign * by[:, :3], exponential(sign * by[:, 3:]) @ turn).motion for sign in (1.0, -1.0)]
        np.testing.assert_allclose(found.rows[:, column], (ends[0] - ends[1]) / (2.0 * step), atol=1e-8)


def test_the_order_of_ports_does_not_matter(model: Nonlinear) -> None:
    """The frame is no port's: with ports in reverse each resists as before."""
    (element,) = model.elements
    order = np.arange(len(element.bodies))[::-1]
    rows = (6 * order[:, None] + np.arange(6)).ravel()
    names = ("bodies", "arm", "axes", "place")
    other = replace(
        element, relative=element.relative[:, rows], share=element.share[rows], **{name: getattr(element, name)[order] for name in names}
    )
    position, turn = placed(model, RIGID, np.zeros(3), 0.3)
    force = resist(element, position, turn, np.array([0.0, 0.0, -9.8]))
    np.testing.assert_allclose(resist(other, position[order], turn[order], np.array([0.0, 0.0, -9.8])), force[rows], rtol=1e-9)


def test_small_weights_sag_it_as_the_linear_model_says(whole: fs.Mechanism, model: Nonlinear) -> None:
    linear, share = fs.lumped(whole), 1e-6
    load = dead_loads(whole, linear)["own weight"]
    sag = linear.output[linear.output_index(tuple(f"platform.{each}" for each in COMPONENTS))] @ displacement(linear, load[..., None])[:, 0]
    found = fs.equilibrium(model, weight=share).twist() / share
    np.testing.assert_allclose(found, sag, atol=1e-4 * np.max(np.abs(sag)))


def test_under_load_it_is_symmetric_and_heavy(model: Nonlinear) -> None:
    """At equilibrium under dead forces stiffness is symmetric, and the ground carries all weight."""
    state = fs.equilibrium(model, {"platform.fx": 2e3, "platform.fz": -3e3})
    assert bool(state.converged)
    stiffness = assemble(model, state.pose, state.loads, state.hold).stiffness[0]
    np.testing.assert_allclose(stiffness, stiffness.T, atol=1e-8 * np.max(np.abs(stiffness)))
    (element,) = model.elements
    total = resist(element, state.pose.position[0, element.bodies], state.pose.turn[0, element.bodies], state.loads.gravity[0])
    np.testing.assert_allclose(
        total.reshape(-1, 6)[:, :3].sum(axis=0), -element.mass * state.loads.gravity[0], atol=1e-8 * np.max(np.abs(total))
    )
