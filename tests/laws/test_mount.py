"""Laws of a stage on a stage: it is the one that is drawn in one piece."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

import flexstage as fs
from flexstage.analysis.linear_statics.deflection import deflection
from flexstage.analysis.linear_statics.drift import drift
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.addresses.address import addresses, assign, get, tag_of
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.mount import mount
from flexstage.mechanism.assembly.moving_mass import moving_inertia
from flexstage.mechanism.assembly.pattern import Normal, Pose
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.mechanism.store import dump, dumps, load, loads
from flexstage.mechanism.store.patch import patch
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped as drawn_lumped
from flexstage.parts.body import Block, Body, Cylinder, Inertia, Payload, Sphere
from flexstage.parts.material import Material
from flexstage.spatial.frame import Frame, axes, spatial_rotation
from tests.conftest import examples
from tests.laws.shared import lumped
from tests.laws.strategies import mechanisms, moved, turns
from tests.laws.test_structure import comparable, same


def pose_of(turn, shift):
    return Pose(tuple(shift.tolist()), tuple(turn[:, 0].tolist()), tuple(turn[:, 2].tolist()))


def by_hand(lower, upper, turn, shift):
    """Both drawn in one piece, what is of the upper one marked with a dash."""

    def far(name):
        return "carriage" if name == GROUND else name if name == PLATFORM else f"{name}-"

    def low(name):
        return "carriage" if name == PLATFORM else name

    there = moved(upper, turn, shift)
    links = {f"{name}-": replace(link, joins=tuple(map(far, link.joins)), part=f"{link.part}-") for name, link in there.links.items()}
    parts = {f"{name}-": replace(part, material="metal-") if hasattr(part, "material") else part for name, part in upper.parts.items()}
    return replace(
        lower,
        materials={**lower.materials, "metal-": upper.materials["metal"]},
        parts={**lower.parts, **parts},
        bodies={low(name): body for name, body in lower.bodies.items()} | {far(name): body for name, body in there.bodies.items()},
        links={**{name: replace(link, joins=tuple(map(low, link.joins))) for name, link in lower.links.items()}, **links},
        gauges={},
    )


@examples(7)
@given(mechanisms(), mechanisms(), turns())
def test_a_stage_on_a_stage_is_both_drawn_in_one_piece(lower, upper, where):
    both = mount(mount(Mechanism("both"), "z", lower, platform=False), "fine", upper, on="z/platform", pose=pose_of(*where))
    assert not check(both)
    assert loads(dumps(both)) == both
    called = [*(f"z/{name}" for name in lower.bodies), *(name if name == PLATFORM else f"fine/{name}" for name in upper.bodies)]
    drawn = ["carriage" if name == PLATFORM else name for name in lower.bodies]
    drawn += [name if name == PLATFORM else f"{name}-" for name in upper.bodies]
    assert same(comparable(lumped(both), called), comparable(lumped(by_hand(lower, upper, *where)), drawn))
    assert set(expand(both).gauges) == {f"z/{name}" for name in lower.gauges} | {f"fine/{name}" for name in upper.gauges}


def test_loads_of_a_carried_stage_turn_with_it():
    """Its forces and the inertia of what it carries: the platform moves, and weighs, as it does by itself, turned."""
    load = Payload(PLATFORM, 0.7, (0.01, 0.03, -0.02), Inertia(1e-4, 2e-4, 1.5e-4, xy=2e-5, xz=-1e-5, yz=3e-5))
    push = fs.Force(PLATFORM, (0.01, 0.02, 0.03), (1.0, -2.0, 3.0))
    alone = replace(parallelogram(), gravity=(0.0, 0.0, 0.0), payloads={"load": load}, forces={"push": push})
    turn, shift = np.array([[0.0, 0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, -0.6]]), np.array([0.1, 0.2, 0.3])
    both = mount(replace(Mechanism("bare"), gravity=(0.0, 0.0, 0.0)), "fine", alone, pose=pose_of(turn, shift))
    there, here = (deflection(each, drawn_lumped(each)).total for each in (both, alone))
    whole = spatial_rotation(turn)
    np.testing.assert_allclose(there, whole @ here, atol=1e-9 * np.max(np.abs(here)))
    heavy, drawn = (moving_inertia(each, expand(each).bodies[PLATFORM]) for each in (both, alone))
    np.testing.assert_allclose(heavy, whole @ drawn @ whole.T, atol=1e-12 * np.max(np.abs(drawn)))


def test_patterns_and_overrides_of_a_carried_stage_go_with_it():
    fine = replace(
        double_triangle(), overrides={"B2/front.thickness": 1.4e-3, "horizontal/back.at.y": 1e-4, "B3.shift.x": 1e-4, "S1.rotation.z": 0.01}
    )
    fine = replace(
        fine,
        placements={
            **fine.placements,
            "M1-M2": replace(fine.placements["B1-B3"], pattern=replace(fine.placements["B1-B3"].pattern, mirror=Normal.Y, height=0.1)),
        },
    )
    turn, shift = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([0.1, 0.2, 0.3])
    both = mount(Mechanism("bare"), "fine", fine, pose=pose_of(turn, shift))
    found, drawn = expand(both), expand(fine)
    assert list(found.actuators) == [f"fine/{name}" for name in drawn.actuators]
    for name, link in drawn.links.items():
        there = link.frame.within(Frame(turn, shift))
        now = found.links[f"fine/{name}"]
        np.testing.assert_allclose(now.frame.position, there.position, atol=1e-12)
        np.testing.assert_allclose(now.frame.rotation, there.rotation, atol=1e-12)
        assert getattr(now.part, "thickness", None) == getattr(link.part, "thickness", None)
    for name, gauge in drawn.gauges.items():
        there = gauge.sights[0].frame.within(Frame(turn, shift))
        np.testing.assert_allclose(found.gauges[f"fine/{name}"].sights[0].frame.rotation, there.rotation, atol=1e-12)
    assert not check(both)
    moves = ideal(mount(Mechanism("bare"), "fine", double_triangle()))
    np.testing.assert_allclose(moves.mapping.values, ideal(double_triangle()).mapping.values, atol=1e-12)


def test_addresses_and_tags_reach_into_a_carried_stage():
    both = mount(parallelogram(), "fine", double_triangle(), on=PLATFORM)
    assert get(assign(both, "fine/B1/front.thickness = 1.7 mm"), "fine/B1/front.thickness") == 1.7e-3
    assert get(assign(both, "fine/horizontal/front.at.x = 1 mm"), "units.fine/horizontal.links.front.at.x") == 1e-3
    assert get(assign(both, "fine/B2.shift.x = 5 um"), "fine/B2.shift.x") == 5e-6
    assert get(assign(both, "parts.fine/neck.thickness = 1.6 mm"), "fine/neck.thickness") == 1.6e-3
    assert all(get(both, address) is not None for address in addresses(both))
    tags = {key: tag_of(double_triangle(), key) for key in double_triangle().tags if key.startswith("parts.")}
    assert tags
    assert {key: tag_of(both, key.replace("parts.", "parts.fine/", 1)) for key in tags} == tags


UPPER = """
format = "flexstage 1"
name = "top"
[stages]
fine = { file = "fine.toml", on = "coarse/platform", pose = { at = ["0 mm", "0 mm", "50 mm"] } }  # the small one
coarse = { file = "coarse.toml" }
[parts.wire]
kind = "joint"
free = ["x"]  # any
[overrides]
"fine/left.thickness" = "0.7 mm"
"""


def written(folder, **texts):
    dump(parallelogram(), folder / "fine.toml")
    dump(parallelogram(), folder / "coarse.toml")
    (folder / "top.toml").write_text(UPPER)
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text)
    return folder / "top.toml"


def test_files_of_stages_are_put_together(tmp_path):
    top = load(written(tmp_path))
    assert [name for name in expand(top).bodies if "platform" in name] == ["coarse/platform", "platform"]
    assert expand(top).links["fine/left"].part.thickness == 0.7e-3
    assert loads(dumps(top)) == top
    text = patch(UPPER, {"fine/right.thickness": "0.6 mm", "fine/B/pzt.stiffness": "20 N/um"}, where=str(tmp_path / "top.toml"))
    assert "# the small one" in text
    assert "# any" in text
    changed = loads(text, folder=tmp_path)
    assert expand(changed).links["fine/right"].part.thickness == 0.6e-3


def test_a_value_of_another_file_is_changed_there(tmp_path):
    written(tmp_path)
    with pytest.raises(DesignError, match=r"parts\.fine/leaf\.thickness: it is in the file of a mounted stage"):
        patch(UPPER, {"parts.fine/leaf.thickness": "0.6 mm"}, where=str(tmp_path / "top.toml"))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"fine.toml"', '"fne.toml"', ":5: stages.fine.file: fne.toml: file not found"),
        ('"fine.toml"', '"top.toml"', ":5: stages.fine.file: the stage would contain itself"),
        ('"coarse/platform"', '"coarse/platfrm"', 'stages.fine.on: unknown body "coarse/platfrm". Use coarse/platform'),
        ("fine/left", "fine/lft", 'overrides."fine/lft.thickness"'),
        ("pose = {", 'pose = { mirror = "x",', "stages.fine.pose.mirror: a whole stage cannot be mirrored"),
        ('on = "coarse/platform", ', "", "no unique topmost stage (got fine, coarse)"),
    ],
)
def test_what_cannot_be_put_together_is_told(tmp_path, old, new, said):
    path = written(tmp_path)
    path.write_text(UPPER.replace(old, new))
    with pytest.raises(DesignError) as caught:
        load(path)
    assert said in str(caught.value)


def test_stages_that_carry_one_another_are_told(tmp_path):
    path = written(tmp_path)
    fine = (tmp_path / "fine.toml").read_text()
    (tmp_path / "fine.toml").write_text(f'{fine}\n[stages]\nagain = {{ file = "top.toml", on = "platform" }}\n')
    with pytest.raises(DesignError, match=r"circular reference between this file and .*top\.toml"):
        load(path)
    (tmp_path / "fine.toml").write_text(fine.replace("thickness", "thicknes", 1))
    with pytest.raises(DesignError, match=r":5: stages\.fine\.file: fine\.toml:\d+: parts\.leaf\.thicknes: unknown key"):
        load(path)


def test_outlines_of_every_kind_go_with_their_stage():
    solids = {
        "plate": Block("metal", (0.1, 0.05, 0.01), at=(0.01, 0.0, 0.0), up=(0.0, 0.1, 1.0)),
        "pin": Cylinder("metal", 0.01, 0.05, at=(0.0, 0.1, 0.0), along=(1.0, 0.0, 1.0)),
        "ball": Sphere("metal", 0.01, at=(0.0, 0.0, 0.1)),
    }
    fine = replace(parallelogram(), materials={**parallelogram().materials, "metal": next(iter(parallelogram().materials.values()))})
    fine = replace(fine, bodies={**fine.bodies, "seat": Body(solids=solids, of=PLATFORM)})
    turn, shift = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([0.1, 0.2, 0.3])
    found = expand(mount(Mechanism("bare"), "fine", fine, pose=pose_of(turn, shift))).bodies[PLATFORM]
    drawn = expand(fine).bodies[PLATFORM]
    centre = Frame(turn, shift).point(drawn.mass.centre)
    np.testing.assert_allclose(found.mass.centre, centre, atol=1e-12)
    np.testing.assert_allclose(found.mass.inertia, turn @ drawn.mass.inertia @ turn.T, atol=1e-15)


@pytest.mark.parametrize("name", ["z-stage", "voice-coil-stage", "double-triangle"])
def test_a_mounted_stage_drifts_as_it_does_by_itself(name):
    """Also where it is mounted twice: equal materials under two names are one."""
    own = fs.case(name)
    alone = drift(own, drawn_lumped(own)).motion
    once = mount(Mechanism("top", gravity=own.gravity, damping=own.damping), "s", own)
    twice = mount(once, "t", own, platform=False)
    for stage in (once, twice):
        found = drift(stage, drawn_lumped(stage)).motion
        rates = [found.at(row, "uniform") for row in alone.rows]
        np.testing.assert_allclose(rates, alone.values[:, 0], rtol=1e-9, atol=1e-15)


GROUNDS = """
format = "flexstage 1"
name = "two guides that carry one platform"
{0}
[stages]
s = {{ file = "s.toml" }}
t = {{ file = "t.toml", on = "{1}" }}
[bodies.platform]
mass = "1 kg"
[parts.weld]
kind = "joint"
[links]
one = {{ joins = ["s/platform", "platform"], part = "weld", at = ["0 mm", "0 mm", "0 mm"], along = "x", bends = "z" }}
two = {{ joins = ["t/platform", "platform"], part = "weld", at = ["0 mm", "0 mm", "0 mm"], along = "x", bends = "z" }}
"""


def test_grounds_of_mounted_stages_agree_or_are_stated(tmp_path):
    stage = parallelogram()
    dump(replace(stage, ground="steel", temperatures={"all": 2.0}), tmp_path / "s.toml")
    dump(replace(stage, ground="aluminium", temperatures={"ground": 3.0}), tmp_path / "t.toml")

    def read(ground="", on="ground"):
        return loads(GROUNDS.format(ground, on), folder=tmp_path)

    with pytest.raises(DesignError) as caught:
        read()
    assert 'different ground materials (got "t/aluminium" in the mounted stage, "s/steel" in this stage)' in str(caught.value)
    assert "different ground temperatures (got 3 K in the mounted stage, 2 K in this stage)" in str(caught.value)
    stated = read('ground = "s/steel"\ntemperatures.ground = "3 K"')
    assert stated.ground == "s/steel"
    bodies = {"s/platform": 2.0, "s/B/base": 2.0, "s/B/tip": 2.0}
    assert dict(stated.temperatures) == {"ground": 3.0, **bodies}
    there = read(on="s/platform")
    assert there.ground == "s/steel"
    assert dict(there.temperatures) == {"ground": 2.0, **bodies}


def test_a_crystal_turns_with_its_stage():
    silicon = Material(None, None, 2329.0, c11=165.7e9, c12=63.9e9, c44=79.6e9, crystal=((1.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    stage = parallelogram()
    stage = replace(stage, materials={**stage.materials, "aluminium": silicon})
    turn = axes((1.0, 2.0, 2.0), (2.0, -2.0, 1.0))
    there = mount(Mechanism("top"), "s", stage, pose=pose_of(turn, np.zeros(3)))
    for name, link in expand(stage).links.items():
        if link.material is not None:
            np.testing.assert_allclose(expand(there).links[f"s/{name}"].material.modulus, link.material.modulus, rtol=1e-12)
