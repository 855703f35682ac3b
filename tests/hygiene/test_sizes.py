"""The budget of size: short functions, short files, few positional parameters, nothing hidden in them."""

from __future__ import annotations

import ast
import io
import tokenize
from collections.abc import Iterator
from pathlib import Path

from tests.hygiene.source import SRC, Defined, Function, code_files, defined, expect_none, tree

FUNCTION_BODY, CLASS_BODY, FILE = 40, 200, 400
POSITIONAL = 5

_NOT_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


def code_lines(path: Path) -> int:
    """Lines that hold code: docstrings, comments and blanks not counted."""
    prose = {line for node in ast.walk(tree(path)) if is_text(node) for line in range(node.lineno, (node.end_lineno or 0) + 1)}
    tokens = tokenize.generate_tokens(io.StringIO(path.read_text(encoding="utf-8")).readline)
    code = {line for token in tokens if token.type not in _NOT_CODE for line in range(token.start[0], token.end[0] + 1)}
    return len(code - prose)


def is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def body_lines(node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> int:
    body = [child for child in node.body if not is_text(child)]
    return (body[-1].end_lineno or 0) - body[0].lineno + 1 if body else 0


def functions(within: Path | None = None) -> Iterator[Defined]:
    for path in code_files():
        if within is None or within in path.parents:
            yield from (each for each in defined(path) if isinstance(each.node, Function))


def positional(each: Defined) -> list[ast.arg]:
    arguments = each.node.args
    found = [*arguments.posonlyargs, *arguments.args]
    bound = isinstance(each.owner, ast.ClassDef) and not any(ast.unparse(mark) == "staticmethod" for mark in each.node.decorator_list)
    return found[1:] if bound else found


def takes_a_flag(each: Defined) -> bool:
    arguments = each.node.args
    flags = [argument for argument in positional(each) if argument.annotation and ast.unparse(argument.annotation) == "bool"]
    defaults = [default for default in arguments.defaults if isinstance(default, ast.Constant) and isinstance(default.value, bool)]
    return bool(flags or defaults)


def test_functions_are_short() -> None:
    expect_none((f"{each.where}: {size} lines" for each in functions() if (size := body_lines(each.node)) > FUNCTION_BODY), "divide it")


def test_classes_are_short() -> None:
    classes = (each for path in code_files() for each in defined(path) if isinstance(each.node, ast.ClassDef))
    expect_none((f"{each.where}: {size} lines" for each in classes if (size := body_lines(each.node)) > CLASS_BODY), "divide it")


def test_files_are_short() -> None:
    found = (f"{path}: {size} lines of code" for path in code_files() if (size := code_lines(path)) > FILE)
    expect_none(found, "make it a package of the same name")


def test_positional_parameters_are_few() -> None:
    found = (f"{each.where}: {count}" for each in functions(SRC) if (count := len(positional(each))) > POSITIONAL)
    expect_none(found, "make some keyword-only, or a value of them")


def test_no_parameters_are_hidden_in_a_dictionary() -> None:
    expect_none((each.where for each in functions(SRC) if each.node.args.kwarg), "name the parameters instead of **")


def test_flags_are_given_by_name() -> None:
    # `feed(state, value, True)` says nothing at the call. Private helpers are read, too.
    expect_none((each.where for each in functions(SRC) if takes_a_flag(each)), "put * before the flag")


def test_no_star_imports() -> None:
    imports = ((path, node) for path in code_files() for node in ast.walk(tree(path)) if isinstance(node, ast.ImportFrom))
    found = (f"{path}:{node.lineno}" for path, node in imports if any(alias.name == "*" for alias in node.names))
    expect_none(found, "import names")


def test_code_lines_leave_out_prose(tmp_path: Path) -> None:
    path = tmp_path / "sample.py"
    path.write_text('"""Text\nof two lines."""\n\n# comment\nx = [  # counts\n    1,\n]\n')
    assert code_lines(path) == 3
