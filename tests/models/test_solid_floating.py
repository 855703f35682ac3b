"""A stage of superelements that moves as one body, all its bodies, joints and copies at once; and one cased stack alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.units.scale import X, mm
from flexstage.mechanism.assembly.expand import PlacedLink, expand
from flexstage.mechanism.mechanism import PLATFORM, Link, Mechanism
from flexstage.models.linear.model import Contributions, LinearModel, assemble
from flexstage.models.linear.static import static_gain
from flexstage.parts.body import Body
from flexstage.parts.mass import MassProperties
from flexstage.parts.neck import Neck
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import length
from flexstage.solid.results.read import model as fea_model
from flexstage.spatial.frame import COMPONENTS, FORCES, rigid_inertia, transport
from tests.models.floating import COARSE, MOUNT, STACK, floating, read_floating

STAGE = floating()
ASSEMBLY = expand(STAGE)
CENTRE = ASSEMBLY.bodies[PLATFORM].reference
METRE = np.array([1.0, 1.0, 1.0, 0.02, 0.02, 0.02])
"""A rotation of one radian is weighed as the translation it makes at 20 mm."""


@pytest.fixture(scope="module")
def model() -> LinearModel:
    return read_floating().model


def without(mark: str, contributions: Contributions, model: LinearModel) -> np.ndarray:
    """The matrix of all contributions but those with a mark in their names."""
    return assemble({name: item for name, item in contributions.items() if mark not in name}, len(model.coordinates))


def moved(matrix: np.ndarray, model: LinearModel) -> np.ndarray:
    """Inertia (6, 6) about the platform's reference of what moves as one body."""
    return (model.rigid.T @ matrix @ model.rigid) * METRE * METRE[:, None]


def scales(model: LinearModel) -> np.ndarray:
    """Of the coordinates: rotations at 20 mm; those within a component have a strain energy of one, they are not turned into metres."""
    return np.array([0.02 if name[-2:] in ("rx", "ry", "rz") else 1.0 for name in model.coordinates])


def test_no_rigid_motion_strains_anything(model: LinearModel) -> None:
    """All coordinates, moved as one body about the platform: without its mount no force anywhere, six times."""
    stiffness = without(MOUNT, model.stiffness, model)
    force = scales(model)[:, None] * (stiffness @ model.rigid) * METRE
    size = np.abs(scales(model)[:, None] * stiffness * scales(model)).max()
    assert np.abs(force).max() < 1e-9 * size
    assert np.linalg.matrix_rank(model.rigid) == 6


def test_every_part_is_free_of_strain_by_itself(model: LinearModel) -> None:
    """No force of one part hides behind another's."""
    for name, item in model.stiffness.items():
        if not name.startswith(MOUNT):
            force = item.law @ item.operator @ model.rigid * METRE
            assert np.abs(force).max() < 1e-8 * np.abs(item.law).max(), name


def test_rigid_motion_is_seen_by_every_output(model: LinearModel) -> None:
    """Bodies and points show the motion carried to where they are; nothing passes through links; a gauge between bodies reads 0."""
    seen = dict(zip((channel.name for channel in model.outputs), model.output @ model.rigid * METRE, strict=True))
    places = {name: body.reference for name, body in ASSEMBLY.bodies.items()} | {
        name: point for name, (_, point) in ASSEMBLY.points.items()
    }
    assert len(places) == 9
    for name, place in places.items():
        expected = transport(place - CENTRE) * METRE
        np.testing.assert_allclose([seen[f"{name}.{part}"] for part in COMPONENTS], expected, atol=1e-9, err_msg=name)
    for name in set(ASSEMBLY.links) - {MOUNT}:
        passed = np.array([seen[f"{name}.{part}"] for part in FORCES])
        assert np.abs(passed).max() < 1e-9 * np.abs(model.stiffness[name].law).max(), name
    assert np.abs(seen["S"]).max() < 1e-12


def neck_mass(link: PlacedLink) -> MassProperties:
    """Of a straight neck: a block in its frame."""
    part = link.part
    assert isinstance(part, Neck)
    assert link.material is not None
    assert part.width is not None
    size = np.array([length(part.profile), part.width, part.thickness])
    mass, turn = link.material.density * np.prod(size), link.frame.rotation
    return MassProperties(np.asarray(mass), link.frame.position, turn @ np.diag(mass / 12.0 * (np.sum(size**2) - size**2)) @ turn.T)


def stated() -> dict[str, MassProperties]:
    """Of every body's outlines, every neck and the payload, by closed forms."""
    found = {name: body.mass for name, body in ASSEMBLY.bodies.items() if body.mass is not None}
    found["mirror"] = MassProperties(np.asarray(0.05), np.array([5e-3, 0.0, 10e-3]), np.diag([1e-6, 2e-6, 3e-6]))
    return found | {name: neck_mass(link) for name, link in ASSEMBLY.links.items() if isinstance(link.part, Neck)}


def exact(*names: str) -> np.ndarray:
    items = stated()
    return sum(rigid_inertia(items[name].mass, items[name].inertia, items[name].centre, CENTRE) for name in names) * METRE * METRE[:, None]


def test_the_whole_weighs_what_its_outlines_do(model: LinearModel) -> None:
    """Mass, centre of mass and all moments of inertia of blocks, necks, frame and payload by closed forms: flat faces mesh exactly."""
    flat = {name: item for name, item in model.inertia.items() if MOUNT not in name and "pzt" not in name}
    found = moved(assemble(flat, len(model.coordinates)), model)
    assert np.abs(found - exact(*stated())).max() < 1e-9 * found[0, 0]


def test_a_round_stack_weighs_what_it_does(model: LinearModel) -> None:
    """In all three copies, to what eight curved elements around have of a circle's area."""
    for name in ("B1/pzt", "B2/pzt", "B3/pzt"):
        item, part = model.inertia[f"{name} (link)"], ASSEMBLY.links[name].part
        assert isinstance(part, Piezo)
        motion = item.operator @ model.rigid
        found, arm = motion.T @ item.law @ motion, ASSEMBLY.links[name].frame.position - CENTRE
        assert found[0, 0] == pytest.approx(part.mass, rel=2e-3)
        np.testing.assert_allclose([found[1, 5], -found[0, 5]], found[0, 0] * arm[:2], rtol=1e-3)


@pytest.mark.parametrize(
    ("names", "parts"),
    [
        (("platform",), ("platform",)),
        (("B2/tip",), ("B2/tip",)),  # of another medium than its neck: elements end at the joint
        (("B1/base", "B1/back (link)"), ("B1/base", "B1/back")),  # one medium: elements may lie across the joint, the sum is exact
    ],
)
def test_each_body_weighs_what_its_outlines_do(model: LinearModel, names: tuple[str, ...], parts: tuple[str, ...]) -> None:
    found = moved(assemble({name: model.inertia[name] for name in names}, len(model.coordinates)), model)
    assert np.abs(found - exact(*parts)).max() < 1e-9 * found[0, 0]


def test_ground_acceleration_acts_on_the_whole_inertia(model: LinearModel) -> None:
    """Accelerated rigidly with the ground, every coordinate feels M times the rigid motion, those within components included."""
    mass = without(MOUNT, model.inertia, model)
    apart = {coordinate for coordinate in model.coordinates if coordinate.startswith(("frame.", MOUNT))}
    rows = [index for index, coordinate in enumerate(model.coordinates) if coordinate not in apart]
    expected, found = mass @ model.rigid * METRE, model.base_inertia * METRE
    inner = [index for index in rows if "~" in model.coordinates[index]]
    assert np.abs(expected[inner]).max() > 0.0
    for index in rows:
        np.testing.assert_allclose(
            found[index], expected[index], atol=1e-9 * np.abs(expected[index]).max(), err_msg=model.coordinates[index]
        )


def stack_alone() -> Mechanism:
    """A cased stack, its ceramic without contraction, between the ground and a rigid platform about its far end."""
    end = (5 * mm, 0.0, 0.0)
    links = {"pzt": Link(("ground", PLATFORM), "stack", (0.0, 0.0, 0.0), X)}
    bodies = {PLATFORM: Body(mass=0.1, centre=end, reference=end)}
    return Mechanism("stack", parts={"stack": replace(STACK, poisson=0.0)}, bodies=bodies, links=links)


def test_a_cased_stack_has_its_stiffness_its_rigidity_and_its_stroke() -> None:
    """1/k along, M L/B and M L^2/(2 B) under a moment, as in torsion; the stroke moves the free end alone; the load passes whole."""
    model, size, rigidity = fea_model(stack_alone(), COARSE, cache=None), STACK.length, STACK.bending_rigidity
    assert rigidity is not None
    twist, wrench = (tuple(f"{PLATFORM}.{name}" for name in names) for names in (COMPONENTS, FORCES))
    flexibility = static_gain(model, twist, wrench).values
    assert flexibility[0, 0] * STACK.stiffness == pytest.approx(1.0, rel=3e-3)
    np.testing.assert_allclose(np.diag(flexibility)[3:], size / rigidity, rtol=1e-3)
    np.testing.assert_allclose([-flexibility[2, 4], flexibility[1, 5]], 0.5 * size**2 / rigidity, rtol=1e-3)
    np.testing.assert_allclose(static_gain(model, twist, ("pzt",)).values[:, 0], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-9)
    passed = static_gain(model, tuple(f"pzt.{name}" for name in FORCES), wrench).values
    np.testing.assert_allclose(passed, transport(np.array([5 * mm, 0.0, 0.0])).T, atol=1e-6)
