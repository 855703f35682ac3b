"""A stage written as STEP and read back: names, volumes and places of all solids, materials, and no entity left hanging."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from netgen import occ

from flexstage.base.finding import DesignError
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.body import Block, Body
from flexstage.parts.mass import mass_properties
from flexstage.parts.material import Material
from flexstage.solid.exchange.step import stage_parts, step
from flexstage.solid.fea.geometry.stage_pieces import stage_pieces
from flexstage.solid.fea.jobs.apart import step_apart


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("step") / "stage.step"
    path.write_bytes(step(case("double-triangle")))
    return path


def leaves(node: occ.OCCAssemblyNode) -> Iterator[occ.OCCAssemblyNode]:
    for child in node.children:
        if child.is_assembly:
            yield from leaves(child)
        else:
            yield child


def read(path: Path) -> dict[str, occ.TopoDS_Shape]:
    found = list(leaves(occ.OCCGeometry(str(path)).GetAssemblyTree()))
    names = [leaf.name for leaf in found]
    assert len(set(names)) == len(names)
    return {leaf.name: leaf.shape for leaf in found}


def place(shape: occ.TopoDS_Shape) -> np.ndarray:
    return np.array([shape.center.x, shape.center.y, shape.center.z]) / 1e3


def test_all_links_and_bodies_come_back_by_name_with_volume_and_place(written: Path) -> None:
    found, stage = read(written), stage_pieces(case("double-triangle"))
    assembly = stage.assembly
    assert set(found) == set(assembly.links) | set(assembly.bodies)
    assert len(assembly.links) == 27
    for part in stage_parts(stage):
        assert found[part.name].mass == pytest.approx(part.shape.mass, rel=1e-9)
        np.testing.assert_allclose(place(found[part.name]), place(part.shape), atol=1e-9)


def test_bodies_come_back_with_their_mass_and_centre(written: Path) -> None:
    """Against the integrals of the description, which know no CAD."""
    found, mechanism = read(written), case("double-triangle")
    density = mechanism.materials["steel"].density * 1e-9
    platform = stage_pieces(mechanism).assembly.bodies["platform"].mass
    assert platform is not None
    assert found["platform"].mass * density == pytest.approx(float(platform.mass), rel=1e-6)
    np.testing.assert_allclose(place(found["platform"]), platform.centre, atol=1e-7)


def test_links_stand_at_their_frames(written: Path) -> None:
    found, assembly = read(written), stage_pieces(case("double-triangle")).assembly
    for name, link in assembly.links.items():
        np.testing.assert_allclose(place(found[name]), link.frame.position, atol=1e-6, err_msg=name)


def test_every_entity_that_is_named_exists(written: Path) -> None:
    text = written.read_text("ascii")
    defined = re.findall(r"^#(\d+)=", text, re.MULTILINE)
    assert len(set(defined)) == len(defined)
    assert set(re.findall(r"#(\d+)", text.partition("DATA;")[2])) == set(defined)


def test_materials_and_colours_are_stated(written: Path) -> None:
    text = written.read_text("ascii")
    solids = text.count("MANIFOLD_SOLID_BREP(")
    assert solids == len(read(written))
    assert text.count("DESCRIPTIVE_REPRESENTATION_ITEM('steel','')") > 20
    assert text.count("'density measure',POSITIVE_RATIO_MEASURE(7.75") > 20
    assert text.count("STYLED_ITEM(") == solids


def bricks(**solids: Block) -> Mechanism:
    steel = Material(young=200e9, poisson=0.3, density=7750.0)
    return Mechanism("Träger 'A' #12;", materials={"steel": steel, "brass": steel}, bodies={"platform": Body(solids=solids)})


def test_a_body_of_two_materials_is_two_solids(tmp_path: Path) -> None:
    mechanism = bricks(low=Block("steel", (0.01, 0.01, 0.01)), high=Block("brass", (0.01, 0.01, 0.01), at=(0.0, 0.0, 0.01)))
    (tmp_path / "two.step").write_bytes(step(mechanism))
    found = read(tmp_path / "two.step")
    assert sorted(found) == ["platform/brass", "platform/steel"]
    assert place(found["platform/brass"])[2] == pytest.approx(0.01)


def test_the_fused_volume_is_that_of_the_mass(tmp_path: Path) -> None:
    mechanism = bricks(low=Block("steel", (0.03, 0.02, 0.01), hole=(0.005, 0.005)))
    (tmp_path / "one.step").write_bytes(step(mechanism))
    mass = mass_properties(mechanism.bodies["platform"], mechanism.materials)
    assert mass is not None
    assert read(tmp_path / "one.step")["platform"].mass * 7750e-9 == pytest.approx(float(mass.mass), rel=1e-9)


def test_a_stage_without_any_shape_is_refused() -> None:
    with pytest.raises(DesignError, match="no body has outlines"):
        step(replace(bricks(), bodies={"platform": Body(mass=1.0)}))


def test_a_process_of_its_own_draws_the_same() -> None:
    mechanism = bricks(low=Block("steel", (0.03, 0.02, 0.01)))
    assert step_apart(mechanism) == step(mechanism)
