"""Session cache: results of functions for later calls in this process; can be listed and cleared.

Pure functions of small constants use `functools.lru_cache` instead.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar, cast

_Function = TypeVar("_Function", bound=Callable[..., Any])


class Session:
    """Results cached by function, least recently used dropped first."""

    def __init__(self) -> None:
        self._kept: dict[str, Any] = {}

    def keep(self, most: int) -> Callable[[_Function], _Function]:
        """Decorate a pure function of hashable values to cache its last results, `most` at most.

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
        """Return the number of cached results by function."""
        counts = {name: each.cache_info().currsize for name, each in self._kept.items()}
        return {name: count for name, count in counts.items() if count}

    def clear(self) -> None:
        """Clear all results."""
        for each in self._kept.values():
            each.cache_clear()


SESSION = Session()
"""Session of this process."""
