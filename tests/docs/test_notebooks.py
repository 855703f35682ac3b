"""The notebooks of the tutorials are those of their pages, and run from top to bottom."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from tools.notebooks import PAGES, TUTORIALS, notebook


@pytest.mark.parametrize("page", PAGES)
def test_the_notebook_is_that_of_the_page(page):
    assert (TUTORIALS / f"{page}.ipynb").read_text(encoding="utf-8") == notebook(page), "run python -m tools.notebooks"


@pytest.mark.parametrize("page", PAGES)
def test_every_cell_runs(page, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", ""))))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    document = nbformat.read(TUTORIALS / f"{page}.ipynb", as_version=4)
    NotebookClient(document, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
