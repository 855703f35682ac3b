"""Laws of force actuators on random stages: they push two bodies apart and hold nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flexstage.base.units.scale import X, Y, Z
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.incidence import deformation, layout
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.mechanism.restrict import restrict
from flexstage.models.ideal import ideal
from flexstage.models.linear.static import displacement, static_gain
from flexstage.models.lumped import lumped
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.stage import nonlinear
from flexstage.parts.body import Body
from flexstage.parts.force_actuator import ForceActuator
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import FORCES, spatial_rotation
from tests.laws.strategies import mechanisms, moved, orientations, places, platforms, turns
from tests.laws.test_mechanisms import METRE, TWIST, WRENCH, near, rounding

FEW = settings(max_examples=15)


@st.composite
def forced(draw, stages):
    """A stage with one to three bare force actuators more, each between the platform and another body, the first of them the ground."""
    stage = draw(stages)
    stage = stage if not isinstance(stage, tuple) else stage[0]
    bodies = [GROUND, *stage.bodies]
    links = {}
    for number in range(draw(st.integers(1, 3))):
        joins = (PLATFORM, draw(st.sampled_from([body for body in bodies if body != PLATFORM])) if number else GROUND)
        links[f"coil{number + 1}"] = Link(joins if draw(st.booleans()) else joins[::-1], "pusher", draw(places), *draw(orientations()))
    return replace(stage, parts={**stage.parts, "pusher": ForceActuator()}, links={**stage.links, **links})


def thrusts(stage):
    return tuple(expand(stage).thrusts)


@FEW
@given(forced(mechanisms()))
def test_a_force_is_a_pair_of_wrenches_and_changes_no_stiffness(stage):
    """B = G^T w, and the motion a force gives the platform is, by Betti, the elongation that a wrench on the platform gives it."""
    assert not check(stage)
    model, assembly, names = lumped(stage), expand(stage), thrusts(stage)
    assert not any(model.stiffness[name].law.any() for name in names)
    rows = np.stack([deformation(assembly, layout(assembly), assembly.links[name])[0] for name in names])
    stretched = rows @ displacement(model, model.input_matrix[:, model.input_index(WRENCH)])
    pushed = static_gain(model, TWIST, names).values
    near(pushed * METRE[:, None], stretched.T * METRE[:, None], rounding(model))


@FEW
@given(forced(mechanisms()), turns())
def test_moving_a_stage_with_forces_changes_only_frames(stage, move):
    turn, shift = move
    here, there = lumped(stage), lumped(moved(stage, turn, shift))
    gains = [static_gain(model, TWIST, thrusts(stage)).values for model in (here, there)]
    near(gains[1] * METRE[:, None], spatial_rotation(turn) @ gains[0] * METRE[:, None], rounding(here))


@FEW
@given(forced(mechanisms()))
def test_a_force_passes_through_its_own_link(stage):
    """All that a bare force actuator transfers is its force: pressed by as much as it pushes, nothing else."""
    model, names = lumped(stage), thrusts(stage)
    carried = static_gain(model, tuple(f"{name}.{force}" for name in names for force in FORCES), names).values
    expected = np.zeros_like(carried)
    expected[range(0, 6 * len(names), 6), range(len(names))] = -1.0
    assert np.array_equal(carried, expected)


@FEW
@given(forced(st.integers(1, 5).flatmap(lambda wires: platforms(wires, 0))))
def test_the_force_map_is_the_limit_of_the_elastic_model(stage):
    """With locked freedoms rigid the elastic answer is xi = C_xi V^T W: the compliance of the ideal motions times the force map."""
    found = ideal(stage)
    model = lumped(restrict(stage, {"wire": (stage.parts["wire"].intended, ())}))
    pushed, compliance = (static_gain(model, TWIST, inputs).values for inputs in (found.thrusts, WRENCH))
    along = found.projection
    length = np.where([name.startswith("r") for name in found.coordinates], 0.1, 1.0)[:, None]
    near(length * (along @ compliance @ along.T @ found.force_map.values), length * (along @ pushed), 100.0 * rounding(model))
    assert not found.actuators
    assert found.force_map.columns == thrusts(stage)


def test_what_forces_command():
    """A platform on five wires moves along x: a force along x commands it, one across does not."""
    wires = [((0.0, 0.05 * s, 0.0), Y) for s in (1, 2)] + [((0.05 * s, 0.0, 0.05), Z) for s in (-1, 1)] + [((0.0, 0.05, -0.05), Z)]
    for along, commanded in ((X, ("x",)), (Y, ())):
        stage = Mechanism(
            name="five wires",
            materials={"metal": Material(young=200e9, poisson=0.3, density=7800.0)},
            parts={"wire": Rod("metal", 0.02, 0.001), "pusher": ForceActuator()},
            bodies={PLATFORM: Body(mass=1.0, reference=(0.0, 0.0, 0.0))},
            links={f"wire{number}": Link((GROUND, PLATFORM), "wire", at, direction) for number, (at, direction) in enumerate(wires)}
            | {"coil": Link((GROUND, PLATFORM), "pusher", (0.0, 0.0, 0.0), along)},
        )
        assert ideal(stage).commanded == commanded


def test_about_rest_a_force_passes_through_its_link_as_in_the_drawn_stage():
    """What a coil's link bears per ampere: its force constant, less what the link's own stiffness takes."""
    stage = case("voice-coil-stage")
    about = linearise(equilibrium(nonlinear(stage), weight=0.0, stated=0.0))
    wrench = tuple(f"motor.{name}" for name in FORCES)
    found, expected = (static_gain(model, wrench, ("motor",)).values for model in (about, lumped(stage)))
    assert abs(expected[0, 0]) == expand(stage).actuator("motor").force_constant
    np.testing.assert_allclose(found, expected, atol=1e-9)
