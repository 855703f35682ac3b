"""Processes that run this package beside the caller: how many at once, and what they find around them."""

from __future__ import annotations

import os
import sys
from pathlib import Path

_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NGS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def cores() -> int:
    """Cores this process may use.

    >>> cores() >= 1
    True
    """
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else (os.cpu_count() or 1)


def environment() -> dict[str, str]:
    """The caller's environment for a process of one thread that finds this package where the caller found it.

    >>> environment()["OMP_NUM_THREADS"]
    '1'
    """
    root = str(Path(__file__).resolve().parents[2])
    paths = [root, *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, **dict.fromkeys(_ONE_THREAD, "1"), "PYTHONPATH": os.pathsep.join(paths)}


def command(module: str, *arguments: str | os.PathLike[str]) -> list[str]:
    """The words that run a module of this package, whatever files lie in the folder it is run from.

    >>> command("flexstage.studies.sweeps.work", "a")[1:]
    ['-P', '-m', 'flexstage.studies.sweeps.work', 'a']
    """
    return [sys.executable, "-P", "-m", module, *(os.fspath(each) for each in arguments)]
