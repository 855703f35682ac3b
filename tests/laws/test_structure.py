"""Laws of structure: what is said with less is the stage drawn out in full."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.base.number import stack
from flexstage.mechanism.addresses.address import addresses, assign, get
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import Normal, Pose
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, Placement, Probe, Unit
from flexstage.mechanism.restrict import restrict
from flexstage.mechanism.store import dumps, loads
from flexstage.mechanism.store.patch import patch
from flexstage.models.linear.static import static_gain
from flexstage.parts.amplified import Amplified
from flexstage.parts.body import Block, Body, Imported, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.cross_hinge import CrossHinge
from flexstage.parts.freedom import ALL, Freedom
from flexstage.parts.gauge import Gauge, SensorSense
from flexstage.parts.leaf import Leaf
from flexstage.parts.mass import solid_properties, within
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import axes, mirror
from tests.conftest import examples
from tests.laws.shared import lumped
from tests.laws.strategies import mechanisms, moved, turns

_ROOT = np.diag([1e-4] * 3 + [1e-2] * 3) @ (np.eye(6) + np.tril(np.arange(36).reshape(6, 6) % 7 / 20.0, -1))
SKEWED = tuple(map(tuple, (_ROOT @ _ROOT.T).tolist()))
"""A compliance of which every motion is coupled with every other."""


def comparable(model, names):
    """K and M with rows and columns of six a body, in the order of the names, scaled by the largest entries of K and of M."""
    places = [model.coordinates.index(f"{name}.{axis}") for name in names for axis in ("x", "y", "z", "rx", "ry", "rz")]
    return [matrix[np.ix_(places, places)] for matrix in (model.stiffness_matrix, model.inertia_matrix)]


def same(found, expected, tolerance=1e-9):
    """Whether K and M are equal, entries against the geometric mean of the largest ones in their rows."""
    for one, other in zip(found, expected, strict=True):
        root = np.sqrt(np.max(np.abs(other), axis=1))
        root = np.where(root > 0.0, root, 1.0)
        if not np.max(np.abs(one - other) / root / root[:, None]) < tolerance:
            return False
    return True


def grouped(mechanism, turn, shift):
    """The same stage, its bodies but the platform drawn in a unit `G`, which also holds every other link between them and the ground."""
    inner = {name: body for name, body in mechanism.bodies.items() if name != PLATFORM}
    own = {name: link for name, link in list(mechanism.links.items())[::2] if set(link.joins) <= {GROUND, *inner}}
    back = Mechanism("", bodies=inner, links=own)
    drawn = moved(back, turn.T, -turn.T @ shift)

    def far(name):
        return f"G/{name}" if name in inner else name

    return replace(
        mechanism,
        bodies={PLATFORM: mechanism.bodies[PLATFORM]},
        units={"group": Unit(drawn.bodies, drawn.links)},
        placements={"G": Placement("group", Pose(tuple(shift.tolist()), tuple(turn[:, 0].tolist()), tuple(turn[:, 2].tolist())))},
        links={
            name: replace(link, joins=tuple(far(body) for body in link.joins)) for name, link in mechanism.links.items() if name not in own
        },
        gauges={name: replace(probe, body=far(probe.body), base=far(probe.base)) for name, probe in mechanism.gauges.items()},
    )


@examples(6)
@given(mechanisms(), turns())
def test_links_may_join_bodies_of_placed_copies(mechanism, where):
    stage = grouped(mechanism, *where)
    assert not check(stage)
    names = list(mechanism.bodies)
    found = comparable(lumped(stage), [name if name == PLATFORM else f"G/{name}" for name in names])
    assert same(found, comparable(lumped(mechanism), names))


def wholly_grouped(mechanism, turn, shift, mirror=None):
    """The same stage, its bodies but the platform and all its links drawn in a unit `G`, or its image in a plane of the stage."""
    inner = {name: body for name, body in mechanism.bodies.items() if name != PLATFORM}
    drawn = moved(Mechanism("", bodies=inner, links=mechanism.links), turn.T, -turn.T @ shift)
    pose = Pose(tuple(shift.tolist()), tuple(turn[:, 0].tolist()), tuple(turn[:, 2].tolist()), mirror)

    def far(name):
        return f"G/{name}" if name in inner else name

    return replace(
        mechanism,
        bodies={PLATFORM: mechanism.bodies[PLATFORM]},
        units={"group": Unit(drawn.bodies, drawn.links)},
        placements={"G": Placement("group", pose)},
        links={},
        gauges={
            name: replace(probe, body=far(probe.body), base=far(probe.base), pattern=replace(probe.pattern, mirror=mirror))
            for name, probe in mechanism.gauges.items()
        },
    )


def reflected(body, axis):
    """A body of stated mass, in a mirror."""
    signs = np.where(np.arange(3) == axis, -1.0, 1.0)

    def point(at):
        return None if at is None else tuple((signs * at).tolist())

    inertia = body.inertia
    if inertia is not None:
        x, y, z = signs
        inertia = replace(inertia, xy=inertia.xy * x * y, xz=inertia.xz * x * z, yz=inertia.yz * y * z)
    return replace(body, centre=point(body.centre), reference=point(body.reference), inertia=inertia)


@examples(6)
@given(mechanisms(), turns(), st.sampled_from(Normal))
def test_a_mirrored_stage_has_the_reflected_matrices(mechanism, where, normal):
    axis = "xyz".index(normal.value)
    image = wholly_grouped(mechanism, *where, mirror=normal)
    image = replace(image, bodies={PLATFORM: reflected(mechanism.bodies[PLATFORM], axis)})
    assert not check(image)
    assert loads(dumps(image)) == image
    plain, seen = lumped(mechanism), lumped(image)
    names = list(mechanism.bodies)
    turned = np.kron(np.eye(len(names)), mirror(axis))
    expected = [turned @ matrix @ turned for matrix in comparable(plain, names)]
    assert same(comparable(seen, [name if name == PLATFORM else f"G/{name}" for name in names]), expected)
    gauges = [f"S{number + 1}" for number in range(len(mechanism.gauges))]
    strokes = [[item.name for item in model.inputs][: len(expand(mechanism).actuators)] for model in (plain, seen)]
    readings = [static_gain(model, gauges, inputs).values for model, inputs in zip((plain, seen), strokes, strict=True)]
    assert np.allclose(*readings, rtol=1e-6, atol=1e-6)  # an expansion stays one, and a gap that opens opens


def test_a_guide_drawn_on_both_sides_is_one_side_and_its_image():
    leaf = Leaf("metal", length=0.03, thickness=0.0005, width=0.02)
    lug = Body(solids={"lug": Block("metal", size=(0.01, 0.004, 0.03), at=(0.02, 0.006, 0.001))}, of=PLATFORM)
    foot = Body(mass=0.2, centre=(0.03, 0.05, 0.002), inertia=Inertia(1e-4, 2e-4, 2.5e-4, 1e-5, 2e-5, -1e-5))
    links = {
        "upper": Link((GROUND, "foot"), "leaf", (0.02, 0.07, 0.0), (0.1, -1.0, 0.0), (0.0, 0.0, 1.0)),
        "lower": Link(("foot", "lug"), "skewed", (0.025, 0.03, 0.0), (0.2, -1.0, 0.3), (1.0, 0.2, 0.0)),
    }
    skewed = ComplianceMatrix(SKEWED, (Freedom.RZ,))
    stage = Mechanism(
        "pair",
        materials={"metal": Material(2e11, 0.3, 7800.0)},
        parts={"leaf": leaf, "skewed": skewed, "image": skewed.mirrored},
        bodies={PLATFORM: Body(solids={"plate": Block("metal", size=(0.08, 0.01, 0.03))})},
        units={"side": Unit({"foot": foot, "lug": lug}, links)},
        placements={"L": Placement("side", Pose()), "R": Placement("side", Pose(mirror=Normal.X))},
    )
    other = Unit(
        {
            "foot": reflected(foot, 0),
            "lug": replace(lug, solids={"lug": replace(lug.solids["lug"], at=(-0.02, 0.006, 0.001))}),
        },
        {
            "upper": replace(links["upper"], at=(-0.02, 0.07, 0.0), along=(-0.1, -1.0, 0.0)),
            "lower": replace(links["lower"], part="image", at=(-0.025, 0.03, 0.0), along=(-0.2, -1.0, 0.3), bends=(-1.0, 0.2, 0.0)),
        },
    )
    by_hand = replace(
        stage, units={"side": stage.units["side"], "other": other}, placements={**stage.placements, "R": Placement("other", Pose())}
    )
    assert not check(stage)
    names = [PLATFORM, "L/foot", "R/foot"]
    assert same(comparable(lumped(stage), names), comparable(lumped(by_hand), names), 1e-12)


def test_a_step_file_in_a_mirrored_copy_is_the_reflected_solid():
    """What is stated of it weighs as the body's own frame has it; the outline that is drawn says that it is the image."""
    lug = Imported("metal", "lug.step", "0", (0.01, 0.02, 0.03), 0.1, (0.001, 0.002, 0.003), Inertia(2e-6, 3e-6, 4e-6, 1e-7, 2e-7, 3e-7))
    unit = Unit({"lug": Body(solids={"lug": lug})}, {"wire": Link((GROUND, "lug"), "wire", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))})
    stage = Mechanism(
        "imported",
        materials={"metal": Material(2e11, 0.3, 7800.0)},
        parts={"wire": Rod("metal", 0.03, 0.001)},
        bodies={PLATFORM: Body(mass=1.0, point=True)},
        units={"arm": unit},
        placements={"A": Placement("arm", Pose(mirror=Normal.Z))},
    )
    assert not any("mirror" in str(finding) for finding in check(stage))
    body = expand(stage).bodies["A/lug"]
    (placed,) = body.solids.values()
    assert placed.solid == lug.mirrored
    assert placed.solid.mirrored == lug
    assert body.mass is not None
    own = solid_properties(replace(placed.solid, at=(0.0, 0.0, 0.0), middle=(0.0, 0.0, 0.0)), 1.0)
    seen = within(own, placed.frame)
    np.testing.assert_allclose(seen.centre, body.mass.centre, atol=1e-15)
    np.testing.assert_allclose(seen.inertia, body.mass.inertia, atol=1e-15)


def test_an_amplified_actuator_has_the_mirror_image_of_a_given_matrix_and_pushes_as_its_image():
    random = np.random.default_rng(5)
    factor, shift = random.normal(size=(6, 6)), tuple(random.normal(size=6))
    part = Amplified(stroke=1e-4, deformation=shift, matrix=tuple(map(tuple, 1e6 * (factor @ factor.T + 6.0 * np.eye(6)))))
    signs = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])  # across y
    np.testing.assert_array_equal(part.mirrored.between, signs[:, None] * part.between * signs)
    np.testing.assert_array_equal(part.mirrored.free_deformation, signs * part.free_deformation)
    assert part.mirrored.mirrored == part
    solid = replace(part, mass=0.1, inertia=Inertia(1e-6, 2e-6, 3e-6, xy=1e-7, xz=2e-7, yz=3e-7))
    assert solid.mirrored.inertia == Inertia(1e-6, 2e-6, 3e-6, xy=-1e-7, xz=2e-7, yz=-3e-7)


def test_a_compound_is_mirrored_member_by_member():
    hinge = CrossHinge("metal", 0.03, 0.0005, 0.008, spacing=0.01)
    unit = Unit(
        {"arm": Body(mass=0.2, inertia=Inertia(1e-4, 1e-4, 1e-4))},
        {"pivot": Link((GROUND, "arm"), "hinge", (0.02, 0.01, 0.003), (1.0, 0.5, 0.0), (0.0, 0.0, 1.0))},
    )
    stage = Mechanism(
        "hinged",
        materials={"metal": Material(2e11, 0.3, 7800.0)},
        parts={"hinge": hinge, "wire": Rod("metal", 0.03, 0.001)},
        bodies={PLATFORM: Body(mass=1.0, point=True)},
        links={"wire": Link((GROUND, PLATFORM), "wire", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))},
        units={"side": unit},
        placements={"A": Placement("side", Pose()), "B": Placement("side", Pose(mirror=Normal.Y))},
    )
    model = lumped(stage)
    one, other = (comparable(model, [name]) for name in ("A/arm", "B/arm"))
    assert same(other, [mirror(1) @ matrix @ mirror(1) for matrix in one], 1e-12)
    assert not same(other, one, 1e-6)


def likened():
    """A stage on two pairs of leaves, the outer like the inner but for a shorter lower leaf, a heavier foot and a leaf elsewhere."""
    inner = Unit(
        {"foot": Body(mass=0.1, inertia=Inertia(1e-4, 1e-4, 1e-4)), "shoe": Body(mass=0.05, inertia=Inertia(1e-5, 1e-5, 1e-5))},
        {
            "upper": Link((GROUND, "foot"), "leaf", (0.0, 0.05, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
            "lower": Link(("foot", "shoe"), "leaf", (0.0, 0.02, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
            "weld": Link(("shoe", PLATFORM), "leaf", (0.0, 0.0, 0.01), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
        },
    )
    lower = Link(("foot", "shoe"), "short", (0.001, 0.02, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
    outer = Unit({"foot": Body(mass=0.2, inertia=Inertia(2e-4, 1e-4, 1e-4))}, {"lower": lower}, like="inner")
    leaf = Leaf("metal", length=0.03, thickness=0.0005, width=0.02)
    return Mechanism(
        "likened",
        materials={"metal": Material(2e11, 0.3, 7800.0)},
        parts={"leaf": leaf, "short": replace(leaf, length=0.02)},
        bodies={PLATFORM: Body(mass=1.0, inertia=Inertia(1e-3, 1e-3, 1e-3))},
        units={"outer": outer, "inner": inner},
        placements={"A": Placement("inner", Pose((0.05, 0.0, 0.0))), "B": Placement("outer", Pose((-0.05, 0.0, 0.0)))},
        overrides={
            "inner/upper.thickness": 0.0006,
            "outer/upper.at.z": 0.002,
            "outer/weld.thickness": 0.0004,
            "inner/weld.thickness": 0.0003,
        },
    )


def test_a_unit_like_another_is_the_unit_drawn_out():
    stage = likened()
    assert not check(stage)
    inner, outer = stage.units["inner"], stage.units["outer"]
    links = {**inner.links, **outer.links}
    links["upper"] = replace(links["upper"], at=(0.0, 0.05, 0.002))
    whole = Unit({**inner.bodies, **outer.bodies}, links)
    changes = {key: value for key, value in stage.overrides.items() if key != "outer/upper.at.z"} | {"outer/upper.thickness": 0.0006}
    by_hand = replace(stage, units={"outer": whole, "inner": inner}, overrides=changes)
    names = [PLATFORM, "A/foot", "A/shoe", "B/foot", "B/shoe"]
    assert same(comparable(lumped(stage), names), comparable(lumped(by_hand), names), 1e-13)


def test_a_unit_like_another_follows_it_and_files_keep_the_relation():
    stage = likened()
    assert loads(dumps(stage)) == stage
    text = dumps(stage, {"units.outer": "as the inner one"})
    changed = patch(
        text, {"inner/lower.at.x": "3 mm", "units.inner.links.weld.at.y": "1 mm", "outer/weld.at.z": "4 mm", "B/weld.length": "31 mm"}
    )
    assert "# as the inner one" in changed
    found = expand(loads(changed)).links
    assert loads(changed).units["outer"].like == "inner"
    assert [found[name].frame.position.round(9).tolist() for name in ("A/weld", "B/weld")] == [[0.05, 0.001, 0.01], [-0.05, 0.001, 0.004]]
    assert found["B/lower"].frame.position[0] == -0.049  # drawn by itself
    assert [found[name].part.length for name in ("A/weld", "B/weld")] == [0.03, 0.031]
    assert "outer/weld.at.z" in addresses(loads(changed))
    assert np.allclose(lumped(restrict(stage, {"outer/upper": (ALL, ())})).stiffness_matrix, lumped(stage).stiffness_matrix, rtol=1e-12)


@pytest.mark.parametrize(
    ("like", "said"),
    [
        ("iner", 'units.outer.like: unknown unit "iner". Use inner'),
        ("outer", "units.outer.like: circular reference."),
    ],
)
def test_units_like_nothing_or_themselves_are_refused(like, said):
    stage = likened()
    bad = replace(stage, units={**stage.units, "outer": replace(stage.units["outer"], like=like)}, overrides={})
    assert any(said in str(finding) for finding in check(bad))
    circle = replace(stage, units={**stage.units, "inner": replace(stage.units["inner"], like="outer")})
    assert sum("circular reference" in str(finding) for finding in check(circle)) == 2


def test_bodies_of_the_other_unit_are_addressed_there():
    assert get(likened(), "outer/foot.mass") == 0.2
    with pytest.raises(DesignError, match=r'inherits its body "shoe" from inner\. Use inner/shoe'):
        get(likened(), "outer/shoe.mass")


@examples(7)
@given(mechanisms())
def test_a_link_may_be_given_by_its_ends(mechanism):
    def by_ends(link):
        half = 0.5 * np.real(getattr(mechanism.parts[link.part], "span", 0.02)) * axes(link.along)[:, 0]
        ends = {"start": tuple((stack(link.at) - half).tolist()), "end": tuple((stack(link.at) + half).tolist())}
        return replace(link, at=None, along=None, **ends)

    stage = replace(mechanism, links={name: by_ends(link) for name, link in mechanism.links.items()})
    assert not check(stage)
    assert loads(dumps(stage)) == stage
    names = list(mechanism.bodies)
    assert same(comparable(lumped(stage), names), comparable(lumped(mechanism), names), 1e-7)


def strut(**place):
    return Mechanism(
        "strut",
        materials={"metal": Material(2e11, 0.3, 7800.0)},
        parts={"wire": Rod("metal", 0.03, 0.001)},
        bodies={PLATFORM: Body(mass=1.0, point=True)},
        links={"strut": Link((GROUND, PLATFORM), "wire", **place)},
        sensors={"gauge": Gauge(range=1e-4)},
        gauges={"S": Probe("gauge", PLATFORM, Pose(along=(0.0, 0.0, 1.0)), SensorSense.OPENS)},
    )


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ({"start": (0.0, 0.0, 0.0), "end": (0.0, 0.0, 0.031)}, "got 31 mm, expected the length of part wire, 30 mm"),
        ({"start": (0.0, 0.0, 0.0)}, "links.strut: to missing."),
        ({"at": (0.0, 0.0, 0.0), "end": (0.0, 0.0, 0.03)}, "both at and to specified"),
        ({"at": (0.0, 0.0, 0.0)}, 'along missing. Use e.g. along = "x"'),
        ({"start": (0.0, 0.0, 0.0), "end": (0.0, 0.0, 0.0)}, "got 0 mm, expected the length of part wire, 30 mm"),
    ],
)
def test_ends_that_cannot_be(place, said):
    assert any(said in str(finding) for finding in check(strut(**place)))


def test_ends_are_addressed_as_files_call_them():
    stage = strut(start=(0.0, 0.0, 0.0), end=(0.0, 0.0, 0.03))
    assert not check(stage)  # a gauge along z does not say which way is up, nor does a wire
    moved_ = assign(assign(stage, "links.strut.from.x = 1 mm"), "strut.to.x = 1 mm")
    assert expand(moved_).links["strut"].frame.position.tolist() == [0.001, 0.0, 0.015]
    text = patch(dumps(stage), {"links.strut.from.y": "2 mm"})
    assert 'from = ["0 mm", "2 mm", "0 mm"]' in text
    assert get(loads(text, checked=False), "links.strut.from.y") == 0.002
    likewise = replace(likened(), overrides={})
    placed = replace(
        likewise, placements={**likewise.placements, "B": Placement("outer", Pose(start=(-0.05, 0.0, 0.0), end=(-0.01, 0.0, 0.0)))}
    )
    assert loads(dumps(placed)) == placed
    assert not check(placed)
    assert lumped(placed).stiffness_matrix.tolist() == lumped(likewise).stiffness_matrix.tolist()
