"""Other processors on this one: the tests whose numbers depend on how a processor rounds, repeated with the kernels of two others.

    python -m tools.processors       (part of `make check-all`)

OpenBLAS and numpy hold code for many processors and take the newest that runs; both can be told to take an older one. Kernels that this
processor lacks would crash, so they are left out.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from collections.abc import Mapping

from threadpoolctl import threadpool_info

_NEEDED = {"Nehalem": {"SSE42", "X86_V2"}, "Haswell": {"AVX2", "X86_V3"}, "Zen": {"AVX2", "X86_V3"}, "SkylakeX": {"AVX512_SKX", "X86_V4"}}
_TESTS = ("tests/laws", "tests/analytic", "tests/models/test_identify.py", "tests/models/test_identify_limits.py")


def processors() -> Mapping[str, Mapping[str, str]]:
    """By name of an OpenBLAS kernel that runs here and is not this processor's own: the environment that chooses it, oldest first.

    With the oldest, numpy is told to leave out all that a processor of its family may lack.
    """
    core = importlib.import_module("numpy._core._multiarray_umath")  # which also loads numpy's own OpenBLAS
    has: Mapping[str, bool] = core.__cpu_features__
    own = {each.get("architecture", "").lower() for each in threadpool_info()}
    names = [name for name, needed in _NEEDED.items() if any(has.get(each, False) for each in needed) and name.lower() not in own]
    plain = " ".join(name for name in core.__cpu_dispatch__ if has.get(name, False))
    return {name: {"OPENBLAS_CORETYPE": name} | ({"NPY_DISABLE_CPU_FEATURES": plain} if name == "Nehalem" else {}) for name in names}


def main() -> int:
    """Run the tests on two other processors; the exit code is the first failure's."""
    chosen = list(processors().items())[:2]
    if not chosen:
        print("OpenBLAS has no other kernels for this processor: nothing to repeat.")
    for name, environment in chosen:
        print(f"== as on {name}", flush=True)
        command = [sys.executable, "-m", "pytest", "-q", "-n", os.environ.get("JOBS", "2"), "--dist", "worksteal", *_TESTS]
        code = subprocess.run(command, env={**os.environ, **environment}, check=False).returncode
        if code:
            return code
    return 0


if __name__ == "__main__":
    sys.exit(main())
