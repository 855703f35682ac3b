"""Sphinx configuration: MyST Markdown, furo theme; built with -W, so every warning is an error. Nothing is fetched."""

from __future__ import annotations

import ast
from pathlib import Path

from sphinx.application import Sphinx

import flexstage

project = "flexstage"
author = "The flexstage authors"
copyright = "2026, the flexstage authors"
release = flexstage.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_enable_extensions = ["colon_fence", "deflist"]  # formulas are plain text: MathJax would be fetched when a page is read
myst_heading_anchors = 3

# autodoc shows objects where they live, not where the lazy table hands them out.
autodoc_member_order = "bysource"
autodoc_typehints = "description"

html_theme = "furo"
html_title = "flexstage"
exclude_patterns = ["_build"]
suppress_warnings: list[str] = []
nitpicky = False


FLOORS = ["apps", "studies", "control", "experiment", "solid", "show", "analysis", "models", "cases"]
FLOORS += ["beams", "mechanism", "parts", "spatial", "base"]


def setup(app: Sphinx) -> None:
    """Write the map of the house from the modules' first lines before pages are read."""
    app.connect("builder-inited", lambda app: Path(app.srcdir, "map.md").write_text(house_map(), encoding="utf-8"))


def house_map() -> str:
    """Every module with its first line, floor by floor."""
    package = Path(flexstage.__file__).parent
    lines = [
        "# Map of the house",
        "",
        "Every concept has one home: look here before writing something anew. Imports go down the floors only.",
    ]
    for floor in FLOORS:
        lines += ["", f"## {floor}", ""]
        for path in sorted((package / floor).rglob("*.py")):
            first = (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n")[0]
            lines.append(f"- `{path.relative_to(package).as_posix()}`: {first}")
    return "\n".join(lines) + "\n"
