"""Options that are one of a few words: read, shown in the help, and told in one line where the word is none of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from types import MappingProxyType
from typing import TypeVar

import typer

from flexstage.apps.cli.failure import BAD_INPUT
from flexstage.apps.cli.speech import tell

_Kind = TypeVar("_Kind", bound=Enum)
_NOTHING: Mapping[str, str] = MappingProxyType({})


def choice(option: str, kind: type[_Kind], otherwise: Mapping[str, str] = _NOTHING) -> Callable[[str | _Kind], _Kind]:
    """A reader of an option's word; `otherwise` says what to do instead for words that one might expect."""

    def read(word: str | _Kind) -> _Kind:
        for each in kind:
            if word in (each, each.value):  # each: the default
                return each
        advice = f" {otherwise[str(word)]}." if word in otherwise else ""
        tell(f'error: {option}: "{word}" is none of {", ".join(str(each.value) for each in kind)}.{advice}')
        raise typer.Exit(BAD_INPUT)

    return read


def choices(kind: type[Enum]) -> str:
    """The words of an option as the help shows them."""
    return f"<{'|'.join(str(each.value) for each in kind)}>"
