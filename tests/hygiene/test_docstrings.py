"""Every public function and class says what it means; every public function shows an example that a reader can check."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from tests.hygiene.source import SRC, Defined, Function, defined, expect_none, modules, tree

WITHOUT_EXAMPLE: dict[str, str] = {
    "apps.cli": "commands: run by tests/apps and the manual",
}
"""Module, or module and function (`readings.lumped.read`): the reason why it has no doctest."""


def public() -> Iterator[Defined]:
    for path in modules():
        if not any(part.startswith("_") and part != "__init__.py" for part in path.relative_to(SRC).parts):
            yield from (each for each in defined(path) if each.is_public)


def address(each: Defined) -> str:
    module = ".".join(each.path.relative_to(SRC).with_suffix("").parts).removesuffix(".__init__")
    return f"{module}.{each.name}"


def is_excused(each: Defined) -> bool:
    return any(address(each) == name or address(each).startswith(f"{name}.") for name in WITHOUT_EXAMPLE)


def is_variant(each: Defined) -> bool:
    """A property's setter or an overload: described where the property or the function itself stands."""
    return any(ast.unparse(mark).endswith((".setter", "overload")) for mark in each.node.decorator_list)


def test_modules_have_docstrings() -> None:
    expect_none((str(path) for path in modules() if not ast.get_docstring(tree(path))), "say what the module is for")


def test_public_functions_and_classes_have_docstrings() -> None:
    found = (each.where for each in public() if not is_variant(each) and not ast.get_docstring(each.node))
    expect_none(found, "say what it means, or make it private")


def test_public_functions_have_examples() -> None:
    functions = (each for each in public() if isinstance(each.node, Function) and isinstance(each.owner, ast.Module))
    missing = (each.where for each in functions if not is_excused(each) and ">>>" not in (ast.get_docstring(each.node) or ""))
    expect_none(missing, "add a doctest, or an entry with its reason to WITHOUT_EXAMPLE")


def test_excuses_are_still_needed() -> None:
    addresses = [address(each) for each in public()]
    idle = (name for name in WITHOUT_EXAMPLE if not any(found == name or found.startswith(f"{name}.") for found in addresses))
    expect_none(idle, "remove it from WITHOUT_EXAMPLE")
