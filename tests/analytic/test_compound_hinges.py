"""Compound hinges: Wittrick 1951 and leaves in series and parallel by hand, the same leaves drawn as links, and what is refused."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.assessment.sensitivities import sensitivities
from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.linear_statics.statics import statics
from flexstage.base.finding import DesignError
from flexstage.base.units.scale import X, Y, Z, mm
from flexstage.beams.compliance import compliance, stiffness
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Normal, Polar, Pose
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, Placement, Unit
from flexstage.mechanism.restrict import restrict
from flexstage.mechanism.store import dumps, loads
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.parts.body import Block, Body, Inertia
from flexstage.parts.cartwheel import Cartwheel
from flexstage.parts.cross_hinge import CrossHinge
from flexstage.parts.folded_leaf import FoldedLeaf
from flexstage.parts.freedom import Freedom
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.part import Restricted
from flexstage.solid.results.calibration import calibrate
from flexstage.spatial.frame import Frame, axes, mirror, spatial_rotation, transport
from flexstage.studies.tolerances.reach import reach

STEEL = Material(young=200e9, poisson=0.3, density=7800.0, expansion=12e-6)
LENGTH, THICKNESS, WIDTH = 20 * mm, 0.1 * mm, 5 * mm
LEAF = Leaf("steel", LENGTH, THICKNESS, WIDTH)
CROSS = CrossHinge("steel", LENGTH, THICKNESS, WIDTH, spacing=6 * mm)
WHEEL = Cartwheel("steel", LENGTH, THICKNESS, WIDTH, angle=0.5 * np.pi, hub_diameter=4 * mm, hub_mass=1e-3)
FOLDED = FoldedLeaf("steel", LENGTH, THICKNESS, WIDTH, second_length=15 * mm, corner=2 * mm)
ALL = (CROSS, replace(CROSS, spacing=8 * mm, middle_width=10 * mm, crossing=0.2, angle=1.2), WHEEL, FOLDED)


def stage(part):
    """A platform on one hinge, its twist given at the hinge."""
    body = Body(mass=1.0, centre=(0.03, 0.0, 0.01), inertia=Inertia(1e-3, 1e-3, 2e-3), reference=(0.0, 0.0, 0.0))
    links = {"pivot": Link((GROUND, PLATFORM), "hinge", (0.0, 0.0, 0.0), X, Z)}
    found = Mechanism("hinge", {"steel": STEEL}, {"hinge": part}, {PLATFORM: body}, links)
    assert check(found) == ()
    return found


def thicken(part):
    """With leaves that are meshed without slivers."""
    return replace(part, thickness=0.5 * mm)


def whole_stiffness(part):
    return statics(lumped(stage(part))).stiffness.values


def softness(part):
    return np.linalg.inv(whole_stiffness(part))


@pytest.mark.parametrize("angle", [0.8, 0.5 * np.pi, 2.0])
@pytest.mark.parametrize("crossing", [-0.2, 0.0, 0.12732, 0.5, 1.0])
def test_cross_axis_pivot_of_wittrick(angle, crossing):
    """K = 8 E I / L (3 lam^2 - 3 lam + 1), about the crossing; leaves stretch as (t/L)^2, which is left out."""
    pivot = softness(replace(CROSS, angle=angle, crossing=crossing, section=LeafSection.BEAM))
    rigidity = STEEL.young * WIDTH * THICKNESS**3 / 12.0
    expected = 8.0 * rigidity / LENGTH * (3.0 * crossing**2 - 3.0 * crossing + 1.0)
    assert 1.0 / pivot[5, 5] == pytest.approx(expected, rel=20.0 * (THICKNESS / LENGTH) ** 2 / np.sin(0.5 * angle) ** 2)
    assert np.abs(pivot[:2, 5]).max() < 1e-3 * pivot[5, 5] * LENGTH  # turned by a couple, the crossing stays


@pytest.mark.parametrize("hub", [0.0, 0.1, 0.5])
def test_cartwheel_is_two_pairs_in_series(hub):
    """A leaf turned about a point p before its end: 4 E I / L (1 + 3 p/L + 3 p^2/L^2); two such, twice in series."""
    rigidity = STEEL.young * WIDTH * THICKNESS**3 / 12.0
    found = 1.0 / softness(replace(WHEEL, hub_diameter=2.0 * hub * LENGTH, section=LeafSection.BEAM))[5, 5]
    assert found == pytest.approx(4.0 * rigidity / LENGTH * (1.0 + 3.0 * hub + 3.0 * hub**2), rel=1e-3)


def carried(matrix, direction, centre, height=0.0):
    """The stiffness or compliance of a leaf as it is at the origin: (stiffness, compliance) wise by `forward`."""
    direction = np.asarray(direction, float)
    turned = spatial_rotation(axes(tuple(direction), Z))
    arm = np.array([centre * direction[0], centre * direction[1], height])
    there = turned @ matrix @ turned.T
    carry = transport(arm)
    return carry.T @ there @ carry


def rotated(angle):
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def test_compounds_are_leaves_in_series_and_parallel():
    """The whole 6x6 of each, put together here from the leaf's own by hand."""
    stiff = stiffness(LEAF, STEEL)
    second = stiffness(replace(LEAF, length=15 * mm), STEEL)
    cross = carried(stiff, rotated(0.25 * np.pi), 0.0, -3 * mm) + carried(stiff, rotated(-0.25 * np.pi), 0.0, 3 * mm)
    pair = sum(carried(stiff, rotated(side * 0.25 * np.pi), 12 * mm) for side in (1, -1))
    other = sum(carried(stiff, rotated(side * 0.25 * np.pi), -12 * mm) for side in (1, -1))
    wheel = np.linalg.inv(np.linalg.inv(pair) + np.linalg.inv(other))
    folded = np.linalg.inv(np.linalg.inv(carried(stiff, X, -11 * mm)) + np.linalg.inv(carried(second, Y, 8.5 * mm)))
    for part, expected in ((CROSS, cross), (WHEEL, wheel), (FOLDED, folded)):
        root = np.sqrt(np.diag(expected))
        np.testing.assert_allclose(
            whole_stiffness(part) / root / root[:, None], expected / root / root[:, None], atol=1e-8, err_msg=part.kind
        )


def by_hand(whole):
    """The same stage with a link for every member, and a body for every inner one."""
    (link,), part = whole.links.values(), whole.parts["hinge"]
    outer = Frame(axes(link.along, link.bends), np.asarray(link.at))
    ends = {"first": link.joins[0], "second": link.joins[1]}
    parts, links = {}, {}
    for key, member in part.composition.members.items():
        frame = Frame(axes(member.along, member.bends), np.asarray(member.at)).within(outer)
        parts[key] = member.part
        links[key] = Link(
            tuple(ends.get(body, body) for body in member.joins), key, tuple(frame.position), *map(tuple, frame.rotation.T[::2])
        )
    inner = {key: turned(body, outer) for key, body in part.composition.bodies.items()}
    return replace(whole, parts=parts, links=links, bodies={**whole.bodies, **inner})


def turned(body, frame):
    along, up = map(tuple, frame.rotation.T[::2])
    place = tuple(frame.position)
    if body.solids:
        (block,) = body.solids.values()
        return replace(body, solids={"block": replace(block, at=place, along=along, up=up)}, reference=place)
    if body.mass is None:
        return replace(body, reference=place)
    own = np.diag([body.inertia.xx, body.inertia.yy, body.inertia.zz])
    matrix = frame.rotation @ own @ frame.rotation.T
    inertia = Inertia(*np.diag(matrix), -matrix[0, 1], -matrix[0, 2], -matrix[1, 2])
    return replace(body, centre=place, inertia=inertia)


@pytest.mark.parametrize("part", ALL, ids=lambda part: part.kind)
@pytest.mark.parametrize("seed", [0, *(pytest.param(each, marks=pytest.mark.full) for each in (1, 2))])
def test_a_compound_is_what_its_members_drawn_as_links_are(part, seed):
    """Stiffness, inertia and ideal motions, wherever it stands: so the laws of links hold for compounds."""
    random = np.random.default_rng(seed)
    along, helper = random.normal(size=(2, 3))
    link = Link((GROUND, PLATFORM), "hinge", tuple(random.normal(size=3) * 0.05), tuple(along), tuple(np.cross(along, helper)))
    whole = replace(stage(part), links={"pivot": link})
    drawn = by_hand(whole)
    one, other = lumped(whole), lumped(drawn)
    for name in ("stiffness_matrix", "inertia_matrix"):
        mine, theirs = getattr(one, name), getattr(other, name)
        size = np.sqrt(np.diag(theirs))
        size = np.where(size > 0.0, size, 1.0)
        np.testing.assert_allclose(mine / size / size[:, None], theirs / size / size[:, None], atol=1e-9)
    mine, theirs = ideal(whole), ideal(drawn)
    assert mine.mobility == theirs.mobility == (5 if part is FOLDED else 1)
    assert len(mine.redundant) == len(theirs.redundant)
    assert len(mine.idle) == len(theirs.idle) == (0 if isinstance(part, CrossHinge) else 1)


def test_redundant_constraints_and_idle_bodies_are_named():
    """Two leaves side by side hold z twice; a cartwheel's hub turns by itself."""
    (redundant,) = ideal(stage(CROSS)).redundant
    assert redundant.constraints == ("pivot.left.z", "pivot.right.z")
    (idle,) = ideal(stage(WHEEL)).idle
    assert idle.bodies == ("pivot.hub",)


def three_legs(part):
    """Three copies of a unit of one compound each, under a platform."""
    leg = Unit({}, {"pivot": Link((GROUND, PLATFORM), "hinge", (0.0, 0.0, 0.0), X, Y)})
    body = Body(solids={"plate": Block("steel", (0.2, 0.2, 0.02), (0.0, 0.0, 0.05))})
    place = {"B1-B3": Placement("leg", Polar(0.08, 0.0, InstanceOrientation.TANGENT))}
    return Mechanism(
        "legs", {"steel": STEEL}, {"hinge": part}, {PLATFORM: body}, units={"leg": leg}, placements=place, gravity=(0.0, 0.0, 0.0)
    )


@pytest.mark.parametrize("part", ALL, ids=lambda part: part.kind)
def test_mirrored_copies_are_mirror_images(part):
    """Members and inner bodies of a copy beyond a plane move as those before it do in a mirror."""
    leg = Unit({}, {"pivot": Link((GROUND, PLATFORM), "hinge", (0.02, 0.03, 0.0), (1.0, 0.4, 0.0), Z)})
    body = Body(reference=(0.0, 0.0, 0.0))
    here, there = (
        statics(
            lumped(
                Mechanism(
                    "leg", {"steel": STEEL}, {"hinge": part}, {PLATFORM: body}, units={"leg": leg}, placements={"B": Placement("leg", pose)}
                )
            )
        ).stiffness.values
        for pose in (Pose(), Pose(mirror=Normal.X))
    )
    root = np.sqrt(np.diag(here))
    image = mirror(0) @ here @ mirror(0)
    np.testing.assert_allclose(there / root / root[:, None], image / root / root[:, None], atol=1e-8)


def test_names_addresses_and_overrides():
    """A compound's numbers are those of its part; an override of one copy reaches its members alone."""
    whole = three_legs(CROSS)
    names = [f"B{copy}/pivot.{side}" for copy, side in itertools.product((1, 2, 3), ("left", "right"))]
    assert list(expand(whole).links) == names
    changed = set_value(whole, "B2/pivot.thickness", 0.2 * mm)
    assert get(changed, "B2/pivot.thickness") == 0.2 * mm
    found = {name: link.part.thickness for name, link in expand(changed).links.items()}
    assert found == {name: 0.2 * mm if name.startswith("B2") else THICKNESS for name in names}
    assert loads(dumps(changed)) == changed
    assert reach(changed, "hinges.thickness").components[""] == ("B1/pivot.thickness", "B2/pivot.thickness", "B3/pivot.thickness")
    assert reach(changed, "parts.hinge.angle").components[""] == ("B1/pivot.angle", "B2/pivot.angle", "B3/pivot.angle")


@pytest.mark.parametrize("address", ["thickness", "angle", "crossing", "spacing"])
def test_sensitivities_pass_through_a_compound(address):
    """The complex step against central differences."""
    whole = three_legs(CROSS)
    slopes = sensitivities(whole, (f"parts.hinge.{address}",), modes=3).frequency[0]
    value = get(whole, f"parts.hinge.{address}")
    step = 1e-4 * value
    high, low = (modes(lumped(set_value(whole, f"parts.hinge.{address}", value + side * step))).frequencies[:3] for side in (1, -1))
    np.testing.assert_allclose(slopes, (high - low) / (2.0 * step), rtol=1e-4, atol=1e-6 * np.max(high) / value)


def test_batches_are_single_designs_one_by_one():
    angles, thicknesses = np.array([1.0, 1.5, 2.0]), np.array([0.1, 0.15, 0.2]) * mm
    batch = lumped(three_legs(replace(CROSS, angle=angles, thickness=thicknesses))).stiffness_matrix
    for number, (angle, thickness) in enumerate(zip(angles, thicknesses, strict=True)):
        single = lumped(three_legs(replace(CROSS, angle=float(angle), thickness=float(thickness)))).stiffness_matrix
        np.testing.assert_allclose(batch[number], single, rtol=1e-12, atol=1e-9 * np.abs(single).max())


def test_what_a_compound_cannot_be_is_told():
    locked = replace(stage(CROSS), parts={"hinge": Restricted(CROSS, (Freedom.RZ,))})
    assert "a compound part cannot be restricted" in str(check(locked)[0])
    with pytest.raises(DesignError, match=r"parts\.hinge: a compound part cannot be restricted"):
        lumped(restrict(stage(CROSS), {"hinge": ((Freedom.RZ,), ())}))
    link = replace(stage(CROSS).links["pivot"], free=(Freedom.RZ,))
    assert "links.pivot.free" in str(check(replace(stage(CROSS), links={"pivot": link}))[0])
    ended = Link((GROUND, PLATFORM), "hinge", start=(-0.01, 0.0, 0.0), end=(0.01, 0.0, 0.0), bends=Z)
    assert "links.pivot.from" in str(check(replace(stage(CROSS), links={"pivot": ended}))[0])
    sideless = replace(stage(CROSS).links["pivot"], bends=None)
    assert "is not axisymmetric" in str(check(replace(stage(CROSS), links={"pivot": sideless}))[0])
    crowded = replace(stage(CROSS), parts={"hinge": replace(CROSS, spacing=4 * mm)})
    assert "parts.hinge.width: must be at most the spacing, 4 mm (got 5 mm). Increase the spacing" in str(check(crowded)[0])
    with pytest.raises(DesignError, match=r"parts\.hinge: it consists of several hinges"):
        calibrate(dumps(stage(CROSS)))


def test_compliance_needs_members():
    """Beam theory has no law of a compound: whoever asks for one is told so."""
    with pytest.raises(DesignError, match="kind cross_hinge"):
        compliance(CROSS, STEEL)


def test_the_hub_of_a_cartwheel_is_a_uniform_disc():
    """Second moments of a disc by its mean squares: r^2/4 across the axis, b^2/12 along it."""
    hub = WHEEL.composition.bodies["hub"]
    across, along = (0.5 * WHEEL.hub_diameter) ** 2 / 4.0, WHEEL.width**2 / 12.0
    expected = 1e-3 * np.array([across + along, across + along, 2.0 * across])
    np.testing.assert_allclose([hub.inertia.xx, hub.inertia.yy, hub.inertia.zz], expected, rtol=1e-12)
