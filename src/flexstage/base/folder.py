"""The folder for what may be computed again: named by the environment, or the user's own."""

from __future__ import annotations

import os
import sys
from pathlib import Path

FOLDER_VARIABLE = "FLEXSTAGE_CACHE"


def cache_folder() -> Path:
    """The folder named by the environment variable FLEXSTAGE_CACHE, else flexstage in the user's folder for caches; it need not be there.

    >>> cache_folder().is_absolute() or FOLDER_VARIABLE in os.environ
    True
    """
    stated = os.environ.get(FOLDER_VARIABLE)
    return Path(stated).expanduser() if stated else _users() / "flexstage"


def _users() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
