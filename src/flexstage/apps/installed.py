"""Installed packages: are all their files there? Standard library only, so that it runs before anything is installed.

What installers wrote is read here and not by `importlib.metadata`: its backport, which some packages bring and which takes its place once
it is imported, leaves out the files that are lost.
"""

from __future__ import annotations

import csv
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from email.parser import HeaderParser
from pathlib import Path


@dataclass(frozen=True)
class Package:
    """A package found in a Python environment: its normalised `name`, its `version` and how many of its files are `lost`.

    A file is lost when it is absent or when its size is not the recorded one. A package without a record of files counts one loss.
    """

    name: str
    version: str
    lost: int


def normalised(name: str) -> str:
    """The name of a package in the one spelling that compares equal (PEP 503).

    >>> normalised("MyST_Parser")
    'myst-parser'
    """
    return re.sub(r"[-_.]+", "-", name).lower()


def packages(folders: Iterable[Path | str]) -> dict[str, Package]:
    """All packages installed in the given `site-packages` folders, by normalised name.

    >>> packages([])
    {}
    """
    found = (_package(each) for folder in folders for each in _records(Path(folder)))
    return {package.name: package for package in found if package}


def package(name: str) -> Package | None:
    """The package of that name in the running environment, or None.

    >>> package("no such package") is None
    True
    """
    records = (each for folder in sys.path for each in _records(Path(folder)))
    named = (each for each in records if normalised(each.name.partition("-")[0]) == normalised(name))
    return next((found for each in named if (found := _package(each))), None)


def _records(folder: Path) -> Iterator[Path]:
    """Folders in which installers keep what they know of each package."""
    return (each for each in sorted(folder.glob("*.dist-info")) if each.is_dir())


def _package(record: Path) -> Package | None:
    """A package; half-removed ones leave a folder without metadata."""
    try:
        metadata = HeaderParser().parsestr((record / "METADATA").read_text(encoding="utf-8"))
    except OSError:
        return None
    if "Name" not in metadata or "Version" not in metadata:
        return None
    return Package(normalised(metadata["Name"]), metadata["Version"], _lost(record))


def _lost(record: Path) -> int:
    try:
        rows = list(csv.reader((record / "RECORD").read_text(encoding="utf-8").splitlines()))
    except OSError:
        return 1
    # Byte code is rewritten at will, and so is the record itself (pip writes it last, without a size).
    checked = [(row[0], row[2] if len(row) > 2 else "") for row in rows if row and not row[0].endswith(".pyc")]
    return sum(_is_lost(record.parent / name, int(size) if size else None) for name, size in checked)


def _is_lost(path: Path, size: int | None) -> bool:
    try:
        present = path.stat().st_size
    except OSError:
        return True
    return size is not None and present != size
