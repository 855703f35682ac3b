"""Laws of stages that are brought somewhere: what is released and what is locked, in any frame, and what contradicts itself."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.loaded.operating_point import coordinate, operating_point
from flexstage.cases.parallelogram import parallelogram
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.parts.freedom import Freedom
from flexstage.spatial.frame import COMPONENTS, FORCES, spatial_rotation
from flexstage.spatial.rotation import exponential
from tests.laws.test_nonlinear import FINE, UNIT, guide

TWIST = tuple(f"platform.{name}" for name in COMPONENTS)
WRENCH = tuple(f"platform.{name}" for name in FORCES)
DOWN = (-9.80665, 0.0, 0.0)


def compliance(model: LinearModel) -> np.ndarray:
    return static_gain(model, TWIST, WRENCH).values


@pytest.mark.parametrize("locked", ["platform.rz", "platform.z"])
def test_a_lock_takes_its_coordinate_out_of_the_free_compliance(locked: str):
    """C - c c^T / c_ll, c the locked coordinate's column: the Schur complement, where the lock does not itself press."""
    stage = guide(gravity=DOWN)
    free = compliance(operating_point(stage, {"platform.y": 8e-3}).linear)
    state = fs.equilibrium(fs.nonlinear(stage), hold={"platform.y": 8e-3})
    held = {"platform.y": 8e-3, locked: float(coordinate(state, locked))}
    found = compliance(fs.linearise(fs.equilibrium(fs.nonlinear(stage), hold=held), locked=[locked]))
    place = TWIST.index(locked)
    column = free[:, place]
    expected = free - np.outer(column, column) / column[place]
    scale = np.sqrt(np.diag(free))
    assert np.max(np.abs(found - expected) / scale / scale[:, None]) < 1e-6
    assert np.max(np.abs(found[place])) < 1e-12 * np.max(np.abs(found))


def test_the_force_that_brings_a_stage_somewhere_keeps_it_there():
    """Loaded by what was found, it comes to the same place, with the same modes."""
    stage = guide(gravity=DOWN)
    found = operating_point(stage, {"platform.y": 8e-3})
    assert found.held is not None
    force = found.held.at("platform.y", "force")
    again = operating_point(stage, loads={"platform.fy": force})
    assert again.sag.at("platform", "y") == pytest.approx(8e-3, rel=1e-9)
    assert fs.modes(again.linear).frequencies[:6] == pytest.approx(fs.modes(found.linear).frequencies[:6], rel=1e-8)


@pytest.mark.parametrize("held", ["tip.y", "platform.rz"])
def test_what_is_released_moves_as_two_more_equilibria_say(held: str):
    """Compliance under the force that holds a point off the reference, or a component of the rotation vector, by differences."""
    body = replace(guide().bodies["platform"], points={"tip": (0.13, 0.02, 0.01)})
    stage = replace(guide(), bodies={"platform": body})
    model, size = fs.nonlinear(stage, resolution=FINE), {"tip.y": 0.01, "platform.rz": 0.02}[held]
    side = {"platform.fz": 5.0 * UNIT, "platform.mx": 0.02 * UNIT}
    state = fs.equilibrium(model, side, hold={held: size})
    step = 1e-6 * size
    reactions = fs.equilibrium(model, side, hold={held: size + np.array([step, -step])}).reactions[:, 0]
    rate = (reactions[0] - reactions[1]) / (2.0 * step)
    about = fs.linearise(state)
    place = [TWIST[5]] if held == "platform.rz" else ["tip.y"]
    load = [WRENCH[5]] if held == "platform.rz" else ["tip.fy"]
    found = 1.0 / static_gain(about, tuple(place), tuple(load)).values[0, 0]
    tolerance = 2e-3 if held == "platform.rz" else 1e-5  # its moment is about the rotation vector's component, not about z
    assert found == pytest.approx(rate, rel=tolerance)


def test_an_operating_point_keeps_what_was_asked():
    asked = {"platform.x": 1e-4}
    point = operating_point(parallelogram(), asked)
    asked["platform.x"] = 5e-4
    assert point.held is not None
    assert point.held.at("platform.x", "value") == pytest.approx(1e-4)


def test_the_frame_does_not_matter():
    turn = exponential(np.array([0.0, 0.0, 0.5 * np.pi]))
    here = operating_point(guide(gravity=DOWN), {"platform.y": 8e-3}, loads={"platform.fx": -10.0})
    there = operating_point(guide(turn, gravity=tuple(turn @ DOWN)), {"platform.x": -8e-3}, loads={"platform.fy": -10.0})
    assert spatial_rotation(turn).T @ compliance(there.linear) @ spatial_rotation(turn) == pytest.approx(compliance(here.linear), abs=1e-9)
    assert fs.modes(there.linear).frequencies[:6] == pytest.approx(fs.modes(here.linear).frequencies[:6], rel=1e-8)


def test_small_loads_add_up_as_in_the_lumped_model():
    """Sags under two small loads, and under both, against K^-1 f; leaves differ by the shear of their clamps."""
    stage = replace(parallelogram(), gravity=(0.0, 0.0, 0.0))
    loads = {"platform.fx": 0.01, "platform.fz": -0.01}
    both = operating_point(stage, loads=loads).sag.values[0]
    single = sum((operating_point(stage, loads={name: value}).sag.values[0] for name, value in loads.items()), np.zeros(6))
    small = static_gain(fs.lumped(stage), TWIST, tuple(loads)).values @ list(loads.values())
    assert both == pytest.approx(single, rel=1e-5, abs=1e-6 * np.max(np.abs(both)))
    assert both == pytest.approx(small, rel=3e-3, abs=3e-3 * np.max(np.abs(small)))


def test_strokes_stay_and_places_count_from_the_sagged_one():
    stage = parallelogram()
    found = operating_point(stage, {"B": 1e-5}, loads={"platform.fx": 50.0})
    assert found.held is None
    assert found.sag.at("platform", "x") == pytest.approx(
        float(fs.equilibrium(fs.nonlinear(stage), {"platform.fx": 50.0}).displacement()[0])
    )
    assert found.moved is not None
    assert found.moved.at("platform", "x") == pytest.approx(0.987e-5, rel=1e-3)


def test_a_warm_stage_sags_as_it_drifts():
    stage = parallelogram()
    warm = replace(stage, materials={name: replace(each, expansion=12e-6) for name, each in stage.materials.items()}, gravity=(0, 0, 0))
    parts = {name: replace(part, expansion=2e-6) if isinstance(part, fs.Piezo) else part for name, part in warm.parts.items()}
    warm = replace(warm, parts=parts)
    found = operating_point(warm, temperature=0.1).sag.at("platform", "x")
    assert found == pytest.approx(0.1 * float(fs.drift(warm, fs.lumped(warm)).motion.at("platform.x", "uniform")), rel=1e-2)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"at": {"platform.y": 1e-3}, "loads": {"platform.fy": 1.0}}, "platform.fy specifies it"),
        ({"at": {"platform.fx": 1.0}, "loads": {"platform.fx": 1.0}}, "specified both as a constant load and as a drive"),
        ({"at": {"x": 1.0}}, "x: unknown coordinate. Use e.g. platform.x"),
        ({"at": {"platform.q": 1.0}}, "platform.q: unknown coordinate. Use e.g. platform.y"),
        ({"fixed": ["platform.ry", "body.x"]}, "unknown body or point"),
        ({"at": {"platform.rz": 1.5, "platform.y": 0.09}}, "of the displacement"),
        ({"at": {"platform.x": -3e-2}}, "unstable mode"),
        ({"at": {"platform.x": -9e-6}, "loads": {"platform.fy": 1e-3}}, r"stable up to 19% of the displacements\."),
    ],
)
def test_what_cannot_be_is_refused_with_its_reason(asked: dict[str, Any], said: str):
    with pytest.raises(fs.DesignError, match=said):
        operating_point(guide(), **asked)


def test_a_refused_moment_is_stated_with_the_last_sixteenth_that_a_pendulum_bears():
    """A pendulum turns by asin(M / m g l) under a moment M; 1.5 m g l has no equilibrium, and 10/16 of it is the last below m g l."""
    pendulum = fs.Mechanism(
        "pendulum",
        parts={"pivot": fs.Joint((Freedom.RX,))},
        bodies={"platform": fs.Body(mass=2.0, inertia=fs.Inertia(1e-3, 1e-3, 1e-3), centre=(0.0, 0.0, -0.1), reference=(0.0, 0.0, 0.0))},
        links={"pivot": fs.Link(("ground", "platform"), "pivot", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))},
        gravity=(0.0, 0.0, -9.80665),
    )
    most = 2.0 * 9.80665 * 0.1
    moved = operating_point(pendulum, {"platform.mx": 0.9 * most}).moved
    assert moved is not None
    assert moved.at("platform", "rx") == pytest.approx(np.arcsin(0.9), rel=1e-9)
    with pytest.raises(fs.DesignError, match="no equilibrium found") as refused:
        operating_point(pendulum, {"platform.mx": 1.5 * most})
    (stated,) = re.findall(r"at 62% of the displacement \(platform\.mx = ([\d.]+)\)", str(refused.value))
    assert float(stated) == pytest.approx(10.0 / 16.0 * 1.5 * most, rel=1e-3)


def test_drives_that_do_nothing_are_told():
    stage = parallelogram()
    assert [each.where for each in operating_point(stage, loads={"platform.fy": 0.0}).warnings] == ["platform.fy"]


def test_a_traced_load_keeps_what_is_held():
    """A guide whose platform cannot turn, pushed by a force as traced, is the one that holds it there finds."""
    model, held = fs.nonlinear(guide()), {"platform.rz": 1e-4}
    found = fs.continuation(model, {"platform.fy": 1.0}, hold=held, step=0.02, points=4, weight=0.0)
    assert found.locked == ("platform.rz",)
    assert found.state.rotation()[:, 2] == pytest.approx(1e-4, rel=1e-9)
    again = fs.equilibrium(model, {"platform.fy": found.values}, hold=held, weight=0.0)
    assert found.values[-1] > 1.0
    assert found.state.twist() == pytest.approx(again.twist(), abs=1e-9)
    assert found.state.reactions == pytest.approx(again.reactions, rel=1e-6, abs=1e-8)


def test_a_force_off_the_reference_turns_with_its_arm():
    """Held at a point far from the reference, or loaded there by the force that was found: one stage."""
    body = replace(guide().bodies["platform"], points={"tip": (0.5, 0.3, 0.2)})
    model = fs.nonlinear(replace(guide(), bodies={"platform": body}))
    state = fs.equilibrium(model, hold={"tip.y": 0.02})
    loaded = fs.equilibrium(model, {"tip.fy": float(state.reactions[0])})
    found, expected = compliance(fs.linearise(state)), compliance(fs.linearise(loaded))
    scale = np.sqrt(np.diag(expected))
    assert np.max(np.abs(found - expected) / scale / scale[:, None]) < 1e-7
