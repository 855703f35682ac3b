"""The public surface: the lazy table, its stub and the modules agree; importing flexstage loads nothing heavy."""

from __future__ import annotations

import ast
import importlib
import inspect
import itertools
import pkgutil
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

import flexstage

PACKAGE = Path(flexstage.__file__).parent
HEAVY = {"numpy", "scipy", "pydantic", "pint", "matplotlib", "pandas", "xarray"}
SOLVER = {"ngsolve", "netgen", "pyngcore", "ngsolve_openblas", "meshio", "pygltflib"}
"""What only the solid model needs: neither loaded nor required by anything else."""

DEFINED_TWICE = """
Amount Amplifier Axes Axis Band Bearing Bend Block Bounds Buckling Channel Code Combination Command Comparison Compensation Contribution
Curve Draft Drive Elimination Ends Engine Fact Family Field Fit Free Grid Group Hardware Inertia Job Jobs Joint
Judgement Kind Law Layout Limits Line Margins Matrix Modes Motion Motions Notch Numbers Outcome Part Peak Piece Place Plan Point
Pose Problem Reach Reading Resolution Response Row Rule Run Scene Section Session Shape Side Simulated Slopes Solid Spectrum Spot
Stage Start State Status Step Stream Stroke Superelement Surface Sweep System Table Values Variable Variant Verdict View Weights
"""
"""Public classes that several modules define, each under this name: the list only shrinks."""

NAMESPACES = {"": flexstage} | {f".{wing}": getattr(flexstage, wing) for wing in flexstage.WINGS}


def table(package: str) -> dict[str, str]:
    return {name: f"flexstage{package}.{home}" for home, names in NAMESPACES[package].HOMES.items() for name in names.split()}


EVERY = [(package, name) for package in NAMESPACES for name in sorted(table(package))]


def stub(package: str) -> dict[str, str]:
    tree = ast.parse((PACKAGE / package.removeprefix(".") / "__init__.pyi").read_text())
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom) and node.module != "flexstage"]
    assert all(alias.asname == alias.name for node in imports for alias in node.names), "re-export as `name as name`"
    return {alias.name: str(node.module) for node in imports for alias in node.names}


def loaded_by(code: str, *, whole: bool = False) -> set[str]:
    """Packages that some code loads, or modules by their whole names."""
    code += f"; import sys; print(*{{name if {whole} else name.partition('.')[0] for name in sys.modules}})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize("package", NAMESPACES)
def test_table_and_stub_agree(package: str) -> None:
    assert table(package) == stub(package)


def test_no_name_has_two_homes_nor_that_of_a_module() -> None:
    """An import of a module would put it in the place of the name."""
    names = [name for package in NAMESPACES.values() for each in package.HOMES.values() for name in each.split()]
    assert len(names) == len(set(names))
    for package in NAMESPACES.values():
        modules = {each.name for each in pkgutil.iter_modules(package.__path__)}
        assert not modules & {name for each in package.HOMES.values() for name in each.split()}


@pytest.mark.parametrize(("package", "name"), EVERY)
def test_every_name_is_the_one_of_its_home(package: str, name: str) -> None:
    assert getattr(NAMESPACES[package], name) is getattr(importlib.import_module(table(package)[name]), name)


def test_a_public_class_name_is_defined_once() -> None:
    nodes = itertools.chain.from_iterable(ast.walk(ast.parse(file.read_text(encoding="utf-8"))) for file in PACKAGE.rglob("*.py"))
    counts = Counter(node.name for node in nodes if isinstance(node, ast.ClassDef) and not node.name.startswith("_"))
    assert {name for name, count in counts.items() if count > 1} == set(DEFINED_TWICE.split())


@pytest.mark.parametrize("package", NAMESPACES)
def test_dir_lists_the_table(package: str) -> None:
    assert {*table(package)} <= set(dir(NAMESPACES[package]))


def test_unknown_names_are_refused() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = flexstage.nonsense


def takers() -> list[tuple[Callable[..., object], str]]:
    """Public functions with each of their parameters that is a model."""
    functions = [value for package, name in EVERY if inspect.isfunction(value := getattr(NAMESPACES[package], name))]
    model = re.compile(r"(LinearModel|Kinematics)( \| None)?")
    told = [(each, parameter) for each in functions for parameter in inspect.signature(each).parameters.values()]
    return [(each, parameter.name) for each, parameter in told if model.fullmatch(str(parameter.annotation))]


def test_a_description_in_the_place_of_a_model_is_refused_with_the_call_that_was_meant() -> None:
    stage = flexstage.case("parallelogram")
    assert len(takers()) >= 15
    for function, name in takers():
        arguments = dict.fromkeys(inspect.signature(function).parameters) | {name: stage}
        with pytest.raises(TypeError, match=rf"{function.__name__} takes a model, not a description: {function.__name__}\("):
            function(**arguments)


def test_import_loads_nothing_heavy() -> None:
    assert not (HEAVY | SOLVER) & loaded_by("import flexstage")


def test_units_and_directions_load_nothing_heavy() -> None:
    assert not HEAVY & loaded_by("import flexstage as fs; fs.mm, fs.X")


def test_help_loads_nothing_heavy() -> None:
    if not (PACKAGE / "apps" / "cli" / "__init__.py").exists():
        pytest.skip("the command line is not there yet")
    code = (
        "import sys; sys.argv = ['flexstage', '--help']\n"
        "try:\n from flexstage.apps.cli import main; main()\n"
        "except SystemExit as end:\n assert not end.code\n0"
    )
    assert not (HEAVY | SOLVER) & loaded_by(code)


def test_commands_load_what_only_some_calls_need_when_they_need_it() -> None:
    """Templates for reports, the editor of design files, pictures, and all of scipy's packages: the help of a command waits for none."""
    modules = "import flexstage.apps.commands.analyse, flexstage.apps.commands.describe, flexstage.control.commands.loop, sys"
    names = "flexstage.control.show.report jinja2 tomlkit PIL scipy.special scipy.linalg scipy.optimize matplotlib pydantic"
    assert not set(names.split()) & loaded_by(modules, whole=True)


def test_other_models_load_no_solver() -> None:
    assert not SOLVER & loaded_by("import flexstage as fs; fs.modes(fs.lumped(fs.case('double-triangle')))")
