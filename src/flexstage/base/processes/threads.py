"""Threads of linear algebra: one where many small matrices run, for a second one costs far more than it gives on a busy machine."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

_Given = ParamSpec("_Given")
_Found = TypeVar("_Found")


def one_thread(function: Callable[_Given, _Found]) -> Callable[_Given, _Found]:
    """The function, with one thread for linear algebra while it runs; the caller's number of threads is restored when it is left.

    Sums over several threads are not the same to the bit from run to run: with one they are.

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
    """The libraries of linear algebra that this process has: looked for anew, which takes a millisecond, only after further imports."""
    return ThreadpoolController()
