"""Memory check: available memory, and an error before an allocation that would exceed it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from flexstage.base.finding import refuse

_USABLE = 0.9
"""Usable fraction of the free memory."""
ALWAYS = 3e7
"""Memory requirement [bytes] up to which `require_memory` does not check."""


def require_memory(where: str, what: str, needed: float, fits: Callable[[float], str]) -> None:
    """Raise `DesignError` if `needed` memory [bytes] exceeds the available memory.

    `what` names the data in the message. `fits` is a function that returns a hint for an amount of available memory [bytes].

    >>> require_memory("stage", "its matrices", 1e3, lambda there: f"{there / 1e6:.0f} bodies would fit")
    """
    if needed < ALWAYS:
        return  # a query takes longer than most such computations
    there = available()
    if needed > there:
        raise refuse(where, f"{what} need about {gigabytes(needed)} of memory, but only {gigabytes(there)} is available", fits(there))


def gigabytes(size: float) -> str:
    """Return a memory size as a string with its unit.

    >>> gigabytes(1.5e9)
    '1.5 GB'
    """
    return f"{size / 1e9:.3g} GB"


def available() -> float:
    """Return the usable memory [bytes]: 90 % of the smallest free memory of machine, control group and process limits.

    >>> available() > 0.0
    True
    """
    return _USABLE * min((*_machine_memory(), *_control_group(), *_process_limits()), default=float("inf"))


def _machine_memory() -> Iterator[float]:
    with suppress(ImportError, OSError):  # unknown on this system
        import psutil

        yield float(psutil.virtual_memory().available)


def _control_group() -> Iterator[float]:
    """Free memory of the control groups (version 2) of this process, without page cache."""
    root, own = Path("/sys/fs/cgroup"), Path("/proc/self/cgroup")
    if not own.is_file():
        return
    paths = [line[3:].strip().lstrip("/") for line in own.read_text(encoding="utf-8").splitlines() if line.startswith("0::")]
    for path in paths:
        group = root / path
        for folder in (group, *group.parents):
            if not folder.is_relative_to(root):
                break
            yield from _group_memory_left(folder)


def _group_memory_left(folder: Path) -> Iterator[float]:
    try:
        most = (folder / "memory.max").read_text(encoding="utf-8").strip()
        used = float((folder / "memory.current").read_text(encoding="utf-8"))
        rows = (line.split() for line in (folder / "memory.stat").read_text(encoding="utf-8").splitlines())
        cached = sum(float(size) for name, size in rows if name == "inactive_file")
    except OSError:
        return
    if most != "max":
        yield max(0.0, float(most) - used + cached)


def _process_limits() -> Iterator[float]:
    try:
        import resource

        import psutil
    except ImportError:  # no limits on this system
        return
    for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA):
        soft, _ = resource.getrlimit(kind)
        if soft != resource.RLIM_INFINITY:
            yield max(0.0, float(soft) - psutil.Process().memory_info().vms)
