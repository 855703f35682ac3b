"""Laws of structure: what is said with less is the stage drawn out in full."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flexstage.mechanism.checks import check
from flexstage.mechanism.expand import expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, Placement, Unit
from flexstage.mechanism.pattern import Normal, Pose
from flexstage.mechanism.store import dumps, loads
from flexstage.models.linear.static import static_gain
from flexstage.parts.body import Block, Body, Imported, Inertia
from flexstage.parts.cross_hinge import CrossHinge
from flexstage.parts.freedom import Freedom
from flexstage.parts.given import Given
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import mirror
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
        place={"G": Placement("group", Pose(tuple(shift.tolist()), tuple(turn[:, 0].tolist()), tuple(turn[:, 2].tolist())))},
        links={
            name: replace(link, joins=tuple(far(body) for body in link.joins)) for name, link in mechanism.links.items() if name not in own
        },
        gauges={name: replace(probe, body=far(probe.body), base=far(probe.base)) for name, probe in mechanism.gauges.items()},
    )


@examples(25, 1000)
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
        place={"G": Placement("group", pose)},
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


@examples(25, 1000)
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
    skewed = Given(SKEWED, (Freedom.RZ,))
    stage = Mechanism(
        "pair",
        materials={"metal": Material(2e11, 0.3, 7800.0)},
        parts={"leaf": leaf, "skewed": skewed, "image": skewed.mirrored},
        bodies={PLATFORM: Body(solids={"plate": Block("metal", size=(0.08, 0.01, 0.03))})},
        units={"side": Unit({"foot": foot, "lug": lug}, links)},
        place={"L": Placement("side", Pose()), "R": Placement("side", Pose(mirror=Normal.X))},
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
    by_hand = replace(stage, units={"side": stage.units["side"], "other": other}, place={**stage.place, "R": Placement("other", Pose())})
    assert not check(stage)
    names = [PLATFORM, "L/foot", "R/foot"]
    assert same(comparable(lumped(stage), names), comparable(lumped(by_hand), names), 1e-12)


def test_what_has_no_mirror_image_is_refused_by_name():
    box = Imported("metal", "lug.step", "0", (0.01,) * 3, 0.1, (0.0, 0.0, 0.0), Inertia(1e-6, 1e-6, 1e-6))
    unit = Unit({"lug": Body(solids={"lug": box})}, {"wire": Link((GROUND, "lug"), "wire", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))})
    stage = Mechanism(
        "imported",
        materials={"metal": Material(2e11, 0.3, 7800.0)},
        parts={"wire": Rod("metal", 0.03, 0.001)},
        bodies={PLATFORM: Body(mass=1.0, point=True)},
        units={"arm": unit},
        place={"A": Placement("arm", Pose(mirror=Normal.Z))},
    )
    assert any("arm/lug.lug is drawn in a STEP file, which cannot be mirrored" in str(finding) for finding in check(stage))


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
        place={"A": Placement("side", Pose()), "B": Placement("side", Pose(mirror=Normal.Y))},
    )
    model = lumped(stage)
    one, other = (comparable(model, [name]) for name in ("A/arm", "B/arm"))
    assert same(other, [mirror(1) @ matrix @ mirror(1) for matrix in one], 1e-12)
    assert not same(other, one, 1e-6)
