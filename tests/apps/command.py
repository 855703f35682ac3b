"""Running the command line in this process, as its entry point does."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from flexstage.apps.cli import run
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import case
from flexstage.mechanism.store import dumps


@dataclass(frozen=True)
class Ended:
    """How a command ended: exit code, stdout, stderr."""

    code: int
    out: str
    err: str

    @property
    def document(self) -> Any:
        """Stdout as one JSON document; NaN and infinity are no JSON."""
        return json.loads(self.out, parse_constant=_no_constant)


def _no_constant(name: str) -> Any:
    raise ValueError(f"{name} is no JSON")


Command = Callable[..., Ended]


def _is_combined(warning: str, text: str) -> bool:
    """Whether a text has the worst of several warnings that differ in their values only."""
    words = r"[\d.]+".join(map(re.escape, re.split(r"[\d.]+", warning)))
    return re.search(rf"\(worst of \d+\): {words}", text) is not None


def told_everywhere(ended: Ended, document: Path, report: Path) -> str:
    """All warnings of a document, each of which the terminal and the report tell too."""
    found = json.loads(document.read_text(encoding="utf-8"))
    said = [each if isinstance(each, str) else each["what"] for each in (*found["warnings"], *found.get("data_warnings", ()))]
    page = html.unescape(report.read_text(encoding="utf-8")).replace("\N{MINUS SIGN}", "-")
    for place in (ended.out + ended.err, page):
        assert [each for each in said if each not in place and not _is_combined(each, place)] == []
    return "\n".join(said)


def command_in(folder: Path, monkeypatch: pytest.MonkeyPatch, capfdbinary: Any) -> Command:
    """A function that runs `flexstage ARGUMENTS...` in a folder."""

    def ended(*arguments: str) -> Ended:
        monkeypatch.chdir(folder)
        capfdbinary.readouterr()
        code = run(arguments)
        captured = capfdbinary.readouterr()
        return Ended(code, captured.out.decode(), captured.err.decode())

    return ended


def design_in(folder: Path, name: str = "double-triangle") -> Path:
    """A shipped case as `stage.toml` in a folder."""
    path = folder / "stage.toml"
    path.write_bytes(_design_file(name))
    return path


@cache
def _design_file(name: str) -> bytes:
    stage = double_triangle() if name == "double-triangle" else case(name)  # plain numbers, which tests change in the text
    return dumps(stage).encode("utf-8")
