"""The virtual test rig: its records are what random vibration theory, time integration and the modes of the stage say they must be."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import scipy

import flexstage as fs
from flexstage.analysis.complete import platform_modes
from flexstage.base.number import Array
from flexstage.experiment import Amplifier, AntiAlias, InputQuantity, InputSignal, NoiseDrive, RigSetup, Sensing
from flexstage.experiment.formats.read import read
from flexstage.experiment.formats.write import write
from flexstage.experiment.identification.identify import Search, identify
from flexstage.experiment.records.record import Record
from flexstage.experiment.spectral.cross_spectra import Segments, Window, spectra
from flexstage.experiment.spectral.transfer import h1, multiple_coherence, noise_density
from flexstage.experiment.virtual_rig.chain import amplitude_shape, butterworth, chain
from flexstage.experiment.virtual_rig.plan import plan_test
from flexstage.experiment.virtual_rig.rig import as_record, simulate_test
from flexstage.experiment.virtual_rig.tables import rig_table
from flexstage.mechanism.mechanism import Mechanism, ModalDamping, StructuralDamping
from flexstage.models.linear.damping import modal_ratios
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.port import ports
from flexstage.models.linear.state_space import state_space
from tests.models.solid_studies import small, small_stage

FINE = Sensing(resolution=0.0)
"""Gauges without steps, and as the shipped stage states none, without noise."""
BARE = RigSetup(seconds=60.0, sensing=FINE, filter=AntiAlias(order=0))


@cache
def stage() -> tuple[Mechanism, LinearModel]:
    mechanism = fs.case("double-triangle")
    return mechanism, fs.mapped(mechanism)


@cache
def lumped() -> LinearModel:
    return fs.lumped(stage()[0])


def recorded(setup: RigSetup, model: LinearModel | None = None) -> Record:
    mechanism, mapped = stage()
    return fs.experiment.rig(mechanism, model or mapped, setup)


def outputs(record: Record) -> Array:
    return record.values[:, len(record.inputs) :]


def test_variances_are_those_of_the_random_response() -> None:
    mechanism, model = stage()
    setup = replace(BARE, seconds=240.0)
    test = simulate_test(mechanism, model, setup)
    grid = np.concatenate([np.linspace(0.25, 820.0, 400), np.linspace(820.5, 1023.5, 800)])
    shape = np.maximum(amplitude_shape(grid, test.plan.band) ** 2, 1e-30)
    area = np.trapezoid(amplitude_shape(np.linspace(0.0, 1024.0, 20_001), test.plan.band) ** 2, np.linspace(0.0, 1024.0, 20_001))
    spectra_in = {name: fs.Spectrum(rms**2 * shape / area, grid) for name, rms in zip(test.plan.actuators, test.plan.rms, strict=True)}
    expected = fs.random_response(model, test.plan.gauges, spectra_in, (0.25, 1023.5))
    np.testing.assert_allclose(test.chain.output_rms, expected.rms, rtol=1e-3)  # 0.25 Hz are left out
    # Variance of a mean square over T: the integral of the squared density over T (Bendat & Piersol, Random Data, ch. 8).
    deviation = np.sqrt(np.trapezoid(expected.density**2, expected.frequencies, axis=0) / setup.seconds)
    found = np.var(1e-6 * outputs(as_record(test)), axis=0)
    scores = (found - expected.rms**2) / deviation
    assert np.max(np.abs(scores)) < 4.0
    assert np.max(deviation / expected.rms**2) < 0.08  # the law says something


def test_readings_are_those_of_integration_in_time() -> None:
    """Recorded strokes, interpolated sixteen times finer and held linear, through the modal state space."""
    _, model = stage()
    record = recorded(replace(BARE, seconds=7.0, drive=NoiseDrive(band=(0.0, 300.0))))
    space = state_space(model, ports(model, [each.name for each in record.outputs], [each.name for each in record.inputs]), model.damping)
    strokes = scipy.signal.resample_poly(record.values[:, :6], 16, 1, axis=0, window=("kaiser", 14.0))
    system = scipy.signal.cont2discrete((space.A, space.B, space.C, space.D), 1.0 / (16 * record.rate), method="foh")
    _, found, _ = scipy.signal.dlsim(system, strokes)
    inner = slice(5 * 2048, -1024)  # what the stage did before the record began is forgotten, the interpolation's end is far
    expected = outputs(record)[inner]
    assert np.max(np.abs(found[::16][inner] - expected)) < 5e-4 * np.max(np.abs(expected))


def test_responses_estimated_are_those_of_the_model() -> None:
    """Without noise the error is leakage alone, and as large as the coherence states."""
    _, model = stage()
    record = recorded(replace(BARE, seconds=120.0, filter=AntiAlias()))
    known = spectra(record, Segments(4.0)).band(20.0, 600.0)
    expected = fs.response(model, [each.name for each in record.outputs], [each.name for each in record.inputs], known.frequencies)
    inverse = np.real(np.diagonal(np.linalg.inv(known.xx), axis1=1, axis2=2))
    stated = noise_density(known)[:, :, None] * inverse[:, None, :] / known.independent
    error = np.abs(h1(known).values - expected.values) ** 2
    scores = np.mean(error, axis=(0, 2)) / np.mean(stated, axis=(0, 2))
    assert np.all((scores > 0.7) & (scores < 1.3))
    assert np.min(np.median(multiple_coherence(known), axis=0)) > 0.999


def test_errors_of_responses_are_as_large_as_their_spectra_state() -> None:
    """With gauge noise the variance of H1 is that of the noise over the input's density and the averages (Bendat & Piersol, ch. 9)."""
    _, model = stage()
    sensing = Sensing(density=2e-8, resolution=0.0)
    record = recorded(replace(BARE, seconds=120.0, sensing=sensing, drive=NoiseDrive(actuators=("B4",))))
    known = spectra(record, Segments(4.0, overlap=0.0)).band(300.0, 800.0)  # far from the resonances: no leakage
    expected = fs.response(model, [each.name for each in record.outputs], ["B4"], known.frequencies).values[:, :, 0]
    folded = 2.0  # without a filter, noise above the Nyquist frequency folds back once
    variance = folded * (2e-8 * 1e6) ** 2 / (known.averages * np.real(known.xx[:, 0, 0]))
    scores = np.abs(h1(known).values[:, :, 0] - expected) ** 2 / variance[:, None]
    assert 0.93 < np.mean(scores) < 1.1


def test_the_amplifier_and_the_filter_are_part_of_responses_to_the_command() -> None:
    _, model = stage()
    setup = replace(BARE, seconds=120.0, filter=AntiAlias(4, 400.0), input_signal=InputSignal.COMMAND, input_quantity=InputQuantity.VOLTAGE)
    record = recorded(replace(setup, amplifier=Amplifier(resistance=1000.0), drive=NoiseDrive(voltage=2.0)))
    known = spectra(record, Segments(16.0)).band(10.0, 60.0)
    corner = 1.0 / (2.0 * np.pi * 1000.0 * np.array([4e-7] * 3 + [1.3e-6] * 3))
    stack = np.array([0.15] * 3 + [0.2] * 3)  # um per V
    plain = fs.response(model, [each.name for each in record.outputs], [each.name for each in record.inputs], known.frequencies).values
    lag = stack / (1.0 + 1j * known.frequencies[:, None] / corner)
    expected = plain * lag[:, None, :] * butterworth(known.frequencies, 4, 400.0)[:, None, None]
    np.testing.assert_allclose(np.std(record.values[:, :6], axis=0), 2.0, rtol=0.01)
    assert np.max(np.abs(h1(known).values - expected)) < 0.01 * np.max(np.abs(expected))


def test_the_lag_of_a_gauge_is_that_of_its_bandwidth() -> None:
    """Of first order, 1/(1 + j f/b): the same chain with and without it."""
    mechanism, model = stage()
    slow = replace(mechanism, sensors={name: replace(each, bandwidth=300.0) for name, each in mechanism.sensors.items()})
    setup = replace(BARE, rate=2048.0)
    with_lag, without = (chain(model, plan_test(each, model, setup), model.damping) for each in (slow, mechanism))
    count = min(len(with_lag.outputs), len(without.outputs))
    assert with_lag.size == without.size
    lag = 1.0 / (1.0 + 1j * with_lag.frequencies[:count] / 300.0)
    expected = without.outputs[:count] * lag[:, None, None]
    np.testing.assert_allclose(with_lag.outputs[:count], expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_blocks_are_longer_than_the_chain_remembers() -> None:
    """Whatever the stage rings on for: a block after an impulse, and a block before it, nothing is left."""
    mechanism, model = stage()
    found = chain(model, plan_test(mechanism, model, replace(BARE, rate=2048.0)), ModalDamping(0.002))
    answers = np.abs(np.fft.irfft(found.outputs, 3 * found.size, axis=0))
    assert np.max(answers[found.size : 2 * found.size]) < 1e-9 * np.max(answers)


def test_without_noise_the_modes_come_back_to_seven_digits() -> None:
    mechanism, model = stage()
    found = identify(recorded(replace(BARE, seconds=30.0, filter=AntiAlias())), Search(band=(80.0, 200.0)))
    np.testing.assert_allclose(found.frequencies, platform_modes(mechanism, model).platform_frequencies, rtol=2e-7)
    np.testing.assert_allclose(found.damping, 0.01, rtol=2e-5)


@pytest.mark.parametrize("name", ["mapped", "lumped"])
def test_identification_finds_the_modes_of_the_stage(name: str) -> None:
    """Threefold pairs included, under the gauges' steps of 10 nm, noise of a good gauge, drift and a slow amplifier."""
    mechanism, mapped = stage()
    model = mapped if name == "mapped" else lumped()
    setup = RigSetup(
        seconds=30.0,
        seed=3,
        drive=NoiseDrive(stroke=0.2e-6),
        amplifier=Amplifier(bandwidth=300.0),
        sensing=Sensing(density=1e-9, drift=20e-9),
    )
    found = identify(recorded(setup, model), Search(band=(80.0, 200.0)))
    expected = platform_modes(mechanism, model)
    np.testing.assert_allclose(found.frequencies, expected.platform_frequencies, rtol=5e-4)
    np.testing.assert_allclose(found.damping, 0.01, rtol=0.03)
    assert found.close == ((0, 1), (4, 5))
    seen = ports(model, [each.name for each in found.outputs], ["B1"]).output @ expected.shapes[:, list(expected.platform)]
    for group in ((0, 1), (2,), (3,), (4, 5)):
        angle = np.max(scipy.linalg.subspace_angles(seen[:, list(group)], found.real_shapes[:, list(group)]))
        assert np.degrees(angle) < 2.0


def test_one_actuator_at_a_time_makes_the_same_test() -> None:
    mechanism, model = stage()
    drive = NoiseDrive(stroke=0.5e-6)
    names = [f"B{number}" for number in range(1, 7)]
    noisy = Sensing(density=5e-10)  # a gauge that sees nothing of one actuator still has noise
    setups = [RigSetup(seconds=10.0, seed=seed, drive=replace(drive, actuators=(name,)), sensing=noisy) for seed, name in enumerate(names)]
    records = [recorded(setup) for setup in setups]
    assert [[each.name for each in record.inputs] for record in records] == [[name] for name in names]
    found = identify(records, Search(band=(80.0, 200.0)))
    np.testing.assert_allclose(found.frequencies, platform_modes(mechanism, model).platform_frequencies, rtol=5e-4)


def test_steps_are_noise_of_a_twelfth_of_their_square() -> None:
    fine, coarse = (outputs(recorded(replace(BARE, sensing=sensing))) for sensing in (FINE, Sensing()))
    difference = 1e3 * (coarse - fine)  # nm; the C36 has steps of 10 nm
    assert np.max(np.abs(difference)) <= 5.0 + 1e-6
    np.testing.assert_allclose(np.var(difference, axis=0), 100.0 / 12.0, rtol=0.015)
    assert np.max(np.abs(coarse / 0.01 - np.round(coarse / 0.01))) < 1e-6


def test_drift_is_a_random_walk_across_blocks() -> None:
    setup = replace(BARE, seconds=100.0, drive=NoiseDrive(stroke=0.1e-6))
    still, drifting = (outputs(recorded(replace(setup, sensing=sensing))) for sensing in (FINE, Sensing(resolution=0.0, drift=60e-9)))
    walked = 1e3 * (drifting - still)
    for lag in (1, 16, 2048, 10 * 2048):
        steps = walked[lag::lag] - walked[:-lag:lag]
        expected = 60.0 * np.sqrt(lag / 2048.0 / 60.0)
        assert np.std(steps) == pytest.approx(expected, rel=5.0 / np.sqrt(2.0 * steps.size) + 1e-3)
    neighbours = np.corrcoef(np.diff(walked[:, 0])[1:], np.diff(walked[:, 0])[:-1])[0, 1]
    assert abs(neighbours) < 5.0 / np.sqrt(len(walked))


def test_expected_rms_is_stated_without_drift() -> None:
    """A strong drift exceeds the motion in the record; the table says that its rms values leave it out."""
    setup = RigSetup(seconds=8.0, rate=1024.0, drive=NoiseDrive(stroke=1e-8), sensing=Sensing(drift=5e-6, resolution=0.0))
    test = simulate_test(*stage(), setup)
    assert np.sqrt(np.mean(test.read(0, test.length)[:, -1] ** 2)) > 5.0 * 1e6 * test.chain.output_rms[-1]
    assert "expected rms without drift" in rig_table(test).notes[0]


def test_strokes_are_as_fast_as_their_band_makes_them() -> None:
    """The mean square of a rate is (2 pi)^2 times the integral of f^2 times the density: what amplifiers' currents follow from."""
    mechanism, model = stage()
    plan = plan_test(mechanism, model, replace(BARE, seconds=1.0))
    lines = np.linspace(0.0, 1024.0, 20_001)
    density = amplitude_shape(lines, plan.band) ** 2
    expected = 2.0 * np.pi * plan.rms * np.sqrt(np.trapezoid(lines**2 * density, lines) / np.trapezoid(density, lines))
    np.testing.assert_allclose(chain(model, plan, model.damping).stroke_rate_rms, expected, rtol=1e-3)


def test_gauge_noise_has_its_density_below_the_filter() -> None:
    setup = replace(BARE, seconds=60.0, filter=AntiAlias(8, 800.0))
    quiet, noisy = (outputs(recorded(replace(setup, sensing=replace(FINE, density=density)))) for density in (0.0, 5e-9))
    frequencies, density = scipy.signal.welch(1e3 * (noisy - quiet), 2048.0, nperseg=2048, axis=0)
    assert np.mean(density[(frequencies > 5.0) & (frequencies < 500.0)]) == pytest.approx(25.0, rel=0.02)
    assert np.mean(density[frequencies > 1015.0]) < 0.1 * 25.0


def test_noise_stays_within_its_band() -> None:
    record = recorded(replace(BARE, drive=NoiseDrive(stroke=1e-6, band=(40.0, 200.0))))
    frequencies, density = scipy.signal.welch(record.values[:, 0], record.rate, nperseg=8192, window=Window.BLACKMAN.value, detrend=False)
    assert np.std(record.values[:, 0]) == pytest.approx(1.0, rel=0.02)
    inside = (frequencies > 42.0) & (frequencies < 198.0)
    outside = (frequencies < 18.0) | (frequencies > 252.0)
    assert np.max(density[outside]) < 1e-6 * np.mean(density[inside])
    assert np.std(density[inside]) < 0.35 * np.mean(density[inside])


@pytest.mark.parametrize("suffix", [".uff", ".h5", ".csv", ".mat"])
def test_the_same_seed_gives_the_same_file(tmp_path: Path, suffix: str) -> None:
    setup = RigSetup(seconds=2.0, seed=11, sensing=Sensing(density=1e-10, drift=1e-9))
    files = [tmp_path / f"{name}{suffix}" for name in ("first", "again", "other")]
    for path, seed in zip(files, (11, 11, 12), strict=True):
        write(path, recorded(replace(setup, seed=seed)))
    first, again, other = (path.read_bytes() for path in files)
    assert first == again
    assert first != other
    back = read(files[0])
    assert isinstance(back, Record)
    np.testing.assert_array_equal(back.values, recorded(setup).values)
    assert [(each.name, each.unit, each.role) for each in back.channels] == [
        (each.name, each.unit, each.role) for each in recorded(setup).channels
    ]


def test_any_stretch_is_the_same_however_it_is_read() -> None:
    setup = RigSetup(seconds=40.0, seed=5, sensing=Sensing(density=1e-9, drift=1e-9))
    whole, late = recorded(setup), recorded(setup)
    np.testing.assert_array_equal(late.samples.read(60_000, 60_100), whole.values[60_000:60_100])
    np.testing.assert_array_equal(np.concatenate(list(late.blocks(7_000))), whole.values)


def test_a_drive_far_above_half_the_rate_gives_as_many_samples_as_asked() -> None:
    """Blocks contain a power of two of samples: a sampling rate multiplied by three would not divide them."""
    mechanism, model = stage()
    test = simulate_test(mechanism, model, RigSetup(seconds=12.0, rate=1024.0, drive=NoiseDrive(stroke=1e-7, band=(0.0, 1000.0))))
    whole = test.read(0, test.length)
    assert test.length > test.block
    assert len(whole) == test.length
    np.testing.assert_array_equal(test.read(test.block + 7, test.block + 17), whole[test.block + 7 : test.block + 17])


def test_records_go_on_over_the_ends_of_blocks() -> None:
    """A jump where blocks meet would be noise in the second differences of a smooth motion."""
    mechanism, model = stage()
    test = simulate_test(mechanism, model, replace(BARE, seconds=100.0, drive=NoiseDrive(band=(0.0, 20.0))))
    bends = np.max(np.abs(np.diff(test.read(0, test.length), n=4, axis=0)), axis=1)
    ends = [number * test.block - each for number in range(1, test.length // test.block) for each in (1, 2, 3)]
    assert ends
    assert np.max(bends[ends]) < np.max(np.delete(bends, ends))


def test_structural_damping_becomes_equivalent_ratios_and_says_so() -> None:
    mechanism, _ = stage()
    model = lumped()
    record = fs.experiment.rig(mechanism, model, replace(BARE, seconds=30.0, drive=NoiseDrive(stroke=0.2e-6)), damping=StructuralDamping())
    assert "structural damping as equivalent modal ratios" in record.name
    found = identify(record, Search(band=(80.0, 200.0)))
    ratios = modal_ratios(model, eigen(model), StructuralDamping())[list(platform_modes(mechanism, model).platform)]
    np.testing.assert_allclose(found.damping, ratios, rtol=0.01)


@pytest.mark.full
def test_the_solid_model_is_a_plant_like_any_other() -> None:
    mechanism, read_as_solid = small(), small_stage().read.model
    setup = RigSetup(seconds=5.0, rate=16_384.0, sensing=Sensing(density=1e-11, resolution=0.0))
    found = identify(fs.experiment.rig(mechanism, read_as_solid, setup))
    assert len(found.frequencies) == 1  # one stack and one gauge along it: of all modes they see the guided one
    ways = [fs.modes(model).frequencies for model in (read_as_solid, fs.lumped(mechanism))]
    by_solids, by_lumps = (float(np.min(np.abs(each / found.frequencies[0] - 1.0))) for each in ways)
    assert by_solids < 1e-4
    assert by_lumps > 1e-2
