"""Output files of commands: checked before the computation, and written completely or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.storage.store import PendingFile, move_all, write_temporary
from flexstage.show.command.terminal import print_bytes, print_note

STDOUT = "-"
_ENDED_WELL = (None, 0, 1)


class _Pending:
    """Outputs of a command until its end, and notes printed after they are written."""

    def __init__(self) -> None:
        self.files: list[PendingFile] = []
        self.folders: list[Path] = []
        self.texts: list[str] = []

    def put(self) -> None:
        move_all(self.files)
        for text in self.texts:
            print_note(text)

    def drop(self) -> None:
        for each in self.files:
            each.drop()
        for folder in self.folders:
            with suppress(OSError):  # it contains files that were written
                folder.rmdir()


# One value for each running command: the command writes all outputs at its end.
_PENDING: ContextVar[_Pending | None] = ContextVar("outputs that wait", default=None)


@contextmanager
def pending_outputs() -> Generator[None]:
    """Write all output files of the `with` block together at its end, or no file after a failure.

    Unmet requirements, and pipes closed by their readers, do not count as failures.
    """
    pending = _Pending()
    token = _PENDING.set(pending)
    try:
        yield
        pending.put()
    except SystemExit as end:
        if end.code in _ENDED_WELL:
            pending.put()
        raise
    except BrokenPipeError:
        pending.put()
        raise
    finally:
        pending.drop()
        _PENDING.reset(token)


def announce(text: str) -> None:
    """Print a note about an output file after the file is written."""
    pending = _PENDING.get()
    if pending is None:
        print_note(text)
    else:
        pending.texts.append(text)


def require_writable(wanted: Sequence[tuple[str, str | Path | None]], read: Iterable[Path] = ()) -> None:
    """Raise `DesignError` for outputs that cannot be written or that are input files. `wanted` contains pairs (option, path).

    `read` are the input files.
    """
    require(_problems(wanted, read))


def _problems(outputs: Iterable[tuple[str, str | Path | None]], read: Iterable[Path]) -> Iterator[Finding]:
    taken = {_real_path(path): "also an input of this command" for path in read}
    spoken: str | None = None
    for option, target in outputs:
        if target is not None and str(target) == STDOUT:
            if spoken is not None:
                yield Finding(option, f"stdout is also the output of {spoken}", "Write one of the two outputs to a file")
            spoken = option
        if target is None or str(target) == STDOUT:
            continue
        path = Path(target)
        if (owner := taken.get(_real_path(path))) is not None:
            yield Finding(option, f"{path} is {owner}", "Choose another file")
        elif (problem := _problem(path, _file_problem)) is not None:
            yield Finding(option, f"{path} cannot be written: {problem}", "Choose another file or folder")
        else:
            taken[_real_path(path)] = f"also the output of {option}"


def check_folder(folder: Path | None) -> Path | None:
    """Return the folder of `--csv`, new or existing; raises `DesignError` if it is not writable."""
    if folder is not None and (problem := _problem(folder, _folder_problem)) is not None:
        raise refuse("--csv", f"cannot write into {folder}: {problem}", "Choose another folder")
    return folder


def _real_path(path: Path) -> Path:
    """The path without links, unless they form a loop."""
    return Path(os.path.realpath(path))


def _problem(path: Path, refused: Callable[[Path], str | None]) -> str | None:
    """Reason why a file or folder cannot be written, from a trial and not from its mode."""
    try:
        return refused(path)
    except OSError as error:  # a name that is too long, a loop of links, a folder that may not be read
        return error.strerror or str(error)


def _file_problem(path: Path) -> str | None:
    if path.is_dir():
        return "it is a folder"
    if path.exists() and not os.access(path, os.W_OK):
        return "the file is write-protected"
    if _is_device(path):
        return None
    folder = _real_path(path).parent
    if not folder.is_dir():
        return f"folder {path.parent} not found"
    with tempfile.TemporaryFile(dir=folder):
        return None


def _folder_problem(folder: Path) -> str | None:
    if folder.exists() and not folder.is_dir():
        return "it is a file"
    return _file_problem(folder / "table.csv" if folder.exists() else folder)


def _is_device(path: Path) -> bool:
    return path.exists() and not path.is_file()


def make_folder(folder: Path) -> None:
    """Make the folder for outputs if it does not exist; a failed command leaves no empty folder."""
    pending = _PENDING.get()
    if pending is not None and not folder.exists():
        pending.folders.append(folder)
    folder.mkdir(exist_ok=True)


def write(target: str | Path, content: str | bytes, option: str) -> None:
    """Write to a file at the end of the command, or to stdout for `-`; raises `DesignError` if writing fails."""
    data = content.encode() if isinstance(content, str) else content
    if str(target) == STDOUT:
        print_bytes(data)
        return
    if not _is_device(Path(target)):
        pending, waiting = _PENDING.get(), write_temporary(target, data)
        if pending is None:
            waiting.put()
        else:
            pending.files.append(waiting)
        return
    try:
        Path(target).write_bytes(data)
    except OSError as error:
        raise refuse(option, f"{target} cannot be written: {error.strerror}", "Choose another file") from None


def save(target: str | Path, content: str | bytes, option: str) -> None:
    """Write to a file and print a note afterwards; write to stdout if the target is `-`."""
    write(target, content, option)
    if str(target) != STDOUT:
        announce(f"Wrote {target}")
