"""Collection of results, with the reason for each result that fails."""

from __future__ import annotations

from collections.abc import Callable, Container
from typing import TypeVar

from flexstage.base.finding import DesignError

_Ground = TypeVar("_Ground")
_Result = TypeVar("_Result")


class Attempts:
    """Collector of results, which stores the reason for each failed result under the name of the result.

    A result that `left_out` names is `None`, without a reason.

    >>> from flexstage.base.finding import refuse
    >>> attempts = Attempts()
    >>> def nothing() -> None:
    ...     raise refuse("gauges", "gauges missing", "Add some")
    >>> attempts.of("sum", lambda: 1 + 1), attempts.of("range", nothing), attempts.missing
    (2, None, {'range': 'gauges: gauges missing. Add some.'})
    """

    def __init__(self, left_out: Container[str] = ()) -> None:
        self.missing: dict[str, str] = {}
        self._left_out = left_out

    def of(self, name: str, result: Callable[[], _Result]) -> _Result | None:
        """Return the value of `result()`; if it raises `DesignError`, store the reason and return `None`."""
        if name in self._left_out:
            return None
        try:
            return result()
        except DesignError as error:
            self.missing[name] = str(error)
            return None

    def of_ground(self, name: str, ground: _Ground | None, reason: str, result: Callable[[_Ground], _Result]) -> _Result | None:
        """Return the value of `result(ground)`; if `ground` is `None`, store the reason and return `None`."""
        if ground is None and name not in self._left_out:
            self.missing[name] = reason
        return None if ground is None else self.of(name, lambda: result(ground))
