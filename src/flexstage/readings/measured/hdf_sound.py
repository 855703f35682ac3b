"""Whether an HDF5 file takes its library down: tried in a process of its own, which runs `hdf_look.py`.

Files of the older form have no checksums. Damaged inside, they can crash the library or let it run in circles, beyond the reach of any
exception; the newer form is refused by the library itself.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from flexstage.base.finding import DesignError, refuse

PATIENCE = 60.0
"""How long it may take to look through a file [s], and as long again for every gigabyte."""
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_CHECKED = 2
_END_OF_FILE = slice(40, 48)


def require_sound(path: Path, *, patience: float = PATIENCE) -> None:
    """Raise `DesignError` where looking through an HDF5 file crashes or takes for ever.

    >>> import tempfile, h5py
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     h5py.File(Path(folder) / "a.h5", "w").close()
    ...     require_sound(Path(folder) / "a.h5")
    """
    if _is_refused_anyway(path):
        return
    seconds = patience * (1.0 + path.stat().st_size / 1e9)
    command = [sys.executable, "-P", str(Path(__file__).with_name("hdf_look.py")), str(path)]
    try:
        code = subprocess.run(command, capture_output=True, check=False, timeout=seconds).returncode
    except subprocess.TimeoutExpired:
        raise _damaged(path, f"reading it did not end within {seconds:.3g} s") from None
    if code < 0:
        raise _damaged(path, f"the library that reads it crashed (signal {-code})")


def _damaged(path: Path, what: str) -> DesignError:
    return refuse(str(path), f"it is damaged: {what}", "Copy or export it anew")


def _is_refused_anyway(path: Path) -> bool:
    """Whether the library itself refuses what is damaged: a version of the superblock with checksums, or a file shorter than it says.

    The superblock stands at 0, 512, 1024, ...; without checksums its end of file is at byte 40 (HDF5 file format specification, II.A).
    """
    place, size = 0, path.stat().st_size
    with path.open("rb") as stream:
        while place < size:
            stream.seek(place)
            head = stream.read(_END_OF_FILE.stop)
            if head.startswith(_SIGNATURE):
                return head[len(_SIGNATURE)] >= _CHECKED or int.from_bytes(head[_END_OF_FILE], "little") > size
            place = max(512, 2 * place)
    return True
