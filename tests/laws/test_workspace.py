"""Workspace: strokes end where an actuator does, corners are worst, forces obey reciprocity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import flexstage as fs
from flexstage.analysis.workspace.blocking import platform_lines, stack_lines
from flexstage.analysis.workspace.gauging import gauge_inverse, gauge_range, pose_resolution
from flexstage.analysis.workspace.load import load_share
from flexstage.analysis.workspace.map_error import linear_map_error, map_error_at
from flexstage.analysis.workspace.polytope import reachable
from flexstage.analysis.workspace.strength import hinge_stress
from flexstage.analysis.workspace.stroke import StrokeLimits, mapping_at, single_axis, stroke_limits, utilisation
from flexstage.analysis.workspace.wrench import dead_wrenches
from flexstage.base.finding import DesignError
from flexstage.base.labelled import Matrix
from flexstage.beams.stress import stress
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar
from flexstage.mechanism.mechanism import Force
from flexstage.models.linear.static import static_gain
from flexstage.parts.body import Payload
from flexstage.spatial.frame import COMPONENTS, FORCES
from tests.conftest import examples
from tests.laws.shared import ideal, lumped
from tests.laws.strategies import actuated_platforms, mechanisms, moved, turns

seeds = st.integers(0, 2**32 - 1)
names = tuple("abcdefgh")


@st.composite
def maps(draw, most=8):
    """A random full-rank mapping from one to six coordinates to as many strokes or up to two more, and uneven limits."""
    size = draw(st.integers(1, 6))
    count = min(most, size + draw(st.integers(0, 2)))
    random = np.random.default_rng(draw(seeds))
    mapping = random.normal(size=(count, size)) + np.eye(count, size) * 3.0
    limits = StrokeLimits(names[:count], -random.uniform(0.5, 1.0, count), random.uniform(0.5, 1.0, count))
    return Matrix(mapping, names[:count], COMPONENTS[:size], "1"), limits


@given(maps())
def test_single_strokes_end_at_an_actuators_end(drawn):
    mapping, limits = drawn
    found = single_axis(mapping, limits)
    for index, name in enumerate(mapping.columns):
        for end in (found.low[index], found.high[index]):
            strokes = mapping.values[:, index] * end
            used = np.maximum(strokes / limits.high, strokes / limits.low)
            np.testing.assert_allclose(np.max(used), 1.0, rtol=1e-12)
        strokes = mapping.values[:, index] * min(found.low[index], found.high[index], key=abs)  # the symmetric stroke
        row = mapping.rows.index(found.limiting[index])
        edge = limits.high[row] if strokes[row] > 0.0 else limits.low[row]
        np.testing.assert_allclose(strokes[row], edge, rtol=1e-9), name


@examples(20)
@given(maps(), seeds)
def test_polytope_is_what_its_half_spaces_say(drawn, seed):
    mapping, limits = drawn
    found = reachable(mapping, limits)
    strokes = found.vertices @ mapping.values.T
    slack = np.minimum(limits.high - strokes, strokes - limits.low)
    assert np.all(slack > -1e-9)
    assert np.all(np.sum(slack < 1e-9, axis=1) >= len(mapping.columns))
    assert np.all(found.contains(found.vertices))
    random = np.random.default_rng(seed)
    weights = random.dirichlet(np.ones(len(found.vertices)), 20)
    assert np.all(found.contains(weights @ found.vertices))
    far = found.vertices * 1.001
    assert not np.any(found.contains(far))
    poses = random.uniform(*found.extent.values.T, (50, len(mapping.columns)))
    inside = [np.all(limits.low <= mapping.values @ pose) and np.all(mapping.values @ pose <= limits.high) for pose in poses]
    np.testing.assert_array_equal(found.contains(poses), inside)


@examples(10)
@given(maps(most=6))
def test_polytope_volume_and_extent_by_both_methods(drawn):
    """As many strokes as coordinates: the parallelotope's formula against crossings of faces with one stroke stated twice."""
    mapping, limits = drawn
    size = len(mapping.columns)
    square = Matrix(mapping.values[:size], names[:size], mapping.columns, "1")
    own = StrokeLimits(names[:size], limits.low[:size], limits.high[:size])
    twice = Matrix(np.concatenate([square.values, square.values[:1]]), names[: size + 1], mapping.columns, "1")
    wide = StrokeLimits(names[: size + 1], np.append(own.low, 2.0 * own.low[0]), np.append(own.high, 2.0 * own.high[0]))
    first, second = reachable(square, own), reachable(twice, wide)
    np.testing.assert_allclose(second.volume, first.volume, rtol=1e-9)
    np.testing.assert_allclose(second.extent.values, first.extent.values, rtol=1e-9)


@given(maps(), seeds)
def test_utilisation_is_the_worst_corner(drawn, seed):
    mapping, limits = drawn
    half = np.random.default_rng(seed).uniform(0.0, 1.0, len(mapping.columns))
    found = utilisation(mapping, limits, dict(zip(mapping.columns, half, strict=True)))
    count = len(half)
    signs = 2.0 * ((np.arange(2**count)[:, None] >> np.arange(count)) & 1) - 1.0
    np.testing.assert_allclose(found.demand, np.max(np.abs(signs * half @ mapping.values.T), axis=0), rtol=1e-12)
    polytope = reachable(mapping, limits)
    corners = signs * half * found.scale
    mirrored = replace_limits(limits)
    assert np.all(reachable(mapping, mirrored).contains(corners * (1.0 - 1e-12)))
    assert np.all(polytope.contains(corners * (1.0 - 1e-12)))


def test_an_actuator_biased_at_its_end_is_used_not_at_all_or_beyond_its_range():
    mapping = Matrix(np.diag([1.0, 1.0]), ("A", "B"), ("x", "y"), "1")
    limits = StrokeLimits(("A", "B"), np.array([0.0, -1e-6]), np.array([2e-6, 1e-6]))
    assert utilisation(mapping, limits, {"x": 0.0, "y": 5e-7}).ratio.tolist() == [0.0, 0.5]
    beyond = utilisation(mapping, limits, {"x": 1e-9, "y": 0.0})
    assert (beyond.ratio.tolist(), bool(beyond.reachable), float(beyond.scale)) == ([np.inf, 0.0], False, 0.0)


def replace_limits(limits):
    least = np.minimum(-limits.low, limits.high)
    return StrokeLimits(limits.actuators, -least, least)


@given(actuated_platforms())
def test_stack_forces_under_load_are_the_gains_transposed(mechanism):
    """Maxwell and Betti: the tension a unit wrench puts on a held stack is the motion its unit stroke gives, k e^T G K^-1 = (K^-1 B)^T."""
    model = lumped(mechanism)
    found = load_share(mechanism, model)
    motion = static_gain(model, tuple(f"platform.{name}" for name in COMPONENTS), found.actuators).values
    np.testing.assert_allclose(-found.share.values, motion.T, rtol=0.0, atol=1e-9 * np.max(np.abs(motion)))
    stroke = found.stroke.values
    np.testing.assert_allclose(stroke, stroke.T, rtol=0.0, atol=1e-8 * np.max(np.abs(stroke)))


@given(actuated_platforms(), seeds)
def test_forces_of_the_description_act_as_wrenches_do(mechanism, seed):
    random = np.random.default_rng(seed)
    force, at = tuple(random.normal(size=3)), tuple(0.1 * random.normal(size=3))
    loaded = replace(mechanism, forces={"push": Force("platform", at, force)})
    found = load_share(loaded, lumped(loaded))
    push = found.loads.columns.index("push")
    scale = np.max(np.abs(found.share.values))
    np.testing.assert_allclose(found.loads.values[:, push], found.under(np.array(force), np.array(at)), rtol=0.0, atol=1e-9 * scale)


@examples(12)
@given(actuated_platforms(), seeds)
def test_an_eccentric_payload_is_its_weight_at_its_place(mechanism, seed):
    random = np.random.default_rng(seed)
    mass, at = random.uniform(0.1, 5.0), tuple(0.1 * random.normal(size=3))
    loaded = replace(mechanism, payloads={"wafer": Payload("platform", mass, at)})
    bare, found = load_share(mechanism, lumped(mechanism)), load_share(loaded, lumped(loaded))
    assert found.loads.columns == ("own weight", "payload wafer")
    weight = bare.under(mass * np.array(mechanism.gravity), np.array(at))
    scale = mass * 10.0 * np.max(np.abs(bare.share.values))
    np.testing.assert_allclose(found.loads.values[:, 1], weight, rtol=0.0, atol=1e-9 * scale)
    np.testing.assert_allclose(
        found.loads.values[:, 0], bare.loads.values[:, 0], rtol=0.0, atol=1e-9 * (scale + np.max(np.abs(bare.compression)))
    )


@examples(12)
@given(actuated_platforms(), seeds)
def test_no_stroke_inside_the_box_stresses_more_than_its_corners(mechanism, seed):
    model, limits, assembly = lumped(mechanism), stroke_limits(mechanism), expand(mechanism)
    found = hinge_stress(replace(mechanism, gravity=(0.0, 0.0, 0.0)), model, limits)
    strokes = np.random.default_rng(seed).uniform(limits.low, limits.high, (8, len(limits.actuators)))
    for link, nominal in zip(found.links, found.nominal, strict=True):
        gain = static_gain(model, tuple(f"{link}.{name}" for name in FORCES), limits.actuators).values
        inside = stress(assembly.links[link].part, assembly.links[link].material, strokes @ gain.T)
        assert np.all(inside.nominal <= nominal * (1.0 + 1e-9))


@given(actuated_platforms())
def test_lines_of_force_and_stroke_cross(mechanism):
    model, kinematics = lumped(mechanism), ideal(mechanism)
    stacks = stack_lines(mechanism, model)
    np.testing.assert_allclose(stacks.force, stacks.stage_stiffness * stacks.travel, rtol=1e-6, atol=1e-6 * np.max(stacks.blocking))
    np.testing.assert_allclose(
        stacks.force, stacks.stiffness * (stacks.free - stacks.travel), rtol=1e-6, atol=1e-6 * np.max(stacks.blocking)
    )
    assert np.all(stacks.stage_stiffness > -1e-6 * stacks.stiffness)
    lines = platform_lines(kinematics.mapping, model, stroke_limits(mechanism))
    np.testing.assert_allclose(lines.blocking, lines.travel * lines.stiffness)


@given(actuated_platforms())
def test_gauge_inverse_returns_the_motion(mechanism):
    """S R_s V = V wherever the gauges see every motion; else it is refused."""
    kinematics = ideal(mechanism)
    scale = np.array([1.0 / kinematics.length if name.startswith("r") else 1.0 for name in kinematics.coordinates])
    seen = kinematics.sensing @ kinematics.motion * scale
    try:
        inverse = gauge_inverse(kinematics).values
    except DesignError:
        assert np.linalg.matrix_rank(seen, tol=1e-9) < kinematics.mobility
        return
    back = inverse @ kinematics.sensing @ kinematics.motion
    error = 1e-13 * np.linalg.cond(seen) / kinematics.length
    np.testing.assert_allclose(back, kinematics.motion, rtol=0.0, atol=error)
    found = pose_resolution(mechanism, kinematics)
    assert np.all(found.rms <= found.worst * (1.0 + 1e-12))


@examples(12)
@given(actuated_platforms(), seeds)
def test_gauge_swing_is_the_worst_corner_and_the_radius_its_limit(mechanism, seed):
    kinematics = ideal(mechanism)
    command = dict(zip(kinematics.coordinates, np.random.default_rng(seed).uniform(1e-6, 1e-4, kinematics.mobility), strict=True))
    found = gauge_range(mechanism, kinematics, command)
    count = len(command)
    signs = 2.0 * ((np.arange(2**count)[:, None] >> np.arange(count)) & 1) - 1.0
    readings = (signs * np.array(list(command.values()))) @ (kinematics.sensing @ kinematics.motion).T
    np.testing.assert_allclose(found.swing, np.max(np.abs(readings), axis=0), rtol=1e-9, atol=1e-18)
    for swing, limit, radius, here in zip(found.swing, found.limit, found.radius, found.largest_here, strict=True):
        if np.isfinite(here):
            assert (radius <= here * (1.0 + 1e-9)) == (swing <= limit * (1.0 + 1e-9)) or here == 0.0
        elif np.isinf(here):
            assert swing <= limit * (1.0 + 1e-9)
    worst, here = (np.nan_to_num(radii, nan=-1.0) for radii in (found.largest_anywhere, found.largest_here))
    assert np.all(worst - here <= 1e-9 * np.abs(here))


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_a_gauge_above_the_reference_at_its_largest_radius_reads_half_its_range(turn):
    """Tilts move a gauge 75 mm above the reference also by this height; a ring of gauges at the least radius reads no more at any angle."""
    stage = case("double-triangle")
    command = {"x": 2e-5, "y": 3e-5, "z": 5e-5, "rx": 4e-4, "ry": 7e-4, "rz": 6e-4}

    def ranged(radius, first, names):
        ring = replace(stage.gauges["S1-S3"], pattern=Polar(radius, first, InstanceOrientation.TANGENT, height=0.18, turn=turn))
        placed = replace(stage, gauges={names: ring}, requirements={})
        return gauge_range(placed, ideal(placed), command)

    for first in (0.3, 2.0):
        found = ranged(0.1, first, "S1-S1")
        assert ranged(found.largest_here[0], first, "S1-S1").swing == pytest.approx(found.limit, rel=1e-9)
    assert np.max(ranged(found.largest_anywhere[0], 0.0, "S1-S72").swing) == pytest.approx(found.limit[0], rel=1e-3)


@given(actuated_platforms(), turns())
def test_strokes_along_z_do_not_depend_on_where_the_stage_stands(mechanism, move):
    """A stage shifted only: the same strokes per motion of the platform's reference, and of any point."""
    _, shift = move
    kinematics = ideal(mechanism)
    there = moved(mechanism, np.eye(3), shift)
    first = mapping_at(mechanism, kinematics)
    second = mapping_at(there, ideal(there))
    assert first.columns == second.columns
    np.testing.assert_allclose(second.values, first.values, rtol=0.0, atol=1e-9 * np.max(np.abs(first.values)))


@pytest.mark.parametrize("name", ["double-triangle", "hexapod", "bridge", "tip-tilt", "tip-tilt-four", "xy-stage"])
def test_map_error_is_worst_where_it_says(name):
    """Finite kinematics at the named strokes errs by the worst value; random strokes within the limits err no more."""
    stage = case(name)
    kinematics, limits = ideal(stage), stroke_limits(stage)
    found = linear_map_error(stage, kinematics, limits)
    there = map_error_at(stage, kinematics, found.worst_strokes)
    np.testing.assert_allclose(np.abs(np.diagonal(there.errors)), found.worst, rtol=1e-6, atol=1e-15)
    assert np.all(np.abs(there.errors) <= found.worst * (1.0 + 1e-6) + 1e-15)
    polytope = reachable(kinematics.mapping, limits)
    weights = np.random.default_rng(5).dirichlet(np.ones(len(polytope.vertices)), 40)
    inside = map_error_at(stage, kinematics, weights @ polytope.vertices @ kinematics.mapping.values.T)
    assert np.all(inside.worst <= found.worst + 1e-12)


@examples(12)
@given(mechanisms())
def test_weight_is_carried(mechanism):
    """Gravity turned round turns all dead loads round; twice the weight doubles them."""
    model = lumped(mechanism)
    found = load_share(mechanism, model).compression
    upside = load_share(replace(mechanism, gravity=tuple(-2.0 * part for part in mechanism.gravity)), model).compression
    np.testing.assert_allclose(upside, -2.0 * found, rtol=1e-9, atol=1e-9 * np.max(np.abs(found)))


@pytest.mark.parametrize("gravity", [10.0, -10.0])
def test_wrenches_of_links_are_positive_in_tension(gravity: float) -> None:
    """1 kg above a rod on the ground, pulled up or pressed down by its weight."""
    stage = fs.Mechanism(
        "column",
        materials={"steel": fs.Material(young=200e9, poisson=0.3, density=0.0)},
        parts={"rod": fs.Rod("steel", 0.05, 2e-3)},
        bodies={"platform": fs.Body(mass=1.0, centre=(0.0, 0.0, 0.05), inertia=fs.Inertia(1e-3, 1e-3, 1e-3), reference=(0.0, 0.0, 0.05))},
        links={"rod": fs.Link(("ground", "platform"), "rod", (0.0, 0.0, 0.025), fs.Z, bends=fs.X)},
        gravity=(0.0, 0.0, gravity),
    )
    assert dead_wrenches(stage, fs.lumped(stage), ("rod.fx",)) == pytest.approx(gravity)
