"""Laws of motions that no stiffness holds, on random stages with ideal joints: they take their inertia along and decide nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.linalg import eigh

from flexstage.analysis.assessment.sensitivities import sensitivities
from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.dynamics.response import response
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import EQUATION_18, double_triangle
from flexstage.mechanism.addresses.address import addresses, get, set_value
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import PLATFORM, ModalDamping, Probe
from flexstage.mechanism.restrict import restrict
from flexstage.models import lumped as models
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.port import ports
from flexstage.models.linear.state_space import state_space
from flexstage.models.linear.static import static_gain
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.parts.gauge import SensorSense
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from tests.conftest import examples
from tests.laws.shared import ideal, lumped
from tests.laws.strategies import actuated_platforms, moved, places, platforms, turns
from tests.laws.test_mechanisms import TWIST, jointed, platform_compliance, rounding

SOFTEST = 1e-7
"""Stiffness [N m/rad] that a joint has in the limit: a millionth of what the stages' own hinges have, and less."""


def idle_stages():
    """Random platforms whose hinges are ideal joints: struts and wires can spin about themselves."""
    return actuated_platforms().map(jointed).filter(lambda stage: bool(lumped(stage).idle))


def softened(mechanism, stiffness):
    """Ideal joints with a little stiffness where they are free."""
    compliance = tuple(tuple(1.0 / stiffness if row == column else 0.0 for column in range(6)) for row in range(6))
    parts = {
        name: Restricted(ComplianceMatrix(compliance, part.free), part.free) if isinstance(part, Joint) else part
        for name, part in mechanism.parts.items()
    }
    return replace(mechanism, parts=parts)


@examples(8)
@given(idle_stages())
def test_modes_are_those_of_joints_with_less_and_less_stiffness(mechanism):
    """As many modes fall to zero as there are idle freedoms; the others stay, whatever the idle ones weigh."""
    model, soft = lumped(mechanism), lumped(softened(mechanism, SOFTEST))
    assert not soft.idle
    assume(np.all(np.linalg.norm(model.idle_inertia, axis=1) > 1e-9))
    expected = eigh(soft.stiffness_matrix, soft.inertia_matrix, eigvals_only=True)[len(model.idle) :]
    found = eigen(model).values[:3]
    assert np.allclose(found, expected[: len(found)], rtol=1e-8)


@examples(8)
@given(idle_stages(), turns())
def test_turning_the_stage_changes_no_frequency(mechanism, move):
    """Which coordinates are named idle follows from the axes; no frequency and no compliance does."""
    still, turned = lumped(mechanism), lumped(moved(mechanism, *move))
    before, after = eigen(still).values, eigen(turned).values
    assert len(still.idle) == len(turned.idle)
    tolerance = 10.0 * (rounding(still) + rounding(turned)) * (1.0 + before[:3] / before[0])
    assert np.all(np.abs(after[:3] / before[:3] - 1.0) < tolerance)
    sizes = [np.sort(np.linalg.eigvalsh(platform_compliance(model)[:3, :3])) for model in (still, turned)]
    assert np.allclose(*sizes, rtol=0.0, atol=10.0 * (rounding(still) + rounding(turned)) * sizes[0].max())


@examples(8)
@given(idle_stages())
def test_the_floor_carries_the_platform_along(mechanism):
    """Idle bodies stay behind where only inertia would turn them; the platform follows, and the state space says the same."""
    model, law = lumped(mechanism), ModalDamping(0.02)
    slow = np.array([1e-4 * np.sqrt(eigen(model).values[0]) / (2.0 * np.pi)])
    followed = response(model, ["platform"], ["ground"], slow, damping=law).values[0]
    scale = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])
    assert np.allclose(followed * scale[:, None] / scale, np.eye(6), atol=1e-6)
    first = min(model.idle).rpartition(".")[0]
    grid, names = np.array([0.3, 0.9, 2.0]) * slow * 1e4, (["platform", first], ["ground"])
    direct = response(model, *names, grid, damping=law).values
    assert np.allclose(state_space(model, ports(model, *names), law).transfer(grid), direct, atol=1e-7 * np.abs(direct).max())


@examples(8)
@given(idle_stages(), st.data())
def test_derivatives_are_differences(mechanism, data):
    """Also those through the idle motions, whose directions and inertia change with the design."""
    picked = data.draw(st.sampled_from([name for name in addresses(mechanism) if name.startswith("units.") and get(mechanism, name)]))
    value, step = get(mechanism, picked), 1e-4
    found = sensitivities(mechanism, (picked,), modes=3)
    ends = [np.sqrt(eigen(lumped(set_value(mechanism, picked, value * (1.0 + side)))).values[:3]) for side in (step, -step)]
    slopes = (ends[0] - ends[1]) / (2.0 * step) / np.sqrt(eigen(lumped(mechanism)).values[:3])
    alone = [group[0] for group in found.clusters if len(group) == 1]
    gaps = np.diff(found.frequencies) / found.frequencies[1:]
    assume(np.min(gaps, initial=1.0) > 0.02)
    assert np.allclose(found.relative_frequency.values[0][alone], slopes[alone], rtol=1e-4, atol=1e-6)


@examples(8)
@given(idle_stages())
def test_what_an_idle_motion_leaves_open_is_refused_by_name(mechanism):
    model = lumped(mechanism)
    body, component = min(model.idle).rpartition(".")[::2]
    wrench = f"{body}.m{component[1]}" if component.startswith("r") else f"{body}.f{component}"
    with pytest.raises(DesignError, match=body):
        ports(model, [f"{body}.{component}"], [wrench])
    assert response(model, ["platform"], [wrench], np.array([10.0]), damping=ModalDamping(0.01)).values.shape == (1, 6, 1)


def with_probes(mechanism, where):
    """The stage with a gauge on a body of every strut, beside its axis: it sees the strut spin."""
    bodies = [name for name in expand(mechanism).bodies if name != PLATFORM]
    return replace(mechanism, gauges={f"G-{name.replace('/', '-')}": _probe(name, where) for name in bodies})


def _probe(body, where):
    return Probe("gauge", body, Pose(where, (0.6, 0.0, 0.8), (0.0, 1.0, 0.0)), SensorSense.OPENS)


@examples(12)
@given(st.integers(1, 6).flatmap(lambda struts: platforms(6 - struts, struts)), places)
def test_gauges_on_spinning_struts_read_what_the_hinges_let_them(drawn, where):
    """R_s x of ideal kinematics is the gauges' reading in the lumped model of which only the free freedoms give way."""
    mechanism = with_probes(drawn[0], where)
    kinematics = ideal(mechanism)
    assume(kinematics.actuated)
    hinges = {name: Restricted(part, () if isinstance(part, Piezo) else part.intended, ()) for name, part in mechanism.parts.items()}
    model = lumped(replace(mechanism, parts=hinges))
    read = static_gain(model, kinematics.gauges, kinematics.actuators).values
    found = kinematics.sensing @ static_gain(model, TWIST, kinematics.actuators).values
    assert np.allclose(found, read, rtol=0.0, atol=1e-7 * max(1.0, np.abs(read).max()))


@examples(8)
@given(idle_stages(), places)
def test_gauges_on_struts_that_spin_freely_are_refused_by_name(mechanism, where):
    watched = with_probes(mechanism, where)
    spinning = min(lumped(watched).idle).rpartition(".")[0]
    with pytest.raises(DesignError, match=f"G-{spinning.replace('/', '-')}"):
        ideal(watched)
    with pytest.raises(DesignError, match=f"G-{spinning.replace('/', '-')}"):
        static_gain(lumped(watched), tuple(watched.gauges), lumped(watched).strokes)


def test_idle_motions_that_only_rounding_moves_have_no_inertia() -> None:
    """Massless struts turned by 120 degrees: what of their spin reaches the platform is rounding, and must not become a mode."""
    simple = {name: EQUATION_18[name] for name in EQUATION_18 if name != "stack_horizontal"}
    model = models.lumped(restrict(double_triangle(), simple), models.Masses.PLATFORM)
    assert np.all(np.isfinite(modes(model).platform_frequencies))
    assert np.linalg.eigvalsh(model.stiffness_matrix)[0] > 0.0
