"""Workspace results that a hand can check: Euler's column, a guided leaf, a stack against a spring, discs and rectangles in plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import judge
from flexstage.analysis.caveats import caveats
from flexstage.analysis.workspace.blocking import platform_lines, stack_lines
from flexstage.analysis.workspace.buckling import Ends, buckling
from flexstage.analysis.workspace.clearance import clearance
from flexstage.analysis.workspace.drive import drive
from flexstage.analysis.workspace.gauging import _pseudo_inverse
from flexstage.analysis.workspace.load import load_share
from flexstage.analysis.workspace.map_error import linear_map_error
from flexstage.analysis.workspace.small import SmallMotion, small_motion
from flexstage.analysis.workspace.strength import hinge_stress
from flexstage.analysis.workspace.stroke import StrokeLimits, mapping_at, single_axis, stroke_limits
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import CASES
from flexstage.mechanism.assembly.expand import expand
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
STEEL = fs.Material(young=200e9, poisson=0.3, density=7750.0, yield_stress=1e9)
STACK = fs.Piezo(
    stroke=20e-6,
    stiffness=50e6,
    length=0.02,
    diameter=0.01,
    maximum_load=2000.0,
    tensile_limit=100.0,
    preload=200.0,
    voltage_low=-30.0,
    voltage_high=150.0,
    bias=30.0,
    capacitance=2e-6,
)


def guide(stack=STACK, leaf=None, **fields):
    """A platform on two upright leaves, pushed along x by a stack with a rod as its coupling."""
    leaf = leaf or fs.Leaf("steel", 0.05, 0.0005, 0.002)
    return fs.Mechanism(
        name="guide",
        materials={"steel": STEEL},
        parts={"leaf": leaf, "stack": stack, "rod": fs.Rod("steel", 0.02, 0.001)},
        bodies={"platform": fs.Body(mass=1.0, centre=(0.0, 0.0, 0.0), points={"tip": (0.0, 0.0, 0.1)}), "tip": fs.Body()},
        links={
            "left": fs.Link(("ground", "platform"), "leaf", (-0.03, -0.025, 0.0), Y, bends=Z),
            "right": fs.Link(("ground", "platform"), "leaf", (0.03, -0.025, 0.0), Y, bends=Z),
            "pzt": fs.Link(("ground", "tip"), "stack", (-0.08, 0.0, 0.0), X),
            "rod": fs.Link(("tip", "platform"), "rod", (-0.05, 0.0, 0.0), X),
        },
        **{"gravity": (0.0, 0.0, 0.0), **fields},
    )


def test_strokes_count_from_the_bias():
    """Bias 30 V in -30 to 150 V: a third of the stroke below, two thirds above."""
    limits = stroke_limits(guide())
    np.testing.assert_allclose([limits.low[0], limits.high[0]], [-20e-6 / 3.0, 40e-6 / 3.0])
    np.testing.assert_allclose([limits.from_zero.low[0], limits.from_zero.high[0]], [-20e-6 / 6.0, 20e-6 * 5.0 / 6.0])
    above = stroke_limits(guide(replace(STACK, voltage_low=30.0, voltage_high=120.0, bias=60.0))).from_zero
    np.testing.assert_allclose([above.low[0], above.high[0]], [20e-6 / 3.0, 80e-6 / 3.0])
    unstated = stroke_limits(guide(replace(STACK, voltage_low=None, voltage_high=None, bias=None))).from_zero
    np.testing.assert_allclose([unstated.low[0], unstated.high[0]], [0.0, 20e-6])
    found = single_axis(ideal(guide()).mapping, limits)
    np.testing.assert_allclose(found.symmetric, 20e-6 / 3.0)
    np.testing.assert_allclose(found.table.at("x", "full"), 20e-6)
    middle = stroke_limits(guide(replace(STACK, bias=None)))
    np.testing.assert_allclose([middle.low[0], middle.high[0]], [-10e-6, 10e-6])


def test_volts_and_currents():
    """20 um over 180 V from a bias of 30 V; a sine of 5 um at 100 Hz takes 2 pi f C a / (um/V) of 2 uF."""
    electric = drive(guide())
    np.testing.assert_allclose(electric.gain, 20e-6 / 180.0)
    strokes = np.array([5e-6])
    np.testing.assert_allclose(electric.bias + strokes / electric.gain, 30.0 + 45.0)
    np.testing.assert_allclose(2.0 * np.pi * 100.0 * electric.capacitance * strokes / electric.gain, 2.0 * np.pi * 100.0 * 2e-6 * 45.0)
    np.testing.assert_allclose([electric.low, electric.high], [[-30.0], [150.0]])
    unstated = drive(guide(replace(STACK, bias=None)))  # the middle of -30 to 150 V, as its strokes count
    np.testing.assert_allclose([unstated.bias[0], (unstated.bias + 10e-6 / unstated.gain).item()], [60.0, 150.0])


def test_volts_need_a_range_and_an_unstated_capacitance_is_unknown():
    with pytest.raises(fs.DesignError, match="pzt: voltage range of the stack missing"):
        drive(guide(replace(STACK, voltage_low=None)))
    assert np.isnan(drive(guide(replace(STACK, capacitance=None))).capacitance).all()


def test_leaf_stress_is_that_of_a_guided_beam():
    """Guided deflection x: M = 6 E I x / L^2 at the ends, sigma = 3 E t x / L^2 (long thin leaf: shear below 1e-3)."""
    stage = guide()
    model = lumped(stage)
    moved = 5.0 / 6.0 * 20e-6 * float(_gain(model))  # of -30 to 150 V, five sixths lie above no voltage
    found = hinge_stress(stage, model, stroke_limits(stage).from_zero)
    nominal = found.nominal[found.links.index("left")]
    assert nominal == pytest.approx(3.0 * 200e9 * 0.0005 * moved / 0.05**2, rel=0.015)
    assert found.strokes[found.links.index("left")] == pytest.approx([5.0 / 6.0 * 20e-6])
    np.testing.assert_allclose(found.safety, 1e9 / found.peak)
    assert found.unchecked == ("pzt",)
    assert replace(found, peak=0.0 * found.peak).weakest == found.links[0]  # nothing is stressed: a tie of infinite factors


def test_force_on_the_stage_counts_the_stroke_lost_in_the_stack():
    """From no voltage, s u of the stroke moves the stage (springs in series), k_s of the guide against k of the stack."""
    stage = guide()
    model = lumped(stage)
    line = stack_lines(stage, model)
    low, high = load_share(stage, model).range(stroke_limits(stage).from_zero)
    assert line.stiffness == pytest.approx(STACK.stiffness)
    series = 1.0 / (1.0 / line.stage_stiffness + 1.0 / line.stiffness)
    np.testing.assert_allclose(np.concatenate([low, high]), series * 20e-6 * np.array([-1.0, 5.0]) / 6.0, rtol=1e-9)


def _gain(model):
    from flexstage.models.linear.static import static_gain

    return static_gain(model, ("platform.x",), ("pzt",)).values[0, 0]


def test_a_stack_against_a_spring():
    """Two leaves of 12 E I / L^3 each behind a rod E A / L: travel u k / (k + k_s), force k_s times that."""
    stage = guide()
    found = stack_lines(stage, lumped(stage))
    leaves = 2.0 * 12.0 * 200e9 * 0.002 * 0.0005**3 / 12.0 / 0.05**3
    rod = 200e9 * np.pi / 4.0 * 0.001**2 / 0.02
    spring = 1.0 / (1.0 / leaves + 1.0 / rod)
    assert found.stage_stiffness[0] == pytest.approx(spring, rel=0.01)
    assert found.travel[0] == pytest.approx(20e-6 * 50e6 / (50e6 + found.stage_stiffness[0]), rel=1e-12)
    assert found.blocking[0] == pytest.approx(1000.0)
    line = platform_lines(ideal(stage).mapping, lumped(stage), stroke_limits(stage))
    series = 1.0 / (1.0 / 50e6 + 1.0 / rod) + leaves
    assert line.stiffness[0] == pytest.approx(series, rel=0.01)


def test_round_necks_bend_by_the_second_moment_of_their_throat():
    """Of a circle of radius r it is pi r^4 / 4, the integral of y^2 over its strips; of a rectangle b h^3 / 12 about its softer axis."""
    stage = double_triangle()
    found = buckling(stage, lumped(stage), stroke_limits(stage).from_zero)
    assert {"round neck", "notch"} <= {_second_moment(link.part)[0] for link in expand(stage).links.values()}
    for index, name in enumerate(found.links):
        link = expand(stage).links[name]
        kind, moment = _second_moment(link.part)
        if kind == "other":
            continue
        length = found.length[index] * (2.0 if found.ends[index] is Ends.FREE else 1.0)
        assert found.critical[index] == pytest.approx(np.pi**2 * link.material.young * moment / length**2, rel=1e-6), name


def _second_moment(part):
    """Kind, and second moment by strips of the thinnest section."""
    if isinstance(part, Neck) and part.width is None:
        radius, turn = 0.5 * part.thickness, (np.arange(2000) + 0.5) * np.pi / 2000
        return "round neck", float(np.sum((radius * np.cos(turn)) ** 2 * 2.0 * (radius * np.sin(turn)) ** 2) * np.pi / 2000)
    if isinstance(part, (Neck, Notch)):
        wide, thin = max(part.width, part.thickness), min(part.width, part.thickness)
        return "notch", wide * thin**3 / 12.0
    return "other", np.nan


def test_euler_columns():
    """A rod between two bodies: pi^2 E I / L^2; a stack without a hinge behind it: over its own length; a body on one rod: a quarter."""
    stage = guide()
    found = buckling(stage, lumped(stage), stroke_limits(stage).from_zero)
    rod, stack = found.links.index("rod"), found.links.index("pzt")
    assert found.critical[rod] == pytest.approx(np.pi**2 * 200e9 * np.pi * 0.001**4 / 64.0 / 0.02**2)
    assert found.ends[rod] is Ends.GUIDED
    assert found.ends[stack] is Ends.PINNED
    assert found.length[stack] == pytest.approx(0.03 + 0.01)
    rigidity = 50e6 * 0.02 * 0.01**2 / 16.0
    assert found.critical[stack] == pytest.approx(np.pi**2 * rigidity / 0.04**2)
    assert found.compression[rod] == pytest.approx(found.compression[stack], rel=1e-9)
    post = replace(
        stage, links={"only": fs.Link(("ground", "platform"), "rod", (0.0, 0.0, -0.01), Z)}, bodies={"platform": stage.bodies["platform"]}
    )
    alone = buckling(replace(post, gravity=(0.0, 0.0, -9.80665)), lumped(post), StrokeLimits((), np.zeros(0), np.zeros(0)))
    assert alone.ends == (Ends.FREE,)
    assert alone.critical[0] == pytest.approx(0.25 * found.critical[rod])
    assert alone.compression[0] == pytest.approx(9.80665, rel=1e-3)


def test_what_only_bears_weight_across_it_is_not_pressed():
    """Leaves that stand upright under carriages: what rounding leaves along them is no compression, on no processor."""
    stage = CASES["voice-coil-xy"].build()
    found = buckling(stage, lumped(stage), stroke_limits(stage))
    assert (len(found.links), found.weakest) == (40, None)
    assert not found.compression.any()
    assert np.isinf(found.factor).all()


def test_loads_against_limits():
    """A push of 100 N along x: nearly all in the stack; preload counts towards the maximum load and against lift-off."""
    stage = guide(forces={"push": fs.Force("platform", (0.0, 0.0, 0.0), (-100.0, 0.0, 0.0))})
    found = load_share(stage, lumped(stage))
    assert found.compression[0] == pytest.approx(100.0, rel=0.01)
    np.testing.assert_allclose(found.usage(np.array([300.0])), 500.0 / 2000.0)
    np.testing.assert_allclose(found.pull(np.array([-150.0])), 150.0 / 300.0)
    np.testing.assert_allclose(found.pull(np.array([150.0])), 0.0)
    added = found.under(np.array([-1.0, 0.0, 0.0]), np.zeros(3))
    np.testing.assert_allclose(added, found.compression[0] / 100.0, rtol=1e-6)
    loose = load_share(guide(replace(STACK, preload=None, tensile_limit=None)), lumped(guide()))
    assert np.isinf(loose.pull(np.array([-1.0]))).all()


def test_the_range_of_compression_is_that_of_the_corners_of_all_strokes():
    """A stroke presses its own stack and pulls at others: corner by corner, and the weight with all of them."""
    stage = double_triangle()
    share, limits = load_share(stage, lumped(stage)), stroke_limits(stage)
    assert np.any(share.stroke.values < 0.0)
    assert np.any(share.stroke.values > 0.0)
    forces = share.compression + limits.corners @ share.stroke.values.T
    size = np.abs(forces).max()
    np.testing.assert_allclose(share.range(limits), (forces.min(axis=0), forces.max(axis=0)), rtol=0.0, atol=1e-12 * size)


def test_stacks_are_pulled_below_no_voltage():
    """Of -70 to 70 V half the stroke is contraction: as much tension as compression, against what the stack allows."""
    even = replace(STACK, voltage_low=-70.0, voltage_high=70.0, bias=None, preload=None, tensile_limit=0.001)
    share, limits = load_share(guide(even), lumped(guide(even))), stroke_limits(guide(even)).from_zero
    least, largest = share.range(limits)
    assert least[0] == pytest.approx(-largest[0], rel=1e-9)
    assert largest[0] == pytest.approx(0.5 * share.stroke.values[0, 0] * 20e-6, rel=1e-9)
    assert share.use(limits)[0] == pytest.approx(-least[0] / 0.001, rel=1e-9)
    assert ["times the limit in tension" in each.what for each in share.tension_findings(limits)] == [True]
    unknown = replace(even, tensile_limit=None)
    told = load_share(guide(unknown), lumped(guide(unknown))).tension_findings(limits)
    assert ["preload and tensile limit missing" in each.what for each in told] == [True]
    positive = replace(even, voltage_low=0.0)
    assert not list(load_share(guide(positive), lumped(guide(positive))).tension_findings(stroke_limits(guide(positive)).from_zero))


def test_a_point_turns_about_itself():
    """Tilting about a point 0.1 m above the reference: R_a there is R_a X^-1."""
    from flexstage.cases.registry import case

    stage = case("hexapod")
    kinematics = ideal(stage)
    at = mapping_at(stage, kinematics, "sample")
    height = stage.bodies["platform"].points["sample"][2] - 0.014
    own = kinematics.mapping.values
    np.testing.assert_allclose(at.values[:, :3], own[:, :3], atol=1e-12)
    np.testing.assert_allclose(at.values[:, 3], own[:, 3] + height * own[:, 1], atol=1e-12)
    np.testing.assert_allclose(at.values[:, 4], own[:, 4] - height * own[:, 0], atol=1e-12)
    with pytest.raises(fs.DesignError, match=r"Use .*sample"):
        mapping_at(stage, kinematics, "sampel")


def solids(*items, **fields):
    """A stage of nothing but outlines."""
    return fs.Mechanism(
        name="outlines", materials={"steel": STEEL}, bodies={"platform": fs.Body(solids=dict(enumerate_names(items)))}, **fields
    )


def enumerate_names(items):
    return ((f"s{number}", item) for number, item in enumerate(items))


def test_discs_and_boxes_against_the_opening():
    """A disc whose edge stands 1 mm into a corner's side, one that just touches, a turned box that reaches in by its corner."""
    half = 0.055
    disc = fs.Cylinder("steel", 0.02, 0.01, at=(half + 0.009, 0.0, 0.0))
    clear = fs.Cylinder("steel", 0.02, 0.01, at=(half + 0.01, 0.0, 0.0))
    corner = fs.Cylinder("steel", 0.02, 0.01, at=(half + 0.0095 * np.sqrt(0.5), half + 0.0095 * np.sqrt(0.5), 0.0))
    lying = fs.Cylinder("steel", 0.02, 0.1, at=(0.0, half + 0.008, 0.0), along=X)
    found = clearance(solids(disc, clear, corner, lying, opening=fs.Aperture((0.11, 0.11))))
    assert [item.name for item in found.intrusions] == ["platform.s0", "platform.s2", "platform.s3"]
    np.testing.assert_allclose([item.depth for item in found.intrusions], [0.001, 0.0005, 0.002], rtol=1e-9)


def test_an_oblong_opening_is_as_long_and_wide_as_it_says():
    """110 mm along x, 70 mm along y: blocks that stand 1 mm and 2 mm into it, and two beside it."""
    places = [(0.064, 0.0, 0.0), (0.0, 0.043, 0.0), (-0.065, 0.0, 0.0), (0.0, -0.045, 0.0)]
    blocks = [fs.Block("steel", (0.02, 0.02, 0.01), at=place) for place in places]
    found = clearance(solids(*blocks, opening=fs.Aperture((0.11, 0.07))))
    assert [item.name for item in found.intrusions] == ["platform.s0", "platform.s1"]
    np.testing.assert_allclose([item.depth for item in found.intrusions], [0.001, 0.002], rtol=1e-9)


def test_holes_and_bores_leave_the_opening_clear():
    """A plate with a hole and a ring with a bore around the opening are clear; one too small is not, nor what stands on its edge."""
    plate = fs.Block("steel", (0.2, 0.2, 0.01), hole=(0.11, 0.11))
    ring = fs.Cylinder("steel", 0.2, 0.01, bore=0.11 * np.sqrt(2.0) + 1e-6)
    narrow = fs.Cylinder("steel", 0.2, 0.01, bore=0.15)
    wheel = fs.Cylinder("steel", 0.2, 0.01, along=X, bore=0.18)
    wall = fs.Block("steel", (0.2, 0.2, 0.01), hole=(0.19, 0.19), along=Z, up=X)
    found = clearance(solids(plate, ring, narrow, opening=fs.Aperture((0.11, 0.11))))
    assert [item.name for item in found.intrusions] == ["platform.s2"]
    for standing in (wheel, wall):
        (intrusion,) = clearance(solids(standing, opening=fs.Aperture((0.11, 0.11)))).intrusions
        assert intrusion.depth == pytest.approx(0.055 + 0.005, rel=1e-9)


def test_bounding_box_and_envelope():
    """A rod along (1, 1, 0) of length 0.1 and diameter 0.02: (0.1 + 0.02) / sqrt 2 along x and y, 0.02 along z."""
    lying = fs.Cylinder("steel", 0.02, 0.1, along=(1.0, 1.0, 0.0))
    found = clearance(solids(lying, envelope=(0.1, 0.08, 0.02)))
    np.testing.assert_allclose(found.size, [0.12 / np.sqrt(2.0)] * 2 + [0.02], rtol=1e-12)
    assert [finding.where for finding in found.findings] == ["envelope.y"]
    assert "84.85 mm" in found.findings[0].what
    assert "80 mm" in found.findings[0].what
    assert found.findings[0].advice == "Check platform.s0"  # one that reaches farthest on both sides is named once


def test_the_linear_map_is_tried_at_corners_and_centres_of_faces():
    """Of the box of two strokes: both at an end, or one at an end and the other in the middle."""
    stage = fs.case("xy-stage")
    limits = stroke_limits(stage).from_zero
    tried = linear_map_error(stage, ideal(stage), limits, inside=0).strokes
    shares = (tried - limits.low) / limits.full
    expected = [(x, y) for x in (0.0, 0.5, 1.0) for y in (0.0, 0.5, 1.0) if (x, y) != (0.5, 0.5)]
    np.testing.assert_allclose(sorted(map(tuple, np.round(shares, 9))), expected, atol=1e-9)


def test_a_batch_is_the_loop():
    """Leaves of two lengths at once (as many as the stroke has corners): every workspace number as for each alone."""
    length = np.array([0.04, 0.05])
    together = guide(leaf=fs.Leaf("steel", length, 0.0005, 0.002))
    model, limits = lumped(together), stroke_limits(together)
    stress, lines, columns = hinge_stress(together, model, limits), stack_lines(together, model), buckling(together, model, limits)
    errors = linear_map_error(together, ideal(together), limits)
    for index, value in enumerate(length):
        alone = guide(leaf=fs.Leaf("steel", float(value), 0.0005, 0.002))
        single = lumped(alone)
        np.testing.assert_allclose(stress.nominal[index], hinge_stress(alone, single, limits).nominal, rtol=1e-9)
        np.testing.assert_allclose(lines.travel[index], stack_lines(alone, single).travel, rtol=1e-9)
        np.testing.assert_allclose(errors.worst[index], linear_map_error(alone, ideal(alone), limits).worst, rtol=1e-9, atol=1e-18)
        np.testing.assert_allclose(columns.critical[index], buckling(alone, single, limits).critical, rtol=1e-9)
        np.testing.assert_allclose(
            load_share(together, model).share.values[index], load_share(alone, single).share.values, rtol=1e-6, atol=1e-9
        )


def test_the_pseudo_inverse_lets_complex_steps_through_and_stays_exact_for_gauges_hardly_told_apart():
    random = np.random.default_rng(5)
    tall, step = random.standard_normal((5, 3)), random.standard_normal((5, 3))
    slope = np.imag(_pseudo_inverse(tall + 1e-20j * step)) / 1e-20
    central = (np.linalg.pinv(tall + 1e-6 * step) - np.linalg.pinv(tall - 1e-6 * step)) / 2e-6
    np.testing.assert_allclose(slope, central, rtol=1e-7, atol=1e-8)
    near = tall * [1.0, 1.0, 0.0] + tall[:, [0]] * [0.0, 0.0, 1.0] + 1e-8 * step * [0.0, 0.0, 1.0]
    np.testing.assert_allclose(_pseudo_inverse(near) @ near, np.eye(3), atol=1e-6)


def test_motions_that_are_not_small_are_told_and_verdicts_on_them_withheld():
    """Leaves of 50 mm: beyond sqrt(2 x 1 %) of their length linear models are 1 % off; a demand below that is judged."""
    far = guide(replace(STACK, stroke=30e-3, bias=None), requirements={"stroke.x": "at least 8 mm", "safety": "at least 0.1"})
    (told,) = (each for each in caveats(far).warnings if each.where == "stroke.x")
    assert "bends by 0.3 of its length" in told.what
    assert told.advice == f"Use +-{np.sqrt(0.02) * 0.05:.4g} m at most"
    stroke, safety = judge(far)
    assert "withheld" in stroke.reason
    assert "withheld" in safety.reason
    near = replace(far, requirements={"stroke.x": "at least 5 mm"})
    assert [bool(verdict.passed) for verdict in judge(near)] == [True]


def test_the_faces_of_a_deep_notch_touch_first():
    """An ellipse of 1 mm by 20 mm: its faces meet after 2 atan(1 / (20 + 0.1)), 0.0995 rad."""
    deep = fs.Notch("steel", 0.0002, 0.01, fs.Elliptic(along=0.001, across=0.02))
    stage = guide(leaf=deep)
    found = small_motion(stage, ideal(stage))
    place = found.names.index("left")
    assert found.limit[place] == pytest.approx(2.0 * np.arctan(1.0 / 20.1))
    assert found.closes[place]
    assert found.limit[found.names.index("rod")] == pytest.approx(np.sqrt(0.02))


def test_a_part_that_turns_shortens_like_an_arc() -> None:
    """Chord of an arc of 0.1 m that turns by 0.01 rad: L (1 - sin(a/2)/(a/2))."""
    one = np.ones((1, 1))
    moved = SmallMotion(("rz",), ("rod",), turn=0.01 * one, bend=0.0 * one, limit=np.ones(1), closes=(False,), span=np.array([0.1]))
    found = moved.second_order({"rz": 1.0})
    assert (found.shortened, found.shortening) == ("rod", pytest.approx(0.1 * (1.0 - np.sin(0.005) / 0.005), rel=1e-4))
