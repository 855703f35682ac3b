"""The pages of the documentation as what a reader types: fenced blocks, run from top to bottom in one folder a page.

The first word behind a fence is the language; the words after it, which no renderer shows, say what a test does with the block:

    python                  run; the blocks of a page share one namespace
    sh                      lines that start with `flexstage` are run and must leave with exit code 0; `make` lines name an existing target
    sh exit=2               they must leave with that exit code
    toml file=guide.toml    a whole file (of any language): written into the page's folder
    toml add=guide.toml     a piece of a file: laid over that file, which must load
    toml into=guide.toml    the same, and afterwards the file is as it was
    toml mistake=guide.toml the same too, but `flexstage check` must refuse it; what it prints is the output
    text output             what the block before it prints, "..." for anything; white space is not compared
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from pathlib import Path

from tests.hygiene.source import ROOT

_FENCE = re.compile(r"^(?P<fence>`{3,})(?P<info>[^`]*)$")


@dataclass(frozen=True)
class Block:
    """A fenced block: where it starts, its language, the words behind it and its text."""

    page: str
    line: int
    language: str
    words: tuple[str, ...]
    text: str

    @property
    def where(self) -> str:
        return f"{self.page}:{self.line}"

    def word(self, key: str) -> str | None:
        """The value of `key=value` among the words."""
        return next((word.partition("=")[2] for word in self.words if word.startswith(f"{key}=")), None)


@functools.cache
def pages() -> tuple[str, ...]:
    """README.md and every page of docs, by path."""
    found = (path for path in (ROOT / "docs").rglob("*.md") if "_build" not in path.parts)
    return ("README.md", *sorted(path.relative_to(ROOT).as_posix() for path in found))


@functools.cache
def blocks(page: str) -> tuple[Block, ...]:
    """The fenced blocks of a page in order; MyST's directives ({toctree} and the like) are left out."""
    found: list[Block] = []
    lines = iter(enumerate((ROOT / page).read_text(encoding="utf-8").splitlines(), start=1))
    for number, line in lines:
        if (opened := _FENCE.match(line)) is None:
            continue
        text = _until(lines, opened["fence"])
        language, *words = opened["info"].split() or [""]
        if not language.startswith("{"):
            found.append(Block(page, number, language, tuple(words), text))
    return tuple(found)


def _until(lines, fence: str) -> str:
    body: list[str] = []
    for _, line in lines:
        if line.strip() == fence:
            return "".join(f"{each}\n" for each in body)
        body.append(line)
    raise ValueError(f"a fence {fence} is not closed")


def commands(text: str) -> list[str]:
    """The lines of a shell block, continued ones joined, comments and blank lines left out."""
    joined = re.sub(r"\\\n\s*", "", text)
    return [line.strip() for line in joined.splitlines() if line.strip() and not line.lstrip().startswith("#")]


def path_of(folder: Path, name: str) -> Path:
    """A file in the page's folder, its own folders made."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    return path
