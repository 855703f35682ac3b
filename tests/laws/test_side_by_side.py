"""Controllers side by side: who wins, who is beaten, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.apps.cli import run
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.noise import noise_budget
from flexstage.control.robustness.stability_margins import bandwidths, peaks
from flexstage.control.show.report import comparison_report
from flexstage.control.show.tables import comparison_tables
from flexstage.control.study.choices import ControllerKind, Criterion
from flexstage.control.study.compare import ComparedController, Comparison, DetunedController, compare_controllers
from flexstage.control.study.compare import rival as rival_of
from flexstage.control.study.setup import ControllerSetup, Floor, GoalSetup, LoopSetup, NotchSetup, VibrationSetup
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.control.systems.closed import LoopBreak, loop
from flexstage.control.tuning.laws import PI_FAMILY
from flexstage.control.tuning.outcome import Outcome, outcome
from flexstage.control.tuning.search import field
from flexstage.control.tuning.spec import TuningSpec
from flexstage.control.tuning.view import view
from flexstage.show.table import Mark

VC_D = VibrationSetup(criterion=Criterion.VC_D)
FLOOR = Floor(VC_D, VC_D, VC_D)


def rival(*, rejection: float, noise: float, settling: float, delay: float) -> ComparedController:
    ones = np.ones(2)
    return ComparedController(
        ("x", "rx"), ("m", "rad"), "so", 1.9, ones * rejection, ones * noise, ones * settling, 0.1 * ones, delay, None
    )


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
    shown = comparison_tables(found)[0]
    assert shown is not None
    assert [row[3].text for row in shown.rows] == ["20", "30", "30", "not settled"]
    assert [row[0].text for row in shown.rows for cell in row[1:5] if cell.mark is Mark.PASS] == ["PI", "PI", "PID", "LQG"]


def test_what_the_best_noise_is_is_told_where_the_worst_is_printed():
    """The least noise on the whole may be the worst along one axis: 1 nm and 10 nrad beside 4 nm and 4 nrad."""
    even = rival(rejection=300.0, noise=4e-9, settling=0.02, delay=1e-4)
    found = Comparison({"pi": replace(even, noise=np.array([1e-9, 10e-9])), "pid": even}, {})
    assert found.wins["noise"] == "pi"
    shown = comparison_tables(found)[0]
    assert shown is not None
    assert any("The best noise is the lowest geometric mean of all coordinates." in note for note in shown.notes)


def test_noise_that_nothing_makes_is_won_by_none():
    silent = rival(rejection=90.0, noise=0.0, settling=0.03, delay=1e-3)
    assert "noise" not in Comparison({"pi": silent}, {}).wins


def test_what_belongs_to_one_controller_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    gains = 'integral = "300 1/s"\nloops = [{ axes = ["x"], proportional = 0.1 }]\n'
    (tmp_path / "own.toml").write_text(f'format = "flexstage loop 1"\n[controller]\n{gains}')
    assert run(["new", "guide.toml", "--case", "parallelogram"]) == 0
    assert run(["loop", "guide.toml", "--setup", "own.toml", "--compare", "--hardware", "r.c"]) == 2
    told = capsys.readouterr().err
    assert "--hardware: belongs to one controller" in told
    assert all(f"controller.{name}: belongs to one controller" in told for name in ("integral", "loops"))
    assert "controller.proportional" not in told
    assert not (tmp_path / "r.c").exists()


def outcome_of(study: LoopStudy, gain: float) -> Outcome:
    seen = view(study.plant, platform_loops(study.plant.coordinates), 0.0)
    return outcome(field(seen, TuningSpec(PI_FAMILY, spread=0.0, floor=study.settled.floor)), study.controller.system, gain)


def test_what_is_read_off_responses_is_what_the_whole_loop_says():
    """Of a controller as tuned and turned down: rejection, peak of S, noise, delay margin and steps, by other computations."""
    study = loop_study(
        parallelogram(), LoopSetup(floor=FLOOR, controller=ControllerSetup(integral=900.0, notches=(NotchSetup(1674.0, 0.02, 0.5),)))
    )
    found = rival_of(study)
    turned = found.detuned
    assert turned.gains[0] == 1.0
    assert turned.rejection[0] == pytest.approx(found.rejection[0], rel=0.01)
    assert turned.delay_margin[0] == pytest.approx(found.delay_margin, rel=0.02)
    assert turned.settling[0] == pytest.approx(found.settling[0], rel=0.08)
    control = study.controller.system
    wired = loop(study.plant, replace(control, C=0.5 * control.C, D=0.5 * control.D))
    half = outcome_of(study, 0.5)
    assert half.rejection[0][0] == pytest.approx(bandwidths(wired).rejection[0], rel=0.01)
    assert half.peaks[0] == pytest.approx(peaks(wired, LoopBreak.POSE).sensitivity.value, rel=0.01)
    budget = noise_budget(wired, study.settled.floor, (0.1, 5e3), ("relative.x",))
    floor = np.sqrt(budget.by_kind.values[0, list(budget.by_kind.columns).index("floor")])
    assert half.floor[0] == pytest.approx(floor, rel=0.05)


def test_settling_is_told_of_no_step_that_lasts_longer_than_what_is_looked_at():
    """A slow integrator's step is led to its end by the lines that are looked at; as it stands the simulation tells."""
    found = rival_of(loop_study(parallelogram(), LoopSetup(controller=ControllerSetup(integral=40.0))))
    assert found.detuned.settling[0] == found.settling[0] == pytest.approx(np.log(50.0) / 40.0, rel=0.02)
    assert np.all(np.isnan(found.detuned.settling[1:]))


def test_the_report_has_the_front_and_every_motion():
    line = np.geomspace(1.0, 0.1, 3)
    found = Comparison(
        {
            "pi": replace(
                rival(rejection=300.0, noise=4e-9, settling=0.02, delay=1e-4), detuned=DetunedController(line, line, line, line, line)
            )
        },
        {},
    )
    page = comparison_report(parallelogram(), LoopSetup(), found)
    assert "Comparison by coordinate" in page
    assert "delay margin [ms]" in page


@pytest.mark.full
def test_processes_share_the_kinds_and_change_nothing():
    stage, asked = parallelogram(), LoopSetup(controller=ControllerSetup(bandwidth=120.0))
    alone, shared = (compare_controllers(stage, asked, workers=count).controllers for count in (0, 2))
    assert list(alone) == list(shared)
    for name, each in alone.items():
        assert np.array_equal(each.rejection, shared[name].rejection)
        assert np.array_equal(each.detuned.settling, shared[name].detuned.settling, equal_nan=True)


@pytest.mark.full
def test_lqg_by_search_is_better_than_the_one_of_one_bandwidth_in_every_column():
    """Rejection, noise of the floor, settling of x, z, rx, rz on the shipped stage; the peak of S stays within what is allowed."""
    floor = VibrationSetup(criterion=Criterion.VC_D)
    asked = LoopSetup(floor=Floor(floor, floor, floor), controller=ControllerSetup(kind=ControllerKind.LQG))
    before = rival_of(loop_study(double_triangle(), asked))
    after = rival_of(loop_study(double_triangle(), replace(asked, controller=replace(asked.controller, goal=GoalSetup()))))
    assert np.all(after.rejection > before.rejection)
    assert np.all(after.noise < 1.15 * before.noise)
    assert np.all(after.noise[:5] < before.noise[:5])  # what the floor shakes
    assert np.all(after.settling < before.settling)
    assert after.peak < 2.0


@pytest.mark.full
def test_every_kind_is_laid_side_by_side_or_has_its_reason():
    found = compare_controllers(parallelogram())
    assert {*found.controllers, *found.reasons} == {"pi", "pid", "resonant", "lqg", "ppf", "pvf", "pi, damped"}
    assert sorted(found.reasons) == ["pvf"]  # a spread of 2 % of the modes is more than positive velocity feedback bears there
    assert all(each.peak <= 2.01 for each in found.controllers.values())
    assert found.wins["rejection"] in found.front
