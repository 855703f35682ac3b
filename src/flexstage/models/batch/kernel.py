"""The iteration in C, several designs in each vector of the processor: built where there is a compiler, never required.

Where nothing is found to build it, or what is built does not work, there is none and numpy does the same work. FLEXSTAGE_KERNEL=off does
without it, FLEXSTAGE_KERNEL=avx2 takes vectors of four where a processor has those of eight.
"""

from __future__ import annotations

import ctypes
import functools
from pathlib import Path

from flexstage.base.processes.native import compiler, kernel_lanes, kernel_library, kernel_recipe, key

_WHAT, _SOURCE = "the kernel", Path(__file__).with_name("kernel.c")


@functools.cache
def kernel() -> ctypes.CDLL | None:
    """The library, built if need be; `None` where there cannot be one.

    >>> found = kernel()
    >>> found is None or found.flexstage_width() in (2, 4, 8)
    True
    """
    return kernel_library(_WHAT, _SOURCE, _answers)


@functools.cache
def kernel_name() -> str:
    """What iterates here: the library by what it is made of, or none. With the same name, results are the same to the bit.

    >>> "kernel" in kernel_name()
    True
    """
    found = compiler() if kernel() is not None else None
    return "no kernel" if found is None else f"kernel {kernel_lanes().name} {key(kernel_recipe(_WHAT, _SOURCE), found)[:12]}"


def _answers(library: ctypes.CDLL) -> bool:
    library.flexstage_modes.restype = library.flexstage_width.restype = ctypes.c_int64
    return library.flexstage_width() in (2, 4, 8)
