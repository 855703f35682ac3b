"""Laws of the mass at a point and of the stiffness by freedom, on stages with few and with six ideal motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from flexstage.analysis.linear_statics.mass_matrix import mass_matrix
from flexstage.analysis.linear_statics.statics import freedom_stiffness, statics
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.moving_mass import carried_masses, moving_inertia
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped
from flexstage.parts.body import Body, Inertia, Payload
from flexstage.spatial.frame import COMPONENTS, FORCES, transport
from tests.conftest import examples
from tests.laws.strategies import platforms

POINT = (0.021, -0.013, 0.034)
LOAD = Payload("platform", 0.7, (0.01, 0.03, -0.02), Inertia(1e-4, 2e-4, 1.5e-4, xy=2e-5))
TWIST = np.array([0.3, -0.7, 0.2, 4.0, -2.0, 9.0])
FEW = {"parallelogram": ("x",), "xy-stage": ("x", "y"), "telescope-mount": ()}
OVER = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])


def with_point(stage):
    """The stage with a payload on its platform and a point `chuck` of it."""
    bodies = {**stage.bodies, "platform": replace(stage.bodies["platform"], points={"chuck": POINT})}
    return replace(stage, bodies=bodies, payloads={**stage.payloads, "load": LOAD})


def in_metres(matrix):
    """A 6x6 of twists or wrenches with rotations over 0.1 m, so that its entries compare."""
    return matrix / OVER / OVER[:, None]


@given(platforms())
@examples(3)
def test_the_mass_at_a_point_is_that_at_the_reference_carried_there(drawn):
    stage = with_point(drawn[0])
    model = lumped(stage)
    whole, chuck = mass_matrix(stage, model), mass_matrix(stage, model, point="chuck")
    carry = transport(expand(stage).bodies["platform"].reference - np.array(POINT))
    for name, tolerance in (("rigid", 1e-12), ("reduced", 1e-7)):  # K is inverted twice for the reduced one
        expected = carry.T @ getattr(whole, name).values @ carry
        scale = np.max(in_metres(expected))
        np.testing.assert_allclose(in_metres(getattr(chuck, name).values), in_metres(expected), atol=tolerance * scale, rtol=0)


def test_a_payload_turns_with_its_own_inertia():
    """What it adds to the energy of a twist: m |v + w x r|^2 / 2 and w J w / 2, written out."""
    bare = replace(case("parallelogram"), payloads={})
    body = expand(bare).bodies["platform"]
    added = moving_inertia(replace(bare, payloads={"load": LOAD}), body) - moving_inertia(bare, body)
    speed = TWIST[:3] + np.cross(TWIST[3:], np.array(LOAD.at) - body.reference)
    x, y, z = TWIST[3:]
    own = 1e-4 * x**2 + 2e-4 * y**2 + 1.5e-4 * z**2 - 2.0 * 2e-5 * x * y
    assert TWIST @ added @ TWIST == pytest.approx(0.7 * speed @ speed + own, rel=1e-12)


@given(platforms())
@examples(6)
def test_a_rigid_motion_has_the_kinetic_energy_of_its_masses(drawn):
    stage = with_point(drawn[0])
    found = mass_matrix(stage, lumped(stage), point="chuck").rigid.values
    energy = 0.0
    for item in carried_masses(stage, expand(stage).bodies["platform"]):
        speed = TWIST[:3] + np.cross(TWIST[3:], item.centre - np.array(POINT))
        energy += 0.5 * item.mass * speed @ speed + 0.5 * TWIST[3:] @ item.inertia @ TWIST[3:]
    assert 0.5 * TWIST @ found @ TWIST == pytest.approx(energy, rel=1e-12)


@given(platforms())
@examples(6)
def test_the_reduced_mass_is_the_energy_of_the_motion_of_least_strain(drawn):
    stage = with_point(drawn[0])
    model = lumped(stage)
    rows = model.output[model.output_index(tuple(f"chuck.{name}" for name in COMPONENTS))]
    # K q + C^T w = 0, C q = t: the chuck is moved by t, all else finds its rest
    size, force = len(model.coordinates), np.mean(np.diag(model.stiffness_matrix))
    bordered = np.block([[model.stiffness_matrix / force, rows.T], [rows, np.zeros((6, 6))]])
    speed = np.linalg.solve(bordered, np.concatenate([np.zeros(size), TWIST]))[:size]
    found = mass_matrix(stage, model, point="chuck").reduced.values
    assert 0.5 * TWIST @ found @ TWIST == pytest.approx(0.5 * speed @ model.inertia_matrix @ speed, rel=1e-6)


@given(platforms())
@examples(6)
def test_reduced_masses_give_frequencies_that_are_never_below_those_of_the_whole(drawn):
    stage = with_point(drawn[0])
    model = lumped(stage)
    mass = mass_matrix(stage, model, point="chuck").reduced.values
    stiffness = statics(model, load_point="chuck", read_point="chuck").stiffness.values
    squares = np.sort(np.real(np.linalg.eigvals(np.linalg.solve(in_metres(mass), in_metres(stiffness)))))
    assert np.all(squares >= np.real(eigen(model).values[:6]) * (1 - 1e-6))


def test_of_a_model_whose_platform_alone_has_mass_nothing_is_added():
    stage = with_point(case("double-triangle"))
    found = mass_matrix(stage, mapped(stage), point="chuck")
    np.testing.assert_allclose(in_metres(found.reduced.values), in_metres(found.rigid.values), atol=1e-9 * found.rigid.values[0, 0], rtol=0)
    assert not found.reasons


def test_what_is_not_known_of_the_mass_is_said():
    stage = case("parallelogram")
    found = mass_matrix(stage, mapped(stage))
    assert found.reduced is None
    assert "locks degrees of freedom" in found.reasons["reduced"]
    bare = replace(stage, bodies={"platform": Body(reference=(0.0, 0.0, 0.0))})
    found = mass_matrix(bare, lumped(bare))
    assert (found.rigid, set(found.reasons)) == (None, {"rigid"})
    assert found.reduced.values[0, 0] > 0.0  # of the parts


@pytest.mark.parametrize("name", FEW)
def test_stiffness_by_freedom_is_what_push_tests_give(name):
    stage = with_point(case(name))
    model = lumped(stage)
    found = freedom_stiffness(statics(model, load_point="chuck", read_point="chuck"), ideal(stage))
    assert found.motions.rows == FEW[name]
    assert (*found.motions.rows, *found.constraints.rows) == (*FEW[name], *(each for each in COMPONENTS if each not in FEW[name]))
    twists, wrenches = (tuple(f"chuck.{each}" for each in names) for names in (COMPONENTS, FORCES))
    compliance = static_gain(model, twists, wrenches).values
    for table in (found.motions, found.constraints):
        for row in table.rows:
            own = COMPONENTS.index(row)
            rest = [each for each in range(6) if each != own]
            held = compliance[own, own] - compliance[own, rest] @ np.linalg.solve(compliance[np.ix_(rest, rest)], compliance[rest, own])
            assert table.at(row, "free") == pytest.approx(1.0 / compliance[own, own], rel=1e-9)
            assert table.at(row, "held") == pytest.approx(1.0 / held, rel=1e-9)


def test_of_a_model_that_locks_freedoms_only_the_motions_left_give_way():
    stage = case("parallelogram")
    found = freedom_stiffness(statics(mapped(stage)), ideal(stage))
    assert np.all(found.motions.values[:, 0] > 0.0)
    assert np.all(np.isnan(found.constraints.values))
    assert set(found.reasons) == {"motions", "constraints"}


def test_six_motions_or_another_point_have_no_stiffness_by_freedom():
    whole, guide = case("double-triangle"), case("parallelogram")
    assert freedom_stiffness(statics(mapped(whole)), ideal(whole)) is None
    assert freedom_stiffness(statics(lumped(guide), load_point="corner"), ideal(guide)) is None
