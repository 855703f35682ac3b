"""Records at the limits of what can be identified: without any noise, with channels that do not move, too short."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy

import flexstage as fs
from flexstage.analysis.complete import platform_modes
from flexstage.experiment import NoiseDrive, RigSetup, Sensing
from flexstage.experiment.identification.diagnosis.peaks import Peak
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.identify import Search, identify
from flexstage.experiment.records.record import Channel, InMemory, Record, Responses, Role, in_memory
from tests.conftest import FULL
from tests.models.synthetic_records import Truth, record, truth

SEEDS = 8 if FULL else 1
CELLS = 1e-6
BAND = Search(band=(80.0, 200.0))


def singles(seed: int, *, seconds: float = 20.0) -> list[Record]:
    """Six noiseless records, one actuator each."""
    made = [record(truth(seed=1000 + seed), 6 * seed + index, active=(index,), noise=0.0, seconds=seconds) for index in range(6)]
    return [each.select([f"u{index + 1}", *(channel.name for channel in each.outputs)]) for index, each in enumerate(made)]


def changed(whole: Record, change: Callable[[np.ndarray], None]) -> Record:
    values = whole.values.copy()
    change(values)
    return replace(whole, samples=InMemory(values))


def still(values: np.ndarray) -> None:
    values[:, 9] = 2.5


def rounding(values: np.ndarray) -> None:
    values[:, 9] = 2.5 + 1e-15 * np.random.default_rng(0).standard_normal(len(values))


def weaker(known: Truth) -> np.ndarray:
    """How many times weaker (k) modes answer the first input than the strongest does."""
    size = np.linalg.norm(known.shapes, axis=0) * np.abs(known.participation[:, 0]) * known.frequencies**2
    return np.max(size) / size


def assert_as_good_as_cells(
    found: Identified, frequencies: np.ndarray, damping: np.ndarray | None = None, weaker: np.ndarray | float = 1.0
) -> None:
    """Modes are right to what cells of lines can say, and deviations know it.

    Cells hold every number to 1e-6. Stated deviations count that as noise whose power over all lines is that of the error at each of them,
    so that an error of that size, in the pattern that shifts one part of a pole the most, shifts it by sqrt(2 outputs) deviations at most:
    by sqrt(outputs) times the deviation of a complex number, sqrt(2) of that of its parts. No mode is worse than the numbers themselves,
    but by as much as it is `weaker` than the strongest.
    """
    assert found.frequencies.shape == frequencies.shape
    worst = np.sqrt(2.0 * len(found.outputs))
    assert np.all(np.abs(found.frequencies - frequencies) < worst * found.frequency_deviations)
    assert np.all(worst * found.frequency_deviations < CELLS * weaker * frequencies)
    if damping is not None:
        assert np.all(np.abs(found.damping - damping) < worst * found.damping_deviations)
        assert np.all(worst * found.damping_deviations < CELLS * weaker)


@pytest.mark.parametrize("seed", range(SEEDS))
def test_without_noise_the_modes_are_as_good_as_cells_and_none_is_added(seed: int) -> None:
    known = truth(seed=1000 + seed)
    parts = singles(seed)
    assert_as_good_as_cells(identify(parts), known.frequencies, known.damping)
    assert_as_good_as_cells(identify(parts[0]), known.frequencies, known.damping, weaker(known))


@pytest.mark.parametrize(
    ("change", "noise"),
    [(still, 0.1), (rounding, 0.0), *(pytest.param(*each, marks=pytest.mark.full) for each in ((still, 0.0), (rounding, 0.1)))],
)
def test_a_gauge_that_does_not_move_says_nothing_and_spoils_nothing(change: Callable[[np.ndarray], None], noise: float) -> None:
    known, made = truth(), record(truth(), 1, seconds=20.0, noise=noise)
    found, rest = identify(changed(made, change)), identify(made.select([name for name in made.names if name != "y4"]))
    np.testing.assert_allclose(found.frequencies, rest.frequencies, rtol=1e-5)
    if noise:
        assert np.max(np.abs(found.frequencies / known.frequencies - 1.0)) < 5e-5
    else:
        assert_as_good_as_cells(found, known.frequencies, known.damping)
    assert np.max(np.abs(found.shapes[3])) < 1e-9


def test_nothing_that_moves_shows_no_mode() -> None:
    def stop(values: np.ndarray) -> None:
        values[:, 6:] = 2.5

    found = identify(changed(record(truth(), 1, seconds=20.0), stop))
    assert len(found.frequencies) == 0
    assert "no mode exceeds the noise" in found.data_warnings[0]


@pytest.mark.parametrize("resolution", [None, 0.0])
@pytest.mark.parametrize("seed", range(SEEDS))
def test_one_actuator_of_a_stage_with_a_gauge_it_does_not_move(resolution: float | None, seed: int) -> None:
    """By the mapped model B1 does not move S4 at all: it reads 0 under the gauge's steps, and rounding without them."""
    mechanism = fs.case("double-triangle")
    model = fs.mapped(mechanism)
    setup = RigSetup(
        seconds=20.0, seed=6 * seed, drive=NoiseDrive(stroke=0.5e-6, actuators=("B1",)), sensing=Sensing(resolution=resolution)
    )
    found = identify(fs.experiment.rig(mechanism, model, setup), BAND)
    expected = platform_modes(mechanism, model).platform_frequencies
    if resolution == 0.0:
        assert_as_good_as_cells(found, expected[[0, 3, 4]])
    else:
        np.testing.assert_allclose(found.frequencies, expected[[0, 3, 4]], rtol=1e-5)


def test_modes_beyond_the_band_do_not_come_back_into_it() -> None:
    """Without noise the tails of the units' own modes from 215 Hz on are seen, and are no mode below 200 Hz."""
    mechanism = fs.case("double-triangle")
    model = fs.lumped(mechanism)
    for seed in range(SEEDS):
        sets = [
            RigSetup(seconds=20.0, seed=6 * seed + index, drive=drive, sensing=Sensing(resolution=0.0))
            for index, drive in enumerate(NoiseDrive(stroke=0.5e-6, actuators=(f"B{index + 1}",)) for index in range(6))
        ]
        found = identify([fs.experiment.rig(mechanism, model, each) for each in sets], BAND)
        assert_as_good_as_cells(found, platform_modes(mechanism, model).platform_frequencies)


@pytest.mark.parametrize("inputs", [1, 6])
def test_exact_responses_give_exact_modes(inputs: int) -> None:
    known, lines = truth(), np.arange(60.0, 350.0, 0.25)
    values = known.response(lines)[:, :, :inputs]
    values[:, 3] = 0.0
    channels = [tuple(Channel(f"{kind}{index}", "V") for index in range(count)) for kind, count in (("y", 6), ("u", inputs))]
    found = identify(Responses(lines, channels[0], channels[1], values))
    assert_as_good_as_cells(found, known.frequencies, known.damping, weaker(known) if inputs == 1 else 1.0)


@pytest.mark.parametrize("seconds", [0.5, 2.0, *(pytest.param(each, marks=pytest.mark.full) for each in (1.0, 3.0))])
def test_short_records_miss_modes_and_say_so(seconds: float) -> None:
    for seed in range(SEEDS):
        found = identify(record(truth(seed=1000 + seed), seed, seconds=seconds))
        if len(found.frequencies) < 6:
            assert any("may be missing" in each or "Too few frequency lines" in each for each in found.data_warnings)
            assert any(f"{seconds:g} s" in each for each in found.data_warnings)


@pytest.mark.parametrize("seed", range(SEEDS))
def test_records_as_long_as_advised_show_all_modes(seed: int) -> None:
    known, seconds = truth(seed=1000 + seed), 2.0
    found = identify(record(known, seed, seconds=seconds))
    while found.data_warnings:
        advised = re.search(r"Record for at least ([\d.]+) s \(got [\d.]+ s\)", found.data_warnings[0])
        assert advised is not None
        assert seconds < float(advised[1]) < 20.0
        seconds = float(advised[1])
        found = identify(record(known, seed, seconds=seconds))
    np.testing.assert_allclose(found.frequencies, known.frequencies, rtol=1e-3)


def test_a_band_that_cannot_be_searched_is_told() -> None:
    made = record(truth(), 0, seconds=4.0)
    low, high = (
        next(each for each in identify(made, Search(band=band)).data_warnings if "are requested" in each)
        for band in ((20, 300), (130, 1e3))
    )
    assert re.search(r"from 20 to 300 Hz are requested; the search covers only 1\d\d.* to 300 Hz. Record longer", low)
    assert "the search covers only 130 to 860.2 Hz. Record faster" in high


def test_what_noise_hides_is_told_in_numbers() -> None:
    values = record(truth(), 0, seconds=20.0)
    alone = changed(
        values, lambda each: each.__setitem__((slice(None), slice(6, 12)), np.random.default_rng(3).standard_normal((len(each), 6)))
    )
    assert "narrower than the line spacing of 1.2 Hz" in identify(alone).data_warnings[0]
    assert "although inputs explain" not in identify(alone).data_warnings[0]
    assert "no mode can be identified, although inputs explain 39.5%" in identify(record(truth(), 0, seconds=1.0)).data_warnings[0]


def test_a_mode_narrower_than_the_line_spacing_is_a_mode() -> None:
    """The inputs excite it, which distinguishes it from a tone; only outputs alone require a width above the line spacing."""
    random, rate, size = np.random.default_rng(0), 64.0, 4096
    pole = np.exp(2.0 * np.pi * 10.0 * (-5e-4 + 1j) / rate)
    drive = random.standard_normal(9 * size)
    moved = scipy.signal.lfilter([0.0, pole.imag], [1.0, -2.0 * pole.real, abs(pole) ** 2], drive)[-size:]
    values = np.stack([drive[-size:], moved + 0.02 * np.std(moved) * random.standard_normal(size)], axis=1)
    found = identify(in_memory([Channel("u", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT)], rate, values))
    assert len(found.frequencies) == 1
    assert 2.0 * found.damping[0] * found.frequencies[0] < 0.8 * rate / size
    (note,) = Peak.TABLE.notes
    assert "under floor excitation, a width" in note


@pytest.mark.parametrize("steps", [np.round, np.floor])
@pytest.mark.parametrize("levels", [2.0, 5.0, 20.0])
def test_steps_are_noise_however_they_are_counted(steps: Callable[[np.ndarray], np.ndarray], levels: float) -> None:
    """Down to half the signal's rms, rounded or cut off: an offset of half a step is taken out with the mean."""
    for seed in range(SEEDS):
        known = truth(seed=1000 + seed)

        def count(values: np.ndarray) -> None:
            step = np.std(values[:, 6:], axis=0) / levels
            values[:, 6:] = steps(values[:, 6:] / step) * step

        found = identify(changed(record(known, seed, seconds=30.0, noise=0.0), count))
        np.testing.assert_allclose(found.frequencies, known.frequencies, rtol=5e-4)
