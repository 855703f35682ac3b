"""Requirements of this installation: the ranges its metadata states, and the versions it was tested with.

Nothing here needs a third party, but for the reading of version ranges, which pip carries along where `packaging` is missing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, metadata, requires
from pathlib import Path
from typing import Any

from flexstage.apps.installed import normalised

_BESIDE = Path(__file__).with_name("pinned.txt")
_CHECKOUT = Path(__file__).parents[3] / "requirements" / "runtime.txt"


@dataclass(frozen=True)
class Need:
    """A package that flexstage needs: its normalised `name`, the `versions` that will do (`>=2.0`), and the `extra` that asks for it.

    `extra` is empty for what is always needed.
    """

    name: str
    versions: str
    extra: str

    def admits(self, version: str) -> bool:
        """Whether a version is in the range."""
        return requirement(f"{self.name}{self.versions}").specifier.contains(version, prereleases=True)


def requirement(text: str) -> Any:
    """A requirement as `packaging` parses it.

    >>> requirement("numpy>=2.0 ; python_version > '3'").name
    'numpy'
    """
    try:
        module = import_module("packaging.requirements")
    except ImportError:
        module = import_module("pip._vendor.packaging.requirements")
    return module.Requirement(text)


def can_parse() -> bool:
    """Whether requirements can be parsed at all: `packaging` or pip is there.

    >>> can_parse()
    True
    """
    try:
        requirement("flexstage")
    except ImportError:
        return False
    return True


def python_versions() -> str:
    """The Python versions flexstage runs on, as its metadata states them; empty when it is not installed.

    >>> python_versions()
    '>=3.11'
    """
    try:
        return metadata("flexstage")["Requires-Python"]
    except (PackageNotFoundError, KeyError):
        return ""


def needs(*extras: str) -> tuple[Need, ...]:
    """The packages flexstage needs here, and those of the given extras.

    >>> "numpy" in [need.name for need in needs()]
    True
    """
    try:
        lines = requires("flexstage") or []
    except PackageNotFoundError:
        return ()
    found = (_need(line, extras) for line in lines)
    return tuple(need for need in found if need)


def _need(line: str, extras: tuple[str, ...]) -> Need | None:
    parsed = requirement(line)
    for extra in ("", *extras):
        if parsed.marker is None or parsed.marker.evaluate({"extra": extra}):
            return Need(normalised(parsed.name), str(parsed.specifier), extra)
    return None


def needs_of(direct: Iterable[Need]) -> Iterator[Need]:
    """What the given packages need in turn, each once, as far as they are installed: a missing one does not say what it needs.

    >>> "contourpy" in [need.name for need in needs_of(needs())]
    True
    """
    waiting = list(direct)
    seen = {need.name for need in waiting}
    while waiting:
        for need in _requires(waiting.pop().name):
            if need.name not in seen:
                seen.add(need.name)
                waiting.append(need)
                yield need


def _requires(name: str) -> tuple[Need, ...]:
    try:
        lines = requires(name) or []
    except (PackageNotFoundError, ValueError):
        return ()
    return tuple(need for line in lines if (need := _need(line, ())))


def pins() -> dict[str, str]:
    """The tested version of every package needed here, with the hashes of its files: name to the lines of a requirements file.

    Empty where the list was neither packed beside this file nor stands in a checkout.

    >>> pins()["numpy"].startswith("numpy==")
    True
    """
    source = _BESIDE if _BESIDE.exists() else _CHECKOUT
    return parsed_pins(source.read_text(encoding="utf-8")) if source.exists() else {}


def parsed_pins(text: str) -> dict[str, str]:
    r"""The pins of a requirements file that apply to the running Python, by normalised name.

    >>> parsed_pins("Some_Thing==1.0 --hash=sha256:00\nother==2 ; python_version < '3' --hash=sha256:00")
    {'some-thing': 'Some_Thing==1.0 --hash=sha256:00'}
    """
    code = "\n".join(line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#"))
    blocks = re.split(r"\n(?=\S)", code) if code else []
    found = ((block, requirement(block.split("--hash")[0].strip(" \\\n"))) for block in blocks)
    return {normalised(parsed.name): block for block, parsed in found if parsed.marker is None or parsed.marker.evaluate()}
