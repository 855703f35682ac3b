"""Faults of records: each kind planted alone is found alone, named with its numbers, and cured only when allowed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.experiment.identification.identify import identify
from flexstage.experiment.pipeline import usable_measurement as sound_records
from flexstage.experiment.records.health import RecordRequirements, examine, responses_findings, usable_record
from flexstage.experiment.records.numbers import Numbers
from flexstage.experiment.records.options import FaultTolerance
from flexstage.experiment.records.record import Channel, Record, Responses, Role, in_memory
from tests.conftest import FULL

RATE, LENGTH = 2048.0, 8192
CHANNELS = (
    *(Channel(f"u{number}", "V", Role.INPUT) for number in (1, 2, 3)),
    *(Channel(f"S{number}", "um", Role.OUTPUT) for number in (1, 2, 3)),
)
STAGE = RecordRequirements(
    inputs=tuple((f"u{number}", "V") for number in (1, 2, 3)), outputs=tuple((f"S{number}", "m") for number in (1, 2, 3))
)


def sound(seed: int = 0) -> np.ndarray:
    """Noise of limited band, as amplifiers and stages give it."""
    values = np.random.default_rng(seed).standard_normal((LENGTH + 2, len(CHANNELS)))
    return values[2:] + values[1:-1] + 0.5 * values[:-2]


def record(values: np.ndarray, channels: tuple[Channel, ...] = CHANNELS) -> Record:
    return replace(in_memory(channels, RATE, values), source="run.uff")


def planted(change: Callable[[np.ndarray], object]) -> Record:
    values = sound()
    change(values)
    return record(values)


def zero(values: np.ndarray) -> None:
    values[:, 4] = 0.0


def constant(values: np.ndarray) -> None:
    values[:, 4] = 2.5


def pulled(values: np.ndarray) -> None:
    values[6000:, 4] = values[6000, 4]


def faint(values: np.ndarray) -> None:
    values[:, 4] *= 1e-6


def nothing_but_nan(values: np.ndarray) -> None:
    values[100:, 4] = np.nan


def clipped(values: np.ndarray) -> None:
    values[:, 4] = np.minimum(values[:, 4], 3.5)


def clipped_below(values: np.ndarray) -> None:
    values[:, 4] = np.maximum(np.round(values[:, 4], 3), -4.0)


def coarse(values: np.ndarray) -> None:
    values[:, 4] = np.round(values[:, 4])


def broken(values: np.ndarray) -> None:
    values[[2048, 5000], 4] = [np.nan, np.inf]


def dependent(values: np.ndarray) -> None:
    values[:, 1] = 0.5 * values[:, 0] + 2.0 * values[:, 2]


def delayed(values: np.ndarray) -> None:
    values[:, 2] = np.roll(values[:, 0], 5) + 0.1 * values[:, 2]


PLANTED = {
    zero: (FaultTolerance.DEAD, "S2", "it is zero throughout"),
    constant: (FaultTolerance.DEAD, "S2", "it is constant at 2.5 um"),
    pulled: (FaultTolerance.DEAD, "S2", "it is frozen from 2.92969 s to 4 s: 2192 of 8192 samples are equal"),
    faint: (FaultTolerance.DEAD, "S2", "its rms is 1.51e-06 um (median of similar channels: 1.51 um)"),
    nothing_but_nan: (FaultTolerance.DEAD, "S2", "8092 of 8192 samples are not numbers, the first at 0.0488281 s"),
    clipped: (FaultTolerance.CLIPPED, "S2", "it is clipped: "),
    clipped_below: (FaultTolerance.CLIPPED, "S2", "lowest value, -4 um"),
    coarse: (FaultTolerance.CLIPPED, "S2", "levels between"),
    broken: (FaultTolerance.GAPS, "S2", "2 of 8192 samples are not numbers, the first at 1 s"),
    dependent: (FaultTolerance.DEPENDENT, "u3", "100 % of its power is explained by the other inputs, u1, u2"),
    delayed: (FaultTolerance.DEPENDENT, "u3", "of its power is explained by the other inputs, u1, u2"),
}


@pytest.mark.parametrize("plant", PLANTED, ids=lambda plant: plant.__name__)
def test_each_fault_is_found_alone_and_named(plant: Callable[[np.ndarray], None]) -> None:
    kind, name, told = PLANTED[plant]
    faults = examine(planted(plant)).faults
    assert [(fault.kind, fault.channel) for fault in faults] == [(kind, name)]
    assert faults[0].finding.where == f"run.uff: {name}"
    assert told in faults[0].finding.what
    assert f'"{kind.value}"' in faults[0].finding.advice


@pytest.mark.parametrize("plant", PLANTED, ids=lambda plant: plant.__name__)
def test_a_fault_is_cured_only_when_allowed(plant: Callable[[np.ndarray], None]) -> None:
    kind, name, _ = PLANTED[plant]
    whole = planted(plant)
    with pytest.raises(DesignError):
        usable_record(whole, frozenset(FaultTolerance) - {kind})
    left = usable_record(whole, frozenset({kind}))
    assert (name in left.names) == (kind in (FaultTolerance.CLIPPED, FaultTolerance.GAPS))
    assert np.isfinite(left.values).all()
    if plant is broken:
        assert (left.start, left.length) == (5001 / RATE, 8192 - 5001)
    else:
        np.testing.assert_array_equal(left.values, whole.select(left.names).values)
    assert all(fault.kind is kind for fault in examine(left).faults)


def test_sound_records_are_left_as_they_are() -> None:
    for seed in range(20 if FULL else 6):
        whole = record(sound(seed))
        assert usable_record(whole, frozenset(FaultTolerance), STAGE) is whole


def test_signals_that_look_odd_but_are_sound() -> None:
    # A fine quantisation, a random binary input, sines that repeat their extremes or are flat on top by quantisation.
    times = np.arange(LENGTH) / RATE
    values = sound()
    values[:, 0] = np.sign(values[:, 0])
    values[:, 3] = np.round(values[:, 3], 1)
    values[:, 4] = np.sin(2.0 * np.pi * 64.0 * times)
    values[:, 5] = np.round(np.sin(2.0 * np.pi * 3.7 * times), 3)
    assert examine(record(values)).findings == ()


def test_all_faults_are_told_at_once() -> None:
    def all_of_them(values: np.ndarray) -> None:
        values[:, 3] = 0.0
        clipped(values)
        values[10, 5] = np.nan
        dependent(values)

    channels = (*CHANNELS[:5], Channel("S3", "furlong", Role.OUTPUT))
    whole = replace(planted(all_of_them), channels=channels)
    with pytest.raises(DesignError) as refused:
        usable_record(whole, requirements=RecordRequirements(resolution=0.1, highest=1500.0))
    kinds = {fault.kind for fault in examine(whole, RecordRequirements(resolution=0.1, highest=1500.0)).faults}
    assert kinds == {
        FaultTolerance.DEAD,
        FaultTolerance.CLIPPED,
        FaultTolerance.GAPS,
        FaultTolerance.DEPENDENT,
        FaultTolerance.UNITS,
        FaultTolerance.SHORT,
        FaultTolerance.SLOW,
    }
    assert len(refused.value.findings) == 7
    left = usable_record(whole, frozenset(kinds), RecordRequirements(resolution=0.1, highest=1500.0))
    assert left.names == ("u1", "u2", "S2", "S3")


def test_a_dead_channel_that_is_left_out_takes_its_gaps_along() -> None:
    whole = planted(nothing_but_nan)
    assert usable_record(whole, frozenset({FaultTolerance.DEAD})).length == LENGTH


def test_units_that_are_missing_or_unknown() -> None:
    channels = (*CHANNELS[:4], Channel("S2", "", Role.OUTPUT), Channel("S3", "furlong", Role.OUTPUT))
    findings = examine(record(sound(), channels)).findings
    assert [finding.what for finding in findings] == ["no unit is specified", '"furlong" is not a known unit']
    assert usable_record(record(sound(), channels), frozenset({FaultTolerance.UNITS})).names == CHANNELS_NAMES


def test_what_is_wrong_with_all_channels_is_told_once() -> None:
    bare = record(sound(), tuple(replace(each, unit="") for each in CHANNELS))
    with pytest.raises(DesignError) as refused:
        sound_records([bare])
    (finding,) = refused.value.findings
    assert finding.where.endswith(", ".join(CHANNELS_NAMES))
    assert finding.what == "no unit is specified"


CHANNELS_NAMES = tuple(channel.name for channel in CHANNELS)


def test_names_and_units_are_held_against_the_stage() -> None:
    channels = (Channel("u1", "V", Role.INPUT), *CHANNELS[1:4], Channel("gauge", "um", Role.OUTPUT), Channel("S3", "V", Role.OUTPUT))
    whole = record(sound(), channels)
    faults = examine(whole, STAGE).faults
    assert [(fault.kind, fault.finding.what) for fault in faults] == [
        (FaultTolerance.NAMES, "unknown output"),
        (FaultTolerance.UNITS, "wrong unit (got V, expected m, the unit of the stage's output)"),
    ]
    assert usable_record(whole, frozenset({FaultTolerance.NAMES, FaultTolerance.UNITS}), STAGE).names == ("u1", "u2", "u3", "S1", "S3")


def test_roles_must_be_known() -> None:
    channels = (*CHANNELS[:3], *CHANNELS[3:5], Channel("spare", "V"))
    whole = record(sound(), channels)
    assert [fault.kind for fault in examine(whole).faults] == [FaultTolerance.NAMES]
    assert usable_record(whole, frozenset({FaultTolerance.NAMES})).names == CHANNELS_NAMES[:5]
    outputs = whole.select(("S1", "S2"))
    with pytest.raises(DesignError, match=r"none of its channels .* is an input"):
        usable_record(outputs, frozenset(FaultTolerance))


def test_nothing_is_left_out_until_nothing_is_left() -> None:
    whole = planted(zero).select(("u1", "S2"))
    with pytest.raises(DesignError, match=r"none of its channels .* is an output"):
        usable_record(whole, frozenset({FaultTolerance.DEAD}))


def test_too_short_and_too_slow() -> None:
    whole = record(sound())
    assert examine(whole, RecordRequirements(resolution=2.0, averages=8, highest=1023.0)).findings == ()
    short, slow = (fault for fault in examine(whole, RecordRequirements(resolution=1.9, averages=8, highest=1024.0)).faults)
    assert "too few averages at a resolution of 1.9 Hz (got 7.6 in 4 s, expected 8)" in short.finding.what
    assert "sampled at 2048 Hz, not above twice the frequency of the highest mode, 1024 Hz" in slow.finding.what
    assert "2621 Hz or more" in slow.finding.advice


def test_stored_responses_are_examined() -> None:
    lines = np.linspace(0.0, 200.0, 101)
    found = Responses(lines, CHANNELS[3:], CHANNELS[:3], np.ones((101, 3, 3), complex), np.full((101, 3, 3), 0.9), source="frf.mat")
    assert responses_findings(found, replace(STAGE, highest=150.0)) == []
    wrong = replace(found, coherence=1.2 * np.ones((101, 3, 3)), frequencies=lines[::-1], inputs=(*CHANNELS[:2], Channel("x", "V")))
    assert [fault.kind for fault in responses_findings(wrong, STAGE)] == [FaultTolerance.NAMES, None, FaultTolerance.CLIPPED]


@pytest.mark.parametrize(("name", "unit"), [("hammer", "N"), ("f1", "")])
def test_a_force_windowed_hammer_is_refused_by_its_name(name: str, unit: str) -> None:
    values = sound()
    values[:200, 0], values[200:, 0] = 0.0, 0.0
    values[100:180, 0] = np.hanning(80) * 50.0
    hit = replace(record(values, (Channel(name, unit, Role.INPUT), *CHANNELS[1:])), start=0.5)
    told = [fault for fault in examine(hit).faults if fault.channel == name and fault.kind is FaultTolerance.WINDOWED]
    at = 0.5 + 179 / RATE  # the window's last sample is nought too
    assert [fault.finding.what.partition(",")[0] for fault in told] == [f"it looks force-windowed: exact zeros from {at:.6g} s on"]
    assert "2.19 % of the record" in told[0].finding.what
    with pytest.raises(DesignError, match="force-windowed"):
        usable_record(hit, frozenset(FaultTolerance) - {FaultTolerance.WINDOWED})
    assert name in usable_record(hit, frozenset(FaultTolerance)).names


@pytest.mark.parametrize("seed", [0, *(pytest.param(each, marks=pytest.mark.full) for each in (1, 2))])
def test_a_windowed_force_that_is_allowed_gives_the_mode(seed: int) -> None:
    rate, count, natural, ratio = 1024.0, 8192, 100.0, 0.01
    random = np.random.default_rng(seed)
    force = np.zeros(count)
    force[100:112] = np.hanning(12)
    lines = np.fft.rfftfreq(2 * count, 1.0 / rate)
    moved = np.fft.irfft(np.fft.rfft(force, 2 * count) / (natural**2 - lines**2 + 2j * ratio * natural * lines))[:count]
    moved += 1e-3 * np.max(moved) * random.standard_normal(count)
    made = in_memory([Channel("hammer", "N", Role.INPUT), Channel("y", "um", Role.OUTPUT)], rate, np.stack([force, moved], axis=1))
    with pytest.raises(DesignError, match='accept "windowed"'):
        usable_record(made)
    found = identify(usable_record(made, frozenset({FaultTolerance.WINDOWED})))
    assert len(found.frequencies) == 1
    assert abs(found.frequencies[0] - natural) < 4.0 * found.frequency_deviations[0] + 1e-6 * natural
    assert abs(found.damping[0] - ratio) < 4.0 * found.damping_deviations[0] + 1e-4 * ratio


def test_a_drive_that_rests_is_no_hammer() -> None:
    values = sound()
    values[4000:, 0] = 0.0  # volts, driven for half of the record
    assert "force-windowed" not in str(examine(record(values)).findings)
    still = sound()
    still[:3000, 0] = 0.0  # a force that begins late
    assert "force-windowed" not in str(examine(record(still, (Channel("f", "N", Role.INPUT), *CHANNELS[1:]))).findings)


def test_a_frequency_that_stands_twice_is_told_by_its_lines() -> None:
    frequencies = np.array([1.0, 2.0, 2.0, 3.0])
    twice = Responses(frequencies, CHANNELS[3:4], CHANNELS[:1], np.ones((4, 1, 1), complex))
    assert [fault.finding.what for fault in responses_findings(twice)] == [
        "its frequencies do not increase: 2 Hz occurs twice, as values 2 and 3"
    ]


def test_statistics_do_not_depend_on_blocks() -> None:
    """Of drifting samples with gaps, steps and stretches that stand still: block by block as at once, and as numpy has them."""
    for seed in range(20):
        random = np.random.default_rng(seed)
        values = np.round(np.cumsum(random.normal(size=400)) + 50.0, 1)
        values[100:160] = values[100]
        values[random.integers(0, 400, 5)] = np.nan
        cuts = np.sort(random.choice(np.arange(1, 400), 6, replace=False))
        parts = Numbers()
        for block in np.split(values, cuts):
            parts = parts.add(block)
        whole, known = Numbers().add(values), values[np.isfinite(values)]
        assert (parts.mean, parts.rms) == pytest.approx((np.mean(known), np.std(known)), rel=1e-12)
        assert (parts.low, parts.high, parts.count, parts.broken) == (known.min(), known.max(), 400, 400 - len(known))
        for name in ("pairs", "step", "still", "still_from", "still_at", "first_broken"):
            assert getattr(parts, name) == getattr(whole, name), name
