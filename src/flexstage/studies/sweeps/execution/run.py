"""A study run: all its designs computed and kept, interrupted at any moment and resumed without loss or repetition."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from filelock import FileLock, Timeout

from flexstage.analysis.assessment.measures import platform_frequency
from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import DesignError, refuse, require
from flexstage.base.number import Array
from flexstage.base.processes import memory
from flexstage.base.processes.jobs import cores
from flexstage.base.processes.threads import one_thread
from flexstage.studies.sweeps.definition import Study, name_findings
from flexstage.studies.sweeps.execution.cost import Cost, sweep_cost
from flexstage.studies.sweeps.execution.engine import engine_covers, engine_of
from flexstage.studies.sweeps.execution.evaluate import nominal
from flexstage.studies.sweeps.execution.gather import gather, require_room
from flexstage.studies.sweeps.execution.store import (
    Results,
    count_of,
    differences,
    done_pieces,
    folder_of,
    open_results,
    pending_pieces,
    read_results,
)
from flexstage.studies.sweeps.execution.work import compute_in_processes

PIECE = 256
"""Designs computed and kept together."""
LARGE, _MANY = 2048, 64
"""Designs together where each takes microseconds; so many pieces of the smaller size must a study have for it."""
_COPIES = 4.0
"""How many times over all numbers of the results are in memory at once, where they are read and looked through."""
_SELDOM = 20.0
_LEAST = 5.0

Progress = Callable[[int, int], None]
"""Told how many designs are there, and how many there will be."""
Told = Callable[[Cost], None]
"""Told what is to do before it begins, where anything is."""


@dataclass(frozen=True)
class Run(CheckedFields):
    """How a study is run: `workers` processes (absent: one a core), `resume` what is there, or a Dask `scheduler`'s address."""

    workers: int | None = None
    resume: bool = False
    scheduler: str | None = None


DEFAULT = Run()


@check_arguments
@one_thread
def sweep(
    study: Study, path: str | os.PathLike[str], how: Run = DEFAULT, progress: Progress | None = None, told: Told | None = None
) -> Results:
    """Compute all designs of a study into the results file at `path`.

    Pieces (see `piece_size`) are written as they come and gathered into the file from time to time and at the end. Results do not depend
    on the number of workers or on the order of pieces; the same study gives the same file. An interruption keeps what is there. Raises
    `DesignError` for a file that exists and is not to be resumed, belongs to another study, or is in use; for measures that the
    design lacks; and for a disk that is full.

    >>> import tempfile
    >>> from flexstage.studies.sweeps.example import neck_study
    >>> with tempfile.TemporaryDirectory() as place:
    ...     found = sweep(neck_study(), f"{place}/results.h5", Run(workers=1))
    >>> found.designs.tolist(), found.complete
    ([0, 1, 2, 3], True)
    """
    target = Path(path).absolute()
    size = piece_size(study)
    _require_ready(target, study, how)
    nominal(study)
    folder = folder_of(target)
    with _locked(folder):
        done = _done_pieces(target, study, size)
        ranges = [(start, min(start + size, study.plan.designs)) for start in (np.flatnonzero(~done) * size).tolist()]
        _report_progress(progress, study, size * int(np.sum(done)))
        require_room(target, study)
        try:
            for count, _ in enumerate(
                _gather_as_they_come(_pieces(study, ranges, folder, how, told), target, study, size), 1 + int(np.sum(done))
            ):
                _report_progress(progress, study, size * count)
        except BaseException:
            with contextlib.suppress(DesignError):  # the first reason is told; pieces stay as they are
                if pending_pieces(target):
                    gather(target, study, size)
            require_room(target, study)
            raise
        gather(target, study, size)
    return read_results(target)


def piece_size(study: Study) -> int:
    """How many designs are computed at once: more where the engine answers all that is asked of many.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> piece_size(neck_study()), piece_size(neck_study(1_000_000))
    (256, 2048)
    """
    quick = engine_covers(study) and all(each.kind is platform_frequency for each in study.columns.values())
    return LARGE if quick and study.plan.designs >= _MANY * PIECE else PIECE


def require_memory(study: Study) -> None:
    """Raise `DesignError` where the results of all designs would not fit into memory when they are read at the end.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> require_memory(neck_study())
    """
    columns, designs = len(study.names), study.plan.designs
    each = _COPIES * 8.0 * columns
    memory.require_memory(
        "sweep.designs",
        f"the results of {designs:,} designs in {columns} columns",
        designs * each,
        lambda there: f"Ask for at most {int(there / each):,} designs, or for fewer responses",
    )


def _report_progress(progress: Progress | None, study: Study, count: int) -> None:
    if progress is not None:
        progress(min(count, study.plan.designs), study.plan.designs)


def _done_pieces(target: Path, study: Study, size: int) -> Array:
    """Which pieces are there; results that were cut in another way are refused."""
    if target.exists():
        file = open_results(target)
        if count_of(file, "piece") != size or file.arrays["computed"].shape != (-(-study.plan.designs // size),):
            what = f"its designs are kept in pieces of {count_of(file, 'piece')}, not {size}"
            raise refuse(os.fspath(target), what, "Resume with the version of flexstage that wrote it, or name another file")
    return done_pieces(target, size, study.plan.designs)


def _require_ready(target: Path, study: Study, how: Run) -> None:
    """Refuse what cannot be begun."""
    require(name_findings(study))
    require_memory(study)
    if not target.parent.is_dir():
        raise refuse(os.fspath(target.parent), "there is no such folder", "Create it, or name another")
    there = target.exists() or pending_pieces(target)
    if there and not how.resume:
        raise refuse(os.fspath(target), "results are there already", "Resume (--resume), or name another file")
    if target.exists():
        require(differences(target, study))
    if how.workers is not None and how.workers < 1:
        raise refuse("workers", f"found {how.workers}", "Give 1 or more")


def _pieces(study: Study, ranges: list[tuple[int, int]], folder: Path, how: Run, told: Told | None) -> Iterator[int]:
    if not ranges:
        return iter(())
    engine = engine_of(study)
    if told is not None:
        told(sweep_cost(study, engine, ranges, how.workers or cores(), how.scheduler or ""))
    if how.scheduler is not None:
        from flexstage.studies.sweeps.execution.cluster import compute_on_cluster

        return compute_on_cluster(study, engine, ranges, folder, how.scheduler)
    return compute_in_processes(study, engine, ranges, folder, how.workers or cores())


def _gather_as_they_come(pieces: Iterator[int], target: Path, study: Study, size: int) -> Iterator[int]:
    """The pieces as they come, gathered seldom enough to cost a twentieth of the time."""
    gather(target, study, size)
    last, cost = time.monotonic(), 0.0
    for start in pieces:
        yield start
        now = time.monotonic()
        if now - last > max(_LEAST, _SELDOM * cost):
            gather(target, study, size)
            last = time.monotonic()
            cost = last - now


@contextmanager
def _locked(folder: Path) -> Generator[None]:
    """Hold the folder of pieces for this process; the system lets go of it however the process ends. At the end it goes."""
    lock = FileLock(folder / ".lock", blocking=False)
    try:
        folder.mkdir(exist_ok=True)
        lock.acquire()
    except Timeout:
        raise refuse(os.fspath(folder), "another process computes this study", "Wait for it, or name another file") from None
    except OSError as error:
        what = f"it cannot be written to ({error.strerror or error})"
        raise refuse(os.fspath(folder.parent), what, "Name a file in another folder") from None
    with lock:
        try:
            _clear(folder)
            yield
        finally:
            _clear(folder)
            Path(lock.lock_file).unlink(missing_ok=True)
            with contextlib.suppress(OSError):  # pieces that could not be gathered stay
                folder.rmdir()


def _clear(folder: Path) -> None:
    """Remove what workers that were ended left half-written; nobody else writes here."""
    for left in folder.glob(".*.part"):
        left.unlink(missing_ok=True)
