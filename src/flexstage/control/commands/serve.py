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
    realtime: Annotated[bool, typer.Option("--realtime/--no-realtime", help="Simulation in real time, or as fast as possible.")] = True,
    changes: Changes = None,
) -> None:
    """Serve a virtual controller of a stage over TCP.

    Simulates the same loop as flexstage loop. Programs on this computer can send commands of the General Command Set 2.0 to the
    controller. Ctrl+C ends the command.
    """
    asked = LoopSetup() if setup is None else load_setup(setup)
    stage = StageController(open_design(design, changes), asked)

    def started(where: int) -> None:
        print_note(f"{stage.name} at {HOST}:{where}: axes {', '.join(stage.axes)}, {1.0 / stage.step:g} samples a second. Ctrl+C ends it.")

    began = stage.seconds
    pace = asyncio.run(run(stage, port, started, paced=realtime))
    told = "" if pace is None else f"; at most {1e3 * pace.most:.3g} ms behind real time, {pace.lost:.3g} s skipped"
    print_note(f"The stage ran for {stage.seconds - began:.3g} s{told}.")
