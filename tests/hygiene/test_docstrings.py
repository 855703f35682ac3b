"""Every public function and class says what it means; examples show what a reader can check."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from tests.hygiene.source import SRC, Defined, defined, expect_none, modules, tree


def public() -> Iterator[Defined]:
    for path in modules():
        if not any(part.startswith("_") and part != "__init__.py" for part in path.relative_to(SRC).parts):
            yield from (each for each in defined(path) if each.is_public)


def is_variant(each: Defined) -> bool:
    """A property's setter or an overload: described where the property or the function itself stands."""
    return any(ast.unparse(mark).endswith((".setter", "overload")) for mark in each.node.decorator_list)


def test_modules_have_docstrings() -> None:
    expect_none((str(path) for path in modules() if not ast.get_docstring(tree(path))), "say what the module is for")


def test_public_functions_and_classes_have_docstrings() -> None:
    found = (each.where for each in public() if not is_variant(each) and not ast.get_docstring(each.node))
    expect_none(found, "say what it means, or make it private")


def test_examples_show_more_than_a_name() -> None:
    # `>>> f.__name__` runs and proves nothing.
    named = re.compile(r">>> [\w.]+\.__name__\s")
    found = (f"{path}: {each[0]}" for path in modules() if (each := named.search(path.read_text(encoding="utf-8"))))
    expect_none(found, "show what the function does, or nothing")
