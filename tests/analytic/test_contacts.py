"""Balls in their seats against closed forms of K. L. Johnson, Contact Mechanics (Cambridge, 1985), chapters 4, 6 and 7."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.caveats import defaults, design_warnings
from flexstage.analysis.loaded.seating import seated, seating
from flexstage.base.finding import DesignError
from flexstage.beams.compliance import compliance, stiffness
from flexstage.mechanism.assembly.expansion import ground_of
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Force, Link, Mechanism
from flexstage.mechanism.store import dumps, loads
from flexstage.models.batch.engine import plan, platform_modes
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.contact import Contact, Seat, hertz
from flexstage.parts.material import Material, Paired

STEEL = Material(young=210e9, poisson=0.3, density=7850.0, yield_stress=1.0e9)
GLASS = Material(young=70e9, poisson=0.2, density=2500.0)
PAIR = Paired.of(STEEL, STEEL)
FLAT = Contact("steel", "steel", radius=5e-3, preload=10.0)
GROOVE = replace(FLAT, seat=Seat.GROOVE, half_angle=0.25 * np.pi)


def test_a_steel_ball_of_5_mm_on_steel_under_10_newton():
    """By hand: E* = 210/1.82 = 115.38 GPa, G* = 80.77/3.4 = 23.756 GPa, a = (150e-3/(4 E*))^(1/3) = 68.75 um, p0 = 30/(2 pi a^2)."""
    found = hertz(FLAT, PAIR)
    np.testing.assert_allclose(found.spot, 68.755e-6, rtol=1e-4)
    np.testing.assert_allclose(found.normal, 15.866e6, rtol=1e-4)
    np.testing.assert_allclose(found.tangential, 13.066e6, rtol=1e-4)
    np.testing.assert_allclose(found.tangential / found.normal, 2.0 * (1.0 - 0.3) / (2.0 - 0.3), rtol=1e-12)  # Johnson, chapter 7
    np.testing.assert_allclose(seated(FLAT, PAIR, np.zeros(6)).pressure, 1010.0e6, rtol=1e-3)


def test_the_normal_stiffness_is_the_slope_of_force_over_approach():
    found = hertz(replace(FLAT, preload=10.0 + 1e-30j), Paired.of(STEEL, GLASS))
    modulus = 1.0 / (0.91 / 210e9 + 0.96 / 70e9)
    approach = (9.0 * (10.0 + 1e-30j) ** 2 / (16.0 * 5e-3 * modulus**2)) ** (1.0 / 3.0)
    np.testing.assert_allclose(found.normal.real, 1e-30 / approach.imag, rtol=1e-12)
    np.testing.assert_allclose(found.normal.imag / 1e-30, found.normal.real / 30.0, rtol=1e-12)  # k ~ F^(1/3)


def test_stiffness_grows_with_the_cube_root_of_the_preload():
    loads_ = np.array([1.0, 8.0, 1000.0])
    whole = stiffness(replace(GROOVE, preload=loads_), PAIR)
    np.testing.assert_allclose(whole / np.cbrt(loads_)[:, None, None], np.broadcast_to(whole[0], whole.shape), rtol=1e-12, atol=1e-6)


@pytest.mark.parametrize("part", [FLAT, GROOVE])
def test_stiffness_is_symmetric_and_nowhere_negative(part):
    whole = stiffness(part, Paired.of(STEEL, GLASS))
    np.testing.assert_allclose(whole, whole.T, rtol=1e-14)
    assert np.min(np.linalg.eigvalsh(whole)) > -1e-9 * np.max(whole)


def test_a_ball_rolls_and_spins_freely_about_its_contact_on_a_flat():
    whole = stiffness(FLAT, PAIR)
    for twist in ([0, 0, 0, 1, 0, 0], [0, 0, -5e-3, 0, 1, 0], [0, 5e-3, 0, 0, 0, 1]):
        np.testing.assert_allclose(whole @ np.array(twist), np.zeros(6), atol=1e-9 * np.max(whole))
    with pytest.raises(DesignError, match="singular stiffness"):
        compliance(FLAT, PAIR)


def test_a_groove_that_opens_becomes_two_contacts_on_a_flat():
    flat = 2.0 * stiffness(replace(FLAT, preload=5.0), PAIR)
    np.testing.assert_allclose(stiffness(replace(GROOVE, half_angle=0.5 * np.pi - 1e-9), PAIR), flat, rtol=1e-8, atol=1e-2)


def test_walls_of_a_groove_share_by_their_slope():
    """At 45 deg each wall bears F/sqrt(2); along x and y both give k_n + k_t, along z 2 k_t, and no force turns into another."""
    one = hertz(GROOVE, PAIR)
    np.testing.assert_allclose(one.force, 10.0 / np.sqrt(2.0))
    whole = stiffness(GROOVE, PAIR)
    both = one.normal + one.tangential
    np.testing.assert_allclose(np.diag(whole)[:3], [both, both, 2.0 * one.tangential], rtol=1e-12)
    np.testing.assert_allclose(whole[:3, :3], np.diag(np.diag(whole)[:3]), atol=1e-6)
    np.testing.assert_allclose(hertz(replace(GROOVE, half_angle=np.pi / 6.0), PAIR).force, 10.0)


def coupling(weight=30.0, **changed):
    """A platform on three balls in grooves towards its middle (Maxwell), that weigh on it as their preload says."""
    turns = 2.0 * np.pi * np.arange(3) / 3.0
    arms = [(float(np.cos(turn)), float(np.sin(turn)), 0.0) for turn in turns]
    links = {
        f"ball{number}": Link(("ground", "platform"), "ball", (0.05 * x, 0.05 * y, 0.0), (0.0, 0.0, 1.0), (x, y, 0.0))
        for number, (x, y, _) in enumerate(arms)
    }
    body = Body(mass=weight / 9.81, centre=(0.0, 0.0, 0.0), inertia=Inertia(2e-3, 2e-3, 2e-3))
    materials = {"steel": STEEL, "glass": GLASS}
    parts = {"ball": replace(GROOVE, **changed)}
    return Mechanism("coupling", materials=materials, parts=parts, bodies={"platform": body}, links=links, gravity=(0.0, 0.0, -9.81))


def test_a_coupling_of_three_grooves_is_determined_and_held():
    stage = coupling(counter="glass")
    assert not check(stage)
    assert loads(dumps(stage)) == stage
    assert ideal(stage).mobility == 0
    one = hertz(stage.parts["ball"], Paired.of(STEEL, GLASS))
    vertical = 3.0 * (one.normal + one.tangential) / (30.0 / 9.81)
    assert np.min(np.abs(eigen(lumped(stage)).values / vertical - 1.0)) < 1e-9


def test_studies_follow_the_material_of_the_seat():
    stage = coupling(counter="glass")
    found = platform_modes(plan(stage, ("materials.glass.young",)), np.array([[70e9], [90e9]])).frequencies
    stiffer = replace(stage, materials={"steel": STEEL, "glass": replace(GLASS, young=90e9)})
    for row, each in zip(found, (stage, stiffer), strict=True):
        np.testing.assert_allclose(row, np.sqrt(eigen(lumped(each)).values) / (2.0 * np.pi), rtol=1e-9)


def test_weight_that_balances_the_preload_leaves_it():
    found = seating(coupling(), lumped(coupling()))["ball0"]
    np.testing.assert_allclose([found.left, found.crush], [1.0, seated(GROOVE, PAIR, np.zeros(6)).pressure / 1.6e9], rtol=1e-9)
    assert np.isnan(found.slip)
    assert any("no slip by default" in str(each) for each in defaults(coupling()))
    assert not any("no slip by default" in str(each) for each in defaults(coupling(friction=0.2)))


def test_what_is_left_and_slips_where_nothing_balances_the_preload():
    """Both walls stick: of a pull F, k_n / (k_n + k_t) goes off the preload of walls at 45 deg, and what pulls along is what is left."""
    found = seated(replace(GROOVE, friction=0.2), PAIR, np.array([10.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    left = 1.0 - 1.0 / (1.0 + 1.4 / 1.7)
    np.testing.assert_allclose([found.left, found.slip], [left, 1.0 / 0.2], rtol=1e-9)


def test_a_ball_on_a_flat_lifts_off_and_slips_by_its_forces():
    """The force acts in the contact: about the centre it has a moment."""
    part = replace(FLAT, friction=0.2, preload=np.array([10.0, 20.0]))
    found = seated(part, PAIR, np.array([4.0, 3.0, 0.0, 0.0, 0.0, -3.0 * 5e-3]))
    np.testing.assert_allclose(found.left, [0.6, 0.8], rtol=1e-9)
    np.testing.assert_allclose(found.slip, [3.0 / 1.2, 3.0 / 3.2], rtol=1e-9)
    assert seated(FLAT, PAIR, np.array([12.0, 0.0, 0.0, 0.0, 0.0, 0.0])).left == pytest.approx(-0.2)
    pressed = seated(FLAT, PAIR, np.array([-70.0, 0.0, 0.0, 0.0, 0.0, 0.0])).pressure  # cube root of eight times the force
    assert pressed == pytest.approx(2.0 * seated(FLAT, PAIR, np.zeros(6)).pressure, rel=1e-9)


@pytest.mark.parametrize(
    ("stage", "what"),
    [
        (replace(coupling(), forces={"up": Force("platform", (0.0, 0.0, 0.0), (0.0, 0.0, 60.0))}), "the ball lifts off its seat"),
        (replace(coupling(friction=0.1), forces={"side": Force("platform", (0.0, 0.0, 0.0), (12.0, 0.0, 0.0))}), "the ball slips"),
        (coupling(radius=1e-3), "times the pressure at which the softer material yields"),
    ],
)
def test_balls_that_leave_their_seats_are_told(stage, what):
    assert any(what in str(finding) for finding in design_warnings(stage))
    assert not any(what in str(finding) for finding in design_warnings(coupling()))


@pytest.mark.parametrize(
    ("changed", "what"),
    [
        ({"preload": None}, "parts.ball.preload: preload missing: a contact without preload has no stiffness"),
        ({"preload": -1.0}, "parts.ball.preload: must be greater than 0 N (got -1 N)"),
        ({"half_angle": None}, "parts.ball.half_angle: half angle of the groove missing"),
        ({"half_angle": 2.0}, "parts.ball.half_angle: must be greater than 0 and less than 90 deg (got 114.592 deg)"),
        ({"seat": Seat.FLAT}, "parts.ball.half_angle: only a groove has a half angle"),
        ({"counter": "steal"}, 'parts.ball.counter: unknown material "steal"'),
    ],
)
def test_bad_contacts_are_told(changed, what):
    assert any(str(finding).startswith(what) for finding in check(coupling(**changed)))


def test_crystals_and_unknown_seats_are_refused():
    silicon = Material(None, None, 2330.0, c11=166e9, c12=64e9, c44=80e9)
    with pytest.raises(DesignError, match="silicon is a crystal"):
        lumped(replace(coupling(counter="silicon"), materials={"steel": STEEL, "silicon": silicon}))
    with pytest.raises(DesignError, match="material of its seat missing"):
        stiffness(FLAT, STEEL)


def test_a_seat_does_not_tell_what_the_ground_is_made_of():
    with pytest.raises(DesignError, match="thermal expansion unknown"):
        ground_of(coupling())
