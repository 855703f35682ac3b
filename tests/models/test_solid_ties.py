"""Parts without a shape in stages of solids: by what they state, where they end on a body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.units.scale import X, Z, mm
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.amplified import Amplified, SteppingDrive
from flexstage.parts.body import Block, Body, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.contact import Contact
from flexstage.parts.force_actuator import ForceActuator
from flexstage.parts.shear_piezo import ShearPiezo
from flexstage.parts.spring import Spring
from flexstage.parts.voice_coil import Supply, VoiceCoil
from flexstage.solid.fea.jobs.content import content
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.fea.solver.component import components
from flexstage.solid.fea.solver.ties import in_words, stated_links
from flexstage.solid.results.read import model
from flexstage.solid.results.resolution import Resolution
from flexstage.solid.results.verification import verify
from flexstage.solid.show.tables import verdict_table_of
from tests.laws.test_superelement import elastic, part_of
from tests.roundtrip.test_gltf import leaf_stage
from tests.stock import STEEL

COARSE = Reduction(Fineness(neck=3.0, block=3.0, grading=0.8, order=2), modes=4)
FINER = Reduction(Fineness(neck=3.0, block=3.0, grading=0.8, order=3), modes=4)
SIX = (2e6, 3e6, 4e6, 50.0, 60.0, 70.0)
DIAGONAL = tuple(tuple(1.0 / SIX[i] if i == j else 0.0 for j in range(6)) for i in range(6))
COUPLED = tuple(tuple(SIX[i] if i == j else 0.0 if {i, j} != {1, 5} else 4e3 for j in range(6)) for i in range(6))
PARTS = {
    "spring": Spring(matrix=COUPLED, length=20 * mm, mass=0.02, loss_factor=0.1),
    "given": ComplianceMatrix(DIAGONAL, free=(), mass=0.03, centre=(1 * mm, 2 * mm, 3 * mm), inertia=Inertia(1e-6, 2e-6, 3e-6)),
    "amplified": Amplified(stroke=1e-4, deformation=(1e-4, 1e-5, 0.0, 0.0, 0.0, 1e-4), diagonal=SIX, mass=0.05),
    "stepper": SteppingDrive(travel=1e-3, diagonal=SIX, mass=0.04),
    "shear": ShearPiezo(
        stroke=1e-6, stiffness=2e7, axial_stiffness=2e8, length=10 * mm, width=10 * mm, depth=8 * mm, mass=0.01
    ),
    "force": ForceActuator(mass=0.02),
    "coil": VoiceCoil(force_constant=8.0, resistance=4.0, stiffness=-2e3, damping=3.0, mass=0.1, magnet_mass=0.2, drive=Supply.VOLTAGE),
    "ball": Contact("steel", "steel", radius=4 * mm, preload=20.0),
}  # fmt: skip


def chain() -> Mechanism:
    """Two rigid bodies, each kind of part between the ground, the one and the other, none of them along an axis of the stage."""
    inertia = Inertia(2e-5, 3e-5, 4e-5)
    bodies = {
        "platform": Body(mass=0.2, centre=(10 * mm, 0.0, 5 * mm), inertia=inertia),
        "middle": Body(mass=0.1, centre=(-20 * mm, 1 * mm, 0.0), inertia=inertia),
    }
    joins = (("ground", "middle"), ("middle", "platform"), ("ground", "platform"))
    links = {
        name: Link(joins[number % 3], name, (number * 7 * mm, -number * 3 * mm, number * mm), (1.0, 0.5, 0.2 * number), (-1.0, 2.0, 0.0))
        for number, name in enumerate(PARTS)
    }
    return Mechanism("chain", materials={"steel": STEEL}, parts=PARTS, bodies=bodies, links=links)


def agree(first, second, tolerance):
    """Both models have the same inputs and outputs, and the same answer to each, static and in motion with the ground."""
    assert [each.name for each in first.inputs] == [each.name for each in second.inputs]
    names = tuple(each.name for each in first.outputs)
    assert names == tuple(each.name for each in second.outputs)
    inputs = tuple(each.name for each in first.inputs)
    one, other = (static_gain(each, names, inputs).values for each in (first, second))
    scale = np.max(np.abs(other), axis=1, keepdims=True)
    np.testing.assert_allclose(one / np.where(scale > 0.0, scale, 1.0), other / np.where(scale > 0.0, scale, 1.0), atol=tolerance)
    weights = [each.rigid.T @ each.base_inertia for each in (first, second)]
    np.testing.assert_allclose(*weights, atol=1e-9 * np.max(np.abs(weights[1])))


def test_between_rigid_bodies_every_part_does_what_it_states():
    """Nothing is meshed: both models are the same numbers, put together by code that shares none."""
    stage = chain()
    solid, lumps = model(stage, COARSE, cache=None), lumped(stage)
    agree(solid, lumps, 1e-9)
    np.testing.assert_allclose(eigen(solid).values, eigen(lumps).values, rtol=1e-9)
    assert solid.stiffness["spring"].loss_factor == 0.1
    assert all(item.loss_factor == lumps.stiffness[name].loss_factor for name, item in solid.stiffness.items())
    np.testing.assert_allclose(solid.viscous["coil"], lumps.viscous["coil"])


def test_a_superelement_keeps_its_ports_its_modes_and_its_mass(tmp_path):
    body = elastic(3, ports=3, inner=8)
    part = part_of(body, tmp_path, loss_factor=0.02)
    names = dict(zip(part.ports, ("ground", "platform", "other"), strict=True))
    own = Body(mass=0.3, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-3, 2e-3, 3e-3))
    link = Link(names, "frame", (10 * mm, 0.0, 5 * mm), (1.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    stage = Mechanism("element", parts={"frame": part}, bodies={"platform": own, "other": own}, links={"frame": link})
    solid, lumps = model(stage, COARSE, cache=None), lumped(stage)
    agree(solid, lumps, 1e-9)
    np.testing.assert_allclose(eigen(solid).values, eigen(lumps).values, rtol=1e-7)


def hung(length: float = 40 * mm, overhang: float = 0.0, **links: Link) -> Mechanism:
    """A steel bar on springs alone, of which nothing is one solid with the ground."""
    spring = Spring(diagonal=(1e5, 2e5, 3e5, 50.0, 60.0, 70.0), mass=0.01)
    feet = {
        f"foot {number + 1}": Link(("ground", "platform"), "spring", (sign * (0.5 * length - overhang), 0.0, -5 * mm), Z, X)
        for number, sign in enumerate((-1.0, 1.0))
    }
    return Mechanism(
        name="hung",
        materials={"steel": STEEL},
        parts={**PARTS, "spring": spring},
        bodies={"platform": Body(solids={"bar": Block("steel", (length, 10 * mm, 10 * mm))})},
        links={**feet, **links},
    )


def test_a_body_that_hangs_on_springs_is_rigid_but_for_its_own_modes():
    """What its block gives way is 2e-3 of what the springs do, and less of the motions; they have the mass of the drawn block."""
    stage = hung(motor=Link(("ground", "platform"), "coil", (-20 * mm, 0.0, 0.0), X))
    solid, lumps = model(stage, COARSE, cache=None), lumped(stage)
    agree(solid, lumps, 5e-3)
    np.testing.assert_allclose(eigen(solid).values[:6], eigen(lumps).values, rtol=2e-3)
    assert eigen(solid).values[6] > 50.0 * eigen(solid).values[5]
    assert "2 springs, 1 voice coil as specified" in solid.provenance


def test_a_part_ends_on_the_surface_where_it_stands_not_on_the_body_as_a_whole():
    """A bar on springs near its ends, pushed in the middle: 1/2k + L^3/48EI + L/4kGA of the beam between them.

    The springs' 60 N m/rad hold the ends a little; the surface counts 5 mm around each end, which takes 1 % of the deflection.
    """
    motor = Link(("ground", "platform"), "force", (0.0, 0.0, 5 * mm), (0.0, 0.0, -1.0), X)
    solid = model(hung(160 * mm, 10 * mm, motor=motor), FINER, cache=None)
    length, side, held = 140 * mm, 10 * mm, 60.0
    rigidity = STEEL.young * side**4 / 12.0
    clamped = held * length / rigidity
    bend = length**3 / (48.0 * rigidity) * (1.0 - 0.375 * clamped / (1.0 + 0.5 * clamped)) + 0.3 * length / (STEEL.shear * side**2)
    column = solid.input_matrix[:, solid.input_index(("motor",))]
    found = (column.T @ np.linalg.solve(solid.stiffness_matrix, column)).item()
    assert (found - 0.5 / 1e5) / bend == pytest.approx(0.99, abs=0.01)


def test_where_a_part_ends_is_content_of_the_solid():
    near, far = (hung(motor=Link(("ground", "platform"), "force", (at, 0.0, 5 * mm), (0.0, 0.0, -1.0), X)) for at in (0.0, 5 * mm))
    assert content(components(near)[0]) != content(components(far)[0])


def test_shipped_stages_on_voice_coils_have_solids():
    for name in ("voice-coil-stage", "tilt-stage"):
        assert in_words(stated_links(expand(case(name)))) == "1 voice coil as specified"
        assert components(case(name))


@pytest.mark.full
def test_a_stage_on_a_voice_coil_verifies_and_says_what_was_not_meshed():
    whole = leaf_stage()
    coil = Link(("ground", "platform"), "coil", (15 * mm, 14 * mm, 0.0), (0.0, -1.0, 0.0), X)
    found = verify(replace(whole, parts={**whole.parts, "coil": PARTS["coil"]}, links={**whole.links, "coil": coil}), Resolution(0.1, 2))
    assert found.as_stated == {"coil": "voice_coil"}
    assert "Not meshed: 1 voice coil as specified (coil)." in verdict_table_of(found).notes
    first = next(row for row in found.rows if row.figure.startswith("platform mode 1"))
    assert first.difference is not None
    assert abs(first.difference) < 0.1
