"""The command line `flexstage ...`. It contains no physics, and imports large packages only when a command is called.

The module `commands` lists all commands. They are defined in `apps.commands` and in the modules `commands` of the other packages. A module
of commands imports common code from `show.command`; it imports neither other commands nor the list.
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
    """Run the command of this process and exit with its exit code; termination signals act like Ctrl-C."""
    for number in ENDINGS:
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _end)
    gc.set_threshold(500_000, 50, 50)  # garbage collection would take a twentieth of the time
    code = MISSED  # for an exception with a traceback
    atexit.register(lambda: _leave(code))  # first in, last out
    code = run(sys.argv[1:])
    sys.exit(code)


def _leave(code: int) -> None:
    """End the process without freeing its memory: that would take a twentieth of a command's time."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):  # the reader closed the pipe
            stream.flush()
    os._exit(code)


def _end(number: int, _frame: object) -> None:
    """Leave with all cleanup, ignoring a second signal."""
    for each in ENDINGS:
        signal.signal(each, signal.SIG_IGN)
    sys.exit(SIGNALLED + number)


def run(arguments: Sequence[str]) -> int:
    """Run a command line and return its exit code.

    Exit codes: 0 success, 1 negative result (e.g. a requirement missed with `--strict`), 2 bad input or unwritable output, 70 internal
    error, 128 + n ended by signal n.
    """
    return run_guarded(lambda: _run(list(arguments)))


def _run(arguments: list[str]) -> None:
    try:
        from flexstage.apps.cli.commands import run_application  # the doctor also runs without typer
    except ModuleNotFoundError as error:
        if arguments[:1] != ["doctor"] or (error.name or "").startswith("flexstage"):
            raise
        from flexstage.apps.installation import consult

        sys.exit(consult())
    sys.exit(run_application(arguments))
