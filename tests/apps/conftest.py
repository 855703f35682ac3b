"""Fixtures of the command line's tests: a folder with a design, and a function that runs commands in it."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest

from tests.apps.command import Command, command_in, design_in


@pytest.fixture
def flexstage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfdbinary: Any) -> Command:
    """Runs `flexstage ARGUMENTS...` in a folder that holds the shipped stage as stage.toml."""
    design_in(tmp_path)
    return command_in(tmp_path, monkeypatch, capfdbinary)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are put together and not drawn, for tests of reports that ask nothing of their pictures: drawing is half of a report."""
    from matplotlib.figure import Figure

    drawn = Figure.savefig

    def save(figure: Figure, target: Any, **options: Any) -> None:
        if isinstance(target, io.StringIO):
            target.write('<svg viewBox="0 0 1 1"></svg>')
        else:
            drawn(figure, target, **options)

    monkeypatch.setattr(Figure, "savefig", save)
