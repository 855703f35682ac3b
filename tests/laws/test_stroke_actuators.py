"""Laws of actuators whose free deformation is any vector: shear piezos, amplified ones, drives that step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexstage.analysis.linear_statics.inner_stage import amplified
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.workspace.blocking import stack_lines
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.base.units.scale import X, Z, mm
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.incidence import deformation, layout
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.mechanism.restrict import restrict
from flexstage.mechanism.store import dumps, loads
from flexstage.models.finite import forward_kinematics
from flexstage.models.ideal import ideal
from flexstage.models.linear.static import displacement, static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.amplified import Amplified, SteppingDrive
from flexstage.parts.body import Body, Inertia
from flexstage.parts.freedom import ALL
from flexstage.parts.leaf import Leaf
from flexstage.parts.shear_piezo import ShearPiezo
from flexstage.spatial.frame import spatial_rotation
from tests.laws.strategies import mechanisms, moved, turns
from tests.laws.test_mechanisms import METRE, TWIST, WRENCH, near, rounding

FEW = settings(max_examples=15)
SHEAR = ShearPiezo(stroke=3e-6, stiffness=2e8, axial_stiffness=6e8, length=10 * mm, width=10 * mm, depth=10 * mm, mass=0.01)
STIFF = (2e7, 1e7, 1e7, 3e3, 2e3, 2e3)
STEPS = SteppingDrive(travel=1e-3, resolution=1e-8, diagonal=STIFF, holding_force=5.0, mass=0.05)


@st.composite
def amplifieds(draw):
    """Any free deformation, any stiffness of six freedoms."""
    whole = st.integers(-5, 5)
    shift, turn = (tuple(draw(whole) * step for _ in range(3)) for step in (1e-5, 1e-4))
    return Amplified(stroke=1e-4, deformation=(1e-4, *shift[1:], *turn), diagonal=STIFF, mass=0.1, inertia=Inertia(1e-5, 2e-5, 2e-5))


@st.composite
def driven(draw):
    """Random mechanisms whose stacks are other stroke actuators."""
    stage = draw(mechanisms())
    kinds = {name: draw(st.just(SHEAR) | st.just(STEPS) | amplifieds()) for name in stage.parts if name.startswith("stack")}
    return replace(stage, parts={**stage.parts, **kinds})


@FEW
@given(driven())
def test_strokes_are_felt_as_their_links_strain_by_betti(stage):
    """dx/du = C G^T k s: a wrench on the platform strains the link, and k s does the work of the stroke on that strain."""
    assert not check(stage)
    model, assembly = lumped(stage), expand(stage)
    order, names = layout(assembly), tuple(assembly.strokes)
    motion = displacement(model, model.input_matrix[:, model.input_index(WRENCH)])
    rows = []
    for name, link in assembly.strokes.items():
        strained = deformation(assembly, order, assembly.links[link]) @ motion
        rows.append(assembly.actuator(name).free_deformation @ model.stiffness[link].law @ strained)
    near(static_gain(model, TWIST, names).values * METRE[:, None], np.stack(rows).T * METRE[:, None], rounding(model))


@FEW
@given(driven(), turns())
def test_moving_a_driven_stage_changes_only_frames(stage, move):
    here, there = lumped(stage), lumped(moved(stage, *move))
    gains = [static_gain(model, TWIST, model.strokes).values for model in (here, there)]
    near(gains[1] * METRE[:, None], spatial_rotation(move[0]) @ gains[0] * METRE[:, None], rounding(here))


def alone(part):
    """A platform on nothing but the actuator, at an angle."""
    return Mechanism(
        name="one actuator",
        parts={"drive": part},
        bodies={PLATFORM: Body(mass=1.0, centre=(0.0, 0.01, 0.02), inertia=Inertia(1e-3, 1e-3, 1e-3))},
        links={"drive": Link((GROUND, PLATFORM), "drive", (0.0, 0.0, 0.0), (1.0, 1.0, 0.0), bends=Z)},
        damping=None,
    )


TURNED = Amplified(stroke=1e-4, deformation=(-1e-4, 2e-5, 0.0, 0.0, 0.0, 1e-3), diagonal=STIFF, mass=0.1)


@pytest.mark.parametrize("part", [SHEAR, STEPS, TURNED])
def test_a_platform_on_the_actuator_follows_its_free_deformation(part):
    """Ideal, lumped and restricted to locked freedoms: all say s u at the platform; finite motion says so to second order."""
    stage = alone(part)
    assert not check(stage)
    assert loads(dumps(stage)) == stage
    assembly = expand(stage)
    carry = deformation(assembly, layout(assembly), assembly.links["drive"])
    free = np.linalg.solve(carry, part.free_deformation)
    found = ideal(stage)
    near(found.motion @ np.linalg.pinv(found.actuation), free[:, None], 1e-9)
    near(static_gain(lumped(stage), TWIST, ("drive",)).values[:, 0], free, 1e-9)
    small = 1e-9
    pose = forward_kinematics(stage, found, np.array([small])).pose.vector
    near(pose / small, free, 1e-6)
    line = stack_lines(stage, lumped(stage))
    assert line.free == pytest.approx([np.real(part.stroke)])
    assert line.force == pytest.approx([0.0], abs=1e-6 * line.blocking.item())
    assert stroke_limits(stage).full == pytest.approx([np.real(part.stroke)])


def test_ideal_is_the_limit_of_lumped_for_any_free_deformation():
    """Held by a stiff spring the loss goes to zero as the actuator gets stiffer than it; locked, it is imposed exactly."""
    stage = alone(TURNED)
    with pytest.raises(Exception, match="nothing is elastic"):
        lumped(restrict(stage, {"drive": ((), ())}))
    assert abs(lost_motion(ideal(stage), lumped(stage)).loss.values.item()) < 1e-9


def test_what_is_missing_is_said():
    """A stiffness across, one of three; a shear stiffness that bending alone exceeds; free freedoms are stated."""
    bare, both = (alone(Amplified(stroke=1e-4, **stated)) for stated in ({}, {"diagonal": STIFF, "matrix": TURNED_MATRIX}))
    assert [each.where for each in check(bare)] == ["parts.drive"]
    assert "diagonal and matrix" in check(both)[0].what
    assert check(alone(replace(SHEAR, stiffness=9e9)))[0].where == "parts.drive.stiffness"
    assert Amplified(stroke=1e-4, diagonal=STIFF, free=ALL[3:]).intended == ALL[3:]
    assert STEPS.blocking_force == pytest.approx(2e4)


TURNED_MATRIX = tuple(map(tuple, TURNED.between.tolist()))


def test_a_stage_inside_another_one_gives_what_it_gives_itself():
    """The bridge as a part on a spring of links: compliance, motion and force at the platform to rounding."""
    inner = case("bridge")
    part = amplified(inner)
    centre = tuple(expand(inner).bodies[PLATFORM].reference.tolist())
    outer = Mechanism(
        name="bridge as a part",
        parts={"bridge": part},
        bodies={PLATFORM: Body(mass=0.1, reference=centre)},
        links={"drive": Link((GROUND, PLATFORM), "bridge", centre, X, bends=Z)},
    )
    assert not check(outer)
    models = lumped(inner), lumped(outer)
    loaded = [static_gain(model, TWIST, WRENCH).values * METRE[:, None] * METRE for model in models]
    near(loaded[1], loaded[0], 1e-6)
    strokes = (inner.parts["stack"].stroke, part.stroke)
    full = [
        static_gain(model, TWIST, model.actuators).values * METRE[:, None] * stroke for model, stroke in zip(models, strokes, strict=True)
    ]
    near(full[1], full[0], 1e-6)


def test_a_stage_inside_another_one_weighs_what_its_bodies_links_and_stack_weigh():
    """The part's mass is the sum of the bodies, of density times volume of every leaf, and of the stack."""
    inner = case("bridge")
    assembly = expand(inner)
    leaves = [link for link in assembly.links.values() if isinstance(link.part, Leaf)]
    blades = sum(link.material.density * link.part.length * link.part.thickness * link.part.width for link in leaves)
    bodies = sum(float(body.mass.mass) for body in assembly.bodies.values())
    assert len(leaves) == len(assembly.links) - 1
    assert amplified(inner).mass == pytest.approx(bodies + blades + inner.parts["stack"].mass, rel=1e-12)


def test_a_shear_piezo_bends_about_each_axis_by_its_own_second_moment():
    """Both shear compliances are equal: those of the faces differ by L^3/12 (1/(E I_y) - 1/(E I_z))."""
    flat = replace(SHEAR, depth=5 * mm)
    young = flat.axial_stiffness * flat.length / (flat.width * flat.depth)
    moments = flat.width * flat.depth / 12.0 * np.array([flat.depth**2, flat.width**2])  # about y, about z
    expected = flat.length**3 / (12.0 * young) * (1.0 / moments[0] - 1.0 / moments[1])
    assert flat.compliance[2, 2] - flat.compliance[1, 1] == pytest.approx(expected, rel=1e-12)


def test_the_faces_of_an_amplified_actuator_have_its_inertia_together():
    """Both faces move with a rigid motion of the actuator: its kinetic energy is that of its mass and inertia."""
    part = Amplified(stroke=1e-4, diagonal=STIFF, mass=0.1, inertia=Inertia(1e-5, 2e-5, 3e-5))
    rigid = np.vstack([np.eye(6), np.eye(6)])
    np.testing.assert_allclose(rigid.T @ part.carried @ rigid, np.diag([0.1, 0.1, 0.1, 1e-5, 2e-5, 3e-5]), rtol=1e-12, atol=1e-20)
