"""The imports of the package, those by a name in a string included, and its layers as the contract in pyproject.toml states them."""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from functools import cache
from pathlib import Path

import grimp

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "flexstage"
LOADERS = ("import_module", "LazyModule", "find_spec", "__import__")
"""Functions that take the name of a module."""
_TABLE = "lazy_attributes"
_NAME = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*(:\w+)?")
_LIKELY = re.compile(rf"\b({'|'.join((*LOADERS, _TABLE))})\b|[\"']{PACKAGE}\.\w|\w:\w+[\"']")


@cache
def layers() -> dict[str, tuple[int, bool]]:
    """Return the level of each package, 0 for the lowest, and whether it may import others of its level."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    floors = next(each["layers"] for each in contracts if each["id"] == "floors")
    levels = {name: (level, ":" in layer) for level, layer in enumerate(reversed(floors)) for name in re.findall(r"\w+", layer)}
    return levels | {PACKAGE: (len(floors), False)}


def package_of(module: str) -> str:
    """Return the package of a module below the root; the root itself is its own."""
    return f"{module}.".split(".")[1] or PACKAGE


def points_up(importer: str, imported: str) -> bool:
    """Whether an import points to a higher level, or to an independent package of the same one. The root is above all."""
    here, there = package_of(importer), package_of(imported)
    (level, is_open), (other, _) = layers()[here], layers()[there]
    return other > level or (other == level and here != there and not is_open)


@cache
def import_graph() -> grimp.ImportGraph:
    """Return all imports within the package: those within functions, those for type checkers, and those by name."""
    graph = grimp.build_graph(PACKAGE, cache_dir=None)
    modules = frozenset(graph.modules)
    for module in sorted(modules):
        for name in named_modules(module, path_of(module), modules):
            graph.add_import(importer=module, imported=name)
    return graph


def path_of(module: str) -> Path:
    """Return the file of a module."""
    path = ROOT / "src" / module.replace(".", "/")
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def named_modules(module: str, path: Path, modules: AbstractSet[str]) -> set[str]:
    """Return the modules that the strings of a file name.

    These are absolute names, `module:name` absolute or below the file's package, and the keys of a table of lazy attributes.
    """
    text = path.read_text(encoding="utf-8")
    if not _LIKELY.search(text):
        return set()
    tree, package = ast.parse(text), module if path.stem == "__init__" else module.rpartition(".")[0]
    constants = _constants(tree)
    prefixes = {constants.get(_id(node.value)) for node in ast.walk(tree) if isinstance(node, ast.FormattedValue)}
    texts = {found for node in ast.walk(tree) if (found := text_of(node, constants)) and _NAME.fullmatch(found)} - prefixes
    names = {each.partition(":")[0] for each in texts if each.startswith(f"{PACKAGE}.")}
    names |= {f"{package}.{each.partition(':')[0]}" for each in texts if ":" in each}
    names |= {f"{package}.{each}" for each in _lazy_homes(tree)}
    return {name for name in names & modules if name != module}


def unread_loaders(path: Path) -> Iterator[int]:
    """Yield the lines of calls that load a module whose name the file does not state as one string."""
    text = path.read_text(encoding="utf-8")
    if not _LIKELY.search(text):
        return
    tree = ast.parse(text)
    constants = _constants(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and _called(node) in LOADERS and not (node.args and text_of(node.args[0], constants)):
            yield node.lineno


def text_of(node: ast.AST, constants: dict[str, str]) -> str | None:
    """Return the string that an expression is, or is made of by an f-string of constants; `None` where it is another thing."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else None
    if isinstance(node, ast.Name):
        return constants.get(node.id)
    if isinstance(node, ast.JoinedStr):
        parts = [text_of(each.value if isinstance(each, ast.FormattedValue) else each, constants) for each in node.values]
        return None if None in parts else "".join(map(str, parts))
    return None


def _constants(tree: ast.Module) -> dict[str, str]:
    """The strings that the names of a module stand for."""
    assigned = [node for node in tree.body if isinstance(node, ast.Assign)]
    return {_id(node.targets[0]): text for node in assigned if (text := text_of(node.value, {}))}


def _lazy_homes(tree: ast.Module) -> Iterator[str]:
    tables = {_called(node): node.args[1] for node in ast.walk(tree) if isinstance(node, ast.Call) and len(node.args) > 1}
    table = tables.get(_TABLE)
    for node in tree.body:
        if isinstance(node, ast.Assign) and table is not None and _id(node.targets[0]) == _id(table):
            yield from ast.literal_eval(node.value)


def _called(node: ast.Call) -> str:
    return node.func.attr if isinstance(node.func, ast.Attribute) else _id(node.func)


def _id(node: ast.AST) -> str:
    return node.id if isinstance(node, ast.Name) else ""
