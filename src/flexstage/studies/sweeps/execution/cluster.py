"""Pieces of a study computed by a Dask cluster, on many machines: they come back over the network and are written here."""

from __future__ import annotations

import logging
import queue
import threading
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from flexstage.base.finding import DesignError, refuse
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.engine import Engine
from flexstage.studies.sweeps.execution.evaluate import Piece, piece
from flexstage.studies.sweeps.execution.store import write_piece

_ANSWER, _WORKERS = 5, 30
"""How long to wait for the scheduler, and for the first of its workers [s]."""


def compute_on_cluster(study: Study, engine: Engine, ranges: list[tuple[int, int]], folder: Path, address: str) -> Iterator[int]:
    """Compute all ranges of designs at the scheduler's `address`; yields the first design of each as it is there.

    A worker that dies costs nothing: the scheduler gives its pieces to another. Raises `DesignError` without the extra `cluster`, where
    no scheduler answers, where it has no workers, and where it is lost on the way.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> from flexstage.studies.sweeps.execution.engine import engine_of
    >>> compute_on_cluster(neck_study(), engine_of(neck_study()), [(0, 4)], Path("nowhere"), "no address")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: scheduler: ...
    """
    return _compute(_client(address), (study, engine), ranges, folder)


def _client(address: str) -> Any:
    """A client of the scheduler with a worker at least."""
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise refuse("scheduler", "the package distributed is not installed", "Install flexstage with the extra 'cluster'") from None
    answer: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def connect() -> None:
        try:
            answer.put(Client(address, timeout=_ANSWER))
        except Exception as error:  # noqa: BLE001 what answers there may be anything
            answer.put(error)

    threading.Thread(target=connect, daemon=True).start()  # what takes the call and says nothing would hold us for ever
    try:
        client = answer.get(timeout=2 * _ANSWER)
    except queue.Empty:
        client = TimeoutError(f"it took the call and said nothing for {2 * _ANSWER} s")
    if isinstance(client, Exception):
        raise refuse("scheduler", f"no Dask scheduler answers at {address} ({client})", 'Start one with "dask scheduler"')
    try:
        client.wait_for_workers(1, timeout=_WORKERS)
    except TimeoutError:
        client.close()
        raise refuse("scheduler", f"{address} has no workers", f'Start some with "dask worker {address}"') from None
    return client


def _compute(client: Any, shared: tuple[Study, Engine], ranges: list[tuple[int, int]], folder: Path) -> Iterator[int]:
    from distributed import as_completed

    with _quiet(), client:
        try:
            there = client.submit(_together, *shared, pure=False)  # not scattered: a worker that dies with it is not asked for it again
            futures = client.map(_piece, [there] * len(ranges), *zip(*ranges, strict=True), pure=False)
            for _, found in as_completed(futures, with_results=True):
                if not isinstance(found, Piece):
                    raise RuntimeError(str(found))
                write_piece(folder, found)
                yield found.start
        except DesignError:
            raise
        except (OSError, RuntimeError, ValueError) as error:
            raise refuse("scheduler", f"the cluster failed ({error})", "Mend it and resume (--resume): what was computed is kept") from None


@contextmanager
def _quiet() -> Generator[None]:
    """Leave it to findings to tell what fails: the client's own log is full of tracebacks."""
    log = logging.getLogger("distributed")
    before = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        log.setLevel(before)


def _together(study: Study, engine: Engine) -> tuple[Study, Engine]:
    return study, engine


def _piece(shared: tuple[Study, Engine], start: int, stop: int) -> Piece:
    study, engine = shared
    return piece(study, start, stop, engine)
