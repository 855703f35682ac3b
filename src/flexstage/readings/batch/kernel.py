"""The iteration in C, several designs in each vector of the processor: built where there is a compiler, never required.

The library is built once by the system's compiler and kept, named by what it depends on, beside other caches of the user. Where nothing is
found to build it, or it cannot be kept or loaded, there is none and numpy does the same work. FLEXSTAGE_KERNEL=off does without it.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import platform
import subprocess
import tempfile
from pathlib import Path

from flexstage.base.compiler import Compiler, compiler
from flexstage.base.store import cache_folder

SWITCH = "FLEXSTAGE_KERNEL"
_SOURCE = Path(__file__).with_name("kernel.c")
_FLAGS = ("-O3", "-march=native", "-ffp-contract=fast", "-fno-math-errno", "-fPIC", "-shared")
_SECONDS = 120.0


@functools.cache
def kernel() -> ctypes.CDLL | None:
    """The library, built if need be; `None` where there cannot be one.

    >>> found = kernel()
    >>> found is None or found.flexstage_width() in (2, 4, 8)
    True
    """
    return None if os.environ.get(SWITCH, "") == "off" else built(cache_folder() / "kernels")


@functools.cache
def kernel_name() -> str:
    """What iterates here: the library by what it is made of, or none. With the same name, results are the same to the bit.

    >>> "kernel" in kernel_name()
    True
    """
    found = compiler() if kernel() is not None else None
    return "no kernel" if found is None else f"kernel {_key(found)[:12]}"


def built(folder: Path) -> ctypes.CDLL | None:
    """The library from a folder, built into it if it is not there yet.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = built(Path(folder, "not", "there", "yet"))
    >>> found is None or found.flexstage_modes.restype is ctypes.c_int64
    True
    """
    found = compiler()
    if found is None:
        return None
    try:
        path = folder / f"modes-{_key(found)}.so"
        if not path.exists():
            _build(found, path)
        library = ctypes.CDLL(str(path))
        library.flexstage_modes.restype = library.flexstage_width.restype = ctypes.c_int64
    except (OSError, subprocess.SubprocessError, AttributeError):
        return None
    return library


def _key(found: Compiler) -> str:
    """What the library depends on: source, flags, compiler, and the processor it is made for."""
    content = [_SOURCE.read_bytes(), *(text.encode() for text in (*_FLAGS, *found.command, found.version, _processor()))]
    return hashlib.sha256(b"\0".join(content)).hexdigest()[:24]


def _processor() -> str:
    """Architecture and features: a folder may be shared by machines that differ."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    told = [next((line for line in lines if line.startswith(name)), "") for name in ("model name", "flags", "Features", "CPU part")]
    return "\n".join([platform.system(), platform.machine(), platform.processor(), *told])


def _build(found: Compiler, path: Path) -> None:
    """Built aside and renamed: another process that does the same at the same time does no harm."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        aside = Path(folder, path.name)
        command = [*found.command, *_FLAGS, "-o", str(aside), str(_SOURCE), "-lm"]
        subprocess.run(command, capture_output=True, check=True, timeout=_SECONDS, stdin=subprocess.DEVNULL)
        aside.replace(path)
