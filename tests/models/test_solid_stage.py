"""Laws of stages read as solids, and what they share with the other models."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from flexstage.analysis.assessment.judge import required_values as judged
from flexstage.analysis.dynamics.modes import modes
from flexstage.base.finding import DesignError
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import PLATFORM, Link, Mechanism
from flexstage.models.linear.static import displacement, static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.geometry.cad import cad
from flexstage.solid.fea.solver.assemble import linear_model
from flexstage.solid.fea.solver.casing import casing
from flexstage.solid.fea.solver.component import components
from flexstage.solid.results.read import SolidRead
from flexstage.solid.results.resolution import Resolution
from flexstage.solid.results.stress import _yield
from flexstage.solid.results.verification import required_values
from flexstage.spatial.frame import COMPONENTS, FORCES, Frame, spatial_rotation, turn_z, twist_transform
from tests.laws.strategies import moved
from tests.models.solids import parts_of, read
from tests.stock import STEEL

TWIST = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)
WRENCH = tuple(f"{PLATFORM}.{name}" for name in FORCES)
METRE = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])


@pytest.fixture(scope="module")
def guide():
    """The parallelogram guide and its solid model."""
    return read("parallelogram")


def compliance(model):
    return static_gain(model, TWIST, WRENCH).values * METRE[:, None] * METRE


def test_same_names_as_the_lumped_model(guide):
    stage, solid = guide
    other = lumped(stage)
    assert [channel.name for channel in solid.model.inputs] == [channel.name for channel in other.inputs]
    assert [channel.name for channel in solid.model.outputs] == [channel.name for channel in other.outputs]


def test_stiffness_and_inertia_are_positive(guide):
    _, solid = guide
    for matrix in (solid.model.stiffness_matrix, solid.model.inertia_matrix):
        scale = 1.0 / np.sqrt(np.diag(matrix))
        assert np.linalg.eigvalsh(matrix * scale * scale[:, None])[0] > 0.0


def test_reciprocity_of_stroke_and_force(guide):
    """A stroke moves the platform as the platform's load presses the stack: two computations, one number (Betti)."""
    _, solid = guide
    forward = static_gain(solid.model, TWIST, ("B",)).values[:, 0]
    backward = static_gain(solid.model, ("B/pzt.fx",), WRENCH).values[0]
    # The stack's tension falls when its output moves: motion per stroke = -(-k e)^T C; both sides are pure numbers.
    assert np.abs(forward - backward).max() < 1e-6 * np.abs(forward).max()


def test_superelements_do_not_resist_rigid_motion(guide):
    """Where nothing is held by the ground, interfaces moved rigidly strain nothing."""
    _, solid = guide
    seen = 0
    for component, element in parts_of(solid):
        if component.fixed or not component.interfaces:
            continue
        whole = sum(element.stiffness.values())
        outer = np.tile(METRE, element.interfaces)[:, None]
        force = outer * (whole @ element.rigid)[: 6 * element.interfaces] * METRE
        assert np.abs(force).max() < 1e-9 * np.abs(outer * whole[: 6 * element.interfaces, : 6 * element.interfaces] * outer.T).max()
        seen += 1
    assert seen >= 2


def test_mass_is_that_of_the_outlines(guide):
    """The plate's exactly. The round adapters share a medium with their necks: elements of the joint, counted by centre, hold 2 %."""
    stage, solid = guide
    for (name, body), error in zip(expand(stage).bodies.items(), (1e-12, 0.02, 0.02), strict=True):
        own = solid.model.inertia[name].law
        assert own[0, 0] == pytest.approx(float(body.mass.mass), rel=error), name


def test_mass_of_a_whole_component_is_its_drawings(guide):
    """Necks and adapters together, however counted: the meshed volume against that of the CAD solids."""
    _, solid = guide
    for component, element in parts_of(solid):
        if not component.fixed:
            drawing = cad(component)
            weight = 1e-9 * drawing.shape.mass * drawing.media[0].density  # one medium each; mm^3
            assert (element.rigid.T @ element.carried)[0, 0] == pytest.approx(weight, rel=2e-3), component.name


def test_stack_has_its_stated_stiffness_and_stroke(guide):
    """The stack alone, free: its stroke; held: its blocking force; pulled: its stiffness (end caps plane)."""
    stage, solid = guide
    part = expand(stage).links["B/pzt"].part
    component, element = next((one, other) for one, other in parts_of(solid) if one.name.endswith("pzt"))
    whole = sum(element.stiffness.values())
    boundary = whole[:12, :12]
    axis = component.pieces[0].frame.rotation[:, 0]
    apart = np.concatenate([-0.5 * axis, np.zeros(3), 0.5 * axis, np.zeros(3)])
    ends = [item.joint.frame.position @ axis for item in component.interfaces]
    sign = np.sign(ends[1] - ends[0])
    stiffness = apart @ boundary @ apart
    assert stiffness == pytest.approx(part.stiffness, rel=0.01)
    free = next(iter(element.free_strokes.values()))
    stroke = next(iter(element.strokes.values()))
    assert (free[6:9] - free[:3]) @ axis * sign == pytest.approx(1.0, rel=1e-12)
    assert np.abs(whole @ free - stroke).max() < 1e-6 * np.abs(stroke).max()
    blocked = stroke[:12] @ apart * sign
    assert blocked == pytest.approx(part.stiffness, rel=0.01)


def is_drawn_in_the_stage(component):
    return np.array_equal(component.place.rotation, np.eye(3)) and not np.any(component.place.position)


def test_moving_the_stage_changes_only_frames(guide):
    """The same superelements in a turned and shifted stage: compliance turns with it."""
    stage, solid = guide
    turn, shift = turn_z(0.7), np.array([0.1, -0.2, 0.05])
    there_stage = moved(stage, turn, shift)
    placed = tuple(
        (replace(old, place=Frame(turn, shift)) if is_drawn_in_the_stage(old) else new, element)
        for new, (old, element) in zip(components(there_stage), parts_of(solid), strict=True)
    )
    there = linear_model(there_stage, expand(there_stage), placed, "moved")
    carry = spatial_rotation(turn)
    expected = carry @ compliance(solid.model) @ carry.T
    assert np.abs(compliance(there) - expected).max() < 1e-9 * np.abs(expected).max()
    np.testing.assert_allclose(modes(there).frequencies[:6], modes(solid.model).frequencies[:6], rtol=1e-9)


def test_stress_resultants_balance_the_load(guide):
    """Under a force on the platform, the forces that all links pass to it add up to the force."""
    stage, solid = guide
    model, assembly = solid.model, expand(stage)
    motion = displacement(model, model.input_matrix[:, model.input_index((f"{PLATFORM}.fx", f"{PLATFORM}.fz"))])
    total = np.zeros((6, 2))
    centre = assembly.bodies[PLATFORM].reference
    for name, link in assembly.links.items():
        if PLATFORM in link.joins:
            sign = 1.0 if link.joins[1] == PLATFORM else -1.0
            own = model.output[model.output_index(tuple(f"{name}.{part}" for part in FORCES))] @ motion
            total += sign * twist_transform(link.frame, centre).T @ own
    assert np.abs(total[:3] - np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])).max() < 1e-8


def test_softer_than_beam_theory_by_a_little(guide):
    """Rigid blocks on beam hinges are stiffer than the solid, by a few per cent here: six modes up to 10 % lower."""
    stage, solid = guide
    ours, theirs = modes(solid.model).frequencies[:6], modes(lumped(stage)).frequencies[:6]
    assert np.all(ours < theirs)
    assert np.all(ours > 0.9 * theirs)


def test_free_stage_is_named(guide):
    """Held by nothing, the stage moves freely, and the finding says what moves."""
    stage, solid = guide
    released = tuple(
        (part, replace(element, stiffness={name: 0.0 * law for name, law in element.stiffness.items()}))
        for part, element in parts_of(solid)
    )
    with pytest.raises(DesignError, match="no stiffness"):
        linear_model(stage, expand(stage), released, "released")


def test_an_encased_stack_does_not_bend_without_its_casing() -> None:
    """Three stacks of 162 mm at right angles: 1.3 kHz. Their ceramic alone, held at both ends, would bend at 530 Hz."""
    sizes = {"length": 0.162, "diameter": 0.01, "mass": 0.167, "bending_rigidity": 387.0}
    stack = Piezo(stroke=150e-6, stiffness=17e6, **sizes)
    faces = {"x": (-0.09, 0.0, 0.0), "y": (0.0, -0.09, 0.0), "z": (0.0, 0.0, -0.09)}
    stage = Mechanism(
        "stacks",
        materials={"steel": STEEL},
        parts={"stack": stack},
        bodies={"platform": Body(mass=0.1, inertia=Inertia(1e-5, 1e-5, 1e-5))},
        links={axis: Link(("ground", "platform"), "stack", at, tuple(float(each == axis) for each in "xyz")) for axis, at in faces.items()},
        requirements={"frequency.1": "at least 1 Hz"},
    )
    theory, found = judged(stage)["frequency.1"], required_values(stage, Resolution(order=2)).values["frequency.1"]
    assert found == pytest.approx(theory, rel=0.03)


def test_the_yield_stress_of_a_body_is_that_of_its_weakest_solid() -> None:
    """Of a body of hard and soft solids the lower limit counts, in either sequence; without one of the limits it is unknown."""
    solids = {name: SimpleNamespace(solid=SimpleNamespace(material=name)) for name in ("hard", "soft")}
    limits = {"hard": replace(STEEL, yield_stress=1e9), "soft": replace(STEEL, yield_stress=1e8)}
    assembly = cast("Assembly", SimpleNamespace(links={}, bodies={"block": SimpleNamespace(solids=solids)}))
    for materials, expected in ((limits, 1e8), ({**limits, "soft": replace(STEEL, yield_stress=None)}, np.nan)):
        read = cast("SolidRead", SimpleNamespace(mechanism=SimpleNamespace(materials=materials)))
        np.testing.assert_equal(_yield(read, assembly, "block"), expected)


def test_a_casing_is_the_tube_that_makes_a_stack_a_thicker_rod() -> None:
    """Of the ceramic's material, from 10 to 14 mm: G J/L in torsion, E I/L in bending, 12 E I/L^3 across, with I and J of a ring."""
    size, inner, outer, poisson = 0.1, 10e-3, 14e-3, 0.25
    young = 20e6 * size / (np.pi * inner**2 / 4.0)
    second, polar = (np.pi * (outer**4 - inner**4) / part for part in (64.0, 32.0))
    stack = Piezo(
        stroke=1e-4,
        stiffness=20e6,
        length=size,
        diameter=inner,
        poisson=poisson,
        bending_rigidity=young * np.pi * outer**4 / 64.0,
    )
    link = Link(("ground", "platform"), "stack", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    body = Body(mass=1.0, inertia=Inertia(1e-3, 1e-3, 1e-3))
    law = casing(expand(Mechanism("tube", parts={"stack": stack}, bodies={"platform": body}, links={"stack": link})).links["stack"])
    across, bending, torsion = 12.0 * young * second / size**3, young * second / size, young / (2.0 * (1.0 + poisson)) * polar / size
    assert law == pytest.approx(np.diag([0.0, across, across, torsion, bending, bending]), rel=1e-9)
