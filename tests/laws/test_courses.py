"""Laws of what viewers play away from the drawn position: true centre lines, small motions about states, ends that do not gape."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.loaded.load_cases import REST, CaseFactor, CaseFactors, LoadCase, buckling_factors
from flexstage.models.nonlinear.graph import assemble
from flexstage.models.nonlinear.lines import centre_lines, critical_motion, mode_motions
from flexstage.models.nonlinear.paths.load_path import LoadPath
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.show.displaced import along_table, buckling_report, stroke_report
from flexstage.show.table import matrix_table
from flexstage.show.viewer.animation import NODES, stroke_data
from flexstage.spatial.rotation import exponential, logarithm

STAGE = fs.case("parallelogram")


@pytest.fixture(scope="module")
def model() -> Nonlinear:
    return fs.nonlinear(STAGE)


@pytest.fixture(scope="module")
def course(model: Nonlinear) -> LoadPath:
    return fs.load_path(model, "platform.x", np.linspace(-1e-4, 5e-4, 4))


def test_what_is_lost_over_a_short_stroke_is_lost_motion(model: Nonlinear, course: LoadPath) -> None:
    """And nothing is told where there is no stroke, or where no stack drives."""
    found = fs.stroke(fs.load_path(model, "B", np.array([0.0, 1e-9]), weight=0.0), kinematics=fs.ideal(STAGE))
    lost = found.along.values[:, found.along.columns.index("lost")]
    assert np.isnan(lost[0])
    assert lost[1] == pytest.approx(
        float(fs.lost_motion(fs.ideal(STAGE), fs.lumped(STAGE)).loss.at("B", "B")), rel=3e-3
    )  # leaves bend as plates
    assert "lost" not in fs.stroke(course, kinematics=fs.ideal(STAGE)).along.columns


@pytest.mark.parametrize("name", ["left", "B/front"])
def test_centre_lines_are_those_of_the_flexures(model: Nonlinear, course: LoadPath, name: str) -> None:
    """They begin and end on their bodies without a gap, and their slope is that of the sections but for shear and stretch."""
    line = centre_lines(course.state)[name]
    drawn = model.assembly.links[name].frame
    group = next(each for each in model.flexures if name in each.names)
    length = float(group.law.length[group.names.index(name)])
    bent = assemble(model, course.state.pose, course.state.loads, course.state.hold).bent[model.flexures.index(group)]
    place = group.names.index(name)
    end = line.place[:, 0] + length * (bent.frame[place] @ bent.lies.end[place][..., None])[..., 0]
    np.testing.assert_allclose(line.place[:, -1], end, rtol=0.0, atol=1e-9 * length)
    slope = np.gradient(line.place, line.shares * length, axis=1)[:, 3:-3]
    axis = (line.turn @ drawn.rotation[:, 0])[:, 3:-3]
    np.testing.assert_allclose(slope / np.linalg.norm(slope, axis=-1)[..., None], axis, atol=2e-3)


def test_small_motions_are_differences_of_states(model: Nonlinear) -> None:
    """Bodies and centre lines move by a small force as the linear model about the state says."""
    loads, step = {"platform.fx": 800.0, "platform.fy": 50.0}, 1e-2
    state = fs.equilibrium(model, loads)
    about = fs.linearise(state)
    push = about.input_matrix[:, about.input_index(("platform.fx",))]
    told = mode_motions(state, np.linalg.solve(about.stiffness_matrix, push))
    near, far = (centre_lines(fs.equilibrium(model, {**loads, "platform.fx": 800.0 + each})) for each in (-step, step))
    for name, moved in told.lines.items():
        shift = (far[name].place - near[name].place)[0] / (2.0 * step)
        turn = logarithm(far[name].turn @ np.swapaxes(near[name].turn, -1, -2))[0] / (2.0 * step)
        size = np.max(np.abs(moved), axis=(0, 1))
        np.testing.assert_allclose(moved[0, :, :3], shift, rtol=0.0, atol=1e-4 * np.max(size[:3]))
        np.testing.assert_allclose(moved[0, :, 3:], turn, rtol=0.0, atol=1e-4 * np.max(size[3:]))


def test_poses_do_not_gape(course: LoadPath) -> None:
    """The first and the last node of all that bends move with their bodies, at every frame, and nodes of nothing else are told."""
    data = stroke_data(STAGE, course, fs.stroke(course))
    path = data.motions[0]
    assert path.course is not None
    bending = [number for number, (one, other) in enumerate(data.mesh.bodies) if one != other]
    assert path.course.poses.shape == (4, len(data.bodies) + NODES * len(bending), 6)
    references = [np.zeros(3), *data.bones.references.values()]
    for frame in path.course.poses:
        for place, carrier in enumerate(bending):
            start = len(data.bodies) + NODES * place
            for side, row in ((0, start), (1, start + NODES - 1)):
                body, point = int(data.mesh.bodies[carrier, side]), data.mesh.ends[carrier, side]
                arm = point - references[body]
                moved = frame[body, :3] + exponential(frame[body, 3:]) @ arm - arm
                np.testing.assert_allclose(frame[row, :3], moved, atol=2e-8)  # points are told in single precision
                np.testing.assert_allclose(frame[row, 3:], frame[body, 3:], atol=1e-12)


@pytest.mark.full
def test_what_gives_way_bends_as_the_flexures_follow(model: Nonlinear) -> None:
    """The ends of centre lines move with the shape's bodies."""
    found = fs.critical_load(model, {"platform.fy": 10e3}, tolerance=1e-3)
    moved = critical_motion(found)
    np.testing.assert_allclose(moved.bodies[0], found.shape)
    number = found.bodies.index("platform")
    arm = centre_lines(found.state)["left"].place[0, -1] - found.state.pose.position[0, number]
    twist = found.shape[number]
    end = moved.lines["left"][0, -1]
    np.testing.assert_allclose(end, [*(twist[:3] + np.cross(twist[3:], arm)), *twist[3:]], atol=1e-12 * np.max(np.abs(twist)))
    whole = buckling_factors(STAGE, [LoadCase("platform.fy=10 kN", REST, {"platform.fy": 10e3})])
    assert len(buckling_report(STAGE, whole)) < 2e6


def test_reports_are_small_and_the_same_again(course: LoadPath) -> None:
    """A report of a stroke stands alone in less than 2 MB, names what is beyond a limit, and has the same bytes again."""
    found = fs.stroke(course)
    told = stroke_report(STAGE, course, found)
    assert len(told) < 2e6
    assert told == stroke_report(STAGE, course, found)
    assert "MPa, limit " in told


def test_points_stand_in_columns_of_one_unit(course: LoadPath) -> None:
    """Numbers of the table are those of the course in the units above them; what is not known has no unit."""
    found = fs.stroke(course)
    gone = replace(found.along, values=np.where(np.arange(len(found.along.rows))[:, None] == 1, np.nan, found.along.values))
    heads, *rows = along_table("Along", gone).texts()
    told = dict(zip(heads, zip(*rows, strict=True), strict=True))
    stress = told["stress [MPa]"]
    known = np.delete(found.along.values[:, found.along.columns.index("stress")], 1)
    np.testing.assert_allclose([float(each) for each in np.delete(stress, 1)], 1e-6 * known, rtol=1e-3)
    assert stress[1] == "-"
    assert "strain [um/m]" in told
    assert set(matrix_table("Points", gone).texts()[2][1:]) == {"-"}


def test_a_report_does_not_count_unknown_load_cases_as_stable() -> None:
    """Of two load cases, one is stable, and the other has no equilibrium at its operating point."""
    stable = CaseFactor("weight", REST, np.inf, "", "", "stable", 1e12)
    unknown = CaseFactor("weight", "platform.x = 5 mm", np.nan, "", "", "no equilibrium found")
    page = buckling_report(STAGE, CaseFactors((stable, unknown), 1.0, ""))
    assert '<p class="headline fail">no buckling in 1 of 2 load cases and stroke ends</p>' in page
