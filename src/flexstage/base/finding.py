"""Findings: what is wrong with a user's input, told so that it can be mended.

A check returns findings (ask); `require` raises them together as one `DesignError` (throw).
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar

from flexstage.base.renamed import new_name


class Severity(Enum):
    """Severity of a finding: an error prevents results, a warning does not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True)
class Finding:
    """One thing wrong: the user's object (`B4/pivot`, or file and key), what was found with the numbers compared, and what to do."""

    where: str
    what: str
    advice: str
    severity: ClassVar[Severity] = Severity.ERROR

    def __str__(self) -> str:
        return f"{self.where}: {self.what}. {self.advice}."


@dataclass(frozen=True)
class DesignWarning(Finding):
    """A doubtful value or result, which prevents nothing."""

    severity = Severity.WARNING


class DesignError(ValueError):
    """All findings that keep a description, a file or a question from being answered."""

    def __init__(self, findings: Iterable[Finding]) -> None:
        self.findings = tuple(findings)
        super().__init__("\n".join(str(finding) for finding in self.findings))

    def __reduce__(self) -> tuple[type[DesignError], tuple[Any, ...]]:
        return type(self), (self.findings,)


class LowerBoundError(DesignError):
    """A quantity that is at least `bound`, and not known beyond."""

    def __init__(self, findings: Iterable[Finding], bound: float) -> None:
        super().__init__(findings)
        self.bound = bound

    def __reduce__(self) -> tuple[type[DesignError], tuple[Any, ...]]:
        return type(self), (self.findings, self.bound)


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


def join_findings(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Findings that say the same of several objects of one file (`file: name`) as one, which names them all.

    >>> print(*join_findings([Finding("a.csv: S1", "no unit", "State it"), Finding("a.csv: S2", "no unit", "State it")]))
    a.csv: S1, S2: no unit. State it.
    """
    groups: dict[tuple[str, str, str], list[str]] = {}
    for finding in findings:
        place, _, name = finding.where.rpartition(": ")
        groups.setdefault((place, finding.what, finding.advice), []).append(name)
    wheres = [f"{place}: {', '.join(names)}" if place else ", ".join(names) for (place, _, _), names in groups.items()]
    return tuple(Finding(where, what, advice) for where, (_, what, advice) in zip(wheres, groups, strict=True))


def name_first(names: Sequence[str], most: int = 8) -> str:
    """The first of some names, and how many more there are.

    >>> name_first(["b2"]), name_first(["b2", "b3", "b4", "b5"], most=2)
    ('b2', 'b2, b3 and 2 more')
    """
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def suggest_nearest(name: str, names: Iterable[str]) -> str:
    """Advice that names what is near to a misspelt or renamed name, or what there is.

    >>> suggest_nearest("plattform", ["ground", "platform"]), suggest_nearest("xyz", ["ground", "platform"])
    ('The nearest name is platform', 'There are ground, platform')
    """
    known = sorted(set(names))
    renamed = new_name(name, known)
    if renamed is not None:
        return f"It is called {renamed}"
    close = difflib.get_close_matches(name[:80], known, n=3, cutoff=0.6)
    if close:
        return f"The nearest name is {close[0]}" if len(close) == 1 else f"Near to it are {', '.join(close)}"
    if not known:
        return "There are none"
    return f"There are {', '.join(known[:12])}{' and more' if len(known) > 12 else ''}"
