"""Shipped cases: the description with default or changed parameters, and the design file as a start for users."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from flexstage.cases.parameters import Stated, parameter, with_parameters
from flexstage.mechanism.grammar.formulas import PREFIX
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import loads, patch

FILES = Path(__file__).parent / "files"


@dataclass(frozen=True)
class Case:
    """Shipped case: the design file of its `name`, and a one-line `summary`."""

    name: str
    summary: str

    def build(self, stated: Mapping[str, Stated] | None = None) -> Mechanism:
        """Build the description with the parameter values `stated`: strings with units, SI numbers, or arrays for a batch.

        The tag of a changed number is removed, because the source in the tag does not contain the new value.

        >>> from flexstage.cases.registry import CASES
        >>> CASES["hexapod"].build({"slope": "50 deg"}).name
        'hexapod'
        """
        return with_parameters(_description(self.name), stated or {})

    def text(self, stated: Mapping[str, Stated], heading: str) -> str:
        """Return the design file, including comments, with the parameter values `stated` and a new `heading`."""
        own = {PREFIX + parameter(_description(self.name), name).name: value for name, value in stated.items()}
        text = file_text(self.name)
        head = "".join(f"# {line}".rstrip() + "\n" for line in heading.splitlines())
        return f"{head}\n{patch(text, own) if own else text}"


def file_text(name: str) -> str:
    """Return the design file of a case as shipped.

    >>> file_text("leaf-guide").splitlines()[0][:9]
    '# This gu'
    """
    return (FILES / f"{name}.toml").read_text(encoding="utf-8")


@cache
def _description(name: str) -> Mechanism:
    return loads(file_text(name), where=f"{name}.toml")
