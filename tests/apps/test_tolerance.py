"""The command `tolerance`: what it shows and writes, that it does not matter who computes it, and studies that cannot be."""

import json

import numpy as np
import pytest

from flexstage.studies.sweeps.execution.evaluate import piece
from flexstage.studies.sweeps.execution.store import read_results
from flexstage.studies.tolerances.file import load_tolerance

STUDY = """
format = "flexstage study 1"
name = "leaves"
case = "parallelogram"
responses.f = "frequency.1"
tolerance = { copies = 40, seed = 2 }
[scatter]
wire = { address = "hinges.thickness", uniform = "5 um" }
turn = { address = "units.rotation.z", normal = "300 urad" }
"""


@pytest.fixture
def study_file(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def test_tolerance_shows_and_writes(study_file, tmp_path, flexstage):
    done = flexstage("tolerance", "study.toml", "-o", "r.h5", "--report", "r.html", "--json", "r.json", "--workers", "1")
    assert done.code == 0, done.err
    for said in ("All requirements", "Allowable tolerances", "Crosstalk", "+-5 um", "common to 4"):
        assert said in done.out
    told = json.loads((tmp_path / "r.json").read_text())
    assert told["copies"] == {"computed": 40, "failed": 0}
    assert sum(told["responses"][0]["share_by_derivatives"].values()) == pytest.approx(1.0)
    study = load_tolerance(study_file)
    kept = read_results(tmp_path / "r.h5")
    for each in told["responses"]:
        values = kept.column(each["name"])[: study.copies]
        expected = (values.mean(), values.std(ddof=1), np.median(values))
        assert (each["mean"], each["deviation"], each["percentiles"]["50"]) == pytest.approx(expected, rel=1e-12)
    first = told["yield"]["lines"][0]
    assert first["yield"]["share"] == first["yield"]["kept"] / 40 <= first["yield"]["interval"][1]
    assert [each["kind"] for each in told["crosstalk"]] == ["open"]  # one gauge does not tell six motions
    page = (tmp_path / "r.html").read_text()
    assert page.startswith("<!doctype html>")
    assert page.count("<svg") == 2
    assert kept.complete
    np.testing.assert_array_equal(kept.responses[:40], piece(study, 0, 40).responses)
    study_file.write_text(STUDY.replace("5 um", "6 um"))
    other = flexstage("tolerance", "study.toml", "-o", "r.h5", "--resume")
    assert (other.code, "scatter.wire was" in other.err) == (2, True)


def test_without_a_specification_there_is_no_yield(study_file, tmp_path, flexstage):
    study_file.write_text(STUDY.replace("copies = 40", "copies = 8, requirements = false, crosstalk = false").replace("turn =", "#"))
    done = flexstage("tolerance", "study.toml", "--json", "r.json")
    assert done.code == 0
    assert "No yield, because neither" in " ".join(done.out.split())
    told = json.loads((tmp_path / "r.json").read_text())
    assert (told["yield"], told["allowed"]) == (None, None)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("hinges", "hinge", "Use hinges"),
        ("units.rotation.z", "units.rotaton.z", "Use rotation"),
        ("300 urad", "-1 urad", "must be greater than 0"),
        ("copies = 40", "copies = 1", "tolerance.copies: must be 2 or more (got 1). Use e.g. 2."),
        ("seed = 2", 'sampling = "grid"', 'unknown value (got "grid")'),
        ("seed = 2", 'point = "edge"', 'unknown point "edge"'),
        ("seed = 2", 'yield = "101 %"', "study.toml:6: tolerance.yield: must be greater than 0.5 and less than 1 (got 1.01)"),
        ("[scatter]", "[scater]", "scater: unknown key"),
    ],
)
def test_bad_studies_are_told(study_file, tmp_path, flexstage, old, new, message):
    assert old in STUDY
    study_file.write_text(STUDY.replace(old, new, 1))
    done = flexstage("tolerance", "study.toml", "-o", "r.h5")
    assert (done.code, message in " ".join(done.err.split())) == (2, True), done.err
    assert not (tmp_path / "r.h5").exists()
    assert "Traceback" not in done.err
