"""`[requirements]` lines: every key is read, judged and told apart; what is misspelt is mended by advice."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import bench_of, judge
from flexstage.analysis.assessment.measures import MEASURES, Measure, loss, stroke
from flexstage.analysis.assessment.requirements import Sense, asked_factor, known_keys, requirements
from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.linear_statics.deflection import deflection
from flexstage.analysis.linear_statics.drift import drift
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.workspace.load import load_share
from flexstage.analysis.workspace.strength import hinge_stress
from flexstage.analysis.workspace.stroke import single_axis, stroke_limits
from flexstage.base.units.unit import quantity_of_unit
from flexstage.cases.registry import CASES, case
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.show.tables.requirements import rank, verdict_text
from tests.show.stages import seldom


@pytest.fixture(scope="module")
def stage():
    return case("double-triangle")


def asking(stage, **lines):
    return replace(stage, requirements={key.replace("__", "."): text for key, text in lines.items()})


def one(stage, key, text):
    return judge(replace(stage, requirements={key: text}))[0]


ALIKE = ("double-triangle-a", "double-triangle-refitted")
"""Cases with the keys of another."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.full) if name in ALIKE else seldom(name) for name in CASES])
def test_every_key_of_every_case_is_read(name):
    """With the unit its quantity asks for, or that about an axis."""
    mechanism = case(name)
    for key in known_keys(mechanism):
        for form, kind in MEASURES.all.items():
            units = [kind.quantity.si, *([kind.about.si] if kind.about else [])]
            if key.startswith("numbers."):
                units = [quantity_of_unit(mechanism.numbers[key.partition(".")[2]].unit).si]
            if key.startswith(form.partition("<")[0]):
                found = [item for unit in units if (item := readable(mechanism, key, f"at most 3 {unit}" if unit != "1" else "at most 3"))]
                if found and found[0].kind is kind:
                    assert found[0].limit == 3.0
                    break
        else:
            pytest.fail(f"{key} is not read")


def readable(mechanism, key, text):
    try:
        return requirements(replace(mechanism, requirements={key: text}))[0]
    except fs.DesignError:
        return None


def test_a_line_is_read():
    stage = replace(case("hexapod"), requirements={"stroke.ry": "  at least   300 urad  at sample ", "loss": "at most 5 %"})
    first, second = requirements(stage)
    assert (first.kind, first.name, first.point, first.sense) == (stroke, "ry", "sample", Sense.AT_LEAST)
    assert first.limit == pytest.approx(300e-6)
    assert (second.kind, second.limit) == (loss, 0.05)


@pytest.mark.parametrize(
    ("key", "text", "told"),
    [
        ("stroke.w", "at least 5 um", 'unknown measure "stroke.w". Use stroke'),
        ("safty", "at least 2", "Use safety"),
        ("frequency.platform.0", "at least 2 Hz", "frequency.platform"),
        ("loss.B7", "at most 2 %", "Use loss.B"),
        ("stroke.x", "more than 3 um", 'Use "at least" or "at most" and a value'),
        ("stroke.x", "at least", 'Use "at least" or "at most" and a value'),
        ("stroke.x", "at least 50", 'unit missing (got "50")'),
        ("stroke.x", "at least 50 urad", "must be a displacement"),
        ("stroke.rx", "at least 50 um", "must be a rotation"),
        ("drift.x", "at most 5 um", "must be a drift"),
        ("mass", "at most 5 kg at chuck", "the measure does not support a point"),
        ("stiffness.(1,1)", "at least 5 N/um", "Use three numbers"),
        ("stiffness.(0,0,0)", "at least 5 N/um", "Use three numbers"),
        ("stiffness.r(1,1,0)", "at least 5 N/um", "must be a rotational stiffness"),
        ("stroke.x", "at least 50 um at chuck", "unknown point (got at chuck)"),
    ],
)
def test_what_cannot_be_read_is_told(stage, key, text, told):
    with pytest.raises(fs.DesignError) as error:
        requirements(replace(stage, requirements={key: text}))
    assert told in str(error.value)
    assert f"requirements.{key}" in str(error.value)


def test_all_findings_are_told_at_once(stage):
    with pytest.raises(fs.DesignError) as error:
        judge(replace(stage, requirements={"safty": "at least 2", "mass": "at most 5 m", "stroke.z": "at least 150 um"}))
    assert [finding.where for finding in error.value.findings] == ["requirements.safty", "requirements.mass"]


def test_values_are_those_of_the_analyses(stage):
    """Each key against its analysis, asked by hand."""
    kinematics, model = ideal(stage), lumped(stage)
    lost, limits = lost_motion(kinematics, model), stroke_limits(stage)
    own = np.diagonal(lost.loss.values)
    cases = {
        "frequency.1": (modes(model).frequencies[0], "Hz"),
        "frequency.platform.6": (modes(model).platform_frequencies[5], "Hz"),
        "safety": (hinge_stress(stage, model, limits.from_zero).min_safety, ""),
        "stiffness.z": (1.0 / statics(model).compliance.values[2, 2], "N/m"),
        "stiffness.rz": (1.0 / statics(model).compliance.values[5, 5], "N m/rad"),
        "loss": (np.max(own), ""),
        "loss.B1": (own[0], ""),
        "crosstalk": (np.max(np.abs(lost.loss.values - np.diag(own))), ""),
        "drift.z": (abs(drift(stage, model, ground="steel").motion.at("platform.z", "uniform")), "m/K"),
        "mass": (13.9965, "kg"),
        "stiffness.(0,0,-2)": (1.0 / statics(model).compliance.values[2, 2], "N/m"),
        "stiffness.r(0,0,1)": (1.0 / statics(model).compliance.values[5, 5], "N m/rad"),
        "stiffness.(1,2,0)": (1.0 / statics(model).compliance.values[0, 0], "N/m"),  # of threefold symmetry: alike in the plane
        "stiffness.least": (1.0 / np.linalg.eigvalsh(statics(model).compliance.values[:3, :3])[-1], "N/m"),
        "deflection.z": (abs(np.sum(deflection(stage, model).by_cause.values[2])), "m"),
        "height": (0.1126972, "m"),  # from the levers, 2 mm, to the plate's upper face
        "envelope.z": (0.1126972, "m"),
        "opening": (0.0, "m"),
        "resolution.z": (10e-9, "m"),
        "load.B4": (load_share(stage, model).range(limits.from_zero)[1][3], "N"),
        "stroke.z": (np.min(limits.high / np.abs(lost.correction.values[:, 2])), "m"),
    }
    for key, (value, unit) in cases.items():
        found = one(stage, key, f"at most 1 {unit}".strip())
        assert found.value == pytest.approx(value, rel=1e-6, abs=1e-15), key


def test_the_mass_of_everything():
    """Discs as cylinders, stacks as stated, necks as solids of revolution: t(x) = t + 2 (R - (R^2 - x^2)^0.5)."""
    stage = case("hexapod")
    density = {name: material.density for name, material in stage.materials.items()}
    plate = np.pi / 4.0 * (0.14**2 - 0.06**2) * 0.012 * density["aluminium"]
    adapters = 12 * np.pi / 4.0 * 0.014**2 * 0.005 * density["steel"]
    stacks = 6 * stage.parts["stack"].mass
    at = 0.004 * np.cos(np.pi * (np.arange(400) + 0.5) / 400)
    thickness = 0.003 + 2.0 * (0.004 - np.sqrt(0.004**2 - at**2))
    necks = 12 * density["steel"] * np.pi / 4.0 * np.pi / 400 * np.sum(np.sqrt(0.004**2 - at**2) * thickness**2)
    assert one(stage, "mass.total", "at most 5 kg").value == pytest.approx(plate + adapters + stacks + necks, rel=1e-5)


def test_the_corner_of_all_required_strokes(stage):
    """x, y 50 um and yaw 244 urad at once: 89 of 75 um, and more to make up for lost motion."""
    lines = {"stroke.x": "at least 50 um", "stroke.y": "at least 50 um", "stroke.rz": "at least 244 urad"}
    corner, gauges = judge(replace(stage, requirements={**lines, "corner": "at most 100 %", "gauge.range": "at most 100 %"}))[3:]
    assert 89.0 / 75.0 < corner.value < 1.05 * 89.0 / 75.0
    assert not corner.passed
    assert gauges.value == pytest.approx((0.5 * (1.0 + np.sqrt(3.0)) * 50.0 + 0.13 * 244.0) / 250.0, rel=1e-6)
    assert gauges.passed


def test_an_upper_limit_of_a_stroke_is_not_a_required_stroke(stage):
    """A stroke along z of at most 400 um does not add to the strokes that are required at once."""
    alone = {"stroke.x": "at least 50 um", "corner": "at most 100 %"}
    (_, one), (_, both, _) = (judge(replace(stage, requirements=each)) for each in (alone, {**alone, "stroke.z": "at most 400 um"}))
    assert both.value == one.value


def test_a_margin_to_a_limit_of_zero_is_no_percentage(stage):
    """A clearance of 1 mm above a limit of 0 is not a relative margin of 0.1 %; alone, it is told as a length."""
    lines = {"frequency.platform.1": "at least 100 Hz", "clearance": "at least 0 mm"}
    told = [verdict_text(judge(replace(stage, requirements=each))) for each in (lines, {"clearance": "at least 0 mm"})]
    assert told[0].endswith("%, for frequency.platform.1.")
    assert told[1].endswith(" mm, for clearance.")
    assert min(judge(replace(stage, requirements=lines)), key=rank).requirement.key == "frequency.platform.1"


def test_margins_and_edges(stage):
    """Ten per cent to spare is 0.1 on either side; meeting a limit exactly is passing."""
    mass = 13.9965
    assert one(stage, "mass", f"at most {mass / 0.9} kg").margin == pytest.approx(0.1)
    assert one(stage, "mass", f"at least {mass / 1.1} kg").margin == pytest.approx(0.1)
    plain = case("double-triangle-a")
    assert one(plain, "mass", f"at most {mass} kg").passed
    assert one(plain, "mass", f"at least {mass} kg").passed
    assert not one(stage, "mass", f"at most {mass * 0.999} kg").passed
    assert one(stage, "opening", "at most 0 mm").passed


def test_a_kind_of_measure_is_one_in_all_processes(stage):
    """What is sent to another process is the same kind there, which code compares by identity."""
    for form in MEASURES:
        kind = MEASURES.get(form)
        assert pickle.loads(pickle.dumps(kind)) is kind  # noqa: S301 (our own)
        assert kind.form == form
        assert kind.meaning


def test_a_stroke_is_the_least_of_its_pieces(stage):
    """Each actuator's share in a stroke against the strokes along single axes."""
    bench = bench_of(stage)
    single = single_axis(bench.lost.correction, bench.limits)
    for name, value in zip(single.coordinates, single.symmetric, strict=True):
        assert stroke.value(bench, Measure(f"stroke.{name}", stroke, name, stroke.quantity)) == value


def test_what_the_stage_cannot_answer_fails_with_a_reason(stage):
    brittle = replace(stage, materials={"steel": replace(stage.materials["steel"], yield_stress=None)})
    found = one(brittle, "safety", "at least 2")
    assert found.value is None
    assert not found.passed
    assert "has no stress limit" in found.reason
    planar = case("xy-stage")
    assert "not an ideal motion" in one(planar, "stroke.z", "at least 1 um").reason
    assert "does not determine" in one(case("xy-stage-floating"), "stroke.x", "at least 1 um").reason
    assert "mode number too high" in one(stage, "frequency.platform.900", "at least 1 Hz").reason
    assert "required strokes missing" in one(stage, "corner", "at most 1").reason


def test_points_of_interest_count():
    """A stroke about the sample, and its stiffness: other numbers than at the platform's reference."""
    stage = case("hexapod")
    for key in ("stroke.rx", "stiffness.x", "resolution.x", "drift.z"):
        unit = {"stroke.rx": "urad", "stiffness.x": "N/um", "resolution.x": "nm", "drift.z": "nm/K"}[key]
        here, there = (one(stage, key, f"at least 1 {unit}{where}").value for where in ("", " at sample"))
        assert here != pytest.approx(there, rel=1e-4), key


def test_a_batch_is_judged_design_by_design():
    """Two head radii at once: a verdict each."""
    radii = np.array([0.05, 0.06])
    together = replace(case("hexapod", {"head_radius": radii}), requirements={"stroke.rz": "at least 500 urad", "safety": "at least 2"})
    for verdict in judge(together):
        assert verdict.passed.shape == (2,)
        for index, radius in enumerate(radii):
            alone = replace(
                case("hexapod", {"head_radius": float(radius)}), requirements={verdict.requirement.key: verdict.requirement.text}
            )
            assert verdict.value[index] == pytest.approx(float(judge(alone)[0].value), rel=1e-6)


def test_only_what_is_asked_is_worked_out(stage, monkeypatch):
    """A line about the mass reads no stage."""
    from flexstage.analysis import bench

    def refused(*_):
        raise AssertionError("worked out for nothing")

    for name in ("standing", "drawn", "kinematics", "modes", "lost_motion", "hinge_stress", "drift"):
        monkeypatch.setattr(bench, name, refused)
    assert judge(replace(stage, requirements={"mass": "at most 14 kg"}))[0].passed


@pytest.mark.parametrize(
    ("lines", "factor"),
    [({"buckling.factor": 1.5, "buckling": 3, "safety": 9}, 3.0), ({"safety": 2.5}, 2.5), ({}, 1.0)],
)
def test_a_factor_is_asked_for_by_the_hardest_line_on_buckling_else_by_safety(lines: dict[str, float], factor: float) -> None:
    asked = {key: f"at least {value}" for key, value in lines.items()}
    assert asked_factor(replace(case("parallelogram"), requirements=asked)) == factor
