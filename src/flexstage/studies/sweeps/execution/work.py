"""Pieces of a study computed in processes of this machine: each takes a piece, writes it, and asks for the next."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path

from flexstage.base.finding import DesignError, refuse
from flexstage.base.processes.jobs import CallError, Line, results
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.engine import Engine
from flexstage.studies.sweeps.execution.evaluate import piece
from flexstage.studies.sweeps.execution.store import write_piece


def compute_in_processes(study: Study, engine: Engine, ranges: Iterable[tuple[int, int]], folder: Path, workers: int) -> Iterator[int]:
    """Compute all ranges of designs into `folder`; yields the first design of each as it is there, in any order.

    All processes take the same `engine`. Raises `DesignError` where a piece cannot be written, or where processes die over it again and
    again. When the iteration is left, all processes end.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> from flexstage.studies.sweeps.execution.engine import engine_of
    >>> list(compute_in_processes(neck_study(), engine_of(neck_study()), [], Path("nowhere"), 2))
    []
    """
    try:
        for (start, _), _ in results(partial(_keep_piece, study, engine, folder), ranges, workers):
            yield start
    except CallError as failed:
        start, stop = failed.arguments
        what, advice = ("processes died over them again and again", "Free memory and resume")
        if isinstance(failed.error, DesignError):
            what, advice = " ".join(str(failed.error).split()), "Mend it and resume"
        elif failed.error is not None:
            raise failed.error from None
        raise refuse(f"designs {start} to {stop - 1}", what, advice) from None


def _keep_piece(study: Study, engine: Engine, folder: Path, _line: Line, start: int, stop: int) -> None:
    write_piece(folder, piece(study, start, stop, engine))
