"""Progress of a computation: who follows it, and which part of the whole is being computed."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeAlias

Told: TypeAlias = Callable[[str, float], None]
"""Called with the work that is being done and the share of all work that is done, 0 to 1."""


def _ignore(_text: str, _share: float) -> None:
    """Nobody follows."""


_FOLLOWER: ContextVar[Told] = ContextVar("_FOLLOWER", default=_ignore)


@contextmanager
def followed(told: Told) -> Generator[None]:
    """Report the progress of what is computed within to `told`.

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
    """Count the work within as the part of the whole from `start` to `stop` (shares); `text` describes it."""
    outer = _FOLLOWER.get()
    with followed(lambda own, share: outer(text or own, start + share * (stop - start))):
        yield


def report(share: float, text: str = "") -> None:
    """Report the share of the present part that is done, 0 to 1; `text` describes it where the part does not."""
    _FOLLOWER.get()(text, share)
