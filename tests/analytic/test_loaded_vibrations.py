"""Vibrations about loaded states against characteristic equations of beams, and what no choice of the reader may change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

import flexstage as fs
from flexstage.beams.flexure.law import Resolution
from flexstage.cases.double_triangle import double_triangle
from flexstage.models.linear import eigen, model
from flexstage.models.linear.eigen import eigenvalues
from flexstage.models.linear.model import assemble, strain_forces
from flexstage.models.linear.static import static_gain
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.stage import nonlinear
from tests.analytic.test_large_displacements import RIGIDITY, SOFT, THIN, stage
from tests.analytic.test_stability import leaves
from tests.laws.test_nonlinear import AWAY, FINE, NONE, SPACE, UNIT, guide, loads


def of_a_tight_beam(tension: float) -> np.ndarray:
    """First three angular frequencies of a clamped beam, over (E I / (rho A L^4))^(1/2), `tension` over E I / L^2."""

    def equation(frequency: float) -> float:
        root = np.sqrt(tension * tension + 4.0 * frequency * frequency)
        p, q = np.sqrt(0.5 * (root + tension)), np.sqrt(0.5 * (root - tension))
        return 2.0 * p * q * (1.0 / np.cosh(p) - np.cos(q)) + (p * p - q * q) * np.tanh(p) * np.sin(q)

    grid = np.linspace(0.5, 400.0, 4000)
    signs = np.array([equation(each) for each in grid])
    (places,) = np.nonzero(signs[:-1] * signs[1:] < 0.0)
    return np.array([brentq(equation, grid[place], grid[place + 1], xtol=1e-12) for place in places[:3]])


@pytest.mark.parametrize("tension", [-30.0, 0.0, 20.0, 100.0, 1000.0])
def test_a_tight_beam_between_clamps(tension: float):
    """Its far end is on a platform so heavy that it rests; below -pi^2/4 that platform would fall, and the beam still vibrates."""
    heavy = fs.Body(mass=1.0, inertia=fs.Inertia(1.0, 1.0, 1.0), centre=(1.0, 0.0, 0.0), reference=(1.0, 0.0, 0.0))
    link = fs.Link(("ground", "platform"), "leaf", at=(0.5, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=fs.Z)
    beam = stage(THIN, {"platform": heavy}, {"leaf": link}, replace(SOFT, density=1.0))
    model = linearise(equilibrium(nonlinear(beam, resolution=Resolution(2, 2, 14, points=16)), {"platform.fx": tension * RIGIDITY}))
    softness = eigh(model.inertia_matrix[6:, 6:], model.stiffness_matrix[6:, 6:], eigvals_only=True)[::-1]
    found = np.sqrt(THIN.width * THIN.thickness / RIGIDITY / softness[:3])
    assert found == pytest.approx(of_a_tight_beam(tension), rel=1e-6)


@pytest.mark.parametrize(("mass", "frequency", "error"), [(2.5, 2.26569, 1e-4), (5.0, 0.181067, 0.01)])
def test_weight_softens_upright_leaves(mass: float, frequency: float, error: float):
    """Beam columns: k = 2 P / (L (tan(u)/u - 1)), u = L/2 sqrt(P / E I), load factors 2.0128 and 1.0064; leaves without mass."""
    upright = leaves(mass)
    light = replace(upright, materials={"steel": replace(upright.materials["steel"], poisson=0.0, density=1e-6)})
    found = fs.modes(linearise(equilibrium(nonlinear(light))))
    assert found.frequencies[0] == pytest.approx(frequency, rel=error)


def test_at_rest_it_vibrates_as_the_lumped_model_does():
    stage = double_triangle()
    model = linearise(equilibrium(nonlinear(stage), weight=0.0, stated=0.0))
    small = fs.lumped(stage)
    assert fs.modes(model).frequencies[:6] == pytest.approx(fs.modes(small).frequencies[:6], rel=1e-8)
    outputs, inputs = ("platform.x", "platform.z", "platform.ry"), ("B1", "B4", "platform.fx")
    assert static_gain(model, outputs, inputs).values == pytest.approx(static_gain(small, outputs, inputs).values, rel=1e-8, abs=1e-13)


@pytest.mark.parametrize(("gravity", "most"), [(NONE, 1e-9), ((400.0, 600.0, -100.0), 1e-7)])
def test_mass_and_frequencies_do_not_depend_on_the_order_of_ends(gravity: tuple[float, float, float], most: float):
    """Of heavy leaves neither: their weight turns in the frame of the body that they start from."""
    stages = [guide(swap=swap, gravity=gravity, mass=5e-3) for swap in (False, True)]
    one, other = (linearise(equilibrium(nonlinear(each), loads(SPACE * UNIT))) for each in stages)
    assert fs.modes(other).frequencies[:12] == pytest.approx(fs.modes(one).frequencies[:12], rel=most)
    assert other.base_inertia[:6] == pytest.approx(one.base_inertia[:6], rel=most, abs=most)


def test_a_soft_rod_vibrates_alike_from_either_end():
    """Its weight stretches and shears it by a thousandth, and turns in the frame of the body it starts from: so do its points with it."""
    soft = fs.Material(young=5e7, poisson=0.3, density=8000.0)
    head = fs.Body(mass=0.05, inertia=fs.Inertia(1e-5, 1e-5, 1e-5), centre=(0.1, 0.0, 0.0), reference=(0.1, 0.0, 0.0))
    found = []
    for joins, along in ((("ground", "platform"), 1.0), (("platform", "ground"), -1.0)):
        link = fs.Link(joins, "rod", at=(0.05, 0.0, 0.0), along=(along, 0.0, 0.0), bends=fs.Z)
        rod = fs.Rod("soft", length=0.1, diameter=0.03)
        each = fs.Mechanism("", {"soft": soft}, {"rod": rod}, {"platform": head}, {"rod": link}, gravity=(30.0, 60.0, -10.0))
        found.append(fs.modes(linearise(equilibrium(nonlinear(each, resolution=FINE)))).frequencies[:12])
    assert found[1] == pytest.approx(found[0], rel=1e-7)


@pytest.mark.parametrize("swap", [False, pytest.param(True, marks=pytest.mark.full)])
def test_small_motions_are_the_slopes_of_large_ones(swap: bool):
    """Compliance about a loaded state with weight, by two more equilibria."""
    model = nonlinear(guide(swap=swap, gravity=(400.0, 600.0, -100.0), mass=5e-3, centre=AWAY), resolution=FINE)
    wrench = SPACE * UNIT * [1, 1, 1, 0, 0, 0]
    step = 1e-4 * UNIT
    state = equilibrium(model, loads(wrench + step * np.concatenate([[np.zeros(6)], np.eye(6)[:3], -np.eye(6)[:3]])))
    slopes = (state.displacement()[1:4] - state.displacement()[4:]).T / (2.0 * step)
    about = linearise(equilibrium(model, loads(wrench)))
    names = tuple("xyz")
    found = static_gain(about, tuple(f"platform.{name}" for name in names), tuple(f"platform.f{name}" for name in names)).values
    scale = np.sqrt(np.diag(slopes))
    assert np.max(np.abs(found - slopes) / scale / scale[:, None]) < 1e-5


def test_cases_of_a_state_are_cases_of_its_model():
    model = nonlinear(guide())
    wrench = np.linspace(0.0, 1.0, 4).reshape(2, 2, 1) * SPACE * UNIT
    whole = fs.modes(linearise(equilibrium(model, loads(wrench))))
    alone = fs.modes(linearise(equilibrium(model, loads(wrench[1, 0]))))
    assert whole.frequencies.shape[:2] == (2, 2)
    assert whole.frequencies[1, 0, :8] == pytest.approx(alone.frequencies[:8], rel=1e-8)


def test_matrices_of_many_coordinates_are_the_sums_of_what_their_parts_do(monkeypatch: pytest.MonkeyPatch):
    about = linearise(equilibrium(nonlinear(guide()), loads(np.array([[0.0], [1.0]]) * SPACE * UNIT)))
    frequencies = eigenvalues(about)[:, :12]
    for module in (eigen, model):
        monkeypatch.setattr(module, "WIDE", 0)
    for parts in (about.stiffness, about.inertia):
        whole = strain_forces(parts, {name: item.operator for name, item in parts.items()})
        assert np.max(np.abs(assemble(parts, len(about.coordinates)) - whole)) < 1e-13 * np.max(np.abs(whole))
    assert eigenvalues(about)[:, :12] == pytest.approx(frequencies, rel=1e-9)
