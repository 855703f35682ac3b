"""What a study costs before it begins: its designs, the processes that compute them, and seconds by the first few of them."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from flexstage.base.processes.progress import duration
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.engine import Engine
from flexstage.studies.sweeps.execution.evaluate import piece

_FEW, _SHARE = 8, 64
"""One design in so many is computed to tell what all take, a few at least."""


@dataclass(frozen=True)
class Cost:
    """How many `designs` there are to compute, of how many `in_all`, in how many processes, and the seconds that takes.

    `cluster` is a Dask scheduler's address: how many processes it has is not known, and seconds are those of one.
    """

    designs: int
    in_all: int
    workers: int
    seconds: float
    cluster: str = ""

    def __str__(self) -> str:
        """The cost in a line.

        >>> print(Cost(768, 1024, 2, 40.0))
        to do: 768 of 1,024 designs, 2 at once; about 40 s by the first few.
        """
        count = f"{self.designs:,}" if self.designs == self.in_all else f"{self.designs:,} of {self.in_all:,}"
        lanes = f"by the workers of {self.cluster}" if self.cluster else f"{self.workers} at once"
        taken = f"{duration(self.seconds)}{' of one process' if self.cluster else ''}"
        return f"to do: {count} designs, {lanes}; about {taken} by the first few."


def sweep_cost(study: Study, engine: Engine, ranges: Sequence[tuple[int, int]], workers: int, cluster: str = "") -> Cost:
    """What computing these ranges of designs costs; one design in 64 is computed for it, at least 8 and at most a piece.

    A batch takes a time of its own and more for every design: two batches tell both.

    >>> from flexstage.studies.sweeps.execution.engine import engine_of
    >>> from flexstage.studies.sweeps.example import neck_study
    >>> found = sweep_cost(neck_study(), engine_of(neck_study()), [(0, 4)], workers=2)
    >>> found.designs, found.workers, found.seconds > 0.0
    (4, 1, True)
    """
    designs = sum(stop - start for start, stop in ranges)
    begin, end = ranges[0]
    few = min(max(_FEW, designs // _SHARE), end - begin)
    piece(study, begin, begin + 1, engine)  # what is loaded once is not measured
    one, more = (_seconds(study, engine, begin, begin + count) for count in (1, few))
    each = max(more - one, 0.0) / (few - 1) if few > 1 else 0.0
    lanes = 1 if cluster else min(workers, len(ranges))
    seconds = -(-len(ranges) // lanes) * max(one - each, 0.0) + each * designs / lanes
    return Cost(designs, study.plan.designs, lanes, seconds, cluster)


def _seconds(study: Study, engine: Engine, start: int, stop: int) -> float:
    begun = time.perf_counter()
    piece(study, start, stop, engine)
    return time.perf_counter() - begun
