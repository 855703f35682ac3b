"""The session: results that functions keep for later calls in this process; they can be listed and cleared.

Results of pure functions of small constants stay with `functools.lru_cache`: they are part of the program, not of what it computed.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar, cast

_Function = TypeVar("_Function", bound=Callable[..., Any])


class Session:
    """Results kept by function, the least recently used dropped first."""

    def __init__(self) -> None:
        self._kept: dict[str, Any] = {}

    def keep(self, most: int) -> Callable[[_Function], _Function]:
        """Decorate a pure function of hashable values: its last results, `most` at most, are kept.

        >>> session = Session()
        >>> half = session.keep(2)(lambda value: value / 2)
        >>> half(8.0), half(8.0), list(session.held().values())
        (4.0, 4.0, [1])
        >>> session.clear()
        >>> session.held()
        {}
        """

        def kept(function: _Function) -> _Function:
            found = functools.lru_cache(maxsize=most)(function)
            self._kept[f"{function.__module__}.{function.__qualname__}"] = found
            return cast("_Function", found)

        return kept

    def held(self) -> dict[str, int]:
        """Number of results kept, by function."""
        counts = {name: each.cache_info().currsize for name, each in self._kept.items()}
        return {name: count for name, count in counts.items() if count}

    def clear(self) -> None:
        """Drop all results kept."""
        for each in self._kept.values():
            each.cache_clear()


SESSION = Session()
"""That of this process."""
