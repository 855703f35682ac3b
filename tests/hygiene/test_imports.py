"""Imports point down the layers and make no cycle, those by a name in a string included."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module

import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from flexstage.apps.studio.engine import TASKS
from tests.hygiene.source import expect_none
from tools.imports import import_graph, named_modules, path_of, points_up, unread_loaders

LOADERS = {
    "flexstage": "the names of WINGS; nothing imports the root",
    "flexstage.base.lazy": "loads the names that its callers state",
    "flexstage.apps.cli.commands": "COMMANDS, in the same file",
    "flexstage.apps.doctor": "packages of others",
    "flexstage.apps.studio.engine": "TASKS, in the same file",
    "flexstage.show.command.models": "tables that the application states",
}
"""Modules that load by a name which their call does not state, and where that name is stated. The list only shrinks."""


def edges() -> Iterator[tuple[str, str]]:
    graph = import_graph()
    return ((importer, imported) for importer in graph.modules for imported in graph.find_modules_directly_imported_by(importer))


def test_imports_point_down() -> None:
    upward = (f"{importer} -> {imported}" for importer, imported in edges() if points_up(importer, imported))
    expect_none(upward, "move what both need down, or the importer up; there is no list of exceptions")


def test_imports_make_no_cycle() -> None:
    modules = sorted(import_graph().modules)
    index = {module: number for number, module in enumerate(modules)}
    rows, columns = zip(*((index[importer], index[imported]) for importer, imported in edges()), strict=True)
    matrix = coo_array(([1.0] * len(rows), (rows, columns)), shape=(len(modules), len(modules)))
    count, labels = connected_components(matrix, connection="strong")
    circles = [[module for module, label in zip(modules, labels, strict=True) if label == number] for number in range(count)]
    expect_none((" ".join(each) for each in circles if len(each) > 1), "these modules import one another: divide one of them")


def test_every_loader_states_its_names() -> None:
    """An import by a name that no string states would not be seen."""
    unread = {module for module in import_graph().modules if any(unread_loaders(path_of(module)))}
    expect_none(unread - LOADERS.keys(), "state the name of the module in the call, or the place that states it in LOADERS")
    assert unread >= LOADERS.keys(), "take out the loaders that are not needed"


@pytest.mark.parametrize(
    "text",
    [
        'import_module("flexstage.show.table")',
        'LazyModule("flexstage.show.table")',
        '_SHOW = "flexstage.show"\nHOME = f"{_SHOW}.table:Table"',
        'HOMES = {"show.table": "Table"}\nlazy_attributes(__name__, HOMES)',
        'TASKS = {"write": "show.table:make_table"}',
        'def later():\n    sys.modules["flexstage.show.table"]',
    ],
)
def test_imports_by_name_are_collected(text, tmp_path) -> None:
    (tmp_path / "__init__.py").write_text(text)
    assert named_modules("flexstage", tmp_path / "__init__.py", import_graph().modules) == {"flexstage.show.table"}


def test_loaders_of_unknown_names_are_found(tmp_path) -> None:
    (tmp_path / "some.py").write_text('from importlib import import_module\nimport_module("json")\nimport_module(name)\n')
    assert list(unread_loaders(tmp_path / "some.py")) == [3]


@pytest.mark.parametrize(
    ("importer", "imported", "is_upward"),
    [
        ("base.number", "show.table", True),
        ("beams.leaf", "mechanism.mount", True),
        ("solid.modes", "experiment.record", True),
        ("studies.sweeps", "control.plants", False),
        ("apps.cli", "base.number", False),
        ("__main__", "apps.cli", False),
    ],
)
def test_upward_means_to_a_higher_or_an_independent_package(importer, imported, is_upward) -> None:
    assert points_up(f"flexstage.{importer}", f"flexstage.{imported}") is is_upward
    assert points_up(f"flexstage.{importer}", "flexstage")


def test_every_task_of_the_studio_is_a_function() -> None:
    """Its processes load tasks by name, relative to the studio: a page waits in vain for one that is nowhere."""
    names = (text.partition(":") for text in TASKS.values())
    assert all(callable(getattr(import_module(f"flexstage.apps.studio.{module}"), name)) for module, _, name in names)
