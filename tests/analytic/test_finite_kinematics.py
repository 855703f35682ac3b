"""Finite motion of linkages whose motion is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import flexstage as fs
from flexstage.models.finite import FinitePose, forward_kinematics, inverse_kinematics
from flexstage.models.ideal import ideal

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
ALUMINIUM = fs.Material(young=70e9, poisson=0.33, density=2700.0)
STACK = fs.Piezo(stroke=1e-3, stiffness=1e7, length=0.02, diameter=0.01)
PIN = fs.Joint((fs.Freedom.RZ,))
BALL = fs.Joint((fs.Freedom.RX, fs.Freedom.RY, fs.Freedom.RZ))


def strut(start, end, along):
    """A stack between pins at both ends, from the ground to the platform."""
    middle = tuple(0.5 * (first + second) for first, second in zip(start, end, strict=True))
    return (
        {"base": fs.Body(reference=start), "tip": fs.Body(reference=end)},
        {
            "foot": fs.Link(("ground", "base"), "pin", start, along, bends=Z),
            "pzt": fs.Link(("base", "tip"), "stack", middle, along),
            "head": fs.Link(("tip", "platform"), "pin", end, along, bends=Z),
        },
    )


def lever(short=0.026, long=0.078):
    """A lever of Shin & Moon's proportions about a pin at the origin; its platform's reference is the lever's far end."""
    bodies, links = strut((-0.2, short, 0.0), (0.0, short, 0.0), X)
    return fs.Mechanism(
        name="lever",
        parts={"pin": PIN, "stack": STACK},
        bodies={"platform": fs.Body(reference=(-long, 0.0, 0.0)), **bodies},
        links={"pivot": fs.Link(("ground", "platform"), "pin", (0.0, 0.0, 0.0), X, bends=Z), **links},
    )


def test_the_lever_end_moves_on_a_circle():
    """Sideways motion z^2/(2 r2): 2.31 um at 600 um with r2 = 78 mm (reference.md A7)."""
    mechanism = lever()
    kinematics = ideal(mechanism)
    assert kinematics.coordinates == ("rz",)
    angle = np.arcsin(600e-6 / 0.078)
    lifted = inverse_kinematics(mechanism, kinematics, FinitePose(np.zeros(3), np.array([0.0, 0.0, -angle]))).pose
    assert lifted.displacement[1] == pytest.approx(600e-6, rel=1e-12)
    sideways = lifted.displacement[0]
    assert sideways == pytest.approx(0.078 - np.sqrt(0.078**2 - 600e-6**2), rel=1e-9)
    assert 1e6 * sideways == pytest.approx(2.31, abs=0.005)
    assert sideways == pytest.approx(600e-6**2 / (2.0 * 0.078), rel=1e-4)


def test_the_lever_stroke_is_the_change_of_a_triangle_side():
    """From the foot to the head: |h(t) - f| - |h(0) - f| exactly, far beyond small motions."""
    mechanism = lever()
    kinematics = ideal(mechanism)
    foot, head, angle = np.array([-0.2, 0.026]), np.array([0.0, 0.026]), -0.6
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    stroke = np.linalg.norm(turn @ head - foot) - np.linalg.norm(head - foot)
    end = np.array([-0.078, 0.0])
    found = forward_kinematics(mechanism, kinematics, np.array([stroke]))
    np.testing.assert_allclose(found.pose.displacement[:2], turn @ end - end, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(found.pose.rotation_vector, [0.0, 0.0, angle], rtol=0.0, atol=1e-12)


def test_a_pure_rotation_of_the_platform():
    """On a ball joint any rotation is a pure one: every reference point moves by (R - 1) r, and strokes are changes of distance."""
    feet = {
        "a": ((0.1, 0.05, -0.2), (0.1, 0.05, 0.0)),
        "b": ((-0.1, 0.05, -0.2), (-0.1, 0.05, 0.0)),
        "c": ((0.3, 0.1, 0.0), (0.0, 0.1, 0.0)),
    }
    bodies, links = {}, {}
    for name, (start, end) in feet.items():
        along = tuple(second - first for first, second in zip(start, end, strict=True))
        own, joined = strut(start, end, along)
        bodies |= {f"{name}.{key}".replace(".", "_"): body for key, body in own.items()}
        for key, link in joined.items():
            joins = tuple(body if body in {"ground", "platform"} else f"{name}_{body}" for body in link.joins)
            links[f"{name}_{key}"] = fs.Link(joins, link.part, link.at, link.along)
    mechanism = fs.Mechanism(
        name="ball",
        parts={"pin": BALL, "stack": STACK},
        bodies={"platform": fs.Body(reference=(0.02, 0.03, 0.15)), **bodies},
        links={"ball": fs.Link(("ground", "platform"), "pin", (0.0, 0.0, 0.0), Z), **links},
    )
    kinematics = ideal(mechanism)
    assert kinematics.mobility == 3
    vector = np.array([0.11, -0.07, 0.05])
    turn = _rodrigues(vector)
    strokes = [np.linalg.norm(turn @ np.array(end) - start) - np.linalg.norm(np.array(end) - start) for start, end in feet.values()]
    found = forward_kinematics(mechanism, kinematics, np.array(strokes))
    np.testing.assert_allclose(found.pose.rotation_vector, vector, rtol=0.0, atol=1e-12)
    arm = np.array([0.02, 0.03, 0.15])
    np.testing.assert_allclose(found.pose.displacement, turn @ arm - arm, rtol=0.0, atol=1e-13)


def _rodrigues(vector):
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def parallel(lengths, kind, push=0.1):
    """A platform on upright legs at x = 0, 50 mm, ...; a stack pushes it along x through a slide that lets it sink."""
    legs = {
        f"leg{number}": fs.Link(("ground", "platform"), f"leg{number}", (0.05 * number, -0.5 * length, 0.0), Y, bends=Z)
        for number, length in enumerate(lengths)
    }
    return fs.Mechanism(
        name="parallel",
        materials={"metal": ALUMINIUM},
        parts={
            **{f"leg{number}": kind(length) for number, length in enumerate(lengths)},
            "stack": STACK,
            "slide": fs.Joint((fs.Freedom.Y, fs.Freedom.RZ)),
        },
        bodies={"platform": fs.Body(reference=(0.0, 0.0, 0.0)), "shoe": fs.Body(reference=(push, 0.0, 0.0))},
        links={
            **legs,
            "pzt": fs.Link(("ground", "shoe"), "stack", (push + 0.05, 0.0, 0.0), X),
            "slide": fs.Link(("shoe", "platform"), "slide", (push, 0.0, 0.0), X, bends=Z),
        },
    )


def test_a_leaf_parallelogram_sinks_by_three_fifths():
    """0.6 x^2/L for guided leaves (beam constraint model, kinematic part)."""
    mechanism = parallel((0.05, 0.05), lambda length: fs.Leaf("metal", length, 0.0005, 0.02))
    kinematics = ideal(mechanism)
    found = forward_kinematics(mechanism, kinematics, np.array([1e-4]))
    assert found.consistent
    assert found.pose.displacement[1] == pytest.approx(-0.6 * found.pose.displacement[0] ** 2 / 0.05, rel=1e-9)
    np.testing.assert_allclose(found.pose.rotation_vector, 0.0, atol=1e-15)


def test_a_rod_sinks_as_a_leaf_does():
    """Four rods: the same shortening, in whichever direction they deflect."""
    mechanism = parallel((0.05, 0.05), lambda length: fs.Rod("metal", length, 0.001))
    held = {"hold": fs.Link(("ground", "platform"), "hold", (0.0, 0.0, 0.0), X)}
    hold = {"hold": fs.Joint((fs.Freedom.X, fs.Freedom.Y))}
    mechanism = fs.Mechanism(
        name="rods",
        materials=mechanism.materials,
        parts={**mechanism.parts, **hold},
        bodies=mechanism.bodies,
        links={**mechanism.links, **held},
    )
    found = forward_kinematics(mechanism, ideal(mechanism), np.array([1e-4]))
    assert found.pose.displacement[1] == pytest.approx(-0.6 * found.pose.displacement[0] ** 2 / 0.05, rel=1e-9)


def _clamped(kind, aside, about):
    """A beam along x whose far end two slides push along `aside`, at the end and 30 mm beyond; a slot keeps the motion in that plane."""
    to, arm = (Y, 0.03) if aside is fs.Freedom.Y else (Z, 0.03)
    push = fs.Joint((fs.Freedom.Y, fs.Freedom.Z, fs.Freedom.RX, fs.Freedom.RY, fs.Freedom.RZ))
    places = {"near": (0.0, 0.0, 0.0), "far": (arm, 0.0, 0.0)}
    return fs.Mechanism(
        name="clamped",
        materials={"metal": ALUMINIUM},
        parts={"beam": kind, "stack": STACK, "push": push, "slot": fs.Joint((fs.Freedom.X, aside, about))},
        bodies={"platform": fs.Body(reference=(0.0, 0.0, 0.0)), **{name: fs.Body(reference=place) for name, place in places.items()}},
        links={
            "beam": fs.Link(("ground", "platform"), "beam", (-0.025, 0.0, 0.0), X, bends=Z),
            "slot": fs.Link(("ground", "platform"), "slot", (0.0, 0.0, 0.0), X, bends=Z),
            **{f"{name}_pzt": fs.Link(("ground", name), "stack", place, to) for name, place in places.items()},
            **{f"{name}_push": fs.Link((name, "platform"), "push", place, to) for name, place in places.items()},
        },
    )


@pytest.mark.parametrize(
    ("kind", "aside", "about"),
    [
        (fs.Leaf("metal", 0.05, 0.0005, 0.02), fs.Freedom.Y, fs.Freedom.RZ),
        (fs.Rod("metal", 0.05, 0.001), fs.Freedom.Y, fs.Freedom.RZ),
        (fs.Rod("metal", 0.05, 0.001), fs.Freedom.Z, fs.Freedom.RY),
    ],
    ids=["leaf", "rod", "rod the other way"],
)
@pytest.mark.parametrize(("deflection", "angle"), [(2e-4, 0.0), (0.0, 6e-3), (2e-4, 6e-3), (2e-4, -6e-3)])
def test_the_end_of_a_beam_comes_nearer_by_half_the_square_of_its_slope(kind, aside, about, deflection, angle):
    """1/2 int v'^2 dx of the cubic v that a beam of 50 mm bends to, its end moved aside and turned; exactly, by Gauss's rule."""
    mechanism = _clamped(kind, aside, about)
    found = forward_kinematics(mechanism, ideal(mechanism), np.array([deflection, deflection + 0.03 * np.sin(angle)]))
    points, weights = np.polynomial.legendre.leggauss(3)
    along, length = 0.5 * (points + 1.0), 0.05
    slope = 6.0 * (along - along**2) * deflection / length + (3.0 * along**2 - 2.0 * along) * angle
    assert found.consistent
    assert found.pose.displacement[0] == pytest.approx(-0.25 * length * weights @ slope**2, rel=1e-6)
    index, turned, sign = (1, 2, 1.0) if aside is fs.Freedom.Y else (2, 1, -1.0)
    assert found.pose.displacement[index] == pytest.approx(deflection, abs=1e-13)
    assert sign * found.pose.rotation_vector[turned] == pytest.approx(angle, abs=1e-11)


def test_unequal_redundant_legs_disagree():
    """Leaves of 40, 50 and 40 mm ask for different heights: 0.6 x^2 (1/40 - 1/50 mm) between them; reported, not hidden."""
    mechanism = parallel((0.04, 0.05, 0.04), lambda length: fs.Leaf("metal", length, 0.0005, 0.02))
    kinematics = ideal(mechanism)
    assert kinematics.redundant
    found = forward_kinematics(mechanism, kinematics, np.array([1e-4]))
    assert not found.consistent
    gap = 0.6 * 1e-8 * (1.0 / 0.04 - 1.0 / 0.05)
    assert 0.1 * gap < found.residual < gap
    assert forward_kinematics(mechanism, kinematics, np.array([0.0])).consistent


def test_a_batch_of_designs():
    """Levers of two arms at once, each as alone."""
    arms = np.array([0.078, 0.05])
    together = lever(long=arms)
    found = forward_kinematics(together, ideal(together), np.array([[1e-4], [1e-4]]))
    for index, arm in enumerate(arms):
        alone = lever(long=float(arm))
        np.testing.assert_allclose(
            found.pose.vector[index], forward_kinematics(alone, ideal(alone), np.array([1e-4])).pose.vector, rtol=0.0, atol=1e-15
        )


def test_strokes_out_of_reach_are_refused():
    mechanism = lever()
    with pytest.raises(fs.DesignError, match="no convergence"):
        forward_kinematics(mechanism, ideal(mechanism), np.array([0.5]))


def test_a_diverging_iteration_tells_its_last_step():
    """The iteration ends at a step above a thousand sizes; the message has that step, not the one before it."""
    mechanism = fs.case("double-triangle")
    with pytest.raises(fs.DesignError, match=r"the last step was [\d.]+e\+\d+ times"):
        forward_kinematics(mechanism, ideal(mechanism), 0.03 * np.array([0.0, 0.0, 0.0, 1.0, -1.0, 1.0]))


def test_an_under_actuated_stage_is_refused():
    mechanism = parallel((0.05, 0.05), lambda length: fs.Leaf("metal", length, 0.0005, 0.02))
    loose = fs.Mechanism(
        name="loose",
        materials=mechanism.materials,
        parts=mechanism.parts,
        bodies={"platform": mechanism.bodies["platform"]},
        links={name: link for name, link in mechanism.links.items() if name.startswith("leg")},
    )
    with pytest.raises(fs.DesignError, match="do not determine"):
        forward_kinematics(loose, ideal(loose), np.zeros(0))
