"""The doctor: is this installation sound, and what can be mended? Returns rows, prints nothing, and runs when any package is missing."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import Enum
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import flexstage
from flexstage.apps import quadmath
from flexstage.apps.cure import Cure, MakeFolder, Outcome, ProvideLibrary, Reinstall, carry_out
from flexstage.apps.installed import package
from flexstage.apps.pins import Need, can_parse, needs, needs_of, python_versions, requirement

_TIME_LIMIT = 120.0
_THREADS = "import json, numpy.linalg, scipy.linalg, threadpoolctl as t; print(json.dumps([p['num_threads'] for p in t.threadpool_info()]))"


class Verdict(Enum):
    """What a row of the examination comes to. A note does not keep flexstage from working."""

    GOOD = "good"
    NOTE = "note"
    BAD = "bad"


@dataclass(frozen=True)
class Row:
    """One thing examined: `what`, what was `found`, what is `wanted`, the `verdict`, the `remedy` in words and the `cure`, if known."""

    what: str
    found: str
    wanted: str
    verdict: Verdict
    remedy: str = ""
    cure: Cure | None = None


def examine(folder: Path, self_test: Callable[[], Row] | None = None) -> tuple[Row, ...]:
    """Examine the running environment and the `folder` that results would be written to.

    `self_test` computes something known and returns its row; whatever it raises becomes a row too.

    >>> {row.verdict for row in examine(Path(tempfile.mkdtemp())) if row.what == "Python"}
    {<Verdict.GOOD: 'good'>}
    """
    if not can_parse():
        remedy = "python -m ensurepip, or flexstage doctor --mend; then examine again"
        return (Row("packaging", "missing, and pip too", "installed", Verdict.BAD, remedy, Reinstall("packaging")),)
    rows = [_python(), _itself(), *_packages(), _threads(), writable("current folder", folder), _cache(), *native_code()]
    return tuple(rows + [_tested(self_test)] * (self_test is not None))


def mend(rows: Iterable[Row]) -> tuple[Outcome, ...]:
    """Carry out the cures of the rows that are bad, in order; examine again afterwards.

    >>> mend([])
    ()
    """
    return tuple(carry_out(row.cure) for row in rows if row.cure and row.verdict is Verdict.BAD)


def _python() -> Row:
    wanted, found = python_versions(), platform.python_version()
    good = not wanted or requirement(f"python{wanted}").specifier.contains(found, prereleases=True)
    remedy = "" if good else f"make an environment with Python {wanted} and install flexstage there"
    return Row("Python", found, wanted, Verdict.GOOD if good else Verdict.BAD, remedy)


def _itself() -> Row:
    try:
        found = version("flexstage")
    except PackageNotFoundError:
        found = "not installed"
    good = found == flexstage.__version__
    remedy = "" if good else "install it again: pip install --force-reinstall --no-deps flexstage, or make setup-runtime in a checkout"
    return Row("flexstage", found, flexstage.__version__, Verdict.GOOD if good else Verdict.BAD, remedy)


def _packages() -> Iterator[Row]:
    direct = needs("solid", "tables")
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        yield from pool.map(examine_package, direct)
    # What those need in turn is worth a row only when something is wrong with it.
    further = (examine_files(need) for need in sorted(needs_of(direct), key=lambda need: need.name))
    yield from (row for row in further if row and row.verdict is Verdict.BAD)


def examine_package(need: Need) -> Row:
    """Is a package there, whole, in the range of versions, and does it import (in a process of its own: a bad binary takes it down)?

    >>> examine_package(Need("no-such-package", ">=1", "")).found
    'missing'
    """
    if damage := examine_files(need):
        return damage
    found = package(need.name)
    present = found.version if found else ""
    cure = Reinstall(need.name, need.versions)
    if not need.admits(present):
        return Row(need.name, present, need.versions, Verdict.BAD, _pip(need), cure)
    if said := _import_error(need.name.replace("-", "_")):
        return _not_importing(need, f"{present}, does not import: {said}")
    return Row(need.name, present, need.versions, Verdict.GOOD)


def _not_importing(need: Need, found: str) -> Row:
    if need.name == "ngsolve" and quadmath.lacking(sys.path):
        remedy = "flexstage doctor --mend puts a copy of libquadmath.so.0 beside it; or on Debian: apt-get install libquadmath0"
        return Row(need.name, found, need.versions, Verdict.BAD, remedy, ProvideLibrary())
    return Row(need.name, found, need.versions, Verdict.BAD, _pip(need), Reinstall(need.name, need.versions))


def examine_files(need: Need) -> Row | None:
    """The row of a package that is missing or has lost files; None if it is whole. What only an extra asks for may be missing.

    >>> examine_files(Need("pip", "", "")) is None
    True
    """
    found = package(need.name)
    if found and not found.lost:
        return None
    wanted = need.versions or "installed"
    if need.extra and not found:
        return Row(need.name, "missing", wanted, Verdict.NOTE, f"if you want what needs it: pip install 'flexstage[{need.extra}]'")
    state = f"{found.version}, {found.lost} files lost" if found else "missing"
    return Row(need.name, state, wanted, Verdict.BAD, _pip(need), Reinstall(need.name, need.versions))


def _pip(need: Need) -> str:
    wanted = f"flexstage[{need.extra}]" if need.extra else f"{need.name}{need.versions}"
    return f"pip install --force-reinstall '{wanted}', or flexstage doctor --mend"


def _run(code: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=_TIME_LIMIT)


def _import_error(module: str) -> str:
    try:
        done = _run(f"import {module}")
    except subprocess.TimeoutExpired:
        return f"took more than {_TIME_LIMIT:.0f} s"
    if done.returncode < 0:
        return f"the process was ended by signal {-done.returncode}"
    return (done.stderr.strip().splitlines() or ["no message"])[-1] if done.returncode else ""


def _threads() -> Row:
    wanted = "1 thread"
    try:
        counts = json.loads(_run(_THREADS).stdout)
    except (ValueError, subprocess.TimeoutExpired):
        return Row("BLAS", "not examined", wanted, Verdict.NOTE, "mend the packages above first")
    most = max(counts, default=1)
    remedy = "" if most == 1 else "if sweeps are slow on a busy machine: export OPENBLAS_NUM_THREADS=1"
    return Row("BLAS", f"{most} thread{'s' * (most > 1)}", wanted, Verdict.NOTE if remedy else Verdict.GOOD, remedy)


def writable(what: str, folder: Path) -> Row:
    """Can a file be written in a folder? Tried, not concluded from its mode.

    >>> writable("folder", Path("no such folder")).verdict
    <Verdict.BAD: 'bad'>
    """
    try:
        with tempfile.TemporaryFile(dir=folder):
            return Row(what, "writable", "writable", Verdict.GOOD)
    except OSError as error:
        return Row(what, f"{folder}: {error.strerror}", "writable", Verdict.BAD, f"choose another folder, or: chmod u+rwx {folder}")


def _cache() -> Row:
    path = figure_cache()
    row = writable("cache of figures", path)
    if row.verdict is Verdict.GOOD:
        return row
    remedy = "flexstage doctor --mend, or set MPLCONFIGDIR to a folder of your own"
    return Row(row.what, row.found, row.wanted, Verdict.BAD, remedy, MakeFolder(path))


def figure_cache() -> Path:
    """The folder where matplotlib keeps its list of fonts: made anew for every figure when it cannot be written.

    >>> figure_cache().is_absolute()
    True
    """
    if chosen := os.environ.get("MPLCONFIGDIR"):
        return Path(chosen).absolute()
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache").absolute() / "matplotlib"


def native_code() -> Iterator[Row]:
    """Where compiled code is kept. A note only: without a folder each process builds its own, without a compiler numpy does the work.

    >>> [row.verdict is Verdict.BAD for row in native_code()]
    [False]
    """
    try:
        from flexstage.base.finding import DesignError
        from flexstage.base.native import compiler, folder, unfit
    except ImportError:
        return
    what, wanted = "compiled code", "a compiler of C, a folder of your own"
    if compiler() is None:
        remedy = "install gcc or clang, or set CC: some computations run several times as fast"
        yield Row(what, "no compiler of C", wanted, Verdict.NOTE, remedy)
        return
    try:
        why, place = unfit(folder()), str(folder())
    except DesignError as error:
        why, place = str(error), ""
    if why:
        remedy = "take the right to write there from others, or let FLEXSTAGE_CACHE name another folder"
        yield Row(what, f"built anew by each process: {why}", wanted, Verdict.NOTE, remedy)
    else:
        yield Row(what, f"kept in {place}", wanted, Verdict.GOOD)


def _tested(self_test: Callable[[], Row] | None) -> Row:
    try:
        return self_test() if self_test else Row("self-test", "none", "none", Verdict.NOTE)
    except Exception as error:  # noqa: BLE001 (the doctor reports whatever is wrong)
        return Row("self-test", f"{type(error).__name__}: {error}", "passes", Verdict.BAD, "mend the rows above; else report this as a bug")
