"""Notebook display: connection of results to the display modules."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import dataclass_transform

from flexstage.base.lazy import LazyModule


class RenderHook:
    """Display modules, registered at import of `flexstage` and loaded at first display.

    `tables` has `to_html(value)` and `to_text(value)`, `views` has `view(mechanism, *, motion)`.
    """

    tables: LazyModule
    views: LazyModule


class InNotebook:
    """A value that is printed in at most 25 lines, and that notebooks show as tables or a picture.

    >>> import numpy as np
    >>> from flexstage.base.labelled import Matrix
    >>> "<td" in Matrix(np.array([[2.0]]), ("a",), ("b",), "m")._repr_html_()
    True
    """

    def _repr_html_(self) -> str:
        return RenderHook.tables.to_html(self)

    def __str__(self) -> str:
        return RenderHook.tables.to_text(self)


@dataclass_transform(eq_default=False, frozen_default=True, field_specifiers=(field,))
class Result(InNotebook):
    """Base of results: frozen dataclasses, compared by identity, with notebook display.

    >>> class Speed(Result):
    ...     value: float
    >>> Speed(2.0).value, Speed(2.0) == Speed(2.0)
    (2.0, False)
    """

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        dataclass(frozen=True, eq=False)(cls)
