"""Laws of gauges, on random stages: what tilts, encoders, strain gauges and sums of gauges read follows from what other outputs say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import flexstage as fs
from flexstage.analysis.workspace.gauging import gauge_inverse, pose_resolution
from flexstage.cases.double_triangle import double_triangle
from flexstage.control.plant_models.coordinates import coordinates
from flexstage.control.plant_models.electronics import sampling_chain
from flexstage.control.plant_models.plants import plant
from flexstage.experiment.virtual_rig.plan import plan_test
from flexstage.experiment.virtual_rig.setup import RigSetup, Sensing
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import GROUND, PLATFORM, GaugeSum, LinkProbe, Probe
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped
from flexstage.parts.encoder import Encoder
from flexstage.parts.gauge import Gauge, SensorSense, combine_gauges
from flexstage.parts.strain_gauge import StrainGauge
from flexstage.parts.tilt import Tilt
from flexstage.spatial.frame import axes
from tests.conftest import examples
from tests.laws.strategies import actuated_platforms, mechanisms, orientations, places

BASE = 0.04
SENSORS = {
    "gap": Gauge(range=1e-4, resolution=1e-9, noise_density=3e-11, bandwidth=1e3),
    "tilt": Tilt(range=1e-3, resolution=5e-9, noise_density=1e-10, bandwidth=1e3),
    "scale": Encoder(range=1e-2, period=4e-6, steps=4096.0),
    "strain": StrainGauge(range=1e-4, resolution=2e-9),
}


def gauged(stage, gauges):
    return replace(stage, sensors=SENSORS, gauges=gauges)


def rows(model, *names):
    """What outputs feel of coordinates and of inputs, side by side."""
    chosen = model.output_index(names)
    return np.concatenate([model.output[chosen], model.feedthrough[chosen]], axis=-1)


def read(gauge, body, base, at, along, up):
    return Probe(gauge, body, Pose(at, along, up), SensorSense.OPENS if gauge == "gap" else None, base)


@examples(10)
@given(mechanisms(), st.data())
def test_a_tilt_is_the_difference_of_two_gaps_over_their_base(stage, data):
    """Two gaps along z, one a base along y beyond the other: turning about x opens the further one more."""
    names = list(stage.bodies)
    body = data.draw(st.sampled_from(names))
    base = data.draw(st.sampled_from([name for name in (GROUND, *names) if name != body]))
    at, (along, up) = data.draw(places), data.draw(orientations())
    turned = axes(along, up)
    further = tuple(np.asarray(at) + BASE * turned[:, 1])
    straight, across = tuple(turned[:, 2]), tuple(turned[:, 0])
    gauges = {
        "T": read("tilt", body, base, at, along, up),
        "near": read("gap", body, base, at, straight, across),
        "far": read("gap", body, base, further, straight, across),
        "difference": GaugeSum({"far": 1.0 / BASE, "near": -1.0 / BASE}),
        "scale": read("scale", body, base, at, straight, across),
    }
    tilt, near, far, difference, scale = rows(lumped(gauged(stage, gauges)), *gauges)
    size = np.max(np.abs([near, far])) / BASE
    np.testing.assert_allclose(tilt, (far - near) / BASE, atol=1e-12 * size)
    np.testing.assert_allclose(difference, (far - near) / BASE, atol=1e-12 * size)
    np.testing.assert_allclose(scale, near, atol=1e-12 * BASE * size)


@examples(10)
@given(mechanisms())
def test_a_strain_gauge_on_a_stack_reads_what_its_force_and_its_stroke_make_it_longer(stage):
    """Elongation = f / k + u: the stack's own force, which another output tells, over its stiffness, and its free stroke."""
    drives = [name for name, link in stage.links.items() if hasattr(stage.parts[link.part], "stroke")]
    model = lumped(gauged(stage, {f"G{number}": LinkProbe("strain", link) for number, link in enumerate(drives)}))
    for number, link in enumerate(drives):
        stroke = np.zeros(len(model.coordinates) + len(model.inputs))
        stroke[len(model.coordinates) + model.input_index((link,))[0]] = 1.0
        elongation, force = rows(model, f"G{number}", f"{link}.fx")
        expected = force / stage.parts[stage.links[link].part].stiffness + stroke
        np.testing.assert_allclose(elongation, expected, atol=1e-9 * np.max(np.abs(expected)))


@examples(10)
@given(mechanisms(), places, orientations())
def test_gauges_feel_no_motion_of_everything_with_the_ground(stage, at, turned):
    """Between bodies that move as one nothing is read; what the model says of a moving ground is the same."""
    link = next((name for name, link in stage.links.items() if GROUND not in link.joins), None)
    other = next((name for name in stage.bodies if name != PLATFORM), None)
    gauges = {} if link is None else {"G": LinkProbe("strain", link), "R": LinkProbe("tilt", link)}
    if other is not None:
        gauges |= {"T": read("tilt", PLATFORM, other, at, *turned), "E": read("scale", PLATFORM, other, at, *turned)}
        gauges["D"] = GaugeSum({"E": -2.0})
    model = lumped(gauged(stage, gauges))
    chosen = model.output_index(tuple(gauges))
    np.testing.assert_allclose(model.output[chosen] @ model.rigid, 0.0, atol=1e-12)
    assert not np.any(model.rigid_output[chosen])


@examples(8)
@given(actuated_platforms())
def test_strain_gauges_on_stacks_read_the_strokes_of_the_ideal_stage(stage):
    """R_s over the ideal motions is R_a, in the mapped model too; steps of strain gauges are those of strokes."""
    links = expand(stage).actuators.values()
    whole = gauged(stage, {f"G{number}": LinkProbe("strain", link) for number, link in enumerate(links)})
    found = ideal(whole)
    seen = found.sensing @ found.motion
    np.testing.assert_allclose(seen, found.actuation, atol=1e-9 * np.max(np.abs(found.actuation)))
    step = SENSORS["strain"].resolution
    fine = pose_resolution(whole, found)
    np.testing.assert_allclose(fine.worst, step * np.sum(np.abs(found.motion @ np.linalg.pinv(found.actuation)), axis=-1), rtol=1e-6)


# The double triangle, with gauges taken together


@pytest.fixture(scope="module")
def stage():
    return double_triangle()


def test_sums_are_their_members_in_every_model(stage):
    """A sum of sums too: weights multiply."""
    sums = {"half": GaugeSum({"S4": 0.5, "S5": 0.5}), "whole": GaugeSum({"half": 2.0, "S6": -1.0})}
    whole = replace(stage, gauges={**stage.gauges, **sums})
    kinematics = ideal(whole)
    chosen = [kinematics.gauges.index(name) for name in ("S4", "S5", "S6", "half", "whole")]
    for matrix in (kinematics.sensing[chosen], *(rows(model(whole), "S4", "S5", "S6", "half", "whole") for model in (mapped, lumped))):
        first, second, third, half, total = matrix
        np.testing.assert_allclose(half, 0.5 * (first + second), atol=1e-12)
        np.testing.assert_allclose(total, first + second - third, atol=1e-12)


def test_sums_and_differences_tell_the_pose_that_their_members_do(stage):
    """Of as many gauges as motions: the same pose, noise and steps, whichever way they are taken together; so the same loop."""
    pair = {"mean": GaugeSum({"S4": 0.5, "S5": 0.5}), "tilt": GaugeSum({"S4": 1.0, "S5": -1.0})}
    formed = replace(stage, sensors={"C36": SENSORS["gap"]}, gauges={**stage.gauges, **pair})
    plain = replace(formed, gauges=stage.gauges)
    assert ideal(formed).telling == ("S1", "S2", "S3", "S6", "mean", "tilt")
    np.testing.assert_allclose(gauge_inverse(ideal(formed)).values, gauge_inverse(ideal(plain)).values, atol=1e-9)
    np.testing.assert_allclose(coordinates(ideal(formed)).pose, coordinates(ideal(plain)).pose, atol=1e-9)
    fine, simple = pose_resolution(formed, ideal(formed)), pose_resolution(plain, ideal(plain))
    for name in ("worst", "rms", "noise"):
        np.testing.assert_allclose(getattr(fine, name), getattr(simple, name), rtol=1e-9)


def test_a_sum_is_worth_what_its_members_are():
    """Noise by root of the sum of squares, steps and ranges one upon the other."""
    gap = SENSORS["gap"]
    found = combine_gauges([(0.5, gap), (-0.5, gap)])
    assert (found.range, found.resolution, found.bandwidth) == (gap.range, gap.resolution, gap.bandwidth)
    assert found.noise_density == pytest.approx(gap.noise_density / np.sqrt(2.0))
    assert combine_gauges([(1.0, gap), (1.0, SENSORS["scale"])]).noise_density is None
    assert combine_gauges([(1.0, gap), (1.0, replace(gap, bandwidth=2e3))]).bandwidth is None


def test_growth_alike_everywhere_is_read_as_scale_by_strain_gauges_and_not_at_all_by_tilts(stage):
    """One coefficient for everything, the ground too: a stack becomes longer by a L T, an encoder 80 mm off the axis reads its place."""
    steel = stage.materials["steel"].expansion
    parts = {name: replace(part, expansion=steel) if hasattr(part, "stroke") else part for name, part in stage.parts.items()}
    gauges = {
        "G": LinkProbe("strain", "B1/pzt"),
        "T": read("tilt", PLATFORM, GROUND, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    }
    whole = replace(stage, parts=parts, sensors=SENSORS, gauges=gauges)
    found = fs.drift(whole, lumped(whole), ground="steel").gauges
    length = next(part.length for name, part in parts.items() if name == whole.units["horizontal"].links["pzt"].part)
    assert found.at("G", "uniform") == pytest.approx(steel * length, rel=1e-6)
    assert abs(found.at("T", "uniform")) < 1e-12
    assert [units[0] for units in found.unit] == ["m/K", "rad/K"]


def test_readings_keep_their_units_in_responses_tests_and_loops(stage):
    """Of a tilt rad everywhere, and what is asked of all gauges in metres is not its; sums are formed where the pose is."""
    gauges = {
        "T": read("tilt", PLATFORM, GROUND, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        "G1-G6": LinkProbe("strain", "B1-B6/pzt"),
        "E": read("scale", PLATFORM, GROUND, (0.0, 0.1, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        "D": GaugeSum({"G1": 1.0, "G2": -1.0}),
    }
    whole = replace(stage, sensors=SENSORS, gauges=gauges)
    model = mapped(whole)
    assert {channel.name: channel.unit for channel in model.outputs if channel.name in ("T", "G1", "D")} == {
        "T": "rad",
        "G1": "m",
        "D": "m",
    }
    test = plan_test(whole, model, RigSetup(seconds=1.0, sensing=Sensing(density=1e-9, resolution=1e-8, drift=1e-9)))
    assert (test.gauges, test.units) == (("T", "G1", "G2", "G3", "G4", "G5", "G6", "E"), ("rad", *("m",) * 7))
    assert (test.densities[0], test.steps[0], test.walks[0]) == (1e-10, 5e-9, 0.0)
    assert set(test.densities[1:]) == {1e-9}
    loop = plant(model, ideal(whole), sampling_chain(whole, rate=10e3))
    assert loop.gauges == test.gauges
    assert [channel.unit for channel in loop.system.outputs if channel.name.startswith("gap.")] == ["rad", *("m",) * 7]


@pytest.mark.parametrize(
    ("gauges", "found"),
    [
        ({"G": Probe("gap", PLATFORM, Pose())}, "gauges.G: positive missing"),
        (
            {"T": Probe("tilt", PLATFORM, Pose(), SensorSense.OPENS)},
            "gauges.T.positive: tilt does not measure a gap, but motion along or about its x axis",
        ),
        ({"G": Probe("strain", PLATFORM, Pose())}, "gauges.G: link missing for strain, a gauge on a link"),
        ({"G": LinkProbe("strain", "B7/pzt")}, 'gauges.G.link: unknown link "B7/pzt". Use'),
        ({"G1-G2": LinkProbe("strain", "B1-B3/pzt")}, "gauges.G1-G2.link: wrong number of links (got 3 links for 2 gauges)"),
        ({"G": LinkProbe("nothing", "B1/pzt")}, 'gauges.G.gauge: unknown sensor "nothing"'),
        ({"D": GaugeSum({"S1": 1.0})}, 'gauges.D.sum.S1: unknown gauge "S1"'),
        ({"D": GaugeSum({})}, "gauges.D.sum: members missing"),
        ({"D": GaugeSum({"E": 1.0}), "E": GaugeSum({"D": 1.0})}, "gauges.D.sum: circular sum"),
        (
            {"T": Probe("tilt", PLATFORM, Pose()), "G": LinkProbe("strain", "B1/pzt"), "D": GaugeSum({"T": 1.0, "G": 1.0})},
            "gauges.D.sum: different quantities (m and rad)",
        ),
    ],
)
def test_gauges_that_cannot_be_are_refused_by_name(stage, gauges, found):
    whole = replace(stage, sensors=SENSORS, gauges=gauges)
    assert any(str(finding).startswith(found) for finding in fs.check(whole)), [str(finding) for finding in fs.check(whole)]
    with pytest.raises(fs.DesignError):
        ideal(whole)
