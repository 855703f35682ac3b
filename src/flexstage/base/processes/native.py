"""Native code: C built by the system's compiler, kept where only its user can write, checked before it is loaded.

A library runs with all rights of who loads it. So it is taken only from a folder that belongs to the user and that nobody else may write
to, and only if its content is what its name says: `<what>-<key>-<digest>.so`, where the key stands for all it is made of. What was cut off,
emptied or altered is built anew. Where no such folder is to be had, each process builds for itself. Libraries for others
(`compile_source`) never come from there.
"""

from __future__ import annotations

import ctypes
import errno
import hashlib
import os
import platform
import shutil
import stat
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from flexstage.base.finding import DesignError, refuse
from flexstage.base.storage.store import cache_folder, temporary_folder

SWITCH = "FLEXSTAGE_KERNEL"
"""The variable that, at `off`, does without kernels, and else names their lanes."""
_KERNEL = ("-O3", "-ffp-contract=fast", "-fno-math-errno", "-fPIC", "-shared")
COMPILERS = ("cc", "gcc", "clang")
"""Names by which a compiler is looked for."""
_KEPT = 64
_SECONDS = 300.0
_BUILDING, _MADE = ".building-", "made.so"
_OTHERS = stat.S_IWGRP | stat.S_IWOTH

Answers = Callable[[ctypes.CDLL], bool]
"""Whether a library that was loaded computes what is known; may raise what a missing function raises."""


@dataclass(frozen=True)
class Compiler:
    """A compiler by the words that call it, and what it says of its version."""

    command: tuple[str, ...]
    version: str


@dataclass(frozen=True)
class Lanes:
    """Vectors that kernels are compiled for: the architecture, the features a processor must have, and the flags that tell the compiler."""

    name: str
    machines: tuple[str, ...]
    features: frozenset[str]
    flags: tuple[str, ...]


_X86, _ARM = ("x86_64", "AMD64"), ("aarch64", "arm64")
LANES = (
    Lanes("avx512", _X86, frozenset({"avx512f", "avx512dq", "avx512vl", "fma"}), ("-mavx512f", "-mavx512dq", "-mavx512vl", "-mfma")),
    Lanes("avx2", _X86, frozenset({"avx2", "fma"}), ("-mavx2", "-mfma")),
    Lanes("sse2", _X86, frozenset(), ()),
    Lanes("neon", _ARM, frozenset(), ()),
)
"""Widest first: eight, four and two doubles. Where none is known, two lanes as the compiler makes them."""


@dataclass(frozen=True)
class Recipe:
    """What a shared library is (`what`, in a few words), its sources (text by file name), and the flags it is compiled with."""

    what: str
    sources: Mapping[str, str]
    flags: tuple[str, ...]


def compiler() -> Compiler | None:
    """The compiler the environment's CC names (`ccache gcc`), else `cc`, `gcc` or `clang` on the PATH; None where none answers.

    >>> found = compiler()
    >>> found is None or bool(found.version)
    True
    """
    stated = os.environ.get("CC")
    for words in (tuple(stated.split()),) if stated and stated.strip() else ((name,) for name in COMPILERS):
        path = shutil.which(words[0])
        if path is not None and (version := _version((path, *words[1:]))):
            return Compiler((path, *words[1:]), version)
    return None


def require_compiler(what: str) -> Compiler:
    """The compiler; raises `DesignError` where `what` needs one and none is there.

    >>> require_compiler("the compile_source loop").version == compiler().version if compiler() else True
    True
    """
    found = compiler()
    if found is None:
        looked = f"CC = {os.environ['CC']}" if os.environ.get("CC") else ", ".join(COMPILERS)
        raise refuse("compiler", f"{what} needs a compiler of C, and none was found ({looked})", "Install one, or set CC to one")
    return found


def key(recipe: Recipe, found: Compiler) -> str:
    """What a library depends on: sources, flags (lanes among them), compiler, architecture; a folder may be shared by machines that differ.

    >>> one, other = (key(Recipe("one", {"one.c": text}, ()), Compiler(("cc",), "1")) for text in ("int a;", "int b;"))
    >>> len(one), one == other
    (24, False)
    """
    content = repr((sorted(recipe.sources.items()), recipe.flags, found.command, found.version, platform.system(), platform.machine()))
    return hashlib.sha256(content.encode()).hexdigest()[:24]


def compile_source(recipe: Recipe) -> bytes:
    """A shared library, compiled now and from the sources alone. Raises `DesignError` where there is no compiler or it refuses.

    >>> one = Recipe("an example", {"one.c": "int one(void); int one(void) { return 1; }"}, ("-fPIC", "-shared"))
    >>> len(compile_source(one)) > 1000 if compiler() else True
    True
    """
    found = require_compiler(recipe.what)
    with temporary_folder() as empty:
        return _compile(recipe, found, empty)


def load_library(recipe: Recipe, answers: Answers) -> ctypes.CDLL:
    """A library in this process: the kept one where it is sound, loads and `answers`, else built anew, once.

    Raises `DesignError` where there is no compiler, where it refuses, and where what it has just built does not load or does not answer.

    >>> one = Recipe("an example", {"one.c": "int one(void); int one(void) { return 1; }"}, ("-fPIC", "-shared"))
    >>> load_library(one, lambda library: library.one() == 1).one() if compiler() else 1
    1
    """
    found = require_compiler(recipe.what)
    place = folder()
    name = f"{recipe.what.replace(' ', '_')}-{key(recipe, found)}"
    if not folder_defect(place):
        with suppress(OSError, AttributeError, NotImplementedError):  # a full or read-only disk, or one without locks or programs
            return _cached(place, name, answers) or _renew(place, name, answers, lambda empty: _compile(recipe, found, empty))
    with temporary_folder() as private:
        _compile(recipe, found, private)
        try:
            return _open(private / _MADE, answers)
        except (OSError, AttributeError) as error:
            what = f"what {found.command[0]} makes of {recipe.what} does not work ({error})"
            raise refuse("compiler", what, "Set CC to another compiler") from None


def processor_lanes() -> tuple[Lanes, ...]:
    """The lanes that this processor has, asked now, widest first.

    >>> all(platform.machine() in each.machines for each in processor_lanes())
    True
    """
    features = _features()
    return tuple(each for each in LANES if platform.machine() in each.machines and each.features <= features)


def kernel_lanes() -> Lanes:
    """The widest lanes of this processor, or those of them that FLEXSTAGE_KERNEL names; raises `DesignError` for others.

    >>> kernel_lanes().name in {each.name for each in LANES} or not processor_lanes()
    True
    """
    found = {each.name: each for each in processor_lanes()} or {"plain": Lanes("plain", (), frozenset(), ())}
    stated = os.environ.get(SWITCH, "")
    if stated and stated not in found:
        what = f"it is {stated}, and kernels run here with {', '.join(found)}, or are off"
        raise refuse(SWITCH, what, "State one of these, or nothing for the fastest")
    return found[stated] if stated else next(iter(found.values()))


def kernel_recipe(what: str, source: Path, lanes: Lanes | None = None) -> Recipe:
    """How a kernel of the package is built: a file of C, headers beside it and the vectors all kernels share, for this processor's lanes.

    >>> sorted(kernel_recipe("none", Path(__file__)).sources)
    ['lanes.h', 'native.py']
    """
    files = (source, *sorted({*source.parent.glob("*.h"), Path(__file__).with_name("lanes.h")}))
    flags = (kernel_lanes() if lanes is None else lanes).flags
    return Recipe(what, {each.name: each.read_text(encoding="utf-8") for each in files}, (*_KERNEL, *flags))


def kernel_library(what: str, source: Path, answers: Answers) -> ctypes.CDLL | None:
    """A kernel, which does what numpy does faster; `None` where FLEXSTAGE_KERNEL is off, nothing can build it, or what is built fails.

    Raises `DesignError` where FLEXSTAGE_KERNEL names lanes that this processor has not.

    >>> kernel_library("none", Path(__file__), lambda library: False) is None
    True
    """
    if os.environ.get(SWITCH, "") == "off":
        return None
    recipe = kernel_recipe(what, source)
    try:
        return load_library(recipe, answers)
    except DesignError:
        return None


def folder() -> Path:
    """Where libraries are kept, if nobody else may write to it (see `folder_defect`).

    >>> folder().name
    'native'
    """
    return (cache_folder() / "native").resolve()


def folder_defect(folder: Path) -> str:
    """Why libraries are not taken from a folder; empty where they are. It is made, for its user alone, if it is not there yet.

    It belongs to the user and nobody else may write to it. The folders above it belong to the user or to the system, and nobody else may
    write to them, but for sticky ones such as /tmp. Where a system knows no owners, the user's own folder for caches is trusted.

    >>> folder_defect(Path(os.devnull, "folder"))[:17]
    'it cannot be made'
    """
    above = tuple(reversed(folder.parents))
    try:
        for place in (*above, folder):
            place.mkdir(mode=0o700, exist_ok=True)
        if not hasattr(os, "geteuid"):
            return ""
        return next(filter(None, (_who_may_write(place, is_above=place != folder) for place in (*above, folder))), "")
    except OSError as error:
        return f"it cannot be made ({error.strerror or error})"


def _who_may_write(place: Path, *, is_above: bool) -> str:
    """By whom else a folder or a file could be changed."""
    status, user = place.lstat(), os.geteuid()
    if status.st_uid != user and not (is_above and status.st_uid == 0):
        return f"{place} belongs to user {status.st_uid}, not to {user}"
    if status.st_mode & _OTHERS and not (is_above and status.st_mode & stat.S_ISVTX):
        return f"others may write to {place}"
    return ""


def _cached(folder: Path, name: str, answers: Answers) -> ctypes.CDLL | None:
    """The library of that name in a folder, where it is whole and works."""
    for path in folder.glob(f"{name}-*.so"):
        with suppress(OSError, AttributeError):
            if _is_sound(path) and (library := _open(path, answers)):
                return library
    return None


def _is_sound(path: Path) -> bool:
    """Whether a file is one of the user's own, and its content what its name says."""
    if not stat.S_ISREG(path.lstat().st_mode) or (hasattr(os, "geteuid") and _who_may_write(path, is_above=False)):
        return False
    return path.stem.rpartition("-")[2] == _digest(path.read_bytes())


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:32]


def _renew(folder: Path, name: str, answers: Answers, build: Callable[[Path], bytes]) -> ctypes.CDLL:
    """The library, built into a folder: by one process, while others wait for it."""
    from filelock import FileLock  # takes long to import, and most processes build nothing

    with FileLock(folder / "lock", timeout=_SECONDS, mode=0o600):
        if (library := _cached(folder, name, answers)) is not None:
            return library
        _remove_old(folder, name)
        with tempfile.TemporaryDirectory(dir=folder, prefix=_BUILDING) as building:
            path = folder / f"{name}-{_digest(build(Path(building)))}.so"
            made = Path(building, _MADE)
            made.chmod(0o700)
            made.replace(path)
        return _open(path, answers)


def _remove_old(folder: Path, name: str) -> None:
    """Remove what is no use: libraries of this name that did not work, old ones, and what builders that were killed left behind."""
    for path in folder.glob(f"{_BUILDING}*"):
        shutil.rmtree(path, ignore_errors=True)
    aged = sorted(folder.glob("*.so"), key=lambda each: each.lstat().st_mtime)
    for path in (*folder.glob(f"{name}-*.so"), *aged[:-_KEPT]):
        path.unlink(missing_ok=True)


def _open(path: Path, answers: Answers) -> ctypes.CDLL:
    library = ctypes.CDLL(str(path))
    if not answers(library):
        raise OSError(errno.ENOEXEC, "it does not compute what is known")
    return library


def _compile(recipe: Recipe, found: Compiler, folder: Path) -> bytes:
    """Compiled within an empty folder, by relative names: no path gets into the library."""
    for name, text in recipe.sources.items():
        (folder / name).write_text(text, encoding="utf-8")
    units = sorted(name for name in recipe.sources if name.endswith(".c"))
    command = [*found.command, *recipe.flags, "-o", _MADE, *units, "-lm"]
    advice = "Set CC to another compiler"
    try:
        done = subprocess.run(
            command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=_SECONDS, check=False
        )
    except (OSError, subprocess.SubprocessError) as error:
        raise refuse("compiler", f"{found.command[0]} did not finish ({error})", advice) from None
    if done.returncode != 0:
        raise refuse("compiler", f"{found.command[0]} refuses {recipe.what}: {done.stderr.strip()[:2000]}", f"{advice}, and report this")
    try:
        return (folder / _MADE).read_bytes()
    except OSError:
        raise refuse("compiler", f"{found.command[0]} made no library of {recipe.what}", advice) from None


def _features() -> frozenset[str]:
    """What the processor says it can do; nothing where the system does not tell."""
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        return frozenset(next((line for line in lines if line.startswith(("flags", "Features"))), "").split())
    return frozenset()


def _version(command: tuple[str, ...]) -> str:
    try:
        done = subprocess.run([*command, "--version"], capture_output=True, text=True, timeout=20.0, check=False)
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout if done.returncode == 0 else ""
