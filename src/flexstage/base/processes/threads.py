"""Threads of linear algebra. For many small matrices, a single thread is faster on a busy machine."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

_Given = ParamSpec("_Given")
_Found = TypeVar("_Found")


def one_thread(function: Callable[_Given, _Found]) -> Callable[_Given, _Found]:
    """Decorate a function to run with one linear-algebra thread; the caller's number of threads is restored.

    Sums in a single thread are bit-identical in every run.

    >>> one_thread(divmod)(7, 2)
    (3, 1)
    """

    @wraps(function)
    def limited(*arguments: _Given.args, **named: _Given.kwargs) -> _Found:
        with _libraries(len(sys.modules)).limit(limits=1):
            return function(*arguments, **named)

    return limited


@lru_cache(maxsize=1)
def _libraries(_modules: int) -> ThreadpoolController:
    """Linear-algebra libraries of this process, updated (in a millisecond) only after further imports."""
    return ThreadpoolController()
