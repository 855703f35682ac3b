"""Records of real instruments: read, or refused with a reason. They are no part of the project: name their folder in FLEXSTAGE_RECORDS."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import pyuff
import scipy.io

from flexstage.base.finding import DesignError
from flexstage.experiment.formats.read import read
from flexstage.experiment.identification.diagnosis.peaks import PeakCause
from flexstage.experiment.identification.identify import identify
from flexstage.experiment.records.options import Arrays, Options
from flexstage.experiment.records.record import Record, Responses

FOLDER = Path(os.environ.get("FLEXSTAGE_RECORDS", "no folder of records"))
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="FLEXSTAGE_RECORDS names no folder of real records")


FRAME = Options(
    arrays=Arrays(samples=("Time_chan_*",), time=("Time_domain",), rate=("Time_Sample_Rate",)),
    inputs=("Time_chan_1",),
    units=(("Time_chan_*", "V"),),
)
AVERAGED = Options(arrays=Arrays(frequencies=("Freq_domain",), responses=("Hf_chan_2",), coherence=("Hf_coh_chan_2",)))


def record(name: str, options: Options | None = None) -> Record:
    found = read(FOLDER / name, options or Options())
    assert isinstance(found, Record)
    return found


@pytest.mark.parametrize("name", ["Sample_UFF58_ascii.uff", "Sample_UFF58b_bin.uff"])
def test_a_microphone(name: str) -> None:
    found = record(name)
    assert (found.names, found.channels[0].unit, found.length) == (("Mic 01",), "Pa", 79292)
    assert found.rate == 65536.0  # its step is printed as 1.52588E-05 s
    np.testing.assert_array_equal(found.values[:, 0], pyuff.UFF(str(FOLDER / name)).read_sets(0)["data"])


def test_a_sine_of_eight_byte_numbers() -> None:
    found = record("binary8byte.uff")
    assert (found.names, found.channels[0].unit, found.rate, found.length) == (("sine 5 Hz",), "g0", 100.0, 250)
    np.testing.assert_allclose(found.values[:, 0], np.sin(2.0 * np.pi * 5.0 * np.arange(250) / 100.0), atol=1e-5)


def test_a_last_line_that_is_not_full() -> None:
    found = record("time-history-not-all-columns-filled.uff")
    assert (found.names, found.channels[0].unit, found.rate, found.length) == (("1x",), "m/s²", 20000.0, 13)
    assert found.values[-1, 0] == -5.84096


def test_a_head_that_is_not_ascii() -> None:
    found = read(FOLDER / "non_ascii_header.uff")
    assert isinstance(found, Responses)
    assert found.units == (("(1/N)*(m/s²)",),)
    assert found.values[1, 0, 0] == -5.99924e-02 - 5.53260e-02j
    np.testing.assert_allclose(found.frequencies, np.arange(6) / 5.12, rtol=1e-15)  # printed as 1.95313e-01 Hz


def test_spectra_without_phase_are_refused() -> None:
    with pytest.raises(DesignError, match=r"contains only 1 x power spectral density"):
        read(FOLDER / "sample_dataset58_psd.uff")


def test_an_analysers_file_holds_a_frame_and_responses() -> None:
    path = FOLDER / "case1.mat"
    with pytest.raises(DesignError, match=r"Time_chan_1 \(4096, 1\), Time_Sample_Rate = 1280.*Hf_chan_2 \(1601, 1\) complex"):
        read(path)
    content = scipy.io.loadmat(path)
    frame = record("case1.mat", FRAME)
    assert (frame.rate, frame.length) == (1280.0, 4096)
    np.testing.assert_array_equal(frame.select(["Time_chan_2"]).values, content["Time_chan_2"])
    averaged = read(path, AVERAGED)
    assert isinstance(averaged, Responses)
    np.testing.assert_array_equal(averaged.values[:, 0, 0], content["Hf_chan_2"][:, 0])
    assert averaged.coherence is not None
    np.testing.assert_array_equal(averaged.coherence[:, 0, 0], content["Hf_coh_chan_2"][:, 0])
    size = np.abs(averaged.values[:, 0, 0])
    for peak in (66.9, 212.2, 398.8):  # what its README says is seen
        near = np.flatnonzero(np.abs(averaged.frequencies - peak) < 2.0)
        assert abs(averaged.frequencies[near[np.argmax(size[near])]] - peak) < 0.4


def test_modes_of_a_blow_by_the_analyser_and_by_its_time_frame() -> None:
    """What is seen in its response: 34.05 and 212.1 Hz far above the lines around, a damped bump at 163 Hz with a dip of phase, one line at
    66.9 Hz. 398.8 and 405.9 Hz are single lines of the scatter around an antiresonance, 2 to 3 standard deviations high.
    """
    averaged = read(FOLDER / "case1.mat", AVERAGED)
    assert isinstance(averaged, Responses)
    scores = {peak: _standing_out(averaged, peak) for peak in (34.05, 66.9, 212.1, 398.8, 405.9)}
    assert min(scores[peak] for peak in (34.05, 66.9, 212.1)) > 15.0
    assert max(scores[398.8], scores[405.9]) < 3.0
    found = identify(averaged)
    assert found.frequencies == pytest.approx([34.05, 162.6, 212.1], rel=2e-3)
    assert found.damping[1] > 20.0 * found.damping[2]
    assert any(
        "further modes next to those found may be missing" in each for each in found.data_warnings
    )  # 66.9 Hz is narrower than a line
    frame = identify(record("case1.mat", FRAME))
    assert frame.frequencies[-2:] == pytest.approx([162.8, 212.1], rel=2e-3)
    np.testing.assert_allclose(frame.frequencies[-2:], found.frequencies[1:], rtol=5e-3)
    np.testing.assert_allclose(frame.damping[-2:], found.damping[1:], rtol=0.1)
    # Not resolved, and told so: 66.9 Hz, and multiples of the mains of 60 Hz; in the frame 66.8 Hz does not fade,
    # and 34.05 Hz so little that it is told as either.
    assert [(round(peak.frequency, 1), peak.doubt) for peak in found.peaks] == [
        (each, PeakCause.NARROW) for each in (60.0, 66.9, 120.0, 360.0)
    ]
    assert [("mains" in peak.reason) for peak in found.peaks] == [True, False, True, True]
    peaks = [(round(peak.frequency, 1), peak.doubt) for peak in frame.peaks]
    first = [round(each, 1) for each in frame.frequencies[:-2]]
    assert (first, peaks) in (([34.1], [(66.8, PeakCause.TONE)]), ([], [(34.1, PeakCause.FREE), (66.8, PeakCause.TONE)]))


def _standing_out(averaged: Responses, peak: float) -> float:
    """How far the highest line within 0.4 Hz is from a cubic through 22 neighbours, in standard deviations of theirs."""
    values, lines = averaged.values[:, 0, 0], averaged.frequencies
    place = int(np.argmax(np.where(np.abs(lines - peak) < 0.4, np.abs(values), 0.0)))
    near = np.r_[place - 12 : place - 1, place + 2 : place + 13]
    cubic = np.polyfit(lines[near] - lines[place], values[near], 3)
    rest = np.abs(values[near] - np.polyval(cubic, lines[near] - lines[place]))
    return float(abs(values[place] - cubic[-1]) / np.sqrt(np.median(rest**2) / np.log(2.0)))


def test_big_endian_with_its_step() -> None:
    found = record("frf_data1.mat", Options(arrays=Arrays(samples=("x", "f"), step=("dt",))))
    assert ([each.name for each in found.inputs], [each.name for each in found.outputs]) == (["f"], ["x"])
    assert (found.rate, found.length) == (10.0, 1024)
    np.testing.assert_array_equal(found.select(["x"]).values, scipy.io.loadmat(FOLDER / "frf_data1.mat")["x"])
