"""The signature of a command without its module: what help and the reading of options need, and nothing that computes.

A command's module imports all that the command computes with. Its arguments, options and docstring need few names of it: those are found in
the source, imported or worked out by themselves, and the module is imported when the command is called.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

_RUN = "_run_with"


def signature_of(module: str, name: str) -> Callable[..., Any]:
    """A function of the name, parameters and docstring of a function of a module, which imports the module when it is called.

    The function itself where its module is imported already, or its signature needs a class or function that stands in its own module.

    >>> signature_of("flexstage.apps.commands.about", "version").__doc__
    'Print the version of flexstage.'
    """
    if module in sys.modules:
        return _own(module, name)
    stated = _statements(module).get(name)
    if not isinstance(stated, ast.FunctionDef) or stated.decorator_list:
        return _own(module, name)
    asked = _names(module, stated.args)
    if any(isinstance(_statements(module).get(each), (ast.FunctionDef, ast.ClassDef)) for each in asked):
        return _own(module, name)
    space = {each: _value(module, each) for each in asked}
    space[_RUN] = lambda given: _own(module, name)(**given)
    told = stated.body[:1] if ast.get_docstring(stated) is not None else []
    shown = ast.FunctionDef(name, stated.args, [*told, *ast.parse(f"return {_RUN}(locals())").body], [], lineno=0)
    exec(f"from __future__ import annotations\n{ast.unparse(shown)}", space)  # noqa: S102 (its own source)
    return space[name]


def _own(module: str, name: str) -> Any:
    return getattr(import_module(module), name)


def _path(module: str) -> Path:
    spec = find_spec(module)
    return Path(spec.origin if spec is not None and spec.origin is not None else "")


@cache
def _statements(module: str) -> dict[str, ast.stmt]:
    """The statements of a module that give its names."""
    path = _path(module)
    tree = ast.parse(path.read_bytes() if path.is_file() else b"")
    return {name: statement for statement in tree.body for name in _given(statement)}


def _given(statement: ast.stmt) -> Iterator[str]:
    if isinstance(statement, (ast.Import, ast.ImportFrom)):
        yield from (each.asname or each.name.partition(".")[0] for each in statement.names)
    elif isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
        yield statement.name
    elif isinstance(statement, (ast.Assign, ast.AnnAssign)):
        targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
        yield from (each.id for target in targets for each in ast.walk(target) if isinstance(each, ast.Name))


def _names(module: str, node: ast.AST) -> set[str]:
    """The names of a module that a node needs."""
    return {each.id for each in ast.walk(node) if isinstance(each, ast.Name)} & _statements(module).keys()


def _value(module: str, name: str) -> Any:
    """A name of a module: what is assigned is worked out by itself, functions and classes are imported from where they stand."""
    stated = _statements(module).get(name)
    if isinstance(stated, ast.ImportFrom) and (stated.module or "").startswith("flexstage.") and not stated.level:
        return _imported(stated, name)
    if isinstance(stated, (ast.Assign, ast.AnnAssign)) and stated.value is not None:
        needed = {each: _value(module, each) for each in _names(module, stated.value)}
        exec(compile(ast.Module([stated], []), _path(module), "exec"), needed)  # noqa: S102 (its own source)
        return needed[name]
    if isinstance(stated, (ast.Import, ast.ImportFrom)):
        space: dict[str, Any] = {}
        exec(compile(ast.Module([stated], []), _path(module), "exec"), space)  # noqa: S102 (its own source)
        return space[name]
    return _own(module, name)


def _imported(stated: ast.ImportFrom, name: str) -> Any:
    """A name that a module imports from another one of this package, perhaps under its own name or as a whole module."""
    original = next(each.name for each in stated.names if (each.asname or each.name) == name)
    home = stated.module or ""
    return _value(home, original) if original in _statements(home) else _member(home, original)


def _member(package: str, name: str) -> Any:
    try:
        return import_module(f"{package}.{name}")
    except ModuleNotFoundError:
        return _own(package, name)
