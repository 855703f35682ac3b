"""Options taken as typer takes them, without its pydantic where none is needed: importing that takes longer than reading all options."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

_READERS: dict[Any, Callable[[Any], Any]] = {str: str, Path: Path, list[str]: str}


class PlainOptions:
    """A command of typer whose options take by themselves what is not given, texts, paths and what has a reader of its own."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Its arguments and options, help among them."""
        found: list[Any] = super().get_params(ctx)  # pyright: ignore[reportAttributeAccessIssue]
        for each in found:
            each.get_runtime_param = partial(Taken, each)
        return found


class Taken:
    """What takes the value of an option."""

    def __init__(self, option: Any) -> None:
        told = option.type_descriptor
        self._read = told.parameter_info.parser or _READERS.get(told.annotation)

    def coerce(self, value: Any, param: Any, ctx: Any) -> Any:
        """The value that the command is called with."""
        several = param.multiple or param.nargs == -1
        if value is None:
            return () if several else None
        if self._read is None:
            return type(param).get_runtime_param(param).coerce(value, param=param, ctx=ctx)
        return [self._read(each) for each in value] if several else self._read(value)
