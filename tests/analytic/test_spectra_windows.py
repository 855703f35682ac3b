"""Windows in closed form, and estimators on responses that are exactly rational."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.experiment.identification.bands import extents
from flexstage.experiment.identification.cluster import stabilisation
from flexstage.experiment.identification.confidence import deviations
from flexstage.experiment.identification.identify import identify
from flexstage.experiment.identification.likelihood import Fit, Modal
from flexstage.experiment.identification.lscf import lscf
from flexstage.experiment.records.record import Channel, Responses, Role, in_memory
from flexstage.experiment.spectral.cross_spectra import Segments, Window, independent_averages, spectra
from flexstage.experiment.spectral.lines import edges, legendre_coefficients, nodes
from flexstage.experiment.spectral.smear import WindowLeakage
from tests.models.identification_study import assurance, bound
from tests.models.synthetic_records import WIDE, Truth, record, truth


def test_white_noise_has_the_density_of_its_variance():
    """2 sigma^2 / rate, one-sided."""
    noise = 3.0 * np.random.default_rng(0).standard_normal((200_000, 1))
    found = spectra(in_memory([Channel("y", "um", Role.OUTPUT)], 100.0, noise), Segments(1.0))
    assert np.mean(np.real(found.yy[2:-1])) == pytest.approx(2.0 * 9.0 / 100.0, rel=0.01)


@pytest.mark.parametrize("window", list(Window))
def test_a_sine_has_its_power_in_its_lines(window: Window):
    time = np.arange(20_000) / 100.0
    wave = np.sqrt(2.0) * np.sin(2.0 * np.pi * 10.0 * time)[:, None]
    found = spectra(in_memory([Channel("y", "um", Role.OUTPUT)], 100.0, wave), Segments(2.0, window=window))
    assert np.sum(np.real(found.yy)) * found.frequencies[1] == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("averages", [1, 2, 3, 7, 40])
@pytest.mark.parametrize("share", [0.5, 0.25])
def test_few_segments_are_worth_what_all_their_pairs_share(averages: int, share: float):
    """The variance of a mean of K is the sum of all K x K correlations over K^2; those of white noise are windows' overlaps squared."""
    size = 64
    window, hop = Window.HANN.samples(size), round(share * size)
    placed = np.zeros((averages, size + hop * (averages - 1)))
    for number in range(averages):
        placed[number, number * hop : number * hop + size] = window
    pairs = (placed @ placed.T / np.sum(window**2)) ** 2
    assert independent_averages(averages, window, hop) == pytest.approx(averages**2 / np.sum(pairs), rel=1e-12)


def test_half_overlapped_hann_segments_are_worth_eleven_twelfths_as_many():
    """Welch 1967: the correlation of neighbours is (1/6)^2."""
    averages = 10_000
    worth = independent_averages(averages, Window.HANN.samples(1024), 512)
    assert worth / averages == pytest.approx(1.0 / (1.0 + 2.0 / 36.0), rel=1e-3)


@pytest.mark.parametrize("window", [Window.HANN, Window.BOXCAR])
@pytest.mark.parametrize("width", [0.01, 0.1, 0.3, 3.0])
def test_smeared_resonance_is_the_transform_of_the_windowed_impulse_response(window: Window, width: float):
    size = 4096
    samples = window.samples(size)
    own = np.correlate(samples, samples, "full")[size - 1 :] / np.sum(samples**2)
    time = np.arange(size) / size
    pole, lines = -width + 10j, np.linspace(7.0, 13.0, 25)
    weight = np.full(size, 2.0 * np.pi / size)
    weight[0] *= 0.5
    kernel = np.exp(2j * np.pi * np.outer(-1j * pole - lines, time))
    smeared, slope = WindowLeakage(window, 1.0).functions(lines, np.array([pole]))
    np.testing.assert_allclose(smeared[:, 0], kernel @ (weight * own), rtol=2e-5, atol=2e-5 * np.max(np.abs(smeared)))
    small = 1e-5
    ahead, behind = (WindowLeakage(window, 1.0).functions(lines, np.array([pole + step]))[0] for step in (small, -small))
    np.testing.assert_allclose(slope, (ahead - behind) / (2.0 * small), rtol=1e-5, atol=1e-6 * np.max(np.abs(slope)))


def test_windows_overstate_damping():
    """By the half-power width of a resonance 5, 8 and 16 lines wide under Hann's window: a tenth, a twentieth, a hundredth or so."""
    found = []
    for share in (5.0, 8.0, 16.0):
        lines = np.linspace(95.0, 105.0, 20_001)
        peak = np.abs(WindowLeakage(Window.HANN, share / 2.0).functions(lines, np.array([-1.0 + 100j]))[0][:, 0]) ** 2
        found.append(np.ptp(lines[peak > 0.5 * np.max(peak)]) / 2.0 - 1.0)
    np.testing.assert_allclose(found, [0.097, 0.04, 0.01], atol=0.003)


def test_poles_of_a_rational_response_are_exact():
    """Also those in the upper half of the band, whose angle on the circle is past a right angle."""
    known = truth(WIDE)
    lines = np.linspace(100.0, 310.0, 2000)
    values = np.einsum("pk,fk,km->fpm", known.shapes, 1.0 / (2j * np.pi * lines[:, None] - known.poles), known.participation)
    found = lscf(lines, values, np.ones((2000, 6)), range(12, 13))[0]
    for pole, row in zip(known.poles, known.participation, strict=True):
        index = int(np.argmin(np.abs(found.values - pole)))
        assert abs(found.values[index] - pole) < 1e-4 * abs(pole)
        assert found.damping[index] == pytest.approx(-pole.real / abs(pole), rel=0.02)
        assert abs(np.dot(row, found.participation[index].conj())) ** 2 / np.sum(row**2) > 0.9999


def test_participation_is_the_left_null_vector():
    """With it and with nothing else the shapes come out: the right one would give the conjugate of another combination."""
    known = truth(WIDE, seed=5)
    skewed = Truth(known.frequencies, known.damping, known.shapes, known.participation * np.exp(1j * np.linspace(0.0, 2.0, 6)))
    lines = np.linspace(100.0, 310.0, 2000)
    values = np.einsum("pk,fk,km->fpm", skewed.shapes, 1.0 / (2j * np.pi * lines[:, None] - known.poles), skewed.participation)
    found = lscf(lines, values, np.ones((2000, 6)), range(12, 13))[0]
    for pole, row in zip(known.poles, skewed.participation, strict=True):
        index = int(np.argmin(np.abs(found.values - pole)))
        assert abs(np.vdot(row, found.participation[index])) ** 2 / np.sum(np.abs(row) ** 2) > 0.9999


def test_stable_poles_are_candidates():
    known = truth(WIDE)
    lines = np.linspace(100.0, 310.0, 1000)
    values = known.response(lines)
    noise = np.random.default_rng(0).standard_normal((2, *values.shape))
    values = values + 0.01 * np.std(values) * (noise[0] + 1j * noise[1])
    diagram, candidates = stabilisation(lscf(lines, values, np.ones((1000, 6)), range(3, 13)), 0.1)
    near = [min(abs(abs(candidate.pole) / each - 1.0) for candidate in candidates) for each in WIDE]
    assert max(near) < 0.002
    assert np.sum(diagram.stable == 3) > 30


def test_without_noise_modes_are_exact():
    known = truth(WIDE)
    lines = np.arange(40.0, 420.0, 0.25)
    names = [tuple(Channel(f"{kind}{index}", "V") for index in range(6)) for kind in "yu"]
    found = identify(Responses(lines, *names, known.response(lines)))
    np.testing.assert_allclose(found.frequencies, known.frequencies, rtol=1e-6)
    np.testing.assert_allclose(found.damping, known.damping, rtol=1e-4)
    assert np.min(np.max(assurance(known.shapes, found.shapes), axis=1)) > 1.0 - 1e-6
    residue = 2.0 * np.pi * known.frequencies / (2j * np.sqrt(1.0 - known.damping**2))
    expected = np.einsum("k,pk,km->kpm", residue, known.shapes, known.participation)
    np.testing.assert_allclose(np.einsum("pk,km->kpm", found.shapes, found.participation), expected, atol=2e-4 * np.max(np.abs(expected)))


def test_an_analysers_window_is_divided_out():
    """One resonance five lines wide: as it stands its damping would come out 5 % too large."""
    lines = np.arange(80.0, 120.0, 0.4)
    pole = 100.0 * (-0.01 + 1j)
    values = WindowLeakage(Window.HANN, 2.5).functions(lines, np.array([pole]))[0][:, :, None]
    noise = np.random.default_rng(1).standard_normal((2, *values.shape))
    values = values + 1e-3 * np.max(np.abs(values)) * (noise[0] + 1j * noise[1])
    channels = ((Channel("y", "um"),), (Channel("u", "V"),))
    divided, raw = (identify(Responses(lines, *channels, values, window=window)) for window in ("hann", ""))
    assert divided.damping[0] == pytest.approx(0.01, rel=0.01)
    assert raw.damping[0] > 0.0102


def test_cells_hold_a_resonance_to_six_digits():
    poles = np.array([-1.0 + 100j, -0.5 + 103j])
    limits = edges(poles, 80.0, 130.0)
    assert limits[0] == 80.0
    assert limits[-1] == pytest.approx(130.0)
    low, high = limits[:-1], limits[1:]
    exact = 1.0 / (1j * nodes(low, high)[:, None, :] - poles[:, None])
    x = np.linspace(-1.0, 1.0, 21)
    taken = legendre_coefficients(exact) @ np.polynomial.legendre.legvander(x, 7).T
    points = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * x
    true = 1.0 / (1j * points[:, None, :] - poles[:, None])
    assert np.max(np.abs(taken - true) / np.abs(true)) < 1e-6


def test_far_groups_are_fitted_apart_and_near_ones_together():
    found = extents(np.array([-1 + 100j, -1 + 120j, -1 + 200j]), 1.0, 500.0)
    assert [band.members for band in found] == [(0, 1), (2,)]


def test_the_bound_is_that_of_one_mode_in_closed_form():
    """One real mode, one input, one output, small damping: var(f) = h q / (pi T) and var(h) = 2 h q / (pi T).

    q is the noise's power per line over the peak's. Near resonance H = R / (j x + h), x = f - f0, and R is real but for a phase that is
    known: |dH/df0|^2 and |dH/dh|^2 integrate to R^2 pi / (2 h^3), and R, not known either, takes half of the latter away.
    """
    zeta, natural, seconds, noise, rate = 0.005, 100.0, 120.0, 0.1, 2048.0
    known = Truth(np.array([natural]), np.array([zeta]), np.ones((1, 1)), np.ones((1, 1)))
    half = zeta * natural
    quality = noise**2 * np.mean(np.abs(known.response(np.arange(1.0, rate / 2.0, 0.125))) ** 2) * (2.0 * zeta) ** 2
    found = bound(known, noise, seconds, rate)[:, 0] * np.array([natural, half])
    np.testing.assert_allclose(found**2, np.array([1.0, 2.0]) * half * quality / (np.pi * seconds), rtol=0.05)


def test_deviations_of_one_mode_are_the_closed_form():
    """With R complex and not known, the phase takes half of what tells f away too: var(f) = var(h) = 2 h q / (pi T).

    What lies outside the band is not known either, and takes as much again at most.
    """
    zeta, natural, seconds, noise, rate = 0.01, 100.0, 60.0, 0.1, 512.0
    known = Truth(np.array([natural]), np.array([zeta]), np.ones((1, 1)), np.ones((1, 1)))
    found = identify(record(known, 1, seconds=seconds, rate=rate, noise=noise))
    half = zeta * natural
    power = np.mean(np.abs(known.response(np.arange(1.0, rate / 2.0, 0.125))) ** 2)
    expected = 2.0 * half * noise**2 * power * (2.0 * zeta) ** 2 / (np.pi * seconds)
    for deviation in (found.frequency_deviations[0], natural * found.damping_deviations[0]):
        assert 0.95 * expected < deviation**2 < 2.2 * expected


def test_a_deviation_of_the_pole_is_one_of_frequency_and_of_damping():
    """p = f (-z + j sqrt(1 - z^2)) with parts that deviate alike, by s: f deviates by s, z by s sqrt(1 - z^2) / f."""
    pole = 50.0 * np.array([-0.6 + 0.8j])
    found = deviations(Fit(Modal(pole, np.ones((1, 1), complex), np.ones((1, 1), complex)), 0.0, np.eye(3, dtype=complex), converged=True))
    assert found.frequencies[0] == pytest.approx(np.sqrt(0.5), rel=1e-12)
    assert found.damping[0] == pytest.approx(np.sqrt(0.5) * 0.8 / 50.0, rel=1e-12)


def test_a_deviation_of_a_shape_is_one_of_its_ratios():
    """Of parts that deviate alike, by s, a ratio r = b / a of real numbers has var(r) = (1 + r^2) s^2 / a^2; the largest is 1."""
    shape = np.array([[2.0], [-1.0]], complex)
    found = deviations(Fit(Modal(np.array([1j]), np.ones((1, 1), complex), shape), 0.0, np.eye(4, dtype=complex), converged=True))
    np.testing.assert_allclose(found.shapes[:, 0], [0.0, np.sqrt(0.5 * (1.0 + 0.25) / 4.0)], rtol=1e-12)
