"""What an optimisation costs before it begins: its searches, what a design with its derivatives takes, and the most that can come of it."""

from __future__ import annotations

import time
from dataclasses import dataclass

from flexstage.base.processes.progress import duration
from flexstage.base.processes.threads import one_thread
from flexstage.studies.optimisation.search.search import STEPS
from flexstage.studies.optimisation.setting import Setting


@dataclass(frozen=True)
class SearchCost:
    """How many `searches` there are, and the seconds that a design with its derivatives takes."""

    searches: int
    each: float

    @property
    def designs(self) -> int:
        """The most designs that the searches evaluate."""
        return 2 * STEPS * self.searches

    def __str__(self) -> str:
        """The cost in a line.

        >>> print(SearchCost(3, 0.05))
        to do: 3 searches in one process, of at most 480 designs in all; a design takes 0.05 s: at most 24 s, usually less.
        """
        most = f"of at most {self.designs:,} designs in all; a design takes {self.each:.2g} s: at most {duration(self.designs * self.each)}"
        return f"to do: {self.searches} searches in one process, {most}, usually less."


@one_thread
def search_cost(set_up: Setting) -> SearchCost:
    """What a search from every start costs, or a front of two objectives: each alone, the other improved, and from both ends between.

    The design as it stands is evaluated once more for it.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> from flexstage.studies.optimisation.setting import setting
    >>> search_cost(setting(*leaf_study())).searches
    2
    """
    definition = set_up.definition
    searches = definition.starts if len(definition.objectives) == 1 else 2 * (definition.starts + 1) + 2 * (definition.points - 2)
    begun = time.perf_counter()
    set_up.values(set_up.before.shares[None])
    return SearchCost(searches, time.perf_counter() - begun)
