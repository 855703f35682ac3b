"""Random stages for laws: parts, elastic graphs with closed loops, and platforms on struts and wires of any mobility.

Everything drawn is valid by construction (`check` finds nothing), so that no example is thrown away, and moderately conditioned, so that
laws can be tested tightly.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import cache

import numpy as np
from hypothesis import strategies as st

from flexstage.base.number import stack
from flexstage.base.units.scale import X, Y, Z, mm
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar, Pose
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, ModalDamping, Placement, Probe, Unit
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.gauge import Gauge, SensorSense
from flexstage.parts.leaf import Leaf
from flexstage.parts.mass import tensor
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Elliptic, Filleted, Straight
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import axes
from tests.laws.shared import Shared

GAUGE = Gauge(range=100e-6)


@cache
def _length(low, high):
    """Lengths in millimetres, drawn in steps of 1/100 mm: they print and shrink well."""
    return st.integers(round(100 * low), round(100 * high)).map(lambda hundredths: hundredths * 0.01 * mm)


@cache
def _number(low, high):
    """Numbers in thousand steps from low to high."""
    return st.integers(0, 1000).map(lambda step: low + (high - low) * step / 1000.0)


places = st.tuples(_length(-80, 80), _length(-80, 80), _length(-80, 80))
"""Points within 80 mm of the origin."""

_STEPS = st.integers(-3, 3)
directions = st.tuples(_STEPS, _STEPS, _STEPS).filter(any).map(lambda steps: tuple(float(step) for step in steps))
"""Directions of small whole components: every octant, and the axes as the simplest."""


@cache
def _across(along):
    """Directions that are not parallel to one."""
    return directions.filter(lambda other: any(_cross(along, other)))


def _cross(one, other):
    """Their product, of numbers that floats hold exactly: numpy takes thirty times as long for three of them."""
    (a, b, c), (x, y, z) = one, other
    return (b * z - c * y, c * x - a * z, a * y - b * x)


@cache
@st.composite
def orientations(draw):
    """(along, bends): two directions exactly perpendicular to one another."""
    along = draw(directions)
    return along, _cross(along, draw(_across(along)))


materials = st.builds(
    Material,
    young=_number(60e9, 220e9),
    poisson=_number(0.15, 0.4),
    density=_number(2000.0, 8000.0),
    loss_factor=_number(0.0, 0.05),
    expansion=_number(0.0, 25e-6),
)

profiles = st.one_of(
    st.builds(Circular, _length(2, 8)),
    st.builds(Elliptic, _length(3, 8), _length(1, 6)),
    st.builds(Filleted, _length(8, 20), _length(1, 3)),
    st.builds(Straight, _length(4, 15)),
)
notches = st.builds(Notch, st.just("metal"), _length(0.6, 2), _length(8, 25), profiles)
necks = st.builds(Neck, st.just("metal"), _length(1, 3), profiles, st.none() | _length(3, 6))
leaves = st.builds(Leaf, st.just("metal"), _length(10, 40), _length(0.3, 1), _length(5, 25))
rods = st.builds(Rod, st.just("metal"), _length(10, 50), _length(0.8, 2))


_of_any_kind = st.sampled_from((notches, necks, leaves, rods)).flatmap(lambda part: part)


@st.composite
def givens(draw):
    """A stated 6x6: any positive definite matrix with stiffnesses like those of hinges, coupled by up to a third."""
    translation, rotation = draw(_number(-8.5, -6.0)), draw(_number(-4.5, -2.0))
    root = 10.0 ** (0.5 * np.array([translation] * 3 + [rotation] * 3))
    lower = np.eye(6) + np.tril(np.array([[draw(_STEPS) for _ in range(6)] for _ in range(6)]) / 9.0, -1)
    matrix = root[:, None] * (lower @ lower.T) * root
    freedoms = draw(_of_any_kind).intended
    return ComplianceMatrix(tuple(map(tuple, (0.5 * (matrix + matrix.T)).tolist())), freedoms, draw(_number(0.0, 0.05)))


piezos = st.builds(
    Piezo,
    stroke=_number(1e-5, 1e-4),
    stiffness=_number(1e7, 1e8),
    length=_length(20, 60),
    diameter=_length(5, 12),
    mass=_number(0.005, 0.1),
    loss_factor=_number(0.0, 0.05),
)
passive_parts = st.one_of(notches, necks, leaves, rods, givens())


_signs = st.sampled_from((0.0, 1.0, -1.0))
_sides = st.sampled_from(SensorSense)


@cache
def _perhaps(value):
    """It, or none."""
    return st.none() | value


@cache
@st.composite
def bodies(draw, *, massless=False, centre=places):
    """A body of stated mass; its inertia is that of a cuboid, turned by up to a few degrees in one plane."""
    if massless and draw(st.booleans()):
        return Body(reference=draw(_perhaps(places)))
    mass, (a, b, c) = draw(_number(0.05, 5.0)), (draw(_length(20, 100)) for _ in range(3))
    xx, yy, zz = (mass / 12.0 * (first**2 + second**2) for first, second in ((b, c), (a, c), (a, b)))
    product = 0.1 * min(xx, yy, zz) * draw(_signs)
    return Body(mass=mass, centre=draw(centre), inertia=Inertia(xx, yy, zz, xy=product), reference=draw(_perhaps(centre)))


@st.composite
def probes(draw, names):
    """One to eight gauges between any bodies, in any direction."""
    result = {}
    for number in range(draw(st.integers(1, 8))):
        body = draw(st.sampled_from(names))
        base = draw(st.sampled_from([name for name in (None, *names) if name != body]))
        along, up = draw(orientations())
        result[f"S{number + 1}"] = Probe("gauge", body, Pose(draw(places), along, up), draw(_sides), base or GROUND)
    return result


@st.composite
def _ears(draw):
    """Links as pairs of names: a chain from ground to platform, then chains between any two bodies there are; so all lie on a path."""
    known, pairs, count = [GROUND, PLATFORM], [], 0
    for number in range(draw(st.integers(1, 3))):
        start, end = (GROUND, PLATFORM) if number == 0 else draw(st.permutations(known))[:2]
        inner = [f"b{count + step + 1}" for step in range(draw(st.integers(0, 2)))]
        count += len(inner)
        chain = [start, *inner, end]
        pairs += itertools.pairwise(chain)
        known += inner
    return known[1:], pairs


@Shared
@st.composite
def mechanisms(draw):
    """Any connected graph of up to seven bodies and elastic links, with closed loops and dangling bodies, one to eight stacks.

    For elastic models: the ideal model of such a graph may find strokes without effect.
    """
    names, pairs = draw(_ears())
    hinges = {f"hinge{number + 1}": draw(passive_parts) for number in range(draw(st.integers(1, 3)))}
    stacks = {f"stack{number + 1}": draw(piezos) for number in range(draw(st.integers(1, 2)))}
    driven = draw(st.sets(st.integers(0, len(pairs) - 1), min_size=1, max_size=8))
    dangling = [f"d{number + 1}" for number in range(draw(st.integers(0, 2)))]
    pairs += [(draw(st.sampled_from([GROUND, *names])), name) for name in dangling]
    names += dangling
    links = {}
    for number, pair in enumerate(pairs):
        part = draw(st.sampled_from(sorted(stacks if number in driven else hinges)))
        joins = pair if draw(st.booleans()) else pair[::-1]
        links[f"link{number + 1}"] = Link(joins, part, draw(places), *draw(orientations()))
    return Mechanism(
        name="random graph",
        materials={"metal": draw(materials)},
        parts={**hinges, **stacks},
        bodies={name: draw(bodies(massless=True)) for name in names},
        links=links,
        sensors={"gauge": GAUGE},
        gauges=draw(probes(names)),
        damping=ModalDamping(0.01),
    )


# Six lines that hold a body well, two along each axis, 50 mm from the other two: (point, direction).
_LINES = tuple((tuple(0.05 * sign * part for part in arm), along) for along, arm in ((X, Y), (Y, Z), (Z, X)) for sign in (1.0, -1.0))


@st.composite
def _lines(draw, count):
    """Lines that differ a little from `_LINES` (in a random order), the first six of which hold a body well."""
    chosen = [_LINES[number % 6] for number in (*draw(st.permutations(range(6))), *range(6), 0)][:count]
    shift = st.tuples(*[st.integers(-10, 10)] * 3)
    lines = []
    for point, along in chosen:
        moved = tuple(part + 1e-3 * step for part, step in zip(point, draw(shift), strict=True))
        leaning = tuple(part + 0.02 * step for part, step in zip(along, draw(shift), strict=True))
        lines.append((moved, leaning))
    return lines


@st.composite
def direct_units(draw):
    """Neck, stack, neck in one line along x with the front neck at the origin: the stroke pushes the platform by as much."""
    span = draw(_length(50, 90))
    bodies_ = {name: draw(bodies(centre=st.just((-at * span, 0.0, 0.0)))) for name, at in (("base", 0.9), ("tip", 0.1))}
    links = {
        "back": Link((GROUND, "base"), "neck", (-span, 0.0, 0.0), X, bends=Y),
        "pzt": Link(("base", "tip"), "stack", (-0.5 * span, 0.0, 0.0), X),
        "front": Link(("tip", PLATFORM), "neck", (0.0, 0.0, 0.0), X, bends=Z),
    }
    return Unit({name: replace(body, reference=None) for name, body in bodies_.items()}, links), 1.0


@st.composite
def lever_units(draw):
    """A stack that turns a lever about a notch on the ground; the lever's end pushes a pole along x, up to the origin.

    The stroke acts `short` from the pivot, the pole at its arm `long`: the platform moves by long/short strokes, along +x.
    """
    short, long, pole, span = (draw(_length(*limits)) for limits in ((15, 25), (30, 60), (30, 50), (60, 90)))
    pivot = (-pole, long, 0.0)
    line = short - pole
    links = {
        "pivot": Link((GROUND, "lever"), "notch", pivot, Y, bends=Z),
        "front": Link(("tip", "lever"), "notch", (line, long, 0.0), Y, bends=Z),
        "pzt": Link(("base", "tip"), "stack", (line, long - 0.5 * span, 0.0), Y),
        "back": Link((GROUND, "base"), "notch", (line, long - span, 0.0), Y, bends=Z),
        "lower": Link(("lever", "pole"), "neck", (-pole, 0.0, 0.0), X, bends=Y),
        "upper": Link(("pole", PLATFORM), "neck", (0.0, 0.0, 0.0), X, bends=Y),
    }
    centres = {
        "lever": (-pole, 0.5 * long, 0.0),
        "tip": (line, long, 0.0),
        "base": (line, long - span, 0.0),
        "pole": (-0.5 * pole, 0.0, 0.0),
    }
    drawn = {name: replace(draw(bodies(centre=st.just(centre))), reference=None) for name, centre in centres.items()}
    return Unit(drawn, links), short / long


@Shared
@st.composite
def platforms(draw, wires=None, struts=None):
    """A platform on `wires` rods and `struts` driven units along lines that hold it well; returns (mechanism, lines, ratios).

    Each wire takes one freedom, so the mobility is 6 - wires; with as many struts as that or more the stage is actuated. `lines` are
    (point, direction) of every strut, `ratios` its stroke per motion of the platform along its line.
    """
    wires = draw(st.integers(0, 5)) if wires is None else wires
    struts = draw(st.integers(1, 8)) if struts is None else struts
    lines = draw(_lines(wires + struts))
    kinds = {"direct": draw(direct_units()), "lever": draw(lever_units())}
    picked = [draw(st.sampled_from(sorted(kinds))) for _ in range(struts)]
    poses = [Pose(point, along, _upright(along)) for point, along in lines]
    links = {
        f"wire{number + 1}": Link((GROUND, PLATFORM), "wire", pose.at, pose.along, pose.up) for number, pose in enumerate(poses[:wires])
    }
    mechanism = Mechanism(
        name="random platform",
        materials={"metal": draw(materials)},
        parts={"neck": draw(necks), "notch": draw(notches), "wire": draw(rods), "stack": draw(piezos)},
        bodies={PLATFORM: draw(bodies(centre=_near))},
        links=links,
        units={name: unit for name, (unit, _) in kinds.items()},
        placements={f"P{number + 1}": Placement(kind, pose) for number, (kind, pose) in enumerate(zip(picked, poses[wires:], strict=True))},
        sensors={"gauge": GAUGE},
        gauges=draw(probes([PLATFORM])),
        damping=ModalDamping(0.01),
    )
    return mechanism, lines[wires:], [kinds[kind][1] for kind in picked]


_near = st.tuples(_length(-20, 20), _length(-20, 20), _length(-20, 20))


def _upright(along):
    """A direction perpendicular to `along`, the same wherever a stage is turned to."""
    return tuple(axes(tuple(map(float, along)))[:, 2].tolist())


@Shared
@st.composite
def actuated_platforms(draw):
    """Platforms of any mobility with as many strokes as freedoms, or up to two more."""
    wires = draw(st.integers(0, 5))
    return draw(platforms(wires, 6 - wires + draw(st.integers(0, 2))))[0]


@Shared
@st.composite
def rosettes(draw):
    """Three to six equal random units around z under a platform whose reference lies on the axis."""
    count = draw(st.integers(3, 6))
    joints = draw(st.lists(st.tuples(places, orientations(), passive_parts), min_size=2, max_size=3))
    parts = {f"hinge{number}": part for number, (_, _, part) in enumerate(joints)} | {"stack": draw(piezos)}
    links = {
        f"link{number}": Link(("foot" if number else GROUND, PLATFORM if number else "foot"), f"hinge{number}", at, *orientation)
        for number, (at, orientation, _) in enumerate(joints)
    }
    links["pzt"] = Link(("foot", PLATFORM), "stack", draw(places), *draw(orientations()))
    around = Polar(draw(_length(20, 100)), draw(_number(-3.0, 3.0)), draw(st.sampled_from(InstanceOrientation)), draw(_length(-30, 30)))
    inertia = Inertia(0.01, 0.01, 0.02)
    return Mechanism(
        name="random rosette",
        materials={"metal": draw(materials)},
        parts=parts,
        bodies={PLATFORM: Body(mass=draw(_number(0.1, 5.0)), centre=(0.0, 0.0, draw(_length(-20, 20))), inertia=inertia)},
        units={"unit": Unit({"foot": draw(bodies())}, links)},
        placements={f"U1-U{count}": Placement("unit", around)},
        damping=ModalDamping(0.01),
    )


@st.composite
def turns(draw):
    """A rotation matrix from two whole directions, and a shift: where to a whole stage is moved."""
    along, up = draw(orientations())
    return axes(along, up), stack(draw(places))


def moved(mechanism, turn, shift):
    """The same stage elsewhere: every drawn thing of the stage's own frame turned and shifted (units follow with their poses)."""

    def point(at):
        return tuple((turn @ stack(at) + shift).tolist())

    def direction(along):
        return None if along is None else tuple((turn @ stack(along)).tolist())

    def pose(pattern):
        return Pose(point(pattern.at), direction(pattern.along), direction(pattern.up))

    return replace(
        mechanism,
        bodies={name: _moved_body(body, turn, point) for name, body in mechanism.bodies.items()},
        links={
            name: replace(link, at=point(link.at), along=direction(link.along), bends=direction(link.bends))
            for name, link in mechanism.links.items()
        },
        placements={name: replace(placement, pattern=pose(placement.pattern)) for name, placement in mechanism.placements.items()},
        gauges={name: replace(probe, pattern=pose(probe.pattern)) for name, probe in mechanism.gauges.items()},
        gravity=direction(mechanism.gravity),
    )


def _moved_body(body, turn, point):
    reference = None if body.reference is None else point(body.reference)
    if body.mass is None:
        return replace(body, reference=reference)
    inertia = turn @ tensor(body.inertia) @ turn.T
    values = Inertia(inertia[0, 0], inertia[1, 1], inertia[2, 2], -inertia[0, 1], -inertia[0, 2], -inertia[1, 2])
    return replace(body, centre=point(body.centre), inertia=values, reference=reference)
