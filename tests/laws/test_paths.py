"""Paths that a design states: what is judged along them is what equilibria say, in files, studies and batches alike."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import judge, measure_all
from flexstage.analysis.assessment.measures import measure_kind
from flexstage.analysis.assessment.requirements import measure, requirements
from flexstage.analysis.caveats import model_findings
from flexstage.analysis.loaded.course import course
from flexstage.mechanism.design import design, designs
from flexstage.mechanism.store import dumps, loads
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.optimisation.search.optimum import optimise
from flexstage.studies.optimisation.values import values_of
from flexstage.studies.sweeps.execution.run import sweep
from flexstage.studies.sweeps.file import load_study
from flexstage.studies.tolerances.file import load_tolerance
from flexstage.studies.tolerances.slopes import slopes
from tests.laws.test_nonlinear import LEAF, UNIT, guide

OUT = fs.StrokePath("platform.y", ("-10 mm", "10 mm"), points=5, hold={"platform.x": "-5 N"})
ASKED = {
    "out.force at 10 mm": "at most 1 kN",
    "out.motion.x": "at most 1 m",
    "out.strain": "at most 2 %",
    "frequency.1 over out": "at least 1 Hz",
    "stiffness.z over out": "at least 1 N/um",
    "buckling.factor": "at least 3",
}


def stage(**changes: fs.StrokePath) -> fs.Mechanism:
    return replace(guide(gravity=(-9.80665, 0.0, 0.0)), paths={"out": OUT, **changes}, requirements=ASKED)


def test_what_is_judged_along_a_path_is_what_equilibria_say():
    model = fs.nonlinear(stage())
    rest = fs.equilibrium(model, {"platform.fx": -5.0})
    ends = fs.equilibrium(model, {"platform.fx": -5.0}, hold={"platform.y": np.array([-10e-3, 0.0, 10e-3])})
    found = {each.requirement.key: float(np.asarray(each.value)) for each in judge(stage())}
    assert found["out.force at 10 mm"] == pytest.approx(ends.reactions[2, 0], rel=1e-9)
    assert found["out.motion.x"] == pytest.approx(abs(ends.displacement()[2, 0] - rest.displacement()[0]), rel=1e-9)
    assert found["frequency.1 over out"] == pytest.approx(np.min(fs.modes(fs.linearise(ends)).frequencies[:, 0]), rel=1e-6)
    slender = 2.0 * np.pi**2 * UNIT / 9.80665
    assert found["buckling.factor"] == pytest.approx(fs.critical_load(model, {"weight": 1.0}, weight=0.0).factor, rel=1e-5)
    assert 1.0 < found["buckling.factor"] / slender < 1.1


def test_paths_stand_in_files():
    again = loads(dumps(stage()))
    assert dict(again.paths["out"].hold) == {"platform.x": "-5 N"}
    assert [each.limit for each in requirements(again)] == [each.limit for each in requirements(stage())]
    assert {measure_kind(each.kind.form).form for each in requirements(again)} == {each.kind.form for each in requirements(again)}


def test_a_batch_is_its_designs_and_steps_along_imaginary_parts_are_slopes():
    """Force goes with t^3 but for plate action, which weighs less in thicker leaves."""
    thick = np.array([0.4e-3, 0.5e-3]) + 1e-20j
    free = replace(stage(), gravity=(0.0, 0.0, 0.0), paths={"out": replace(OUT, hold={})})
    batch = replace(free, parts={"leaf": replace(LEAF, thickness=thick)})
    assert designs(batch) == 2
    (both,) = measure_all(batch, (measure(batch, "out.force at 10 mm", "here"),))
    single = [measure_all(design(batch, place), (measure(batch, "out.force at 10 mm", "here"),))[0] for place in (0, 1)]
    assert not isinstance(both, str)
    assert np.real(both) == pytest.approx(np.array(single, dtype=float), rel=1e-12)
    powers = np.imag(both) / 1e-20 * np.real(thick) / np.real(both)
    assert np.all((powers > 2.8) & (powers < 3.01))
    mean = np.log(float(np.real(both[1] / both[0]))) / np.log(1.25)
    assert np.mean(powers) == pytest.approx(mean, abs=5e-3)


def test_a_sweep_asks_for_measures_along_a_path(tmp_path: Path):
    (tmp_path / "stage.toml").write_text(dumps(stage()))
    (tmp_path / "study.toml").write_text(
        'format = "flexstage study 1"\nname = "leaves"\ndesign = "stage.toml"\n[variables]\n'
        't = { address = "parts.leaf.thickness", from = "0.4 mm", to = "0.5 mm", levels = 2 }\n'
        '[responses]\npush = "out.force at 10 mm"\nslow = "frequency.1 over out"\n[sweep]\nsampling = "grid"\n'
    )
    found = sweep(load_study(tmp_path / "study.toml"), tmp_path / "out.h5")
    assert found.responses[:, 0][1] == pytest.approx(float(np.asarray(judge(stage())[0].value)), rel=1e-9)
    assert np.all(np.isfinite(found.responses))


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        (fs.StrokePath("platform.q", ("0 mm", "1 mm")), "expected a coordinate or a load"),
        (fs.StrokePath("platform.y", ("1 mm", "1 mm")), "start and end are equal"),
        (fs.StrokePath("platform.y", ("0 mm", "1 kg")), "kg"),
        (fs.StrokePath("platform.y", ("0 mm", "1 mm"), points=1), "too few points"),
        (fs.StrokePath("platform.y", ("0 mm", "1 mm"), hold={"platform.y": "5 N"}), "the force that drives"),
        (fs.StrokePath("platform.y", ("0 mm", "1 mm"), hold={"platform.y": "0"}), "cannot be a fixed coordinate"),
        (fs.StrokePath("platform.y", ("0 mm", "1 mm"), hold={"gravity": "half"}), '"on" or "off"'),
    ],
)
def test_paths_that_mean_nothing_are_found(stated: fs.StrokePath, said: str):
    with pytest.raises(fs.DesignError, match=said):
        course(stage(bad=stated), "bad")
    assert any(said in str(each) for each in model_findings(stage(bad=stated)))


@pytest.mark.parametrize("key", ["out.force at 5 N", "frequency.1 over in", "mass over out", "in.force", "out.motion.q"])
def test_measures_along_no_path_are_refused(key: str):
    with pytest.raises(fs.DesignError):
        measure(stage(), key, "here")


def test_where_the_stage_is_not_stable_it_has_no_frequencies_and_that_is_said():
    """Pressed by one and a half times what its guided leaves bear."""
    pressed = stage(out=replace(OUT, points=2, hold={"platform.x": f"{-3.0 * np.pi**2 * UNIT:.6g} N"}))
    found = {each.requirement.key: each for each in judge(pressed)}["frequency.1 over out"]
    assert found.value is None
    assert "of the loads the stage snaps or buckles" in found.reason


def test_what_stays_on_a_path_stays():
    """A locked rotation does not turn, gravity off is no weight."""
    locked = course(
        stage(bare=fs.StrokePath("platform.y", ("0 mm", "10 mm"), points=2, hold={"platform.rz": "0", "gravity": "off"})), "bare"
    )
    assert (locked.weight, locked.locked) == (0.0, ("platform.rz",))
    model = fs.nonlinear(stage())
    rest = locked.rest(model)
    found = fs.stroke(locked.path(model, rest), rest)
    assert found.sag is not None
    assert np.max(np.abs(found.sag.values)) < 1e-15
    assert found.along.at("2", "platform.rz") == pytest.approx(0.0, abs=1e-15)


BEAMS = """
format = "flexstage study 1"
name = "a guide at its stroke"
design = "guide.toml"
[responses]
force = "out.force at 10 mm"
soft = "out.stiffness"
"""


@pytest.fixture
def at_its_stroke(tmp_path: Path) -> Path:
    """A guide of beams, whose force over 10 mm is to be found: fast, and not linear."""
    leaf = replace(LEAF, section=fs.LeafSection.BEAM)
    path = fs.StrokePath("platform.y", ("0 mm", "10 mm"), points=2)
    stated = replace(stage(), parts={"leaf": leaf}, paths={"out": path}, requirements={})
    (tmp_path / "guide.toml").write_text(dumps(stated))
    return tmp_path / "study.toml"


def test_the_best_design_is_looked_for_by_what_it_does_at_its_stroke(at_its_stroke: Path):
    at_its_stroke.write_text(
        BEAMS
        + """
[variables]
thin = { address = "parts.leaf.thickness", from = "0.3 mm", to = "0.8 mm" }
[limits]
"out.stiffness" = "at least 3 N/mm"
[optimise]
minimise = "force"
starts = 1
"""
    )
    study = load_study(at_its_stroke)
    found = optimise(study, load_optimisation(study))
    assert found.final is not None
    best = study.mechanism_for(values_of(study, found.final.shares))
    path = fs.load_path(fs.nonlinear(best), "platform.y", np.array([0.0, 10e-3]))
    told = fs.stroke(path).along.values[:, 2]
    assert np.min(told) == pytest.approx(3e3, rel=1e-3)
    assert [each.name for each in found.binding] == ["out.stiffness at least 3 N/mm"]


def test_what_scatters_is_told_at_the_stroke(at_its_stroke: Path):
    """How a force changes with a thickness: by two equilibria beside."""
    at_its_stroke.write_text(
        BEAMS
        + """
[scatter]
cut = { address = "parts.leaf.thickness", normal = "2 um" }
[tolerance]
copies = 4
requirements = false
crosstalk = false
"""
    )
    study = load_tolerance(at_its_stroke)
    found = slopes(study)
    assert found.smooth.all()
    step = 1e-8
    forces = [
        fs.equilibrium(fs.nonlinear(replace(study.design, parts={"leaf": leaf})), hold={"platform.y": 10e-3}).reactions[0]
        for leaf in (replace(LEAF, section=fs.LeafSection.BEAM, thickness=0.5e-3 + each) for each in (step, -step))
    ]
    assert found.gradient[0, 0] == pytest.approx((forces[0] - forces[1]) / (2.0 * step), rel=1e-5)
