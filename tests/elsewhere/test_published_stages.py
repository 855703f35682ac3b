"""Stages that others built or computed, against the numbers they print."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modes
from flexstage.base.units.scale import deg, mm
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import set_text
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped


def lowest(**parameters: float) -> np.ndarray:
    return modes(lumped(case("telescope-mount", parameters))).frequencies[:6]


def test_telescope_mount_has_the_frequencies_of_its_finite_elements():
    """GardenerGeralt/ssd-2024-group-b at f1b61c4b, Bipod_FEA_model_v2.0/assembly_sim1-modal.f06.

    Twenty elements a strut. Ours are lower, as the struts' sections have rotary inertia: (1/2) 12.3 r^2/L^2 = 0.04 % of a clamped beam's
    first frequency; the elements' mass is lumped and has none.
    """
    printed = np.array([172.4707, 172.4707, 233.9532, 281.3463, 281.7757, 281.7757])
    error = lowest() / printed - 1.0
    assert np.all(np.abs(error) < 5e-4)
    assert np.all(error < 0.0)


def test_telescope_mount_on_thinner_blades():
    """Results/Iterations.txt of the same project: 165 Hz with blades of 2 mm, printed to whole hertz."""
    assert lowest(thickness=2 * mm)[0] == pytest.approx(165.0, abs=0.5)


def sideways(**parameters: float) -> float:
    """Motion of the mirror along x by a force along x [m/N]."""
    return float(static_gain(lumped(case("mirror-mount", parameters)), ("platform.x",), ("platform.fx",)).values[0, 0])


def test_mirror_mount_sags_as_published():
    """Kihm, Yang & Lee, Rev. Sci. Instrum. 85, 125101 (2014): 10.5 um sideways by their theory (11.2 um by finite elements).

    They print no modulus: ours is Invar's of handbooks.
    """
    assert 46.0 * 9.80665 * sideways() == pytest.approx(10.5e-6, rel=0.01)


def test_mirror_mount_is_as_stiff_as_its_legs_stretch():
    """1.5 x 2 (E t w / 3 l) sin^2(psi / 2), the same paper; what bending of the blades adds goes with their thickness squared."""
    blade = case("mirror-mount").parts["blade"]
    stretch = 3.0 * 141e9 * blade.width / (3.0 * blade.length) * math.sin(32 * deg) ** 2
    added = [1.0 / sideways(blade_thickness=thickness) / (stretch * thickness) - 1.0 for thickness in (0.2 * mm, 0.4 * mm)]
    assert 0.0 < added[0] < 5e-4
    assert added[1] / added[0] == pytest.approx(4.0, rel=0.02)


def test_leaf_guide_bends_as_its_solid_elements():
    """GitHub haijunsu-osu/parallelogram_model_comparison at 20457f69, fea_models/3d: 5.01558 mm under 0.5 E I / L^2.

    PARALLOGRAM_FEA_3D_sweep.csv, fy = 0.5, fx = m = 0; its own mesh errs by 0.6 % (MESH_REFINEMENT_COMPARISON.md). A beam: 4.1 % more.
    """
    unit = 210e9 * 0.05 * 0.005**3 / 12.0 / 0.25**2
    motion = {}
    for section in ("plate", "beam"):
        stage = set_text(case("leaf-guide"), "parts.leaf.section", section)
        motion[section] = 0.5 * unit * float(static_gain(lumped(stage), ("platform.y",), ("platform.fy",)).values[0, 0])
    assert motion["plate"] == pytest.approx(5.01558e-3, rel=6e-3)
    assert motion["beam"] / 5.01558e-3 - 1.0 == pytest.approx(0.041, abs=0.002)


def test_resonator_is_as_stiff_as_its_formula_and_as_heavy_as_its_legs_make_it():
    """COMSOL application 477: 4 E t b^3 / L^3 and the plate's mass alone, 14.989 kHz; legs add 13/35 of their own mass (Rayleigh)."""
    model = lumped(case("resonator"))
    formula = 4.0 * 155e9 * 2.25e-6 * (2e-6 / 200e-6) ** 3
    assert 1.0 / float(static_gain(model, ("platform.x",), ("platform.fx",)).values[0, 0]) == pytest.approx(formula, rel=1e-3)
    plate, legs = 2330.0 * 250e-6 * 120e-6 * 2.25e-6, 4.0 * 2330.0 * 200e-6 * 2e-6 * 2.25e-6
    heavy = math.sqrt(formula / (plate + 13.0 / 35.0 * legs)) / (2.0 * math.pi)
    assert modes(model).frequencies[0] == pytest.approx(heavy, rel=1e-3)


def test_suspension_has_the_modes_of_a_chain_of_its_masses_and_springs():
    """Masses and stiffnesses of ark0015/pygwinc_clone, ifo/aLIGO/ifo.yaml; the chain is written out here, fibres as rods in a row."""
    fibres = 4.0 * 72e9 * math.pi / (0.5 / 205e-6**2 + 0.09 / 400e-6**2)
    k, m = [3400.0, 3900.0, 5200.0, fibres], [22.1, 21.8, 39.6, 39.6]
    stiffness = np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    chain = np.sqrt(np.sort(np.linalg.eigvals(stiffness / np.array(m)[:, None]).real)) / (2.0 * np.pi)
    found = modes(lumped(case("quad-suspension"))).frequencies
    assert [found[np.argmin(np.abs(found - each))] for each in chain] == pytest.approx(chain.tolist(), rel=1e-6)
    np.testing.assert_allclose(chain, [0.5959, 2.3654, 3.8079, 9.7320], atol=5e-5)
