"""The library missing in NGSolve's wheels: their OpenBLAS needs `libquadmath.so.0`, which a minimal system does not have.

numpy's wheels contain it under another name. `python -m flexstage.apps.quadmath` copies it next to the library that needs it; the loader
prefers this copy on every machine. The module uses the standard library only, because `tools/setup.py` calls it too.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

COMMAND = "python -m flexstage.apps.quadmath"
_NAME = "libquadmath.so.0"
_WANTING = "ngsolve_openblas/libgfortran.so*"
_CARRIERS = ("numpy.libs", "scipy.libs")


def missing_place(folders: Iterable[Path | str]) -> Path | None:
    """Find the folder for the library within these `site-packages` folders. Returns None if the library exists or is not needed.

    >>> missing_place([]) is None
    True
    """
    # Some builds (64-bit ARM) do not need it: the dynamic section of a library lists its dependencies.
    missing = (
        library.with_name(_NAME)
        for folder in folders
        for library in Path(folder).glob(_WANTING)
        if not library.with_name(_NAME).exists() and _NAME.encode() in library.read_bytes()
    )
    return next(missing, None)


def provide(folders: Iterable[Path | str]) -> str:
    """Copy the library into its folder. Returns the reason for a failure, else an empty string. A second call has no effect.

    >>> provide([])
    ''
    """
    known = [Path(folder) for folder in folders]
    place = missing_place(known)
    if place is None:
        return ""
    copies = (found for folder in known for carrier in _CARRIERS for found in sorted((folder / carrier).glob("libquadmath-*.so*")))
    copy = next(copies, None)
    if copy is None:
        return f"no package contains a copy of {_NAME}; install the library of the system (Debian: apt-get install libquadmath0)"
    try:
        _copy(copy, place)
    except OSError as error:
        return f"{place}: {error.strerror}"
    return ""


def _copy(source: Path, place: Path) -> None:
    # Written completely, then renamed: another process may be importing.
    handle, unfinished = tempfile.mkstemp(dir=place.parent, prefix=f".{_NAME}.")
    os.close(handle)
    try:
        shutil.copyfile(source, unfinished)
        Path(unfinished).chmod(0o755)
        Path(unfinished).replace(place)
    except OSError:
        Path(unfinished).unlink(missing_ok=True)
        raise


if __name__ == "__main__":
    sys.exit(provide(sys.path) or 0)
