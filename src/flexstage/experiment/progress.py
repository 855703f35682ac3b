"""Progress of a computation, reported to a callback function as a completed fraction."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeAlias, TypeVar

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
ProgressCallback: TypeAlias = Callable[[str, float], None]
"""Callback with two arguments: a description of the current step, and the completed fraction, 0 to 1."""


def _ignore(_text: str, _share: float) -> None:
    """Without observer."""


_FOLLOWER: ContextVar[ProgressCallback] = ContextVar("_FOLLOWER", default=_ignore)


@contextmanager
def followed(told: ProgressCallback) -> Generator[None]:
    """Report the progress of computations inside the `with` block to the callback `told`.

    >>> with followed(print), part(0.5, 1.0, "finding modes"):
    ...     report(0.5)
    finding modes 0.75
    """
    token = _FOLLOWER.set(told)
    try:
        yield
    finally:
        _FOLLOWER.reset(token)


@contextmanager
def part(start: float, stop: float, text: str = "") -> Generator[None]:
    """Report the progress 0 to 1 of the `with` block as `start` to `stop` of the enclosing block; `text` describes the block."""
    outer = _FOLLOWER.get()
    with followed(lambda own, share: outer(text or own, start + share * (stop - start))):
        yield


def each_part(compute: Callable[[_Item], _Result], items: Sequence[_Item]) -> list[_Result]:
    """Return the results of a computation for all items; each item is an equal part of the progress.

    >>> with followed(print):
    ...     each_part(lambda item: report(item), [0.5, 1.0])
     0.25
     1.0
    [None, None]
    """
    found: list[_Result] = []
    for index, item in enumerate(items):
        with part(index / len(items), (index + 1) / len(items)):
            found.append(compute(item))
    return found


def report(share: float, text: str = "") -> None:
    """Report the completed fraction of the current part, 0 to 1; `text` is used if the part has no description of its own."""
    _FOLLOWER.get()(text, share)
