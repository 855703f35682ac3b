"""Registers of kinds: flexstage's own kinds, and kinds that other packages provide through entry points."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar

from flexstage.base.finding import refuse

PREFIX = "flexstage."
"""First letters of the names of all entry-point groups for kinds of other packages, one group per register."""
Entry = TypeVar("Entry")


@dataclass(frozen=True)
class Register(Generic[Entry]):
    """Entries by kind: `own` entries, and entries of installed packages in the entry-point `group`, which are loaded on first use."""

    group: str
    own: Mapping[str, Entry]

    def __iter__(self) -> Iterator[str]:
        """Iterate over all kinds, own ones first."""
        yield from self.own
        yield from dict.fromkeys(offer.name for offer in _offered(self.group) if offer.name not in self.own)

    def get(self, kind: str) -> Entry | None:
        """Return the entry of a kind, or `None` if there is none. Raises `DesignError` if it cannot be loaded or has several providers.

        >>> Register("flexstage.nothing", {"leaf": 1.0}).get("leaf")
        1.0
        """
        offers = [offer for offer in _offered(self.group) if offer.name == kind]
        if len(offers) + (kind in self.own) > 1:
            who = ", ".join([*(["flexstage"] if kind in self.own else []), *(_distribution(offer) for offer in offers)])
            raise refuse(f"{self.group}: {kind}", f"several packages provide this kind: {who}", "Uninstall all of these packages but one")
        return self.own[kind] if kind in self.own else _load(offers[0]) if offers else None

    def offer(self, kind: str) -> str:
        """Return name and version of the package that provides a kind; an empty string for a kind of flexstage itself."""
        return ", ".join(_distribution(offer) for offer in _offered(self.group) if offer.name == kind)

    @property
    def all(self) -> dict[str, Entry]:
        """Return every entry by kind."""
        result = {kind: self.get(kind) for kind in self}
        return {kind: entry for kind, entry in result.items() if entry is not None}


def origin(module: str) -> str:
    """Return name and version of the installed package that contains a module; an empty string for flexstage and scripts.

    Digests include the name and version, because results of a class may change with its package's version.

    >>> origin("flexstage.parts.leaf")
    ''
    """
    return "" if module.startswith(PREFIX) else _origin(module.partition(".")[0])


@functools.cache
def _origin(package: str) -> str:
    groups = (group for group in _installed().groups if group.startswith(PREFIX))
    offers = [offer for group in groups for offer in _offered(group) if offer.module.partition(".")[0] == package]
    return ", ".join(sorted({_distribution(offer) for offer in offers}))


@functools.cache
def _offered(group: str) -> tuple[EntryPoint, ...]:
    return tuple(_installed().select(group=group))


@functools.cache
def _installed() -> Any:
    """Entry points of all packages, cached: every installed package has a separate file."""
    return entry_points()


def _distribution(offer: EntryPoint) -> str:
    return f"{offer.dist.name} {offer.dist.version}" if offer.dist is not None else offer.value


@functools.cache
def _load(offer: EntryPoint) -> Entry:  # type: ignore[type-var]
    try:
        return offer.load()
    except Exception as error:
        what = f"{_distribution(offer)} provides this kind, but the kind cannot be loaded: {type(error).__name__}: {error}"
        raise refuse(f"{offer.group}: {offer.name}", what, "Reinstall this package, or ask its maintainer") from error
