"""Checks of overrides and tags: valid addresses and values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from flexstage.base.finding import DesignError, Finding, suggest_nearest
from flexstage.base.number import Table
from flexstage.mechanism.addresses.address import ASSUMED, value_at
from flexstage.mechanism.addresses.locate import Place, locate
from flexstage.mechanism.mechanism import Mechanism

STATED = "stated"
DERIVED = "derived"
_WORDS = (STATED, DERIVED, ASSUMED)


def override_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of overrides: an override must address a link's value, have a value of the same kind, and be unique.

    >>> print(*override_findings(Mechanism("", overrides={"parts.neck.thickness": 0.001})))
    overrides."parts.neck.thickness": unknown name "neck". None is defined.
    """
    made: dict[str, str] = {}
    inside: dict[str, str] = {}
    for key, value in mechanism.overrides.items():
        where = f'overrides."{key}"'
        try:
            place = locate(mechanism, key)
        except DesignError as error:
            yield from (replace(finding, where=where) for finding in error.findings)
            continue
        yield from _override(mechanism, key, place, value)
        prefixes = [".".join((*place.owners[-1:], *place.path[:depth])) for depth in range(1, len(place.path) + 1)]
        other = inside.get(place.address) or next((made[prefix] for prefix in prefixes if prefix in made), None)
        if other is not None:
            yield Finding(where, f'overrides the same value as "{other}"', "Remove one of them")
        made[place.address] = key
        inside.update(dict.fromkeys(prefixes, key))


def _override(mechanism: Mechanism, key: str, place: Place, value: Any) -> Iterator[Finding]:
    where = f'overrides."{key}"'
    if not any(key.startswith(f"{owner}.") for owner in place.owners):
        advice = "Set that value directly; an override has the address unit/link.field or instance/link.field"
        yield Finding(where, f"{place.address} is not an override of a link", advice)
        return
    try:
        value_at(replace(mechanism, overrides=Table({key: value})), place)  # validates by construction
    except DesignError as error:
        yield from (replace(finding, where=where) for finding in error.findings)


def tag_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of tags: each must have the address of a value, and begin with stated, derived or assumed.

    >>> print(*tag_findings(Mechanism("", tags={"gravity": "published"})))
    tags."gravity": found "published", which does not begin with stated, derived or assumed. Use e.g. "stated paper 2.2".
    """
    without = replace(mechanism, overrides=Table({}))
    for address, tag in mechanism.tags.items():
        where = f'tags."{address}"'
        try:
            locate(without, address)
        except DesignError as error:
            yield from (replace(finding, where=where, what=f"unknown address: {finding.what}") for finding in error.findings)
        words = tag.split()
        if words[:1] not in [[word] for word in _WORDS]:
            what = f'found "{tag}", which does not begin with stated, derived or assumed'
            yield Finding(where, what, 'Use e.g. "stated paper 2.2"')
        elif words[0] == STATED and (len(words) < 2 or words[1] not in mechanism.sources):
            source = words[1] if len(words) > 1 else ""
            what = f'unknown source "{source}"' if source else "source missing"
            yield Finding(where, what, suggest_nearest(source, mechanism.sources))
