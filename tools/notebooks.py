"""The notebooks of the tutorials: `python -m tools.notebooks` writes them from the pages; tests compare and run them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.docs.pages import Block, blocks

TUTORIALS = Path(__file__).resolve().parents[1] / "docs" / "tutorials"
PAGES = ("leaf-guide", "voice-coil-loop", "measured-record")
_FENCED = re.compile(r"^```[^\n]*\n.*?^```\n", re.MULTILINE | re.DOTALL)


def notebook(page: str) -> str:
    """The notebook of a page as JSON: its prose, and its blocks as cells; outputs are left out."""
    return json.dumps(_document(page), indent=1, ensure_ascii=False) + "\n"


def _document(page: str) -> dict[str, Any]:
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    cells = [{"id": f"{page}-{number}", **cell} for number, cell in enumerate(_cells(page))]
    return {"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}


def _cells(page: str) -> Iterator[dict[str, Any]]:
    text = (TUTORIALS / f"{page}.md").read_text(encoding="utf-8")
    found = iter(blocks(f"docs/tutorials/{page}.md"))
    for prose in _FENCED.split(text):
        if prose.strip():
            yield {"cell_type": "markdown", "metadata": {}, "source": _lines(prose.strip())}
        if (block := next(found, None)) is not None and "output" not in block.words:
            yield _cell(block)


def _cell(block: Block) -> dict[str, Any]:
    """A block as a cell: files are written, commands run by bash, Python is run, and text is shown."""
    code = block.text.rstrip()
    if (name := block.word("file")) is not None:
        code = f"%%writefile {name}\n{code}"
    elif block.language == "sh":
        code = f"%%bash\nset -e\n{code}"
    elif block.language != "python":
        return {"cell_type": "markdown", "metadata": {}, "source": _lines(f"```{block.language}\n{code}\n```")}
    return {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": [], "source": _lines(code)}


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


def main() -> None:
    """Write all notebooks."""
    for page in PAGES:
        (TUTORIALS / f"{page}.ipynb").write_text(notebook(page), encoding="utf-8")


if __name__ == "__main__":
    main()
