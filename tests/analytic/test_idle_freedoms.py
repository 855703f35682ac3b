"""A hexapod of rods between ball joints in closed form: how a rod resists spinning about itself cannot matter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.workspace.load import applied_forces, dead_loads
from flexstage.base.finding import DesignError
from flexstage.mechanism.mechanism import Force, Link, Mechanism
from flexstage.models.linear.static import displacement, static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.part import Restricted
from flexstage.spatial.frame import COMPONENTS, FORCES, cross_matrix

TURNS = (Freedom.RX, Freedom.RY, Freedom.RZ)
SOFT = 2e7
ROD, LENGTH = 0.3, 0.08
MASS, MOMENTS = 1.4, (2e-3, 2e-3, 3e-3)


def struts():
    """Heads and directions of six rods in three pairs around z."""
    for turn in np.deg2rad((0.0, 120.0, 240.0)):
        about = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
        for side in (1.0, -1.0):
            yield about @ (0.055, side * 0.012, -0.01), about @ np.array([0.0, -side * 0.8, 0.6])


def hexapod(spin):
    """Rods with the inertia `spin` about themselves, on springs along themselves, between ball joints."""
    compliance = tuple(tuple(1.0 / SOFT if row == column == 0 else float(row == column) for column in range(6)) for row in range(6))
    parts = {"foot": Restricted(ComplianceMatrix(compliance, TURNS), (Freedom.X,), TURNS), "head": Joint(TURNS)}
    bodies, links = {"platform": Body(mass=MASS, inertia=Inertia(*MOMENTS), centre=(0.0, 0.0, 0.0))}, {}
    for number, (head, along) in enumerate(struts()):
        middle = head - 0.5 * LENGTH * along
        tensor = ROD * LENGTH**2 / 12.0 * (np.eye(3) - np.outer(along, along)) + spin * np.outer(along, along)
        moments = Inertia(*np.diag(tensor), *-tensor[[0, 0, 1], [1, 2, 2]])
        bodies[f"rod{number}"] = Body(mass=ROD, centre=tuple(middle), inertia=moments)
        for name, joins, at in (("foot", ("ground", f"rod{number}"), head - LENGTH * along), ("head", (f"rod{number}", "platform"), head)):
            links[f"{name}{number}"] = Link(joins, name, tuple(at), tuple(along))
    return Mechanism("rods between balls", parts=parts, bodies=bodies, links=links)


def closed_form():
    """K and M of the platform's twist: a rod follows its head, along itself as a whole and across as it turns about its foot."""
    K, M = np.zeros((6, 6)), np.diag([MASS] * 3 + list(MOMENTS))
    for head, along in struts():
        carry = np.hstack([np.eye(3), -cross_matrix(head)])
        line = along @ carry
        K += SOFT * np.outer(line, line)
        M += carry.T @ (ROD / 3.0 * np.eye(3) + (ROD - ROD / 3.0) * np.outer(along, along)) @ carry
    return K, M


@pytest.mark.parametrize("spin", [0.0, 1e-7, 1e-4, 1.0])
def test_spin_of_rods_between_ball_joints_matters_to_nothing(spin):
    K, M = closed_form()
    expected = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)) / (2.0 * np.pi)
    model = lumped(hexapod(spin))
    found = modes(model).frequencies
    assert len(found) == 6
    assert np.allclose(found, expected, rtol=1e-9)
    pairs = found[[0, 1]] if np.isclose(expected[0], expected[1]) else found[[1, 2]]
    assert abs(pairs[1] / pairs[0] - 1.0) < 1e-9
    compliance = static_gain(model, tuple(f"platform.{name}" for name in COMPONENTS), tuple(f"platform.{name}" for name in FORCES)).values
    assert np.allclose(compliance, np.linalg.inv(K), rtol=1e-9, atol=1e-9 * np.abs(np.linalg.inv(K)).max())


def test_a_rod_that_spins_freely_follows_its_head_all_the_same():
    """Along itself as a whole, across by half at its middle, and it turns about its foot; how far it spins is not told by anything."""
    model = lumped(hexapod(1e-4))
    forces = tuple(f"platform.{name}" for name in FORCES)
    platform = static_gain(model, tuple(f"platform.{name}" for name in COMPONENTS), forces).values
    for number, (head, along) in enumerate(struts()):
        moved = np.hstack([np.eye(3), -cross_matrix(head)]) @ platform
        line = np.outer(along, along)
        rod = static_gain(model, tuple(f"rod{number}.{name}" for name in COMPONENTS), forces).values
        np.testing.assert_allclose(rod[:3], (line + 0.5 * (np.eye(3) - line)) @ moved, rtol=0.0, atol=1e-9 * np.abs(moved).max())
        turned = cross_matrix(along) @ moved / LENGTH
        np.testing.assert_allclose((np.eye(3) - line) @ rod[3:], turned, rtol=0.0, atol=1e-9 * np.abs(turned).max())


def test_loads_that_turn_a_rod_about_itself_have_no_rest():
    """A force beside a rod's axis, or the weight of a rod whose centre lies beside it; through the axis both are borne."""
    stage = hexapod(1e-4)
    head, along = next(struts())
    middle, across = head - 0.5 * LENGTH * along, np.array([1.0, 0.0, 0.0])
    model = lumped(stage)
    borne = Force("rod0", tuple(middle), tuple(across))
    assert np.all(np.isfinite(displacement(model, applied_forces(stage, model, borne))))
    beside = tuple(middle + 1e-4 * np.cross(along, across))
    with pytest.raises(DesignError, match=r"a force on rod0: drives a free internal mode \(zero stiffness\).*rod0"):
        applied_forces(stage, model, replace(borne, at=beside))
    hanging = replace(stage, gravity=(0.0, 0.0, -9.80665))
    assert len(dead_loads(hanging, lumped(hanging))) == 1
    lopsided = replace(hanging, bodies={**hanging.bodies, "rod0": replace(hanging.bodies["rod0"], centre=tuple(middle + 1e-4 * across))})
    with pytest.raises(DesignError, match=r"gravity: drives a free internal mode \(zero stiffness\).*rod0"):
        dead_loads(lopsided, lumped(lopsided))


def test_a_force_at_a_point_beside_a_rod_has_no_answer_at_rest():
    """At a point on the axis it has one."""
    stage = hexapod(1e-4)
    head, along = next(struts())
    middle = head - 0.5 * LENGTH * along
    points = {"on": tuple(middle), "beside": tuple(middle + 0.003 * np.cross(along, (1.0, 0.0, 0.0)))}
    model = lumped(replace(stage, bodies={**stage.bodies, "rod0": replace(stage.bodies["rod0"], points=points)}))
    assert np.isfinite(static_gain(model, ("platform.x",), ("rod0.on.fx",)).values).all()
    with pytest.raises(DesignError, match=r"rod0\.beside\.fx: drives a free internal mode \(zero stiffness\)"):
        static_gain(model, ("platform.x",), ("rod0.beside.fx",))
