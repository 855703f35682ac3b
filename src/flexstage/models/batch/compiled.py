"""A stage's tables and numbers as the kernel in C takes them, and its answer."""

from __future__ import annotations

import ctypes
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.blocks import Scheme
from flexstage.models.batch.choice import MARGIN, THRESHOLD
from flexstage.models.batch.parameters.features import GROUNDED, PORTION, Feature, Rows
from flexstage.models.batch.parameters.numbers import MIRROR, MIRROR_SIGN, Change
from flexstage.models.batch.parameters.planes import SKEW, Planes, no_planes
from flexstage.models.batch.solution import LEAST_PIVOT, Solution, Stage
from flexstage.models.batch.subspace import TOGETHER, Start

MODES = 12
"""Platform modes that the kernel finds at most."""

_ROUNDS = 2
"""How often modes are found one by one at most."""

_KINDS = ("stiffness", "mass", "turn", "first", "second")
_SLOTS = ("stiffness", "mass", "first turn", "first", "second turn", "second", "inertia")
_DESIGNS = ("designs", "numbers_stride", "numbers_portion", "slopes_stride", "slopes_portion", "stride")
_SIZES = (
    *_DESIGNS,
    "bodies",
    "links",
    "edges",
    "updates",
    "numbers",
    "m",
    "count",
    "rounds",
    "once",
    "variables",
    "widest",
    "single",
    "parts",
    "ports",
    "gates",
    "rows",
)
_GRAPH = ("link", "range", "later", "heavy", "product", "update", "mirror", "inertia", "start")
_OWN = ("gate", "through", "normal", "model", "row", "copies", "nth")
_PLANES = (*_OWN, "tree", "member")
_TABLES = (*_GRAPH, "slot", "reach", "about", "run", "entry", "alike", *_PLANES)
_ARRAYS = ("force", "numbers_", "still", "changes")
_SETTINGS = ("shift", "value", "angle", "cluster", "together", "threshold", "margin", "pivot", "skew", "span")
_RESULTS = ("values", "share", "good", "slopes", "between", "crossed")


class _Task(ctypes.Structure):
    """`Task` of kernel.c."""

    _fields_ = (
        *((name, ctypes.c_int64) for name in _SIZES),
        *((name, ctypes.c_void_p) for name in (*_TABLES, *_ARRAYS)),
        *((name, ctypes.c_double) for name in _SETTINGS),
        *((name, ctypes.c_void_p) for name in _RESULTS),
    )


@dataclass(frozen=True, eq=False)
class Tables:
    """What the kernel is told of a topology, of derivatives (the `changes`) and of planes of legs, by name: arrays of whole numbers."""

    scheme: Scheme
    changes: tuple[Change, ...]
    planes: Planes

    def __reduce__(self) -> tuple[type[Tables], tuple[Scheme, tuple[Change, ...], Planes]]:
        """Without what is kept: another process has other places in memory."""
        return Tables, (self.scheme, self.changes, self.planes)

    @cached_property
    def whole(self) -> Tables:
        """The same in the stage's axes, for designs whose legs have not these planes."""
        return Tables(self.scheme, self.changes, no_planes(self.scheme))

    @cached_property
    def arrays(self) -> Mapping[str, Array]:
        """Every table."""
        tree, member = self.planes.members
        trees = {"later": self.planes.later(self.scheme), "tree": tree, "member": member}
        own = {name: getattr(self.planes, name) for name in _OWN}
        return {**_tables(self.scheme), **_slots(self.scheme, self.changes), **trees, **own}

    @cached_property
    def places(self) -> Mapping[str, int]:
        """Where they stand in memory."""
        return _places(self.arrays)

    @cached_property
    def sizes(self) -> Mapping[str, int]:
        """How large they are."""
        graph, topology, copies = self.scheme.graph, self.scheme.topology, self.planes.copies
        return {
            "bodies": len(graph.order),
            "links": len(topology.links),
            "edges": len(graph.edges),
            "updates": sum(map(len, graph.updates)),
            "widest": int(np.diff(self.arrays["reach"], prepend=0).max(initial=0)) * 2,
            "parts": topology.parts,
            "ports": len(copies) - len(graph.order),
            "gates": len(self.planes.gate),
            "rows": 6 * int(copies[len(graph.order) :].sum()) + 6 * len(graph.order),
        }


def by_kernel(library: ctypes.CDLL, stage: Stage, start: Start, tables: Tables) -> Solution:
    """Many designs by iteration from `start`, in C; the same as `by_iteration`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.engine import plan
    >>> from flexstage.models.batch.kernel import kernel
    >>> from flexstage.models.batch.parameters.numbers import numbers_of
    >>> stage = plan(double_triangle(), ())
    >>> numbers = numbers_of(stage.family, np.zeros((1, 0)))
    >>> library = kernel()
    >>> tables = Tables(stage.scheme, (), stage.planes)
    >>> library is None or by_kernel(library, Stage(stage.scheme, numbers), stage.start, tables).good.tolist() == [True]
    True
    """
    job = kernel_job(library.flexstage_width(), stage, start, tables)
    if library.flexstage_modes(ctypes.byref(job.task)):
        job.results["good"][:] = 0
    count = stage.numbers.shape[1]
    values, share, slopes = (job.results[name][..., :count].T for name in ("values", "share", "slopes"))
    good = job.results["good"][:count]
    found = Solution(values, share, good > 0, slopes, _between(job.results, count))
    other = np.flatnonzero(good < 0)
    return found.put(other, by_kernel(library, stage.take(other), start, tables.whole)) if len(other) else found


def _between(results: Mapping[str, Array], count: int) -> Array | None:
    """What is between modes of clusters, where there are any."""
    used = np.flatnonzero(results["crossed"])
    if not len(used):
        return None
    found = np.zeros_like(results["between"])
    found[used] = results["between"][used]
    return np.moveaxis(found, 3, 1).reshape(-1, *found.shape[1:3])[:count].swapaxes(1, 2)


@dataclass(frozen=True, eq=False)
class Job:
    """What the kernel is called with: the `task`, the arrays that it points to, and those among them that it writes."""

    task: ctypes.Structure
    arrays: Mapping[str, Array]
    results: Mapping[str, Array]


def kernel_job(width: int, stage: Stage, start: Start, tables: Tables) -> Job:
    """The designs of a stage for a kernel of so many lanes.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.engine import plan
    >>> from flexstage.models.batch.parameters.numbers import numbers_of
    >>> stage = plan(double_triangle(), ())
    >>> numbers = numbers_of(stage.family, np.zeros((3, 0)))
    >>> tables = Tables(stage.scheme, (), stage.planes)
    >>> kernel_job(8, Stage(stage.scheme, numbers), stage.start, tables).results["values"].shape  # whole vectors, and a line of the cache
    (6, 16)
    """
    count, modes = stage.numbers.shape[1], start.choice.count
    number = _held(stage.numbers)
    change = _held(np.zeros((0, count)) if stage.slopes is None else stage.slopes.values)
    still = np.zeros(len(stage.numbers), dtype=np.int64) if stage.still is None else stage.still.astype(np.int64)
    held = {"force": tables.planes.inside(start.force), "numbers_": number, "changes": change, "still": still}
    vectors = -(-count // width)
    stride = vectors * width + 8  # rows a power of two apart would be on the same lines of the cache
    results: dict[str, Array] = {
        "values": np.empty((modes, stride)),
        "share": np.empty((modes, stride)),
        "good": np.zeros(stride, dtype=np.int64),
        "slopes": np.empty((modes, stage.variables, stride)),
        "between": np.empty((vectors, modes * (modes - 1) // 2, stage.variables, width)),
        "crossed": np.zeros(vectors, dtype=np.int64),
    }
    sizes = _sizes(stage, start, tables, (count, *_strides(number), *_strides(change), stride))
    bounds = (start.shift, start.value, start.angle, start.choice.cluster)
    settings = (*bounds, TOGETHER, THRESHOLD, MARGIN, LEAST_PIVOT, SKEW, tables.planes.span)
    task = _Task(**sizes, **tables.places, **_places(held | results), **dict(zip(_SETTINGS, settings, strict=True)))
    return Job(task, {**tables.arrays, **held}, results)


def _places(arrays: Mapping[str, Array]) -> dict[str, int]:
    return {name: item.ctypes.data for name, item in arrays.items()}


def _held(rows: Array | Rows) -> Array:
    """The numbers where they are: by portions or (rows, designs), designs beside each other. Rows may be farther apart than long."""
    if isinstance(rows, Rows):
        return rows.held
    return rows if rows.strides[1] == rows.itemsize else np.ascontiguousarray(rows)


def _strides(held: Array) -> tuple[int, int]:
    """How many numbers it is from row to row, and from a portion of designs to the next."""
    return held.strides[-2] // 8, held.strides[0] // 8 if held.ndim == 3 else PORTION


def _sizes(stage: Stage, start: Start, tables: Tables, designs: tuple[int, ...]) -> dict[str, int]:
    return {
        **dict(zip(_DESIGNS, designs, strict=True)),
        **tables.sizes,
        "numbers": stage.numbers.shape[0],
        "m": start.force.shape[-1],
        "count": start.choice.count,
        "rounds": _ROUNDS,
        "once": (1 << start.needed) - 1 if np.isinf(start.angle) else sum(1 << int(mode) for mode in np.flatnonzero(start.once)),
        "variables": stage.variables,
        "single": start.needed,
    }


def _tables(scheme: Scheme) -> dict[str, Array]:
    graph, topology = scheme.graph, scheme.topology
    place = {**scheme.position, GROUNDED: -1}
    edge = {pair: number for number, pair in enumerate(graph.edges)}
    link = [
        (part, place[one], place[two], edge.get((min(place[one], place[two]), max(place[one], place[two])), -1))
        for part, one, two in topology.links
    ]
    firsts = [first for first, _ in graph.edges]
    bodies = len(graph.order)
    update = [item for level in graph.updates for item in level]
    starts = {place.kind: place.start for place in reversed(topology.features)}
    inertia = starts["inertia"]
    return {
        "link": np.array(link, dtype=np.int64),
        "range": np.searchsorted(firsts, np.arange(bodies + 1)).astype(np.int64),
        "heavy": np.isin(np.arange(len(graph.edges)), [item[3] for item in link]).astype(np.int64),
        "product": np.searchsorted([firsts[item[0]] for item in update], np.arange(bodies + 1)).astype(np.int64),
        "update": np.array(update, dtype=np.int64).reshape(-1, 3),
        "mirror": topology.mirror,
        "inertia": np.array([inertia + 10 * body for body in graph.order], dtype=np.int64),
        "alike": np.argsort([part for part, *_ in link], kind="stable").astype(np.int64),
        "start": np.array([starts[kind] for kind in _KINDS], dtype=np.int64),
    }


def _slots(scheme: Scheme, changes: tuple[Change, ...]) -> dict[str, Array]:
    """Slots, the single numbers that derivatives are about, by group, entries (slot, row), and runs of entries of one variable."""
    found: list[tuple[int, tuple[int, int, int, int, int, int]]] = []
    for change in changes:
        group, kind, owner = _owner(scheme, change.place)
        columns = change.place.shape[-1] if len(change.place.shape) == 2 else 1
        both = [int(change.mirrored and MIRROR[row] != row) * int(MIRROR_SIGN[row]) for row in change.rows] if columns == 12 else []
        found += [
            (change.variable, (group, kind, owner, row // columns, row % columns, sign))
            for row, sign in itertools.zip_longest(change.rows.tolist(), both, fillvalue=0)
        ]
    slots = {key: number for number, key in enumerate(sorted({key for _, key in found}))}
    entries = sorted((key[0], variable, slots[key], row) for row, (variable, key) in enumerate(found))
    firsts = [at for at, entry in enumerate(entries) if not at or entry[:2] != entries[at - 1][:2]]
    run = [*((entries[at][1], at) for at in firsts), (0, len(entries))]
    groups = np.arange(scheme.topology.parts + len(scheme.topology.links) + len(scheme.graph.order) + 1)
    return {
        "slot": np.array([key[1:] for key in slots], dtype=np.int64).reshape(-1, 5),
        "entry": np.array([entry[2:] for entry in entries], dtype=np.int64).reshape(-1, 2),
        "run": np.array(run, dtype=np.int64),
        "reach": np.searchsorted([key[0] for key in slots], groups).astype(np.int64),
        "about": np.searchsorted([entries[at][0] for at in firsts], groups).astype(np.int64),
    }


def _owner(scheme: Scheme, place: Feature) -> tuple[int, int, int]:
    """The group, the kind and the owner of a feature, bodies by place: groups are parts, then links, then bodies."""
    owner = scheme.position[place.owner] if place.kind == "inertia" else place.owner
    kind = _SLOTS.index(place.kind)
    parts, links = scheme.topology.parts, len(scheme.topology.links)
    return owner + (0 if kind < 2 else parts if kind < 6 else parts + links), kind, owner
