"""Registers: what a floor knows of each kind of thing. Its own kinds it states itself; other packages offer theirs by entry points."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Generic, TypeVar

from flexstage.base.finding import refuse

PREFIX = "flexstage."
GROUPS = tuple(f"{PREFIX}{name}" for name in ("parts", "laws", "shapes", "gauges", "measures", "formats", "controllers", "amplifiers"))
"""Groups of entry points by which packages offer what they add, a group a register."""
Entry = TypeVar("Entry")


@dataclass(frozen=True)
class Register(Generic[Entry]):
    """Entries by kind: the floor's `own`, and those that installed packages offer in the entry-point `group`, loaded when asked for.

    A kind without an entry is unknown there, which is for who asks to say. Processes that are started later load the same packages.
    """

    group: str
    own: Mapping[str, Entry]

    def __iter__(self) -> Iterator[str]:
        """All kinds, the floor's own first."""
        yield from self.own
        yield from dict.fromkeys(offer.name for offer in _offered(self.group) if offer.name not in self.own)

    def get(self, kind: str) -> Entry | None:
        """The entry of a kind; `None` where there is none. Raises `DesignError` for one that cannot be loaded, or is offered twice.

        >>> Register("flexstage.nothing", {"leaf": 1.0}).get("leaf")
        1.0
        """
        offers = [offer for offer in _offered(self.group) if offer.name == kind]
        if len(offers) + (kind in self.own) > 1:
            who = ", ".join([*(["flexstage"] if kind in self.own else []), *(_distribution(offer) for offer in offers)])
            raise refuse(f"{self.group}: {kind}", f"it is offered by {who}", "Uninstall all of these packages but one")
        return self.own[kind] if kind in self.own else _load(offers[0]) if offers else None

    def offer(self, kind: str) -> str:
        """Name and version of the package that offers a kind; empty for the floor's own."""
        return ", ".join(_distribution(offer) for offer in _offered(self.group) if offer.name == kind)

    @property
    def all(self) -> dict[str, Entry]:
        """Every entry by kind."""
        found = {kind: self.get(kind) for kind in self}
        return {kind: entry for kind, entry in found.items() if entry is not None}


def origin(module: str) -> str:
    """Name and version of the installed package that offers what stands in a module; empty for flexstage's own and for scripts.

    It is part of digests: what a class of another package computes may change with its version.

    >>> origin("flexstage.parts.leaf")
    ''
    """
    return "" if module.startswith(PREFIX) else _origin(module.partition(".")[0])


def offered_packages() -> tuple[str, ...]:
    """Names and versions of all installed packages that offer something, sorted."""
    return tuple(sorted({_distribution(offer) for group in GROUPS for offer in _offered(group)}))


@functools.cache
def _origin(package: str) -> str:
    offers = [offer for group in GROUPS for offer in _offered(group) if offer.module.partition(".")[0] == package]
    return ", ".join(sorted({_distribution(offer) for offer in offers}))


@functools.cache
def _offered(group: str) -> tuple[EntryPoint, ...]:
    return _known_offers()[group] if group in GROUPS else tuple(entry_points(group=group))


@functools.cache
def _known_offers() -> Mapping[str, tuple[EntryPoint, ...]]:
    """What packages offer to all registers, read once: every installed package has a file of its own."""
    found = entry_points()
    return {group: tuple(found.select(group=group)) for group in GROUPS}


def _distribution(offer: EntryPoint) -> str:
    return f"{offer.dist.name} {offer.dist.version}" if offer.dist is not None else offer.value


@functools.cache
def _load(offer: EntryPoint) -> Entry:  # type: ignore[type-var]
    try:
        return offer.load()
    except Exception as error:
        what = f"{_distribution(offer)} offers it, and it cannot be loaded: {type(error).__name__}: {error}"
        raise refuse(f"{offer.group}: {offer.name}", what, "Install that package again, or ask who maintains it") from error
