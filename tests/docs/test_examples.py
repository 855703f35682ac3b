"""Every example of README.md and of docs is run as a reader would run it; warnings are errors."""

from __future__ import annotations

import ast

import pytest

from tests.docs.pages import blocks, pages
from tests.docs.runner import Runner

ANALYSES = ("mapping", "statics", "lost_motion", "modes")


@pytest.mark.parametrize("page", pages())
def test_every_block_of_a_page_works_in_order(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    reader = Runner(tmp_path)
    for block in blocks(page):
        reader.run(block)


LENGTHS = {"README.md": 15, "docs/how-to/describe-in-python.md": 40}
"""Pages with one Python example that ends with the four analyses, and its most lines."""


def _example(page):
    (block,) = (block for block in blocks(page) if block.language == "python")
    return block.text


@pytest.mark.parametrize("page", LENGTHS)
def test_the_stage_and_its_analyses_fit_in_few_lines(page):
    assert len([line for line in _example(page).splitlines() if line.strip()]) <= LENGTHS[page]


@pytest.mark.parametrize("page", LENGTHS)
def test_the_example_ends_with_the_four_analyses(page):
    last = ast.parse(_example(page)).body[-len(ANALYSES) :]
    assert [_called(statement) for statement in last] == ["print"] * len(ANALYSES)
    for statement, analysis in zip(last, ANALYSES, strict=True):
        names = {node.attr for node in ast.walk(statement) if isinstance(node, ast.Attribute)}
        assert analysis in names, f"line {statement.lineno} shows no {analysis}"


def _called(statement):
    call = statement.value if isinstance(statement, ast.Expr) else None
    return call.func.id if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) else None
