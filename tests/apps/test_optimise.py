"""The command `optimise`: a design file that keeps its promises, and studies that cannot be."""

from dataclasses import replace

import pytest

from flexstage import Inertia, Payload
from flexstage.analysis.assessment.judge import judge
from flexstage.cases.registry import case
from flexstage.mechanism.store import dump, load

STUDY = """
format = "flexstage study 1"
name = "thicker leaves"
design = "guide.toml"
[variables]
leaf = { address = "parts.leaf.thickness", from = "0.6 mm", to = "2 mm", step = "50 um" }
[responses]
f1 = "frequency.platform.1"
[optimise]
maximise = "f1"
starts = 2
"""


@pytest.fixture
def study_file(tmp_path):
    dump(case("parallelogram"), tmp_path / "guide.toml")
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def test_the_file_written_keeps_what_was_told(study_file, tmp_path, flexstage):
    before = (tmp_path / "guide.toml").read_text()
    done = flexstage("optimise", "study.toml", "-o", "better.toml", "--report", "r.html", "--json", "r.json")
    assert done.code == 0, done.err
    assert "2 of 2 starts agree" in " ".join(done.out.split())
    assert (tmp_path / "guide.toml").read_text() == before
    better = load(tmp_path / "better.toml")
    assert better.parts["leaf"].thickness == 0.0016  # on the step
    assert better.tags["parts.leaf.thickness"] == "derived optimise thicker leaves, maximise f1"
    assert all(verdict.passed for verdict in judge(better))
    assert (tmp_path / "r.html").read_text().startswith("<!doctype html>")
    body = flexstage("optimise", "study.toml", "--json", "-").document
    assert body["rounded"]["variables"]["leaf"] == pytest.approx(0.0016, rel=1e-12)
    assert body["agreeing"] == 2


def test_a_case_is_written_as_a_new_file(study_file, tmp_path, flexstage):
    text = study_file.read_text().replace('design = "guide.toml"', 'case = "parallelogram"')
    study_file.write_text(text.replace('address = "parts.leaf.thickness"', 'parameter = "leaf_thickness"'))
    assert flexstage("optimise", "study.toml", "-o", "better.toml").code == 0
    assert load(tmp_path / "better.toml").parts["leaf"].thickness == 0.0016


def test_a_front_is_shown(study_file, tmp_path, flexstage):
    text = study_file.read_text().replace('f1 = "', 'x = "stroke.x"\nf1 = "')
    study_file.write_text(text.replace('maximise = "f1"', 'maximise = ["f1", "x"]\npareto_points = 3'))
    done = flexstage("optimise", "study.toml", "--report", "r.html", "--json", "r.json")
    assert (done.code, "Front" in done.out) == (0, True), done.err
    assert (tmp_path / "r.html").read_text().startswith("<!doctype html>")
    refused = flexstage("optimise", "study.toml", "-o", "better.toml")
    assert (refused.code, "a Pareto front has many designs" in refused.err) == (2, True)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('maximise = "f1"', 'maximise = "f11"', "Use f1"),
        ('maximise = "f1"', "", "objective missing"),
        ('maximise = "f1"', 'maximise = ["f1", "f1"]', "is listed twice"),
        ('maximise = "f1"', "maximise = 3", "must be one or several strings (got 3)"),
        ("starts = 2", "starts = 0", "optimise.starts: must be 1 or more (got 0). Use e.g. 1."),
        ("starts = 2", "start = 2", "Use starts"),
        ('"0.6 mm"', '"1.2 mm"', "expected 0.0012 to 0.002 m"),
        ('"50 um"', '"-50 um"', "must be greater than 0"),
        ('"50 um"', "50", "50"),
        (
            "[optimise]",
            '[limits]\n"stroke.x" = "at least 100 um"\n[optimise]',
            "'stroke.x at least 100 um' cannot hold within these ranges",
        ),
        ("[optimise]", '[limits]\nloss = "at most 1 um"\n[optimise]', "loss"),
        ('"frequency.platform.1"', '"frequency.platform.9"', "Use measures of"),
    ],
)
def test_bad_studies_are_told_and_nothing_is_written(study_file, tmp_path, flexstage, old, new, message):
    text = study_file.read_text()
    assert old in text
    study_file.write_text(text.replace(old, new, 1))
    (tmp_path / "better.toml").write_text("of the user")
    done = flexstage("optimise", "study.toml", "-o", "better.toml")
    assert (done.code, message in " ".join(done.err.split())) == (2, True), done.err
    assert "Traceback" not in done.err
    assert (tmp_path / "better.toml").read_text() == "of the user"


def test_three_objectives_and_its_own_design_are_refused(study_file, flexstage):
    three = study_file.read_text().replace("[optimise]", 'm = "mass"\nk = "stiffness.z"\n[optimise]\nminimise = ["m", "k"]')
    same = flexstage("optimise", "study.toml", "-o", "guide.toml")
    assert (same.code, "is the initial design of the study" in same.err) == (2, True)
    study_file.write_text(three)
    done = flexstage("optimise", "study.toml")
    assert (done.code, "Keep two" in " ".join(done.err.split())) == (2, True)


def test_a_best_design_that_its_weight_brings_down_is_refused(study_file, tmp_path, flexstage):
    inertia = Inertia(0.01, 0.01, 0.01)
    heavy = {"weight": Payload("platform", mass=200.0, at=(0.0, 0.0, 0.0), inertia=inertia)}
    dump(replace(case("parallelogram"), gravity=(0.0, 9.80665, 0.0), payloads=heavy, requirements={}), tmp_path / "guide.toml")
    text = study_file.read_text().replace("maximise", "minimise").replace(', step = "50 um"', "")
    study_file.write_text(text.replace("0.6 mm", "0.1 mm"))
    done = flexstage("optimise", "study.toml", "-o", "worse.toml")
    assert (done.code, "position is unstable" in done.err) == (2, True), done.err
    assert not (tmp_path / "worse.toml").exists()
