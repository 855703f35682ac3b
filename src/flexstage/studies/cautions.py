"""Cautions: what does not keep a stage from being read, but should be known with its results."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.analysis.requirements import requirements
from flexstage.analysis.workspace.room import room
from flexstage.base.finding import DesignError, Finding
from flexstage.beams.validity import validity
from flexstage.mechanism.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.readings.ideal import ideal
from flexstage.readings.lumped import lumped


def cautions(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Parts outside the range that beam theory was compared with, and outlines beyond the envelope or in the clear opening.

    A part that departs from the shared one is told by its link.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> cautions(double_triangle())
    ()
    """
    return (*part_cautions(mechanism), *_room(mechanism))


def reading_findings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """What keeps a sound description from being read: actuators without a path, a mechanism that gives way, unreadable requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> reading_findings(double_triangle())
    ()
    """
    found: list[Finding] = []
    for read in (requirements, ideal, lumped):
        try:
            read(mechanism)
        except DesignError as error:
            found += error.findings
    return tuple(found)


def part_cautions(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Parts outside the range that beam theory was compared with.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> part_cautions(double_triangle())
    ()
    """
    return tuple(_validity(mechanism))


def _validity(mechanism: Mechanism) -> Iterator[Finding]:
    shared = mechanism.parts
    told: set[str] = set()
    for link in expand(mechanism).links.values():
        departs = link.part != shared[link.link.part]
        where = link.name if departs else f"parts.{link.link.part}"
        if where not in told:
            told.add(where)
            yield from validity(link.part, where).findings


def _room(mechanism: Mechanism) -> tuple[Finding, ...]:
    try:
        return room(mechanism).findings
    except DesignError as error:
        return error.findings
