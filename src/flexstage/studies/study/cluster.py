"""Pieces of a study computed by a Dask cluster, on many machines: they come back over the network and are written here."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from flexstage.base.finding import refuse
from flexstage.studies.study.definition import Study
from flexstage.studies.study.engine import Engine
from flexstage.studies.study.evaluate import Piece, piece
from flexstage.studies.study.store import write_piece


def clustered(study: Study, engine: Engine, ranges: list[tuple[int, int]], folder: Path, address: str) -> Iterator[int]:
    """Compute all ranges of designs at the scheduler's `address`; yields the first design of each as it is there.

    A worker that dies costs nothing: the scheduler gives its pieces to another. Raises `DesignError` without the extra `cluster`, and where
    no scheduler answers.

    >>> from flexstage.studies.study.example import neck_study
    >>> from flexstage.studies.study.engine import engine_of
    >>> next(clustered(neck_study(), engine_of(neck_study()), [(0, 4)], Path("nowhere"), "no address"))
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: scheduler: ...
    """
    try:
        from distributed import Client, as_completed
    except ModuleNotFoundError:
        raise refuse("scheduler", "the package distributed is not installed", "Install flexstage with the extra 'cluster'") from None
    try:
        client = Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise refuse("scheduler", f"nothing answers at {address} ({error})", 'Start one with "dask scheduler"') from None
    with client:
        shared = client.scatter((study, engine), broadcast=True, hash=False)
        futures = client.map(_piece, [shared] * len(ranges), *zip(*ranges, strict=True), pure=False)
        for _, found in as_completed(futures, with_results=True):
            write_piece(folder, found)
            yield found.start


def _piece(shared: tuple[Study, Engine], start: int, stop: int) -> Piece:
    study, engine = shared
    return piece(study, start, stop, engine)
