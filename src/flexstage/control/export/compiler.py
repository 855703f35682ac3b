"""The C compiler of this computer, for exported code."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

from flexstage.base.finding import refuse
from flexstage.base.storage.store import temporary_folder

COMPILERS = ("cc", "gcc", "clang")
"""Command names of known compilers."""
_MADE, _SECONDS = "made.so", 300.0


def find_compiler() -> tuple[str, ...] | None:
    """Find the command of the C compiler: the environment variable CC if set, else `cc`, `gcc` or `clang`; None if not found.

    >>> found = find_compiler()
    >>> found is None or len(found) > 0
    True
    """
    stated = os.environ.get("CC", "").split()
    for words in (stated,) if stated else ((name,) for name in COMPILERS):
        if (path := shutil.which(words[0])) is not None:
            return (path, *words[1:])
    return None


def compile_source(what: str, sources: Mapping[str, str], flags: tuple[str, ...]) -> bytes:
    """Compile `sources` (text by file name) to a shared library. A temporary working folder keeps file paths out of the library.

    Raises `DesignError` without a compiler, or for sources that do not compile.

    >>> sources = {"one.c": "int one(void); int one(void) { return 1; }"}
    >>> len(compile_source("an example", sources, ("-fPIC", "-shared"))) > 1000 if find_compiler() else True
    True
    """
    found = find_compiler()
    if found is None:
        looked = f"CC = {os.environ['CC']}" if os.environ.get("CC") else ", ".join(COMPILERS)
        raise refuse("compiler", f"{what} needs a C compiler (found none of {looked})", "Install a compiler, or set CC to its command")
    with temporary_folder() as folder:
        for name, text in sources.items():
            Path(folder, name).write_text(text, encoding="utf-8")
        units = sorted(name for name in sources if name.endswith(".c"))
        try:
            command = [*found, *flags, "-o", _MADE, *units, "-lm"]
            done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=_SECONDS, check=False)
            said = done.stderr.decode(errors="replace").strip()[:2000] if done.returncode else ""
            if not said:
                return Path(folder, _MADE).read_bytes()
        except (OSError, subprocess.SubprocessError) as error:
            said = str(error)
    raise refuse("compiler", f"{found[0]} cannot compile {what}: {said}", "Set CC to another compiler, and report this")
