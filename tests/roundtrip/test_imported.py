"""STEP files that stand for outlines: measured, stated, held to what is stated, found from the design file, and meshed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from netgen import occ

from flexstage.analysis.linear_statics.statics import statics
from flexstage.base.finding import DesignError
from flexstage.base.storage.digest import digest
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.mechanism.store import dump, dumps, load, loads
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped
from flexstage.parts.body import Block, Body, Imported, Inertia
from flexstage.parts.leaf import Leaf
from flexstage.parts.mass import mass_properties
from flexstage.parts.material import Material
from flexstage.solid.exchange.step import stage_parts, step
from flexstage.solid.fea.geometry.contact import contact_findings
from flexstage.solid.fea.geometry.imported import import_findings, imported_shape, measure, with_properties
from flexstage.solid.fea.geometry.stage_pieces import stage_pieces
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import model as solid

STEEL = Material(young=200e9, poisson=0.3, density=7750.0)
BLOCK = Block("steel", (0.02, 0.03, 0.01), at=(0.02, 0.0, 0.0))


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """A block of 20 x 30 x 10 mm, its corner at the file's origin, turned there."""
    path = tmp_path / "parts" / "block.step"
    path.parent.mkdir()
    occ.Box(occ.Pnt(0, 0, 0), occ.Pnt(10, 20, 30)).WriteStep(str(path))
    return path


def imported(path: Path) -> Imported:
    """The file's block where BLOCK is: the file's x along z, its y along x, its z along y."""
    solid = with_properties(measure(path), str(path), "steel", STEEL.density)
    return replace(solid, at=(0.01, -0.015, -0.005), along=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0))


def stage(solid: Block | Imported) -> Mechanism:
    return Mechanism(
        "imported",
        materials={"steel": STEEL},
        parts={"leaf": Leaf("steel", 0.02, 0.001, 0.01)},
        bodies={"platform": Body(solids={"block": solid})},
        links={"leaf": Link(("ground", "platform"), "leaf", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))},
    )


def test_an_imported_block_is_the_drawn_one(part: Path) -> None:
    ours, drawn = stage(imported(part)), stage(BLOCK)
    one, other = (mass_properties(each.bodies["platform"], each.materials) for each in (ours, drawn))
    assert one is not None
    assert other is not None
    assert float(one.mass) == pytest.approx(float(other.mass), rel=1e-9)
    np.testing.assert_allclose(one.centre, other.centre, atol=1e-12)
    np.testing.assert_allclose(one.inertia, other.inertia, rtol=1e-9, atol=1e-15)
    shapes = [next(item for item in stage_parts(stage_pieces(each)) if item.name == "platform").shape for each in (ours, drawn)]
    assert (shapes[0] * shapes[1]).mass == pytest.approx(shapes[1].mass, rel=1e-6)
    assert contact_findings(ours) == ()


def test_a_solid_of_an_assembly_is_chosen_by_its_name_or_place(tmp_path: Path) -> None:
    solids = {"plate": Block("steel", (0.04, 0.04, 0.005)), "post": Block("steel", (0.01, 0.01, 0.02), at=(0.0, 0.0, 0.0125))}
    apart = replace(stage(BLOCK), links={}, bodies={name: Body(solids={"s": solid}) for name, solid in solids.items()})
    path = tmp_path / "assembly.step"
    path.write_bytes(step(apart))
    for number, name in enumerate(solids, start=1):
        for called in (name, f"#{number}"):
            found = measure(path, called)
            np.testing.assert_allclose(found.size, solids[name].size, rtol=1e-9)
            assert found.volume == pytest.approx(float(np.prod(solids[name].size)), rel=1e-9)
    refusals = {None: "2 solids: plate, post", "plat": 'have the name "plat"', "#3": "0 of its solids", "#0": "0 of its solids"}
    for called, words in refusals.items():
        with pytest.raises(DesignError) as refused:
            measure(path, called)
        assert words in refused.value.findings[0].what
    chosen = with_properties(measure(path, "post"), str(path), "steel", STEEL.density, "post")
    ours = replace(stage(BLOCK), bodies={"platform": Body(solids={"post": chosen})})
    assert loads(dumps(ours)) == ours
    assert import_findings(ours) == ()


def test_a_reflected_solid_is_the_image_of_the_files(tmp_path: Path) -> None:
    """A wedge beside the plane: its image has its volume, stands on the other side, held to the file as well."""
    wedge = occ.Box(occ.Pnt(0, 2, 0), occ.Pnt(4, 8, 3)) - occ.Box(occ.Pnt(1, 4, -1), occ.Pnt(5, 9, 4))
    path = tmp_path / "wedge.step"
    wedge.WriteStep(str(path))
    own = imported(path)
    shown, image = imported_shape(own), imported_shape(own.mirrored)
    assert image.mass == pytest.approx(shown.mass)
    np.testing.assert_allclose(
        [image.center.x, -image.center.y, image.center.z], [shown.center.x, shown.center.y, shown.center.z], atol=1e-6
    )
    assert import_findings(stage(own.mirrored)) == ()
    assert loads(dumps(stage(own.mirrored))) == stage(own.mirrored)


def test_rigid_readings_need_no_file(part: Path) -> None:
    ours = stage(imported(part))
    part.unlink()
    np.testing.assert_allclose(lumped(ours).inertia_matrix, lumped(stage(BLOCK)).inertia_matrix, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"mass": 0.05}, "mass"),
        ({"centre": (0.0, 0.0, 0.0)}, "centre"),
        ({"middle": (0.005, 0.01, 0.0151)}, "middle"),
        ({"size": (0.01, 0.02, 0.0301)}, "size"),
        ({"inertia": Inertia(5e-6, 4e-6, 2e-6)}, "inertia"),
        ({"sha256": "0" * 64}, "sha256"),
        ({"file": "nowhere.step"}, "file"),
    ],
)
def test_what_is_stated_is_held_to_the_file(part: Path, change: dict[str, object], where: str) -> None:
    (finding,) = contact_findings(stage(replace(imported(part), **change)))
    assert finding.where == f"bodies.platform.solids.block.{where}"


def test_small_differences_pass(part: Path) -> None:
    solid = imported(part)
    assert import_findings(stage(replace(solid, mass=1.0009 * float(solid.mass)))) == ()
    assert import_findings(stage(replace(solid, mass=1.0011 * float(solid.mass)))) != ()


def test_the_design_file_names_it_relative_to_itself(part: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ours = stage(imported(part))
    path = dump(ours, tmp_path / "stage.toml")
    assert 'file = "parts/block.step"' in path.read_text()
    monkeypatch.chdir("/")
    assert load(path) == ours
    assert contact_findings(load(path)) == ()
    assert loads(path.read_text()) != ours  # a text knows no folder


def test_the_content_counts_and_the_path_does_not(part: Path) -> None:
    solid = imported(part)
    assert digest(solid, physics=True) == digest(replace(solid, file="elsewhere.step"), physics=True)
    assert digest(solid, physics=True) != digest(replace(solid, sha256="0" * 64), physics=True)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.step", b"no step", "not a STEP file"),
        ("a.step", b"ISO-10303-21;\nHEADER;\nbroken", "cannot read it"),
        ("a.txt", b"ISO-10303-21;\n", 'ends in ".txt"'),
    ],
)
def test_files_that_are_none(tmp_path: Path, name: str, content: bytes, said: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(DesignError, match=said):
        measure(tmp_path / name)


def test_two_solids_are_too_many(tmp_path: Path) -> None:
    path = tmp_path / "two.step"
    boxes = [occ.Box(occ.Pnt(x, 0, 0), occ.Pnt(x + 1, 1, 1)) for x in (0, 5)]
    occ.Compound(boxes).WriteStep(str(path))
    with pytest.raises(DesignError, match=r'it contains 2 solids: #1, #2\. Select one: solid = "#1"'):
        measure(path)


def test_a_solid_read_from_the_file_is_as_stiff_and_heavy_as_the_drawn_one(part: Path) -> None:
    reduction = Reduction(Fineness(neck=4.0, block=1.0, grading=0.6, order=3), modes=2)  # the meshes differ: fine enough to agree
    ours, drawn = (solid(stage(each), reduction, cache=None) for each in (imported(part), BLOCK))
    np.testing.assert_allclose(eigen(ours).values[:6], eigen(drawn).values[:6], rtol=1e-2)
    loads = [statics(each).compliance.values for each in (ours, drawn)]
    np.testing.assert_allclose(np.diag(loads[0]), np.diag(loads[1]), rtol=1e-2)
