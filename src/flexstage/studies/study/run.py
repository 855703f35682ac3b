"""A study run: all its designs computed and kept, interrupted at any moment and resumed without loss or repetition."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from glob import escape
from pathlib import Path

import numpy as np

from flexstage.base.aside import stem_of
from flexstage.base.child import cores
from flexstage.base.finding import refuse, require
from flexstage.studies.study.definition import Study
from flexstage.studies.study.engine import engine_of
from flexstage.studies.study.evaluate import nominal
from flexstage.studies.study.store import Results, computed, differences, folder_of, gather, read_results, waiting
from flexstage.studies.study.work import worked

PIECE = 256
"""Designs computed at once: matrices of more no longer fit into a processor's cache."""
_SELDOM = 20.0
_LEAST = 5.0

Progress = Callable[[int, int], None]
"""Told how many designs are there, and how many there will be."""


@dataclass(frozen=True)
class Run:
    """How a study is run: `workers` processes (absent: one a core), `resume` what is there, or a Dask `scheduler`'s address."""

    workers: int | None = None
    resume: bool = False
    scheduler: str | None = None


DEFAULT = Run()


def run(study: Study, path: str | os.PathLike[str], how: Run = DEFAULT, progress: Progress | None = None) -> Results:
    """Compute all designs of a study into the results file at `path`.

    Pieces of 256 designs are written as they come and gathered into the file from time to time and at the end. Results do not depend on
    the number of workers or on the order of pieces; the same study gives the same file. An interruption keeps what is there. Raises
    `DesignError` for a file that exists and is not to be resumed, belongs to another study, or is in use; for measures that the
    design lacks; and for a disk that is full.

    >>> import tempfile
    >>> from flexstage.studies.study.example import neck_study
    >>> with tempfile.TemporaryDirectory() as place:
    ...     found = run(neck_study(), f"{place}/results.h5", Run(workers=1))
    >>> found.designs.tolist(), found.complete
    ([0, 1, 2, 3], True)
    """
    target = Path(path).absolute()
    _ready(target, study, how)
    nominal(study)
    folder = folder_of(target)
    with _alone(folder):
        done = computed(target, PIECE, study.plan.designs)
        ranges = [(start, min(start + PIECE, study.plan.designs)) for start in (np.flatnonzero(~done) * PIECE).tolist()]
        _tell(progress, study, done)
        try:
            for start in _gathering(_pieces(study, ranges, folder, how), target, study):
                done[start // PIECE] = True
                _tell(progress, study, done)
        finally:
            gather(target, study, PIECE)
        gather(target, study, PIECE)
    folder.rmdir()
    return read_results(target)


def _tell(progress: Progress | None, study: Study, done: np.ndarray) -> None:
    if progress is not None:
        progress(min(int(np.sum(done)) * PIECE, study.plan.designs), study.plan.designs)


def _ready(target: Path, study: Study, how: Run) -> None:
    """Refuse what cannot be begun."""
    if not target.parent.is_dir():
        raise refuse(os.fspath(target.parent), "there is no such folder", "Create it, or name another")
    there = target.exists() or waiting(target)
    if there and not how.resume:
        raise refuse(os.fspath(target), "results are there already", "Resume (--resume), or name another file")
    if target.exists():
        require(differences(target, study))
    if how.workers is not None and how.workers < 1:
        raise refuse("workers", f"found {how.workers}", "Give 1 or more")


def _pieces(study: Study, ranges: list[tuple[int, int]], folder: Path, how: Run) -> Iterator[int]:
    if not ranges:
        return iter(())
    engine = engine_of(study)
    if how.scheduler is not None:
        from flexstage.studies.study.cluster import clustered

        return clustered(study, engine, ranges, folder, how.scheduler)
    return worked(study, engine, ranges, folder, how.workers or cores())


def _gathering(pieces: Iterator[int], target: Path, study: Study) -> Iterator[int]:
    """The pieces as they come, gathered seldom enough to cost a twentieth of the time."""
    last, cost = time.monotonic(), 0.0
    gather(target, study, PIECE)
    for start in pieces:
        yield start
        now = time.monotonic()
        if now - last > max(_LEAST, _SELDOM * cost):
            gather(target, study, PIECE)
            last = time.monotonic()
            cost = last - now


@contextmanager
def _alone(folder: Path) -> Generator[None]:
    """Hold the folder of pieces for this process; the system lets go of it however the process ends."""
    import fcntl

    folder.mkdir(exist_ok=True)
    lock = folder / ".lock"
    with lock.open("w") as held:
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise refuse(os.fspath(folder), "another process computes this study", "Wait for it, or name another file") from None
        for left in (*folder.glob(".*.part"), *folder.parent.glob(f".{escape(stem_of(folder.with_suffix('')))}.*.part")):
            left.unlink(missing_ok=True)
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)
