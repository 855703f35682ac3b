"""The compiler of C of this machine, where there is one."""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass

COMPILERS = ("cc", "gcc", "clang")
"""Names by which a compiler is looked for."""


@dataclass(frozen=True)
class Compiler:
    """A compiler by the words that call it, and what it says of its version."""

    command: tuple[str, ...]
    version: str


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


def _version(command: tuple[str, ...]) -> str:
    try:
        done = subprocess.run([*command, "--version"], capture_output=True, text=True, timeout=20.0, check=False)
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout if done.returncode == 0 else ""
