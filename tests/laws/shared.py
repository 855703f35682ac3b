"""Random stages drawn once for all laws: drawing one takes ten times as long as reading it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.conftest import FULL


def shared(strategy: Callable[..., st.SearchStrategy[Any]]) -> Callable[..., st.SearchStrategy[Any]]:
    """In the quick tests a strategy called without arguments gives stages of a common store, as many as a law has examples.

    So a law of stages alone is still tried on that many different ones, and `test_all_kinds_are_drawn` says that every kind is among
    them. The full tests draw stages anew for every law, ten times as many.
    """
    if FULL:
        return strategy
    count = settings().max_examples
    store = cache(lambda: _drawn(strategy(), count))
    stored = st.integers(0, count - 1).map(lambda number: store()[number])
    return lambda *arguments, **named: strategy(*arguments, **named) if arguments or named else stored


def _drawn(strategy: st.SearchStrategy[Any], count: int) -> list[Any]:
    """What one law would be tried on, even if the one that asks first is tried on fewer."""
    found: list[Any] = []

    @settings(max_examples=count)
    @given(strategy)
    def keep(stage: Any) -> None:
        found.append(stage)

    keep()
    return found
