"""Commands about the installation: `doctor` and `version`."""

from __future__ import annotations

import platform

import typer

from flexstage.apps import installation
from flexstage.base.version import __version__
from flexstage.show.command.terminal import print_result


def doctor() -> None:
    """Examine the installation.

    Checks Python, packages, threads, folders and a computation with a known result. Prints a command to fix each error. Exit
    code 2 if there is an error.
    """
    raise typer.Exit(installation.consult())


def version() -> None:
    """Print the version of flexstage."""
    print_result(f"flexstage {__version__}, Python {platform.python_version()}, {platform.system()} {platform.machine()}")
