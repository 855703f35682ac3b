"""The command line: `flexstage ...`. Translates requests; no physics. Nothing heavy is loaded before a command is called.

`commands` is the table of all commands; their modules are in `apps.commands` and in `commands` of the other packages. A command's module
imports what commands share from `show.command`, and neither another command nor the table.
"""

from __future__ import annotations

import atexit
import contextlib
import gc
import os
import signal
import sys
from collections.abc import Sequence

from flexstage.show.command.failure import ENDINGS, MISSED, SIGNALLED, run_guarded


def main() -> None:
    """Run the command of this process and leave with its exit code; signals to end it end it as Ctrl-C does."""
    for number in ENDINGS:
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _end)
    gc.set_threshold(500_000, 50, 50)  # a twentieth of a command's time goes into looking for cycles that are not there
    code = MISSED  # of an exception that leaves with its traceback
    atexit.register(lambda: _leave(code))  # first in, last out
    code = run(sys.argv[1:])
    sys.exit(code)


def _leave(code: int) -> None:
    """End the process without taking all that it has in memory apart, piece by piece: a twentieth of a command's time."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):  # whoever read it has gone, or closed it
            stream.flush()
    os._exit(code)


def _end(number: int, _frame: object) -> None:
    """Leave through everything that cleans up, undisturbed by a second signal."""
    for each in ENDINGS:
        signal.signal(each, signal.SIG_IGN)
    sys.exit(SIGNALLED + number)


def run(arguments: Sequence[str]) -> int:
    """Run a command line and return its exit code.

    0 done, 1 requirement missed (`--strict`), 2 bad input, no place for the output or interrupted, 70 a fault, 128 + n ended by signal n.
    """
    return run_guarded(lambda: _run(list(arguments)))


def _run(arguments: list[str]) -> None:
    try:
        from flexstage.apps.cli.commands import run_application  # where typer itself is missing, the doctor still runs
    except ModuleNotFoundError as error:
        if arguments[:1] != ["doctor"] or (error.name or "").startswith("flexstage"):
            raise
        from flexstage.apps.installation import consult

        sys.exit(consult())
    sys.exit(run_application(arguments))
