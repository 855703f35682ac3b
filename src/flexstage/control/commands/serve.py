"""The command `serve`: a simulated closed-loop stage that laboratory programs control over a socket."""

from __future__ import annotations

import asyncio
from typing import Annotated

import typer

from flexstage.control.loop_options import Setup
from flexstage.control.serve.controller import StageController
from flexstage.control.serve.server import HOST, PORT, run
from flexstage.control.study.file import load_setup
from flexstage.control.study.setup import LoopSetup
from flexstage.show.command.design import open_design
from flexstage.show.command.options import Changes, Design, Port
from flexstage.show.command.terminal import print_note


def serve(
    design: Design,
    *,
    setup: Setup = None,
    port: Port = PORT,
    realtime: Annotated[bool, typer.Option("--realtime/--no-realtime", help="Real time, or as fast as it is computed.")] = True,
    changes: Changes = None,
) -> None:
    """Run a stage as a virtual controller that programs drive over TCP.

    The stage is under its loop, as flexstage loop simulates it. It speaks a part of the General Command Set 2.0 to this computer
    alone (see the documentation for the commands); Ctrl+C ends it.
    """
    asked = LoopSetup() if setup is None else load_setup(setup)
    stage = StageController(open_design(design, changes), asked)

    def started(where: int) -> None:
        print_note(f"{stage.name} at {HOST}:{where}: axes {', '.join(stage.axes)}, {1.0 / stage.step:g} samples a second. Ctrl+C ends it.")

    began = stage.seconds
    pace = asyncio.run(run(stage, port, started, paced=realtime))
    told = "" if pace is None else f"; at most {1e3 * pace.most:.3g} ms late, {pace.lost:.3g} s given up"
    print_note(f"The stage ran for {stage.seconds - began:.3g} s{told}.")
