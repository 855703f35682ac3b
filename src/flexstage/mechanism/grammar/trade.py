"""Synonyms of kinds and keys (`synonyms.toml`), for hints about unknown words in a file."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection
from functools import cache
from importlib import resources
from typing import Any

from flexstage.base.finding import list_choices, suggest_nearest
from flexstage.base.renamed import new_name


@cache
def _words() -> dict[str, dict[str, Any]]:
    """Kinds, keys and remarks by synonym."""
    return tomllib.loads(resources.files("flexstage.mechanism.grammar").joinpath("synonyms.toml").read_text(encoding="utf-8"))


def advise_kind(word: str, known: Collection[str]) -> str:
    """Return a hint for an unknown kind or shape: the kind with the word as synonym, else the most similar names.

    >>> advise_kind("Leaf-Spring", ["leaf", "notch"]), advise_kind("leef", ["leaf", "notch"])
    ('Use leaf', 'Use leaf')
    """
    plain = re.sub(r"[\s_-]", "", word.strip('"').lower())
    meant = [kind for kind, words in _words()["kinds"].items() if kind in known and plain in words]
    if not meant:
        return suggest_nearest(word.strip('"'), known)
    remarks = _words()["remarks"]
    return f"Use {' or '.join(f'{kind} ({remarks[kind]})' if kind in remarks else kind for kind in meant)}"


def advise_key(key: str, unused: Collection[str], known: Collection[str]) -> str:
    """Return a hint for an unknown key: the key with this synonym, else similar names, `unused` keys first.

    >>> advise_key("E", {"young", "density"}, {"young", "density"}), advise_key("thicknes", {"section"}, {"section", "thickness"})
    ('Use young', 'Use thickness')
    """
    meant = [name for name in known if key in _words()["keys"].get(name, ()) or name == new_name(key, known)]
    if meant:
        return f"Use {list_choices(meant)}"
    return suggest_nearest(key, unused, otherwise=suggest_nearest(key, known))
