"""Findings: what is wrong with a user's input, told so that it can be mended.

A check returns findings (ask); `require` raises them together as one `DesignError` (throw).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One thing wrong: the user's object (`B4/pivot`, or file and key), what was found with the numbers compared, and what to do."""

    where: str
    what: str
    advice: str

    def __str__(self) -> str:
        return f"{self.where}: {self.what}. {self.advice}."


class DesignError(ValueError):
    """All findings that keep a description, a file or a question from being answered."""

    def __init__(self, findings: Iterable[Finding]) -> None:
        self.findings = tuple(findings)
        super().__init__("\n".join(str(finding) for finding in self.findings))

    def __reduce__(self) -> tuple[type[DesignError], tuple[tuple[Finding, ...]]]:
        return type(self), (self.findings,)


def require(findings: Iterable[Finding]) -> None:
    """Raise a `DesignError` with all findings, or return if there are none.

    >>> require([])
    """
    collected = tuple(findings)
    if collected:
        raise DesignError(collected)


def refuse(where: str, what: str, advice: str) -> DesignError:
    """Return a `DesignError` of a single finding, to be raised.

    >>> str(refuse("B4/pivot", "thickness is -1 mm", "give a positive thickness"))
    'B4/pivot: thickness is -1 mm. give a positive thickness.'
    """
    return DesignError([Finding(where, what, advice)])
