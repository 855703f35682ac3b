"""Stages that can be built: links end on faces of the bodies they join, bodies are one piece each, and nothing else meets."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, expand
from flexstage.mechanism.geometry.outline import Outline, outlines
from flexstage.mechanism.mechanism import GROUND
from flexstage.parts.body import Block, PlacedSolid
from flexstage.parts.part import is_actuator

BUILDABLE = ("double-triangle", "parallelogram", "xy-stage", "tip-tilt", "tip-tilt-four")
CLEARANCE = 0.3e-3
AROUND_CASINGS = 1e-3
FLUSH = 1e-9


def gap(one: Outline, other: Outline) -> float:
    """Largest separation of two outlines over the normals of faces and edges, and from round ones to corners: their distance is no less."""
    turns = [outline.frame.rotation for outline in (one, other)]
    normals = [*turns[0].T, *turns[1].T, *(np.cross(a, b) for a in turns[0].T for b in turns[1].T)]
    for disc, box in ((one, other), (other, one)):
        if disc.is_cylinder:
            signs = np.array(list(itertools.product((-0.5, 0.0, 0.5), repeat=3)))
            arms = box.frame.position + (signs * box.size) @ box.frame.rotation.T - disc.frame.position
            normals += list(arms - np.outer(arms @ disc.frame.rotation[:, 0], disc.frame.rotation[:, 0]))
    units = np.array([normal / np.linalg.norm(normal) for normal in normals if np.linalg.norm(normal) > 1e-6])
    units = np.concatenate([units, -units])
    return -float(np.min(one.reach(units) + other.reach(-units)))


def faces(solid: PlacedSolid) -> list[tuple[np.ndarray, np.ndarray, np.ndarray, bool]]:
    """Middle, axes (normal first), half sizes across and roundness of a solid's flat faces."""
    turn, place = solid.frame.rotation, solid.frame.position
    if not isinstance(solid.solid, Block):
        half, radius = 0.5 * solid.solid.length, 0.5 * solid.solid.diameter
        return [(place + sign * half * turn[:, 0], turn * [sign, 1, 1], np.full(2, radius), True) for sign in (1, -1)]
    found, size = [], np.array(solid.solid.size)
    for axis, sign in itertools.product(range(3), (1, -1)):
        others = [(axis + 1) % 3, (axis + 2) % 3]
        found.append((place + 0.5 * sign * size[axis] * turn[:, axis], turn[:, [axis, *others]] * [sign, 1, 1], 0.5 * size[others], False))
    return found


def holds(solid: PlacedSolid, end: np.ndarray, outline: Outline, outward: np.ndarray) -> bool:
    """Whether a face of the solid, looking at the link, holds the whole end face of its outline."""
    y, z = (0.5 * outline.size[axis] * outline.frame.rotation[:, axis] for axis in (1, 2))
    ring = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    rim = [np.cos(a) * y + np.sin(a) * z for a in ring] if outline.is_cylinder else [y + z, y - z, z - y, -y - z]
    for middle, turn, half, is_round in faces(solid):
        arms = (end + np.array(rim) - middle) @ turn
        flush = np.allclose(turn[:, 0], -outward, atol=1e-9) and np.abs(arms[:, 0]).max() < FLUSH
        inside = np.hypot(arms[:, 1], arms[:, 2]) <= half[0] + FLUSH if is_round else np.all(np.abs(arms[:, 1:]) <= half + FLUSH, axis=1)
        if flush and inside.all():
            return True
    return False


def joined(one: PlacedSolid, other: PlacedSolid) -> bool:
    """Whether two solids of a body touch over faces that look at one another, by more than an edge."""
    for (here, turn, half, _), (there, face, size, _) in itertools.product(faces(one), faces(other)):
        arm = (there - here) @ turn
        reach = np.abs(face[:, 1:].T @ turn[:, 1:]).T @ size
        if turn[:, 0] @ face[:, 0] < -1.0 + 1e-9 and abs(arm[0]) < FLUSH and np.all(np.abs(arm[1:]) < half + reach - 1e-3):
            return True
    return False


def drawn_links(assembly: Assembly) -> dict[str, tuple[PlacedLink, Outline]]:
    found = {outline.name: outline for outline in outlines(assembly)}
    return {name: (link, found[name]) for name, link in assembly.links.items()}


@pytest.mark.parametrize("name", BUILDABLE)
def test_links_end_on_faces_of_the_bodies_they_join(name: str) -> None:
    assembly = expand(case(name))
    for link, outline in drawn_links(assembly).values():
        for sign, body in zip((-1.0, 1.0), link.joins, strict=True):
            outward = sign * link.frame.rotation[:, 0]
            end = link.frame.position + 0.5 * outline.size[0] * outward
            held = body == GROUND or any(holds(solid, end, outline, outward) for solid in assembly.bodies[body].solids.values())
            assert held, (link.name, body)


@pytest.mark.parametrize("name", BUILDABLE)
def test_bodies_are_one_piece(name: str) -> None:
    for body in expand(case(name)).bodies.values():
        solids = list(body.solids.values())
        reached = {0}
        while new := {b for a in reached for b in range(len(solids)) if b not in reached and joined(solids[a], solids[b])}:
            reached |= new
        assert len(reached) == len(solids), body.name


@pytest.mark.parametrize("name", BUILDABLE)
def test_nothing_else_meets(name: str) -> None:
    assembly = expand(case(name))
    links = drawn_links(assembly)
    ends = {link: set(placed.joins) - {GROUND} for link, (placed, _) in links.items()}
    owner = {solid: body.name for body in assembly.bodies.values() for solid in body.solids}
    for one, other in itertools.combinations(outlines(assembly), 2):
        mine, theirs = ({owner[each.name]} if each.name in owner else ends[each.name] for each in (one, other))
        if not mine & theirs:
            assert gap(one, other) >= CLEARANCE, (one.name, other.name)
        elif one.name in owner and other.name in owner:
            assert gap(one, other) > -FLUSH, (one.name, other.name)


def test_stacks_fit_the_bodies_they_pass() -> None:
    """The casings of 18 and 25 mm, wider than the ceramic that is drawn, pass the pole, the lever and the plate too."""
    assembly = expand(case("double-triangle"))
    casings = {True: 18e-3, False: 25e-3}
    for name, (link, outline) in drawn_links(assembly).items():
        if is_actuator(link.part):
            wide = casings[name[:2] in ("B1", "B2", "B3")]
            cased = Outline(name, outline.frame, np.array([outline.size[0], wide, wide]), is_cylinder=True)
            for body in assembly.bodies.values():
                for solid in outlines(Assembly({body.name: body}, {}, {}, {}, {}, {})):
                    assert body.name in link.joins or gap(cased, solid) >= AROUND_CASINGS - FLUSH, (name, solid.name)
