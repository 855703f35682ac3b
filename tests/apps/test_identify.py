"""The commands `identify` and `compare`: documents, tables, reports, and everything that can be wrong with a record."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flexstage.analysis.complete import platform_modes
from flexstage.base.storage.digest import digest
from flexstage.cases.double_triangle import double_triangle
from flexstage.experiment.formats.write import write
from flexstage.experiment.records.record import Channel, InMemory, Record, Role, in_memory
from flexstage.mechanism.store import load
from flexstage.models.lumped import lumped
from tests.apps.command import Command, Ended
from tests.models.stage_records import stage_record


@pytest.fixture(scope="module")
def record() -> Record:
    return stage_record(double_triangle())


@pytest.fixture(scope="module")
def short() -> Record:
    return stage_record(double_triangle(), seconds=8.0)


@pytest.fixture
def recorded(flexstage: Command, tmp_path: Path, record: Record, monkeypatch: pytest.MonkeyPatch) -> Command:
    """The command line in a folder with stage.toml and record.uff, and an empty cache: other tests may have kept this stage's FEA."""
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "cache"))
    write(tmp_path / "record.uff", record)
    return flexstage


def test_identify_gives_a_document(recorded: Command) -> None:
    ended = recorded("identify", "record.uff", "--stage", "stage.toml", "--json", "-")
    assert ended.code == 0, ended.err
    document = ended.document
    assert (document["kind"], document["name"], document["model"]) == ("identify", "double triangle", None)
    assert document["physics_digest"] == digest(load("stage.toml"), physics=True)
    assert [each["kind"] for each in document["files"]] == ["record"]
    known = platform_modes(double_triangle(), lumped(double_triangle())).platform_frequencies
    assert [mode["frequency_hz"] for mode in document["modes"]] == pytest.approx(known.tolist(), rel=5e-4)
    for mode in document["modes"]:
        low, high = mode["frequency_interval_hz"]
        assert low < mode["frequency_hz"] < high
        assert set(mode["shape"]) == {"S1", "S2", "S3", "S4", "S5", "S6"}
        assert set(mode["participation"]) == {"B1", "B2", "B3", "B4", "B5", "B6"}
    assert document["close_modes"] == [[1, 2], [5, 6]]
    assert document["shape_matrix"]["rows"] == ["S1", "S2", "S3", "S4", "S5", "S6"]
    assert len(document["platform"]["twists"]) == 6
    assert document["spectra"]["averages"] > 6


def test_identify_without_a_stage_at_a_stated_resolution(recorded: Command, tmp_path: Path) -> None:
    ended = recorded("identify", "record.uff", "--frequency-resolution", "2 Hz", "--json", "modes.json")
    assert ended.code == 0
    document = json.loads((tmp_path / "modes.json").read_text())
    assert document["name"] is None
    assert document["physics_digest"] is None
    assert "platform" not in document
    assert len(document["modes"]) == 6
    assert document["spectra"]["resolution_hz"] == 2.0
    for text in ("Recorded data", "20 s at 1024 Hz", "Modes found", "95 % interval", "Shapes of the modes"):
        assert text in ended.out


def test_a_band_is_kept_to(recorded: Command) -> None:
    document = recorded("identify", "record.uff", "--band", "120 Hz", "0.16 kHz", "--json", "-").document
    assert [round(mode["frequency_hz"]) for mode in document["modes"]] == [126, 144]
    assert document["band_hz"] == [120.0, 160.0]


def pictures(page: str) -> list[str]:
    return re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL)


@pytest.mark.full  # its parts stand alone in reports of comparisons, which are always tried
def test_the_report_stands_alone(recorded: Command, tmp_path: Path) -> None:
    ended = recorded("identify", "record.uff", "--stage", "stage.toml", "--report", "modes.html")
    assert ended.code == 0, ended.err
    page = re.sub(r"<script.*?</script>", "", (tmp_path / "modes.html").read_text(), flags=re.DOTALL)
    for title in ("Modes found", "Shapes on the stage", "Responses", "Coherence", "Stabilisation"):
        assert f"<h2>{title}</h2>" in page
    assert not re.search(r"(src|href)=.?https?:|url\(.?https?:", page)
    page = re.sub(r"base64,[^\"]+", "", page)
    drawn = pictures(page)
    assert len(drawn) == 1 + 6 + 4  # the stage; shapes; responses, estimators, coherence, stabilisation
    for each in drawn:
        ET.fromstring(each)  # noqa: S314  our own text
    assert "NaN" not in page
    assert "nan" not in "".join(drawn)


def test_compare_gives_a_document_and_a_report(recorded: Command, tmp_path: Path) -> None:
    ended = recorded("compare", "stage.toml", "--record", "record.uff", "--json", "-", "--report", "compared.html")
    assert ended.code == 0, ended.err
    _document_of_a_comparison(ended)
    page = (tmp_path / "compared.html").read_text()
    assert page.index("<h2>Theory and experiment</h2>") < page.index("<h2>Modes found</h2>")
    assert len(pictures(page)) == 1 + 6 + 5
    assert len(page.encode()) < 2_000_000
    assert max(len(each) for each in pictures(page)) < 450_000  # 36 responses of some thousand points, as Matplotlib writes them


def _document_of_a_comparison(ended: Ended) -> None:
    document = ended.document
    assert (document["kind"], document["model"]) == ("compare", "lumped")
    assert [mode["name"] for mode in document["modes"]] == ["tilt", "tilt", "z", "yaw", "x", "y"]
    for mode in document["modes"]:
        assert abs(mode["difference"]) < 5e-4
        assert mode["assurance"] > 0.99
        assert mode["fea_hz"] is None
    assert [group["numbers"] for group in document["repeated"]] == [[1, 2], [5, 6]]
    assert "--fea" in ended.err


def test_compare_takes_changes_and_models(recorded: Command) -> None:
    softer = recorded("compare", "stage.toml", "--record", "record.uff", "--set", "horizontal/front.thickness=1.4mm", "--json", "-")
    assert softer.document["modes"][3]["difference"] < -0.002
    mapped = recorded("compare", "stage.toml", "--record", "record.uff", "--model", "mapped", "--json", "-")
    assert mapped.document["model"] == "mapped"
    assert recorded("compare", "stage.toml", "--record", "record.uff", "--model", "ideal").code == 2


@pytest.mark.full  # tests/models/test_identify.py puts them together always
def test_records_of_single_actuators_are_put_together(flexstage: Command, tmp_path: Path) -> None:
    names = [f"B{number}.csv" for number in range(1, 7)]
    for number, name in enumerate(names):
        write(tmp_path / name, stage_record(double_triangle(), seed=10 + number, seconds=12.0, active=(number,)))
    whole = flexstage("identify", *names, "--json", "-").document
    known = platform_modes(double_triangle(), lumped(double_triangle())).platform_frequencies
    assert [mode["frequency_hz"] for mode in whole["modes"]] == pytest.approx(known.tolist(), rel=1e-3)
    alone = flexstage("identify", names[0], "--json", "-")
    assert "only B1 was driven" in alone.err
    assert "only one combination" in alone.document["data_warnings"][0]


def test_noise_gives_no_mode_and_says_so(flexstage: Command, tmp_path: Path) -> None:
    channels = [Channel("u1", "V", Role.INPUT), Channel("y1", "um", Role.OUTPUT), Channel("y2", "um", Role.OUTPUT)]
    write(tmp_path / "noise.csv", in_memory(channels, 512.0, np.random.default_rng(2).standard_normal((8192, 3))))
    ended = flexstage("identify", "noise.csv", "--report", "noise.html")
    assert ended.code == 0
    assert "no mode exceeds the noise" in ended.err
    assert "No mode was found" in ended.out
    assert "no mode exceeds the noise" in (tmp_path / "noise.html").read_text()


def changed(column: str, change: Callable[[np.ndarray], Any]) -> Callable[[Record], Record]:
    def made(record: Record) -> Record:
        values = record.values.copy()
        values[:, record.names.index(column)] = change(values[:, record.names.index(column)])
        return replace(record, samples=InMemory(values))

    return made


def with_gap(values: np.ndarray) -> np.ndarray:
    values[5000:5100] = np.nan
    return values


def without_unit(record: Record) -> Record:
    return replace(record, channels=tuple(replace(each, unit="") if each.name == "S3" else each for each in record.channels))


def copied_input(record: Record) -> Record:
    values = record.values.copy()
    values[:, 1] = 2.0 * values[:, 0]
    return replace(record, samples=InMemory(values))


def renamed(record: Record) -> Record:
    return replace(record, channels=tuple(replace(each, name="S9") if each.name == "S3" else each for each in record.channels))


FAULTS: dict[str, tuple[Callable[[Record], Record], str, str]] = {
    "gap": (changed("S2", with_gap), "S2: 100 of 8192 samples are not numbers", "gaps"),
    "dead": (changed("S2", lambda values: 0.0 * values), "S2: it is zero throughout", "dead"),
    "clipped": (changed("S2", lambda values: np.clip(values, -0.5 * np.std(values), 0.5 * np.std(values))), "S2: it is clipped", "clipped"),
    "unit": (without_unit, "S3: no unit is specified", "units"),
    "dependent": (copied_input, "is explained by the other inputs", "dependent"),
    "name": (renamed, "S9: unknown output", "names"),
}


@pytest.mark.parametrize("fault", [pytest.param(each, marks=[pytest.mark.full] if each == "dependent" else []) for each in FAULTS])
def test_faults_are_named_and_used_only_when_allowed(flexstage: Command, tmp_path: Path, short: Record, fault: str) -> None:
    change, told, allowed = FAULTS[fault]
    write(tmp_path / "bad.h5", change(short))
    arguments = ("identify", "bad.h5", "--stage", "stage.toml", "--json", "-")
    ended = flexstage(*arguments)
    assert ended.code == 2
    assert ended.out == ""
    assert told in ended.err
    assert "Traceback" not in ended.err
    cured = flexstage(*arguments, "--accept-fault", allowed)
    assert cured.code == 0, cured.err
    assert cured.document["modes"]


def test_units_can_be_stated(flexstage: Command, tmp_path: Path, short: Record) -> None:
    write(tmp_path / "bare.h5", without_unit(short))
    ended = flexstage("identify", "bare.h5", "--units", "S*=um", "--band", "120 Hz", "160 Hz", "--json", "-")
    assert ended.code == 0, ended.err
    assert {each["unit"] for each in ended.document["files"][0]["outputs"]} == {"um"}


def test_sampling_below_twice_the_highest_mode(flexstage: Command, tmp_path: Path, record: Record) -> None:
    write(tmp_path / "slow.h5", replace(record, rate=300.0))
    ended = flexstage("compare", "stage.toml", "--record", "slow.h5")
    assert ended.code == 2
    assert "300 Hz, not above twice the frequency of the highest mode, 173" in ended.err


def test_all_files_are_looked_at(flexstage: Command, tmp_path: Path, record: Record) -> None:
    write(tmp_path / "dead.h5", FAULTS["dead"][0](record))
    write(tmp_path / "bare.h5", without_unit(record))
    ended = flexstage("identify", "dead.h5", "bare.h5")
    assert ended.code == 2
    assert "dead.h5: S2: it is zero" in ended.err
    assert "bare.h5: S3: no unit" in ended.err


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("nowhere.uff",), "file not found"),
        (("stage.toml",), "stage.toml"),
        (("record.uff", "--accept-fault", "everything"), "--accept-fault everything: unknown word. Use truncated, gaps"),
        (("record.uff", "--kind", "film"), "--kind film: unknown word. Use record or responses"),
        (("record.uff", "--kind", "responses"), "record.uff"),
        (("record.uff", "--units", "um"), "channel or unit missing"),
        (("record.uff", "--rate", "fast"), "--rate"),
        (("record.uff", "--rate", "0 Hz"), "--rate"),
        (("record.uff", "--band", "200 Hz", "100 Hz"), "invalid band (got 200 Hz to 100 Hz)"),
        (("record.uff", "--band", "2 kHz", "3 kHz"), "not above twice the frequency of the highest mode"),
        (("record.uff", "--frequency-resolution", "0.1 Hz"), "averages at a resolution of 0.1 Hz"),
        (("record.uff", "--inputs", "X*"), "unknown channel"),
        (("record.uff", "--inputs", "B1", "--outputs", "B1"), "as an input and as an output"),
        (("record.uff", "--channels", "S*"), "is an input"),
        (("record.uff", "--stage", "nowhere.toml"), "nowhere.toml"),
        (("record.uff", "--report", "record.uff"), "also an input of this command"),
        (("record.uff", "--report", "no/folder.html"), "cannot be written"),
        (("record.uff", "--stage", "stage.toml", "--report", "stage.toml"), "also an input of this command"),
        (("record.uff", "--json", "-", "--report", "-"), "stdout"),
    ],
)
def test_bad_input_is_told(recorded: Command, arguments: tuple[str, ...], told: str) -> None:
    ended = recorded("identify", *arguments)
    assert ended.code == 2, ended.err
    assert ended.out == ""
    assert told in ended.err
    assert "Traceback" not in ended.err


def test_a_truncated_file_is_told(recorded: Command, tmp_path: Path) -> None:
    whole = (tmp_path / "record.uff").read_bytes()
    (tmp_path / "cut.uff").write_bytes(whole[: len(whole) // 2])
    ended = recorded("identify", "cut.uff")
    assert ended.code == 2
    assert "cut.uff" in ended.err
