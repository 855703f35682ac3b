"""Drift: a stage of one material scales without stress, fields add, the datum only shifts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import flexstage as fs
from flexstage.analysis.linear_statics.drift import FIELDS, Drift, drift
from flexstage.analysis.workspace.gauging import gauge_inverse
from flexstage.base.labelled import Matrix
from flexstage.base.number import Table
from flexstage.cases.registry import CASES, case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.spatial.frame import COMPONENTS
from tests.conftest import examples
from tests.laws.shared import ideal, lumped
from tests.laws.strategies import actuated_platforms, mechanisms, moved, places, turns

coefficients = st.floats(-5e-6, 30e-6)


def of_one_material(mechanism, coefficient):
    """The same stage of materials that all expand alike; bodies without solids take that of their links."""
    materials = {name: replace(material, expansion=coefficient) for name, material in mechanism.materials.items()}
    parts = {name: replace(part, expansion=coefficient) if isinstance(part, fs.Piezo) else part for name, part in mechanism.parts.items()}
    return with_solids(replace(mechanism, materials=materials, parts=parts))


def with_solids(mechanism):
    """Every body of the stage's own gets a grain of the first material, so that it is known how it grows."""
    material = next(iter(mechanism.materials))

    def grained(body):
        if body.solids:
            return body
        place = body.reference or body.centre or (0.0, 0.0, 0.0)
        return fs.Body(solids={"grain": fs.Block(material, (1e-3, 1e-3, 1e-3), place)}, points=body.points, reference=place)

    units = {
        name: replace(unit, bodies={key: grained(body) for key, body in unit.bodies.items()}) for name, unit in mechanism.units.items()
    }
    return replace(mechanism, bodies={name: grained(body) for name, body in mechanism.bodies.items()}, units=units)


def scaled_stress(found, model):
    """Largest stress resultant per kelvin against what locked ends would give, alpha K length."""
    stiffest = max(float(np.max(np.abs(part.law))) for part in model.stiffness.values())
    return np.max(np.abs(found.forces.values)) / (1e-5 * 0.1 * stiffest)


def closed_loop_drift(drifted: Drift, gauge_inverse: Matrix) -> Matrix:
    """Platform motion (6 x fields) when a control loop holds all gauge readings: x - S s, with S of `gauge_inverse`."""
    moved = drifted.of(PLATFORM)
    readings = drifted.gauges.part(gauge_inverse.columns, FIELDS)
    return Matrix(moved.values - gauge_inverse.values @ readings.values, moved.rows, moved.columns, moved.unit)


@examples(16)
@given(st.one_of(mechanisms(), actuated_platforms()), coefficients, places)
def test_one_material_scales_without_stress(mechanism, coefficient, datum):
    """Uniform temperature: every body's reference moves by alpha (r - datum), nothing turns. Linear fields: no stress either."""
    alike = of_one_material(mechanism, coefficient)
    model = lumped(alike)
    found = drift(alike, model, ground=next(iter(alike.materials)), datum=datum)
    reference = expand(alike).bodies["platform"].reference
    moved_ = found.of("platform").values
    np.testing.assert_allclose(moved_[:3, 0], coefficient * (reference - np.array(datum)), rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(moved_[3:, 0], 0.0, atol=1e-12)
    for name, body in expand(alike).bodies.items():
        np.testing.assert_allclose(found.bodies[name][:3, 0], coefficient * (body.reference - np.array(datum)), rtol=0.0, atol=1e-13)
    assert scaled_stress(found, model) < 1e-7
    arm = reference - np.array(datum)
    for axis in range(3):
        slope = np.eye(3)[axis]
        np.testing.assert_allclose(moved_[3:, 1 + axis], coefficient * np.cross(slope, arm), rtol=0.0, atol=1e-12)
        bent = coefficient * (arm[axis] * arm - 0.5 * (arm @ arm) * slope)
        np.testing.assert_allclose(moved_[:3, 1 + axis], bent, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(found.gauges.values, 0.0, atol=1e-12)


@pytest.mark.parametrize("name", [name for name in CASES if name != "quad-suspension"])  # which is of springs, of no material
def test_every_case_of_one_material_scales(name):
    alike = of_one_material(case(name), 10e-6)
    model = lumped(alike)
    found = drift(alike, model, ground=next(iter(alike.materials)))
    reference = expand(alike).bodies["platform"].reference
    np.testing.assert_allclose(found.of("platform").values[:3, 0], 10e-6 * reference, rtol=0.0, atol=1e-13)
    assert scaled_stress(found, model) < 1e-8


def test_a_model_without_links_is_refused():
    stage = case("parallelogram")
    with pytest.raises(fs.DesignError, match=r"models with stiffness outside links \(got the stiffness of B\)\. Use the lumped model"):
        drift(stage, fs.mapped(stage), ground="aluminium")


def different(mechanism, seed):
    """Stacks, metal and a ground of their own expansion."""
    random = np.random.default_rng(seed)
    first = next(iter(mechanism.materials.values()))
    materials = {name: replace(each, expansion=float(random.uniform(0.0, 25e-6))) for name, each in mechanism.materials.items()}
    parts = {
        name: replace(part, expansion=float(random.uniform(-5e-6, 5e-6))) if isinstance(part, fs.Piezo) else part
        for name, part in mechanism.parts.items()
    }
    materials["base"] = replace(first, expansion=float(random.uniform(0.0, 25e-6)))
    return replace(with_solids(replace(mechanism, materials=materials, parts=parts)))


@examples(8)
@given(actuated_platforms(), st.integers(0, 2**32 - 1), turns())
def test_moving_the_stage_turns_the_drift(mechanism, seed, move):
    turn, shift = move
    here = different(mechanism, seed)
    there = moved_solids(here, turn, shift)
    first = drift(here, lumped(here), ground="base").of("platform").values[:, 0]
    second = drift(there, lumped(there), ground="base", datum=tuple(shift.tolist())).of("platform").values[:, 0]
    np.testing.assert_allclose(second[:3], turn @ first[:3], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(second[3:], turn @ first[3:], rtol=0.0, atol=1e-11)


def moved_solids(mechanism, turn, shift):
    """`moved` for stages whose own bodies carry grains: they are put where their references go."""
    bare = replace(mechanism, bodies={name: replace(body, solids=Table({})) for name, body in mechanism.bodies.items()})
    return with_solids(moved(bare, turn, shift))


@examples(8)
@given(actuated_platforms(), st.integers(0, 2**32 - 1), places)
def test_the_datum_only_shifts(mechanism, seed, datum):
    """Another datum of a growing ground: the platform's uniform drift moves by alpha times the shift, stresses and gauges do not."""
    stage = different(mechanism, seed)
    model, coefficient = lumped(stage), stage.materials["base"].expansion
    first, second = drift(stage, model, ground="base"), drift(stage, model, ground="base", datum=datum)
    difference = first.of("platform").values[:3, 0] - second.of("platform").values[:3, 0]
    np.testing.assert_allclose(difference, coefficient * np.array(datum), rtol=0.0, atol=1e-13)
    scale = np.max(np.abs(first.forces.values)) + 1e-12
    np.testing.assert_allclose(second.forces.values[:, 0], first.forces.values[:, 0], rtol=0.0, atol=1e-7 * scale)
    np.testing.assert_allclose(second.gauges.values[:, 0], first.gauges.values[:, 0], rtol=0.0, atol=1e-13)


@examples(8)
@given(actuated_platforms(), st.integers(0, 2**32 - 1))
def test_expansions_add(mechanism, seed):
    """Drift is linear in the coefficients: that of stacks alone and of all the rest alone add up."""
    stage = different(mechanism, seed)
    cold = {name: replace(part, expansion=0.0) if isinstance(part, fs.Piezo) else part for name, part in stage.parts.items()}
    still = {name: replace(material, expansion=0.0) for name, material in stage.materials.items()}
    parts = [replace(stage, parts=cold), replace(stage, materials=still)]
    whole, *halves = (drift(item, lumped(item), ground="base").of("platform").values for item in (stage, *parts))
    np.testing.assert_allclose(halves[0] + halves[1], whole, rtol=0.0, atol=1e-11)


def test_gauges_held_still():
    """With six gauges held by a loop, the platform's drift is what the gauges do not see: for a stage of one material, its scaling."""
    alike = of_one_material(case("double-triangle"), 10e-6)
    found = drift(alike, lumped(alike), ground="steel")
    held = closed_loop_drift(found, gauge_inverse(ideal(alike)))
    np.testing.assert_allclose(held.values, found.of("platform").values, atol=1e-12)
    unlike = case("double-triangle")
    loose = drift(unlike, lumped(unlike), ground="steel")
    held = closed_loop_drift(loose, gauge_inverse(ideal(unlike)))
    assert np.max(np.abs(held.values[:3, 0])) < 0.5 * np.max(np.abs(loose.of("platform").values[:3, 0]))
    assert held.columns == FIELDS
    assert held.rows == tuple(f"platform.{name}" for name in COMPONENTS)


def test_given_parts_and_joints_take_part():
    """A stage on a given 6x6 and an ideal joint: of one material it scales all the same, the locked joint included."""
    steel = fs.Material(young=200e9, poisson=0.3, density=7750.0, expansion=10e-6)
    spring = ComplianceMatrix(tuple(tuple(1e-6 if row == column else 0.0 for column in range(6)) for row in range(6)), (fs.Freedom.X,))
    grain = {"grain": fs.Block("steel", (1e-3, 1e-3, 1e-3), (0.02, 0.01, 0.0))}
    stage = fs.Mechanism(
        name="joints",
        materials={"steel": steel},
        parts={"spring": spring, "pin": Joint((fs.Freedom.RZ, fs.Freedom.X)), "rod": fs.Rod("steel", 0.03, 0.002)},
        bodies={"platform": fs.Body(solids=grain), "arm": fs.Body(solids={"grain": replace(grain["grain"], at=(0.1, 0.1, 0.05))})},
        links={
            "foot": fs.Link(("ground", "arm"), "spring", (0.1, 0.0, 0.0), (0.0, 0.0, 1.0)),
            "pin": fs.Link(("arm", "platform"), "pin", (0.05, 0.05, 0.02), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0)),
            "stay": fs.Link(("ground", "platform"), "rod", (0.0, 0.05, 0.0), (0.0, 1.0, 0.0)),
        },
    )
    found = drift(stage, lumped(stage), ground="steel")
    np.testing.assert_allclose(found.of("platform").values[:, 0], [0.2e-6, 0.1e-6, 0.0, 0.0, 0.0, 0.0], atol=1e-15)
    assert np.max(np.abs(found.forces.values)) < 1e-6
