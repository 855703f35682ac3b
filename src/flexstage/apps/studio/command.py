"""The command `studio`: a stage in a window of the browser, edited and computed interactively."""

from __future__ import annotations

import asyncio
import webbrowser
from typing import Annotated

import typer

from flexstage.apps.studio.server import run
from flexstage.show.command.options import Design, Port
from flexstage.show.command.terminal import print_note


def studio(
    design: Design,
    *,
    port: Port = 0,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open a browser window; with --no-browser, print only the address.")
    ] = True,
) -> None:
    """Open a stage in the browser, and edit it.

    The page is served to this computer only, at an address with a secret key. Ctrl+C ends the command.

    A file with errors can be opened too; the errors are shown at their lines.
    """

    def started(url: str) -> None:
        print_note(f"Studio of {design}: {url}")
        print_note("Ctrl+C ends it.")
        if browser and not webbrowser.open(url):
            print_note("No browser was found: open this address.")

    try:
        asyncio.run(run(design, port, started))
    except KeyboardInterrupt:
        print_note("The studio has ended.")
