"""Compiled iteration in C, for several designs per vector register. The kernel is used if it was built at installation.

Without the kernel, dense matrices give the same results. `FLEXSTAGE_KERNEL=off` disables the kernel. `FLEXSTAGE_KERNEL=avx2` selects
vectors of four numbers, even on processors with vectors of eight numbers.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexstage.base.number import Array
from flexstage.base.processes.native import kernel_library, library_digest
from flexstage.models.batch.choice import MARGIN, THRESHOLD, Choice
from flexstage.models.batch.graph import GROUNDED, SHAPES, Elimination, Topology

MODES = 12
"""Maximum number of platform modes in the kernel."""
_ROUNDS = 2
"""Maximum number of repetitions of the mode-by-mode iteration."""
_VALUE = 1e-6
"""Relative error bound of eigenvalues."""
_TOGETHER = 1e-4
"""Relative gap of eigenvalues below which both sides are counted together."""
_PIVOT = 1e-9
"""Minimum pivot of K over its diagonal entry: below it another method decides whether K is singular."""
_SIZES = ("designs", "stride", "bodies", "links", "edges", "updates", "numbers", "parts", "m", "count", "rounds", "single")
_TABLES = ("link", "range", "later", "heavy", "product", "update", "mirror", "inertia", "start")
_ARRAYS = ("force", "numbers_")
_SETTINGS = ("shift", "value", "cluster", "together", "threshold", "margin", "pivot")
_RESULTS = ("values", "good")


class _Task(ctypes.Structure):
    """`Task` of kernel.c."""

    _fields_ = (
        *((name, ctypes.c_int64) for name in _SIZES),
        *((name, ctypes.c_void_p) for name in (*_TABLES, *_ARRAYS)),
        *((name, ctypes.c_double) for name in _SETTINGS),
        *((name, ctypes.c_void_p) for name in _RESULTS),
    )


@functools.cache
def kernel() -> ctypes.CDLL | None:
    """Load the library, or return `None` if there is none.

    >>> result = kernel()
    >>> result is None or result.flexstage_width() in (2, 4, 8)
    True
    """
    library = kernel_library(SOURCE)
    if library is not None:
        library.flexstage_modes.restype = library.flexstage_width.restype = ctypes.c_int64
    return library


SOURCE = Path(__file__).with_name("kernel.c")


def kernel_name() -> str:
    """Return a name of the library, formed from its vector lanes and content, or "no kernel". Equal names give bit-identical results.

    >>> kernel_name()[:9] in {"no kernel", "kernel av", "kernel ss", "kernel ne", "kernel pl"}
    True
    """
    return "no kernel" if kernel() is None else f"kernel {library_digest(SOURCE)}"


@dataclass(frozen=True, eq=False)
class Start:
    """Start values of the iteration: inertial forces `force` (six per body, m) of m nominal modes, and a `shift` between two eigenvalues.

    `needed` is the number of modes that are computed one by one.
    """

    force: Array
    shift: float
    needed: int


@dataclass(frozen=True, eq=False)
class Job:
    """Arguments of a kernel call: the structure `task`, its input arrays, and its output arrays."""

    task: ctypes.Structure
    arrays: Mapping[str, Array]
    results: Mapping[str, Array]


def solve_designs(library: ctypes.CDLL, tables: Mapping[str, Array], numbers: Array, start: Start, choice: Choice) -> tuple[Array, Array]:
    """Compute the ascending platform eigenvalues (b, k) of b designs from their `numbers` (numbers, b).

    Also returns a mask (b,) of the designs with a result that is proven to be correct.
    """
    job, count = kernel_job(library.flexstage_width(), tables, numbers, start, choice), numbers.shape[1]
    if library.flexstage_modes(ctypes.byref(job.task)):
        job.results["good"][:] = 0
    return job.results["values"][:, :count].T, job.results["good"][:count] > 0


def kernel_job(width: int, tables: Mapping[str, Array], numbers: Array, start: Start, choice: Choice) -> Job:
    """Build the arguments of a kernel call for the designs; `width` is the number of vector lanes."""
    count = numbers.shape[1]
    stride = -(-count // width) * width + 8  # rows a power of two apart would share cache lines
    arrays = {**tables, "force": np.ascontiguousarray(start.force), "numbers_": np.ascontiguousarray(numbers)}
    results = {"values": np.empty((choice.count, stride)), "good": np.zeros(stride, dtype=np.int64)}
    sizes = {
        "designs": count,
        "stride": stride,
        "bodies": len(tables["inertia"]),
        "links": len(tables["link"]),
        "edges": len(tables["later"]),
        "updates": len(tables["update"]),
        "numbers": len(numbers),
        "parts": int(tables["link"][:, 0].max()) + 1,
        "m": start.force.shape[1],
        "count": choice.count,
        "rounds": _ROUNDS,
        "single": start.needed,
    }
    settings = dict(zip(_SETTINGS, (start.shift, _VALUE, choice.cluster, _TOGETHER, THRESHOLD, MARGIN, _PIVOT), strict=True))
    places = {name: array.ctypes.data for name, array in (arrays | results).items()}
    return Job(_Task(**sizes, **settings, **places), arrays, results)


def kernel_tables(topology: Topology, graph: Elimination) -> dict[str, Array]:
    """Build the integer tables of a topology for the kernel, by name."""
    place = {body: number for number, body in enumerate(graph.order)} | {GROUNDED: -1}
    edge = {pair: number for number, pair in enumerate(graph.edges)}
    ends = [(part, place[one], place[two]) for part, one, two in topology.links]
    link = [(part, one, two, edge.get((min(one, two), max(one, two)), -1)) for part, one, two in ends]
    firsts, bodies = [first for first, _ in graph.edges], np.arange(len(graph.order) + 1)
    tables = {
        "link": link,
        "range": np.searchsorted(firsts, bodies),
        "later": [later for _, later in graph.edges],
        "heavy": np.isin(np.arange(len(graph.edges)), [item[3] for item in link]),
        "product": np.searchsorted([firsts[item[0]] for item in graph.updates], bodies),
        "update": np.reshape(graph.updates, (-1, 3)),
        "mirror": topology.mirror,
        "inertia": topology.starts["inertia"] + 10 * np.array(graph.order),
        "start": [topology.starts[kind] for kind in SHAPES if kind != "inertia"],
    }
    return {name: np.ascontiguousarray(table, dtype=np.int64) for name, table in tables.items()}
