"""Cache of superelements and hinges in files by content: each of them is computed once on a machine, and a stopped command resumes.

Files that cannot be read or written cause warnings, not errors: the result is then computed again, or is not stored.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import DesignError, Finding
from flexstage.base.storage.record_store import FORMAT, RecordStore, to_bytes
from flexstage.base.storage.store import FOLDER_VARIABLE, cache_folder
from flexstage.base.version import __version__
from flexstage.solid.fea.hinges.hinge_form import HingeSolid
from flexstage.solid.fea.jobs.content import content
from flexstage.solid.fea.jobs.install import SOLVER_VERSION
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.component import Component
from flexstage.solid.fea.solver.superelement import Skin, Superelement


@dataclass(frozen=True)
class Kind:
    """A kind of file in the cache: the ending of the file's name, and a noun for its content."""

    suffix: str
    noun: str


SUPERELEMENTS, HINGES = Kind(".superelement", "superelement"), Kind(".hinge", "compliance matrix")
SOUND = Kind(".sound", "record of checked outlines")


@dataclass(frozen=True)
class Cache(CheckedFields):
    """Folder of stored FEA results: superelements, compliance matrices of hinges, and records of checked outlines.

    `limit` [bytes] is the largest total size of each kind of file; the least recently used files are removed first. The default `folder` is
    the value of the environment variable FLEXSTAGE_CACHE, or else the folder flexstage in the user's folder for caches.
    """

    folder: Path | None = None
    limit: float = 4e9


@functools.cache
def program() -> str:
    """Return the identity of the program: flexstage with a digest of its solid model's code, NGSolve, and the file format.

    Stored results of another program identity are therefore never used.

    >>> program().endswith(f"with NGSolve {SOLVER_VERSION}, format {FORMAT}")
    True
    """
    state = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        state.update(path.name.encode() + path.read_bytes())
    return f"flexstage {__version__} ({state.hexdigest()[:16]}) with NGSolve {SOLVER_VERSION}, format {FORMAT}"


Notice: TypeAlias = Callable[[Finding], None]
"""Function called with a warning if a file of the cache is damaged or could not be written."""


def warn(finding: Finding) -> None:
    """Issue a finding as a Python warning."""
    warnings.warn(str(finding), stacklevel=2)


def folder_of(cache: Cache) -> Path:
    """Return the folder of a cache; this folder need not exist.

    >>> folder_of(Cache(Path("/tmp/superelements"))).name
    'superelements'
    """
    return cache_folder() if cache.folder is None else cache.folder


def key_of(component: Component, reduction: Reduction) -> str:
    """Return a digest of a superelement's inputs (content of the component, options of reduction), which excludes program versions.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.solid.fea.solver.component import components
    >>> part = components(parallelogram())[0]
    >>> key_of(part, Reduction()) == key_of(part, Reduction(modes=13))
    False
    """
    return hashlib.sha256(f"{content(component)} {reduction}".encode()).hexdigest()[:32]


def find(cache: Cache, key: str, where: str, kind: Kind = SUPERELEMENTS, *, notice: Notice = warn) -> Any:
    """Return the superelement or hinge stored for a key, or `None`. `where` is the name of the component or hinge in warnings.

    >>> find(Cache(Path("/nowhere")), "key", "lever") is None
    True
    """
    store = _store(cache, kind)
    try:
        result = store.find(key)
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        why = f"it cannot be read ({error.strerror})" if isinstance(error, OSError) else error
        notice(Finding(where, f"its {kind.noun} {store.path(key)} is not used: {why}", "It is computed again and replaced"))
        return None
    with contextlib.suppress(OSError):
        os.utime(store.path(key))
    return result


def holds(cache: Cache, key: str, kind: Kind = SUPERELEMENTS) -> bool:
    """Return whether a file exists for a key. The content of the file is checked only when it is read.

    >>> holds(Cache(Path("/nowhere")), "key")
    False
    """
    return _store(cache, kind).path(key).is_file()


def keep(cache: Cache, key: str, where: str, element: Any, kind: Kind = SUPERELEMENTS, *, notice: Notice = warn) -> None:
    """Store a superelement, a hinge or a record of checked outlines in a file. The file is written completely or not at all.

    >>> keep(Cache(Path("/proc/nowhere")), "key", "lever", None, notice=lambda finding: print(finding.where))
    lever
    """
    store, data = _store(cache, kind), to_bytes(element, key, program())
    try:
        _remove_old(cache, store.folder, len(data), kind)
        store.write(key, data)
    except (OSError, DesignError) as error:
        why = error.strerror if isinstance(error, OSError) else error.findings[0].what
        what = f"its {kind.noun} of {len(data) / 1e6:.3g} MB could not be stored in {store.folder} ({why})"
        advice = f"The result is complete, but not cached: free space in this folder, or set {FOLDER_VARIABLE} to another folder"
        notice(Finding(where, what, advice))


def _remove_old(cache: Cache, folder: Path, coming: int, kind: Kind) -> None:
    """Remove the least recently used files, until there is enough space."""
    total, files = float(coming), list[tuple[float, int, Path]]()
    for path in folder.glob(f"*{kind.suffix}"):
        with contextlib.suppress(FileNotFoundError):  # another process removed it
            state = path.stat()
            files.append((state.st_mtime, state.st_size, path))
    for _, size, path in sorted(files, reverse=True):
        total += size
        if total > cache.limit:
            path.unlink(missing_ok=True)


def _store(cache: Cache, kind: Kind) -> RecordStore:
    ending = f"-{hashlib.sha256(program().encode()).hexdigest()[:12]}{kind.suffix}"
    return RecordStore(folder_of(cache), ending, (Superelement, Skin, HingeSolid, Finding), program())
