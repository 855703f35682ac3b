"""Load factors of whole stages against closed forms: Euler's columns, pendulums, lateral buckling (Timoshenko & Gere, 1961)."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.loaded.stability import Stability, prestress, stability
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.beams.compliance import compliance
from flexstage.cases.double_triangle import double_triangle
from flexstage.models.lumped import lumped
from flexstage.parts.freedom import Freedom
from flexstage.parts.part import Restricted

Z = (0.0, 0.0, 1.0)
STEEL = fs.Material(young=200e9, poisson=0.0, density=1e-3)
LENGTH, DIAMETER = 0.2, 0.001
EULER = np.pi**2 * 200e9 * np.pi * DIAMETER**4 / 64.0 / LENGTH**2
TURNS = (Freedom.RX, Freedom.RY, Freedom.RZ)


def of(stage: fs.Mechanism) -> Stability:
    return stability(stage, fs.lumped(stage))


def column(free: tuple[Freedom, ...], foot: tuple[Freedom, ...] = ()) -> fs.Mechanism:
    """A rod up from a foot on the ground, its top held by a joint with these freedoms to the ground, 1 N pressing down on it."""
    return fs.Mechanism(
        "column",
        materials={"steel": STEEL},
        parts={"rod": fs.Rod("steel", LENGTH, DIAMETER), "guide": fs.Joint(free), "foot": fs.Joint(foot)},
        bodies={"platform": fs.Body(reference=(0.0, 0.0, LENGTH)), "base": fs.Body(reference=(0.0, 0.0, 0.0))},
        links={
            "foot": fs.Link(("ground", "base"), "foot", (0.0, 0.0, 0.0), Z),
            "rod": fs.Link(("base", "platform"), "rod", (0.0, 0.0, 0.5 * LENGTH), Z),
            "guide": fs.Link(("ground", "platform"), "guide", (0.0, 0.0, LENGTH), Z),
        },
        forces={"load": fs.Force("platform", (0.0, 0.0, LENGTH), (0.0, 0.0, -1.0))},
        gravity=(0.0, 0.0, 0.0),
    )


SIDE = (Freedom.X, Freedom.Y, Freedom.Z)


@pytest.mark.parametrize(
    ("free", "foot", "share"),
    [
        pytest.param((*SIDE, *TURNS), (), 0.25, id="free"),
        pytest.param((Freedom.X, *TURNS), TURNS[1:], 1.0, id="pinned"),
        pytest.param(SIDE, (), 1.0, id="guided"),
        pytest.param((Freedom.X, *TURNS), (), 2.045748, id="clamped-pinned"),
        pytest.param((Freedom.X,), (), 4.0, id="clamped"),
    ],
)
def test_eulers_columns(free: tuple[Freedom, ...], foot: tuple[Freedom, ...], share: float) -> None:
    """The joints' x is the column's axis. Shear and stretch of the rod, which Euler leaves out, change the load by up to 6e-4."""
    assert of(column(free, foot)).dead == pytest.approx(share * EULER, rel=1e-3)


def on_rods(random: np.random.Generator, pieces: int) -> fs.Mechanism:
    """A heavy body on one to three slender rods in any directions, each in so many equal pieces with bodies without mass between them."""
    length, diameter, count = 0.1, 0.1 * random.uniform(0.01, 0.03), int(random.integers(1, 4))
    bodies = {"platform": fs.Body(mass=1.0, centre=tuple(0.02 * random.normal(size=3)), inertia=fs.Inertia(1e-4, 1e-4, 1e-4))}
    links: dict[str, fs.Link] = {}
    for rod in range(count):
        along, end = random.normal(size=3), 0.02 * random.normal(size=3)
        along /= np.linalg.norm(along)
        across = tuple(np.cross(along, random.normal(size=3)))
        places = [tuple(end + length * (share - 1.0) * along) for share in np.arange(1, pieces) / pieces]
        names = ["ground", *(f"middle{rod}{place}" for place in range(pieces - 1)), "platform"]
        bodies |= {name: fs.Body(reference=at) for name, at in zip(names[1:-1], places, strict=True)}
        for place, joins in enumerate(itertools.pairwise(names)):
            at = tuple(end + length * ((place + 0.5) / pieces - 1.0) * along)
            links[f"rod{rod}{place}"] = fs.Link(joins, "rod", at, tuple(along), bends=across)
    gravity = tuple(10.0 * random.normal(size=3))
    return fs.Mechanism(
        "rods", {"steel": STEEL}, parts={"rod": fs.Rod("steel", length / pieces, diameter)}, bodies=bodies, links=links, gravity=gravity
    )


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(each, marks=pytest.mark.full) for each in range(3, 100))])
def test_rods_in_two_halves_have_the_same_load_factor(seed: int) -> None:
    """Rods bent in both planes and twisted at once, as in lateral buckling, where more shapes take part than in a column."""
    whole, halves = (float(of(on_rods(np.random.default_rng([5, seed]), pieces)).dead) for pieces in (1, 2))
    assert whole == pytest.approx(halves, rel=5e-3)


def leaves(mass: float, sides: tuple[float, float] = (0.0003, 0.02)) -> fs.Mechanism:
    leaf = fs.Leaf("steel", 0.06, *sides)
    return fs.Mechanism(
        "leaves",
        materials={"steel": STEEL},
        parts={"leaf": leaf},
        bodies={"platform": fs.Body(mass=mass, centre=(0.0, 0.0, 0.06), inertia=fs.Inertia(1e-3, 1e-3, 1e-3))},
        links={
            name: fs.Link(("ground", "platform"), "leaf", (x, 0.0, 0.03), Z, bends=(0.0, 1.0, 0.0))
            for name, x in (("a", -0.05), ("b", 0.05))
        },
    )


@pytest.mark.parametrize(("sides", "share"), [((0.0003, 0.02), 1.0), ((0.02, 0.0003), 0.25)], ids=["guided", "free"])
@pytest.mark.parametrize("mass", [2.5, 5.0, 10.0])
def test_a_platform_on_two_upright_leaves(mass: float, sides: tuple[float, float], share: float) -> None:
    """Both give way together: as columns with a guided end, or, bent the other way, with a free one, as the platform tilts with them."""
    critical = share * 2.0 * np.pi**2 * 200e9 * 0.02 * 0.0003**3 / 12.0 / 0.06**2
    assert of(leaves(mass, sides)).dead == pytest.approx(critical / (9.80665 * mass), rel=2e-3)


def pendulum(height: float) -> fs.Mechanism:
    """A body of 1 kg whose centre stands above (or hangs below) a notch on the ground."""
    hinge = fs.Notch("steel", 0.0005, 0.01, fs.Circular(0.002))
    return fs.Mechanism(
        "pendulum",
        materials={"steel": STEEL},
        parts={"hinge": hinge},
        bodies={"platform": fs.Body(mass=1.0, centre=(0.0, 0.0, height), inertia=fs.Inertia(1e-4, 1e-4, 1e-4))},
        links={"hinge": fs.Link(("ground", "platform"), "hinge", (0.0, 0.0, 0.0), (0.0, 0.0, height), bends=(0.0, 1.0, 0.0))},
    )


def test_a_body_standing_on_a_notch_falls_where_its_weight_beats_the_hinge():
    """c_theta = m g h, the hinge turning about its middle; its own length of 4 mm on 0.5 m is felt as 1 %."""
    stage = pendulum(0.5)
    hinge = compliance(stage.parts["hinge"], STEEL)[5, 5]
    assert of(stage).dead == pytest.approx(1.0 / hinge / (9.80665 * 0.5), rel=0.01)


def test_a_hanging_body_is_stiffened():
    """A pendulum's m g h over the hinge's stiffness; nothing gives way."""
    stage = pendulum(-0.5)
    found = of(stage)
    hinge = compliance(stage.parts["hinge"], STEEL)[5, 5]
    assert np.isinf(found.dead)
    assert found.stiffens == pytest.approx(9.80665 * 0.5 * hinge, rel=0.01)


@pytest.mark.parametrize(("sides", "down"), [((0.0005, 0.01), (0.0, 0.0, -1.0)), ((0.01, 0.0005), (0.0, -1.0, 0.0))], ids=["z", "y"])
def test_a_cantilevered_leaf_on_edge_tips_over(sides: tuple[float, float], down: tuple[float, float, float]) -> None:
    """Lateral buckling under a force at the end: P = 4.013 sqrt(E I G J) / L^2, uniform twist (the leaf's ends are kept from warping)."""
    length, thickness, width = 0.2, 0.0005, 0.01
    stage = fs.Mechanism(
        "edge",
        materials={"steel": STEEL},
        parts={"leaf": fs.Leaf("steel", length, *sides)},
        bodies={"platform": fs.Body(reference=(length, 0.0, 0.0))},
        links={"leaf": fs.Link(("ground", "platform"), "leaf", (0.5 * length, 0.0, 0.0), (1.0, 0.0, 0.0), bends=Z)},
        forces={"load": fs.Force("platform", (length, 0.0, 0.0), down)},
        gravity=(0.0, 0.0, 0.0),
    )
    bending = 200e9 * width * thickness**3 / 12.0
    torsion = 100e9 * width * thickness**3 / 3.0 * (1.0 - 0.63 * thickness / width)
    assert of(stage).dead == pytest.approx(4.013 * np.sqrt(bending * torsion) / length**2, rel=0.05)


def test_loads_scale_the_factor():
    once, twice = of(leaves(1.0)), of(replace(leaves(1.0), gravity=(0.0, 0.0, -2.0 * 9.80665)))
    assert once.dead == pytest.approx(2.0 * twice.dead, rel=1e-9)


def test_the_reference_point_of_a_body_does_not_matter():
    stage = leaves(2.0)
    other = replace(stage, bodies={"platform": replace(stage.bodies["platform"], reference=(0.03, -0.02, 0.2))})
    assert of(other).dead == pytest.approx(of(stage).dead, rel=1e-7)


def test_strokes_through_locked_parts_press_as_through_stiff_ones():
    """A stack that knows its axis only presses on an upright rod held at its top: u k k_rod / (k + k_rod) against Euler's load."""
    rod = fs.Rod("steel", LENGTH, DIAMETER)
    piezo = fs.Piezo(stroke=2e-4, stiffness=5e6, length=0.02, diameter=0.01)
    stage = fs.Mechanism(
        "pressed",
        materials={"steel": STEEL},
        parts={"rod": rod, "pzt": Restricted(piezo, (Freedom.X,))},
        bodies={"platform": fs.Body(reference=(0.0, 0.0, 0.0))},
        links={
            "pzt": fs.Link(("ground", "platform"), "pzt", (0.0, 0.0, -0.01), Z),
            "rod": fs.Link(("platform", "ground"), "rod", (0.0, 0.0, 0.5 * LENGTH), Z),
        },
        gravity=(0.0, 0.0, 0.0),
    )
    spring = 200e9 * np.pi / 4.0 * DIAMETER**2 / LENGTH
    pressed = 2e-4 / (1.0 / 5e6 + 1.0 / spring)
    limits = StrokeLimits(("pzt",), np.zeros(1), np.full(1, 2e-4))
    found = stability(stage, fs.lumped(stage), limits)
    assert np.isinf(found.dead)
    assert found.worst == pytest.approx(4.0 * EULER / pressed, rel=2e-3)
    assert found.strokes == pytest.approx([2e-4])
    loaded = replace(stage, forces={"push": fs.Force("platform", (0.0, 0.0, 0.0), (0.0, 0.0, 20.0))})
    both = stability(loaded, fs.lumped(loaded), limits)
    weighed = 20.0 * spring / (spring + 5e6)
    assert both.dead == pytest.approx(4.0 * EULER / weighed, rel=2e-3)
    assert both.worst == pytest.approx(4.0 * EULER / (pressed + weighed), rel=2e-3)


def test_a_squeezed_body_turns_about_the_line_of_its_forces_for_nothing():
    """Forces of F inward at +-r along x soften turns about y and z by 2 F r, those about x, the hinge's own axis, by nothing."""
    hinge = fs.Notch("steel", 0.0002, 0.01, fs.Circular(0.002))
    stage = fs.Mechanism(
        "squeezed",
        materials={"steel": STEEL},
        parts={"hinge": hinge},
        bodies={"platform": fs.Body(reference=(0.0, 0.0, 0.0))},
        links={"hinge": fs.Link(("ground", "platform"), "hinge", (0.0, 0.0, 0.0), Z, bends=(1.0, 0.0, 0.0))},
        forces={name: fs.Force("platform", (x, 0.0, 0.0), (-np.sign(x), 0.0, 0.0)) for name, x in (("a", -0.1), ("b", 0.1))},
        gravity=(0.0, 0.0, 0.0),
    )
    others = 1.0 / np.diag(compliance(hinge, STEEL))[3:5]
    assert of(stage).dead == pytest.approx(np.min(others) / (2.0 * 0.1), rel=1e-3)


@pytest.mark.parametrize(("factor", "softer", "slower"), [(2.0, "50 %", "29 %"), (4.0 / 3.0, "75 %", "50 %"), (10.0, "10 %", "5.1 %")])
def test_a_load_factor_is_told_as_stiffness_and_frequency(factor: float, softer: str, slower: str) -> None:
    """Of the stiffness 1/factor is gone, of the frequency 1 - (1 - 1/factor)^(1/2)."""
    found = replace(of(leaves(1.0)), dead=np.array(factor), worst=np.array(factor), stiffens=np.zeros(()))
    (told,) = found.warnings
    assert f"is {softer} less stiff than the nominal stage, and its frequency {slower} lower" in told.what
    assert not found.refusals
    (worse,) = replace(found, dead=np.array(100.0)).warnings
    assert f"up to {softer} less stiff than the results show, and a frequency up to {slower} lower" in worse.what
    assert len(replace(found, worst=np.array(0.9 * factor)).warnings) == 2  # the strokes take a tenth of it more


def test_a_repeated_load_factor_names_the_bodies_of_all_its_shapes():
    """Three equal units give way at one factor: which of them a solver mixes first says nothing."""
    stage = double_triangle()
    wanted = tuple(f"{unit}/{body}" for unit in ("B4", "B5", "B6") for body in ("base", "tip"))
    assert stability(stage, lumped(stage)).moving == wanted


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["pressed", "pulled"])
def test_a_platform_on_a_strut_leans_and_tilts(side: float) -> None:
    """A strut of length L that turns about both ends, under a platform on springs k and c: P = k L leans it, P = c / h tilts the platform.

    V = (k - P / L) d^2 / 2 + (c - P h) t^2 / 2 with the load P a height h above the strut's end, k and c at that end. Upside down (the
    platform hangs) both stiffen. The reference of the platform, away from the strut's end, couples d and t and changes nothing.
    """
    length, height, across, tilting = 0.05, 0.03, 4e3, 3.0
    # The rod's own law is free of moments; the springs hold the platform sideways and against tilting, at the strut's end.
    strut = fs.Spring(stiffness=1e9, length=length)
    guide = fs.Spring(diagonal=(across, 1.5 * across, 0.0, tilting, 2.0 * tilting, 5.0))
    down = np.array([0.0, 0.0, -side])
    stage = fs.Mechanism(
        "strut",
        materials={},
        parts={"strut": strut, "guide": guide},
        bodies={
            "platform": fs.Body(mass=1.0, inertia=fs.Inertia(1e-3, 1e-3, 1e-3), centre=(0.01, 0.02, 0.1), reference=(0.02, 0.01, -0.01))
        },
        links={
            "strut": fs.Link(("ground", "platform"), "strut", (0.0, 0.0, 0.5 * length), Z),
            "guide": fs.Link(("ground", "platform"), "guide", (0.0, 0.0, length), (1.0, 0.0, 0.0)),
        },
        forces={"load": fs.Force("platform", (0.0, 0.0, length + height), tuple(down))},
        gravity=(0.0, 0.0, 0.0),
    )
    found = of(stage)
    if side < 0.0:
        assert np.isinf(found.dead)
        assert found.stiffens == pytest.approx(max(1.0 / (across * length), height / tilting), rel=1e-4)
        return
    assert found.dead == pytest.approx(min(across * length, tilting / height), rel=1e-4)
    high = replace(stage, forces={"load": fs.Force("platform", (0.0, 0.0, length + 0.005), (0.0, 0.0, -1.0))})
    assert of(high).dead == pytest.approx(min(across * length, tilting / 0.005), rel=1e-4)


@pytest.mark.parametrize("sides", [(0.0003, 0.02), (0.0002, 0.004)], ids=["wide", "narrow"])
def test_tension_stiffens_torsion_by_the_spread_of_its_fibres(sides: tuple[float, float]) -> None:
    """A taut strip turns about its axis against N I_p / (A L) more (Timoshenko & Gere, 1961, 5.3), times (t'^2) / (t')^2 in the mean.

    Ends kept from warping: the rate of twist is t' ~ 1 - cosh(2 a x / L) / cosh(a), a = (G J / E C_w)^1/2 L / 2 = 6^1/2 L / w of a thin
    strip without Poisson's ratio (Vlasov).
    """
    thickness, width, length, tension = *sides, 0.06, 1e-3
    stage = fs.Mechanism(
        "strip",
        materials={"steel": STEEL},
        parts={"leaf": fs.Leaf("steel", length, thickness, width)},
        bodies={"platform": fs.Body(reference=(length, 0.0, 0.0))},
        links={"leaf": fs.Link(("ground", "platform"), "leaf", (0.5 * length, 0.0, 0.0), (1.0, 0.0, 0.0), bends=Z)},
        forces={"pull": fs.Force("platform", (length, 0.0, 0.0), (tension, 0.0, 0.0))},
        gravity=(0.0, 0.0, 0.0),
    )
    model = fs.lumped(stage)
    turn = list(model.coordinates).index("platform.rx")
    added = (prestress(stage, model).stiffness_matrix - model.stiffness_matrix)[turn, turn]
    end = np.tanh(a := np.sqrt(6.0) * length / width) / a
    uneven = (1.0 - 1.5 * end + 0.5 / np.cosh(a) ** 2) / (1.0 - end) ** 2
    assert added == pytest.approx(uneven * tension * (thickness**2 + width**2) / 12.0 / length, rel=2e-3)
