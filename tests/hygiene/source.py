"""What the hygiene tests look at: the repository's files and their syntax trees."""

from __future__ import annotations

import ast
import functools
import subprocess
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SRC = ROOT / "src" / "flexstage"

Function = ast.FunctionDef | ast.AsyncFunctionDef


def expect_none(found: Iterable[str], advice: str) -> None:
    """Fail with every finding on its own line, and what to do."""
    listed = sorted(found)
    if listed:
        pytest.fail("\n".join([*listed, f"-> {advice}"]), pytrace=False)


@dataclass(frozen=True)
class Defined:
    """A class or function of a file: its dotted `name`, whether it `is_public` and whether it stands within a function or a class."""

    path: Path
    name: str
    node: Function | ast.ClassDef
    owner: ast.AST

    @property
    def where(self) -> str:
        return f"{self.path.relative_to(ROOT)}:{self.node.lineno} {self.name}"

    @property
    def is_public(self) -> bool:
        inner = any(part.startswith("_") for part in self.name.split("."))
        return not inner and not isinstance(self.owner, Function)


@functools.cache
def tracked() -> tuple[Path, ...]:
    """Files under version control; in an unpacked archive without it, the files there are."""
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        paths = [ROOT / name for name in done.stdout.split("\0") if name]
    else:
        paths = [path for path in ROOT.rglob("*") if not any(part.startswith(".") for part in path.relative_to(ROOT).parts)]
    return tuple(path for path in paths if path.is_file())


@functools.cache
def modules() -> tuple[Path, ...]:
    """The package's files, packages' `__init__` included."""
    return tuple(sorted(path for path in SRC.rglob("*.py") if "__pycache__" not in path.parts))


@functools.cache
def tree(path: Path) -> ast.Module:
    """A file's syntax tree."""
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


def defined(path: Path) -> Iterator[Defined]:
    """All classes and functions of a file, nested ones too."""
    yield from _defined(path, tree(path), "")


def _defined(path: Path, owner: ast.AST, prefix: str) -> Iterator[Defined]:
    for child in ast.iter_child_nodes(owner):
        if isinstance(child, Function | ast.ClassDef):
            yield Defined(path, prefix + child.name, child, owner)
            yield from _defined(path, child, f"{prefix}{child.name}.")
        elif not isinstance(child, ast.expr):
            yield from _defined(path, child, prefix)
