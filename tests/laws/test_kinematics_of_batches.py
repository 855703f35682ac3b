"""Models of a batch are those of its designs, whichever begins it; designs that the choices of the first do not serve are refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.requirements import measure
from flexstage.base.finding import DesignError
from flexstage.base.number import Table
from flexstage.base.units.quantity import LENGTH
from flexstage.base.units.scale import X, Y, Z
from flexstage.cases.registry import CASES
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import Link, Mechanism, Probe
from flexstage.models.finite import forward_kinematics
from flexstage.models.linear.eigen import eigenvalues
from flexstage.models.linear.elimination import eliminate, eliminate_each
from flexstage.models.mapped import chain_compliance
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.parts.freedom import ALL, Freedom
from flexstage.parts.gauge import Gauge, SensorSense
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.evaluate import piece
from flexstage.studies.sweeps.plan import Plan, Sampling
from flexstage.studies.sweeps.variable import Variable

FACTORS = (1.0, 1.003, 0.998, 1.0007)


def told(case: str, address: str, factors: Sequence[float] | float) -> dict[str, np.ndarray]:
    """What depends on lengths and pivots, of one design or of several."""
    stage = scaled(case, address, factors)
    kinematics = fs.ideal(stage)
    lost = fs.lost_motion(kinematics, fs.lumped(stage))
    many = {"length": np.asarray(kinematics.length), "motion": kinematics.motion, "actuation": kinematics.actuation}
    many |= {"projection": kinematics.projection, "bodies": kinematics.bodies, "sensing": kinematics.sensing}
    return many | {"loss": lost.loss.values, "parasitic": lost.parasitic.values}


def scaled(case: str, address: str, factors: Sequence[float] | float) -> Mechanism:
    stage = CASES[case].build()
    return set_value(stage, address, get(stage, address) * np.asarray(factors))


MOVED = (
    ("tip-tilt", "bodies.platform.solids.holder.diameter"),
    ("double-triangle", "units.vertical.links.upper.at.z"),
    ("xy-stage", "units.following.links.left.at.y"),
    ("parallelogram", "links.left.at.x"),
)


@pytest.mark.parametrize(("case", "address"), MOVED)
def test_each_design_of_a_batch_is_itself_whichever_begins_it(case: str, address: str) -> None:
    many, back = told(case, address, FACTORS), told(case, address, FACTORS[::-1])
    for place, factor in enumerate(FACTORS):
        for name, alone in told(case, address, factor).items():
            axes = alone.ndim
            for batch, number in ((many, place), (back, len(FACTORS) - 1 - place)):
                found = batch[name] if batch[name].ndim == axes else batch[name][number]
                np.testing.assert_array_equal(found, alone, err_msg=name)


def study(case: str, address: str, key: str) -> Study:
    """Four designs within 0.3 % of a case's own, and one of their numbers."""
    stage = CASES[case].build()
    value = float(get(stage, address))
    low, high = sorted((0.997 * value, 1.003 * value))
    variable = Variable("place", (address,), LENGTH, low, high)
    columns = Table({"asked": measure(stage, key, "responses.asked")})
    return Study("moved", stage, (variable,), columns, (), Plan(Sampling.SOBOL, 1, count=4))


def test_a_sweep_does_not_depend_on_how_it_is_cut() -> None:
    asked = study(*MOVED[0], "loss.P1")
    whole = piece(asked, 0, 4).responses
    assert np.isfinite(whole).all()
    parts = [piece(asked, start, stop).responses for start, stop in ((0, 1), (1, 4))]
    np.testing.assert_array_equal(np.concatenate(parts), whole)


MOUNT = ("telescope-mount", "units.bipod.links.right_top.end.y")


def test_designs_of_another_mobility_are_told_apart() -> None:
    """A bipod whose strut leaves its plane has motions that the drawn one has not, and in turn."""
    drawn, moved = (fs.ideal(scaled(*MOUNT, factor)).mobility for factor in (1.0, 1.003))
    assert drawn != moved
    with pytest.raises(DesignError, match=r"design 2 of the batch differs from the first design in its motions.*one by one"):
        fs.ideal(scaled(*MOUNT, (1.0, 1.003, 0.998)))
    assert fs.ideal(scaled(*MOUNT, (1.003, 0.998))).mobility == moved


def test_the_pivots_of_a_design_are_its_own() -> None:
    """A pivot of the first design that is nothing in the second made all of the second infinite, or worthless."""
    rows = np.array([[[1.0, 2.0, 0.0, 0.5]], [[1.0, 1e-12, 2.0, 0.5]], [[1.0, 0.3, 2.0, 0.1]]])
    found = eliminate_each(rows, np.ones((3, 4)), keep=(0,))
    assert np.max(np.abs(rows @ found.basis)) < 1e-15
    for place, row in enumerate(rows):
        np.testing.assert_array_equal(found.basis[place], eliminate(row, np.ones(4), keep=(0,)).basis)
    stepped = eliminate_each(rows + 1e-20j * rows[:, :, ::-1], np.ones(4), keep=(0,)).basis
    np.testing.assert_array_equal(np.real(stepped), found.basis)
    assert np.max(np.abs((rows + 1e-20j * rows[:, :, ::-1]) @ stepped)) < 1e-15


Numbers = float | np.ndarray
TURNS = (Freedom.RX, Freedom.RY, Freedom.RZ)
AXIAL = tuple(freedom for freedom in ALL if freedom is not Freedom.X)
PLATE = Body(mass=1.0, centre=(0.01, 0.02, 0.03), inertia=Inertia(1e-3, 2e-3, 3e-3))


def spring(stiffness: float, free: tuple[Freedom, ...] = ALL) -> ComplianceMatrix:
    """As stiff along all axes, and about them over 0.03 m."""
    compliance = np.diag([1.0 / stiffness] * 3 + [1e3 / stiffness] * 3)
    return ComplianceMatrix(tuple(map(tuple, compliance.tolist())), free)


def on_rods(apart: Numbers, turn: Numbers) -> Mechanism:
    """A platform on springs, held by two rigid rods: those of one line hold one freedom, others two."""
    along, ends = (np.cos(turn), np.sin(turn), 0.0 * turn), ("ground", "platform")
    links = {"spring": Link(ends, "spring", (0.0, 0.0, 0.0), X, Z), "one": Link(ends, "rod", (0.0, 0.0, 0.0), along, Z)}
    links["other"] = Link(ends, "rod", (0.0, apart, 0.0), along, Z)
    return Mechanism("rods", parts={"spring": spring(1e6), "rod": Joint(AXIAL)}, bodies={"platform": PLATE}, links=links)


def spinning(beside: Numbers, centre: Numbers, gauge: Numbers) -> Mechanism:
    """A rod between two balls: a spring beside its line holds its spin, its centre of mass and what a gauge reads may be beside it too."""
    rod = Body(mass=0.1, centre=(0.05, centre, 0.0), inertia=Inertia(0.0, 2e-4, 2e-4))
    return Mechanism(
        "spin",
        parts={"spring": spring(1e6), "ball": Joint(TURNS), "side": Restricted(spring(1e5), ALL[:3], TURNS)},
        bodies={"platform": PLATE, "rod": rod},
        links={
            "spring": Link(("ground", "platform"), "spring", (0.12, 0.0, 0.0), X, Z),
            "first": Link(("ground", "rod"), "ball", (0.0, 0.0, 0.0), X),
            "second": Link(("rod", "platform"), "ball", (0.1, 0.0, 0.0), X),
            "side": Link(("ground", "rod"), "side", (0.03, beside, 0.0), X),
        },
        sensors={"gauge": Gauge(range=1e-4)},
        gauges={"S": Probe("gauge", "rod", Pose((0.05, gauge, 0.0), Z, X), SensorSense.OPENS)},
    )


def pushed(turn: Numbers) -> Mechanism:
    """A cart pushes a platform by three struts: two beside each other across the push bear none of it, one at an angle would."""
    across = (np.sin(turn), np.cos(turn), 0.0 * turn)
    return Mechanism(
        "push",
        parts={
            "stack": Piezo(stroke=1e-5, stiffness=2e7, length=0.02, diameter=0.008),
            "ball": Joint(TURNS),
            "slide": Joint((Freedom.X,)),
            "strut": spring(1e7, AXIAL),
        },
        bodies={"tip": Body(), "cart": Body(), "platform": PLATE},
        links={
            "pzt": Link(("ground", "tip"), "stack", (0.0, 0.0, 0.0), X),
            "pin": Link(("tip", "cart"), "ball", (0.01, 0.0, 0.0), X),
            "rail": Link(("ground", "cart"), "slide", (0.02, 0.0, 0.0), X, Z),
            "push": Link(("cart", "platform"), "strut", (0.05, 0.0, 0.0), X, Z),
            "across": Link(("cart", "platform"), "strut", (0.05, 0.01, 0.0), Y, Z),
            "oblique": Link(("cart", "platform"), "strut", (0.05, 0.0, 0.0), across, Z),
            "guide": Link(("ground", "platform"), "slide", (0.08, 0.03, 0.0), X, Z),
        },
    )


def carried(mass: Numbers) -> Mechanism:
    """A platform on a body of some mass, or none."""
    carrier = Body(mass=mass, centre=(0.05, 0.0, 0.0), inertia=Inertia(1e-3 * mass, 2e-3 * mass, 2e-3 * mass))
    links = {"first": Link(("ground", "carrier"), "spring", (0.0, 0.0, 0.0), X, Z)}
    links["second"] = Link(("carrier", "platform"), "spring", (0.1, 0.0, 0.0), X, Z)
    return Mechanism("carried", parts={"spring": spring(1e6)}, bodies={"platform": PLATE, "carrier": carrier}, links=links)


def own_values(stage: Mechanism) -> np.ndarray:
    return eigenvalues(fs.lumped(stage))


def first_reading(stage: Mechanism) -> np.ndarray:
    return fs.ideal(stage).sensing[..., 0, :]


def borne(stage: Mechanism) -> np.ndarray:
    found = chain_compliance(expand(stage), fs.ideal(stage), "pzt")
    return np.array(np.nan) if found is None else np.asarray(found)


UNLIKE = {
    "rods of one line, then apart": (own_values, lambda apart: on_rods(apart, 0.0), (0.0, 0.05)),
    "rods turned across": (own_values, lambda turn: on_rods(0.02, turn), (0.0, 0.5 * np.pi - 1e-7)),
    "a spin, then held": (own_values, lambda beside: spinning(beside, 0.0, 0.0), (0.0, 0.02)),
    "a spin without inertia, then with": (own_values, lambda centre: spinning(0.0, centre, 0.0), (0.0, 0.02)),
    "a body without mass, then with": (own_values, carried, (0.0, 1.0)),
    "modes of a body without mass, then with": (lambda stage: fs.modes(fs.lumped(stage)).frequencies, carried, (0.0, 1.0)),
    "a gauge on a line of spin, then beside it": (first_reading, lambda gauge: spinning(0.02, 0.0, gauge), (0.0, 0.01)),
    "a gauge that sees a spin which is held, then not": (first_reading, lambda beside: spinning(beside, 0.0, 0.01), (0.02, 0.0)),
}
"""What is asked, of which stage, and two values that make other choices: read together, either would have numbers of another stage."""


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("asked", "stage", "values"), UNLIKE.values(), ids=UNLIKE)
def test_designs_that_other_choices_serve_are_refused(
    asked: Callable[[Mechanism], np.ndarray], stage: Callable[[Numbers], Mechanism], values: tuple[float, float], turned: bool
) -> None:
    with pytest.raises(DesignError, match=r"design 2 of the batch .* one by one"):
        asked(stage(np.array(values[::-1] if turned else values)))


LIKE = {
    "rods": (own_values, lambda turn: on_rods(0.02, turn), (0.0, 0.7, 1.2)),
    "a body without mass": (own_values, lambda beside: carried(0.0 * beside), (0.0, 1.0)),
    "a body with mass": (own_values, carried, (1.0, 2.0, 3.0)),
    "rods of one line": (own_values, lambda turn: on_rods(0.0, turn), (0.0, 0.7, 1.2)),
    "a spin": (own_values, lambda centre: spinning(0.0, centre, 0.0), (0.01, 0.02, 0.03)),
    "a spin that is held": (own_values, lambda beside: spinning(beside, 0.0, 0.0), (0.01, 0.02, 0.03)),
    "what a gauge reads of a spin": (first_reading, lambda gauge: spinning(0.02, 0.0, gauge), (0.01, 0.02, 0.03)),
    "what bears a push": (borne, lambda turn: pushed(0.0 * turn), (0.1, 0.2, 0.3)),
}


@pytest.mark.parametrize(("asked", "stage", "values"), LIKE.values(), ids=LIKE)
def test_designs_that_the_same_choices_serve_are_themselves(
    asked: Callable[[Mechanism], np.ndarray], stage: Callable[[Numbers], Mechanism], values: tuple[float, ...]
) -> None:
    alone = np.array([asked(stage(value)) for value in values])
    np.testing.assert_allclose(asked(stage(np.array(values))), alone, rtol=1e-9, atol=1e-12 * np.max(np.abs(alone)))


def test_what_bears_a_load_is_chosen_for_every_design() -> None:
    """Statics tells what one design's struts bear and not the other's; the first one's choice would tell both."""
    told, untold = borne(pushed(0.0)), borne(pushed(0.3))
    assert told == pytest.approx(1.0 / 2e7 + 1.0 / 1e7, rel=1e-9)
    assert np.isnan(untold)
    assert np.isnan(borne(pushed(np.array([0.0, 0.3]))))


def test_finite_motion_weighs_rotations_by_each_design_s_own_length() -> None:
    """Four stacks, one of them pushing: what does not fit is met by least squares."""
    case, address, factors = "tip-tilt-four", "bodies.platform.solids.holder.diameter", (1.0, 1.2, 0.85)
    strokes = np.array([10e-6, 0.0, 0.0, 0.0])
    stages = [scaled(case, address, factors), *(scaled(case, address, factor) for factor in factors)]
    whole, *alone = (forward_kinematics(stage, fs.ideal(stage), strokes) for stage in stages)
    for number, one in enumerate(alone):
        assert not np.all(one.consistent)
        np.testing.assert_allclose(whole.pose.vector[number], one.pose.vector, rtol=0.0, atol=1e-15)


def test_a_sweep_reads_designs_alone_that_cannot_be_read_together() -> None:
    """A spring that is moved off the line of a spin: the first design has a mode less than the others."""
    drawn = spinning(0.0, 0.0, 0.0)
    columns = Table({key: measure(drawn, key, f"responses.{key}") for key in ("frequency.1", "frequency.2")})
    places = Variable("place", ("links.side.at.y",), LENGTH, 0.0, 0.02)
    swept = piece(Study("moved", drawn, (places,), columns, (), Plan(Sampling.GRID, 1, levels=(3,))), 0, 3)
    alone = [np.sqrt(own_values(spinning(place, 0.0, 0.0))[:2]) / (2.0 * np.pi) for place in swept.variables[:, 0]]
    assert not swept.failures
    np.testing.assert_allclose(swept.responses, alone, rtol=1e-9)
