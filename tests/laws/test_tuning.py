"""Laws of tuning on random stages: what is judged reached is stable by the verdict, with the gain and the peak that were asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.dynamics.modes import modes
from flexstage.control.controllers.loops import Loops, actuator_loops, loop_modes, modal_loops, platform_loops
from flexstage.control.controllers.lqg import Disturbances
from flexstage.control.plant_models.electronics import Hardware
from flexstage.control.plant_models.plants import Plant, plant
from flexstage.control.robustness.stability import verdict
from flexstage.control.robustness.stability_margins import peaks
from flexstage.control.systems.closed import LoopBreak, loop, open_at
from flexstage.control.tuning.attempt import BandwidthTrial
from flexstage.control.tuning.judge import judge_loop
from flexstage.control.tuning.laws import FAMILIES, LQG_FAMILY
from flexstage.control.tuning.spec import TuningSpec
from flexstage.control.tuning.view import view
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import PLATFORM, Probe
from flexstage.parts.gauge import SensorSense
from flexstage.spatial.frame import axes
from tests.conftest import examples
from tests.laws.shared import ideal, lumped
from tests.laws.strategies import platforms


@st.composite
def plants(draw) -> tuple[Plant, Loops]:
    """A platform of one to six axes with a gauge along every strut, sampled 10 to 60 times a period of its lowest mode, up to 2 late."""
    wires = draw(st.integers(0, 5))
    mechanism, lines, _ = draw(platforms(wires, 6 - wires + draw(st.integers(0, 1))))
    poses = [Pose(point, along, tuple(axes(tuple(map(float, along)))[:, 2].tolist())) for point, along in lines]
    gauges = {f"S{number + 1}": Probe("gauge", PLATFORM, pose, SensorSense.OPENS) for number, pose in enumerate(poses)}
    stage = replace(mechanism, gauges=gauges)
    model, kinematics = lumped(stage), ideal(stage)
    found = modes(model)
    rate = float(found.frequencies[0]) * draw(st.integers(10, 60))
    one = plant(model, kinematics, Hardware(rate=rate, delay=draw(st.sampled_from([0.0, 0.3, 1.0, 1.7])) / rate), modes=6)
    count = len(kinematics.coordinates)
    kinds = [platform_loops(one.coordinates)]
    kinds.append(modal_loops(one.coordinates, found.platform_shapes[:, list(loop_modes(found, one.coordinates))]))
    if len(one.actuators) == count:
        kinds.append(actuator_loops(one.coordinates))
    return one, draw(st.sampled_from(kinds))


@examples(5)
@given(case=plants(), kind=st.sampled_from(list(FAMILIES.values())), part=st.sampled_from([0.005, 0.05, 0.3, 0.8]))
def test_what_is_judged_reached_is_reached(case, kind, part):
    """Eigenvalues with hold and delay, the gain of each loop at the frequency, the exact peak of S; judgements of others are right too."""
    one, loops = case
    if kind == LQG_FAMILY:
        loops = platform_loops(one.coordinates)
    asked = part * float(one.frequencies[0])
    noise = Disturbances(1e-9, dict.fromkeys(one.gauges, 1e-10))
    spec = TuningSpec(kind, None, 2.0, 0.0, expected=noise)
    seen = view(one, loops, 0.0)
    found = BandwidthTrial(seen, spec, asked).best()
    if found is None:
        return
    system = found.controller.system(one.hardware.step)
    closed = loop(one, system)
    assert verdict(closed).stable == found.judgement.stable
    again = judge_loop(seen, system)
    np.testing.assert_allclose([again.peak, *again.bandwidths], [found.judgement.peak, *found.judgement.bandwidths], rtol=1e-6)
    if not found.reaches():
        return
    gains = open_at(closed, LoopBreak.POSE).transfer(np.array([asked]))[0]
    own = np.diag(loops.sense @ gains @ np.linalg.inv(loops.sense))
    np.testing.assert_allclose(np.abs(own), 1.0, rtol=0.01)
    assert peaks(closed, LoopBreak.POSE).sensitivity.value <= spec.sensitivity * 1.02
