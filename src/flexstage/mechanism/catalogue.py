"""Shipped catalogue: materials, piezo stacks and gauges, each number with its source."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

from flexstage.parts.gauge import Gauge
from flexstage.parts.material import Material
from flexstage.parts.piezo import Piezo


@dataclass(frozen=True)
class Section:
    """Entries of one class by name, as tables of a design file under `key`; `kind` identifies the class if the file requires it."""

    key: str
    record: type
    kind: str | None
    entries: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Catalogue:
    """Catalogue: sections of entries for `like`, and the sources of their tags."""

    sections: tuple[Section, ...]
    sources: Mapping[str, str]

    def section(self, record: type) -> Section | None:
        """Section of a class; `None` if there is none."""
        return next((section for section in self.sections if section.record is record), None)

    def sources_of(self, tags: Iterable[str]) -> dict[str, str]:
        """Sources named in tags (`stated key place`)."""
        keys = {word for tag in tags for word in tag.split()[1:2]}
        return {key: text for key, text in self.sources.items() if key in keys}


@functools.cache
def shipped_catalogue() -> Catalogue:
    """Return the catalogue of the package.

    >>> "SUS420" in shipped_catalogue().section(Material).entries
    True
    """
    text = resources.files("flexstage.mechanism").joinpath("catalogue.toml").read_text(encoding="utf-8")
    return catalogue_from(tomllib.loads(text))


def catalogue_from(raw: Mapping[str, Any]) -> Catalogue:
    """Read a catalogue from its tree: tables `materials`, `stacks`, `gauges` and `sources`.

    >>> catalogue_from({"materials": {"steel": {"young": "200 GPa"}}}).section(Material).entries["steel"]["young"]
    '200 GPa'
    """
    sections = (
        Section("materials", Material, None, raw.get("materials", {})),
        Section("parts", Piezo, "piezo", raw.get("stacks", {})),
        Section("sensors", Gauge, None, raw.get("gauges", {})),
    )
    return Catalogue(sections, raw.get("sources", {}))
