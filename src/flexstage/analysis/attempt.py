"""Attempts: results that a stage may refuse to give, each on its own."""

from __future__ import annotations

from collections.abc import Callable, Container
from typing import TypeVar

from flexstage.base.finding import DesignError

_Ground = TypeVar("_Ground")
_Result = TypeVar("_Result")


class Attempts:
    """Gathers the reasons of results that are refused, by name, while the others go on; those `left_out` are `None` without one.

    >>> from flexstage.base.finding import refuse
    >>> attempts = Attempts()
    >>> def nothing() -> None:
    ...     raise refuse("gauges", "there are none", "Add some")
    >>> attempts.of("sum", lambda: 1 + 1), attempts.of("range", nothing), attempts.missing
    (2, None, {'range': 'gauges: there are none. Add some.'})
    """

    def __init__(self, left_out: Container[str] = ()) -> None:
        self.missing: dict[str, str] = {}
        self._left_out = left_out

    def of(self, name: str, result: Callable[[], _Result]) -> _Result | None:
        """The result, or `None` with its reason noted."""
        if name in self._left_out:
            return None
        try:
            return result()
        except DesignError as error:
            self.missing[name] = str(error)
            return None

    def of_ground(self, name: str, ground: _Ground | None, reason: str, result: Callable[[_Ground], _Result]) -> _Result | None:
        """The result of its `ground` where that is there; else `None`, noted with the reason."""
        if ground is None and name not in self._left_out:
            self.missing[name] = reason
        return None if ground is None else self.of(name, lambda: result(ground))
