"""The mesh that moves: bodies move rigidly, links follow both of their bodies in place and slope and bend as beams; the data is whole."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given

import flexstage as fs
from flexstage.analysis.workspace.strength import hinge_stress
from flexstage.analysis.workspace.stroke import StrokeLimits, stroke_limits
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.leaf import Leaf
from flexstage.parts.shape import Shaped
from flexstage.show.scene.skin import Kind
from flexstage.show.viewer.bend import Bend, bend_of
from flexstage.show.viewer.data import StageData, stage_data, still_data
from flexstage.show.viewer.fragment import bundle, data_script, element
from flexstage.show.viewer.motions import Group
from flexstage.spatial.frame import COMPONENTS
from tests.conftest import examples
from tests.laws.strategies import mechanisms
from tests.show.stages import HOSTILE, hostile
from tests.show.zoo import PARTS, zoo

NAMES = ("double-triangle", "bridge", "telescope-mount")
RANDOM = np.random.default_rng(7)


@cache
def stage(name: str) -> Mechanism:
    return zoo() if name == "zoo" else fs.case(name)


@cache
def data(name: str) -> StageData:
    return still_data(stage(name))


@cache
def moving(name: str) -> StageData:
    return stage_data(stage(name))


def twists_of(shown: StageData) -> Array:
    """Any twists of all bodies; the ground stands still."""
    twists = RANDOM.uniform(-1.0, 1.0, (len(shown.bodies), 6)) * [1e-3] * 6
    twists[0] = 0.0
    return twists


def rigid(twists: Array, points: Array) -> Array:
    return twists[:, :3] + np.cross(twists[:, 3:], points)


@pytest.mark.parametrize("name", [*NAMES, "zoo"])
def test_rigid_bodies_move_by_their_twists_and_links_follow_both_of_their_bodies_at_their_ends(name: str) -> None:
    shown = data(name)
    mesh, twists = shown.mesh, twists_of(shown)
    moved = mesh.displacement(twists)
    share = mesh.stations[mesh.station, 0]
    ends = mesh.bodies[mesh.carrier]
    assert ends.max() < len(shown.bodies)
    assert np.all((share >= 0.0) & (share <= 1.0))
    assert np.all(share[ends[:, 0] == ends[:, 1]] == 0.0)
    first, second = share == 0.0, share == 1.0
    assert np.array_equal(moved[first], rigid(twists[ends[first, 0]], mesh.points[first]))
    # The ends are middles of rings of points that are rounded to 32 bits.
    assert np.allclose(moved[second], rigid(twists[ends[second, 1]], mesh.points[second]), rtol=0.0, atol=1e-6 * np.abs(moved).max())


@pytest.mark.parametrize("name", [*NAMES, "zoo"])
def test_a_stage_that_moves_as_one_keeps_its_shape(name: str) -> None:
    shown = data(name)
    twists = np.tile(RANDOM.uniform(-1.0, 1.0, 6), (len(shown.bodies), 1))
    assert np.allclose(shown.mesh.displacement(twists), rigid(twists[:1], shown.mesh.points), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("name", [*NAMES, "zoo"])
def test_every_link_outline_and_gauge_is_a_part_that_is_drawn(name: str) -> None:
    shown, assembly = data(name), expand(stage(name))
    drawn = {shown.things[number].name for number in shown.mesh.part}
    assert {*assembly.links, *assembly.superelements} <= drawn
    assert {each for each, gauge in assembly.gauges.items() if gauge.single} <= drawn
    assert {address for body in assembly.bodies.values() for address in body.solids} <= drawn
    assert drawn == {thing.name for thing in shown.things}
    assert {shown.things[number].name for number in shown.links} == set(assembly.links) | set(assembly.superelements)
    assert shown.mesh.triangles.max() < len(shown.mesh.points)
    assert np.all(np.bincount(shown.mesh.triangles.ravel(), minlength=len(shown.mesh.points))[np.unique(shown.mesh.triangles)] > 0)


@examples(2)
@given(mechanisms.fresh())
def test_random_stages_move_as_one_and_follow_their_bodies(mechanism: Mechanism) -> None:
    shown = stage_data(mechanism, count=3)
    assert all(
        note.startswith(("no ideal motions: ", "no drift: ")) for note in shown.notes
    )  # what the lumped model takes, others may refuse
    assert any(motion.group is Group.MODE for motion in shown.motions)
    assert json.loads(shown.text())["bodies"] == ["ground", *expand(mechanism).bodies]
    twists = np.tile(RANDOM.uniform(-1.0, 1.0, 6), (len(shown.bodies), 1))
    assert np.allclose(shown.mesh.displacement(twists), rigid(twists[:1], shown.mesh.points), rtol=0.0, atol=1e-13)
    assert all(np.isfinite(shown.reach(motion)) for motion in shown.motions)


def test_of_a_batch_the_first_design_is_shown() -> None:
    steel = stage("parallelogram").parts["leaf"]
    assert isinstance(steel, Leaf)
    both = replace(
        stage("parallelogram"),
        parts={**stage("parallelogram").parts, "leaf": replace(steel, thickness=steel.thickness * np.array([1.0, 2.0]))},
    )
    shown, first = stage_data(both), moving("parallelogram")
    assert np.array_equal(shown.mesh.points, first.mesh.points)
    assert [motion.label for motion in shown.motions] == [motion.label for motion in first.motions]


def shaped() -> list[str]:
    return [name for name, part in PARTS.items() if isinstance(part, Shaped)]


@pytest.mark.parametrize("name", [*shaped(), "ball"])
def test_bends_meet_their_ends_and_their_slopes_are_their_derivatives(name: str) -> None:
    bend = bend_of(PARTS[name])
    assert bend.at(np.array([0.0, 1.0])).tolist() == [[0.0] * 5, [1.0, 1.0, 0.0, 0.0, 1.0]]
    step = np.diff(bend.shares)
    for value, slope in ((1, 3), (2, 4)):
        # Between stations curvature is constant: the mean slope is that of the ends.
        mean = 0.5 * (bend.values[1:, slope] + bend.values[:-1, slope])
        assert np.allclose(np.diff(bend.values[:, value]), mean * step, rtol=0.0, atol=1e-12)


def moments(part: Shaped, bend: Bend, column: int) -> tuple[Array, Array]:
    """Places and bending moments, but for Young's modulus: curvature times the second moment of area, of the part's own silhouette."""
    stations, sections = zip(*part.silhouette, strict=True)
    places = 0.5 * (bend.shares[1:] + bend.shares[:-1])
    along = stations[0] + places * (stations[-1] - stations[0])
    height, width = (np.interp(along, stations, [getattr(each, side) for each in sections]) for side in ("height", "width"))
    thin = np.minimum(height, width)
    inertia = np.pi * height**4 / 64.0 if part.is_axisymmetric else height * width * thin**2 / 12.0
    return places, np.diff(bend.values[:, column]) / np.diff(bend.shares) * inertia


@pytest.mark.parametrize("name", shaped())
@pytest.mark.parametrize("column", [3, 4])
def test_moments_in_bent_parts_are_those_of_forces_at_their_ends(name: str, column: int) -> None:
    """A beam that is loaded at its ends alone has a moment that runs straight from the one to the other."""
    part = PARTS[name]
    assert isinstance(part, Shaped)
    places, moment = moments(part, bend_of(part), column)
    line = np.polynomial.Polynomial.fit(places, moment, 1)
    assert np.allclose(moment, line(places), rtol=0.0, atol=1e-9 * np.abs(moment).max())
    assert np.ptp(moment) > 0.1 * np.abs(moment).max()


def test_a_leaf_bends_as_the_cubic_of_hermite() -> None:
    share = np.linspace(0.0, 1.0, 23)
    found = bend_of(Leaf("steel", 0.02, 0.001, 0.01)).at(share)
    cubic = [share, 3 * share**2 - 2 * share**3, share**3 - share**2, 6 * share - 6 * share**2, 3 * share**2 - 2 * share]
    # The curvature of a straight moment, taken as constant over each of 400 intervals; between them values are interpolated.
    assert np.allclose(found, np.stack(cubic, axis=-1), rtol=0.0, atol=2e-5)


def test_a_notch_bends_at_its_throat() -> None:
    slope = bend_of(PARTS["notch"]).at(np.array([0.25, 0.75]))[:, 3:] @ [0.5, 1.0]  # a turn about the middle
    assert slope[0] < 0.15
    assert slope[1] > 0.85


def test_modes_move_the_platform_as_the_model_says_and_share_out_their_energy() -> None:
    shown, mechanism = moving("bridge"), stage("bridge")
    model = fs.lumped(mechanism)
    found = fs.modes(model)
    bone = shown.bones.references["platform"]
    own = [motion for motion in shown.motions if motion.group is Group.MODE]
    assert len(own) >= 6
    for number, motion in enumerate(own[:6]):
        twist = motion.twists[shown.bodies.index("platform")]
        told = found.platform_shapes[:, number]
        assert np.allclose(twist[:3] + np.cross(twist[3:], bone), told[:3], rtol=0.0, atol=1e-9)
        assert np.allclose(twist[3:], told[3:], rtol=0.0, atol=1e-9 * np.abs(told[3:]).max(initial=1.0))
        assert motion.energy is not None
        assert sum(motion.energy.values()) == pytest.approx(1.0)
        assert set(motion.energy) == {shown.things[each].name for each in shown.links}
        assert motion.frequency == pytest.approx(float(found.frequencies[number]))
        assert not motion.twists[0].any()


def test_strokes_and_axes_are_those_of_the_models() -> None:
    shown, mechanism = moving("double-triangle"), stage("double-triangle")
    model, kinematics = fs.lumped(mechanism), fs.ideal(mechanism)
    place = shown.bodies.index("platform")
    bone = shown.bones.references["platform"]
    at_bone = {
        (motion.group, motion.name): np.concatenate(
            [motion.twists[place, :3] + np.cross(motion.twists[place, 3:], bone), motion.twists[place, 3:]]
        )
        for motion in shown.motions
    }
    gain = fs.lost_motion(kinematics, model)
    for number, name in enumerate(COMPONENTS):
        assert np.allclose(at_bone[Group.AXIS, name], 1e-6 * np.eye(6)[number], rtol=0.0, atol=1e-18)
    for name in model.strokes:
        pushed = kinematics.actuation @ at_bone[Group.STROKE, name]
        own = pushed[list(kinematics.actuators).index(name)]
        assert own == pytest.approx(1e-6 * float(gain.actuators[name].gain), rel=1e-6)


def test_a_stroke_strains_a_stack_and_its_spring_by_the_same_force() -> None:
    """A stack k that pushes against a spring c strains both by one force F: the energies F^2 / 2k and F^2 / 2c, not its free expansion."""
    stack, spring = 2e7, 5e6
    pushed = fs.Mechanism(
        "stack and spring",
        parts={
            "stack": fs.Piezo(stroke=2e-5, stiffness=stack, length=0.02, diameter=0.005),
            "spring": fs.Spring(diagonal=(spring, 1e6, 1e6, 1e2, 1e2, 1e2)),
        },
        bodies={"platform": fs.Body(mass=0.1, inertia=fs.Inertia(1e-4, 1e-4, 1e-4))},
        links={
            "drive": fs.Link(("ground", "platform"), "stack", (-0.01, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0)),
            "back": fs.Link(("platform", "ground"), "spring", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0)),
        },
        gravity=(0.0, 0.0, 0.0),
    )
    (stroke,) = (each for each in stage_data(pushed).motions if each.group is Group.STROKE)
    assert stroke.energy == pytest.approx({"drive": spring / (stack + spring), "back": stack / (stack + spring)}, rel=1e-9)


def test_stress_is_that_of_the_whole_stroke_alone_and_of_the_load_alone() -> None:
    """Against the analysis of all corners, of which a stage without weight has one if its only actuator has one end."""
    mechanism = replace(fs.case("parallelogram"), gravity=(0.0, 0.0, 0.0))
    limits = stroke_limits(mechanism)
    only = StrokeLimits(limits.actuators, limits.high, limits.high)
    found = hinge_stress(mechanism, fs.lumped(mechanism), only)
    stroke = next(each for each in stage_data(mechanism).motions if each.group is Group.STROKE)
    assert stroke.stress == pytest.approx(dict(zip(found.links, (found.peak / found.allowed).tolist(), strict=True)), rel=1e-9)
    heavy = fs.case("parallelogram")
    weight = next(each for each in moving("parallelogram").motions if each.name == "own weight")
    none = StrokeLimits((), np.zeros(0), np.zeros(0))
    hung = hinge_stress(heavy, fs.lumped(heavy), none)
    assert weight.stress == pytest.approx(dict(zip(hung.links, (hung.peak / hung.allowed).tolist(), strict=True)), rel=1e-9)
    assert next(each.stress for each in moving("parallelogram").motions if each.group is Group.MODE) is None


def test_a_stage_that_warms_moves_as_its_drift_says() -> None:
    shown, mechanism = moving("parallelogram"), stage("parallelogram")
    warm = next(each for each in shown.motions if each.group is Group.DRIFT and each.name == "uniform")
    place, bone = shown.bodies.index("platform"), shown.bones.references["platform"]
    told = fs.drift(mechanism, fs.lumped(mechanism)).of("platform").values[:, 0]
    assert np.allclose(warm.twists[place, :3] + np.cross(warm.twists[place, 3:], bone), told[:3], rtol=0.0, atol=1e-18)
    assert np.allclose(warm.twists[place, 3:], told[3:], rtol=0.0, atol=1e-18)


def test_what_is_not_drawn_as_it_is_is_said() -> None:
    guide = fs.case("parallelogram")
    hole = fs.Block("aluminium", (5e-3, 5e-3, 1.0), subtract=True)
    platform = guide.bodies["platform"]
    pierced = replace(guide, bodies={**guide.bodies, "platform": replace(platform, solids={**platform.solids, "hole": hole})})
    assert still_data(guide).notes == ()
    assert still_data(pierced).notes == ("drawn without holes: platform.block",)


def test_the_data_is_the_same_each_time_and_holds_what_the_page_reads() -> None:
    shown = moving("double-triangle")
    assert shown.text() == stage_data(fs.case("double-triangle")).text()
    plain = json.loads(shown.text())
    counts = {"points": 3, "part": 1, "carrier": 1, "station": 1}
    sizes = {name: len(base64.b64decode(plain["mesh"][name])) for name in plain["mesh"] if name != "indices"}
    vertices = len(shown.mesh.points)
    assert {name: sizes[name] for name in counts} == {
        "points": 12 * vertices,
        "part": 2 * vertices,
        "carrier": 2 * vertices,
        "station": 2 * vertices,
    }
    modes = [motion for motion in plain["motions"] if motion["group"] == "mode"]
    assert sum(len(motion["twists"]) for motion in modes[:6]) < 4_000  # base64 of 6 modes of 20 bodies
    assert all(motion["reach"] > 0.0 for motion in plain["motions"])
    assert len(shown.text()) < 200_000


def test_parts_know_where_they_stand_in_the_design() -> None:
    mechanism = fs.case("double-triangle")
    text = fs.dumps(mechanism)
    lines = text.splitlines()
    things = {thing.name: thing for thing in still_data(mechanism, text=text).things}
    front = things["B1/front"]
    assert (front.unit, front.what, front.kind, front.address) == ("B1", "neck", Kind.HINGE, "units.horizontal.links.front")
    assert front.line is not None
    assert "front" in lines[front.line - 1]
    assert dict(front.facts)["thickness"] == "1.54 mm"
    plate = next(thing for thing in things.values() if thing.kind is Kind.PLATFORM)
    assert plate.line is not None
    assert "platform" in lines[plate.line - 1]
    assert things["S1"].address.startswith("gauges.")
    assert all(thing.line is not None for thing in things.values())


def test_a_stage_that_no_model_takes_is_drawn_and_says_why_it_does_not_move() -> None:
    shown = stage_data(replace(stage("zoo"), links={}))
    assert len(shown.mesh.points)
    assert not shown.motions
    assert "platform" in shown.notes[0]


def test_no_text_of_a_design_ends_the_script_that_holds_it() -> None:
    script = data_script("stage", still_data(hostile()))
    assert script.count("<") == 2
    assert json.loads(script.partition(">")[2].rpartition("<")[0])["name"] == HOSTILE
    assert element('a"b', motion="<x>") == '<div data-flexstage="a&quot;b" data-motion="&lt;x&gt;"></div>'
    assert "</script" not in bundle()
