"""Laws of records: parts and blocks are those of the whole; rounding of times is undone; a record's numbers do not depend on its blocks."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from flexstage.experiment import numbers
from flexstage.experiment.clock import Clock, nominal, printed_uncertainty, read_clock
from flexstage.experiment.formats.read import read
from flexstage.experiment.formats.write import Form, write
from flexstage.experiment.health import examine
from flexstage.experiment.numbers import explained, gather
from flexstage.experiment.record import Channel, Record, Role, in_memory
from flexstage.experiment.unit import in_si

NAMES = ("u1", "u2", "S1", "S2", "S3")


def noise(seed: int, length: int = 4096, rate: float = 2048.0) -> Record:
    channels = [Channel(name, "V" if name[0] == "u" else "um", Role.INPUT if name[0] == "u" else Role.OUTPUT) for name in NAMES]
    return in_memory(channels, rate, np.random.default_rng(seed).standard_normal((length, len(NAMES))))


@given(length=st.integers(1, 60), data=st.data())
def test_parts_of_a_record_are_those_of_its_numbers(length: int, data: st.DataObject) -> None:
    whole = noise(length, length)
    start, stop = sorted(data.draw(st.tuples(st.integers(0, length), st.integers(0, length))))
    names = data.draw(st.permutations(NAMES))[: data.draw(st.integers(1, len(NAMES)))]
    columns = [NAMES.index(name) for name in names]
    np.testing.assert_array_equal(whole.part(start, stop).select(names).values, whole.values[start:stop][:, columns])
    np.testing.assert_array_equal(whole.select(names).part(start, stop).values, whole.values[start:stop][:, columns])
    assert whole.part(start, stop).start == pytest.approx(start / whole.rate)


@given(length=st.integers(0, 60), size=st.integers(1, 20), data=st.data())
def test_blocks_cover_the_record_once_but_for_their_overlap(length: int, size: int, data: st.DataObject) -> None:
    overlap = data.draw(st.integers(0, size - 1))
    whole = noise(1, 60).part(0, length)
    blocks = list(whole.blocks(size, overlap))
    assert all(len(block) == size for block in blocks[:-1])
    covered = [block if number == 0 else block[overlap:] for number, block in enumerate(blocks)]
    together = np.concatenate(covered) if covered else np.zeros((0, len(NAMES)))
    np.testing.assert_array_equal(together, whole.values[: len(together)])
    assert length - len(together) <= (overlap if not blocks else 0)


@given(rate=st.one_of(st.integers(1, 200_000).map(float), st.floats(0.5, 5e5)), digits=st.integers(5, 9))
def test_a_printed_step_gives_back_round_rates(rate: float, digits: int) -> None:
    text = f"{1.0 / rate:.{digits}e}"
    uncertainty = printed_uncertainty(text)
    found = nominal(1.0 / float(text), 1.01 * uncertainty + 1e-15)
    assert abs(found / rate - 1.0) <= 2.1 * uncertainty + 1e-14
    if rate == round(rate, -len(str(int(rate))) + 4):  # four digits: rounder than anything else so near
        assert found == rate


@given(rate=st.sampled_from([10.0, 50.0, 1280.0, 2048.0, 20_000.0]), seed=st.integers(0, 50), pieces=st.integers(1, 5))
def test_times_give_rate_and_gaps_however_they_are_divided(rate: float, seed: int, pieces: int) -> None:
    draw = np.random.default_rng(seed)
    times = seed + np.arange(3000) / rate
    where = np.sort(draw.choice(np.arange(10, 2990), size=seed % 3, replace=False))
    for place in where:
        times[place:] += draw.integers(1, 1000) / rate
    found = read_clock(np.array_split(times, pieces), "a.csv")
    assert isinstance(found, Clock)
    assert found.rate == rate
    assert [start for start, _ in found.stretches] == [0, *where]
    np.testing.assert_allclose(found.starts, times[[0, *where]])


@given(decimals=st.integers(4, 7))
def test_rounded_times_give_the_rate(decimals: int) -> None:
    times = np.round(np.arange(20_000) / 2048.0, decimals)
    found = read_clock([times], "a.csv")
    assert isinstance(found, Clock)
    assert (found.rate, len(found.stretches)) == (2048.0, 1)


def test_si_scales_numbers_and_units() -> None:
    whole = noise(2)
    scaled = in_si(whole)
    np.testing.assert_array_equal(scaled.values, whole.values * [1.0, 1.0, 1e-6, 1e-6, 1e-6])
    assert [channel.unit for channel in scaled.channels] == ["V", "V", "m", "m", "m"]
    np.testing.assert_array_equal(in_si(scaled).values, scaled.values)


@given(seed=st.integers(0, 30), segments=st.integers(1, 7))
def test_numbers_do_not_depend_on_blocks(seed: int, segments: int) -> None:
    values = noise(seed, 9000).values.copy()
    draw = np.random.default_rng(seed)
    values[:, 2] = np.clip(np.round(values[:, 2], 1), -1.5, 2.0)
    values[draw.integers(0, 9000, 3), 3] = np.nan
    values[3000:3300, 4] = 0.25
    whole = in_memory(noise(0).channels, 2048.0, values)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numbers, "_BLOCK", 1024 * segments * len(NAMES))
        found = gather(whole)
    one = gather(whole)
    assert found.stretch == one.stretch
    np.testing.assert_allclose(found.input_spectra, one.input_spectra, rtol=1e-12)
    for column, (divided, undivided) in enumerate(zip(found.channels, one.channels, strict=True)):
        finite = values[:, column][np.isfinite(values[:, column])]
        assert (divided.mean, divided.rms) == pytest.approx((finite.mean(), finite.std()))
        assert (divided.low, divided.high, divided.broken) == (finite.min(), finite.max(), 9000 - len(finite))
        assert (divided.still, divided.still_from, divided.levels) == (undivided.still, undivided.still_from, undivided.levels)
        for end, extreme in ((divided.at_low, finite.min()), (divided.at_high, finite.max())):
            assert end == min(2048, np.count_nonzero(finite == extreme))
    assert (one.channels[4].still, one.channels[4].still_from) == (300, 3000)


@pytest.mark.parametrize("form", [form for form in Form if form is not Form.MAT])
def test_memory_does_not_grow_with_the_record(form: Form, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Blocks are made small, so that short records have many; MAT files of version 5 cannot be read in part.
    monkeypatch.setattr(numbers, "_BLOCK", 4 * 1024)
    monkeypatch.setattr("flexstage.experiment.formats.table.read._BLOCK", 1024)
    monkeypatch.setattr("flexstage.experiment.formats.table.values._PIECE", 1 << 16)
    peaks: list[int] = []
    for length in (10_000, 20_000, 40_000):
        path = tmp_path / f"{length}.{'mat' if form is Form.MAT_73 else form.value.partition('-')[0]}"
        values = np.random.default_rng(0).standard_normal((length, 4))
        write(path, in_memory([Channel(f"S{number}", "um") for number in range(4)], 20e3, values), form)
        tracemalloc.start()
        try:
            found = read(path)
            assert isinstance(found, Record)
            gather(found)
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
    assert peaks[2] - peaks[1] < 0.1 * 20_000 * 4 * 8  # the first read loads modules


@given(seed=st.integers(0, 10_000))
def test_sound_noise_has_no_faults(seed: int) -> None:
    assert examine(noise(seed)).findings == ()


@given(seed=st.integers(0, 200), share=st.floats(0.0, 1.0), delay=st.integers(0, 20))
def test_what_is_explained_is_the_share_of_power(seed: int, share: float, delay: int) -> None:
    # u2 is a share of u1, some samples late, and noise of its own.
    assume(share == 0.0 or share > 1e-3)
    draw = np.random.default_rng(seed)
    one, other = draw.standard_normal((2, 16_384))
    second = np.sqrt(share) * np.roll(one, delay) + np.sqrt(1.0 - share) * other
    found = gather(in_memory([Channel("u1", "V", Role.INPUT), Channel("u2", "V", Role.INPUT)], 1.0, np.column_stack([one, second])))
    np.testing.assert_allclose(explained(found.input_spectra), share, atol=0.05 + 0.15 * share * delay / 20)
