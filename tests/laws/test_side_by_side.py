"""Controllers side by side: who wins, who is beaten, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.apps.cli import run
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.study.compare import Comparison, Rival, compare_controllers
from flexstage.control.tables import comparison_table


def rival(*, rejection: float, noise: float, settling: float, delay: float) -> Rival:
    ones = np.ones(2)
    return Rival(("x", "rx"), ("m", "rad"), "so", 1.9, ones * rejection, ones * noise, ones * settling, 0.1 * ones, delay, None)


def test_the_front_is_what_no_other_beats_at_once():
    far = rival(rejection=300.0, noise=4e-9, settling=0.02, delay=1e-4)
    quiet = rival(rejection=100.0, noise=1e-9, settling=0.03, delay=1e-3)
    beaten = rival(rejection=90.0, noise=1e-9, settling=0.03, delay=1e-3)
    never = rival(rejection=310.0, noise=5e-9, settling=np.inf, delay=5e-5)
    found = Comparison({"pi": far, "pid": quiet, "resonant": beaten, "lqg": never}, {})
    assert found.front == ("pi", "pid", "lqg")
    assert {aim: found.wins[aim] for aim in ("rejection", "noise", "settling", "delay margin")} == {
        "rejection": "lqg",
        "noise": "pid",
        "settling": "pi",
        "delay margin": "pid",
    }
    shown = comparison_table(found)
    assert any("not" in str(row) for row in shown.rows)


def test_noise_that_nothing_makes_is_won_by_none():
    silent = rival(rejection=90.0, noise=0.0, settling=0.03, delay=1e-3)
    assert "noise" not in Comparison({"pi": silent}, {}).wins


def test_what_belongs_to_one_controller_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.toml").write_text('format = "flexstage loop 1"\n[controller]\nintegral = "300 1/s"\n')
    assert run(["new", "guide.toml", "--case", "parallelogram"]) == 0
    assert run(["loop", "guide.toml", "--setup", "own.toml", "--compare", "--report", "r.html"]) == 2
    told = capsys.readouterr().err
    assert "--report: it belongs to one controller" in told
    assert "controller.integral: it belongs to one controller" in told
    assert not (tmp_path / "r.html").exists()


@pytest.mark.full
def test_four_kinds_are_laid_side_by_side():
    found = compare_controllers(parallelogram())
    assert sorted(found.controllers) == ["lqg", "pi", "pid", "resonant"]
    assert all(each.peak <= 2.01 for each in found.controllers.values())
    assert found.wins["rejection"] in found.front
