"""Laws of frequency and random responses, on random models."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh, solve_continuous_lyapunov

from flexstage.analysis.dynamics.random_response import Rate, Spectrum, random_response
from flexstage.analysis.dynamics.response import default_frequencies, response, transmissibility
from flexstage.base.finding import DesignError
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import ModalDamping, RayleighDamping, StructuralDamping
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.frequency import direct
from flexstage.models.linear.model import Channel, Contribution, LinearModel
from flexstage.models.linear.port import input_names, ports
from flexstage.models.linear.state_space import state_space
from flexstage.models.linear.static import part_deformation, static_gain
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped
from flexstage.spatial.frame import COMPONENTS
from tests.laws.models import BODIES, FORCES, laws, linear_model, models, ratios, seeds

GRID = np.array([0.0, 0.1, 0.7, 1.3, 2.9, 11.0])


def near(actual, expected, tolerance):
    assert np.max(np.abs(actual - expected)) <= tolerance * np.max(np.abs(expected))


@given(models, laws)
def test_collocated_receptances_are_reciprocal(model, law):
    forces = [f"{body}.{name}" for body in ("platform", "arm") for name in FORCES]
    values = response(model, ["platform", "arm"], forces, GRID, damping=law).values
    near(values, np.swapaxes(values, -1, -2), 1e-9)


@given(models, laws)
def test_a_stroke_and_the_force_in_its_stack_are_dual(model, law):
    """Maxwell: motion of the platform per stroke = tension of the stack per force on the platform."""
    forward = response(model, ["platform"], ["B1"], GRID, damping=law).values[..., 0]
    backward = response(model, ["pzt.fx"], [f"platform.{name}" for name in FORCES], GRID, damping=law).values[..., 0, :]
    near(forward, backward, 1e-9)


@given(models)
def test_a_stroke_against_nothing_does_not_lag(model):
    """A stack that carries an arm and nothing else moves it by the stroke at rest, whatever is lost in it and elsewhere."""
    alone = replace(model, stiffness={name: part for name, part in model.stiffness.items() if name != "side"})
    values = response(alone, ["arm", "platform"], ["B1"], np.array([0.0]), damping=StructuralDamping()).values[0]
    expected = np.concatenate([static_gain(alone, (f"{body}.{name}",), ("B1",)).values for body in BODIES[::-1] for name in COMPONENTS])
    near(values, expected, 1e-9)
    assert np.abs(expected).max() > 0.1


@given(models)
def test_what_a_stroke_does_is_lost_in_the_parts(model):
    """Work of the stroke in a cycle, -pi Im F, is what the parts lose, pi sum eta e^H k e: it is never negative."""
    law, names = StructuralDamping(), [channel.name for channel in model.outputs[: len(model.coordinates)]]
    motion = response(model, names, ["B1"], GRID, damping=law).values[..., 0].T
    selector = np.zeros((len(model.inputs), len(GRID)))
    selector[0] = 1.0
    strains = part_deformation(model, motion, selector)
    lost = sum(
        part.loss_factor * np.real(np.sum(np.conj(strains[name]) * (part.law @ strains[name]), axis=0))
        for name, part in model.stiffness.items()
    )
    force = response(model, ["pzt.fx"], ["B1"], GRID, damping=law).values[:, 0, 0]
    near(-np.imag(force), lost, 1e-8)


@given(models, laws)
def test_low_frequency_is_the_static_gain(model, law):
    names = tuple(channel.name for channel in model.outputs)
    strokes = tuple(channel.name for channel in model.inputs)
    found = response(model, names, strokes, np.array([0.0]), damping=law).values[0]
    expected = static_gain(model, names, strokes).values
    if isinstance(law, StructuralDamping):
        chosen = ports(model, names, strokes)
        lossless = direct(model.stiffness_matrix, model.inertia_matrix, chosen, np.array([1e-6]))[0]
        near(lossless, expected, 1e-9)
    else:
        near(found, expected, 1e-9)


@given(models, st.floats(0.0, 1.0), st.floats(1e-5, 1e-2))
def test_superposition_is_the_direct_solve_for_rayleigh(model, mass_factor, stiffness_factor):
    law = RayleighDamping(mass_factor, stiffness_factor)
    chosen = ports(model, ["platform", "S1", "pzt.fx"], [*input_names(model)])
    K, M = model.stiffness_matrix, model.inertia_matrix
    for frequency in GRID:
        omega = 2.0 * np.pi * frequency
        dynamic = K + 1j * omega * (mass_factor * M + stiffness_factor * K) - omega**2 * M
        motion = np.linalg.solve(dynamic, chosen.force + omega**2 * chosen.inertial)
        found = response(model, ["platform", "S1", "pzt.fx"], input_names(model), np.array([frequency]), damping=law).values[0]
        near(found, chosen.output @ motion + chosen.feedthrough, 1e-8)


@given(models, ratios)
def test_modal_damping_is_the_direct_solve_with_its_own_matrix(model, ratio):
    solved = eigen(model)
    M = model.inertia_matrix
    carried = M @ solved.shapes
    C = carried @ np.diag(2.0 * ratio * np.sqrt(solved.values)) @ carried.T
    chosen = ports(model, ["platform"], ["B1", "platform.fx"])
    omega = 2.0 * np.pi * 1.3
    motion = np.linalg.solve(model.stiffness_matrix + 1j * omega * C - omega**2 * M, chosen.force)
    found = response(model, ["platform"], ["B1", "platform.fx"], np.array([1.3]), damping=ModalDamping(ratio)).values[0]
    near(found, chosen.output @ motion, 1e-8)


@given(models, laws)
def test_transmissibility_tends_to_one(model, law):
    values = transmissibility(model, frequencies=np.array([0.0, 1e-4]), damping=law).values
    near(values[0], np.eye(6), 1e-12)
    near(values[1], np.eye(6), 1e-6)
    feels = transmissibility(model, ("S1", "pzt.fx"), np.array([0.0]), damping=law).values
    assert np.all(feels == 0.0)


@given(models)
def test_transmissibility_is_that_of_the_absolute_equations(model):
    """Absolute coordinates: K* (x - R g) - omega^2 M x = 0 with all mass on the bodies."""
    omega = 2.0 * np.pi * 1.3
    K = sum(part.operator.T @ part.law @ part.operator * (1 + 1j * part.loss_factor) for part in model.stiffness.values())
    absolute = np.linalg.solve(K - omega**2 * model.inertia_matrix, K @ model.rigid)
    near(transmissibility(model, frequencies=np.array([1.3]), damping=StructuralDamping()).values[0], absolute[:6], 1e-9)


@given(seeds, laws)
def test_a_batch_is_a_loop(seed, law):
    batch = linear_model(seed, batch=(3,))
    found = response(batch, ["platform", "S1"], ["B1", "arm.fy", "ground"], GRID, damping=law).values
    assert found.shape == (3, len(GRID), 7, 8)
    for number in range(3):
        parts = {
            name: Contribution(part.operator, part.law[number] if part.law.ndim == 3 else part.law, part.loss_factor)
            for name, part in batch.stiffness.items()
        }
        single = replace(batch, stiffness=parts)
        one = response(single, ["platform", "S1"], ["B1", "arm.fy", "ground"], GRID, damping=law).values
        near(found[number], one, 1e-10)


exact = st.one_of(st.builds(ModalDamping, ratios), st.builds(RayleighDamping, st.floats(0.0, 1.0), st.floats(1e-5, 1e-2)))


@given(seeds, exact)
def test_state_space_is_the_response(seed, law):
    """Without massless freedoms, whose Rayleigh damping the state space leaves out and says so."""
    model = linear_model(seed)
    chosen = ports(model, ["platform", "S1", "pzt.fx"], ["B1", "arm.mz", "ground"])
    expected = response(model, ["platform", "S1", "pzt.fx"], ["B1", "arm.mz", "ground"], GRID, damping=law).values
    near(state_space(model, chosen, law).transfer(GRID), expected, 1e-8)


@given(models)
def test_structural_damping_in_time_is_equivalent_ratios_and_says_so(model):
    space = state_space(model, ports(model, ["platform"], ["B1"]), StructuralDamping())
    factors = [part.loss_factor for part in model.stiffness.values()]
    assert "equivalent modal ratios" in space.note
    assert np.all(space.ratios >= 0.5 * min(factors) * (1 - 1e-9))
    assert np.all(space.ratios <= 0.5 * max(factors) * (1 + 1e-9))


@given(models, laws)
def test_a_truncated_state_space_keeps_the_static_gain(model, law):
    names = tuple(channel.name for channel in model.outputs)
    space = state_space(model, ports(model, names, ["B1", "platform"]), law, modes=6)
    assert space.A.shape == (12, 12)
    expected = static_gain(model, names, ("B1", *(f"platform.{name}" for name in FORCES))).values
    near(space.transfer(np.array([0.0]))[0], expected, 1e-9)


@given(seeds, st.floats(0.003, 0.2))
def test_random_response_is_the_lyapunov_solution(seed, ratio):
    """Parseval: white force on the platform: rms of displacements = covariance from A P + P A^T + B S/2 B^T = 0 (S one-sided)."""
    model = linear_model(seed)
    chosen = ports(model, ["platform", "arm"], ["platform.fx", "arm.my"])
    space = state_space(model, chosen, ModalDamping(ratio))
    densities = np.array([3.0, 0.2])
    covariance = solve_continuous_lyapunov(space.A, -space.B @ np.diag(densities / 2.0) @ space.B.T)
    expected = np.sqrt(np.diag(space.C @ covariance @ space.C.T))
    top = 1e4 * np.sqrt(eigen(model).values[..., 0]) / (2.0 * np.pi)
    spectra = {"platform.fx": Spectrum(densities[0]), "arm.my": Spectrum(densities[1])}
    found = random_response(model, ["platform", "arm"], spectra, (top * 1e-13, top), damping=ModalDamping(ratio))
    np.testing.assert_allclose(found.rms, expected, rtol=1e-8)
    np.testing.assert_allclose(np.sum(found.shares, axis=-1), found.rms**2, rtol=1e-12)


def oscillator(mass=2.0, stiffness=800.0, loss_factor=0.05):
    """One freedom x on a stack of that stiffness; u is the stack's stroke."""
    unit = np.ones((1, 1))
    return LinearModel(
        coordinates=("platform.x",),
        stiffness={"stack": Contribution(unit, stiffness * unit, loss_factor)},
        inertia={"platform": Contribution(unit, mass * unit)},
        inputs=(Channel("u", "m"), Channel("platform.fx", "N")),
        force=np.array([[0.0, 1.0]]),
        imposed={"stack": np.array([[1.0, 0.0]])},
        outputs=(Channel("platform.x", "m"),),
        output=unit,
        feedthrough=np.zeros((1, 2)),
        rigid=np.eye(6)[:1],
        rigid_output=np.eye(6)[:1],
        base_inertia=mass * np.eye(6)[:1],
        damping=None,
        idle=(),
        provenance="oscillator",
    )


@given(st.floats(1e-3, 0.5), st.floats(0.0, 20.0), st.floats(0.1, 10.0), st.floats(1.0, 1e4))
def test_one_freedom_closed_forms(ratio, frequency, mass, stiffness):
    model = oscillator(mass, stiffness, 2.0 * ratio)
    omega, natural = 2.0 * np.pi * frequency, np.sqrt(stiffness / mass)
    grid = np.array([frequency])
    viscous = natural**2 - omega**2 + 2j * ratio * natural * omega
    found = response(model, ["platform.x"], ["u", "platform.fx", "ground.x"], grid, damping=ModalDamping(ratio)).values[0, 0]
    base = (natural**2 + 2j * ratio * natural * omega) / viscous
    np.testing.assert_allclose(found, [natural**2 / viscous, 1.0 / mass / viscous, base], rtol=1e-9)
    found = response(model, ["platform.x"], ["platform.fx"], grid, damping=StructuralDamping()).values[0, 0, 0]
    np.testing.assert_allclose(found, 1.0 / (stiffness * (1 + 2j * ratio) - omega**2 * mass), rtol=1e-9)


def test_rms_of_one_freedom_under_white_force():
    """sigma_x^2 = S / (8 zeta omega^3 m^2) for a one-sided density S per Hz."""
    model, ratio = oscillator(), 0.01
    found = random_response(model, ["platform.x"], {"platform.fx": Spectrum(4.0)}, (1e-6, 1e5), damping=ModalDamping(ratio))
    assert found.rms[0] == pytest.approx(np.sqrt(4.0 / (8.0 * ratio * 20.0**3 * 4.0)), rel=1e-6)


def test_floor_acceleration_is_floor_displacement_times_omega_to_the_fourth():
    model = oscillator()
    table = np.geomspace(1.0, 30.0, 7)
    as_motion = Spectrum(1e-6 * (2.0 * np.pi * table) ** -4.0, table)
    as_rate = Spectrum(1e-6 * (2.0 * np.pi * table) ** -2.0, table, Rate.VELOCITY)
    as_acceleration = Spectrum(1e-6, rate=Rate.ACCELERATION)
    spectra = (as_motion, as_rate, as_acceleration)
    rms = [random_response(model, ["platform.x"], {"ground.x": item}, (1.0, 30.0), damping=ModalDamping(0.02)).rms[0] for item in spectra]
    np.testing.assert_allclose(rms, rms[0], rtol=1e-9)


def test_the_default_grid_resolves_every_peak():
    model = oscillator()
    grid = default_frequencies(model, damping=ModalDamping(1e-3))
    assert np.all(np.diff(grid) > 0.0)
    peak = np.abs(response(model, ["platform.x"], ["u"], grid, damping=ModalDamping(1e-3)).values).max()
    assert peak == pytest.approx(500.0, rel=1e-3)


def test_the_default_grid_ends_at_twice_the_twelfth_natural_frequency_or_the_last():
    """Twice the twelfth of 18 natural frequencies, or twice the only one of a mass on a spring, ends it; 1/50 of the first begins it."""
    stage = lumped(parallelogram())
    many = np.sqrt(eigh(stage.stiffness_matrix, stage.inertia_matrix, eigvals_only=True)) / (2.0 * np.pi)
    assert len(many) == 18
    assert default_frequencies(stage)[[0, -1]] == pytest.approx([many[0] / 50.0, 2.0 * many[11]], rel=1e-6)
    one = np.sqrt(800.0 / 2.0) / (2.0 * np.pi)
    assert default_frequencies(oscillator(), damping=ModalDamping(0.01))[[0, -1]] == pytest.approx([one / 50.0, 2.0 * one], rel=1e-9)


def test_refusals_name_the_object_and_the_remedy():
    model = oscillator()
    with pytest.raises(DesignError, match=r"specifies no damping.*damping=ModalDamping"):
        response(model, ["platform.x"], ["u"], GRID)
    with pytest.raises(DesignError, match=r"plattform\.x: unknown output\. Use platform\.x"):
        response(model, ["plattform.x"], ["u"], GRID, damping=ModalDamping(0.01))
    with pytest.raises(DesignError, match=r"platform\.fq: unknown input\. Use platform\.f[xyz]"):
        response(model, ["platform.x"], ["platform.fq"], GRID, damping=ModalDamping(0.01))
    with pytest.raises(DesignError, match="frequencies"):
        response(model, ["platform.x"], ["u"], np.array([-1.0]), damping=ModalDamping(0.01))
    with pytest.raises(DesignError, match=r"invalid band \(got 10 Hz to 1 Hz\)\. Use 0 < low < high in Hz"):
        random_response(model, ["platform.x"], {"u": Spectrum(1.0)}, (10.0, 1.0), damping=ModalDamping(0.01))
    wrong = Spectrum(np.ones(2), np.array([2.0, 1.0]))
    with pytest.raises(DesignError, match="ascend"):
        random_response(model, ["platform.x"], {"u": wrong}, (1.0, 10.0), damping=ModalDamping(0.01))


def test_a_slow_rotation_of_the_ground_turns_a_point_about_the_reference_in_both_models():
    """Rigidly: the point moves across the arm from the platform's reference, 6 mm above it."""
    stage = case("hexapod")
    for model in (mapped(stage), lumped(stage)):
        found = response(model, ["sample.x", "sample.y"], ["ground.rx", "ground.ry"], np.array([1.0])).values[0]
        np.testing.assert_allclose(found, [[0.0, 6e-3], [-6e-3, 0.0]], atol=1e-6)
