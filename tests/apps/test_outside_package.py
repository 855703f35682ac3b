"""A package from outside with a hinge, a gauge, a measure and a record format: known where it is installed, and only there."""

import json
import math
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from flexstage.cases.registry import case
from flexstage.mechanism.store import dumps
from tests.outside_package.stage import SMALL, design

ROUGH = "--accuracy 10% --order 2"
LOOP = """
format = "flexstage loop 1"
amplifier = { kind = "switching", carrier = "20 kHz" }
controller = { kind = "integrators" }
"""
RUN = "import sys; from flexstage.apps.cli import run; sys.exit(max(run(words.split()) for words in sys.argv[1:]))"
PACKAGE = Path(__file__).parents[1] / "outside_package"
STUDY = """
format = "flexstage study 1"
design = "s.toml"
responses = { sag = "sag", f = "frequency.1" }
sweep = { sampling = "grid" }
[variables]
thickness = { address = "parts.leaf.thickness", from = "0.8 mm", to = "1 mm", levels = 5 }
"""


def installed(folder, version="1.0", without=None):
    """A folder that the package is installed in, as an installer leaves it; `without` what it offers in one group."""
    project = tomllib.loads((PACKAGE / "pyproject.toml").read_text())["project"]
    shutil.copytree(PACKAGE / "tapered_leaf", folder / "tapered_leaf")
    told = folder / f"tapered_leaf-{version}.dist-info"
    told.mkdir()
    (told / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {version}\n")
    offers = {group: own for group, own in project["entry-points"].items() if group != without}
    lines = [f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in own.items()) for group, own in offers.items()]
    (told / "entry_points.txt").write_text("\n".join(lines))
    return folder


def flexstage(work, *commands, path=None, ok=0):
    """Commands in a process of their own; stdout and stderr."""
    known = os.pathsep.join(str(each) for each in (path, os.environ.get("PYTHONPATH")) if each)
    surroundings = {**os.environ, "PYTHONPATH": known}
    run = [sys.executable, "-c", RUN, *commands]
    ended = subprocess.run(run, cwd=work, env=surroundings, capture_output=True, text=True, timeout=300, check=False)
    assert ended.returncode == ok, ended.stdout + ended.stderr
    return ended.stdout + ended.stderr


@pytest.fixture(scope="module")
def work(tmp_path_factory):
    """A folder with the design and a study of it."""
    folder = tmp_path_factory.mktemp("outside")
    (folder / "s.toml").write_text(design())
    (folder / "small.toml").write_text(SMALL)
    (folder / "study.toml").write_text(STUDY)
    (folder / "loop.toml").write_text(LOOP)
    return folder


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """The package, installed."""
    return installed(tmp_path_factory.mktemp("site"))


@pytest.fixture(scope="module")
def without(work):
    """What commands say where the package is not installed."""
    (work / "plain.toml").write_text(dumps(case("parallelogram")))
    commands = ("check s.toml", "sweep study.toml -o no.h5", "check small.toml", "loop plain.toml --setup loop.toml")
    return flexstage(work, *commands, ok=2)


@pytest.fixture(scope="module")
def known(work, package):
    """What commands say where it is."""
    pair = SMALL.replace('kind = "taper"', 'kind = "blade_pair"\ndistance = "50 mm"').replace('end_thickness = "3 mm"\n', "")
    pair = pair[: pair.index("left = ")] + 'pair = { joins = ["ground", "platform"], part = "leaf", at = ["0 mm", "27.5 mm", "0 mm"], '
    (work / "pair.toml").write_text(f'{pair}along = "-y", bends = "z" }}\n')
    commands = (
        "check s.toml",
        "analyse s.toml --json analyse.json",
        "schema",
        "check pair.toml",
        "loop s.toml --setup loop.toml --json loop.json",
        "schema loop",
        *(f"sweep study.toml -o {workers}.h5 --workers {workers} --json {workers}.json" for workers in ("1", "2")),
    )
    return flexstage(work, *commands, path=package)


def test_without_the_package_the_design_says_what_to_install(without):
    assert without.count('packages: "tapered-leaf >= 1" is not installed. Install it') == 2  # the design's check, the study of it
    assert without.count("parts.leaf.kind") == 1  # that of `small`: one finding where a package is asked for, not one of every kind


def test_another_version_than_the_design_asks_for_is_refused(work, tmp_path):
    told = flexstage(work, "check s.toml", path=installed(tmp_path / "site", version="0.9"), ok=2)
    assert 'got tapered-leaf 0.9, expected "tapered-leaf >= 1"' in told


def test_without_the_package_the_kind_is_refused_with_what_to_do(without):
    assert 'parts.leaf.kind: unknown kind (got "taper")' in without
    assert "If another package provides this kind, install the package." in without


def test_without_the_package_its_controller_and_amplifier_are_refused_by_kind(without):
    assert 'amplifier.kind: unknown kind (got "switching")' in without
    assert 'controller.kind: unknown value (got "integrators")' in without


def test_check_analyse_and_schema_know_it(work, known):
    assert "sag" in (work / "analyse.json").read_text()
    assert '"const": "taper"' in known
    assert '"const": "interferometer"' in known


def test_a_loop_takes_its_controller_and_its_amplifier(work, known):
    assert "integrators in platform coordinates" in known
    assert '"const": "switching"' in known
    found = json.loads((work / "loop.json").read_text())
    assert found["setup"]["amplifier"] == {"kind": "switching", "carrier": 20e3}
    assert [law["proportional"] for law in (each["law"] for each in found["controller"]["loops"].values())] == [0.0]


def test_its_compound_is_its_members(known):
    assert "2 x leaf" in known
    assert known.count("no errors") >= 2


@pytest.mark.usefixtures("known")
def test_a_sweep_in_two_processes_asks_its_law_and_its_measure(work):
    one, two = (json.loads((work / f"{workers}.json").read_text())["responses"] for workers in ("1", "2"))
    assert one == two
    sag, frequency = one
    assert sag["max_value"] == pytest.approx(9.80665 / (2.0 * math.pi * frequency["min_value"]) ** 2, rel=1e-12)
    assert sag["min_value"] < sag["max_value"]  # by its law: a thicker waist is stiffer


def test_its_shape_is_all_that_finite_elements_need(work, package):
    """Theory and finite elements of the hinge and of the first mode agree within what either is good for; calibration takes that over."""
    whole = (
        f"verify small.toml {ROUGH} --json verify.json",
        f"solid small.toml --scope hinge {ROUGH} --json hinge.json",
        f"calibrate small.toml -o calibrated.toml {ROUGH}",
    )
    flexstage(work, *whole, path=package)
    document = json.loads((work / "verify.json").read_text())
    first = next(row for row in document["rows"] if row["figure"].startswith("platform mode 1 "))
    assert first["fea_error"] < 0.05
    assert first["theory"] == pytest.approx(first["fea"], rel=first["fea_error"])
    alone = {row["figure"]: row for row in document["rows"] if row["group"] == "hinge leaf"}
    assert list(alone) == [f"compliance {axis}" for axis in ("x", "y", "z", "rx", "ry", "rz")]
    bending = alone["compliance rz"]
    assert bending["theory"] == pytest.approx(bending["fea"], rel=0.05)  # theory without plate action
    found = json.loads((work / "hinge.json").read_text())["hinges"]["leaf"]
    assert found["roots"] == {"first": False, "second": True}
    assert found["compliance"]["values"][5][5] == bending["fea"]
    given = tomllib.loads((work / "calibrated.toml").read_text())["parts"]
    assert (given["leaf"]["replaces"], given["leaf-drawn"]["kind"]) == ("leaf-drawn", "taper")


def test_without_a_shape_it_is_not_known_to_finite_elements(work, tmp_path):
    package = installed(tmp_path, without="flexstage.shapes")
    told = flexstage(work, "solid small.toml --scope hinge", "check small.toml", path=package, ok=2)
    assert "leaf: no installed package has a solid shape for this kind. Install a package with this shape" in told
    assert "no errors" in told


def test_a_record_of_its_form_is_read(work, package):
    (work / "a.log").write_text("LOG 100\nu1 S1\nV um\n1 2\n3 4\n")
    ask = "import flexstage as fs; a = fs.experiment.read_record('a.log'); print(a.rate, a.inputs[0].name, a.values.tolist())"
    run = [sys.executable, "-c", ask]
    told = subprocess.run(run, cwd=work, env={**os.environ, "PYTHONPATH": str(package)}, capture_output=True, text=True, check=True)
    assert told.stdout == "100.0 u1 [[1.0, 2.0], [3.0, 4.0]]\n"
    told = subprocess.run(run, cwd=work, env=os.environ, capture_output=True, text=True, check=False)
    assert "no column contains times" in told.stderr


def test_the_page_shows_what_the_package_offers():
    offers = (PACKAGE / "pyproject.toml").read_text().partition("[project.entry-points")
    assert "".join(offers[1:]).strip() in (PACKAGE.parents[1] / "docs" / "contributing.md").read_text()


def test_another_version_has_other_digests(work, package, tmp_path):
    newer = installed(tmp_path / "site", version="2.0")
    ask = (
        "from flexstage import load; from flexstage.base.storage.digest import digest; "
        "print(digest(load('s.toml').parts['leaf'], physics=True))"
    )
    told = [
        subprocess.run([sys.executable, "-c", ask], cwd=work, env={**os.environ, "PYTHONPATH": str(path)}, capture_output=True, check=True)
        for path in (package, newer)
    ]
    first, second = (each.stdout for each in told)
    assert first != second


CRUCIFORM = """format = "flexstage 1"
name = "block on a torsion hinge"
[materials.steel]
like = "17-4PH"
[parts]
pivot = { kind = "cruciform", material = "steel", length = "30 mm", thickness = "2 mm", width = "10 mm" }
[bodies.platform]
solids = { block = { shape = "block", material = "steel", size = ["20 mm", "30 mm", "30 mm"] } }
[links]
pivot = { joins = ["ground", "platform"], part = "pivot", at = ["-25 mm", "0 mm", "0 mm"], along = "x", bends = "z" }
[damping]
law = "modal"
ratio = 0.01
"""


@pytest.fixture(scope="module")
def crossed(tmp_path_factory):
    """A stage on the cruciform hinge, the same on a hinge `plus`, and a package that offers it: our part and law."""
    folder = tmp_path_factory.mktemp("crossed")
    (folder / "own.toml").write_text(CRUCIFORM)
    (folder / "plus.toml").write_text(CRUCIFORM.replace('"cruciform"', '"plus"'))
    package = folder / "site" / "plus_hinge"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    ours = PACKAGE.parents[1] / "src" / "flexstage"
    for floor, module in (("parts", "part"), ("beams", "law")):
        text = (ours / floor / "cruciform.py").read_text()
        text = text.replace("flexstage.parts.cruciform", "plus_hinge.part").replace('"cruciform"', '"plus"').replace("Cruciform", "Plus")
        (package / f"{module}.py").write_text(text)
    (package / "shape.py").write_text("from flexstage.solid.fea.geometry.draw import Shape, prism\n\nPLUS = Shape(prism)\n")
    told = folder / "site" / "plus_hinge-1.0.dist-info"
    told.mkdir()
    (told / "METADATA").write_text("Metadata-Version: 2.1\nName: plus-hinge\nVersion: 1.0\n")
    offers = {"parts": "part:Plus", "laws": "law:CRUCIFORM", "shapes": "shape:PLUS"}
    lines = [f"[flexstage.{group}]\nplus = plus_hinge.{entry}\n" for group, entry in offers.items()]
    (told / "entry_points.txt").write_text("\n".join(lines))
    return folder


def test_a_hinge_of_any_section_is_as_known_from_outside_as_from_inside(crossed):
    """Every number of theory is that of our own: nobody but the registers knows either kind."""
    told = alike(crossed, "check {0}.toml", "analyse {0}.toml --json {0}-analyse.json")
    assert told.count("no errors") == 2
    assert '"const": "plus"' in told
    assert '"const": "cruciform"' in told


@pytest.mark.full
def test_every_command_knows_a_hinge_of_any_section(crossed):
    alike(
        crossed,
        "analyse {0}.toml --report {0}.html",
        *(f"{name} {{0}}.toml --json {{0}}-{name}.json" for name in ("buckle", "sensitivities")),
    )


def alike(folder, *commands):
    """Commands of both stages, whose documents have the same numbers, and the schema; what they say."""
    told = flexstage(folder, *(words.format(name) for name in ("own", "plus") for words in commands), "schema", path=folder / "site")
    for document in folder.glob("own-*.json"):
        own, plus = (json.loads(path.read_text()) for path in (document, document.with_name(document.name.replace("own", "plus"))))
        assert numbers(own) == numbers(plus)
    return told


def numbers(document):
    """All numbers of a JSON document, in order."""
    if isinstance(document, dict | list):
        values = document.values() if isinstance(document, dict) else document
        return [number for value in values for number in numbers(value)]
    return [document] if isinstance(document, float) else []


@pytest.mark.full
@pytest.mark.parametrize("name", ["own", "plus"])
def test_finite_elements_verify_and_calibrate_a_hinge_of_any_section(crossed, name):
    commands = (f"verify {name}.toml {ROUGH} --json verify.json", f"calibrate {name}.toml -o calibrated.toml {ROUGH}")
    flexstage(crossed, *commands, path=crossed / "site")
    rows = json.loads((crossed / "verify.json").read_text())["rows"]
    twist = next(row for row in rows if row["group"] == "hinge pivot" and row["figure"] == "compliance rx")
    assert twist["theory"] == pytest.approx(twist["fea"], rel=0.1)  # the block that it grows on yields, too
    given = tomllib.loads((crossed / "calibrated.toml").read_text())["parts"]
    assert given["pivot-drawn"]["kind"] == ("plus" if name == "plus" else "cruciform")


def test_nothing_but_its_files_and_registers_names_the_cruciform_hinge():
    sources = PACKAGE.parents[1] / "src" / "flexstage"
    naming = {path.relative_to(sources).as_posix() for path in sources.rglob("*.py") if "cruciform" in path.read_text().lower()}
    assert naming == {"parts/cruciform.py", "beams/cruciform.py", "parts/__init__.py", "beams/__init__.py", "solid/fea/geometry/draw.py"}
