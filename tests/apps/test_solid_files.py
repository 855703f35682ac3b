"""The command `cad`: files of solids, what keeps them from being written, and what is only warned of."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pygltflib
import pytest
from netgen import occ

from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.mechanism.store import dump, dumps, load
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.condensation import condense
from flexstage.parts.freedom import Freedom
from flexstage.parts.mass import mass_properties
from flexstage.parts.superelement import Superelement
from flexstage.solid.fea.geometry.imported import import_findings
from tests.apps.command import Command
from tests.roundtrip.test_gltf import leaf_stage


def apart_stage() -> Mechanism:
    """The stage of two leaves, its block 5 um away from them."""
    stage = leaf_stage()
    block = stage.bodies["platform"].solids["block"]
    return replace(
        stage, bodies={"platform": Body(solids={"block": replace(block, at=tuple(np.add(block.at, (5e-6, 0.0, 0.0)).tolist()))})}
    )


def test_all_three_files(flexstage: Command, tmp_path: Path) -> None:
    dump(leaf_stage(), tmp_path / "leaf.toml")
    names = ("-o", "a.step", "--mesh", "a.vtu", "--gltf", "a.glb")
    ended = flexstage("cad", "leaf.toml", *names, "--order", "1", "--modes", "2")
    assert ended.code == 0, ended.err
    assert all(f"Wrote {name}" in ended.err for name in names[1::2])
    assert len(occ.OCCGeometry(str(tmp_path / "a.step")).shape.solids) == 3
    assert len(meshio.read(tmp_path / "a.vtu").cells_dict["tetra10"]) > 100
    shown = pygltflib.GLTF2.load_binary(str(tmp_path / "a.glb"))
    assert shown is not None
    assert [animation.name.partition(":")[0] for animation in shown.animations] == ["mode 1", "mode 2"]
    assert all(animation.name.endswith(" Hz") for animation in shown.animations)
    assert not list(tmp_path.glob(".*.part"))


def test_what_does_not_meet_is_warned_of_in_step_and_refused_in_a_mesh(flexstage: Command, tmp_path: Path) -> None:
    dump(apart_stage(), tmp_path / "apart.toml")
    drawn = flexstage("cad", "apart.toml", "-o", "a.step")
    assert drawn.code == 0
    assert "warning: one: its end face is 5 um away from platform" in drawn.err
    for option, name in (("--mesh", "a.vtu"), ("--gltf", "a.glb")):
        ended = flexstage("cad", "apart.toml", option, name)
        assert ended.code == 2
        told = [f"error: {name}: its end face is 5 um away from platform. Move or lengthen" for name in ("one", "other")]
        assert [line.partition(" an outline")[0] for line in ended.err.splitlines()] == told
        assert not (tmp_path / name).exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("-o", "nowhere/a.step"), "folder nowhere not found"),
        (("-o", "stage.toml"), "also an input of this command"),
        (("-o", "."), "it is a folder"),
        (("-o", "a", "--gltf", "./a"), "the output of --output"),
        ((), "--output: missing. Use -o stage.step, --mesh stage.vtu or --gltf stage.glb."),
        (("--mesh", "a.vtu", "--order", "0"), "--order"),
    ],
)
def test_bad_outputs_are_found_before_anything_is_drawn(
    flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], said: str
) -> None:
    monkeypatch.setattr("flexstage.solid.commands.exchange.stage_findings", lambda *_: pytest.fail("drawn all the same"))
    before = (tmp_path / "stage.toml").read_bytes()
    ended = flexstage("cad", "stage.toml", *arguments)
    assert ended.code == 2
    assert said in ended.err
    assert (tmp_path / "stage.toml").read_bytes() == before


def test_a_part_without_shape_is_named(flexstage: Command, tmp_path: Path) -> None:
    stage = leaf_stage()
    dump(replace(stage, parts={"leaf": Joint((Freedom.X,))}), tmp_path / "joint.toml")
    ended = flexstage("cad", "joint.toml", "-o", "a.step")
    assert ended.code == 2
    assert "one: a part of kind joint has neither a shape" in ended.err


def test_a_solid_becomes_a_superelement_and_the_table_that_states_it(flexstage: Command, tmp_path: Path) -> None:
    """What is printed, put into a design file beside the matrices, is a stage that checks and has the part's mass."""
    dump(leaf_stage(), tmp_path / "leaf.toml")
    ended = flexstage("superelement", "leaf.toml", "platform", "-o", "whole.npz", "--order", "1", "--modes", "2")
    assert ended.code == 0, ended.err
    assert "Wrote whole.npz" in ended.err
    whole = load(tmp_path / "leaf.toml")
    link = Link({"one": "ground", "other": "platform"}, "platform", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    body = Body(mass=1.0, centre=(0.0, 0.0, 0.0), inertia=Inertia(1.0, 1.0, 1.0))
    text = dumps(replace(whole, parts={}, bodies={"platform": body}, links={"one": link}))
    (tmp_path / "again.toml").write_text(f"{text}\n{ended.out}")
    part = load(tmp_path / "again.toml").parts["platform"]
    assert isinstance(part, Superelement)
    volume = 0.01 * 0.02 * 0.02 + 2 * 0.02 * 0.001 * 0.01
    assert condense(part).mass == pytest.approx(7750.0 * volume, rel=1e-9)
    assert flexstage("superelement", "leaf.toml", "spoon", "-o", "a.npz").code == 2
    assert not (tmp_path / "a.npz").exists()


def test_step_to_stdout_is_nothing_but_step(flexstage: Command, tmp_path: Path) -> None:
    dump(leaf_stage(), tmp_path / "leaf.toml")
    ended = flexstage("cad", "leaf.toml", "-o", "-")
    assert ended.out.startswith("ISO-10303-21;")
    assert ended.out.rstrip().endswith("END-ISO-10303-21;")


def test_a_step_file_is_stated_so_that_the_design_holds_it(flexstage: Command, tmp_path: Path) -> None:
    occ.Cylinder(occ.Pnt(0, 0, 0), occ.Z, r=7.0, h=3.0).WriteStep(str(tmp_path / "disc.step"))
    ended = flexstage("import", "disc.step", "stage.toml", "--material", "steel", "--body", "disc")
    assert ended.code == 0, ended.err
    assert 'file = "disc.step"' in ended.out
    steel = '[materials.steel]\nyoung = "200 GPa"\npoisson = 0.3\ndensity = "7750 kg/m^3"\n'
    (tmp_path / "bodies.toml").write_text(f'format = "flexstage 1"\nname = "disc"\n{steel}{ended.out}')
    stage = load(tmp_path / "bodies.toml", checked=False)
    assert import_findings(stage) == ()
    mass = mass_properties(stage.bodies["disc"], stage.materials)
    assert mass is not None
    assert float(mass.mass) == pytest.approx(np.pi * 0.007**2 * 0.003 * 7750.0, rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("nowhere.step", "--material", "steel"), "file not found"),
        (("stage.toml", "--material", "steel"), "not a STEP file"),
        (("nowhere.step", "--material", "stele"), "steel"),
    ],
)
def test_bad_imports(flexstage: Command, arguments: tuple[str, ...], said: str) -> None:
    ended = flexstage("import", arguments[0], "stage.toml", *arguments[1:])
    assert ended.code == 2
    assert said in ended.err
    assert "Traceback" not in ended.err
