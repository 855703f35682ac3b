"""Runs the blocks of a page (see `pages`), as a reader would: in order, in a folder of their own."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import tomlkit

from flexstage.apps.cli import run
from flexstage.mechanism.store import load
from tests.docs.pages import Block, commands, path_of
from tests.hygiene.source import ROOT

_SHELLS = ("sh", "bash", "console", "shell")
_PROGRAM = re.compile(r"(\.venv/bin/)?flexstage( |$)")
_FOR_A_SHELL = re.compile(r"[|<>;&$]")
_UNCHECKED = ("", "text", "diff", "json", "html", "matlab", "make")


class Runner:
    """A reader of one page: its folder, its Python names, and what the last block printed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.names: dict[str, Any] = {"__name__": "__main__"}
        self.printed = ""

    def run(self, block: Block) -> None:
        """Do what a block says; fails with the page and line."""
        try:
            self._do(block)
        except Exception as error:
            error.add_note(f"in {block.where}")
            raise

    def _do(self, block: Block) -> None:
        if (name := block.word("file")) is not None:
            path_of(self.folder, name).write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            self._python(block)
        elif block.language in _SHELLS or (not block.language and _PROGRAM.match(block.text)):
            self._shell(block)
        elif block.language == "toml":
            self._toml(block)
        elif "output" in block.words:
            _compare(block, self.printed)
        else:
            assert block.language in _UNCHECKED, f"{block.where}: what is to be done with a block of {block.language}?"

    def _python(self, block: Block) -> None:
        code = compile("\n" * block.line + block.text, str(ROOT / block.page), "exec")
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(code, self.names)  # noqa: S102 (the examples of our own pages)
        self.printed = printed.getvalue()

    def _shell(self, block: Block) -> None:
        self.printed = ""
        for line in commands(block.text):
            if _PROGRAM.match(line):
                self.printed += self._flexstage(block, line)
            else:
                _known(block, line)

    def _flexstage(self, block: Block, line: str) -> str:
        expected = int(block.word("exit") or 0)
        whole = line.startswith(".venv/") or _FOR_A_SHELL.search(line)
        code, printed = (_in_a_shell if whole else _in_this_process)(line, self.folder)
        if code != expected:
            pytest.fail(f"{block.where}: exit code {code}, expected {expected}\n$ {line}\n{printed}", pytrace=False)
        return printed

    def _toml(self, block: Block) -> None:
        said = [(key, name) for key in ("add", "into", "mistake") if (name := block.word(key))]
        assert len(said) == 1, f"{block.where}: say what the file is: file=..., add=..., into=... or mistake=..."
        ((key, name),) = said
        if key == "add":
            path = self.folder / name
            path.write_text(_laid(block, path), encoding="utf-8")
            load(path)
        else:
            self._tried(block, name, wrong=key == "mistake")

    def _tried(self, block: Block, name: str, *, wrong: bool) -> None:
        """Lay a piece over a file of the page, then load it, or show what the command says of it; the file itself stays."""
        path = self.folder / name
        whole = path.read_text(encoding="utf-8")
        try:
            path.write_text(_laid(block, path), encoding="utf-8")
            if wrong:
                self._shell(Block(block.page, block.line, "sh", ("exit=2",), f"flexstage check {name}"))
            else:
                load(path)
        finally:
            path.write_text(whole, encoding="utf-8")


def _in_this_process(line: str, folder: Path) -> tuple[int, str]:
    """Run a command line without a process of its own: a hundred of them would cost minutes."""
    printed = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)
    with contextlib.chdir(folder), contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        code = run(shlex.split(line, comments=True)[1:])
    return code, printed.buffer.getvalue().decode()


def _in_a_shell(line: str, folder: Path) -> tuple[int, str]:
    """Run it as the installed program, through a shell."""
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", line.removeprefix(".venv/bin/")],
        cwd=folder,
        env=_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout


def _environment() -> dict[str, str]:
    """That of the tests, with this interpreter's programs first, warnings as errors and no terminal."""
    programs = str(Path(sys.executable).parent)
    path = os.pathsep.join((programs, os.environ.get("PATH", "")))
    return {**os.environ, "PATH": path, "PYTHONWARNINGS": "error", "MPLBACKEND": "Agg", "COLUMNS": "140", "TERM": "dumb"}


def _known(block: Block, line: str) -> None:
    """What is not ours is not run, but a target of make must exist."""
    words = line.split()
    assert words[0] in ("make", "cd", "pip", ".venv/bin/pip"), f"{block.where}: a test cannot know whether this works: {line}"
    if words[0] == "make":
        makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
        assert re.search(rf"^{re.escape(words[1])}:", makefile, re.MULTILINE), f"{block.where}: there is no target {words[1]}"


def _laid(block: Block, path: Path) -> str:
    """A file's text with the piece laid over it."""
    return tomlkit.dumps(_merged(tomllib.loads(path.read_text(encoding="utf-8")), tomllib.loads(block.text)))


def _merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    result = dict(below)
    for key, value in above.items():
        inner = result.get(key)
        result[key] = _merged(inner, value) if isinstance(inner, dict) and isinstance(value, dict) else value
    return result


def _compare(block: Block, printed: str) -> None:
    pieces = (re.escape(" ".join(piece.split())) for piece in block.text.split("..."))
    if not re.fullmatch(".*?".join(pieces), " ".join(printed.split())):
        pytest.fail(f"{block.where}: the page says\n{block.text}\nbut this is printed\n{printed}", pytrace=False)
