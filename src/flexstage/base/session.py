"""Session cache: function results for later calls in this process. The cache can be listed and cleared."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar, cast

_Function = TypeVar("_Function", bound=Callable[..., Any])


class Session:
    """Cached results of functions. Each function's least recently used results are dropped first."""

    def __init__(self) -> None:
        self._kept: dict[str, Any] = {}

    def keep(self, most: int) -> Callable[[_Function], _Function]:
        """Return a decorator that caches at most `most` results of a pure function with hashable arguments.

        >>> session = Session()
        >>> half = session.keep(2)(lambda value: value / 2)
        >>> half(8.0), half(8.0), list(session.held().values())
        (4.0, 4.0, [1])
        >>> session.clear()
        >>> session.held()
        {}
        """

        def kept(function: _Function) -> _Function:
            result = functools.lru_cache(maxsize=most)(function)
            self._kept[f"{function.__module__}.{function.__qualname__}"] = result
            return cast("_Function", result)

        return kept

    def held(self) -> dict[str, int]:
        """Return the number of cached results of each function."""
        counts = {name: each.cache_info().currsize for name, each in self._kept.items()}
        return {name: count for name, count in counts.items() if count}

    def clear(self) -> None:
        """Clear all results."""
        for each in self._kept.values():
            each.cache_clear()


SESSION = Session()
"""Session of this process."""
