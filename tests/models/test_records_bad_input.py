"""Bad files of tests: found, named, explained; what is left is used only when the user says so."""

from __future__ import annotations

import contextlib
import re
import struct
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io

from flexstage.base.finding import DesignError
from flexstage.experiment.formats.read import read
from flexstage.experiment.records.health import examine
from flexstage.experiment.records.options import Arrays, FaultTolerance, Kind, Options
from flexstage.experiment.records.record import Channel, Record, Responses, in_memory
from tests.conftest import FULL
from tests.roundtrip.records import awkward_responses, write_version_73
from tests.roundtrip.records import write_form as write

RATE = 100.0
VALUES = np.random.default_rng(5).standard_normal((400, 2))
CHANNELS = (Channel("u1", "V"), Channel("S1", "um"))
FORMS = {"uff": "uff", "uff-ascii": "uff", "mat": "mat", "hdf5": "h5", "csv": "csv"}
"""Forms of file, and how their names end."""


def refusal(path: Path, options: Options | None = None) -> str:
    with pytest.raises(DesignError) as refused:
        read(path, options or Options())
    for finding in refused.value.findings:
        assert str(path) in finding.where  # the file is named
        assert finding.advice
    return str(refused.value)


def allowing(*allowed: FaultTolerance) -> Options:
    return Options(accept_faults=frozenset(allowed))


def plain(path: Path, form: str) -> Path:
    write(path, in_memory(CHANNELS, RATE, VALUES), form)
    return path


def kept(path: Path, options: Options) -> np.ndarray:
    found = read(path, options)
    assert isinstance(found, Record)
    return found.values


def names(path: Path) -> tuple[str, ...]:
    found = read(path)
    assert isinstance(found, Record)
    return found.names


# --- no file, no record ---


def test_what_is_no_record_is_told(tmp_path: Path) -> None:
    assert "file not found" in refusal(tmp_path / "none.uff")
    assert "got a folder" in refusal(tmp_path)
    for content, told in {
        b"": "it is empty",
        b"PK\x03\x04...": "a spreadsheet",
        b"TDSm....": "TDMS",
        b"one\ntwo\n": "no line of numbers",
        b"\x00\x01\x02\x03": "neither text",
        "time,u1\n0,1\n".encode("utf-16"): "UTF-16",
    }.items():
        path = tmp_path / "a.dat"
        path.write_bytes(content)
        assert told in refusal(path), content


def test_arrays_that_are_no_record_are_listed(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"stiffness": np.eye(3)})
    assert "stiffness (3, 3)" in refusal(path)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["stiffness"] = np.eye(3)
    assert "stiffness (3, 3)" in refusal(tmp_path / "a.h5")


def test_the_other_kind_is_not_given_for_the_one_asked(tmp_path: Path) -> None:
    for form, suffix in (("uff", "uff"), ("mat", "mat"), ("csv", "csv")):
        refusal(plain(tmp_path / f"a.{suffix}", form), Options(kind=Kind.RESPONSES))


def test_channels_that_no_one_has_are_named_with_the_nearest(tmp_path: Path) -> None:
    path = plain(tmp_path / "a.uff", "uff")
    told = refusal(path, Options(inputs=("u2",), outputs=("S*",), units=(("S7", "um"),)))
    assert "inputs u2: unknown channel. Use u1 or S1" in told
    assert "units S7" in told
    assert "named as an input and as an output" in refusal(path, Options(inputs=("u1",), outputs=("u*",)))


# --- files that break off ---


def test_a_last_line_that_ends_in_a_missing_value_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time [s],a [um]\n" + "".join(f"{0.1 * number:.1f},1.5,\n" for number in range(20)) + "2.0,,")
    found = read(path)
    assert isinstance(found, Record)
    assert found.length == 21
    assert np.isnan(found.values[-1]).all()


@pytest.mark.parametrize(("form", "suffix"), [("uff", "uff"), ("uff-ascii", "uff"), ("csv", "csv")])
def test_a_file_that_breaks_off_is_used_only_when_allowed(form: str, suffix: str, tmp_path: Path) -> None:
    path = plain(tmp_path / f"a.{suffix}", form)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(0.8 * len(whole))])
    told = refusal(path)
    assert "it is truncated" in told
    assert '"truncated"' in told
    found = kept(path, allowing(FaultTolerance.TRUNCATED))
    assert 150 < len(found) < 400
    np.testing.assert_allclose(found, VALUES[: len(found)], rtol=1e-11)


@pytest.mark.parametrize("form", [*FORMS, "mat 7.3"])
def test_a_file_cut_anywhere_is_refused_or_whole(form: str, tmp_path: Path) -> None:
    # At every cut a reason or the right numbers: never another error, never numbers that were not measured.
    if form == "mat 7.3":
        path = write_version_73(tmp_path / "a.mat", {"samples": VALUES, "rate": RATE, "names": ("u1", "S1")})
    else:
        path = plain(tmp_path / f"a.{FORMS[form]}", form)
    whole = path.read_bytes()
    for cut in np.linspace(0, len(whole) - 1, 97).astype(int):
        path.write_bytes(whole[:cut])
        for options in (Options(), allowing(FaultTolerance.TRUNCATED)):
            try:
                found = read(path, options)
                assert isinstance(found, Record)
                values = found.values
            except DesignError:
                continue
            columns = [found.names.index(channel.name) for channel in CHANNELS if channel.name in found.names]
            np.testing.assert_allclose(values[:, columns], VALUES[: len(values), : len(columns)], rtol=1e-11, err_msg=str(cut))


@pytest.mark.parametrize("binary", [True, False])
def test_a_universal_file_cut_between_two_functions_is_told(binary: bool, tmp_path: Path) -> None:
    """The format counts no functions; what is written here does."""
    path = tmp_path / "whole.uff"
    plain(path, "uff" if binary else "uff-ascii")
    ends = [found.end() for found in re.finditer(rb"    -1\n(?=    -1\n)", path.read_bytes())]
    whole, count = path.read_bytes(), len(CHANNELS)
    assert len(ends) == count - 1
    path.write_bytes(whole[: ends[-1]])
    told = refusal(path)
    assert f"it has {count - 1} of the {count} functions that were written" in told
    assert '"truncated"' in told


def test_responses_without_their_coherence_are_told(tmp_path: Path) -> None:
    """Some have theirs, so that the file may break off between a response and its coherence."""
    path, outputs = tmp_path / "whole.uff", (Channel("S1", "um"), Channel("S2", "um"))
    values = np.ones((20, 2, 1), dtype=complex)
    write(path, Responses(np.arange(20.0), outputs, (Channel("u", "V"),), values, coherence=np.ones(values.shape)), "uff")
    text = path.read_bytes()
    last = text.rindex(b"    58b")
    path.write_bytes(text[: text.rindex(b"    -1\n", 0, last)].replace(b"function", b"whatever"))  # as another program would
    told = refusal(path)
    assert "only the last response, of S2 to u, has no coherence" in told
    assert '"incomplete"' in told


def test_a_table_cut_within_its_last_number_is_told(tmp_path: Path) -> None:
    # Every field is there and every line; only our own comment of how many samples there are, and the missing end of line, tell.
    path = plain(tmp_path / "a.csv", "csv")
    path.write_bytes(path.read_bytes()[:-4])
    assert "it is truncated" in refusal(path)
    np.testing.assert_array_equal(kept(path, allowing(FaultTolerance.TRUNCATED)), VALUES[:-1])


def test_hdf_that_breaks_off_says_how_far_it_goes(tmp_path: Path) -> None:
    path = plain(tmp_path / "a.h5", "hdf5")
    path.write_bytes(path.read_bytes()[:3000])
    assert "eof = 3000" in refusal(path)


def test_a_binary_universal_file_changed_as_text_is_told(tmp_path: Path) -> None:
    path = plain(tmp_path / "a.uff", "uff")
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    refusal(path)


def test_a_head_that_cannot_be_read_is_told_with_its_line(tmp_path: Path) -> None:
    path = plain(tmp_path / "a.uff", "uff-ascii")
    text = path.read_text()
    path.write_text(text.replace("         4       400         1", "         4       4x0         1", 1))
    assert "a.uff:2: function 1: record 7, the form of the data, cannot be read" in refusal(path)
    path.write_text(text.replace("         4       400         1", "         3       400         1", 1))
    assert "unknown data type (got 3" in refusal(path)


@pytest.mark.parametrize("form", ["uff", "uff-ascii"])
@pytest.mark.parametrize("said", ["rate 100.0 Hz", "rate 0 Hz", "rate 1e999 Hz"])
def test_the_step_in_the_head_counts_not_a_text_beside_it(form: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    write(path, in_memory(CHANNELS, 50.0, VALUES), form)
    path.write_bytes(path.read_bytes().replace(b"rate 50.0 Hz".ljust(len(said)), said.encode().ljust(12)))
    found = read(path)
    assert isinstance(found, Record)
    assert found.rate == 50.0


def test_more_values_than_the_head_announces_are_told(tmp_path: Path) -> None:
    path = plain(tmp_path / "a.uff", "uff-ascii")
    path.write_text(path.read_text().replace("         4       400         1", "         4        40         1", 1))
    assert "it has 400 values (expected 40" in refusal(path)


# --- gaps, times ---


def with_times(path: Path, times: np.ndarray) -> Path:
    np.savetxt(path, np.column_stack([times, VALUES[: len(times)]]), header="time [s],u1 [V],S1 [um]", delimiter=",", comments="")
    return path


@pytest.mark.parametrize("suffix", ["csv", "mat", "h5"])
def test_a_gap_divides_the_record(suffix: str, tmp_path: Path) -> None:
    times = np.arange(400) / RATE
    times[120:] += 0.5
    path = tmp_path / f"a.{suffix}"
    if suffix == "csv":
        with_times(path, times)
    elif suffix == "mat":
        scipy.io.savemat(path, {"time": times, "u1": VALUES[:, 0], "S1": VALUES[:, 1]})
    else:
        with h5py.File(path, "w") as file:
            for name, column in (("time", times), ("u1", VALUES[:, 0]), ("S1", VALUES[:, 1])):
                file[name] = column
    named = Options() if suffix == "csv" else Options(arrays=Arrays(samples=("u1", "S1")))
    told = refusal(path, named)
    assert "1 gap between samples, before 1.7 s" in told
    assert "280 samples (2.8 s)" in told
    found = read(path, replace(named, accept_faults=frozenset({FaultTolerance.GAPS})))
    assert isinstance(found, Record)
    assert (found.rate, round(found.start, 9)) == (RATE, 1.7)
    np.testing.assert_array_equal(found.select(["u1", "S1"]).values, VALUES[120:])


def test_times_that_are_none_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    assert "not evenly spaced" in refusal(with_times(path, np.cumsum(np.random.default_rng(0).exponential(0.01, 400))))
    assert "2 of 2 steps" in refusal(with_times(path, np.array([0.0, 1.0, 6.0])))
    assert "do not increase" in refusal(with_times(path, np.round(np.arange(400) / 1e6, 3)))
    broken = np.arange(400) / RATE
    broken[7] = np.nan
    assert "1 of 400 times are not numbers" in refusal(with_times(path, broken))
    np.testing.assert_array_equal(kept(path, Options(rate=RATE)), VALUES)  # the rate that is stated holds


@pytest.mark.parametrize(
    ("name", "value", "unit", "rate"),
    [
        ("rate", 2.0, "kHz", 2000.0),
        ("rate", 2.0, "1/s", 2.0),
        ("step", 2.0, "ms", 500.0),
        ("step", 0.5, "s", 2.0),
        ("rate", 2.0, "", 2.0),
        ("step", 2.0, "m", None),
        ("step", 2.0, "kHz", None),
        ("rate", 2.0, "ms", None),
    ],
)
def test_a_rate_or_step_has_its_stated_unit(name: str, value: float, unit: str, rate: float | None, tmp_path: Path) -> None:
    """A unit in the file counts: it is converted, or refused, but never ignored."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["samples"] = np.random.default_rng(0).standard_normal((64, 2))
        file[name] = value
        file[name].attrs["units"] = unit
    if rate is None:
        assert f'{name}: wrong unit (got "{unit}"' in refusal(tmp_path / "a.h5")
    else:
        found = read(tmp_path / "a.h5", Options())
        assert isinstance(found, Record)
        assert found.rate == rate


@pytest.mark.parametrize(("unit", "highest"), [("kHz", 20_000.0), ("Hz", 20.0), ("rad/s", None), ("ms", None)])
def test_frequencies_have_their_stated_unit(unit: str, highest: float | None, tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["frequencies"], file["responses"] = np.linspace(1.0, 20.0, 20), np.ones((20, 1, 1), dtype=complex)
        file["frequencies"].attrs["units"] = unit
        file["averages"] = 10.0
        file["averages"].attrs["units"] = "1"  # a count
    if highest is None:
        assert f'frequencies: wrong unit (got "{unit}"' in refusal(tmp_path / "a.h5")
    else:
        found = read(tmp_path / "a.h5", Options())
        assert isinstance(found, Responses)
        assert found.band[1] == highest


def test_times_and_rate_that_disagree_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"time": np.arange(400) / RATE, "rate": 128.0, "samples": VALUES[:, 0]})
    assert "contradictory rates: 100 Hz from the times, 128 Hz stated in the file" in refusal(path)


def test_arrays_of_different_lengths_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"rate": RATE, "u1": VALUES[:, 0], "S1": VALUES[:399, 1]})
    assert "u1 (1, 400), S1 (1, 399)" in refusal(path, Options(arrays=Arrays(samples=("u1", "S1"))))
    assert kept(path, Options(arrays=Arrays(samples=("u1",)))).shape == (400, 1)


# --- CSV lines ---


def lines_of(path: Path) -> list[str]:
    return with_times(path, np.arange(400) / RATE).read_text().splitlines()


def test_lines_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    lines = lines_of(path)
    lines[200] = lines[200].rpartition(",")[0] + ",OVERLOAD"
    path.write_text("\n".join(lines))
    found = read(path)
    assert isinstance(found, Record)
    with pytest.raises(DesignError, match=r"a\.csv:201: S1: \"OVERLOAD\" is not a number"):
        _ = found.values
    lines[200] = "1.99,1.0"
    path.write_text("\n".join(lines))
    with pytest.raises(DesignError, match=r"a\.csv:201: wrong number of fields \(got 2, expected 3\)"):
        _ = kept(path, Options())


@pytest.mark.parametrize("at", [2, 3, 6, 9, 200, 399, 400])
@pytest.mark.parametrize(
    "wrong", ["{},1,2,3", "{},1", "{},1;2", "{}", "time [s],u1 [V],S1 [um]", "", "{},1.0,1.2.3", "{},1_0,2", "{},1,2\x0c3"]
)
def test_one_row_that_is_none_is_named_wherever_it_stands(at: int, wrong: str, tmp_path: Path) -> None:
    path, lines = tmp_path / "a.csv", lines_of(tmp_path / "a.csv")
    lines[at] = wrong.format(lines[at].partition(",")[0])
    path.write_text("\n".join([*lines, ""]))
    if at == 400 and not wrong:
        assert len(kept(path, Options())) == 399  # an empty line at the end is none
        return
    with pytest.raises(DesignError, match=rf"a\.csv:{at + 1}: "):
        _ = kept(path, Options())


@pytest.mark.parametrize("at", [2, 40, 399])
def test_a_comma_among_points_is_no_number(at: int, tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    rows = [f"{np.sin(number):.4f} {np.cos(3 * number):.4f}" for number in range(400)]
    rows[at] = "1,5 -0.1108"
    path.write_text("\n".join(["% of a test", "% u1 S1", *rows, ""]))
    with pytest.raises(DesignError, match=rf"a\.txt:{at + 3}: .*\b(not a|no) number"):
        _ = kept(path, Options(rate=100.0))


def test_a_row_may_end_with_what_divides_it(tmp_path: Path) -> None:
    path, lines = tmp_path / "a.csv", lines_of(tmp_path / "a.csv")
    lines[200] += ","
    path.write_text("\r\n".join(lines))
    np.testing.assert_array_equal(kept(path, Options()), VALUES)


def test_line_ends_of_old_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("\r".join(lines_of(path)), newline="")
    assert "its lines end in carriage returns only" in refusal(path)


def test_steps_that_are_none_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time [s], u1 [V], S1 [um]\n1e-320, 1, 2\n2e-320, 2, 3\n3e-320, 1, 5\n")
    assert "invalid median time step (got 1e-320 s)" in refusal(path)


def test_missing_fields_are_no_numbers(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    lines = lines_of(path)
    lines[200] = lines[200].rpartition(",")[0] + ","
    lines[201] = lines[201].rpartition(",")[0] + ",NaN"
    path.write_text("\n".join(lines))
    values = kept(path, Options())
    assert np.isnan(values[199:201, 1]).all()
    assert np.isfinite(np.delete(values, [199, 200], axis=0)).all()


def test_a_table_without_header_or_time_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, VALUES, delimiter=",")
    assert "2 columns have no header" in refusal(path)
    np.savetxt(path, VALUES, delimiter=",", header="u1 [V],S1 [um]", comments="")
    assert "no column contains times" in refusal(path)
    np.testing.assert_array_equal(kept(path, Options(rate=50.0)), VALUES)


PREAMBLES = {
    "keys and values": "Delta_X\t0.001\nX_Value\tForce\tNote",
    "a key": "u1 [V]\tS1 [um]\nSamples:\t400",
    "a sentence": "# Sample rate: 100 Hz",
}


@pytest.mark.parametrize("preamble", PREAMBLES)
def test_a_preamble_never_names_columns(preamble: str, tmp_path: Path) -> None:
    path, last = tmp_path / "a.csv", PREAMBLES[preamble].splitlines()[-1].lstrip("# ")
    np.savetxt(path, VALUES, delimiter="\t", header=PREAMBLES[preamble], comments="")
    said = refusal(path)
    assert f'its 2 columns are not named by the line above them: "{last}"' in said
    named = said.rpartition('such as "')[2].rpartition('"')[0]  # the hint works as typed
    np.savetxt(path, np.column_stack([np.arange(400) / RATE, VALUES[:, 0]]), delimiter="\t", header=named, comments="")
    assert names(path) == ("u1",)


def test_signs_of_comments_within_names_belong_to_them(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, np.column_stack([np.arange(400) / RATE, VALUES]), header="time [s],a//b [V],50 % load #1 [um]", delimiter=",")
    assert names(path) == ("a//b", "50 % load #1")


def test_names_that_are_formulas_head_no_column(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match="not allowed as a CSV column name"):
        write(tmp_path / "a.csv", in_memory((Channel("=1+1", "V"),), RATE, VALUES[:, :1]))


def test_a_channel_without_samples_is_refused_whatever_is_allowed(tmp_path: Path) -> None:
    path = plain(tmp_path / "a.uff", "uff")
    whole = path.read_bytes()
    size = 8 * len(VALUES)
    first = whole.index(np.ascontiguousarray(VALUES[:, 0]).tobytes())
    path.write_bytes(whole[:first] + whole[first + size :])
    assert "it is truncated" in refusal(path)
    assert "one of its channels has no samples" in refusal(path, allowing(FaultTolerance.TRUNCATED))


# --- responses ---


@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_magnitude_and_phase_are_the_responses(unit: str, tmp_path: Path) -> None:
    path, lines = tmp_path / "a.csv", np.arange(1.0, 51.0)
    exact = 2.0 / (1.0 - (lines / 30.2) ** 2 + 0.02j * lines / 30.2)
    phase = np.angle(exact, deg=unit == "deg")
    np.savetxt(path, np.column_stack([lines, abs(exact), phase]), header=f"frequency [Hz],magnitude [um/V],phase [{unit}]", delimiter=",")
    found = read(path)
    assert isinstance(found, Responses)
    np.testing.assert_allclose(found.values[:, 0, 0], exact, rtol=1e-12)
    assert found.units == (("um/V",),)
    head = f"Frequency (Hz),A Magnitude (dB),B Magnitude (dB),B Phase ({unit})"
    np.savetxt(path, np.column_stack([lines, 0.0 * lines, 20.0 * np.log10(abs(exact)), phase]), header=head, delimiter=",", comments="")
    assert "or select the complete ones (option channels): B" in refusal(path)
    second = read(path, Options(only=("B",)))
    assert isinstance(second, Responses)
    np.testing.assert_allclose(second.values[:, 0, 0], exact, rtol=1e-12)
    np.savetxt(path, np.column_stack([lines, abs(exact), phase]), header="frequency [Hz],gain [um/V],phase [um]", delimiter=",")
    assert 'wrong unit (got "um", expected an angle' in refusal(path)


@pytest.mark.parametrize("name", ["TIME", "Time (s)"])
def test_times_are_known_in_upper_and_lower_case(name: str, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, np.column_stack([np.arange(400) / RATE, VALUES]), header=f"{name},CH1,Frequency", delimiter=",", comments="")
    assert (kept(path, Options()).shape, names(path)) == ((400, 2), ("CH1", "Frequency"))


def test_responses_that_are_no_numbers_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    values = np.ones((50, 2), complex)
    values[3, 1] = np.nan
    scipy.io.savemat(path, {"frequencies": np.arange(50.0), "responses": values})
    assert "y2: 1 of 50 responses are not numbers" in refusal(path)


@pytest.mark.parametrize("at", [3, 40])
@pytest.mark.parametrize("suffix", ["mat", "csv"])
def test_a_frequency_that_stands_twice_is_told(at: int, suffix: str, tmp_path: Path) -> None:
    path, lines = tmp_path / f"a.{suffix}", np.arange(50.0)
    lines[at] = lines[at - 1]
    if suffix == "mat":
        scipy.io.savemat(path, {"frequencies": lines, "responses": np.ones((50, 2), complex)})
    else:
        np.savetxt(path, np.column_stack([lines, lines, lines]), header="frequency [Hz],H_re,H_im", delimiter=",")
    assert f"its frequencies do not increase: {at - 1} Hz occurs twice, as values {at} and {at + 1}" in refusal(path)


# --- files damaged anywhere ---


def damaged(whole: bytes, draw: np.random.Generator) -> bytes:
    """Some bytes changed, left out, repeated or cut off, more often near the head."""
    content = bytearray(whole)
    for _ in range(draw.integers(1, 4)):
        place = int(draw.integers(0, min(len(content), 1200) if draw.random() < 0.6 else len(content)))
        length = int(draw.integers(1, 30))
        change = draw.integers(0, 4)
        if change == 0:
            content[place] = int(draw.integers(0, 256))
        elif change == 1:
            content[place] = b"0123456789-+.,;: \n#eE"[int(draw.integers(0, 21))]
        elif change == 2:
            del content[place : place + length]
        else:
            content[place:place] = content[place : place + length]
        content = content or bytearray(b"x")
    return bytes(content)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", [Record, Responses])
def test_a_file_damaged_anywhere_is_refused_or_read(form: str, kind: type, tmp_path: Path) -> None:
    path = tmp_path / f"a.{FORMS[form]}"
    write(path, in_memory(CHANNELS, RATE, VALUES[:60]) if kind is Record else awkward_responses(), form)
    whole, draw = path.read_bytes(), np.random.default_rng(list(FORMS).index(form))
    for _ in range(1000 if FULL else 30):
        path.write_bytes(damaged(whole, draw))
        for options in (Options(), Options(accept_faults=frozenset(FaultTolerance), rate=50.0)):
            with contextlib.suppress(DesignError):
                found = read(path, options)
                if isinstance(found, Record):
                    examine(found)


# --- objects of MATLAB ---


def _element(kind: int, content: bytes) -> bytes:
    return struct.pack("<II", kind, len(content)) + content + b"\x00" * (-len(content) % 8)


def _with_object(path: Path, name: str, kind: str) -> Path:
    """A MAT file of version 5 with the array `gain` and an object of a class, as MATLAB stores one (class 17)."""
    scipy.io.savemat(path, {"gain": 2.0})
    head = _element(6, struct.pack("<II", 13, 0)) + _element(5, struct.pack("<ii", 1, 1)) + _element(1, b"")
    numbers = _element(14, head + _element(6, b"\x00\x00\x00\xdd"))
    texts = b"".join(_element(1, text.encode()) for text in (name, "MCOS", kind))
    with path.open("ab") as stream:
        stream.write(_element(14, _element(6, struct.pack("<II", 17, 0)) + texts + numbers))
    return path


@pytest.mark.parametrize("kind", ["timeseries", "idfrd", "my.Class"])
def test_objects_of_classes_are_named_with_what_to_save(kind: str, tmp_path: Path) -> None:
    told = refusal(_with_object(tmp_path / "a.mat", "log", kind))
    assert f'a.mat: log: it is an object of class "{kind}"' in told
    expected = {"timeseries": "samples = log.Data", "idfrd": "log.ResponseData", "my.Class": "log's numbers"}
    assert expected[kind] in told
    assert "class" in refusal(_with_object(tmp_path / "a.mat", "log", kind), Options(arrays=Arrays(samples=("log",))))


def test_objects_in_files_of_version_73_are_named_too(tmp_path: Path) -> None:
    path = write_version_73(tmp_path / "a.mat", {"gain": np.ones((1, 1))})
    with h5py.File(path, "r+") as file:
        file["log"] = np.zeros(6, dtype=np.uint32)
        file["log"].attrs["MATLAB_class"], file["log"].attrs["MATLAB_object_decode"] = np.bytes_("timetable"), 3
    assert "seconds(log.Properties.RowTimes)" in refusal(path)


# --- GCS arrays ---

GCS = """# REM C-867
#
# VERSION = 1
# TYPE = 1
# SEPARATOR = {separator}
# DIM = 2
# SAMPLE_TIME = 0.000200
# NDATA = 3
#
# NAME0 = Target Position of Axis AXIS:1
# NAME1 = Actual Position of Axis AXIS:1
#
# END_HEADER
"""
ROWS = ((5.0, 4.9), (5.5, 5.25), (-6.0e-3, 5.875))


def gcs(path: Path, separator: int = 32, end: str = " \n", change: tuple[str, str] = ("", "")) -> Path:
    lines = (chr(separator).join(f"{value:.6e}" for value in row) + end for row in ROWS)
    path.write_text(GCS.format(separator=separator).replace(*change) + "".join(lines), newline="")
    return path


@pytest.mark.parametrize("separator", [32, 9, 44])
@pytest.mark.parametrize("end", ["\n", " \n", " \r\n"])
def test_gcs_arrays_are_read_as_their_header_says(separator: int, end: str, tmp_path: Path) -> None:
    found = read(gcs(tmp_path / "rec.dat", separator, end))
    assert isinstance(found, Record)
    assert (found.rate, found.name) == (5000.0, "C-867")
    assert [each.name for each in found.inputs] == ["Target Position of Axis AXIS:1"]
    assert [each.name for each in found.outputs] == ["Actual Position of Axis AXIS:1"]
    np.testing.assert_array_equal(found.values, ROWS)
    assert FaultTolerance.UNITS in [fault.kind for fault in examine(found).faults]  # the header states none: they are the user's to say


def test_bad_gcs_arrays_are_told(tmp_path: Path) -> None:
    path = tmp_path / "rec.dat"
    for change, told in {
        ("NDATA = 3", "NDATA = 4"): "it has 3 of 4 samples",
        ("NDATA = 3", "NDATA = 2"): "too many lines of numbers (got 3, expected 2 from its header)",
        ("DIM = 2", "DIM = two"): 'DIM: wrong value in the header (got "two"',
        ("DIM = 2", "DIM = 1"): "its header has NAME1, but its DIM is 1",
        ("# SAMPLE_TIME = 0.000200", "#"): "SAMPLE_TIME: the header has no valid time step (missing)",
        ("SEPARATOR = 32", "SEPARATOR = 7"): "unknown separator code",
    }.items():
        assert told in refusal(gcs(path, change=change)), change
    assert len(kept(gcs(path, change=("NDATA = 3", "NDATA = 4")), allowing(FaultTolerance.TRUNCATED))) == 2
    assert read(gcs(path, change=("# SAMPLE_TIME = 0.000200", "#")), Options(rate=10.0)).rate == 10.0  # type: ignore[union-attr]
    twice = GCS.format(separator=32) + "1 2\n3 4\n"
    assert "rec.dat:17: too many lines" in refusal(gcs(path, change=("# REM C-867", twice)))
