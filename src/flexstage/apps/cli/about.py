"""Commands about the installation: `doctor` and `version`."""

from __future__ import annotations

import platform
from typing import Annotated

import typer

import flexstage
from flexstage.apps.cli import installation
from flexstage.show.command.terminal import say


def doctor(*, mend: Annotated[bool, typer.Option("--mend", help="Mend what can be mended, then examine again.")] = False) -> None:
    """Examine the installation and mend it.

    Python, packages, threads, folders, a computation with a known result. Exit code 2 if anything is bad.
    """
    raise typer.Exit(installation.consult(mending=mend))


def version() -> None:
    """Print the version of flexstage."""
    say(f"flexstage {flexstage.__version__}, Python {platform.python_version()}, {platform.system()} {platform.machine()}")
