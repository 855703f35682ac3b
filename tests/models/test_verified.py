"""Verifications that are known: told again to the last digit, and only of the same description, question and program."""

import json
from dataclasses import replace

import pytest

from flexstage.base.finding import Finding
from flexstage.cases.parallelogram import parallelogram
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.results import verified
from flexstage.solid.results.resolution import Resolution
from flexstage.solid.results.verification import Row
from flexstage.solid.results.verified import Known, recall, retain

ROWS = (
    Row("stage", "stiffness z", "N/m", 1.0 / 3.0, 0.1 + 0.2, 1e-17, calibration=("neck", "leaf"), reason="so"),
    Row("stage", "platform mode 1 (z)", "Hz", None, 5e300, None),
)
KNOWN = Known(ROWS, {"units": "none"}, (Finding("stage", "it is so", "Leave it"),), ("units: 1 %",))


def test_what_is_kept_is_told_again(tmp_path):
    stage, cache = parallelogram(), Cache(tmp_path)
    assert recall(stage, Resolution(), cache) is None
    retain(KNOWN, stage, Resolution(), cache)
    assert recall(parallelogram(), Resolution(), cache) == KNOWN


def test_another_description_question_or_program_is_another_verification(tmp_path, monkeypatch):
    stage, cache = parallelogram(), Cache(tmp_path)
    retain(KNOWN, stage, Resolution(), cache)
    assert recall(replace(stage, name="another"), Resolution(), cache) is None
    assert recall(stage, Resolution(0.02), cache) is None
    assert recall(stage, Resolution(order=3), cache) is None
    monkeypatch.setattr(verified, "_program", lambda: "another")
    assert recall(stage, Resolution(), cache) is None


@pytest.mark.parametrize("damage", [lambda text: text[:-9], lambda text: text.replace("5e+300", "6e+300"), lambda _: "[1]", lambda _: ""])
def test_a_damaged_file_is_not_used(tmp_path, damage):
    stage, cache = parallelogram(), Cache(tmp_path)
    retain(KNOWN, stage, Resolution(), cache)
    (path,) = tmp_path.glob("*.verified")
    assert "5e+300" in json.loads(path.read_text())["told"]
    path.write_text(damage(path.read_text()))
    assert recall(stage, Resolution(), cache) is None


def test_the_oldest_give_way(tmp_path, monkeypatch):
    monkeypatch.setattr(verified, "MOST", 1)
    for order in (2, 3):
        retain(KNOWN, parallelogram(), Resolution(order=order), Cache(tmp_path))
    assert len(list(tmp_path.glob("*.verified"))) == 1
