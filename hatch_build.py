"""Build the kernels when the package is installed: each source once for every width of vectors, several at a time.

A library that was built from the same sources, by the same compiler and with the same flags stays. Without a compiler the wheel is a pure
one and numpy does the work; where a compiler refuses some lanes, their kernels are left out.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent / "src"))

from flexstage.base.processes.native import HEADERS, KERNELS, Lanes, library_path, machine_lanes, sources_digest

# -O3 takes nearly twice as long to compile.
FLAGS = ("-O2", "-ffp-contract=fast", "-fno-math-errno", "-fPIC", "-shared")


class KernelHook(BuildHookInterface[Any]):
    """What hatchling calls before it packs or links the package."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Build the kernels and name the platform; an editable installation finds them beside their sources."""
        if self.target_name == "wheel" and build_kernels():
            build_data["pure_python"] = False
            build_data["tag"] = f"py3-none-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def build_kernels() -> list[Path]:
    """Build what is not there yet, and return all libraries; none without a compiler."""
    compiler = find_compiler()
    if compiler is None:
        for stale in (path for source in KERNELS for path in source.parent.glob("*.so")):
            stale.unlink()
        return []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        made = pool.map(lambda each: build(compiler, *each), [(source, lanes) for source in KERNELS for lanes in machine_lanes()])
    return [path for path in made if path is not None]


def find_compiler() -> tuple[str, ...] | None:
    """The words that call the compiler which CC names, or `cc`, `gcc` or `clang`."""
    for words in [os.environ["CC"].split()] if os.environ.get("CC", "").strip() else [["cc"], ["gcc"], ["clang"]]:
        if path := shutil.which(words[0]):
            return path, *words[1:]
    return None


def build(compiler: tuple[str, ...], source: Path, lanes: Lanes) -> Path | None:
    """The library of a kernel for some lanes, built unless it is there."""
    path, sources = library_path(source, lanes), sources_digest(source)
    version = subprocess.run([*compiler, "--version"], capture_output=True, text=True, check=False).stdout
    key = hashlib.sha256(repr((sources, compiler, version, FLAGS, lanes)).encode()).hexdigest()[:32]
    if path.exists() and key.encode() in path.read_bytes():
        return path
    begun = path.with_suffix(f".{os.getpid()}.part")
    macros = (f'-DFLEXSTAGE_SOURCES="{sources}"', f'-DFLEXSTAGE_BUILD="{key}"')
    command = [*compiler, *FLAGS, *lanes.flags, *macros, f"-I{HEADERS}", "-o", str(begun), source.name, "-lm"]
    done = subprocess.run(command, cwd=source.parent, capture_output=True, text=True, check=False)
    if done.returncode:
        begun.unlink(missing_ok=True)
        sys.stderr.write(f"{source}, {lanes.name}: {done.stderr.strip()[:2000]}\n")
        return None
    begun.replace(path)
    return path
