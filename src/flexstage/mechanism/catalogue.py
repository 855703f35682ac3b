"""Catalogues of materials, actuators and sensors, each value with its source: the shipped catalogue, and files of users."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from importlib import resources
from typing import Any

from flexstage.parts.amplified import Amplified
from flexstage.parts.gauge import Gauge
from flexstage.parts.material import Material
from flexstage.parts.piezo import Piezo
from flexstage.parts.voice_coil import VoiceCoil


@dataclass(frozen=True)
class Section:
    """Section of a catalogue: the entries of one class by name. Each entry is a table, as in a design file under `key`.

    `kind` is the kind of part, or None if the entries are not parts.
    """

    name: str
    title: str
    key: str
    record: type
    kind: str | None
    entries: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Catalogue:
    """Catalogue of entries that `like` can name, in sections, with the sources of their tags."""

    sections: tuple[Section, ...]
    sources: Mapping[str, str]

    def section(self, record: type) -> Section | None:
        """Return the section of a class; `None` if the catalogue has no such section."""
        return next((section for section in self.sections if section.record is record), None)

    def extended(self, raw: Mapping[str, Any]) -> Catalogue:
        """Return the catalogue extended by the tree `raw` of another catalogue, whose entries take precedence.

        >>> result = Catalogue((), {}).extended({"materials": {"ours": {"young": "200 GPa"}}})
        >>> list(result.section(Material).entries)
        ['ours']
        """
        known = {section.name: section.entries for section in self.sections}
        return Catalogue(
            tuple(replace(each, entries={**known.get(each.name, {}), **raw.get(each.name, {})}) for each in SECTIONS),
            {**self.sources, **raw.get("sources", {})},
        )

    def sources_of(self, tags: Iterable[str]) -> dict[str, str]:
        """Return the sources named in tags (`stated key place`), by key."""
        keys = {word for tag in tags for word in tag.split()[1:2]}
        return {key: text for key, text in self.sources.items() if key in keys}


SECTIONS = (
    Section("materials", "Materials", "materials", Material, None, {}),
    Section("stacks", "Piezo stacks", "parts", Piezo, "piezo", {}),
    Section("amplified", "Amplified piezo actuators", "parts", Amplified, "amplified", {}),
    Section("coils", "Voice coils", "parts", VoiceCoil, "voice_coil", {}),
    Section("gauges", "Displacement sensors", "sensors", Gauge, None, {}),
)
"""Sections of a catalogue, without entries."""


@functools.cache
def shipped_catalogue() -> Catalogue:
    """Return the catalogue of the package.

    >>> "SUS420" in shipped_catalogue().section(Material).entries
    True
    """
    text = resources.files("flexstage.mechanism").joinpath("catalogue.toml").read_text(encoding="utf-8")
    return Catalogue((), {}).extended(tomllib.loads(text))
