"""Modes behind a delay and at uneven lines are the modes the records were made of; a delay is told as it is, or not at all."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from flexstage.experiment.identification.diagnosis.lateness import common_delay
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.identify import identify
from flexstage.experiment.records.record import Channel, InMemory, Record, Responses, Role
from flexstage.experiment.show.tables import identified_table
from tests.conftest import FULL
from tests.models.synthetic_records import Truth, record, truth

TRUTH = truth((118.0, 119.4, 231.0), outputs=3, inputs=3)
APART = truth((118.0, 166.0, 231.0), outputs=3, inputs=3)
LATE = 1.2e-3
STEPPED = np.concatenate([np.arange(80.0, 110.0), np.arange(110.0, 126.0, 0.1), np.arange(126.0, 225.0), np.arange(225.0, 320.0, 0.3)])
LINES = {"logarithmic": np.geomspace(80.0, 400.0, 700), "stepped": STEPPED}


def late(made: Record, samples: int) -> Record:
    """The record with outputs whole samples late."""
    count = len(made.inputs)
    values = np.hstack([made.values[samples:, :count], made.values[:-samples, count:]])
    return replace(made, samples=InMemory(values))


def responses(lines: np.ndarray, seconds: float, seed: int = 1, unit: str = "um", noise: float = 0.01, known: Truth = TRUTH) -> Responses:
    exact = known.response(lines) * np.exp(-2j * np.pi * lines * seconds)[:, None, None]
    exact = exact * (2j * np.pi * lines)[:, None, None] if unit.endswith("/s") else exact
    draw = np.random.default_rng(seed).standard_normal((2, *exact.shape))
    values = exact + noise * np.sqrt(0.5 * np.mean(np.abs(exact) ** 2)) * (draw[0] + 1j * draw[1])
    outputs, inputs = (
        tuple(Channel(f"{name}{each}", of, role) for each in range(3))
        for name, of, role in (("y", unit, Role.OUTPUT), ("u", "um", Role.INPUT))
    )
    return Responses(lines, outputs, inputs, values)


def scores(found: Identified) -> np.ndarray:
    """Errors of frequencies and damping over their stated deviations."""
    assert len(found.frequencies) == 3
    frequency = (found.frequencies - TRUTH.frequencies) / found.frequency_deviations
    return np.concatenate([frequency, (found.damping - TRUTH.damping) / found.damping_deviations])


@pytest.mark.parametrize(("lines", "seconds", "unit"), [("logarithmic", LATE, "um/s"), ("stepped", 0.0, "um"), ("stepped", LATE, "um")])
def test_modes_at_uneven_lines_are_those_of_the_truth(lines: str, seconds: float, unit: str) -> None:
    found = identify(responses(LINES[lines], seconds, unit=unit))
    assert np.sqrt(np.mean(scores(found) ** 2)) < 2.0  # 6 numbers: chi-square passes that once in 1500
    assert found.delay == pytest.approx(seconds, abs=3e-6)
    assert abs(found.delay - seconds) <= 4.0 * found.delay_deviation
    told = re.findall(r"are (\S+) ms late \(95 % interval: \+-(\S+) ms\)", " ".join(identified_table(found).notes))
    expected = [(1e3 * found.delay, 1.96e3 * found.delay_deviation)] if seconds else []
    assert [tuple(map(float, each)) for each in told] == [pytest.approx(each, rel=0.05) for each in expected]


@pytest.mark.full
def test_errors_at_uneven_lines_are_as_large_as_stated() -> None:
    found = np.array([scores(identify(responses(STEPPED, LATE, seed))) for seed in range(60)])
    assert 0.75 < np.sqrt(np.mean(found**2)) < 1.3


def test_a_record_with_a_delay_gives_the_modes_of_the_same_without() -> None:
    made = record(TRUTH, 1, seconds=60.0 if FULL else 20.0)
    plain, behind = identify(made), identify(late(made, 3))
    assert plain.delay == 0.0
    assert abs(behind.delay - 3.0 / made.rate) < 4.0 * behind.delay_deviation + 2e-6
    np.testing.assert_allclose(behind.frequencies, plain.frequencies, rtol=0.0, atol=np.min(plain.frequency_deviations))
    lines = np.linspace(80.0, 320.0, 400)
    exact = TRUTH.response(lines) * np.exp(-2j * np.pi * lines * 3.0 / made.rate)[:, None, None]
    away = behind.response(lines).values - exact
    assert np.sqrt(np.mean(np.abs(away) ** 2) / np.mean(np.abs(exact) ** 2)) < 0.02


def test_no_delay_is_told_of_travelling_waves() -> None:
    lines = np.linspace(80.0, 320.0, 400)
    twisted = replace(TRUTH, shapes=TRUTH.shapes * np.exp(2j * np.pi * np.random.default_rng(4).random(TRUTH.shapes.shape)))
    poles, residues = TRUTH.poles, TRUTH.participation * (2 * np.pi * TRUTH.frequencies[:, None]) ** 2
    values = np.zeros((len(lines), 3, 3), dtype=complex)
    for pole, shape, row in zip(poles, twisted.shapes.T, residues / (2j * np.imag(poles))[:, None], strict=True):
        for one, each in ((pole, np.outer(shape, row)), (np.conj(pole), np.conj(np.outer(shape, row)))):
            values += each / (2j * np.pi * lines - one)[:, None, None]
    found = identify(replace(responses(lines, 0.0), values=values))
    assert found.delay == 0.0
    assert common_delay(found) is None


@pytest.mark.parametrize(
    ("side", "number", "seconds"), [("outputs", 1, LATE), ("inputs", 2, LATE), ("outputs", 0, -LATE), ("outputs", 0, 0.0)]
)
def test_a_channel_that_comes_later_than_the_others_is_named(side: str, number: int, seconds: float) -> None:
    lines = np.linspace(80.0, 320.0, 600)
    made = responses(lines, 0.0, known=APART)
    turned = made.values.copy()
    chosen = turned[:, number] if side == "outputs" else turned[:, :, number]
    chosen *= np.exp(-2j * np.pi * lines * seconds)[:, None]
    found = identify(replace(made, values=turned))
    told = [each for each in found.data_warnings if "looks" in each]
    if not seconds:
        assert told == []
        return
    word, name = "late" if seconds > 0.0 else "early", ("y" if side == "outputs" else "u") + str(number)
    assert len(told) == 1
    assert told[0].startswith(f"{name} looks {word} by 1.2 ms")


def beam(frequencies: tuple[float, ...], order: int, seconds: float = 0.0, channel: int | slice = slice(None)) -> Responses:
    """Five points of a pinned beam, displacements or their derivatives; one of them, or all, late. The middle is a node of mode 2."""
    known, points = np.array(frequencies), np.linspace(0.1, 0.9, 5)
    shapes = np.sin(np.pi * np.outer(points, np.arange(1, len(known) + 1)))
    lines = np.arange(2.0, 1.5 * np.max(known), 0.5)
    exact = Truth(known, np.full(len(known), 0.005), shapes, shapes[1][:, None] / known[:, None] ** 2).response(lines)
    exact = exact * ((2j * np.pi * lines) ** order)[:, None, None]
    turn = np.exp(-2j * np.pi * lines * seconds)
    exact[:, channel] = (exact[:, channel].T * turn).T
    draw = np.random.default_rng(1).standard_normal((2, *exact.shape))
    outputs = tuple(Channel(f"y{each}", ("m", "m/s", "m/s^2")[order], Role.OUTPUT) for each in range(5))
    return Responses(lines, outputs, (Channel("u", "N", Role.INPUT),), exact * (1.0 + 1e-4 * (draw[0] + 1j * draw[1])))


@pytest.mark.parametrize(("frequencies", "order"), [((48.0, 144.0, 240.0), 0), ((48.0, 144.0, 240.0), 2), ((50.0, 110.0, 250.0), 2)])
def test_modes_in_whole_ratios_show_no_delay_where_there_is_none(frequencies: tuple[float, ...], order: int) -> None:
    """Half-turns of all modes in which a channel moves are changes of sign: they make no shape more real."""
    found = identify(beam(frequencies, order))
    assert len(found.frequencies) == len(frequencies)
    assert found.delay == 0.0
    assert not any("looks" in each for each in found.data_warnings)


@pytest.mark.parametrize(("channel", "seconds", "text"), [(2, 2e-3, "y2 looks late by 2 ms"), (4, -1.5e-3, "y4 looks early by 1.5 ms")])
def test_a_late_channel_is_named_where_modes_are_in_whole_ratios(channel: int, seconds: float, text: str) -> None:
    found = [each for each in identify(beam((48.0, 144.0, 240.0), 2, seconds, channel)).data_warnings if "looks" in each]
    assert len(found) == 1
    assert found[0].startswith(text)


def test_a_common_delay_of_accelerations_is_that_of_the_truth() -> None:
    found = identify(beam((48.0, 144.0, 240.0), 2, LATE))
    assert found.delay == pytest.approx(LATE, abs=3e-6)


def test_a_channel_that_hardly_moves_in_a_mode_is_not_called_late_by_it() -> None:
    """The phase of little is noise: a whole period of another mode would have explained it."""
    assert not any("looks" in each for each in identify(record(truth(seed=1006), 6, seconds=7.2)).data_warnings)


@pytest.mark.parametrize("noise", [2e-3, 2e-2])
def test_both_modes_of_a_pair_are_found_where_noise_goes_with_the_response(noise: float) -> None:
    known = truth((118.0, 118.0, 231.0), outputs=3, inputs=3)
    lines = np.geomspace(80.0, 400.0, 700)
    exact = known.response(lines)
    draw = np.random.default_rng(5).standard_normal((2, *exact.shape))
    found = identify(replace(responses(lines, 0.0), values=exact * (1.0 + noise * np.sqrt(0.5) * (draw[0] + 1j * draw[1]))))
    assert found.frequencies.round(0).tolist() == [118.0, 118.0, 231.0]
    residues = found.shapes[:, :2] @ found.participation[:2]
    directions = np.linalg.svd(known.shapes[:, :2] @ known.participation[:2])[1], np.linalg.svd(residues)[1]
    assert directions[1][1] / directions[1][0] == pytest.approx(directions[0][1] / directions[0][0], rel=10.0 * noise)
    spread = np.abs(found.frequencies - known.frequencies) / found.frequency_deviations
    assert np.max(spread[2:]) < 4.0
    assert np.sum(found.frequencies[:2]) == pytest.approx(236.0, abs=8.0 * np.max(found.frequency_deviations[:2]))
    np.testing.assert_array_equal(found.widening, 1.0)
