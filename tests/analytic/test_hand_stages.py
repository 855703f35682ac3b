"""Four stages against closed forms: stiffness, frequency, loss, stress at the required strokes, coupling; and every command on them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import bench_of, measure_all
from flexstage.analysis.assessment.requirements import measure
from flexstage.analysis.loaded.stroke import stroke
from flexstage.models.nonlinear.paths.load_path import load_path
from flexstage.models.nonlinear.stage import nonlinear
from tests.analytic.hand_stages import STAGES
from tests.apps.command import command_in

HAND = 0.017
"""Accuracy of the closed forms."""


def weightless(name):
    return replace(fs.loads(STAGES[name]), gravity=(0.0, 0.0, 0.0))


def measured(stage, *keys):
    return [float(each) for each in measure_all(stage, tuple(measure(stage, key, "here") for key in keys))]


def test_xy_of_double_parallelograms():
    """k = 48 E I / L^3 and, of each leaf half of the stroke d, 3 E t (d/2) / L^2."""
    young, thick, length = 70e9, 0.6e-3, 50e-3
    stage = weightless("xy")
    assert measured(stage, "stiffness.x") == pytest.approx([48.0 * young * 25e-3 * thick**3 / 12.0 / length**3], rel=HAND)
    bench = bench_of(stage)
    bench.command = {"x": 5e-3}
    assert np.max(bench.stress_at_strokes.peak) == pytest.approx(3.0 * young * thick * 2.5e-3 / length**2, rel=HAND)


def test_butterfly_pivot():
    """K = 2 E I (1 + 3 p + 3 p^2) / L; the intermediate bodies turn by a quarter, half and three quarters of the platform's angle."""
    young, inertia, length, p = 114e9, 10e-3 * 0.2e-3**3 / 12.0, 20e-3, 0.25
    stiffness = 2.0 * young * inertia * (1.0 + 3.0 * p + 3.0 * p * p) / length
    turning = 1e-4 + 1e-5 / 16.0 + 1e-7 / 4.0 + 9e-5 / 16.0
    found = measured(weightless("butterfly"), "stiffness.rz", "frequency.platform.1", "safety.at_strokes")
    assert found[0] == pytest.approx(stiffness, rel=HAND)
    assert found[1] == pytest.approx(math.sqrt(stiffness / turning) / (2.0 * math.pi), rel=HAND)
    each = math.radians(5.0) / 4.0  # both leaves of a pivot bend by M = E I (4 + 6 p) / L at the far end from their crossing
    assert 830e6 / found[2] == pytest.approx(young * 0.2e-3 / 2.0 * (4.0 + 6.0 * p) / length * each, rel=HAND)


def test_cube_of_three_legs():
    """The stack beside four leaves, in series with four wires, beside the eight wires of the other legs."""
    young = 200e9
    leaves = 4 * 12.0 * young * 12e-3 * 0.4e-3**3 / 12.0 / 20e-3**3
    wires, across = 4 * young * math.pi / 4e6 / 25e-3, 8 * 12.0 * young * math.pi / 64e12 / 25e-3**3
    stack = 50e6
    stiffness = (stack + leaves) * wires / (stack + leaves + wires) + across
    gain = stack * wires / (stack + leaves + wires) / stiffness
    found = measured(weightless("cube"), "stiffness.x", "loss", "stroke.x")
    assert found[0] == pytest.approx(stiffness, rel=HAND)
    assert found[1] == pytest.approx(1.0 - gain, rel=HAND)
    assert found[2] == pytest.approx(19e-6 * gain, rel=HAND)


def test_roberts_linkage():
    """k = 10 K / (2 h)^2 with the simplified notch of Paros and Weisbord; its platform turns by x / (2 h)."""
    notch = 2.0 * 200e9 * 10e-3 * 0.4e-3**2.5 / (9.0 * math.pi * math.sqrt(3e-3))
    stage = weightless("roberts")
    assert measured(stage, "stiffness.x") == pytest.approx([10.0 * notch / 80e-3**2], rel=HAND)
    compliance = fs.statics(fs.lumped(stage)).compliance
    assert compliance.at("platform.rz", "platform.fx") / compliance.at("platform.x", "platform.fx") == pytest.approx(12.5, rel=1e-3)


@pytest.mark.parametrize("name", ["xy", "butterfly"])
def test_stress_at_a_small_stroke_is_that_of_the_path_to_it(name):
    """Of every leaf that the linear stress of the worst corner bends, at an actuator's force that brings the platform there."""
    stage = weightless(name)
    bench = bench_of(stage)
    axis, size = {"xy": ("x", 1e-6), "butterfly": ("rz", 1e-5)}[name]
    bench.command = {axis: size}
    known, inputs = bench.stress_at_strokes, bench.force_workspace("platform").per_motion
    driven = inputs.rows[0]
    along = stroke(load_path(nonlinear(stage), driven, np.array([0.0, float(inputs.at(driven, axis)) * size])))
    assert along.along.at("2", f"platform.{axis}") == pytest.approx(size, rel=1e-3)
    at_end = dict(zip(along.strained.names, along.strained.stress[1], strict=True))
    np.testing.assert_allclose(known.nominal, [at_end[link] for link in known.links], rtol=1e-3, atol=1e-3 * np.max(known.nominal))


def test_stress_at_strokes_is_that_of_all_strokes_where_these_are_required():
    """A piezo stage: the box of the strokes that its actuators reach, about the bias."""
    stage = fs.loads(STAGES["cube"])
    bench = bench_of(stage)
    reach = bench.lost.transfer.values @ np.ones(3) * 19e-6
    bench.command = dict(zip("xyz", reach, strict=True))
    np.testing.assert_allclose(bench.stress_at_strokes.nominal, bench.stress.nominal, rtol=1e-4)
    bench = bench_of(replace(stage, requirements={}))
    with pytest.raises(fs.DesignError, match="required strokes missing"):
        _ = bench.stress_at_strokes


def test_stress_names_hinge_end_and_faces():
    analysis = fs.analyse(fs.loads(STAGES["butterfly"]), whole=False)
    assert analysis.stress is not None
    assert {each.rpartition(", ")[2] for each in analysis.stress.places} == {"faces +-y"}
    assert analysis.stress.places[analysis.stress.links.index("a1")].startswith("ground end")  # near its crossing
    loose = fs.analyse(replace(fs.loads(STAGES["butterfly"]), requirements={}), whole=False)
    assert loose.stress is not None
    assert "limits in short use" in loose.stress.condition
    np.testing.assert_allclose(loose.stress.worst_strokes.values, np.sign(loose.stress.strokes) * 2.0)
    assert loose.stress.worst_strokes.unit[0] == ("A",)


def test_drive_force_of_a_compliant_coupling():
    """A coil on a carriage (guide c), a coupling b, the platform (guide p): F / x = p + c (1 + p / b); the ideal guide has p + c."""
    p, c, b, stiff = 3e4, 5e4, 1e6, 1e9
    across = (stiff, stiff, 1e7, 1e7, 1e7)
    parts = {
        "coil": fs.VoiceCoil(force_constant=10.0),
        "p": fs.Spring(diagonal=(p, *across), free=(fs.Freedom.X,)),
        "c": fs.Spring(diagonal=(c, *across), free=(fs.Freedom.X,)),
        "b": fs.Spring(diagonal=(b, *across), free=()),
    }
    joins = {"p": ("ground", "platform"), "c": ("ground", "carriage"), "b": ("carriage", "platform"), "coil": ("ground", "carriage")}
    links = {name: fs.Link(each, name, (0.0, 0.0, 0.0), fs.X) for name, each in joins.items()}
    bodies = {name: fs.Body(mass=1.0, centre=(0.0, 0.0, 0.0), inertia=fs.Inertia(1e-3, 1e-3, 1e-3)) for name in ("platform", "carriage")}
    stage = fs.Mechanism("coupled", parts=parts, bodies=bodies, links=links, gravity=(0.0, 0.0, 0.0))
    found = fs.analyse(stage, whole=False).drive_force
    assert found is not None
    np.testing.assert_allclose(found.force.values, [[p + c * (1.0 + p / b), p + c]], rtol=1e-9)
    np.testing.assert_allclose(found.total, [c * p / b / (p + c)], rtol=1e-7)
    by_hand = {"p": p * (b + c), "c": c * (b + p), "b": -c * p}
    for name, share in by_hand.items():
        assert found.shares.at(name, "x") == pytest.approx(share / sum(by_hand.values()), rel=1e-6)


@pytest.mark.parametrize("name", ["xy", "butterfly", "roberts"])
def test_drive_force_is_shared_by_the_flexures_that_bend(name):
    """Equal leaves take equal shares; of the Roberts linkage the upper notches, which turn twice as far, take four times as much."""
    found = fs.analyse(weightless(name), whole=False).drive_force
    assert found is not None
    own = np.sort(np.abs(found.shares.values[:, 0]))[::-1]
    by_hand = {"xy": [1.0 / 16.0] * 16, "butterfly": [0.125] * 8, "roberts": [0.4, 0.4, 0.1, 0.1]}[name]
    np.testing.assert_allclose(own[: len(by_hand)], by_hand, rtol=2e-3)
    assert np.all(np.abs(found.total) < 2e-3)


@pytest.mark.full
@pytest.mark.parametrize("name", list(STAGES))
def test_commands_take_the_stage(name, tmp_path, monkeypatch, capfdbinary):
    """From `check` to the report, without a refusal."""
    run = command_in(tmp_path, monkeypatch, capfdbinary)
    (tmp_path / "stage.toml").write_text(STAGES[name])
    for words in ("check", "analyse --full --report r.html --json r.json", "lost-motion", "modes", "response", "workspace", "stroke"):
        ended = run(*words.split(), "stage.toml", *(["--drive", "platform.rz"] if (words, name) == ("stroke", "butterfly") else []))
        assert ended.code == 0, f"{words}: {ended.err}"
