"""Error budget of force-driven stages: noise by closed form and by simulation, floor, parasitic motion, reciprocity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy

import flexstage as fs
from flexstage.analysis.assessment.budget import budget
from flexstage.analysis.assessment.error_budget import NOISES, PARASITIC
from flexstage.analysis.dynamics.random_response import Rate
from flexstage.experiment.virtual_rig.rig import rig
from flexstage.experiment.virtual_rig.setup import NoiseDrive, RigSetup, Sensing
from flexstage.mechanism.mechanism import ModalDamping
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.frequency import transfer
from flexstage.models.linear.port import ports
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped

WHOLE = fs.case("z-stage")
STAGE = replace(
    WHOLE,
    payloads={},
    links={name: link for name, link in WHOLE.links.items() if name != "carrier"},
    gravity=(0.0, 0.0, 0.0),
    damping=ModalDamping(0.02),
)
"""Without anything that a loaded state would change."""
MODEL = lumped(STAGE)
BAND = (0.05, 90.0)
CURRENT, FLOOR = fs.Spectrum(1e-10), fs.Spectrum(1e-10, rate=Rate.ACCELERATION)


def errors(noise: dict[str, fs.Spectrum], stage: fs.Mechanism = STAGE) -> fs.Matrix:
    return budget(stage, {"z": 1e-3}, temperature=0.0, noise=noise, band=BAND).ideal


def test_noise_is_that_of_one_mass_on_its_springs() -> None:
    """sigma^2 = S g^2 omega/(8 zeta) for a force, S/(8 zeta omega^3) for the floor's acceleration (Crandall and Mark, 1963)."""
    omega = float(np.sqrt(eigen(MODEL).values[0]))
    gain = float(static_gain(MODEL, ("platform.z",), ("motor",)).values[0, 0])
    found = errors({"motor": CURRENT, "ground.z": FLOOR})
    expected = 3.0 * np.array([1e-5 * gain * np.sqrt(omega / 0.16), 1e-5 / np.sqrt(0.16 * omega**3)])
    np.testing.assert_allclose([found.at("z", name) for name in NOISES], expected, rtol=2e-2)


def test_budget_and_simulation_agree() -> None:
    setup = RigSetup(seconds=2000.0, rate=256.0, drive=NoiseDrive(current=1e-3, band=(0.0, 90.0)), sensing=Sensing(0.0, 0.0))
    samples = rig(STAGE, MODEL, setup).values
    lines, densities = scipy.signal.welch(samples[:, 0], setup.rate, nperseg=4096)
    density = np.mean(densities[(lines > 2.0) & (lines < 60.0)])
    found = errors({"motor": fs.Spectrum(float(density))}).at("z", "actuator noise")
    assert np.std(samples[:, 1]) * 1e-6 == pytest.approx(found / 3.0, rel=0.05)


def test_forces_of_the_elastic_model_make_the_command_exactly() -> None:
    stage = fs.case("tilt-stage")
    found = budget(stage, {"rz": 1e-3}, temperature=0.0)
    assert found.ideal.at("rz", PARASITIC) < 1e-9 * 1e-3
    assert set(NOISES) <= set(found.missing)
    np.testing.assert_array_equal(found.ideal.values, found.corrected.values)


def test_a_stage_without_gauges_has_a_budget_that_names_what_is_not_known() -> None:
    found = budget(replace(STAGE, gauges={}), {"z": 1e-3}, noise={"motor": CURRENT}, band=BAND)
    assert set(found.reasons) == {"gauge noise", "quantisation", "floor vibration"}
    assert found.ideal.at("z", "actuator noise") > 0.0


def test_a_stage_on_strokes_counts_noise_where_it_is_given() -> None:
    stage = fs.case("parallelogram")
    known, without = (budget(stage, {"x": 1e-6}, temperature=0.0, noise=noise) for noise in ({"B": fs.Spectrum(1e-20)}, None))
    assert not set(NOISES) & set(without.ideal.columns)
    assert known.ideal.at("x", "actuator noise") > 0.0
    assert known.missing[-1] == "floor vibration"


@pytest.mark.parametrize("name", ["z-stage", "voice-coil-stage"])
def test_a_wrench_at_one_place_is_seen_at_the_other_as_the_other_way_round(name: str) -> None:
    """Maxwell and Betti, at any frequency, with the coil's own damper: H = H^T."""
    stage = fs.case(name)
    model = lumped(stage)
    point = next(iter(stage.bodies["platform"].points))
    lines = np.array([0.0, 7.0, 90.0])
    one, other = (f"platform.{part}" for part in ("fx", "mz")), (f"{point}.{part}" for part in ("fy", "fz", "mx"))
    wrenches = [*one, *other]
    names = {"f": "", "m": "r"}
    motions = [f"{place}.{names[part[0]]}{part[1]}" for place, _, part in (each.rpartition(".") for each in wrenches)]
    assert model.damping is not None
    both = transfer(model, ports(model, motions, wrenches), lines, model.damping)
    scale = np.sqrt(np.abs(np.einsum("fii->fi", both)))
    sizes = scale[:, :, None] * scale[:, None, :]
    np.testing.assert_allclose(both / sizes, np.swapaxes(both, 1, 2) / sizes, atol=1e-9)
