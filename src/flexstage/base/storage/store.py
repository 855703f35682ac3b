"""What is kept on disk: the cache's folder, atomic writes, temporary folders; and what killed processes left of these.

A file is written under another name beside its target and renamed once it is whole. Such names, and those of temporary folders, say which
process of which machine they belong to: whoever writes there next removes those whose process is gone.
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
"""Characters of a file's name, of four bytes at most, that a temporary one beside it has."""
_PART = ".part"
_OURS = re.compile(r"(?:\..*\.|flexstage-)(?P<place>[0-9a-f]{8})-(?P<process>[0-9]{1,9})-[^.-]+(?P<part>\.part)?", re.DOTALL)
_TICK = 2.0
"""How far the clocks of files and of processes may lie apart [s]."""
_DAY = 86400.0
"""Age of a half-written file of another machine [s] whose writer must be gone."""


def cache_folder() -> Path:
    """The folder named by the environment variable FLEXSTAGE_CACHE, else flexstage in the user's folder for caches; it need not be there.

    Raises `DesignError` where it cannot be told.

    >>> cache_folder().is_absolute()
    True
    """
    from platformdirs import user_cache_path

    stated = os.environ.get(FOLDER_VARIABLE)
    try:
        place = Path(stated).expanduser().absolute() if stated else user_cache_path("flexstage", appauthor=False, opinion=False)
    except (RuntimeError, OSError) as error:
        raise refuse(FOLDER_VARIABLE, f'the folder "{stated}" cannot be told ({error})', "Name the folder by its whole path") from None
    if not place.is_absolute():  # nobody knows the user's home
        raise refuse(FOLDER_VARIABLE, "it is not set, and the user's home is not known", "Name a folder for what may be computed again")
    return place


@dataclass(frozen=True)
class PendingFile:
    """A file written, or to be written, at `place` beside its `target`, where it is not yet; `where` is how the user named it."""

    place: Path
    target: Path
    where: str

    def flush(self) -> None:
        """Bring it to the disk, with the rights of the file it replaces; raises `DesignError` if that cannot be."""
        try:
            with self.place.open("rb+") as stream:
                os.fsync(stream.fileno())  # a disk may report only now that it is full
            if self.target.exists():
                self.place.chmod(self.target.stat().st_mode & 0o777)
        except OSError as error:
            raise _write_error(self.where, error) from None

    def rename(self) -> None:
        """Rename it onto its target; raises `DesignError` if that cannot be."""
        try:
            self.place.replace(self.target)
        except OSError as error:
            raise _write_error(self.where, error) from None

    def put(self) -> Path:
        """Rename it onto its target, on the disk before it is there; raises `DesignError` if that cannot be."""
        try:
            self.flush()
            self.rename()
        finally:
            self.drop()
        return self.target

    def drop(self) -> None:
        """Remove it, where it has not been put."""
        with contextlib.suppress(OSError):
            self.place.unlink()


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Generator[Path]:
    """A path beside `path` to write to; renamed to it when the block ends, removed where it fails.

    Raises `DesignError` where the folder is missing, the file is none or write-protected, or the disk refuses.

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
    """Write a whole file, or none; raises `DesignError` if that cannot be.

    >>> with temporary_folder() as folder:
    ...     write(folder / "stage.toml", "name = 'a'").read_text()
    "name = 'a'"
    """
    return write_temporary(path, content).put()


def write_temporary(path: str | os.PathLike[str], content: str | bytes) -> PendingFile:
    """Write beside `path`, to be put there later, together with others; raises `DesignError` if it cannot be written.

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
    """Put all files or none: where one cannot be put, those before it are as they were.

    All are on the disk before the first is renamed, and only renames lie between the first and the last: a process that is killed within
    these few microseconds leaves files that are whole, some of them new.

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
    """The file that is to be replaced under another name; nothing where there is none."""
    target = waiting.target
    if not target.exists():
        return None
    place = target.with_name(_part_name(target))
    try:
        try:
            place.hardlink_to(target)
        except (OSError, NotImplementedError):  # a disk without second names
            shutil.copy2(target, place)
    except OSError as error:
        raise _write_error(waiting.where, error) from None
    return place


def _open_temporary(path: str | os.PathLike[str]) -> PendingFile:
    where = os.fspath(path)
    try:
        target = Path(path).resolve()
        if target.is_dir():
            raise refuse(where, "this is a directory", "Name a file in it")
        if target.exists() and not target.is_file():
            raise refuse(where, "this is no regular file", "Name a file")
        if target.exists() and not os.access(target, os.W_OK):  # renaming would replace even that
            raise PermissionError(errno.EACCES, "the file is write-protected")
        remove_leftovers(target.parent)
        return PendingFile(target.with_name(_part_name(target)), target, where)
    except (OSError, ValueError, RuntimeError) as error:
        if isinstance(error, DesignError):
            raise
        raise _write_error(where, error) from None


def _part_name(target: Path) -> str:
    """A new name for a file beside another: its own, cut so that no disk finds it too long, and whose it is."""
    return f".{target.name[:_LONGEST]}.{process_mark()}-{os.urandom(4).hex()}{_PART}"


def _write_error(where: str, error: Exception) -> DesignError:
    reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return refuse(where, f"it cannot be written: {reason}", "Choose another file or folder, or free space")


def make_temporary_folder() -> Path:
    """A new folder for temporary files, to be removed by the caller. Raises `DesignError` where none can be made.

    >>> make_temporary_folder().rmdir()
    """
    try:
        remove_leftovers(Path(tempfile.gettempdir()))
        return Path(tempfile.mkdtemp(prefix=f"flexstage-{process_mark()}-"))
    except OSError as error:
        what = f"no folder for temporary files can be made ({error.strerror or error})"
        raise refuse("TMPDIR", what, "Let the environment variable TMPDIR name a folder with room that can be written to") from None


@contextmanager
def temporary_folder() -> Generator[Path]:
    """A new folder for temporary files that is gone when the block ends. Raises `DesignError` where none can be made.

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
    """Remove what killed processes left in a folder: half-written files and folders for temporary files of this user.

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
    """The same in the folder for temporary files, where there is one."""
    with contextlib.suppress(OSError):
        remove_leftovers(Path(tempfile.gettempdir()))


def _is_abandoned(entry: os.DirEntry[str], ours: re.Match[str]) -> bool:
    """Whether the process that made a file or folder is gone."""
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
    """The name of this process among those of all machines that share a disk.

    >>> has_ended(process_mark(), time.time())
    False
    """
    return f"{_host()}-{os.getpid()}"


def has_ended(mark: str, since: float) -> bool:
    """Whether the process of a `process_mark` that wrote at a time [s since 1970] is gone; of another machine that is taken as true."""
    host, _, number = mark.partition("-")
    return host != _host() or not number.isdecimal() or not _is_running(int(number), since)


def _is_running(number: int, since: float) -> bool:
    """Whether the process of a number that wrote at a time still runs; one that began later has taken over the number."""
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
    """The machine, or the container, in which numbers of processes mean something."""
    try:
        space = Path("/proc/self/ns/pid").stat().st_ino
    except OSError:
        space = 0
    return f"{zlib.crc32(f'{platform.node()} {space}'.encode()):08x}"
