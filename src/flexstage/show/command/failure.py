"""Exit codes and messages of failures: one line for each input error, and no traceback for internal errors of flexstage."""

from __future__ import annotations

import errno
import os
import signal
import sys
import warnings
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path

from flexstage.base.finding import DesignError, refuse
from flexstage.base.storage.store import remove_temporary_leftovers
from flexstage.show.command.output import pending_outputs
from flexstage.show.command.terminal import print_note, print_warning, streams

DONE, MISSED, BAD_INPUT, FAULT, INTERRUPTED = 0, 1, 2, 70, 130
SIGNALLED = 128
"""Offset of the exit code of a command that a signal ended: the exit code is this offset plus the number of the signal."""
ENDINGS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
_DISKS = {getattr(errno, name, None) for name in ("ENAMETOOLONG", "EACCES", "EPERM", "ENOTDIR", "ELOOP", "EROFS", "EIO", "ENOSPC")}
_DEBUG = "FLEXSTAGE_DEBUG"
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
_KEPT = "Finished results are kept for --resume: finite elements in the cache, designs in the results file, pairs in the folder."


def run_guarded(action: Callable[[], object]) -> int:
    """Run an action and return its exit code. Messages are printed to stderr."""
    with streams():
        return _exit_code(action)


def _exit_code(action: Callable[[], object]) -> int:
    remove_temporary_leftovers()
    for name in _THREADS:  # many small matrices: a second thread is slower. Read when numpy is loaded.
        os.environ.setdefault(name, "1")
    try:
        with _print_warnings(), pending_outputs():
            _run_and_flush(action)
    except SystemExit as end:
        return _code_of_exit(end)
    except DesignError as error:
        return _bad_input(error)
    except ModuleNotFoundError as error:
        return _missing(error)
    except BrokenPipeError:
        return DONE  # `| head`
    except KeyboardInterrupt as interruption:
        return _interrupted(interruption)
    except MemoryError as error:
        return _bad_input(refuse("memory", f"not sufficient: {error}", "Use a smaller model or fewer designs, or free memory"))
    except Exception as error:  # noqa: BLE001 (the last resort: a message instead of a traceback)
        return _fault(error)
    return DONE


def _code_of_exit(end: SystemExit) -> int:
    """The exit code of a command that left early."""
    if end.code == INTERRUPTED:  # of the command-line framework, for an interruption
        return _interrupted(end.__context__)
    if isinstance(end.__context__, BrokenPipeError):  # and a failure for a closed pipe
        return DONE
    if end.code in {SIGNALLED + each for each in ENDINGS}:
        print_note(f"Ended by a signal. {_KEPT}")
    return end.code if isinstance(end.code, int) else DONE if end.code is None else MISSED


def _run_and_flush(action: Callable[[], object]) -> None:
    """Run the action and flush its output, also after a failure."""
    try:
        action()
    except SystemExit:
        sys.stdout.flush()
        raise
    sys.stdout.flush()


def _interrupted(interruption: BaseException | None) -> int:
    """The exit code; an interruption may name the best result so far."""
    best = f"{interruption} " if isinstance(interruption, KeyboardInterrupt) and interruption.args else ""
    print_note(f"Interrupted. {best or 'Nothing was written. '}{_KEPT}")
    return INTERRUPTED


def _bad_input(error: DesignError) -> int:
    for finding in error.findings:
        print_note(f"error: {finding}")
    return BAD_INPUT


def _fault(error: Exception) -> int:
    if isinstance(error, OSError) and error.filename and error.errno in _DISKS:
        return _bad_input(refuse(os.fsdecode(error.filename), f"refused by the system: {error.strerror}", "Choose another file or folder"))
    if isinstance(error, FileNotFoundError) and _folder_is_gone():
        return _bad_input(refuse("current folder", "has been removed", "Change to another folder"))
    if os.environ.get(_DEBUG):
        raise error
    print_note(f"error: internal error of flexstage, not caused by your design: {type(error).__name__}: {error}")
    print_note(
        f"Run the same command with {_DEBUG}=1 in the environment and report its output with the design file and `flexstage version`."
    )
    print_note("`flexstage doctor` checks the installation.")
    return FAULT


def _folder_is_gone() -> bool:
    try:
        Path.cwd()
    except FileNotFoundError:
        return True
    return False


def _missing(error: ModuleNotFoundError) -> int:
    if os.environ.get(_DEBUG) or (error.name or "").partition(".")[0] == "flexstage":
        raise error
    print_note(f"error: the package {error.name} is missing. `flexstage doctor` prints the command to install it.")
    return FAULT


@contextmanager
def _print_warnings() -> Generator[None]:
    """Python's warnings as one line each, without file and line of code."""
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: print_warning(str(message))
        yield
