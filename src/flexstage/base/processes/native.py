"""Kernels: C that does what numpy does faster, built when the package is installed (`hatch_build.py`), beside its sources.

A kernel is built once for each width of vectors; the widest that this processor has is loaded. Each library carries the digest of the
sources it was built from: of edited sources it is not loaded. This module needs nothing but the standard library, as installation uses it.
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
"""The variable that, at `off`, does without kernels, and else names their lanes."""
PACKAGE = Path(__file__).parents[2]
HEADERS = Path(__file__).parent
"""Where the headers are that all kernels share."""
KERNELS = tuple(PACKAGE / "models" / model / "kernel.c" for model in ("batch", "nonlinear"))


@dataclass(frozen=True)
class Lanes:
    """Vectors that kernels are compiled for: the architecture, the features a processor must have, and the flags that tell the compiler."""

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
"""Widest first: eight, four and two doubles."""


def machine_lanes() -> tuple[Lanes, ...]:
    """The lanes of this architecture, widest first; where none is known, two lanes as the compiler makes them.

    >>> len(machine_lanes()) > 0
    True
    """
    return tuple(each for each in _LANES if platform.machine() in each.machines) or (Lanes("plain", (), frozenset(), ()),)


def processor_lanes() -> tuple[Lanes, ...]:
    """The lanes that this processor has, asked now, widest first.

    >>> set(processor_lanes()) <= set(machine_lanes())
    True
    """
    features = _features()
    return tuple(each for each in machine_lanes() if each.features <= features)


def sources_digest(source: Path) -> str:
    """The digest of a kernel's source and of the headers beside it and shared by all.

    >>> len(sources_digest(KERNELS[0]))
    32
    """
    files = (source, *sorted((*source.parent.glob("*.h"), *HEADERS.glob("*.h"))))
    return hashlib.sha256(b"\0".join(each.read_bytes() for each in files)).hexdigest()[:32]


def library_path(source: Path, lanes: Lanes) -> Path:
    """Where the library of a kernel for these lanes is.

    >>> library_path(KERNELS[0], Lanes("sse2", (), frozenset(), ())).name
    'kernel-sse2.so'
    """
    return source.with_name(f"{source.stem}-{lanes.name}.so")


def kernel_lanes() -> Lanes:
    """The widest lanes of this processor, or those of them that FLEXSTAGE_KERNEL names; raises `DesignError` for others.

    >>> kernel_lanes() in processor_lanes()
    True
    """
    found, stated = {each.name: each for each in processor_lanes()}, os.environ.get(SWITCH, "")
    if stated and stated not in found:
        from flexstage.base.finding import refuse  # which needs more than the standard library

        what = f"it is {stated}, and kernels run here with {', '.join(found)}, or are off"
        raise refuse(SWITCH, what, "State one of these, or nothing for the fastest")
    return found[stated] if stated else next(iter(found.values()))


def kernel_library(source: Path) -> ctypes.CDLL | None:
    """The library of a kernel; `None` where FLEXSTAGE_KERNEL is off, none was built, or it was built from other sources.

    Raises `DesignError` where FLEXSTAGE_KERNEL names lanes that this processor has not.

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
    """The digest of the sources that a library was built from."""
    return ctypes.c_char_p.in_dll(library, "flexstage_sources").value.decode()  # type: ignore[union-attr]


def library_digest(source: Path) -> str:
    """The lanes and the content of the library that is loaded: with equal ones, results are equal to the bit."""
    path = library_path(source, kernel_lanes())
    return f"{path.stem.rpartition('-')[2]} {hashlib.sha256(path.read_bytes()).hexdigest()[:12]}"


def _features() -> frozenset[str]:
    """What the processor says it can do; nothing where the system does not tell."""
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        return frozenset(next((line for line in lines if line.startswith(("flags", "Features"))), "").split())
    return frozenset()
