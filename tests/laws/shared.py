"""Random stages drawn once for all laws: drawing one takes ten times as long as reading it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from flexstage.models import ideal as _ideal
from flexstage.models import lumped as _lumped
from tests.conftest import FULL, QUICK

_KEPT = 800
"""Models kept at a time: of the stages that laws share, and of what they were last turned into."""

ideal = lru_cache(maxsize=_KEPT)(_ideal.ideal)
lumped = lru_cache(maxsize=_KEPT)(_lumped.lumped)


_STORED = settings().max_examples if QUICK else 100
"""Stages of a store: enough that every kind is among them."""


class Shared:
    """In the usual tests a strategy called without arguments gives stages of a common store, at least as many as a law has examples.

    So a law of stages alone is still tried on that many different ones, and `test_all_kinds_are_drawn` says that every kind is among
    them. The full tests draw stages anew for every law, many times as many. `fresh` is the strategy itself.
    """

    def __init__(self, fresh: Callable[..., st.SearchStrategy[Any]]) -> None:
        self.fresh = fresh
        self._store = cache(lambda: _drawn(fresh(), _STORED))
        self._stored = st.integers(0, _STORED - 1).map(lambda number: self._store()[number])

    def __call__(self, *arguments: Any, **named: Any) -> st.SearchStrategy[Any]:
        return self.fresh(*arguments, **named) if FULL or arguments or named else self._stored


def _drawn(strategy: st.SearchStrategy[Any], count: int) -> list[Any]:
    """What one law would be tried on, even if the one that asks first is tried on fewer."""
    found: list[Any] = []

    @settings(max_examples=count)
    @given(strategy)
    def keep(stage: Any) -> None:
        found.append(stage)

    keep()
    return found
