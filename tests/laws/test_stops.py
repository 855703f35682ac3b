"""Travel stops: a stroke ends at the nearer of gaps and actuators' ends, and a stop out of reach changes nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.assessment.judge import judge
from flexstage.analysis.workspace.force_workspace import force_workspace
from flexstage.analysis.workspace.stops import single_strokes, with_stops
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.analysis.workspace.workspace import all_strokes, workspace
from flexstage.base.storage.digest import digest
from flexstage.base.units.scale import X, mm, um
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.mount import mount
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Normal, Polar, Pose
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, Probe, Stop
from flexstage.mechanism.store import dumps, loads
from flexstage.models.ideal import ideal
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.encoder import Encoder
from flexstage.parts.force_actuator import ForceActuator

SIX = double_triangle()
ONE = case("parallelogram")
FACE = Pose((30 * mm, 0.0, 0.0))
ARM, GAP = 30 * mm, 2 * um


def strokes(stage):
    return single_strokes(stage, ideal(stage))


def pushed():
    """The leaves of the parallelogram, pushed by a bare force."""
    links = {**ONE.links, "motor": Link((GROUND, PLATFORM), "push", (-40 * mm, 0.0, 0.0), X)}
    parts = {**ONE.parts, "push": ForceActuator(maximum=20.0)}
    return replace(ONE, parts=parts, links=links, units={}, placements={}, gauges={}, requirements={"stroke.x": "at least 10 um"})


@pytest.mark.parametrize("back", [None, 7 * um])
def test_a_stroke_ends_at_a_stop_before_its_actuator_does(back):
    free, held = strokes(ONE), strokes(replace(ONE, stops={"end": Stop(PLATFORM, FACE, 5 * um, back)}))
    assert held.high.item() == 5 * um < free.high.item()
    assert held.low.item() == (free.low.item() if back is None else -back)
    assert (free.limiting, held.limiting) == (("B",), ("stops/end",))
    turned = strokes(replace(ONE, stops={"end": Stop(GROUND, replace(FACE, along=(-1.0, 0.0, 0.0)), 5 * um, back, base=PLATFORM)}))
    assert (turned.low.item(), turned.high.item()) == (held.low.item(), held.high.item())


def test_a_stop_on_the_nearer_side_limits_the_symmetric_stroke():
    """The actuator ends the stroke in +x, and a stop in -x; the stop is nearer."""
    held = strokes(replace(ONE, stops={"end": Stop(PLATFORM, FACE, 1.0, 1 * um)}))
    assert held.symmetric.item() == 1 * um < held.high.item() == strokes(ONE).high.item()
    assert held.limiting == ("stops/end",)


def test_what_is_required_of_a_stroke_and_of_all_at_once_follows():
    """With lost motion made up by command the platform itself moves the gap, and 18 um both ways are 3.6 times the gap."""
    stage = replace(ONE, stops={"end": Stop(PLATFORM, FACE, 5 * um)}, requirements={"stroke.x": "at least 18 um", "corner": "at most 1"})
    line, together = judge(stage)
    assert (line.passed, together.passed) == (False, False)
    assert line.value == pytest.approx(5 * um, rel=1e-12)
    assert together.value == pytest.approx(18.0 / 5.0, rel=1e-12)
    assert all_strokes(stage) == {"x": 5 * um}


def test_turning_closes_a_stop_by_its_arm():
    """An arm along y from the reference point sees x - arm rz: the gap is left to negative rz, and x and rz both close it."""
    x, y, z = np.asarray(expand(SIX).bodies[PLATFORM].reference).tolist()
    stage = replace(SIX, stops={"end": Stop(PLATFORM, Pose((x, y + ARM, z)), GAP)})
    free, held, rz = strokes(SIX), strokes(stage), SIX_COORDINATES.index("rz")
    assert held.low[rz] == pytest.approx(-GAP / ARM, rel=1e-9)
    assert (held.high[rz], held.high[0]) == (free.high[rz], pytest.approx(GAP, rel=1e-12))
    np.testing.assert_array_equal(held.high[1:], free.high[1:])
    command = {"x": 1 * um, "rz": 40e-6}
    corner = workspace(stage, ideal(stage), None, command=command).worst_case
    assert corner.actuators[-1] == "stops/end"
    assert corner.ratio[-1] == pytest.approx((1 * um + ARM * 40e-6) / GAP, rel=1e-9)


SIX_COORDINATES = ("x", "y", "z", "rx", "ry", "rz")


@pytest.mark.parametrize("mirror", [None, *Normal])
def test_a_stop_sees_what_a_gauge_in_its_place_reads(mirror):
    pattern = Polar(0.05, 0.3, InstanceOrientation.TANGENT, height=0.02, turn=0.4, mirror=mirror)
    body, base = "B4/tip", "B1/base"
    gauges = {"G1-G3": Probe("scale", PLATFORM, pattern, base=base), "H1-H2": Probe("scale", body, pattern)}
    tight = {"G1-G3": Stop(PLATFORM, pattern, 1e-9, base=base), "H1-H2": Stop(body, pattern, 1e-9)}
    stage = replace(
        SIX, sensors={**SIX.sensors, "scale": Encoder(range=10 * mm, period=1 * um)}, gauges=gauges, stops=tight, requirements={}
    )
    assert not check(stage)
    known = ideal(stage)
    mapping, limits = with_stops(stage, known, known.mapping, stroke_limits(stage))
    assert mapping.rows[6:] == ("stops/G1", "stops/G2", "stops/G3", "stops/H1", "stops/H2")
    np.testing.assert_allclose(mapping.values[6:], known.sensing @ known.motion, rtol=0.0, atol=1e-12)
    assert np.all(np.isfinite(limits.low))


def test_a_stop_out_of_reach_changes_nothing_bit_by_bit():
    for plain, gap in ((ONE, 0.1 * mm), (SIX, 2 * mm)):
        far = replace(plain, stops={"end": Stop(PLATFORM, FACE, gap, gap)})
        both = [workspace(stage, ideal(stage), None) for stage in (plain, far)]
        for name in ("low", "high", "limiting"):
            np.testing.assert_array_equal(*(getattr(item.single_axis, name) for item in both))
        np.testing.assert_array_equal(*(item.worst_case.ratio for item in both))
        np.testing.assert_array_equal(*(item.polytope.vertices for item in both))
    far = replace(ONE, stops={"end": Stop(PLATFORM, FACE, 0.1 * mm)})
    assert [line.value for line in judge(far)] == [line.value for line in judge(ONE)]


def test_the_reachable_poses_end_at_a_stop_on_both_sides_of_a_corner():
    """Of a stage of two motions the poses beyond a gap across x are cut off: as much area as is beyond it."""
    stage = case("xy-stage")
    free = workspace(stage, ideal(stage), None)
    gap = 0.5 * free.single_axis.high[0]
    stopped = replace(stage, stops={"end": Stop(PLATFORM, Pose(), gap)})
    cut = workspace(stopped, ideal(stopped), None)
    extent = free.polytope.extent.values
    assert cut.polytope.extent.values[0, 1] == pytest.approx(gap, rel=1e-9)
    assert cut.polytope.volume < free.polytope.volume
    assert cut.polytope.extent.values[0, 0] == pytest.approx(extent[0, 0], rel=1e-9)


def test_the_reach_of_forces_ends_at_the_nearer_side_of_a_stop():
    free = pushed()
    per_newton = static_gain(lumped(free), ("platform.x",), ("motor",)).values.item()
    for gap, back, told in ((5 * um, None, 5 * um), (5 * um, 3 * um, 3 * um), (1.0, None, 20.0 * per_newton)):
        stage = replace(free, stops={"end": Stop(PLATFORM, FACE, gap, back)})
        found = force_workspace(stage, ideal(stage), lumped(stage))
        assert found.held.item() == pytest.approx(told, rel=1e-9)
        assert found.limited_by == (("stops/end",) if gap < 1.0 else ("motor maximum force",))
        assert found.bounds.at("x", "motor maximum force").item() == pytest.approx(20.0 * per_newton, rel=1e-12)
        assert judge(stage)[0].value == pytest.approx(told, rel=1e-9)


def test_gaps_are_batches_and_addresses():
    stage = replace(ONE, stops={"end": Stop(PLATFORM, FACE, 5 * um)})
    assert get(stage, "stops.end.gap") == 5 * um
    batch = set_value(stage, "stops.end.gap", np.array([5 * um, 50 * um]))
    np.testing.assert_array_equal(strokes(batch).high[:, 0], [5 * um, strokes(ONE).high.item()])
    assert strokes(batch).low.shape == (2, 1)


def test_stops_are_physics_and_stages_without_keep_their_digest():
    stage = replace(ONE, stops={"end": Stop(PLATFORM, FACE, 5 * um)})
    assert loads(dumps(stage)) == stage
    assert digest(stage, physics=True) != digest(ONE, physics=True) == digest(replace(ONE, stops={}), physics=True)


def test_a_carried_stage_brings_its_stops():
    """Turned by a quarter on another one its gap is along y, between the platform and the body that it stands on."""
    fine = replace(ONE, stops={"E1-E2": Stop(PLATFORM, Polar(ARM, 0.0, InstanceOrientation.OUTWARD), 5 * um)})
    coarse = mount(Mechanism("both", materials=ONE.materials), "z", ONE, platform=False)
    both = mount(coarse, "fine", fine, on="z/platform", pose=Pose((0.0, 0.0, 40 * mm), along=(0.0, 1.0, 0.0)))
    assert not check(both)
    assert (both.stops["fine/E1"].body, both.stops["fine/E2"].base) == (PLATFORM, "z/platform")
    held, free = strokes(both), strokes(ONE)
    assert held.coordinates == ("x", "y")
    np.testing.assert_allclose(held.high, [free.high.item(), 5 * um], rtol=1e-9)
    np.testing.assert_allclose(held.low, [free.low.item(), -5 * um], rtol=1e-9)
    assert held.limiting == ("z/B", "stops/fine/E1")


def test_faulty_stops_are_told():
    def told(**stops):
        return "\n".join(map(str, check(replace(ONE, stops=stops))))

    assert 'stops.end.body: unknown body "platfrom"' in told(end=Stop("platfrom", FACE, GAP))
    assert 'stops.end.base: unknown body "grund"' in told(end=Stop(PLATFORM, FACE, GAP, base="grund"))
    assert 'stops.end.base: equal to the body, "platform"' in told(end=Stop(PLATFORM, FACE, GAP, base=PLATFORM))
    assert "stops.end.gap" in told(end=Stop(PLATFORM, FACE, 0.0))
    assert "stops.end.gap_negative" in told(end=Stop(PLATFORM, FACE, GAP, -1.0 * um))
    assert "stops.E2-E1" in told(**{"E2-E1": Stop(PLATFORM, FACE, GAP)})
