"""Bad input: each class of mistake is a message with the object, the numbers compared and the remedy; never a traceback, never a hang."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.control.hysteresis.stack import load_hysteresis
from flexstage.control.study.file import load_setup
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar, Pose
from flexstage.mechanism.checks import check, require_valid
from flexstage.mechanism.mechanism import Link, Mechanism, Placement
from flexstage.mechanism.store import load, loads
from flexstage.mechanism.store.file import LARGEST, read_text
from flexstage.parts.body import Block, Body, Cylinder, Inertia, Payload
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Filleted, Straight
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod
from flexstage.studies.sweeps.file import load_study
from tests.roundtrip.designs import TEXT


def told(text: str) -> list[str]:
    """What is said about a text, in order."""
    with pytest.raises(DesignError) as caught:
        loads(text, where="stage.toml")
    lines = [str(finding) for finding in caught.value.findings]
    assert all(line.startswith("stage.toml:") for line in lines)
    assert all(finding.advice for finding in caught.value.findings)
    return lines


def test_the_small_stage_is_sound() -> None:
    assert check(loads(TEXT)) == ()


def test_an_unknown_entry_of_the_catalogue_is_all_that_is_told() -> None:
    """What it would have brought along is not missed besides; what stands beside it is read all the same."""
    assert len(told(TEXT.replace('"SUS420"', '"SUS430"'))) == 1
    lines = told(TEXT.replace('like = "SUS420"', 'like = "SUS430"\nyoung = "200 N"'))
    keys = [line.split(": ")[:2] for line in lines]
    assert keys == [["stage.toml:9", "materials.steel.like"], ["stage.toml:10", "materials.steel.young"]]


def polygon(*corners: str) -> str:
    """An extrusion of these corners [mm]."""
    outline = ", ".join('["{} mm", "{} mm"]'.format(*corner.split()) for corner in corners)
    return f'solids.s = {{ shape = "extrusion", material = "steel", height = "1 mm", outline = [{outline}] }}'


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        # keys and names
        ("diameter =", "diametre =", ["parts.wire.diametre", "unknown key", "diameter"]),
        ("diameter =", "diametre =", ["parts.wire", "diameter missing", '"2 mm"']),
        ("[parts.wire]", "[part.wire]", ["part:", "unknown key", "parts"]),
        ('kind = "rod"', 'kind = "rodd"', ["parts.wire.kind", '"rodd"', "rod"]),
        ('kind = "rod"', 'kind = "wire"', ["parts.wire.kind", '"wire"', "Use rod"]),
        ('kind = "rod"', 'kind = "Leaf-Spring"', ["parts.wire.kind", "Use leaf"]),
        ('kind = "rod"', 'kind = "flexure"', ["parts.wire.kind", "Use leaf"]),
        ('kind = "rod"', 'kind = "circular"', ["parts.wire.kind", "notch", "profile"]),
        ('kind = "rod"', 'kind = "cross"', ["parts.wire.kind", "Use cross_hinge"]),
        ('kind = "rod"', 'kind = "vcm"', ["parts.wire.kind", "Use voice_coil"]),
        ('kind = "rod"', 'kind = "PZT stack"', ["parts.wire.kind", "PZT stack", "neck"]),
        ('like = "SUS420" ', 'like = "SUS420"\nE = "200 GPa" ', ["materials.steel.E", "Use young"]),
        ('like = "SUS420" ', 'like = "SUS420"\nrho = "7800 kg/m^3" ', ["materials.steel.rho", "Use density"]),
        ('diameter = "1 mm"', 'd = "1 mm"', ["parts.wire.d:", "Use diameter"]),
        ('length = "30 mm" ', 'L = "30 mm" ', ["parts.wire.L:", "Use length"]),
        ('kind = "rod"\n', "", ["parts.wire", "kind missing", "notch"]),
        ('like = "SUS420"', 'like = "SUS430"', ["materials.steel.like", '"SUS430"', "SUS420"]),
        ('part = "wire"', 'part = "wier"', ["units.leg.links.front.part", '"wier"', "wire"]),
        ('"platform"]', '"plattform"]', ["units.leg.links.front.joins", '"plattform"', "platform"]),
        ('"ground", "platform"', '"platform", "platform"', ["joins", 'both ends join "platform"']),
        ('material = "steel"', 'material = "steal"', ["parts.wire.material", '"steal"', "steel"]),
        ('unit = "leg"', 'unit = "legs"', ["placements.L1-L3.unit", '"legs"', "leg"]),
        ("L1-L3 =", "L3-L1 =", ["placements.L3-L1", "3", "1", "ascending"]),
        ("L1-L3 =", "L1-L9000 =", ["placements.L1-L9000", "got 9000", "360"]),
        ("L1-L3 =", "L1-L99999999999999999999 =", ["placements.L1-L9999", "too many digits"]),
        ("L1-L3 =", '"L 1" =', ["placements", '"L 1"', "invalid name"]),
        ('name = "wire"', "", ["name missing", 'name = "a name"']),
        ("[bodies.platform]", "[bodies.plate]", ["bodies", 'unknown body "platform"']),
        # units and numbers
        ('"30 mm"', "30", ["parts.wire.length", "unit missing (got 30)", '"2 mm"']),
        ('"30 mm"', '"30"', ["parts.wire.length", 'unit missing (got "30")', '"2 mm"']),
        ('"30 mm"', '"30 kg"', ["parts.wire.length", "a mass", "a length"]),
        ('"30 mm"', '"30 mmm"', ["parts.wire.length", '"mmm"']),
        ('"30 mm"', "true", ["parts.wire.length", "got true", "a length"]),
        ('"30 mm"', '["30 mm"]', ["parts.wire.length", "1 values in brackets", "a length"]),
        ('"30 mm"', "2026-11-20", ["parts.wire.length", "2026-11-20", "a length"]),
        ('"30 mm"', "nan", ["parts.wire.length", "nan", "unit missing"]),
        ('"30 mm"', '"nan mm"', ["parts.wire.length", "finite"]),
        ('"30 mm"', '"-30 mm"', ["parts.wire.length", "-30 mm", "greater than 0 mm"]),
        ('"30 mm"', '"0 mm"', ["parts.wire.length", "0 mm", "greater than 0 mm"]),
        ('"30 mm"', "0x" + "f" * 300, ["parts.wire.length", "more than 64 bits"]),
        ('"30 mm"', '"1e300 mm"', ["parts.wire.length", "1e300 mm", "implausible size", "exponent"]),
        ('"30 mm"', '"1e-300 mm"', ["parts.wire.length", "1e-300 mm", "implausible size", "exponent"]),
        ('along = "z"', "along = [0, 0, 1e-200]", ["along", "of length 1e-200"]),
        ('along = "z"', "along = [0, 0, 1e200]", ["along", "of length 1e+200"]),
        ('"0 deg"', '"1"', ["placements.L1-L3.polar.first", "unit missing", "deg"]),
        ('"0 deg"', '"0 mm"', ["placements.L1-L3.polar.first", "a length", "an angle"]),
        ('facing = "tangent"', 'facing = "tangential"', ["polar.facing", '"tangential"', "Use tangent"]),
        ('along = "z"', 'along = "up"', ["along", '"up"', "-z"]),
        ('along = "z"', "along = [0, 0, 0]", ["units.leg.links.front.along", "zero"]),
        ('along = "z"', "along = [0, 0, nan]", ["along", "finite"]),
        ('along = "z"', "along = [0, 0]", ["along", "2 values", "three numbers"]),
        ('along = "z"', 'along = "z", bends = [1, 0, 1]', ["bends", "45 deg", "90 deg"]),
        ('along = "z"', 'along = "z", free = ["x", "q"]', ["free", '"q"', "rx"]),
        ('["1 mm", "0 mm", "0 mm"]', '["1 mm", "0 mm"]', ["front.at", "2 values", "3 values"]),
        ('["1 mm", "0 mm", "0 mm"]', '["1 mm", "0 mm", 1]', ["front.at.z", "unit missing (got 1)"]),
        # provenance
        ('"stated paper 2"', '"published"', ['tags."parts.wire.length"', '"published"', "stated, derived or assumed"]),
        ('"stated paper 2"', '"stated papre 2"', ['tags."parts.wire.length"', '"papre"', "paper"]),
        ("tags = { length =", "tags = { lenght =", ['tags."parts.wire.lenght"', "unknown address", "length"]),
        ("tags = { length =", "tags = { length = 1, x =", ["parts.wire.tags", "a tag must be a string"]),
        # the file
        ('format = "flexstage 1"', 'format = "flexstage 9"', ["format", '"flexstage 9"', '"flexstage 1"']),
        ('format = "flexstage 1"', "", ["format", "missing", '"flexstage 1"']),
        ('name = "wire"', 'name = "wire', ["stage.toml:3:", "not TOML"]),
        ('mass = "1 kg"', 'mass = "1 kg"\nmass = "2 kg"', ["stage.toml:20:", "duplicate name"]),
        ("[bodies.platform]", "[parts.wire]\n[bodies.platform]", ["stage.toml:18:", "duplicate name"]),
        ("[placements]", "x = " + "[" * 2000 + "]" * 2000 + "\n[placements]", ["characters", "4000"]),
        ("[placements]", "x = " + "[" * 1500 + "]" * 1500 + "\n[placements]", ["nested too deeply"]),
        ("[placements]", "x = " + "9" * 3990 + "\n[placements]", ["links.x", "more than 64 bits"]),
        ("[placements]", "[links]\na.b.c.d = 1\n[placements]", ["links.a", "unknown key"]),
        # outlines
        ('mass = "1 kg"', polygon("0 0", "1 1"), ["bodies.platform.solids.s.outline", "got 2", "3 or more"]),
        ('mass = "1 kg"', polygon("0 0", "1 1", "1 0", "0 1"), ["bodies.platform.solids.s.outline", "corners 1 and 3", "intersect"]),
        ('mass = "1 kg"', polygon("0 0", "2 0", "0 0", "0 1"), ["bodies.platform.solids.s.outline", "intersect"]),
        ('mass = "1 kg"', polygon("0 0", "2 0", "1 0"), ["bodies.platform.solids.s.outline", "collinear"]),
    ],
)
def test_each_mistake_is_told_with_its_object_and_remedy(old: str, new: str, words: list[str]) -> None:
    assert old in TEXT
    lines = told(TEXT.replace(old, new))
    assert any(all(word in line for word in words) for line in lines), lines


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('"L2/front.diametre" = "1 mm"', ['"diametre"', "diameter"]),
        ('"L4/front.diameter" = "1 mm"', ['"L4"', "L1"]),
        ('"leg/front.diameter" = "1 kg"', ["a mass", "a length"]),
        ('"leg/front.diameter" = "-1 mm"', ["-1 mm", "greater than 0"]),
        ('"leg/front.part" = "wire"', ["cannot be overridden"]),
        ('"parts.wire.length" = "1 mm"', ["not an override of a link"]),
        ('"leg/front.at" = ["1 mm", "2 mm"]', ["2 values", "3 values"]),
        ('"leg/front.at" = ["1 mm", "2 mm", "3 mm"]\n"leg/front.at.x" = "1 mm"', ["overrides the same value"]),
        ('tags = "stated"', ["not an address"]),
    ],
)
def test_overrides_are_checked_like_the_rest(text: str, words: list[str]) -> None:
    lines = told(f"{TEXT}\n[overrides]\n{text}\n")
    assert any(re.match(r"stage\.toml:2[6-9]: overrides", line) and all(word in line for word in words) for line in lines), lines


def test_everything_wrong_is_told_at_once() -> None:
    text = TEXT.replace('"30 mm"', "30").replace('"1 mm"\n', '"1 kg"\n').replace('"0 deg"', '"1"').replace("mass =", "mas =")
    where = [tuple(line.split(": ")[:2]) for line in told(text)]
    numbers = {"parts.wire.length": 14, "parts.wire.diameter": 15, "bodies.platform.mas": 19, "placements.L1-L3.polar.first": 25}
    assert where == [(f"stage.toml:{number}", address) for address, number in numbers.items()]


def test_wrong_values_do_not_hide_unknown_names() -> None:
    lines = told(TEXT.replace('"30 mm"', "30").replace('part = "wire"', 'part = "wirr"').replace('"steel"', '"stel"'))
    assert ["unit missing" in lines[0], *sorted(line.split("unknown ")[1].split(" ")[0] for line in lines[1:])] == [
        True,
        "material",
        "part",
    ]


def test_zero_needs_no_unit_and_keys_with_dots_no_quotes() -> None:
    plain = TEXT + '[requirements]\n"stroke.x" = "at least 0 um"\n'
    short = TEXT.replace('"0 mm"', "0").replace('"0 deg"', '"0"') + '[requirements]\nstroke.x = "at least 0"\n'
    assert loads(short).placements == loads(plain).placements
    assert list(loads(short).requirements) == ["stroke.x"]


@pytest.mark.parametrize("name", ["T", "H", "m", "bar"])
def test_a_number_may_have_the_name_of_a_unit(name: str) -> None:
    text = TEXT.replace('"30 mm"', f'"2*{name}"').replace("[materials.steel]", f'[numbers]\n{name} = "15 mm"\n\n[materials.steel]')
    assert loads(text).parts["wire"].length == 0.03


CATALOGUE = """
[sources]
lot = "tensile test"
[materials.ours]
young = "71.2 GPa"
poisson = 0.33
density = "2810 kg/m^3"
tags = { young = "stated lot" }
[coils.small]
force_constant = "12 N/A"
"""


def test_entries_of_a_catalogue_of_ones_own(tmp_path: Path) -> None:
    head = 'format = "flexstage 1"\nname = "a"\ncatalogue = "lab.toml"\n'
    design = head + 'materials.al.like = "ours"\nmaterials.steel.like = "17-4PH"\nparts.coil.like = "small"\n'
    (tmp_path / "lab.toml").write_text(CATALOGUE)
    stage = loads(design, checked=False, folder=tmp_path)
    assert stage.materials["al"].young == 71.2e9
    assert stage.parts["coil"].kind == "voice_coil"
    assert stage.sources["lot"] == "tensile test"
    for name, text, words in (
        ("no.toml", CATALOGUE, "file not found"),
        ("lab.toml", CATALOGUE + "[coil]", "catalogue: lab.toml: coil: unknown section. Use coils."),
        ("lab.toml", CATALOGUE + "[gauges]\ng = 1", "gauges: unknown section"),
        ("lab.toml", CATALOGUE.replace("ours", "theirs"), 'the catalogue has no "ours"'),
        ("lab.toml", CATALOGUE.replace("71.2 GPa", "71.2 N"), "materials.al.young"),
    ):
        (tmp_path / "lab.toml").write_text(text)
        with pytest.raises(DesignError, match=re.escape(words)):
            loads(design.replace("lab.toml", name), checked=False, folder=tmp_path)


def test_a_flood_of_mistakes_is_cut_short() -> None:
    lines = told(TEXT + "".join(f"unknown{number} = 1\n" for number in range(10_000)))
    assert len(lines) < 200
    assert "correct these first" in lines[-1].lower()


# --------------------------------------------------------------------------------------------------------------------------------- files


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match="file not found"):
        load(tmp_path / "stage.toml")


def test_a_directory(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match="not a file but a folder"):
        load(tmp_path)


@pytest.mark.parametrize("read", [load, load_study, load_setup, load_hysteresis])
def test_pipes_and_devices_are_refused_unopened(tmp_path: Path, read: Callable[[Path], object]) -> None:
    os.mkfifo(tmp_path / "pipe")  # opening it would wait for a writer that never comes
    for path, kind in ((tmp_path / "pipe", "a pipe"), (Path("/dev/zero"), "a device")):
        with pytest.raises(DesignError, match=rf"^{path}: not a regular file \(got {kind}\)"):
            read(path)


def test_what_a_shell_hands_over_open_is_read() -> None:
    out, into = os.pipe()
    os.write(into, b"the text")
    os.close(into)
    try:
        assert read_text(f"/dev/fd/{out}") == "the text"
    finally:
        os.close(out)


def test_a_path_with_a_null_byte() -> None:
    with pytest.raises(DesignError, match="cannot be read"):
        load("stage\0.toml")


def test_a_file_of_100_mb_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "stage.toml"
    with path.open("wb") as stream:
        stream.truncate(100_000_000)
    with pytest.raises(DesignError, match=r"file too large"):
        load(path)


def test_a_text_that_is_too_large() -> None:
    with pytest.raises(DesignError, match=r"file too large"):
        loads("#" * (LARGEST + 1))


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    path = tmp_path / "stage.toml"
    path.write_bytes(b'name = "a"\nx = "\xff"\n')
    with pytest.raises(DesignError, match=r":2: not UTF-8 \(byte 16\)"):
        load(path)


def test_a_byte_order_mark_does_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "stage.toml"
    path.write_bytes(b"\xef\xbb\xbf" + TEXT.replace("\n", "\r\n").encode())
    assert load(path) == loads(TEXT)


# ------------------------------------------------------------------------------------------------------------ descriptions made in Python

STAGE = loads(TEXT)
STEEL = STAGE.materials["steel"]
UNIT = STAGE.units["leg"]
X, Y, Z, O = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)  # noqa: E741
REINFORCED = ReinforcedLeaf("steel", 0.05, 0.0005, 0.01, flexure_length=0.01, reinforced_thickness=0.002)
STACK = Piezo(stroke=1e-5, stiffness=1e7, length=0.02, diameter=0.005)


def part(value: Any) -> Mechanism:
    """The stage with another part."""
    return dataclasses.replace(STAGE, parts={**STAGE.parts, "p": value})


def linked(value: Any, **link: Any) -> Mechanism:
    """The stage with a part in a link between ground and platform."""
    return dataclasses.replace(part(value), links={"l": Link(**{"joins": ("ground", "platform"), "part": "p", "at": O, "along": X} | link)})


def body(value: Body) -> Mechanism:
    """The stage with another body, hung up by a wire."""
    wire = Link(("ground", "b"), "wire", O, X)
    return dataclasses.replace(STAGE, bodies={**STAGE.bodies, "b": value}, links={"w": wire})


def matrix(**entries: float) -> tuple[tuple[float, ...], ...]:
    """A 6x6 of ones on the diagonal, with other entries by row and column."""
    rows = [[1e-6 * (row == column) for column in range(6)] for row in range(6)]
    for name, value in entries.items():
        rows[int(name[1])][int(name[2])] = value
    return tuple(tuple(row) for row in rows)


DANGLING = {"tip": Body(mass=1.0), **STAGE.bodies}


@pytest.mark.parametrize(
    ("mechanism", "words"),
    [
        (part(Notch("steel", thickness=0.012, width=0.01, profile=Circular(0.005))), ["parts.p.thickness", "12 mm", "width, 10 mm"]),
        (part(Notch("steel", thickness=0.01, width=0.01, profile=Circular(0.005))), ["parts.p.thickness", "10 mm", "width, 10 mm"]),
        (part(Notch("steel", 0.001, 0.01, Filleted(length=0.01, radius=0.006))), ["profile.radius", "6 mm", "half the length, 5 mm"]),
        (part(dataclasses.replace(REINFORCED, curvature=2.0)), ["parts.p.curvature", "not modelled in a reinforced leaf"]),
        (part(dataclasses.replace(REINFORCED, face_temperature_difference=5.0)), ["parts.p.face_temperature_difference", "not modelled"]),
        (part(dataclasses.replace(REINFORCED, inner_modes=2)), ["parts.p.inner_modes", "not modelled"]),
        (part(Restricted(Notch("steel", 0.012, 0.01, Circular(0.005)), elastic=())), ["parts.p.part.thickness", "12 mm"]),
        (part(Restricted(Rod("steel", 0.1, 0.01), (Freedom.X,), (Freedom.X,))), ["parts.p", "x both elastic and free"]),
        (part(Rod("steel", length=np.array([0.1, 0.2, -0.3]), diameter=0.01)), ["parts.p.length at index 2", "-300 mm"]),
        (part(Notch("steel", np.array([[0.001], [0.02]]), np.array([0.01, 0.03]), Circular(1.0))), ["at index 1, 0", "20 mm", "10 mm"]),
        (part(Rod("steel", length=np.ones(2), diameter=np.ones(3))), ["batch", "(2,)", "(3,)", "broadcast"]),
        (part(ComplianceMatrix(matrix(x05=1e-7), (Freedom.RZ,))), ["parts.p.compliance at index 0, 5", "not symmetric", "1e-07"]),
        (part(ComplianceMatrix(matrix(x05=2e-6, x50=2e-6), (Freedom.RZ,))), ["parts.p.compliance", "not positive definite"]),
        (part(ComplianceMatrix(matrix(x33=0.0), (Freedom.RZ,))), ["parts.p.compliance", "not positive definite", "restricted part"]),
        (part(dataclasses.replace(STACK, preload=20.0, maximum_load=10.0)), ["parts.p.preload", "20 N", "maximum load, 10 N"]),
        (part(dataclasses.replace(STACK, voltage_low=100.0, voltage_high=-20.0)), ["parts.p.voltage_low", "100 V", "-20 V"]),
        (
            part(dataclasses.replace(STACK, voltage_low=-20.0, voltage_high=120.0, bias=-100.0)),
            ["parts.p.voltage_low", "at most the bias, -100 V", "-20 V"],
        ),
        (linked(Notch("steel", 0.001, 0.01, Circular(0.005))), ["links.l", 'part "p" is not axisymmetric', 'bends = "y"']),
        (linked(Neck("steel", 0.001, Straight(0.005), width=0.002)), ["links.l", "not axisymmetric"]),
        (linked(Joint((Freedom.RZ,))), ["links.l", "not axisymmetric"]),
        (linked(ComplianceMatrix(matrix(x11=2e-6), (Freedom.RX,))), ["links.l", "not axisymmetric"]),
        (linked(Rod("steel", 0.1, 0.01), free=(Freedom.RY,)), ["links.l", "not axisymmetric"]),
        (linked(Rod("steel", 0.1, 0.01), bends=(1.0, 0.0, 1.0)), ["links.l.bends", "45 deg", "90 deg"]),
        (linked(Rod("steel", 0.1, 0.01), bends=X), ["links.l.bends", "0 deg", "90 deg"]),
        (linked(Rod("steel", 0.1, 0.01), along=O), ["links.l.along", "zero"]),
        (linked(Rod("steel", 0.1, 0.01), along=(np.array([1.0, 0.0]), 0.0, 0.0)), ["links.l.along at index 1", "zero"]),
        (linked(Rod("steel", 0.1, 0.01), joins=("ground", "ground")), ["links.l.joins", "both ends"]),
        (body(Body(mass=1.0, solids={"s": Block("steel", (1.0, 1.0, 1.0))})), ["bodies.b", "both solids and mass specified"]),
        (body(Body(centre=O)), ["bodies.b", "centre without a mass"]),
        (body(Body(mass=1.0, inertia=Inertia(1.0, 1.0, 3.0))), ["bodies.b.inertia", "1, 1, 3", "sum of the other two"]),
        (body(Body(mass=1.0, inertia=Inertia(1.0, 1.0, 1.0, xy=2.0))), ["bodies.b.inertia", "-1", "between 0 and"]),
        (body(Body(solids={"s": Block("steel", (0.1, 0.2, 0.1), hole=(0.05, 0.2))})), ["solids.s.hole.y", "200 mm", "block, 200 mm"]),
        (body(Body(solids={"s": Cylinder("steel", 0.1, 0.2, bore=0.1)})), ["solids.s.bore", "100 mm", "diameter, 100 mm"]),
        (body(Body(solids={"s": Cylinder("steel", 0.1, 0.2, along=O)})), ["solids.s.along", "zero"]),
        (body(Body(solids={"s": Cylinder("iron", 0.1, 0.2)})), ["solids.s.material", '"iron"', "steel"]),
        (
            dataclasses.replace(STAGE, payloads={"chuck": Payload("platform", 1.0, O, Inertia(0.0, 0.0, 1.0))}),
            ["payloads.chuck.inertia", "0, 0, 1"],
        ),
        (dataclasses.replace(STAGE, payloads={"chuck": Payload("platfrom", 1.0, O)}), ["payloads.chuck.body", '"platfrom"', "platform"]),
        (dataclasses.replace(STAGE, placements={}), ["platform", "not connected to the ground"]),
        (dataclasses.replace(STAGE, bodies={**STAGE.bodies, "loose": Body(mass=1.0)}), ["loose", "not connected to the ground"]),
        (dataclasses.replace(STAGE, bodies={**STAGE.bodies, "ground": Body()}), ["bodies.ground", "implied"]),
        (
            dataclasses.replace(part(STACK), bodies=DANGLING, links={"pzt": Link(("ground", "tip"), "p", O, X)}),
            ["pzt", "ground and tip", "not in a chain of links from ground to platform"],
        ),
        (
            dataclasses.replace(STAGE, placements={**STAGE.placements, "L2": Placement("leg", Pose())}),
            ["placements.L2", "L1-L3, L2 use the name 2 times"],
        ),
        (
            dataclasses.replace(STAGE, placements={"leg": Placement("leg", Pose())}),
            ["placements.leg", "a unit and an instance have this name"],
        ),
        (
            dataclasses.replace(STAGE, links={"L2": Link(("ground", "platform"), "wire", O, X)}),
            ["placements.L2", "a link and an instance have this name"],
        ),
        (
            dataclasses.replace(STAGE, placements={"L": Placement("leg", Pose(along=X, up=X))}),
            ["placements.L.pose.up", "got 0 deg"],
        ),
        (
            dataclasses.replace(STAGE, units={"leg": dataclasses.replace(UNIT, bodies={"platform": Body()})}),
            ["units.leg.bodies.platform", "the stage also has a body"],
        ),
        (
            dataclasses.replace(STAGE, placements={"L" * 70: Placement("leg", Polar(0.1, 0.0, InstanceOrientation.AXIS))}),
            ["placements.LLL", "70 characters"],
        ),
        (dataclasses.replace(STAGE, overrides={"L2/front.diameter": -0.001}), ['overrides."L2/front.diameter"', "-1 mm"]),
        (dataclasses.replace(STAGE, overrides={"L2/front.diameter": "1 mm"}), ['overrides."L2/front.diameter"', "'1 mm'", "a number"]),
        (dataclasses.replace(STAGE, overrides={"L9/front.diameter": 0.001}), ['overrides."L9/front.diameter"', '"L9"']),
        (dataclasses.replace(STAGE, tags={"parts.wire.width": "assumed"}), ['tags."parts.wire.width"', "unknown address"]),
        (dataclasses.replace(STAGE, tags={"parts.wire.length": "stated"}), ["source missing", "paper"]),
        (dataclasses.replace(STAGE, materials={"steel": dataclasses.replace(STEEL, poisson=0.5)}), ["poisson", "0.5", "less than 0.5"]),
    ],
)
def test_each_fault_of_a_description_is_told(mechanism: Mechanism, words: list[str]) -> None:
    lines = [str(finding) for finding in check(mechanism)]
    assert any(all(word in line for word in words) for line in lines), lines
    with pytest.raises(DesignError):
        require_valid(mechanism)


@pytest.mark.parametrize(
    "mechanism",
    [
        linked(Notch("steel", 0.001, 0.01, Circular(0.005)), bends=Z),
        linked(Neck("steel", 0.001, Circular(0.005))),
        linked(Joint((Freedom.RX, Freedom.RY, Freedom.RZ))),
        linked(ComplianceMatrix(matrix(), (Freedom.RX,))),
        linked(Rod("steel", 0.1, 0.01), bends=(0.0, 0.0008, 1.0)),
        linked(STACK),
        body(Body(mass=1.0, inertia=Inertia(1.0, 1.0, 2.0))),
        body(Body()),
        part(Notch("steel", np.array([0.001, 0.002]), np.array([[0.01], [0.03]]), Circular(1.0))),
        dataclasses.replace(STAGE, overrides={"L2/front.diameter": np.array([0.001, 0.002])}),
    ],
)
def test_what_is_sound_is_let_through(mechanism: Mechanism) -> None:
    assert check(mechanism) == ()


def test_a_departed_part_is_checked_too() -> None:
    notched = linked(Notch("steel", 0.001, 0.01, Circular(0.005)), bends=Z)
    lines = [str(finding) for finding in check(dataclasses.replace(notched, overrides={"links.l.thickness": 0.02}))]
    assert any("links.l.thickness" in line and "20 mm" in line for line in lines), lines


NUMBERS = TEXT.replace('length = "30 mm"         # as drawn', 'length = "long"').replace(
    "[materials.steel]", '[numbers]\nlong = "2*arm"\narm = "15 mm"\nlean = "3 deg"\n\n[materials.steel]'
)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"long"', '"lnog"', ["parts.wire.length", 'unknown number "lnog"', "long"]),
        ('"long"', '"2*arm*mm2"', ["parts.wire.length", 'unknown number "mm2"', "have the sign ^: mm^2"]),
        ('"long"', '"long + 3 N"', ["parts.wire.length", '"long + 3 N"', "a length and a force"]),
        ('"long"', '"long*arm"', ["parts.wire.length", "a quantity in m^2", "must be a length"]),
        ('"long"', '"sin(arm)*long"', ["parts.wire.length", '"sin(arm)"', "an angle", "a length"]),
        ('"long"', '"long/(arm - arm)"', ["parts.wire.length", "divides by 0"]),
        ('"long"', '"sqrt(-long*long)"', ["parts.wire.length", "root", "negative"]),
        ('"long"', '"long*1e300*1e300"', ["parts.wire.length", "finite"]),
        ('"long"', '"long^2"', ["parts.wire.length", '"^"', "arm*arm"]),
        ('"long"', '"2 long"', ["parts.wire.length", "long", "2*long"]),
        ('"long"', '"2*mm"', ["parts.wire.length", "mm is a unit", "1 mm"]),
        ('"long"', '"abs(long)"', ["parts.wire.length", 'unknown function "abs"', "sqrt, sin, cos or tan"]),
        ('"long"', '"2,5*long"', ["parts.wire.length", '","', "point"]),
        ('"long"', '"long*"', ["parts.wire.length", "ends too early"]),
        ('"long"', f'"{"(" * 30}long{")" * 30}"', ["parts.wire.length", "deeper than 20"]),
        ('"long"', f'"{"long+" * 80}long"', ["parts.wire.length", "at most 300"]),
        ('"long"', "\"__import__('os')\"", ["parts.wire.length", "__import__"]),
        ('"15 mm"', '"long/2"', ["numbers.arm", "arm -> long -> arm", "a number"]),
        ('"15 mm"', '"arm"', ["numbers.arm", "arm -> arm"]),
        ('"15 mm"', '"15 furlong"', ["numbers.arm", '"furlong" is not a known unit']),
        ('"15 mm"', '["15 mm"]', ["numbers.arm", "not a number", "26 mm"]),
        ('"15 mm"', '"sqrt(sqrt(2 m))"', ["numbers.arm", "m^0.25"]),
        ('"2*arm"', '"2 arm"', ["numbers.long", "not a known unit"]),
        ("lean =", 'mm = "1 mm"\nlean =', ["parts.wire.diameter", '"mm" is a unit and a named number', "mm_1"]),
        ("lean =", "sin =", ["numbers.sin", "reserved in formulas"]),
        ("lean =", '"a-b" =', ["numbers.a-b", "letters, digits"]),
        ("[numbers]", "[number]", ["number:", "unknown key", "numbers"]),
    ],
)
def test_each_mistake_in_a_formula_is_told_with_its_object_and_remedy(old: str, new: str, words: list[str]) -> None:
    assert check(loads(NUMBERS)) == ()
    assert old in NUMBERS
    lines = told(NUMBERS.replace(old, new, 1))
    assert any(all(word in line for word in words) for line in lines), lines
