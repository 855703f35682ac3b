"""Compiled kernels: C equivalents of numpy code, built at installation (`hatch_build.py`) next to their sources.

Each kernel is built for several vector widths. The widest version that this processor supports is loaded. Each library contains the digest
of its sources, and is not loaded if the sources have changed. The installation uses this module, which therefore requires only the standard
library.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

SWITCH = "FLEXSTAGE_KERNEL"
"""Environment variable: `off` disables the kernels; another value names the vector lanes to use."""
PACKAGE = Path(__file__).parents[2]
HEADERS = Path(__file__).parent
"""Folder of shared headers of all kernels."""
KERNELS = tuple(PACKAGE / "models" / model / "kernel.c" for model in ("batch", "nonlinear"))


@dataclass(frozen=True)
class Lanes:
    """Vector lanes (SIMD width) of a kernel: architecture, required processor features, and compiler flags."""

    name: str
    machines: tuple[str, ...]
    features: frozenset[str]
    flags: tuple[str, ...]


_X86, _ARM = ("x86_64", "AMD64"), ("aarch64", "arm64")
_LANES = (
    Lanes("avx512", _X86, frozenset({"avx512f", "avx512dq", "avx512vl", "fma"}), ("-mavx512f", "-mavx512dq", "-mavx512vl", "-mfma")),
    Lanes("avx2", _X86, frozenset({"avx2", "fma"}), ("-mavx2", "-mfma")),
    Lanes("sse2", _X86, frozenset(), ()),
    Lanes("neon", _ARM, frozenset(), ()),
)
"""Lanes, widest first: eight, four and two doubles."""


def machine_lanes() -> tuple[Lanes, ...]:
    """Return the vector lanes of this architecture, widest first; for an unknown architecture, two lanes chosen by the compiler.

    >>> len(machine_lanes()) > 0
    True
    """
    return tuple(each for each in _LANES if platform.machine() in each.machines) or (Lanes("plain", (), frozenset(), ()),)


def processor_lanes() -> tuple[Lanes, ...]:
    """Return the vector lanes that this processor supports, widest first.

    >>> set(processor_lanes()) <= set(machine_lanes())
    True
    """
    features = _features()
    return tuple(each for each in machine_lanes() if each.features <= features)


def sources_digest(source: Path) -> str:
    """Return the digest of a kernel's source, its headers and the shared headers.

    >>> len(sources_digest(KERNELS[0]))
    32
    """
    files = (source, *sorted((*source.parent.glob("*.h"), *HEADERS.glob("*.h"))))
    return hashlib.sha256(b"\0".join(each.read_bytes() for each in files)).hexdigest()[:32]


def library_path(source: Path, lanes: Lanes) -> Path:
    """Return the path of a kernel's library for these vector lanes.

    >>> library_path(KERNELS[0], Lanes("sse2", (), frozenset(), ())).name
    'kernel-sse2.so'
    """
    return source.with_name(f"{source.stem}-{lanes.name}.so")


def kernel_lanes() -> Lanes:
    """Return the vector lanes named by FLEXSTAGE_KERNEL, by default the widest lanes of this processor.

    Raises `DesignError` for lanes that this processor does not support.

    >>> kernel_lanes() in processor_lanes()
    True
    """
    result, stated = {each.name: each for each in processor_lanes()}, os.environ.get(SWITCH, "")
    if stated and stated not in result:
        from flexstage.base.finding import refuse  # requires more than the standard library

        what = f"unsupported value (got {stated}, expected {', '.join(result)} or off)"
        raise refuse(SWITCH, what, "Use one of these values, or leave the variable empty for the fastest kernels")
    return result[stated] if stated else next(iter(result.values()))


def kernel_library(source: Path) -> ctypes.CDLL | None:
    """Load the library of a kernel; `None` if FLEXSTAGE_KERNEL is `off`, or no library was built from the current sources.

    Raises `DesignError` if FLEXSTAGE_KERNEL names unsupported lanes.

    >>> kernel_library(Path("no-such-kernel.c")) is None
    True
    """
    if os.environ.get(SWITCH, "") == "off":
        return None
    with suppress(OSError, AttributeError, ValueError):
        library = ctypes.CDLL(str(library_path(source, kernel_lanes())))
        if library_sources(library) == sources_digest(source):
            return library
    return None


def library_sources(library: ctypes.CDLL) -> str:
    """Return the digest of the sources from which a library was built."""
    return ctypes.c_char_p.in_dll(library, "flexstage_sources").value.decode()  # type: ignore[union-attr]


def library_digest(source: Path) -> str:
    """Return the lanes and the content digest of the loaded library. Equal digests give bit-identical results."""
    path = library_path(source, kernel_lanes())
    return f"{path.stem.rpartition('-')[2]} {hashlib.sha256(path.read_bytes()).hexdigest()[:12]}"


def _features() -> frozenset[str]:
    """Features of the processor; empty if unknown."""
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        return frozenset(next((line for line in lines if line.startswith(("flags", "Features"))), "").split())
    return frozenset()
