"""Run of a study: all designs are computed and stored. After an interruption, it continues without loss or repetition."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from filelock import FileLock, Timeout

from flexstage.analysis.assessment.measures import platform_frequency
from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import DesignError, refuse, require
from flexstage.base.processes import memory
from flexstage.base.processes.jobs import Line, cores
from flexstage.base.processes.pool import CallError, results
from flexstage.base.processes.threads import one_thread
from flexstage.base.storage.store import remove_leftovers
from flexstage.studies.sweeps.definition import Study, name_findings
from flexstage.studies.sweeps.execution.engine import Engine, engine_covers, engine_of
from flexstage.studies.sweeps.execution.evaluate import nominal, piece
from flexstage.studies.sweeps.execution.store import (
    Results,
    differences,
    folder_of,
    gather,
    pending_pieces,
    read_results,
    require_room,
    write_piece,
)

PIECE = 256
"""Designs computed and stored together."""
LARGE, _MANY = 2048, 64
"""Number of designs in a piece if each takes microseconds, and the smallest number of small pieces in a study with such pieces."""
_COPIES = 4.0
"""Number of copies of all results that are in memory at the same time, during reading."""

Progress = Callable[[int, int], None]
"""Function that is called with the number of computed designs and the number of all designs."""


@dataclass(frozen=True)
class Run(CheckedFields):
    """Options of a run: `workers`, the number of processes (default: one per core), and whether to `resume` from existing results."""

    workers: int | None = None
    resume: bool = False


DEFAULT = Run()


@check_arguments
@one_thread
def sweep(study: Study, path: str | os.PathLike[str], how: Run = DEFAULT, progress: Progress | None = None) -> Results:
    """Compute all designs of a study, and store them in the results file `path`.

    Designs are computed in pieces of several designs each (see `piece_size`). Each piece is written to its own file; at the end of the run,
    the pieces are combined in the results file. Results do not depend on the number of workers or on the sequence of pieces; equal studies
    give equal files. Results computed before an interruption are kept. Raises `DesignError` if the results file exists and `how.resume` is
    false, if the file belongs to another study or is in use, if the design does not have a measure of the study, and if the disk is full.

    >>> import tempfile
    >>> from flexstage.studies.sweeps.example import neck_study
    >>> with tempfile.TemporaryDirectory() as place:
    ...     found = sweep(neck_study(), f"{place}/results.h5", Run(workers=1))
    >>> found.designs.tolist(), found.complete
    ([0, 1, 2, 3], True)
    """
    target = Path(path).absolute()
    size = piece_size(study)
    _require_ready(target, study, size, how)
    nominal(study)
    folder, designs = folder_of(target), study.plan.designs

    def report(pieces: int) -> None:
        if progress is not None:
            progress(min(size * pieces, designs), designs)

    with _locked(folder):
        done = gather(target, study, size)
        ranges = [(start, min(start + size, designs)) for start in (np.flatnonzero(~done) * size).tolist()]
        report(int(np.sum(done)))
        try:
            for count, _ in enumerate(_pieces(study, ranges, folder, how.workers or cores()), 1 + int(np.sum(done))):
                report(count)
        finally:
            gather(target, study, size)
    return read_results(target)


def piece_size(study: Study) -> int:
    """Return the number of designs in a piece. The number is larger if the engine computes all responses of a large study.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> piece_size(neck_study()), piece_size(neck_study(1_000_000))
    (256, 2048)
    """
    quick = engine_covers(study) and all(each.kind is platform_frequency for each in study.columns.values())
    return LARGE if quick and study.plan.designs >= _MANY * PIECE else PIECE


def require_memory(study: Study) -> None:
    """Raise `DesignError` if the results of all designs would not fit into memory at the end.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> require_memory(neck_study())
    """
    columns, designs = len(study.names), study.plan.designs
    each = _COPIES * 8.0 * columns
    memory.require_memory(
        "sweep.designs",
        f"the results of {designs:,} designs in {columns} columns",
        designs * each,
        lambda there: f"Use at most {int(there / each):,} designs, or fewer responses",
    )


def _require_ready(target: Path, study: Study, size: int, how: Run) -> None:
    """Refuse a run that cannot start."""
    require(name_findings(study))
    require_memory(study)
    if not target.parent.is_dir():
        raise refuse(os.fspath(target.parent), "folder not found", "Create the folder, or choose another")
    there = target.exists() or pending_pieces(target)
    if there and not how.resume:
        raise refuse(os.fspath(target), "file exists already", "Continue with --resume, or choose another file")
    if target.exists():
        require(differences(target, study, size))
    if how.workers is not None and how.workers < 1:
        raise refuse("workers", f"must be at least 1 (got {how.workers})", "Use 1 or more")
    require_room(target, study)


def _pieces(study: Study, ranges: Iterable[tuple[int, int]], folder: Path, workers: int) -> Iterator[object]:
    """Compute all ranges of designs into the folder, in processes of one engine; yields once for each completed range."""
    try:
        if ranges:
            yield from results(partial(_keep_piece, study, engine_of(study), folder), ranges, workers)
    except CallError as failed:
        start, stop = failed.arguments
        what, advice = ("processes crashed repeatedly", "Free memory and resume")
        if isinstance(failed.error, DesignError):
            what, advice = " ".join(str(failed.error).split()), "Correct the study and resume"
        elif failed.error is not None:
            raise failed.error from None
        raise refuse(f"designs {start} to {stop - 1}", what, advice) from None


def _keep_piece(study: Study, engine: Engine, folder: Path, _line: Line, start: int, stop: int) -> None:
    write_piece(folder, piece(study, start, stop, engine))


@contextmanager
def _locked(folder: Path) -> Generator[None]:
    """Lock the folder of pieces for this process; the system releases it at the end of the process. Then the folder is removed."""
    lock = FileLock(folder / ".lock", blocking=False)
    try:
        folder.mkdir(exist_ok=True)
        lock.acquire()
    except Timeout:
        raise refuse(os.fspath(folder), "another process computes this study", "Wait for its end, or choose another file") from None
    except OSError as error:
        what = f"cannot be written ({error.strerror or error})"
        raise refuse(os.fspath(folder.parent), what, "Choose a file in another folder") from None
    with lock:
        try:
            yield
        finally:
            remove_leftovers(folder)
            Path(lock.lock_file).unlink(missing_ok=True)
            for old in folder.glob("[0-9]*.npz"):  # pieces of earlier versions, which are computed again
                old.unlink(missing_ok=True)
            with contextlib.suppress(OSError):  # pieces that could not be combined remain
                folder.rmdir()
