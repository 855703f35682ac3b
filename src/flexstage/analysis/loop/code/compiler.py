"""A compiler of C, where one is there: sources to shared libraries, kept by content."""

from __future__ import annotations

import hashlib
import os
import subprocess
from collections.abc import Mapping
from pathlib import Path

from flexstage.base.compiler import COMPILERS, Compiler, compiler
from flexstage.base.finding import DesignError, refuse
from flexstage.base.store import cache_folder, temporary_folder, write

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-fPIC", "-shared", *WARNINGS)
"""Without contraction: a product and a sum round as written, here as elsewhere."""
_KEPT = 64
_SECONDS = 300.0


def require_compiler(what: str) -> Compiler:
    """The compiler; raises `DesignError` where `what` needs one and none is there.

    >>> require_compiler("the compiled loop").version == compiler().version if compiler() else True
    True
    """
    found = compiler()
    if found is None:
        looked = f"CC = {os.environ['CC']}" if os.environ.get("CC") else ", ".join(COMPILERS)
        raise refuse("compiler", f"{what} needs a compiler of C, and none was found ({looked})", "Install one, or set CC to one")
    return found


def library(sources: Mapping[str, str], what: str) -> bytes:
    """The shared library of `sources` (text by file name), compiled as C99 with warnings as errors; the same ones give the same bytes.

    Kept in the cache's folder by content, compiler and flags. Raises `DesignError` where there is no compiler or it refuses.

    >>> len(library({"one.c": "int one(void); int one(void) { return 1; }"}, "an example")) > 1000 if compiler() else True
    True
    """
    found = require_compiler(what)
    key = hashlib.sha256(repr((sorted(sources.items()), found, FLAGS)).encode()).hexdigest()[:32]
    place = cache_folder() / "loops" / f"{key}.so"
    if place.is_file():
        return place.read_bytes()
    with temporary_folder() as folder:
        made = _compiled(found, sources, folder)
    _keep(place, made)
    return made


def _compiled(found: Compiler, sources: Mapping[str, str], folder: Path) -> bytes:
    """Compiled within the folder, by relative names: no path gets into the library."""
    for name, text in sources.items():
        (folder / name).write_text(text, encoding="utf-8")
    units = sorted(name for name in sources if name.endswith(".c"))
    command = [*found.command, *FLAGS, "-o", "made.so", *units, "-lm"]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=_SECONDS, check=False)
    except (OSError, subprocess.SubprocessError) as error:
        raise refuse("compiler", f"{found.command[0]} did not finish ({error})", "See whether it works, or set CC to another") from None
    if done.returncode != 0:
        raise refuse("compiler", f"{found.command[0]} refuses the code: {done.stderr.strip()[:2000]}", "Set CC to another, and report this")
    return (folder / "made.so").read_bytes()


def _keep(place: Path, made: bytes) -> None:
    """A folder that cannot be written to only costs time."""
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        write(place, made)
        aged = sorted(place.parent.glob("*.so"), key=lambda each: each.stat().st_mtime)
        for each in aged[:-_KEPT]:
            each.unlink(missing_ok=True)
    except (OSError, DesignError):
        return
