"""Lists of fields in docs/json.md: `python -m tools.json_page` writes them anew from the results themselves.

A list stands below the line that names the result, `<!-- fields of flexstage.analysis.dynamics.modes.Modes -->`, as far as the next
empty line.
"""

from __future__ import annotations

import importlib
import re
from pathlib import Path

from flexstage.base.record import explanation, paths

PAGE = Path(__file__).resolve().parents[1] / "docs" / "json.md"
_LIST = re.compile(r"(<!-- fields of (\S+)\.(\w+)(?: in (\S+))? -->\n)(?:\|.*\n)*")


def written(page: str) -> str:
    """The page with its lists as the results are now."""
    return _LIST.sub(lambda found: found[1] + _list(found[2], found[3], found[4]), page)


def _list(module: str, name: str, within: str | None) -> str:
    kind = getattr(importlib.import_module(module), name)
    rows = [(f"`{path}`", word, meaning) for path, word, meaning in paths(kind, f"{within}." if within else "")]
    lines = [" | ".join(text.replace("|", "\\|") for text in row) for row in [("", "", explanation(kind)), *rows]]
    return "\n".join(["| Path | Value | Meaning |", "|---|---|---|", *(f"| {line} |" for line in lines), ""])


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
