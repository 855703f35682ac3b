"""Tables of a study's file read field by field: every finding is collected, nothing unknown is passed over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from flexstage.base.finding import DesignError, Finding, nearest
from flexstage.base.quantity import Quantity
from flexstage.base.unit import missing_unit, parse


@dataclass
class Fields:
    """The entries of one table at `where`; findings of all tables go to one list."""

    tree: Mapping[str, Any]
    where: str
    findings: list[Finding]
    asked: list[str] = field(default_factory=list)

    def at(self, key: str) -> str:
        """Where a key stands, for findings."""
        return f"{self.where}.{key}" if self.where else key

    def note(self, key: str, what: str, advice: str) -> None:
        """Add a finding about a key."""
        self.findings.append(Finding(self.at(key), what, advice))

    def raw(self, key: str, kind: type | tuple[type, ...], words: str, default: Any = None) -> Any:
        """The entry if it is of this kind; after a finding, and where it is absent, `default`."""
        self.asked.append(key)
        if key not in self.tree:
            return default
        found = self.tree[key]
        if isinstance(found, kind) and (kind is bool or not isinstance(found, bool)):
            return found
        self.note(key, f"found {found!r}", f"Give {words}")
        return default

    def text(self, key: str, default: str = "") -> str:
        """A text."""
        return self.raw(key, str, "a text in quotes", default)

    def whole(self, key: str, least: int, default: int) -> int:
        """A whole number of `least` or more; where it is absent, `default`."""
        found = self.raw(key, int, f"a whole number of {least} or more")
        if found is not None and found < least:
            self.note(key, f"found {found}", f"Give a whole number of {least} or more")
        return default if found is None or found < least else found

    def flag(self, key: str) -> bool:
        """True or false; absent is false."""
        return self.raw(key, bool, "true or false", default=False)

    def table(self, key: str) -> Fields:
        """An inner table; empty where absent."""
        return Fields(self.raw(key, Mapping, "a table", {}), self.at(key), self.findings)

    def texts(self, key: str) -> tuple[str, ...]:
        """A list of texts."""
        found = self.raw(key, list, "a list of texts", [])
        for number, item in enumerate(found):
            if not isinstance(item, str):
                self.note(f"{key}[{number}]", f"found {item!r}", "Give a text in quotes")
        return tuple(item for item in found if isinstance(item, str))

    def text_or_texts(self, key: str, default: str = "") -> tuple[str, ...]:
        """A text, or a list of them."""
        return self.texts(key) if isinstance(self.tree.get(key), list) else (self.text(key, default),)

    def number(self, key: str, quantity: Quantity, default: float | None = None) -> float | None:
        """A number with its unit, in SI; a ratio may be bare."""
        self.asked.append(key)
        if key not in self.tree:
            return default
        found = self.tree[key]
        try:
            if isinstance(found, str):
                return parse(found, quantity, where=self.at(key))
            if quantity.si == "1" and isinstance(found, (int, float)) and not isinstance(found, bool):
                return float(found)
            raise missing_unit(found, quantity, where=self.at(key))
        except DesignError as error:
            self.findings.extend(error.findings)
            return default

    def done(self) -> None:
        """Note every key that nothing has asked for."""
        for key in self.tree:
            if key not in self.asked:
                self.note(key, "nothing of this name is known here", nearest(key, self.asked))
