"""Modes from outputs alone are those of the truth, within their intervals: of a floor that shakes all along, and of free decays."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.diagnosis.peaks import PeakCause
from flexstage.experiment.identification.excitation import Excitation
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.identify import Search
from flexstage.experiment.pipeline import identification, usable_measurement
from flexstage.experiment.records.health import RecordRequirements
from flexstage.experiment.records.record import Channel, InMemory, Record, Role
from flexstage.models.linear.frequency import superpose
from flexstage.models.linear.port import ports
from flexstage.models.lumped import lumped
from tests.conftest import FULL
from tests.models.synthetic_records import Truth, binomial_limits, truth

PAIR = truth((118.0, 118.0, 231.0), outputs=3, inputs=3)
FLOOR, DECAY = Search(band=(90.0, 300.0), excitation=Excitation.FLOOR), Search(excitation=Excitation.DECAY)


def outputs(values: np.ndarray, rate: float) -> Record:
    return Record(tuple(Channel(f"S{each + 1}", "um", Role.OUTPUT) for each in range(values.shape[1])), rate, InMemory(values))


def shaken(response: np.ndarray, density: np.ndarray, rate: float, seed: int, noise: float) -> Record:
    """Outputs of inputs of that density [unit/Hz^0.5] at each line, independent of one another, and white noise of density `noise`."""
    random = np.random.default_rng(seed)
    size = 2 * (len(response) - 1)
    drive = random.standard_normal((2, len(response), response.shape[2]))
    lines = np.einsum("fpm,fm->fp", response, (drive[0] + 1j * drive[1]) * density[:, None]) * np.sqrt(0.25 * rate * size)
    return outputs(
        np.fft.irfft(lines, size, axis=0) + noise * np.sqrt(0.5 * rate) * random.standard_normal((size, response.shape[1])), rate
    )


def floor_record(known: Truth, seconds: float, seed: int) -> Record:
    rate = 1024.0
    lines = np.fft.rfftfreq(int(seconds * rate), 1.0 / rate)
    return shaken(known.response(lines), 1.0 / np.maximum(lines, 1.0) ** 1.5, rate, seed, 1e-3)


def errors(found: Identified, known: Truth) -> np.ndarray:
    """Errors of frequencies and damping over their standard deviations; modes within a tenth of a hertz are taken by damping."""
    own = np.lexsort((found.damping, found.frequencies.round(0)))
    true = np.lexsort((known.damping, known.frequencies))
    frequency = (found.frequencies[own] - known.frequencies[true]) / found.frequency_deviations[own]
    return np.concatenate([frequency, (found.damping[own] - known.damping[true]) / found.damping_deviations[own]])


def test_modes_of_a_shaken_floor_are_those_of_the_truth_a_pair_too() -> None:
    found = identification((floor_record(PAIR, 400.0, 1),), FLOOR).found
    assert found.frequencies.round(0).tolist() == [118.0, 118.0, 231.0]
    assert np.max(np.abs(errors(found, PAIR))) < 4.0
    np.testing.assert_allclose(found.frequencies, PAIR.frequencies, rtol=3e-3)
    assert found.close_modes == ((1, 2),)
    away = found.shapes[:, 2] - PAIR.shapes[:, 2] / PAIR.shapes[np.argmax(np.abs(PAIR.shapes[:, 2])), 2]
    assert np.all(np.abs(away) <= 5.0 * found.shape_deviations[:, 2] + 1e-12)
    assert found.inputs == ()
    assert found.participation.shape == (3, 0)
    assert any("mass-normalised shapes are unknown" in each for each in found.data_warnings)


def test_noise_alone_has_no_mode() -> None:
    noise = np.random.default_rng(3).standard_normal((120 * 1024, 3))
    found = identification((outputs(noise, 1024.0),), FLOOR).found
    assert not len(found.frequencies)


def free(known: Truth, column: int, noise: float = 0.3) -> Record:
    rate, silent = 2048.0, 300
    time = np.arange(int(3.0 * rate)) / rate
    decays = np.imag(np.exp(known.poles * time[:, None])) * 2.0 * np.pi * known.frequencies * known.participation[:, column]
    values = np.vstack([np.zeros((silent, len(known.shapes))), decays @ known.shapes.T])
    return outputs(values + noise * np.random.default_rng(column).standard_normal(values.shape), rate)


def test_a_mode_that_the_floor_hardly_drives_is_as_sure_as_a_strong_one() -> None:
    """Its peak is no higher than the strong one's tail, which lies in another direction."""
    known = truth((118.0, 131.0), inputs=2)
    weak = replace(known, participation=known.participation * np.array([[1.0], [0.15]]))
    found = identification((floor_record(weak, 400.0, 1),), FLOOR).found
    assert found.frequencies.round(0).tolist() == [118.0, 131.0]
    assert np.max(np.abs(errors(found, weak))) < 4.0
    assert np.all(found.frequency_deviations < 0.2)


def test_two_free_decays_tell_both_modes_of_a_pair_and_one_says_that_there_may_be_more() -> None:
    both = identification((free(PAIR, 0), free(PAIR, 1)), DECAY).found
    assert both.frequencies.round(0).tolist() == [118.0, 118.0, 231.0]
    assert np.max(np.abs(errors(both, PAIR))) < 4.5
    np.testing.assert_allclose(both.frequencies, PAIR.frequencies, rtol=1e-4)
    assert any("outputs are largest: at 0.1" in each for each in both.data_warnings)
    one = identification((free(truth((118.0, 166.0, 231.0), outputs=3, inputs=3), 0),), DECAY).found
    assert one.frequencies.round(0).tolist() == [118.0, 166.0, 231.0]
    assert any("only decay 1 was driven" in each for each in one.data_warnings)


def test_what_moved_the_stage_is_never_guessed() -> None:
    made = floor_record(PAIR, 20.0, 1)
    with pytest.raises(DesignError, match="or specify the excitation"):
        usable_measurement([made])
    driven = Record((Channel("u", "um", Role.INPUT), *made.channels[1:]), made.rate, made.samples)
    with pytest.raises(DesignError, match="the excitation is unrecorded, but the record has inputs: u"):
        usable_measurement([driven], requirements=RecordRequirements(unrecorded=True))
    with pytest.raises(DesignError, match=r"wrong number of records \(got 2, expected 1\)"):
        identification((made, made), FLOOR)
    with pytest.raises(DesignError, match=r"too short \(got 10240 samples, expected 40 blocks of 400\)"):
        identification((floor_record(PAIR, 10.0, 1),), FLOOR)


def test_short_records_are_searched_where_their_lines_suffice() -> None:
    made = floor_record(PAIR, 20.0, 1)
    low, _ = identification((made,), Search(excitation=Excitation.FLOOR)).found.band
    assert 120.0 < low < 240.0  # 56 lines of 2 Hz in 0.72 of it, to the next of bands of 1.4
    with pytest.raises(DesignError, match="between 118 and 119 Hz have too few lines: a block lasts only a fortieth of 20 s"):
        identification((made,), Search(band=(118.0, 119.0), excitation=Excitation.FLOOR))


THREE = truth((14.3, 36.0, 52.0), outputs=3, inputs=3)


def white_floor(known: Truth, seconds: float, seed: int, *, noise: float, rate: float = 128.0) -> Record:
    """Outputs of a white floor, with white noise of that density [unit/Hz^0.5]."""
    lines = np.fft.rfftfreq(int(seconds * rate), 1.0 / rate)
    return shaken(known.response(lines), np.ones(len(lines)), rate, seed, noise)


def with_tone(made: Record, frequency: float, level: float, wander: float = 0.0) -> Record:
    """A sinusoid in all outputs, its rms `level` times theirs, whose phase wanders: a line `wander` Hz wide."""
    steps = np.random.default_rng(1).standard_normal(made.length) * np.sqrt(2.0 * np.pi * wander / made.rate)
    phase = 2.0 * np.pi * frequency * np.arange(made.length) / made.rate + np.cumsum(steps)
    return replace(made, samples=InMemory(made.values + level * np.sqrt(2.0) * np.std(made.values, axis=0) * np.sin(phase)[:, None]))


def test_modes_are_the_same_whatever_band_is_searched() -> None:
    made = white_floor(THREE, 600.0, 2, noise=1.0)
    bands = ((13.5, 15.2), (10.0, 20.0), (14.0, 53.8), (6.0, 53.8))
    found = [identification((made,), Search(band=band, excitation=Excitation.FLOOR)).found for band in bands]
    assert [len(each.frequencies) for each in found] == [1, 1, 3, 3]
    assert {each.frequencies[0] for each in found} == {found[-1].frequencies[0]}
    assert np.max(np.abs(errors(found[-1], THREE))) < 4.0
    assert np.all(found[-1].damping_deviations < 0.15 * THREE.damping)


def test_modes_ten_decibels_above_the_noise_are_found_in_half_an_hour() -> None:
    """No more than one mode in fifty is not found, as on the shipped stage; that one is listed as unsure, and nothing else is a mode."""
    peaks = np.sum(np.abs(THREE.response(THREE.frequencies)) ** 2, axis=2)  # (mode, output)
    missed, seeds = 0, 20 if FULL else 1
    for seed in range(seeds):
        made = white_floor(THREE, 1800.0, seed, noise=np.sqrt(0.1 * np.min(np.max(peaks, axis=1))))
        found = identification((made,), Search(excitation=Excitation.FLOOR)).found
        told = np.isin(THREE.frequencies.round(0), found.frequencies.round(0))
        assert found.frequencies.round(0).tolist() == THREE.frequencies[told].round(0).tolist()
        assert np.max(np.abs(errors(found, replace(THREE, frequencies=THREE.frequencies[told], damping=THREE.damping[told])))) < 4.0
        unsure = [peak.frequency for peak in found.peaks if peak.doubt is PeakCause.UNSURE]
        assert np.isin(THREE.frequencies[~told].round(0), np.round(unsure)).all()
        missed += int(np.sum(~told))
    assert missed <= 0.02 * seeds * len(THREE.frequencies)


@pytest.mark.parametrize(
    ("frequency", "level", "wander", "doubt"),
    [(34.4, 0.7, 0.0, PeakCause.TONE), (36.1, 2.0, 0.0, PeakCause.TONE), (34.4, 0.7, 0.005, PeakCause.NARROW)],
)
def test_a_tone_beside_a_mode_is_none(frequency: float, level: float, wander: float, doubt: PeakCause) -> None:
    """A steady one is taken out; one that wanders is narrower than the record resolves."""
    made = with_tone(white_floor(THREE, 900.0, 4, noise=1.0), frequency, level, wander)
    found = identification((made,), Search(excitation=Excitation.FLOOR)).found
    assert found.frequencies.round(0).tolist() == [14.0, 36.0, 52.0]
    np.testing.assert_allclose(found.frequencies, THREE.frequencies, rtol=4e-3)
    assert [
        (round(peak.frequency, 1), peak.doubt, peak.width) for peak in found.peaks if peak.doubt in (PeakCause.TONE, PeakCause.NARROW)
    ] == [(frequency, doubt, None)]


def test_no_peak_is_called_noise_that_is_only_unsure() -> None:
    found = identification((white_floor(THREE, 150.0, 1, noise=30.0),), Search(excitation=Excitation.FLOOR)).found
    assert {peak.doubt for peak in found.peaks} <= {PeakCause.UNSURE}


def test_intervals_from_outputs_alone_hold_as_often_as_they_state() -> None:
    """Frequency, damping and shape: one standard deviation holds 68 % of the time, neither more often nor less."""
    known, seeds = truth((26.0, 33.0), outputs=2, inputs=2), 30 if FULL else 20
    scores: list[np.ndarray] = []
    for seed in range(seeds):
        found = identification((white_floor(known, 400.0, seed, noise=1.0),), Search(band=(22.0, 40.0), excitation=Excitation.FLOOR)).found
        mode = [int(np.argmin(np.abs(known.frequencies - each))) for each in found.frequencies]
        every, largest = np.arange(len(mode)), np.argmax(np.abs(found.shapes), axis=0)
        shape = (known.shapes[:, mode] / known.shapes[largest, mode] - np.real(found.shapes)) / np.where(
            found.shapes == 1.0, 1.0, found.shape_deviations
        )
        frequency = (found.frequencies - known.frequencies[mode]) / found.frequency_deviations
        damping = (found.damping - known.damping[mode]) / found.damping_deviations
        scores.extend(np.stack([frequency, damping, shape[1 - largest, every]], axis=1))
    held, (least, most) = np.sum(np.abs(scores) < 1.0, axis=0), binomial_limits(len(scores))
    assert len(scores) >= 0.9 * 2 * seeds
    assert np.all((held >= least) & (held <= most)), held


@cache
def floor_response() -> tuple[np.ndarray, np.ndarray]:
    """Gauges of the shipped stage by its floor in x, y and z [um/m], and VC-D's displacement, its velocity held beyond 80 Hz [m/Hz^0.5]."""
    model = lumped(double_triangle())
    gauges = [each.name for each in model.outputs if "." not in each.name]
    lines = np.fft.rfftfreq(1800 * 512, 1.0 / 512.0)
    assert model.damping is not None
    response = np.zeros((len(lines), len(gauges), 3), dtype=complex)
    wanted = ports(model, gauges, ["ground.x", "ground.y", "ground.z"])
    for some in np.array_split(np.flatnonzero(lines > 40.0), 100):
        response[some] = 1e6 * superpose(model, wanted, lines[some], model.damping)
    velocity = 6.25e-6 / np.sqrt(np.log(2.0) / 3.0 * np.maximum(lines, 1.0))
    return response, velocity / (2.0 * np.pi * np.maximum(lines, 1.0))


def test_a_pole_that_only_one_division_into_bands_contains_is_no_mode() -> None:
    """Tails of the modes at 126 and 173 Hz give it a width of 11 % between them, certain to thirteen deviations."""
    response, density = floor_response()
    found = identification((shaken(response, density, 512.0, 9, 5e-4),), Search(band=(85.0, 210.0), excitation=Excitation.FLOOR)).found
    assert found.frequencies.round(0).tolist() == [106.0, 106.0, 126.0, 144.0, 173.0, 173.0]
    assert [round(peak.frequency) for peak in found.peaks if peak.doubt is PeakCause.UNSURE] == [142]


def test_a_mode_damped_by_eight_per_cent_is_found() -> None:
    known = replace(THREE, damping=np.array([0.02, 0.08, 0.015]))
    found = identification((white_floor(known, 1800.0, 1, noise=1.0),), Search(excitation=Excitation.FLOOR)).found
    assert found.frequencies.round(0).tolist() == [14.0, 36.0, 52.0]
    assert np.max(np.abs(errors(found, known))) < 4.0


@pytest.mark.full
def test_half_an_hour_of_vc_d_tells_modes_and_how_sure_they_are() -> None:
    response, density = floor_response()
    known, count = np.array([106.0126, 126.1554, 144.2323, 173.0859]), np.array([2, 1, 1, 2])
    parts, scores, missed, seeds = [], [], 0, 200
    for seed in range(seeds):
        search = Search(band=(85.0, 210.0), excitation=Excitation.FLOOR)
        found = identification((shaken(response, density, 512.0, seed, 5e-4),), search).found
        nearest = known[np.argmin(np.abs(found.frequencies[:, None] / known - 1.0), axis=1)]
        np.testing.assert_allclose(found.frequencies, nearest, rtol=0.01)
        missed += int(np.sum(np.maximum(count - np.sum(nearest[:, None] == known, axis=0), 0)))
        away = np.stack([found.frequencies / nearest - 1.0, found.damping / 0.01 - 1.0], axis=1)
        parts.append(away)
        scores.append(away / np.stack([found.frequency_deviations / nearest, found.damping_deviations / 0.01], axis=1))
    held = np.mean(np.abs(np.concatenate(scores)) < NORMAL_95, axis=0)
    assert np.all(held > 0.90)
    assert np.all(held < 0.98)
    assert missed <= 0.02 * seeds * np.sum(count)
    assert np.all(NORMAL_95 * np.sqrt(np.mean(np.square(np.concatenate(parts)), axis=0)) < [1e-3, 0.1])
