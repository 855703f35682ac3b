"""Sphinx configuration: MyST Markdown, furo theme; built with -W, so every warning is an error. Nothing is fetched."""

from __future__ import annotations

import ast
import re
import sys
from collections import Counter
from importlib import import_module
from pathlib import Path

from sphinx.application import Sphinx

import flexstage

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tools.imports import import_graph, layers, package_of, points_up

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

smartquotes_action = "qe"  # options such as --list keep both hyphens
html_theme = "furo"
html_title = "flexstage"
html_search_scorer = str(Path(__file__).with_name("search_scorer.js"))  # ranks pages for developers last
exclude_patterns = ["_build", "archive"]
suppress_warnings: list[str] = []
nitpicky = False


LAYERS = [name for name in layers() if name not in {"flexstage", "__main__"}]


def setup(app: Sphinx) -> None:
    """Write the pages that are made from the code before pages are read: package structure and reference; stages that turn."""
    app.connect("builder-inited", write_pages)
    app.connect("source-read", let_turn)
    app.connect("build-finished", write_stages)
    app.connect("autodoc-process-docstring", plain)


def write_pages(app: Sphinx) -> None:
    """The package structure, and a page of the reference for each chapter."""
    pages = {"map": structure(), "api/index": contents()} | {f"api/{each}": chapter(each) for each in CHAPTERS}
    for name, text in pages.items():
        path = Path(app.srcdir, f"{name}.md")
        path.parent.mkdir(exist_ok=True)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


TURNED = re.compile(r"<!-- turn ([\w-]+)( here)? -->")
_LINK = '<p><a href="stages/{0}.html">Turn this stage, and play its modes</a></p>'
_FRAME = '<iframe src="stages/{0}.html" title="{0}" loading="lazy" style="width:100%;height:480px;border:0"></iframe>'


def let_turn(app: Sphinx, _page: str, source: list[str]) -> None:
    """Where a page says `<!-- turn NAME -->`, a link to the stage that turns, or the stage itself (`here`)."""
    if app.builder.format == "html":
        source[0] = TURNED.sub(lambda found: f"```{{raw}} html\n{(_FRAME if found[2] else _LINK).format(found[1])}\n```", source[0])


def write_stages(app: Sphinx, error: Exception | None) -> None:
    """The stages that turn, a page each, which stands alone."""
    if error is None and app.builder.format == "html":
        folder = Path(app.outdir, "stages")
        folder.mkdir(exist_ok=True)
        pages = Path(app.srcdir).glob("*.md")
        for name in sorted({found[1] for page in pages for found in TURNED.finditer(page.read_text(encoding="utf-8"))}):
            flexstage.view(flexstage.case(name)).save(folder / f"{name}.html")


def names(part: str) -> dict[str, str]:
    """The public names of a wing or floor and how they are written in a program."""
    if part in flexstage.WINGS:
        homes, space = getattr(flexstage, part).HOMES.values(), f"flexstage.{part}"
    else:
        homes, space = (each for home, each in flexstage.HOMES.items() if home.split(".")[0] == part), "flexstage"
    return {name: f"{space}.{name}" for each in homes for name in each.split()}


CHAPTERS = [each for each in LAYERS if names(each)]


def contents() -> str:
    """The first page of the reference."""
    return f"""# Reference

`import flexstage as fs`: what describes a stage, models it and analyses it is in `fs` itself, the rest in `fs.solid`, `fs.experiment`,
`fs.control` and `fs.studies`. Chapters are in the order of the layers, lowest first. Types of results, and steps of others' work, are
imported from their modules ([package structure](../map.md)).

```{{toctree}}
:maxdepth: 1

{chr(10).join(CHAPTERS)}
```
"""


def chapter(part: str) -> str:
    """The reference of a floor or wing: units as a list, all else with its docstring."""
    found = {name: getattr(import_module(path.rpartition(".")[0]), name) for name, path in names(part).items()}
    constants = [name for name, value in found.items() if not callable(value)]
    first = (import_module(f"flexstage.{part}").__doc__ or "").partition("\n")[0]
    lines = [f"# {'fs.' if part in flexstage.WINGS else ''}{part}", "", first, ""]
    if constants:
        lines += ["Units and directions, numbers in SI to multiply with: " + ", ".join(f"`fs.{name}`" for name in constants) + ".", ""]
    for name, value in found.items():
        if name not in constants:
            lines += [f"## {name}", "", "```{eval-rst}", f".. auto{kind(value)}:: {names(part)[name]}", "```", ""]
    return "\n".join(lines)


def kind(value: object) -> str:
    """What autodoc calls it."""
    return ("exception" if issubclass(value, Exception) else "class") if isinstance(value, type) else "function"


def plain(_app: Sphinx, _what: str, _name: str, _object: object, _options: object, lines: list[str]) -> None:
    """Docstrings are plain text: signs that mean something to Sphinx stand for themselves, names in backticks are code."""
    lines[:] = [line if line.lstrip().startswith((">>>", "...")) else literal(line) for line in lines]


def literal(line: str) -> str:
    """A line of plain text as reStructuredText."""
    indent, parts = line[: len(line) - len(line.lstrip())], line.lstrip().split("`")
    return indent + "".join(f"``{part}``" if odd % 2 else re.sub(r"([\\*|_])", r"\\\1", part) for odd, part in enumerate(parts))


def structure() -> str:
    """The imports between packages as a table, the largest folders, and every module with its first line, layer by layer."""
    lines = ["# Package structure", "", *imports_table(), "", *folders_table()]
    package = Path(flexstage.__file__).parent
    for layer in reversed(LAYERS):
        lines += ["", f"## {layer}", ""]
        for path in sorted((package / layer).rglob("*.py")):
            first = (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n")[0]
            lines.append(f"- `{path.relative_to(package).as_posix()}`: {first}")
    return "\n".join(lines) + "\n"


def imports_table() -> list[str]:
    """How often each package imports each other one, highest layer first. Raises `RuntimeError` for an import that points upwards."""
    graph = import_graph()
    edges = [(importer, each) for importer in graph.modules for each in graph.find_modules_directly_imported_by(importer)]
    if upward := [f"{importer} -> {imported}" for importer, imported in edges if points_up(importer, imported)]:
        raise RuntimeError(f"imports point upwards: {', '.join(upward)}")
    counts = Counter((package_of(importer), package_of(imported)) for importer, imported in edges)
    order = LAYERS[::-1]
    lines = [
        "Number of imports by modules of the row's package of modules of the column's: statements, also those within functions, and",
        "modules named in a string. Packages are in the order of the layers, highest first; no import points upwards.",
        "",
        f"| | {' | '.join(order)} |",
        f"|---|{'---:|' * len(order)}",
    ]
    return lines + [f"| **{row}** | {' | '.join(str(counts[row, column] or '') for column in order)} |" for row in order]


def folders_table() -> list[str]:
    """Folders of more than fifteen modules, the largest first."""
    package = Path(flexstage.__file__).parent
    counts = Counter(path.parent.relative_to(package).as_posix() for path in package.rglob("*.py"))
    rows = [f"| `{folder}` | {count} |" for folder, count in counts.most_common() if count > 15]
    return ["| folder of more than fifteen modules | modules |", "|---|---:|", *rows]
