"""Threads of linear algebra. For many small matrices, a single thread is faster on a busy machine."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

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
        with threadpool_limits(limits=1):
            return function(*arguments, **named)

    return limited
