"""Controllers against python-control, an independent code: series of laws, Tustin's rule, linear-quadratic gains.

Its numbers are made at test time by the pinned version; it solves the same Riccati equations by its own formulation.
"""

from __future__ import annotations

import numpy as np

from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.control.controllers.decentralised import Decentralised, loop_systems
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.controllers.lqg import Disturbances, Weights, lqg
from flexstage.control.controllers.notch import Notch
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.pose_plant import pose_plant
from flexstage.control.plant_models.coordinates import coordinates
from flexstage.control.plant_models.electronics import Hardware
from flexstage.control.plant_models.plants import plant
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped

FREQUENCIES = np.geomspace(0.1, 4000.0, 60)
STEP = 1e-4


def test_a_row_of_law_and_notch_is_the_peer_s():
    """PID, filter and notch as transfer functions, multiplied and made digital by the other code."""
    import control as peer  # takes a third of a second, also where the tests are only listed

    s = peer.tf("s")
    omega, corner = 2.0 * np.pi * 110.9, 2.0 * np.pi * 1500.0
    law = 0.3 + 200.0 / s + 2e-3 * s / (1.0 + s / corner)
    notch = (s**2 + 2.0 * 0.02 * 0.5 * omega * s + omega**2) / (s**2 + 2.0 * 0.5 * omega * s + omega**2)
    loops = platform_loops(coordinates(ideal(parallelogram())))
    found = Decentralised(loops, (PID(0.3, 200.0, 2e-3, 1500.0),), ((Notch(110.9, 0.02, 0.5),),))
    continuous = loop_systems(found)[0].transfer(FREQUENCIES)[:, 0, 0]
    np.testing.assert_allclose(continuous, (law * notch)(2j * np.pi * FREQUENCIES), rtol=1e-9)
    digital = peer.c2d(law, STEP, "bilinear") * peer.c2d(notch, STEP, "bilinear", prewarp_frequency=omega)
    sampled = loop_systems(found, STEP)[0].transfer(FREQUENCIES)[:, 0, 0]
    np.testing.assert_allclose(sampled, digital(np.exp(2j * np.pi * FREQUENCIES * STEP)), rtol=1e-8)


def test_linear_quadratic_gains_are_the_peer_s():
    """Regulator with integrators and observer, sampled, of the shipped two-axis stage with four modes."""
    import control as peer

    stage = case("xy-stage")
    one = plant(lumped(stage), ideal(stage), Hardware(rate=5e3, delay=130e-6), modes=4)
    model = pose_plant(one)
    found = lqg(model, one.coordinates, Weights(30.0, 0.2), Disturbances(2e-9, dict.fromkeys(one.gauges, 1e-11)))
    states, step = len(model.A), model.step
    A = np.block([[model.A, np.zeros((states, 2))], [-step * model.C, np.eye(2)]])
    B = np.vstack([model.B, -step * model.D])
    C = np.hstack([model.C, np.zeros((2, 2))])
    cost = 0.2 * C.T @ C + (60.0 * np.pi) ** 2 * np.diag([0.0] * states + [1.0, 1.0])
    effort, cross = np.eye(2) + 0.2 * model.D.T @ model.D, 0.2 * C.T @ model.D
    gain = peer.dlqr(A, B, cost, effort, cross)[0]
    scale = np.max(np.abs(gain))
    np.testing.assert_allclose(np.hstack([found.regulator, -found.integral]), gain, rtol=1e-7, atol=1e-7 * scale)
    # noises in units of the gauges' density, which leaves the gains as they are
    pose = one.coordinates.pose
    noise = pose @ pose.T + 200.0**2 * model.D @ model.D.T
    state, both = 200.0**2 * model.B @ model.B.T, 200.0**2 * model.B @ model.D.T
    gain = peer.dare(model.A.T, model.C.T, 0.5 * (state + state.T), noise, both)[2].T
    np.testing.assert_allclose(model.A @ found.observer, gain, rtol=1e-6, atol=1e-6 * np.max(np.abs(gain)))
