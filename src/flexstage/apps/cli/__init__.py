"""The command line: `flexstage ...`. Translates requests; no physics. Nothing heavy is loaded before a command needs it.

Commands stand by family: `design` (files), `analyses` (one command an analysis), `whole` (everything at once), `installation`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from flexstage.apps.cli.failure import guarded


def main() -> None:
    """Run the command of this process and leave with its exit code."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Run a command line and return its exit code: 0 done, 1 requirement missed (`--strict`), 2 bad input or interrupted, 70 a fault."""
    return guarded(lambda: _run(list(arguments)))


def _run(arguments: list[str]) -> None:
    try:
        from flexstage.apps.cli.application import app
    except ModuleNotFoundError as error:
        if arguments[:1] != ["doctor"] or (error.name or "").startswith("flexstage"):
            raise
        from flexstage.apps.cli.installation import consult

        sys.exit(consult(mending="--mend" in arguments))
    app(arguments, prog_name="flexstage")
