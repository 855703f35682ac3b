"""A voice coil on a leaf parallelogram of one freedom, by hand: x/i = k_f / (k - m w^2 + j w c), c = c_own + k_f^2/R."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.assessment.judge import bench_of, judge
from flexstage.analysis.complete import analyse
from flexstage.analysis.dynamics.response import response
from flexstage.analysis.workspace.force_workspace import force_workspace, input_limits
from flexstage.base.finding import DesignError
from flexstage.base.units.scale import X, Z, mm
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Force, Link, Mechanism, ModalDamping, StructuralDamping
from flexstage.mechanism.restrict import restrict
from flexstage.models.ideal import ideal
from flexstage.models.linear.damping import modal_ratios
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.port import ports
from flexstage.models.linear.state_space import state_space
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.force_actuator import ForceActuator
from flexstage.parts.freedom import Freedom
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod
from flexstage.parts.spring import Spring
from flexstage.parts.voice_coil import Supply, VoiceCoil
from flexstage.show.sections.reach import workspace_section

YOUNG, LENGTH, THICKNESS, WIDTH = 200e9, 50 * mm, 0.4 * mm, 20 * mm
COIL = VoiceCoil(force_constant=12.0, resistance=6.0, mass=0.1, magnet_mass=0.4, damping=0.5)
MASS = 0.9
"""Of the platform without the coil [kg]; the magnet stands on the ground."""


UNDAMPED = ModalDamping(0.0)


def stage(coil=COIL, damping=UNDAMPED):
    """Two leaves along y, 60 mm apart, let the platform move along x; nothing else of them gives way."""
    leaf = Leaf("steel", length=LENGTH, thickness=THICKNESS, width=WIDTH)
    links = {
        name: Link((GROUND, PLATFORM), "leaf", (at, 0.5 * LENGTH, 0.0), (0.0, -1.0, 0.0), bends=Z)
        for name, at in (("left", -30 * mm), ("right", 30 * mm))
    }
    whole = Mechanism(
        name="voice coil on a parallelogram",
        materials={"steel": Material(young=YOUNG, poisson=0.3, density=7800.0)},
        parts={"leaf": leaf, "coil": coil},
        bodies={PLATFORM: Body(mass=MASS, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-3, 1e-3, 1e-3))},
        links=links | {"motor": Link((GROUND, PLATFORM), "coil", (-40 * mm, 0.0, 0.0), X)},
        damping=damping,
    )
    return restrict(whole, {"leaf": ((Freedom.Y,), ())})


def by_hand(model, frequencies, coil=COIL, damped=None):
    """x/i in m/A, with the stiffness of the model's own statics."""
    stiffness = 1.0 / static_gain(model, ("platform.x",), ("platform.fx",)).values.item()
    omega = 2.0 * np.pi * frequencies
    damper = coil.damping if damped is None else damped
    return coil.force_constant / (stiffness - (MASS + coil.mass) * omega**2 + 1j * omega * damper)


def test_force_map_and_static_motion_per_ampere():
    """Leaves between parallel faces: 12 E I / L^3 each, as plates in bending E / (1 - nu^2) at most; 12 N/A along x."""
    found, model = ideal(stage()), lumped(stage())
    assert found.force_map.values.tolist() == [[12.0]]
    assert (found.force_map.rows, found.force_map.columns, found.force_map.unit) == (("fx",), ("motor",), (("N/A",),))
    beam = 2.0 * YOUNG * WIDTH * THICKNESS**3 / LENGTH**3
    per_ampere = static_gain(model, ("platform.x",), ("motor",))
    assert per_ampere.unit == (("m/A",),)
    assert COIL.force_constant / beam * (1.0 - 0.3**2) < per_ampere.values.item() < COIL.force_constant / beam * 1.001


def test_bode_plot_current_drive():
    """The whole curve, its resonance at sqrt(k/m) / (2 pi) of the coil's mass too, and -40 dB a decade above."""
    model = lumped(stage())
    natural = float(np.sqrt(eigen(model).values[0])) / (2.0 * np.pi)
    grid = natural * np.array([1e-3, 0.3, 0.99, 1.0, 1.01, 3.0, 100.0, 1000.0])
    found = response(model, ("platform.x",), ("motor",), grid).at("platform.x", "motor")
    assert found == pytest.approx(by_hand(model, grid), rel=1e-9)
    assert np.abs(found[-2] / found[-1]) == pytest.approx(100.0, rel=1e-3)
    assert np.abs(found[3]) == pytest.approx(COIL.force_constant / (2.0 * np.pi * natural * COIL.damping), rel=1e-9)


def test_bode_plot_voltage_drive():
    """Back-EMF adds k_f^2/R = 24 N s/m to the 0.5 N s/m of the coil, and the ratio c / (2 sqrt(k m)) is that of the mode."""
    coil = replace(COIL, drive=Supply.VOLTAGE)
    assert coil.viscous_damping == 24.5
    model = lumped(stage(coil))
    grid = np.array([0.1, 3.0, 7.0, 20.0, 300.0])
    expected = by_hand(model, grid, coil, damped=24.5)
    assert response(model, ("platform.x",), ("motor",), grid).at("platform.x", "motor") == pytest.approx(expected, rel=1e-9)
    stiffness = 1.0 / static_gain(model, ("platform.x",), ("platform.fx",)).values.item()
    ratio = 24.5 / (2.0 * np.sqrt(stiffness * (MASS + coil.mass)))
    assert modal_ratios(model, eigen(model), ModalDamping(0.0)) == pytest.approx([ratio], rel=1e-9)
    chosen = ports(model, ("platform.x",), ("motor",))
    assert state_space(model, chosen, ModalDamping(0.0)).transfer(grid)[:, 0, 0] == pytest.approx(expected, rel=1e-9)


def test_magnets_and_structural_damping():
    """Negative magnetic stiffness lowers the stage's, and the loss factor of steel turns with the coil's own damping."""
    steel = replace(stage().materials["steel"], loss_factor=0.02)
    pulling = replace(COIL, stiffness=-1000.0)
    plain, pulled = (replace(stage(coil, StructuralDamping()), materials={"steel": steel}) for coil in (COIL, pulling))
    stiffness = [1.0 / static_gain(lumped(each), ("platform.x",), ("platform.fx",)).values.item() for each in (plain, pulled)]
    assert stiffness[1] - stiffness[0] == pytest.approx(-1000.0, rel=1e-9)
    omega = 2.0 * np.pi * 5.0
    expected = 12.0 / (stiffness[1] + 0.02j * stiffness[0] - 1.0 * omega**2 + 0.5j * omega)
    found = response(lumped(pulled), ("platform.x",), ("motor",), np.array([5.0])).at("platform.x", "motor")
    assert found == pytest.approx([expected], rel=1e-9)


def test_the_magnet_may_move():
    """With the coil on the ground the magnet's mass goes with the platform."""
    moving = lumped(stage(replace(COIL, coil=COIL.coil.FIRST)))
    fixed = lumped(stage())
    ratio = eigen(fixed).values[0] / eigen(moving).values[0]
    assert ratio == pytest.approx((MASS + COIL.magnet_mass) / (MASS + COIL.mass), rel=1e-9)


LIMITED = replace(
    COIL,
    peak_current=4.0,
    continuous_current=1.8,
    voltage=12.0,
    maximum_force=40.0,
    thermal_resistance=5.0,
    temperature_rise=60.0,
    duty=0.25,
)


def test_reach_is_the_least_limit_over_stiffness():
    """Held for ever heat ends it at sqrt(60 K / (5 K/W 6 ohm)) = 1.414 A; a quarter of the time the voltage does, at 12 V / 6 ohm = 2 A."""
    mechanism = stage(LIMITED)
    model = lumped(mechanism)
    found = force_workspace(mechanism, ideal(mechanism), model)
    per_ampere = static_gain(model, ("platform.x",), ("motor",)).values.item()
    by_cause = dict(zip(found.bounds.columns, found.bounds.values[0] / per_ampere, strict=True))
    expected = {"peak current": 4.0, "continuous current": 1.8, "heat": 2.0**0.5, "voltage": 2.0, "maximum force": 40.0 / 12.0}
    assert by_cause == pytest.approx({f"motor {cause}": value for cause, value in expected.items()}, rel=1e-9)
    assert found.limited_by == ("motor heat",)
    assert input_limits(mechanism, model).high == pytest.approx([2.0], rel=1e-9)  # short use: heat only at 2.83 A
    assert found.held_briefly == pytest.approx([2.0 * per_ampere], rel=1e-9)
    needs = [each.values.item() for each in (found.current, found.voltage, found.power, found.rise)]
    assert needs == pytest.approx([2.0**0.5, 6.0 * 2.0**0.5, 12.0, 60.0], rel=1e-9)


def test_a_coil_does_not_bound_what_it_does_not_move():
    """Crosstalk that is rounding is no slope: the other axis' coil never reaches its limit."""
    mechanism = case("voice-coil-xy")
    found = force_workspace(mechanism, ideal(mechanism), lumped(mechanism))
    for axis, other, row in zip(found.bounds.rows, ("D2", "D1"), np.isinf(found.bounds.values), strict=True):
        assert row.tolist() == [cause.startswith(other) for cause in found.bounds.columns], axis
    assert np.count_nonzero(found.per_motion.values) == 2


def pushed(rods: bool, along: tuple[float, float, float]) -> Mechanism:
    """A platform on three rods along x, or on a spring without coupling, and a force through its middle."""
    rod, spring = Rod("steel", 40 * mm, 0.8 * mm), Spring(diagonal=(1e4, 2e4, 3e4, 5.0, 6.0, 7.0))
    places = ((-20 * mm, 20 * mm, 0.0), (-20 * mm, -10 * mm, 17 * mm), (-20 * mm, -10 * mm, -17 * mm)) if rods else ((0.0, 0.0, 0.0),)
    links = {f"held{number}": Link((GROUND, PLATFORM), "held", at, X, bends=Z) for number, at in enumerate(places)}
    return Mechanism(
        name="pushed",
        materials={"steel": Material(young=YOUNG, poisson=0.3, density=7800.0, yield_stress=1.5e9)},
        parts={"held": rod if rods else spring, "push": ForceActuator(maximum=10.0)},
        bodies={PLATFORM: Body(mass=0.2, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-4, 1e-4, 1e-4), reference=(0.0, 0.0, 0.0))},
        links=links | {"motor": Link((GROUND, PLATFORM), "push", (0.0, 0.0, 0.0), along)},
        gravity=(0.0, 0.0, 0.0),
    )


@pytest.mark.parametrize(("rods", "along", "moved", "unmoved"), [(False, X, "x", "y z rx ry rz"), (True, Z, "z", "y rx")])
def test_motions_that_no_force_causes_have_no_reach(rods, along, moved, unmoved):
    """A gain of zero, or of rounding, is none: neither a failure nor a stroke of 1e-23 m."""
    mechanism = pushed(rods, along)
    found = force_workspace(mechanism, ideal(mechanism), lumped(mechanism))
    assert (found.coordinates, found.unmoved) == ((moved,), tuple(unmoved.split()))
    assert 0.0 < found.held.item() <= 10.0 * static_gain(lumped(mechanism), (f"platform.{moved}",), ("motor",)).values.item() * (1 + 1e-9)
    verdict = judge(replace(mechanism, requirements={"stroke.y": "at least 1 um"}))[0]
    assert verdict.value is None
    assert "no actuator drives this motion" in verdict.reason
    assert analyse(mechanism).force_workspace is not None


def test_a_stage_that_no_force_moves_is_refused():
    mechanism = pushed(rods=True, along=X)
    with pytest.raises(DesignError, match=r"no actuator moves platform along any ideal motion \(y, z, rx\)"):
        force_workspace(mechanism, ideal(mechanism), lumped(mechanism))


def test_designs_whose_force_turns_off_a_motion_have_none_of_it():
    """A batch in which the force is along x, between x and y, and along y."""
    mechanism = pushed(rods=False, along=X)
    angles = np.array([0.0, 0.3, 0.5 * np.pi])
    motor = replace(mechanism.links["motor"], along=(np.array([1.0, np.cos(0.3), 0.0]), np.array([0.0, np.sin(0.3), 1.0]), 0.0))
    several = replace(mechanism, links={**mechanism.links, "motor": motor})
    found = force_workspace(several, ideal(several), lumped(several))
    assert found.coordinates == ("x", "y")
    expected = np.stack([10.0 * np.abs(np.cos(angles)) / 1e4, 10.0 * np.abs(np.sin(angles)) / 2e4], axis=-1)
    expected[[0, 2], [1, 0]] = np.nan
    assert found.held == pytest.approx(expected, rel=1e-9, nan_ok=True)


def test_travel_and_a_stress_end_the_reach_too():
    """A coil of 0.2 mm travel goes 0.1 mm either way; where nothing is stated, nothing is known, and a requirement says so."""
    short = stage(replace(COIL, travel=0.2 * mm))
    found = force_workspace(short, ideal(short), lumped(short))
    assert (found.held.item(), found.limited_by) == (pytest.approx(0.1 * mm, rel=1e-9), ("motor travel",))
    verdict = judge(replace(stage(), requirements={"stroke.x": "at least 50 um"}))[0]
    assert verdict.value is None
    assert "the actuators of this motion have no specified limit" in verdict.reason


def test_yield_of_the_leaves_ends_the_reach():
    """Guided leaves without end rotation bear sigma = 3 E t d / L^2 at their ends: 0.5 mm at 240 MPa, plate action aside."""
    mechanism = stage(replace(COIL, peak_current=1e3))
    steel = replace(mechanism.materials["steel"], yield_stress=3.0 * YOUNG * THICKNESS * 0.5 * mm / LENGTH**2)
    leaf = replace(mechanism.parts["leaf"].part, width=1.0 * mm)
    free = replace(mechanism, materials={"steel": steel}, parts={**mechanism.parts, "leaf": leaf}, gravity=(0.0, 0.0, 0.0))
    found = force_workspace(free, ideal(free), lumped(free))
    assert found.limited_by == ("yield stress",)
    assert found.held.item() == pytest.approx(0.5 * mm, rel=0.05)


@pytest.mark.parametrize(("share", "left"), [(0.5, 0.5), (0.99, 0.01), (1.01, 0.0)])
def test_a_permanent_load_near_yield_leaves_little_reach(share: float, left: float):
    """A constant force along x bends the leaves by a share of the motion at yield; the rest of this motion remains, none beyond."""
    mechanism = stage(replace(COIL, peak_current=1e3))
    steel = replace(mechanism.materials["steel"], yield_stress=240e6)
    leaf = mechanism.parts["leaf"].part
    free = replace(mechanism, materials={"steel": steel}, parts={**mechanism.parts, "leaf": leaf}, gravity=(0.0, 0.0, 0.0))
    reach = force_workspace(free, ideal(free), lumped(free)).held.item()
    push = share * reach / static_gain(lumped(free), ("platform.x",), ("platform.fx",)).values.item()
    at = tuple(expand(free).bodies[PLATFORM].reference.tolist())
    pushed = replace(free, forces={"load": Force(PLATFORM, at, (push, 0.0, 0.0))})
    found = force_workspace(pushed, ideal(pushed), lumped(pushed))
    assert found.held.item() == pytest.approx(left * reach, rel=1e-9, abs=1e-15)


def test_stress_without_required_strokes_is_not_said_to_be_at_peak_current():
    """The amplifier's 12 V over 6 ohm allow 2 A, half the peak current of the coil."""
    whole = stage(LIMITED)
    bench = bench_of(replace(whole, parts={**whole.parts, "leaf": whole.parts["leaf"].part}))
    assert np.max(np.abs(bench.stress.worst_strokes.values)) == pytest.approx(2.0)
    assert bench.stress.condition == "of all strokes and forces (coils at their limits in short use)"


def test_requirements_of_what_holding_takes():
    """50 um by hand: i = d/(x/i), R i, k_f i, i^2 R, i^2 R R_th."""
    lines = {"stroke.x": "at least 50 um"} | {
        key: f"at most {limit}"
        for key, limit in zip(
            ("current.x", "voltage.x", "thrust.x", "power.x", "heating.x"), ("1 A", "9 V", "20 N", "9 W", "40 K"), strict=True
        )
    }
    mechanism = replace(stage(LIMITED), requirements=lines)
    held = 50e-6 / static_gain(lumped(mechanism), ("platform.x",), ("motor",)).values.item()
    found = [verdict.value.item() for verdict in judge(mechanism)[1:]]
    assert found == pytest.approx([held, 6.0 * held, 12.0 * held, 6.0 * held**2, 30.0 * held**2], rel=1e-9)


def test_redundant_coils_share_by_their_limits():
    """Two coils on one freedom: the one of thrice the current takes thrice of it, and together they reach four times as far."""
    one, two = replace(COIL, peak_current=1.0), replace(COIL, peak_current=3.0)
    single = stage(one)
    links = {**single.links, "second": Link((PLATFORM, GROUND), "strong", (40 * mm, 0.0, 0.0), X)}
    both = replace(single, parts={**single.parts, "strong": two}, links=links)
    alone, together = (force_workspace(each, ideal(each), lumped(each)) for each in (single, both))
    assert together.current.values[0] == pytest.approx([1.0, 3.0], rel=1e-9)
    assert together.held.item() == pytest.approx(4.0 * alone.held.item(), rel=1e-9)


def test_the_report_shows_the_reach():
    """Where strokes would stand: how far, and what holding it takes."""
    shown = workspace_section(analyse(stage(LIMITED)))
    assert shown is not None
    assert shown.title == "Force workspace"
    compared = ["Drive force per displacement, compared with the ideal guide", "Drive force by flexure"]
    assert [each.title for each in shown.blocks] == ["Reach", "Coil inputs at the continuous travel", *compared]
