"""Installed packages: are all their files there? Standard library only, so that it runs before anything is installed."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.metadata import Distribution, PackageNotFoundError, distributions
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
    found = (_package(each) for each in distributions(path=[str(folder) for folder in folders]))
    return {package.name: package for package in found if package}


def package(name: str) -> Package | None:
    """The package of that name in the running environment, or None.

    >>> package("no such package") is None
    True
    """
    try:
        return _package(Distribution.from_name(name))
    except (PackageNotFoundError, ValueError):
        return None


def _package(distribution: Distribution) -> Package | None:
    # Half-removed packages leave a folder without metadata: importlib.metadata then has no name to give.
    metadata = distribution.metadata
    if metadata is None or "Name" not in metadata or "Version" not in metadata:  # pyright: ignore[reportUnnecessaryComparison]
        return None
    return Package(normalised(metadata["Name"]), metadata["Version"], _lost(distribution))


def _lost(distribution: Distribution) -> int:
    files = distribution.files
    if files is None:
        return 1
    # Byte code is rewritten at will, and so is the record itself (pip writes it last, without a size).
    checked = (file for file in files if file.suffix != ".pyc")
    return sum(_is_lost(Path(str(file.locate())), file.size) for file in checked)


def _is_lost(path: Path, size: int | None) -> bool:
    try:
        present = path.stat().st_size
    except OSError:
        return True
    return size is not None and present != size
