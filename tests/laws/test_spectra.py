"""Spectra and transfer functions keep to laws whatever the record: units, order of channels, blocks, energy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.experiment.progress import followed
from flexstage.experiment.records.record import Channel, InMemory, Record, Role, in_memory
from flexstage.experiment.spectral import cross_spectra as module
from flexstage.experiment.spectral.cross_spectra import Segments, Window, pool, spectra
from flexstage.experiment.spectral.transfer import (
    h1,
    h2,
    multiple_coherence,
    noise_density,
    ordinary_coherence,
    spectral_ratio,
)

RATE = 64.0


def made(seed: int, inputs: int = 2, outputs: int = 3, seconds: float = 40.0, *, noise: float = 0.5) -> tuple[Record, np.ndarray]:
    """Outputs that are fixed multiples of correlated inputs, one sample late, and noise; and those multiples."""
    random = np.random.default_rng(seed)
    size = round(seconds * RATE)
    drive = random.standard_normal((size, inputs)) @ (np.eye(inputs) + 0.4 * random.standard_normal((inputs, inputs)))
    gains = random.standard_normal((outputs, inputs))
    moved = drive @ gains.T + noise * random.standard_normal((size, outputs))
    channels = [Channel(f"u{index}", "V", Role.INPUT) for index in range(inputs)]
    channels += [Channel(f"y{index}", "um", Role.OUTPUT) for index in range(outputs)]
    return in_memory(channels, RATE, np.hstack([drive, moved])), gains


seeds = st.integers(0, 2**31)
segments = st.builds(Segments, st.sampled_from([0.5, 1.0, 2.0]), st.sampled_from([0.0, 0.5, 0.75]), st.sampled_from(list(Window)))
few = settings(max_examples=25)


@few
@given(seeds, segments)
def test_spectra_are_hermitian_and_positive(seed: int, cut: Segments):
    found = spectra(made(seed)[0], cut)
    every = np.block([[found.xx, np.conj(np.swapaxes(found.yx, 1, 2))], [found.yx, found.yy]])
    np.testing.assert_allclose(every, np.conj(np.swapaxes(every, 1, 2)), atol=1e-12 * np.max(np.abs(every)))
    assert np.min(np.linalg.eigvalsh(every)) > -1e-12 * np.max(np.abs(every))


@few
@given(seeds, segments)
def test_integral_of_a_density_is_the_variance(seed: int, cut: Segments):
    """Parseval, of the windowed segments: to within what a window weighs unevenly."""
    record, _ = made(seed, seconds=400.0)
    found = spectra(record, cut)
    step = found.frequencies[1]
    power = np.real(np.diagonal(found.xx, axis1=1, axis2=2)).sum(axis=0) * step
    free = 1.0 - 1.5 / (cut.seconds * RATE)
    np.testing.assert_allclose(power, np.var(record.values[:, :2], axis=0) * free, rtol=0.08)


@few
@given(seeds, segments, st.floats(1e-9, 1e9))
def test_units_scale_spectra(seed: int, cut: Segments, factor: float):
    record, _ = made(seed)
    scaled = record.values * np.array([1.0, 1.0, factor, factor, factor])
    first, second = h1(spectra(record, cut)), h1(spectra(replace(record, samples=InMemory(scaled)), cut))
    np.testing.assert_allclose(second.values, factor * first.values, rtol=1e-9, atol=1e-9 * factor * np.max(np.abs(first.values)))


@few
@given(seeds, segments)
def test_order_of_channels_does_not_matter(seed: int, cut: Segments):
    record, _ = made(seed)
    turned = record.select(["y2", "u1", "y0", "u0", "y1"])
    first, second = h1(spectra(record, cut)), h1(spectra(turned, cut))
    np.testing.assert_allclose(second.at("y2", "u0"), first.at("y2", "u0"), rtol=1e-9)


@few
@given(seeds, segments)
def test_blocks_do_not_matter(seed: int, cut: Segments):
    record, _ = made(seed)
    whole = spectra(record, cut)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "BATCH", 1)
        parts = spectra(record, cut)
    assert parts.averages == whole.averages
    np.testing.assert_allclose(parts.yy, whole.yy, rtol=1e-9, atol=1e-12)


@few
@given(seeds)
def test_without_noise_every_estimate_is_the_truth(seed: int):
    record, gains = made(seed, outputs=3, noise=0.0)
    found = spectra(record, Segments(1.0))
    inside = slice(1, -1)
    for estimate in (h1, h2):
        expected = np.broadcast_to(gains, estimate(found).values[inside].shape)
        np.testing.assert_allclose(estimate(found).values[inside], expected, atol=1e-6)
    np.testing.assert_allclose(multiple_coherence(found)[inside], 1.0, atol=1e-9)


@few
@given(seeds)
def test_coherences_are_shares(seed: int):
    found = spectra(made(seed)[0], Segments(1.0))
    ordinary, multiple = ordinary_coherence(found), multiple_coherence(found)
    assert np.all((ordinary >= 0.0) & (ordinary <= 1.0))
    assert np.all(multiple >= np.max(ordinary, axis=2) - 1e-9)


@few
@given(seeds)
def test_for_one_input_the_papers_ratio_is_h1(seed: int):
    found = spectra(made(seed, inputs=1)[0], Segments(1.0))
    np.testing.assert_allclose(spectral_ratio(found).values, h1(found).values, rtol=1e-9)


@few
@given(seeds)
def test_for_correlated_inputs_only_h1_is_a_transfer_function(seed: int):
    random = np.random.default_rng(seed)
    drive = random.standard_normal((64_000, 1)) * np.array([1.0, 1.0]) + 0.5 * random.standard_normal((64_000, 2))
    channels = [Channel("u0", "V", Role.INPUT), Channel("u1", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT)]
    found = spectra(in_memory(channels, RATE, np.hstack([drive, drive[:, :1]])), Segments(1.0))
    np.testing.assert_allclose(h1(found).values[5].ravel(), [1.0, 0.0], atol=1e-9)
    assert abs(spectral_ratio(found).values[5, 0, 1]) > 0.5


def test_noise_density_is_free_of_bias():
    """What six inputs explain of noise by chance is given back."""
    record, _ = made(7, inputs=6, outputs=4, seconds=600.0, noise=1.0)
    found = spectra(record, Segments(20.0))
    assert found.averages < 60
    assert np.mean(noise_density(found)) == pytest.approx(2.0 / RATE, rel=0.02)


def test_single_records_pooled_are_one_record():
    random = np.random.default_rng(0)
    channels = (Channel("u0", "V", Role.INPUT), Channel("u1", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT))
    parts = []
    for index, gain in enumerate((2.0, -3.0)):
        drive = random.standard_normal((6400, 1))
        parts.append(spectra(in_memory((channels[index], channels[2]), RATE, np.hstack([drive, gain * drive])), Segments(1.0)))
    together = pool(parts)
    assert [channel.name for channel in together.inputs] == ["u0", "u1"]
    np.testing.assert_allclose(h1(together).values[5].ravel(), [2.0, -3.0], atol=1e-9)


@dataclass(frozen=True)
class _Counted:
    """Samples made up as they are read, that refuse to be read in large pieces."""

    length: int

    def read(self, start: int, stop: int) -> np.ndarray:
        assert stop - start <= 1_100_000
        return np.random.default_rng(start).standard_normal((min(stop, self.length) - start, 2))


def test_a_long_record_is_read_in_pieces():
    long = Record((Channel("u", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT)), 20_000.0, _Counted(6_000_000))
    shares: list[float] = []
    with followed(lambda _, share: shares.append(share)):
        found = spectra(long, Segments(0.5, overlap=0.0))
    assert found.averages == 600
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_a_record_too_short_is_refused_with_both_numbers():
    with pytest.raises(DesignError, match=r"the record is shorter than a segment \(40 s and 60 s\)"):
        spectra(made(1)[0], Segments(60.0))


def test_a_constant_input_is_named():
    record, _ = made(1)
    values = record.values.copy()
    values[:, 1] = 3.0
    with pytest.raises(DesignError, match="u1: the input is constant"):
        h1(spectra(replace(record, samples=InMemory(values)), Segments(1.0)))


@pytest.mark.parametrize("size", [64, 65])
def test_lines_add_up_to_the_mean_square(size: int) -> None:
    """Parseval's theorem, the last line included: of an even number of samples it stands once, of an odd one twice."""
    values = np.random.default_rng(size).standard_normal((size, 1)) + 3.0 * (-1.0) ** np.arange(size)[:, None]
    one = in_memory([Channel("y", "um", Role.OUTPUT)], RATE, values)
    found = spectra(one, Segments(size / RATE, 0.0, Window.BOXCAR))
    assert np.sum(found.yy[:, 0, 0].real) * RATE / size == pytest.approx(np.var(values), rel=1e-12)
