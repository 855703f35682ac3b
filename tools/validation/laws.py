"""The laws that tests try on random parts, models and mechanisms, read from tests/laws."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from pathlib import Path

from hypothesis import settings

from tests import conftest
from tools.validation.row import Section, table

TESTS = Path(conftest.__file__).parent
FILES = (*sorted((TESTS / "laws").glob("test_*.py")), TESTS / "elsewhere" / "test_direct_stiffness.py")
PROFILES = ("default", "full")
"""Of Hypothesis, registered by tests/conftest.py."""


def sections() -> list[Section]:
    """One section a file of laws, and the second assembly that all random stages are compared with."""
    return [section for path in FILES if (section := _section(path))]


def _section(path: Path) -> Section | None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    tests = list(_tests(tree))
    named = {node.targets[0].id: node.value for node in tree.body if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)}
    lines = [(_words(each), examples) for each in tests if (examples := _examples(each, named))]
    if not tests:
        return None
    stated = [_words(each).partition(":")[0] for each in tests if not _examples(each, named)]
    about = (ast.get_docstring(tree) or "").partition("\n\n")[0].replace("\n", " ")
    more = [f"On stated cases: {'; '.join(stated)}."] if stated else []
    return Section(f"`{path.relative_to(TESTS.parent)}`", about, (), (*([table(("law", "examples"), lines)] if lines else []), *more))


def _tests(tree: ast.Module) -> Iterator[ast.FunctionDef]:
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
            yield node


def _words(test: ast.FunctionDef) -> str:
    said = (ast.get_docstring(test) or "").partition("\n\n")[0].replace("\n", " ")
    name = test.name.removeprefix("test_").replace("_", " ")
    return f"{name}: {said}".replace("|", "\\|") if said else name


def _examples(test: ast.FunctionDef, named: Mapping[str, ast.expr]) -> str:
    """How many random examples, as configured for `make test` and `make check-all`; empty: the law is tried on stated cases."""
    decorators = [named.get(_name(each), each) for each in test.decorator_list]
    calls = {_name(each.func): each for each in decorators if isinstance(each, ast.Call)}
    if "given" not in calls:
        return ""
    decorator = calls.get("settings")
    own = next((word.value for word in decorator.keywords if word.arg == "max_examples"), None) if decorator else None
    profiles = [settings.get_profile(name).max_examples for name in PROFILES]
    if "examples" in calls:  # ten times as many in the full tests
        count = _count(calls["examples"].args[0], 0)
        own, profiles = None, [count, 10 * count]
    usual, full = (_count(own, each) for each in profiles)
    return str(usual) if usual == full else f"{usual} (`make check-all`: {full})"


def _count(node: ast.expr | None, profile: int) -> int:
    """A number of examples as it is written: a constant, that of the profile, or a part of either."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int):
        return node.value
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.FloorDiv):
        return _count(node.left, profile) // _count(node.right, profile)
    return profile


def _name(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
