"""Surfaces and modes as GLB, of solids and of theory, read back: sizes, bounds, targets and animations hold what the standard asks."""

from __future__ import annotations

import struct

import numpy as np
import pygltflib as gl
import pytest

from flexstage.analysis.dynamics.modes import Modes, modes
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.models.lumped import lumped
from flexstage.parts.body import Block, Body
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.solid.exchange.gltf import Motion, Surface, gltf, surfaces
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import SolidRead, read_solid, solids
from flexstage.solid.show.moving import to_glb

KINDS = {"SCALAR": 1, "VEC3": 3}
TYPES = {gl.FLOAT: np.float32, gl.UNSIGNED_INT: np.uint32}


def leaf_stage() -> Mechanism:
    """A block on two leaves that stand on the ground."""
    leaf = Link(("ground", "platform"), "leaf", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))
    other = Link(("ground", "platform"), "leaf", (0.0, 0.008, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))
    return Mechanism(
        "two leaves",
        materials={"steel": Material(young=200e9, poisson=0.3, density=7750.0)},
        parts={"leaf": Leaf("steel", 0.02, 0.001, 0.01)},
        bodies={"platform": Body(solids={"block": Block("steel", (0.01, 0.02, 0.02), at=(0.015, 0.004, 0.0))})},
        links={"one": leaf, "other": other},
    )


@pytest.fixture(scope="module")
def read() -> SolidRead:
    return read_solid(leaf_stage(), Reduction(Fineness(neck=4.0, block=1.0, order=2), modes=4), solids(Ways(cache=None)))


@pytest.fixture(scope="module")
def found(read: SolidRead) -> Modes:
    return modes(read.model)


@pytest.fixture(scope="module")
def motions(found: Modes) -> list[Motion]:
    return [Motion(f"mode {number + 1}: {found.frequencies[number]:.1f} Hz", found.shapes[:, number]) for number in range(3)]


@pytest.fixture(scope="module")
def shown(read: SolidRead, motions: list[Motion]) -> dict[str, Surface]:
    return dict(surfaces(read.placed, motions))


@pytest.fixture(scope="module")
def content(shown: dict[str, Surface], motions: list[Motion]) -> bytes:
    return gltf("two leaves", shown, motions)


@pytest.fixture(scope="module")
def document(content: bytes) -> gl.GLTF2:
    document = gl.GLTF2.load_from_bytes(content)
    assert document is not None
    return document


def values(document: gl.GLTF2, accessor: int) -> np.ndarray:
    described = document.accessors[accessor]
    view = document.bufferViews[described.bufferView]
    data = document.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    array = np.frombuffer(data, TYPES[described.componentType]).reshape(-1, KINDS[described.type])
    assert len(array) == described.count
    return array


def test_the_container_is_a_glb(content: bytes) -> None:
    magic, version, length, chunk, kind = struct.unpack("<4sIII4s", content[:20])
    assert (magic, version, length, kind) == (b"glTF", 2, len(content), b"JSON")
    binary, kind = struct.unpack("<I4s", content[20 + chunk : 28 + chunk])
    assert kind == b"BIN\x00"
    assert chunk % 4 == binary % 4 == 0
    assert 28 + chunk + binary == length


def test_the_description_has_neither_nulls_nor_empty_lists(content: bytes) -> None:
    (length,) = struct.unpack("<I", content[12:16])
    text = content[20 : 20 + length].decode()
    assert "null" not in text
    assert "[]" not in text.replace(" ", "")


def test_accessors_state_the_bounds_of_what_they_hold(document: gl.GLTF2) -> None:
    for number, described in enumerate(document.accessors):
        held = values(document, number)
        np.testing.assert_array_equal(np.array(described.min, held.dtype), held.min(axis=0))
        np.testing.assert_array_equal(np.array(described.max, held.dtype), held.max(axis=0))
        assert document.bufferViews[described.bufferView].byteOffset % 4 == 0
    ends = [view.byteOffset + view.byteLength for view in document.bufferViews]
    assert max(ends) == document.buffers[0].byteLength <= len(document.binary_blob())


def test_every_body_and_link_is_a_node_with_one_target_a_motion(document: gl.GLTF2, motions: list[Motion]) -> None:
    root = document.nodes[document.scenes[0].nodes[0]]
    members = [document.nodes[number] for number in root.children]
    assert sorted(node.name for node in members) == ["one", "other", "platform"]
    for node in members:
        mesh = document.meshes[node.mesh]
        (primitive,) = mesh.primitives
        places = values(document, primitive.attributes.POSITION)
        corners = values(document, primitive.indices)
        assert corners.max() == len(places) - 1
        assert len(corners) % 3 == 0
        assert len(primitive.targets) == len(mesh.weights) == len(motions)
        assert mesh.extras["targetNames"] == [motion.name for motion in motions]
        for target in primitive.targets:
            assert document.accessors[target["POSITION"]].count == len(places)


def test_animations_are_sines_of_one_target_each(document: gl.GLTF2, motions: list[Motion]) -> None:
    assert [animation.name for animation in document.animations] == [motion.name for motion in motions]
    for number, animation in enumerate(document.animations):
        assert sorted(channel.target.node for channel in animation.channels) == [0, 1, 2]
        assert {channel.target.path for channel in animation.channels} == {"weights"}
        (sampler,) = animation.samplers
        times = values(document, sampler.input)[:, 0]
        weights = values(document, sampler.output).reshape(len(times), len(motions))
        assert np.all(np.diff(times) > 0.0)
        np.testing.assert_allclose(weights[:, number], np.sin(2.0 * np.pi * times), atol=1e-6)
        assert not weights[:, [other for other in range(len(motions)) if other != number]].any()


def test_surfaces_are_closed_around_the_stage_and_of_its_volume(shown: dict[str, Surface]) -> None:
    volume = 0.0
    for each in shown.values():
        a, b, c = (each.vertices[each.triangles[:, corner]] for corner in range(3))
        volume += np.einsum("ti,ti->", a, np.cross(b, c)) / 6.0
    assert abs(volume) == pytest.approx(2 * 0.02 * 0.001 * 0.01 + 0.01 * 0.02 * 0.02, rel=1e-6)


def test_shifts_are_those_of_the_mode(shown: dict[str, Surface], found: Modes) -> None:
    """The lowest mode moves the block as a whole, along the platform's twist."""
    twist, mean = found.platform_shapes[:3, 0], shown["platform"].shifts[0].mean(axis=0)
    assert mean @ twist / np.linalg.norm(mean) / np.linalg.norm(twist) > 0.98


def test_largest_shift_is_a_twentieth_of_the_diagonal(shown: dict[str, Surface]) -> None:
    diagonal = np.linalg.norm(np.ptp(np.vstack([each.vertices for each in shown.values()]), axis=0))
    for number in range(3):
        largest = max(np.linalg.norm(each.shifts[number], axis=1).max() for each in shown.values())
        assert largest == pytest.approx(0.05 * diagonal)


def test_without_motions_there_is_a_still_surface(shown: dict[str, Surface]) -> None:
    still = {name: Surface(each.vertices, each.triangles, each.shifts[:0], each.is_body) for name, each in shown.items()}
    document = gl.GLTF2.load_from_bytes(gltf("still", still, []))
    assert document is not None
    assert not document.animations
    assert all(not primitive.targets for mesh in document.meshes for primitive in mesh.primitives)


def test_a_stage_of_rigid_bodies_and_bending_links_moves_by_the_lumped_model_without_finite_elements() -> None:
    stage = case("parallelogram")
    document = gl.GLTF2.load_from_bytes(to_glb(stage, modes=2))
    assert document is not None
    members = {node.name: document.meshes[node.mesh] for node in document.nodes if node.mesh is not None}
    assembly = expand(stage)
    assert set(members) == {"ground", *assembly.bodies, *assembly.links, *assembly.gauges}
    assert [each.name for each in document.animations] == members["platform"].extras["targetNames"]
    assert [each.name[:7] for each in document.animations] == ["mode 1 ", "mode 2 "]
    found = modes(lumped(stage))
    reference = np.asarray(assembly.bodies["platform"].reference)
    (primitive,) = members["platform"].primitives
    places = values(document, primitive.attributes.POSITION)
    for number, target in enumerate(primitive.targets):
        twist = found.platform_shapes[:, number]
        shift = twist[:3] + np.cross(twist[3:], places - reference)
        drawn = values(document, target["POSITION"])
        scale = np.sum(drawn * shift) / np.sum(shift**2)
        np.testing.assert_allclose(drawn, scale * shift, rtol=0.0, atol=1e-6 * np.abs(drawn).max())  # 32 bits
    largest = max(np.linalg.norm(values(document, each.primitives[0].targets[0]["POSITION"]), axis=1).max() for each in members.values())
    everything = np.vstack([values(document, each.primitives[0].attributes.POSITION) for each in members.values()])
    assert largest == pytest.approx(0.05 * np.linalg.norm(np.ptp(everything, axis=0)), rel=1e-6)
