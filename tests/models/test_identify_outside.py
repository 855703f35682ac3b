"""What shakes a stage or its gauges from outside: tones, forces that are not recorded. None of it is a mode, and none hides one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.experiment.example import one_mode_record
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.diagnosis.peaks import PeakCause
from flexstage.experiment.identification.diagnosis.peaks import peaks as find_peaks
from flexstage.experiment.identification.evidence import evidence
from flexstage.experiment.identification.group import RejectedResonance
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.identify import identify
from flexstage.experiment.identification.outputs.tones import remove_tones
from flexstage.experiment.records.record import InMemory, Record
from flexstage.show.table import result_table
from tests.conftest import FULL
from tests.models.synthetic_records import Truth, record, truth

SEEDS = 20 if FULL else 1
LEVELS = (1.0, 3.0, 10.0)


def shaken(made: Record, frequency: float, level: float, gauges: tuple[int, ...], phase: float = 1.0) -> Record:
    """The record with a tone in some gauges, whose rms is `level` times their own."""
    values, time = made.values.copy(), np.arange(made.length) / made.rate
    for gauge in gauges:
        values[:, 6 + gauge] += level * np.sqrt(2.0) * np.std(values[:, 6 + gauge]) * np.sin(2.0 * np.pi * frequency * time + phase)
    return replace(made, samples=InMemory(values))


def places(seed: int) -> tuple[float, ...]:
    """Far from all modes, beside one, on one, below and above all."""
    random = np.random.default_rng(77_000 + seed)
    near = random.choice([118.0, 166.0, 231.0, 291.0]) * random.uniform(0.996, 1.004)
    beside = random.choice([166.0, 291.0]) + random.uniform(2.0, 6.0)
    return (
        random.uniform(135.0, 150.0),
        random.uniform(180.0, 215.0),
        near,
        beside,
        random.uniform(20.0, 90.0),
        random.uniform(330.0, 800.0),
    )


def undriven(known: Truth, seed: int, level: float = 1.0) -> Record:
    """Actuator `seed` modulo 6 shakes as strongly as the others, or `level` times, and is not recorded."""
    hidden = seed % 6
    made = record(known, seed, seconds=30.0, active=tuple(index for index in range(6) if index != hidden))
    values = made.values.copy()
    values[:, 6:] += level * record(known, 20_000 + seed, seconds=30.0, noise=0.0, active=(hidden,)).values[:, 6:]
    return replace(made, samples=InMemory(values)).select([name for name in made.names if name != f"u{hidden + 1}"])


def peaks(found: Identified, doubt: PeakCause) -> list[float]:
    return [peak.frequency for peak in found.peaks if peak.doubt is doubt]


@pytest.mark.parametrize("place", range(6) if FULL else (0, 3))
def test_a_tone_is_taken_out_wherever_it_is_and_no_mode_is_lost(place: int) -> None:
    for seed in range(100, 100 + SEEDS):
        known, level = truth(seed=1000 + seed), LEVELS[(seed + place) % 3]
        frequency, gauges = places(seed)[place], tuple(range(6)) if seed % 3 == 0 else (seed % 6,)
        found = identify(shaken(record(known, seed, seconds=30.0), frequency, level, gauges, phase=float(seed)))
        np.testing.assert_allclose(found.frequencies, known.frequencies, rtol=1e-3)
        np.testing.assert_allclose(peaks(found, PeakCause.TONE), [frequency], atol=1e-3)


@pytest.mark.parametrize("seed", [9, *range(SEEDS - 1)])
def test_the_mains_and_a_pump(seed: int) -> None:
    """At all gauges and at one; that of seed 9 once passed for a mode."""
    known, made = truth(seed=1000 + seed), record(truth(seed=1000 + seed), seed, seconds=30.0)
    found = identify(shaken(shaken(made, 50.0, 0.3 / 2.0**0.5, tuple(range(6))), 150.02, 3.0 / 2.0**0.5, (2,), phase=0.0))
    np.testing.assert_allclose(found.frequencies, known.frequencies, rtol=2e-4)
    assert [peak.outputs for peak in found.peaks if peak.doubt is PeakCause.TONE] == [("y1", "y2", "y3", "y4", "y5", "y6"), ("y3",)]
    assert "the mains?" in found.peaks[0].reason


@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_what_is_left_of_a_tone_is_less_than_the_noise(noise: float) -> None:
    made = record(truth(), 3, seconds=30.0, noise=noise)
    quiet, tones = remove_tones(shaken(made, 150.02, 10.0, (2,)))
    assert {round(tone.frequency, 4) for tone in tones} == {150.02}
    assert np.std((quiet.values - made.values)[:, 8]) < (1e-5 if noise == 0.0 else 0.01 * noise) * np.std(made.values[:, 8])


@pytest.mark.parametrize("offset", [-1.8, -1.2, 0.5])
def test_a_tone_near_the_end_of_a_stretch_of_lines_is_taken_out(offset: float) -> None:
    """Levels are medians of 64 lines each: a tone within two lines of the last one raises the level of one side alone."""
    made = record(truth(seed=1107), 107, seconds=30.0)
    frequency = (78 * 64 + offset) * made.rate / made.length
    [tone] = remove_tones(shaken(made, frequency, 3.0, (5,)))[1]
    np.testing.assert_allclose(tone.frequency, frequency, atol=1e-3)


def test_a_record_without_tones_stays_as_it_is() -> None:
    for seed in range(2 * SEEDS):
        assert remove_tones(record(truth(seed=1000 + seed), seed, seconds=30.0))[1] == ()


def test_a_stage_driven_by_tones_keeps_them() -> None:
    """An input of sinusoids, repeated: what they do to the outputs is no tone from outside."""
    made, random = record(truth(), 4, seconds=30.0), np.random.default_rng(4)
    lines = np.fft.rfft(made.values, axis=0)
    lines[random.random(len(lines)) > 0.05] = 0.0
    tuned = replace(made, samples=InMemory(np.fft.irfft(lines, made.length, axis=0)))
    assert remove_tones(tuned)[1] == ()


def test_an_oscillation_that_fades_stays() -> None:
    made, time = record(truth(), 5, seconds=30.0), np.arange(30 * 2048) / 2048.0
    values = made.values.copy()
    values[:, 8] += 5.0 * np.std(values[:, 8]) * np.exp(-0.01 * time) * np.sin(2.0 * np.pi * 150.02 * time)
    quiet, tones = remove_tones(replace(made, samples=InMemory(values)))
    assert [(round(tone.frequency, 2), round(tone.fades, 1)) for tone in tones] == [(150.02, 0.3)]
    np.testing.assert_array_equal(quiet.values, values)


@pytest.mark.parametrize("seed", [1, 3, 7, 34, 57, 110, 111, *range(20, 20 + SEEDS // 2)] if FULL else [34])
def test_a_drive_that_is_not_recorded_gives_no_mode_and_hides_none(seed: int) -> None:
    """All six are found and nothing else is hinted at; of seeds 34 and 111 one was 0.5 % off, of seed 57 one was missed once."""
    known = truth(seed=1000 + seed)
    found = identify(undriven(known, seed))
    assert len(found.frequencies) == 6
    np.testing.assert_allclose(found.frequencies, known.frequencies, rtol=4e-3)
    assert np.all(np.abs(found.frequencies - known.frequencies) < 5.0 * found.frequency_deviations)
    assert not [peak for peak in found.peaks if peak.doubt in (PeakCause.UNDRIVEN, PeakCause.WEAK)]
    assert not found.delay
    assert not [each for each in found.data_warnings if "looks" in each]


@pytest.mark.full
def test_intervals_hold_the_truth_where_a_drive_is_not_recorded() -> None:
    scores: list[np.ndarray] = []
    for seed in range(300, 330):
        known = truth(seed=1000 + seed)
        found = identify(undriven(known, seed))
        mode = np.argmin(np.abs(found.frequencies[:, None] / known.frequencies - 1.0), axis=1)
        frequency = (found.frequencies - known.frequencies[mode]) / found.frequency_deviations
        scores.append(np.stack([frequency, (found.damping - known.damping[mode]) / found.damping_deviations]))
    assert np.mean(np.abs(np.concatenate(scores, axis=1)) < NORMAL_95) > 0.88


def test_the_probability_of_a_resonance_that_is_not_driven_is_that_of_its_correlation_with_inputs() -> None:
    """The resonance itself is certain; only that the inputs drive it is not, and the note says so."""
    nothing = np.zeros(0)
    silent = RejectedResonance(-0.1 + 20.0j, np.ones(1), 0.4)
    (found,) = find_peaks(evidence(one_mode_record(), None), nothing, nothing, nothing, refused=(silent,), lost=())
    assert (found.doubt, found.chance) == (PeakCause.UNDRIVEN, 0.4)
    table = result_table((found,))
    assert table is not None
    assert "Not driven: probability that inputs explain as much motion by chance" in table.notes[0]


@pytest.mark.full
def test_a_mode_that_is_hardly_driven_by_inputs_is_listed() -> None:
    """The actuator that is not recorded drives the mode at 166 Hz four times as strongly as all others together."""
    found = identify(undriven(truth(seed=1165), 165, 1.5))
    assert [round(frequency) for frequency in peaks(found, PeakCause.UNDRIVEN)] == [166]


@pytest.mark.full
def test_forces_that_are_not_recorded_are_told_where_they_exceed_the_recorded_ones() -> None:
    known = truth(seed=1002)
    strong, weak = (identify(undriven(known, 2, level)) for level in (4.0, 0.5))
    assert any("less than half of the motion" in each for each in strong.data_warnings)
    assert not any("less than half of the motion" in each for each in weak.data_warnings)
