"""Findings: faults in a user's input, each with a message of one form.

The form is `KEY: PROBLEM (got VALUE, expected CONDITION). HINT.`; the key may begin with file and line.

A check returns findings; `require` raises them together as one `DesignError`.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, ClassVar

from flexstage.base.renamed import new_name

_SUGGESTIONS = 6
_VALUE = re.compile(r"got ([0-9][0-9.]*(?:e[+-]?[0-9]+)?)(?=.* or (less|more)\))(.*)", re.DOTALL)
"""Value in a text with a bound, and the allowed side of the bound."""


class Severity(Enum):
    """Severity of a finding: an error prevents results, a warning does not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True)
class Finding:
    """A fault: its place (file, line and key, or an object such as `B4/pivot`), the problem with its value, and an imperative hint."""

    where: str
    what: str
    advice: str
    severity: ClassVar[Severity] = Severity.ERROR

    def __str__(self) -> str:
        return f"{self.where}: {self.what}.{f' {self.advice}.' if self.advice else ''}"


@dataclass(frozen=True)
class DesignWarning(Finding):
    """Warning about a doubtful value or result, which is still computed."""

    severity = Severity.WARNING


class DesignError(ValueError):
    """All faults found in a description, a file or a request."""

    def __init__(self, findings: Iterable[Finding]) -> None:
        self.findings = tuple(findings)
        super().__init__("\n".join(str(finding) for finding in self.findings))

    def __reduce__(self) -> tuple[type[DesignError], tuple[Any, ...]]:
        return type(self), (self.findings,)


class LowerBoundError(DesignError):
    """Error for a quantity for which only a lower `bound` is known."""

    def __init__(self, findings: Iterable[Finding], bound: float) -> None:
        super().__init__(findings)
        self.bound = bound

    def __reduce__(self) -> tuple[type[DesignError], tuple[Any, ...]]:
        return type(self), (self.findings, self.bound)


def require(findings: Iterable[Finding]) -> None:
    """Raise a `DesignError` with all findings, or return if there are no findings.

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
    """Merge equal errors of several objects of one file (`file: name`) into one error with all names.

    >>> print(*join_findings([Finding("a.csv: S1", "no unit", "Add it"), Finding("a.csv: S2", "no unit", "Add it")]))
    a.csv: S1, S2: no unit. Add it.
    """
    groups: dict[tuple[str, str, str], list[str]] = {}
    for finding in findings:
        place, _, name = finding.where.rpartition(": ")
        groups.setdefault((place, finding.what, finding.advice), []).append(name)
    wheres = [f"{place}: {', '.join(names)}" if place else ", ".join(names) for (place, _, _), names in groups.items()]
    return tuple(Finding(where, what, advice) for where, (_, what, advice) in zip(wheres, groups, strict=True))


def combine_warnings(warnings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Merge warnings that differ only in object and value into one warning with the worst value and the number of warnings.

    >>> large = [Finding(f"B{each}", f"stress too large (got {each} MPa, expected 1 MPa or less)", "Reduce it") for each in (2, 4, 3)]
    >>> print(*combine_warnings(large))
    B4 (worst of 3): stress too large (got 4 MPa, expected 1 MPa or less). Reduce it.
    """
    groups: dict[tuple[str, str], list[Finding]] = {}
    for each in warnings:
        groups.setdefault((_VALUE.sub(r"\3", each.what), each.advice), []).append(each)
    return tuple(map(_worst, groups.values()))


def _worst(group: Sequence[Finding]) -> Finding:
    """Finding with the value farthest beyond the bound; for equal texts the first, with the other names."""
    values = [float(result[1]) * (1.0 if result[2] == "less" else -1.0) for each in group if (result := _VALUE.search(each.what))]
    if len(group) == 1 or not values:
        return replace(group[0], where=name_first(list(dict.fromkeys(each.where for each in group)), most=3))
    worst = group[values.index(max(values))]
    return replace(worst, where=f"{worst.where} (worst of {len(group)})")


def name_first(names: Sequence[str], most: int = 8) -> str:
    """Return a string with the first `most` names and the number of further names.

    >>> name_first(["b2"]), name_first(["b2", "b3", "b4", "b5"], most=2)
    ('b2', 'b2, b3 and 2 more')
    """
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def suggest_nearest(name: str, names: Iterable[str], *, otherwise: str = "") -> str:
    """Return a hint for an unknown name.

    The hint is the new name of a renamed item, or at most six similar names (the nearest first). Without a similar name, the hint is
    `otherwise` or some known names.

    >>> suggest_nearest("plattform", ["ground", "platform"]), suggest_nearest("xyz", ["ground", "platform"])
    ('Use platform', 'Use ground or platform')
    """
    known = list(dict.fromkeys(names))
    renamed = new_name(name, known)
    if renamed is not None:
        return f"Use {renamed}"
    lowered = {each.lower().removeprefix("--"): each for each in known}
    word = name[:80].lower().removeprefix("--")
    begin = [each for each in lowered if len(word) > 2 and each.startswith(word)]
    ratios = {each: difflib.SequenceMatcher(None, each, word).ratio() for each in lowered}
    close = sorted((each for each in ratios if ratios[each] >= 0.6), key=ratios.__getitem__, reverse=True)
    similar = [lowered[each] for each in (begin or close)[:_SUGGESTIONS]]
    if otherwise and not similar:
        return otherwise
    if not known:
        return "None is defined"
    if similar or len(known) <= _SUGGESTIONS:
        return f"Use {list_choices(similar or known)}"
    return f"Use e.g. {list_choices(known[:3])}"


def unknown_names(names: Iterable[str], known: Collection[str], what: str) -> Iterator[Finding]:
    """Return a finding for each of the names that is not `known`.

    >>> print(*unknown_names(["x", "q"], ["x", "y"], "axis"))
    q: unknown axis. Use x or y.
    """
    return (Finding(name, f"unknown {what}", suggest_nearest(name, known)) for name in names if name not in known)


def list_choices(names: Sequence[str]) -> str:
    """Return names as alternatives.

    >>> list_choices(["x", "y", "z"]), list_choices(["x"])
    ('x, y or z', 'x')
    """
    return " or ".join([*filter(None, [", ".join(names[:-1])]), *names[-1:]])
