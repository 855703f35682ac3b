"""The doctor: checks of the installation, each with a remedy. Checks print nothing, return rows, and run even if packages are missing."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import Enum
from importlib.metadata import PackageNotFoundError, metadata, packages_distributions, requires, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from flexstage.apps import quadmath
from flexstage.base.processes.native import KERNELS, SWITCH, kernel_lanes, kernel_library
from flexstage.base.version import __version__

_TIME_LIMIT = 120.0
_EXTRAS = ("", "solid", "tables")
_THREADS = "import json, numpy.linalg, scipy.linalg, threadpoolctl as t; print(json.dumps([p['num_threads'] for p in t.threadpool_info()]))"


class Verdict(Enum):
    """Verdict on a row: good, bad, or a note on an item that flexstage can do without."""

    GOOD = "good"
    NOTE = "note"
    BAD = "bad"


@dataclass(frozen=True)
class Row:
    """One checked item `what`: its state `found`, the required state `wanted`, the `verdict` and the `remedy`, as text."""

    what: str
    found: str
    wanted: str
    verdict: Verdict
    remedy: str = ""


def examine(folder: Path, self_test: Callable[[], Row] | None = None) -> tuple[Row, ...]:
    """Examine the running environment and the `folder` for results.

    `self_test` computes a known result and returns its row; an exception becomes a row too.
    """
    rows = [*_examine_installed(), _threads(), examine_folder("current folder", folder), _figure_cache(), *native_code()]
    return (*rows, *([_run_self_test(self_test)] if self_test else []))


def _examine_installed() -> Iterator[Row]:
    """Python, flexstage itself, and the required packages."""
    try:
        wanted, lines = metadata("flexstage")["Requires-Python"], requires("flexstage") or []
        found = version("flexstage")
    except PackageNotFoundError:
        wanted, lines, found = "", [], "not installed"
    yield Row("Python", platform.python_version(), wanted, Verdict.GOOD)  # an older one fails earlier
    good = found == __version__
    remedy = "" if good else "install it again: pip install --force-reinstall --no-deps flexstage, or make setup-runtime in a checkout"
    yield Row("flexstage", found, __version__, Verdict.GOOD if good else Verdict.BAD, remedy)
    try:
        from packaging.requirements import Requirement
    except ImportError:
        yield Row("packaging", "missing", "installed", Verdict.BAD, "pip install packaging; then examine again")
        return
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        yield from filter(None, pool.map(examine_package, map(Requirement, lines)))


def examine_package(need: Any) -> Row | None:
    """Check whether a required package is installed in a permitted version, and importable. Returns `None` if it is not needed.

    The package is imported in a separate process, because a broken library may crash that process. Packages of extras are optional.

    >>> from packaging.requirements import Requirement
    >>> examine_package(Requirement("no-such-package>=1")).found
    'missing'
    """
    extra = next((each for each in _EXTRAS if need.marker is None or need.marker.evaluate({"extra": each})), None)
    if extra is None:
        return None
    wanted, asked = str(need.specifier), f"flexstage[{extra}]" if extra else f"{need.name}{need.specifier}"
    try:
        present = version(need.name)
    except PackageNotFoundError:
        return Row(need.name, "missing", wanted, Verdict.NOTE if extra else Verdict.BAD, f"pip install '{asked}'")
    remedy = f"pip install --force-reinstall '{asked}'"
    if not need.specifier.contains(present, prereleases=True):
        return Row(need.name, present, wanted, Verdict.BAD, remedy)
    if not (said := _import_error(_module(need.name))):
        return Row(need.name, present, wanted, Verdict.GOOD)
    if need.name == "ngsolve" and quadmath.missing_place(sys.path):
        remedy = f"{quadmath.COMMAND}; or on Debian: apt-get install libquadmath0"
    return Row(need.name, f"{present}, cannot be imported: {said}", wanted, Verdict.BAD, remedy)


def _run(code: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=_TIME_LIMIT)


def _module(package: str) -> str:
    """The module of a package: the one of its name, or its first one (PIL of pillow)."""
    own = package.replace("-", "_")
    if find_spec(own):
        return own  # without a search in all installed packages
    known = [module for module, owners in packages_distributions().items() if package in map(str.lower, owners)]
    return own if own in known else next(iter(known), own)


def _import_error(module: str) -> str:
    try:
        done = _run(f"import {module}")
    except subprocess.TimeoutExpired:
        return f"the import took more than {_TIME_LIMIT:.0f} s"
    if done.returncode < 0:
        return f"the process was ended by signal {-done.returncode}"
    return (done.stderr.strip().splitlines() or ["no message"])[-1] if done.returncode else ""


def _threads() -> Row:
    wanted = "1 thread"
    try:
        counts = json.loads(_run(_THREADS).stdout)
    except (ValueError, subprocess.TimeoutExpired):
        return Row("BLAS", "not examined", wanted, Verdict.NOTE, "correct the packages above first")
    most = max(counts, default=1)
    remedy = "" if most == 1 else "if sweeps are slow on a busy machine: export OPENBLAS_NUM_THREADS=1"
    return Row("BLAS", f"{most} thread{'s' * (most > 1)}", wanted, Verdict.NOTE if remedy else Verdict.GOOD, remedy)


def examine_folder(what: str, folder: Path) -> Row:
    """Check with a trial file whether a folder is writable, because its permissions may be misleading.

    >>> examine_folder("folder", Path("no such folder")).verdict
    <Verdict.BAD: 'bad'>
    """
    try:
        with tempfile.TemporaryFile(dir=folder):
            return Row(what, "writable", "writable", Verdict.GOOD)
    except OSError as error:
        return Row(what, f"{folder}: {error.strerror}", "writable", Verdict.BAD, f"choose another folder, or: chmod u+rwx {folder}")


def _figure_cache() -> Row:
    """The folder of matplotlib's list of fonts: if it is not writable, the list is rebuilt for every figure."""
    chosen = os.environ.get("MPLCONFIGDIR")
    path = Path(chosen) if chosen else Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "matplotlib")
    row = examine_folder("cache of figures", path.absolute())
    if row.verdict is Verdict.GOOD:
        return row
    return Row(row.what, row.found, row.wanted, Verdict.NOTE, f"mkdir -p {path}, or set MPLCONFIGDIR to a folder of your own")


def native_code() -> Iterator[Row]:
    """Check whether the compiled kernels can be loaded. Missing kernels only cause a note, because numpy replaces them.

    >>> [row.verdict is Verdict.BAD for row in native_code()]
    [False]
    """
    what, wanted = "kernels", f"compiled at installation, from {len(KERNELS)} source files"
    try:
        loaded = [source for source in KERNELS if kernel_library(source)]
        found = f"{len(loaded)} for {kernel_lanes().name}" if os.environ.get(SWITCH) != "off" else f"off ({SWITCH})"
    except Exception as error:  # noqa: BLE001 (lanes missing on this processor, or a package with its own row)
        loaded, found = [], str(error)
    if len(loaded) == len(KERNELS):
        yield Row(what, found, wanted, Verdict.GOOD)
    else:
        remedy = "install gcc or clang, or set CC, then install flexstage again: some computations run several times as fast"
        yield Row(what, found, wanted, Verdict.NOTE, remedy)


def _run_self_test(self_test: Callable[[], Row]) -> Row:
    try:
        return self_test()
    except Exception as error:  # noqa: BLE001 (the doctor reports all errors)
        return Row(
            "self-test", f"{type(error).__name__}: {error}", "passes", Verdict.BAD, "correct errors above; if none, report this as a bug"
        )
