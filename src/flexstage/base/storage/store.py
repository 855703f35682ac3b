"""Disk storage: cache folder, atomic writes, temporary folders, and clean-up after killed processes.

A file is written under a temporary name next to its target and renamed on completion. Temporary names of files and folders identify the
process and the machine. The next writer in the folder removes files and folders of ended processes.
"""

from __future__ import annotations

import contextlib
import errno
import functools
import os
import platform
import re
import shutil
import tempfile
import time
import zlib
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from flexstage.base.finding import DesignError, refuse

FOLDER_VARIABLE = "FLEXSTAGE_CACHE"
_LONGEST = 15
"""Number of characters (of four bytes at most) of a file's name in its temporary name."""
_PART = ".part"
_OURS = re.compile(r"(?:\..*\.|flexstage-)(?P<place>[0-9a-f]{8})-(?P<process>[0-9]{1,9})-[^.-]+(?P<part>\.part)?", re.DOTALL)
_TICK = 2.0
"""Largest difference between clocks of files and of processes [s]."""
_DAY = 86400.0
"""Age of an abandoned partial file of another machine [s]."""


def cache_folder() -> Path:
    """Return the path of the cache folder, which may not exist yet.

    The environment variable FLEXSTAGE_CACHE sets the path (default: `flexstage` in the user's cache folder). Raises `DesignError` if the
    path is unknown.

    >>> cache_folder().is_absolute()
    True
    """
    from platformdirs import user_cache_path

    stated = os.environ.get(FOLDER_VARIABLE)
    try:
        place = Path(stated).expanduser().absolute() if stated else user_cache_path("flexstage", appauthor=False, opinion=False)
    except (RuntimeError, OSError) as error:
        raise refuse(FOLDER_VARIABLE, f'unknown folder "{stated}" ({error})', "Use an absolute path") from None
    if not place.is_absolute():  # the user's home is unknown
        raise refuse(FOLDER_VARIABLE, "not set, and the home folder is unknown", "Set it to a folder for cached results")
    return place


@dataclass(frozen=True)
class PendingFile:
    """Temporary file at `place`, to be renamed to its `target`; `where` is the user's name for the target in messages."""

    place: Path
    target: Path
    where: str

    def flush(self) -> None:
        """Flush the file to the disk, with the permissions of the file that it replaces; raises `DesignError` on failure."""
        try:
            with self.place.open("rb+") as stream:
                os.fsync(stream.fileno())  # a full disk may be reported only here
            if self.target.exists():
                self.place.chmod(self.target.stat().st_mode & 0o777)
        except OSError as error:
            raise _write_error(self.where, error) from None

    def rename(self) -> None:
        """Rename the file to its target; raises `DesignError` on failure."""
        try:
            self.place.replace(self.target)
        except OSError as error:
            raise _write_error(self.where, error) from None

    def put(self) -> Path:
        """Flush the file and rename it to its target; raises `DesignError` on failure."""
        try:
            self.flush()
            self.rename()
        finally:
            self.drop()
        return self.target

    def drop(self) -> None:
        """Remove the temporary file, unless it has been renamed."""
        with contextlib.suppress(OSError):
            self.place.unlink()


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Generator[Path]:
    """Provide a temporary path for writing. At the end of the block, the temporary file is renamed to `path`, or removed after a failure.

    Raises `DesignError` for a missing folder, a write-protected file, a path that is not a regular file, or a disk error.

    >>> with temporary_folder() as folder:
    ...     with atomic_write(folder / "a.txt") as place:
    ...         _ = place.write_text("whole")
    ...     [each.name for each in folder.iterdir()]
    ['a.txt']
    """
    waiting = _open_temporary(path)
    try:
        yield waiting.place
        waiting.put()
    except OSError as error:
        raise _write_error(waiting.where, error) from None
    finally:
        waiting.drop()


def write(path: str | os.PathLike[str], content: str | bytes) -> Path:
    """Write a file atomically; raises `DesignError` on failure.

    >>> with temporary_folder() as folder:
    ...     write(folder / "stage.toml", "name = 'a'").read_text()
    "name = 'a'"
    """
    return write_temporary(path, content).put()


def write_temporary(path: str | os.PathLike[str], content: str | bytes) -> PendingFile:
    """Write a temporary file for `path`, to be renamed later together with others; raises `DesignError` on failure.

    >>> with temporary_folder() as folder:
    ...     waiting = write_temporary(folder / "stage.toml", "name = 'a'")
    ...     (waiting.target.exists(), waiting.put().exists())
    (False, True)
    """
    waiting = _open_temporary(path)
    try:
        with waiting.place.open("xb") as stream:
            stream.write(content.encode() if isinstance(content, str) else content)
    except BaseException as error:
        waiting.drop()
        if isinstance(error, (OSError, ValueError)):
            raise _write_error(waiting.where, error) from None
        raise
    return waiting


def move_all(files: Iterable[PendingFile]) -> None:
    """Rename all files or none: on failure, the previous files are restored.

    All files are flushed before the first rename. If the process is killed between two renames, all files are complete, but only some of
    them are new.

    >>> with temporary_folder() as folder:
    ...     move_all(write_temporary(folder / name, "whole") for name in ("a.c", "a.h"))
    ...     sorted(each.name for each in folder.iterdir())
    ['a.c', 'a.h']
    """
    waiting = tuple(files)
    before: list[Path | None] = []
    begun = 0
    try:
        for each in waiting:
            each.flush()
            before.append(_keep_aside(each) if len(waiting) > 1 else None)
        for each in waiting:
            begun += 1
            each.rename()
    except BaseException:
        for each, old in zip(waiting[:begun] if len(waiting) > 1 else (), before, strict=False):
            if old is None:
                each.target.unlink(missing_ok=True)
            else:
                old.replace(each.target)
        raise
    finally:
        for left in (*filter(None, before), *(each.place for each in waiting)):
            left.unlink(missing_ok=True)


def _keep_aside(waiting: PendingFile) -> Path | None:
    """Backup of the file to be replaced; `None` if there is none."""
    target = waiting.target
    if not target.exists():
        return None
    place = target.with_name(_part_name(target))
    try:
        try:
            place.hardlink_to(target)
        except (OSError, NotImplementedError):  # no hard links on this disk
            shutil.copy2(target, place)
    except OSError as error:
        raise _write_error(waiting.where, error) from None
    return place


def _open_temporary(path: str | os.PathLike[str]) -> PendingFile:
    where = os.fspath(path)
    try:
        target = Path(path).resolve()
        if target.is_dir():
            raise refuse(where, "not a file but a folder", "Use a file in it")
        if target.exists() and not target.is_file():
            raise refuse(where, "not a regular file", "Use a regular file")
        if target.exists() and not os.access(target, os.W_OK):  # renaming would replace it
            raise PermissionError(errno.EACCES, "the file is write-protected")
        remove_leftovers(target.parent)
        return PendingFile(target.with_name(_part_name(target)), target, where)
    except (OSError, ValueError, RuntimeError) as error:
        if isinstance(error, DesignError):
            raise
        raise _write_error(where, error) from None


def _part_name(target: Path) -> str:
    """Temporary name for a file: its name, truncated, and the mark of this process."""
    return f".{target.name[:_LONGEST]}.{process_mark()}-{os.urandom(4).hex()}{_PART}"


def _write_error(where: str, error: Exception) -> DesignError:
    reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return refuse(where, f"it cannot be written: {reason}", "Choose another file or folder, or free space")


def make_temporary_folder() -> Path:
    """Create a folder for temporary files, to be removed by the caller. Raises `DesignError` on failure.

    >>> make_temporary_folder().rmdir()
    """
    try:
        remove_leftovers(Path(tempfile.gettempdir()))
        return Path(tempfile.mkdtemp(prefix=f"flexstage-{process_mark()}-"))
    except OSError as error:
        what = f"cannot create a folder for temporary files ({error.strerror or error})"
        raise refuse("TMPDIR", what, "Set the environment variable TMPDIR to a writable folder with free space") from None


@contextmanager
def temporary_folder() -> Generator[Path]:
    """Provide a folder for temporary files, removed at the end of the block. Raises `DesignError` on failure.

    >>> with temporary_folder() as folder:
    ...     folder.is_dir()
    True
    >>> folder.exists()
    False
    """
    place = make_temporary_folder()
    try:
        yield place
    finally:
        shutil.rmtree(place, ignore_errors=True)


def remove_leftovers(folder: Path) -> None:
    """Remove leftovers of killed processes in a folder: partial files and temporary folders of this user.

    >>> remove_leftovers(Path("nowhere"))
    """
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if (ours := _OURS.fullmatch(entry.name)) is not None and _is_abandoned(entry, ours):
                if ours["part"]:
                    Path(entry.path).unlink(missing_ok=True)
                else:
                    shutil.rmtree(entry.path, ignore_errors=True)


def remove_temporary_leftovers() -> None:
    """Remove leftovers in the folder for temporary files, if there is one."""
    with contextlib.suppress(OSError):
        remove_leftovers(Path(tempfile.gettempdir()))


def _is_abandoned(entry: os.DirEntry[str], ours: re.Match[str]) -> bool:
    """Whether the process of a file or folder has ended."""
    try:
        state = entry.stat(follow_symlinks=False)
    except OSError:
        return False
    if hasattr(os, "getuid") and state.st_uid != os.getuid():
        return False
    if ours["place"] != _host():
        return bool(ours["part"]) and time.time() - state.st_mtime > _DAY
    return has_ended(f"{ours['place']}-{ours['process']}", state.st_mtime)


def process_mark() -> str:
    """Return a string that identifies this process, unique among machines with a shared disk.

    >>> has_ended(process_mark(), time.time())
    False
    """
    return f"{_host()}-{os.getpid()}"


def has_ended(mark: str, since: float) -> bool:
    """Return whether the process with a `process_mark` has ended; true for a mark of another machine.

    `since` is a time [s since 1970] at which the process was running. A process with the same number that started later does not count.
    """
    host, _, number = mark.partition("-")
    return host != _host() or not number.isdecimal() or not _is_running(int(number), since)


def _is_running(number: int, since: float) -> bool:
    """Whether the process with a number that wrote at a time still runs; a later one has reused the number."""
    try:
        import psutil

        if not psutil.pid_exists(number):
            return False
        process = psutil.Process(number)
        return process.create_time() <= since + _TICK and process.status() != psutil.STATUS_ZOMBIE
    except Exception:  # noqa: BLE001 the system does not tell, in whatever way
        return True


@functools.cache
def _host() -> str:
    """Machine or container of process numbers."""
    try:
        space = Path("/proc/self/ns/pid").stat().st_ino
    except OSError:
        space = 0
    return f"{zlib.crc32(f'{platform.node()} {space}'.encode()):08x}"
