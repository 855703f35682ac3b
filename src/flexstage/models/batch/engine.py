"""Platform frequencies of many designs at once, and their derivatives by every number that varies.

Numbers of designs -> features (`numbers`) -> blocks of bodies (`blocks`) -> iteration from the modes of the family's own design
(`subspace`, or the same in C: `kernel`) -> derivatives (`slopes`). What iteration does not prove is solved again whole (`dense`). Every
design is computed by itself: results do not depend on the others beside it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from enum import Enum, IntEnum
from functools import cached_property

import numpy as np

from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.base.processes.threads import one_thread
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.batch.blocks import Scheme, blocks, dense, scheme
from flexstage.models.batch.choice import Choice, choose
from flexstage.models.batch.compiled import MODES, Tables, by_kernel
from flexstage.models.batch.dense import Whole
from flexstage.models.batch.kernel import kernel
from flexstage.models.batch.locked import locked_solution
from flexstage.models.batch.parameters.features import Rows
from flexstage.models.batch.parameters.numbers import Family, Slopes, family, numbers_and_slopes, numbers_of, rows_of
from flexstage.models.batch.parameters.planes import Planes, no_planes, planes
from flexstage.models.batch.parameters.surface import Surface, surface
from flexstage.models.batch.solution import Solution, Stage, by_iteration, cluster_slopes, every_mode, wholly
from flexstage.models.batch.subspace import Start
from flexstage.models.lumped import lumped

_CHUNK, PORTION = 1024, 128
"""Designs described at once, and those iterated at once in numpy: as many as the processor's cache holds."""

_MOST = 16
"""Vectors of a block at most."""

_DEGREE, _GROWTH = 7, 1e10
"""Degree of a polynomial at most; how much more the lowest mode may grow than those outside, lest the highest of the block drown in it."""

_VALUE, _ANGLE = 1e-6, 1e-6
"""Relative bound of eigenvalues; bound of the angles of vectors, where derivatives are asked for."""


_NEAR = 0.3
"""How far an eigenvalue is from the shift to begin with, over how far it is below the highest wanted, whose vector takes one step."""

_WIDE = 0.02
"""Relative gap of eigenvalues in which a shift may lie."""


class Status(IntEnum):
    """How a design ended."""

    ITERATED = 0
    """By iteration, proved."""
    WHOLE = 1
    """By dense matrices."""
    SINGULAR = 2
    """Some motion has no stiffness, or a negative one: no frequencies."""
    NOT_FINITE = 3
    """Some number of it is not finite: no frequencies."""
    FEW = 4
    """It has fewer platform frequencies than asked for: none are given."""
    REFUSED = 5
    """It cannot be described, as where outlines overlap that cannot be weighed: no frequencies. Reading it by itself tells why."""


class Method(Enum):
    """What iterates: the kernel in C where there is one, else numpy; or numpy in any case. Both give the same."""

    FASTEST = "fastest"
    NUMPY = "numpy"


@dataclass(frozen=True, eq=False)
class Plan:
    """What is found once for a family of designs.

    Topology, order of elimination, `planes` of symmetry of its legs and the block to begin with (none: all are solved whole); a `wider` one
    for designs where that is not enough, as modes cross; the `surface` of their features over stated ranges.
    """

    family: Family
    scheme: Scheme
    choice: Choice
    planes: Planes
    start: Start | None
    wider: Start | None = None
    surface: Surface | None = None

    @cached_property
    def tables(self) -> Tables:
        """What the kernel is told of the topology."""
        return Tables(self.scheme, (), self.planes)

    @cached_property
    def slope_tables(self) -> Tables:
        """What it is told with derivatives."""
        return Tables(self.scheme, self.family.changes, self.planes)

    @cached_property
    def wide_tables(self) -> Tables:
        """What it is told where designs change more than those near the nominal one."""
        return Tables(self.scheme, self.family.wide, self.planes)


@dataclass(frozen=True, eq=False)
class PlatformModes:
    """Platform modes of b designs; NaN where there are none.

    `frequencies` (b, k) [Hz] ascending, `share` (b, k), `status` (b,) of `Status`. `slopes` (b, P, k, k) [Hz per SI unit] are the symmetric
    matrices Phi^T (dK - lambda dM) Phi / (8 pi^2 f) of each cluster, zero between clusters: their eigenvalues are one-sided derivatives.
    `gradient` (b, P, k) is their trace over their size: the derivative of a cluster's mean, for each of its modes. Both have P = 0 unless
    they were asked for.
    """

    frequencies: Array
    share: Array
    status: Array
    slopes: Array
    gradient: Array


@one_thread
def plan(mechanism: Mechanism, addresses: tuple[str, ...], choice: Choice | None = None, ranges: tuple[Array, Array] | None = None) -> Plan:
    """Plan a family of designs around a mechanism, with other numbers at the addresses.

    With `ranges`, (low, high) of (P,), features are fitted over them once (seconds), where polynomials meet them to 1e-10: then numbers of
    designs within cost less than solving. Others are described one by one, as they all are without ranges.

    Raises `DesignError` for addresses that are none, and for a mechanism whose own stiffness is singular.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = plan(double_triangle(), ("parts.neck.thickness",))
    >>> found.scheme.topology.size
    114
    """
    return plan_family(family(mechanism, addresses), choice, ranges)


def plan_family(family_: Family, choice: Choice | None = None, ranges: tuple[Array, Array] | None = None) -> Plan:
    """Plan a family of designs, however it is drawn: see `plan`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> plan_family(family(double_triangle(), ("parts.neck.thickness",))).scheme.topology.size
    114
    """
    scheme_ = scheme(family_.topology)
    choice = choice or Choice()
    if family_.topology.locked:
        lumped(family_.mechanism)  # says which bodies can move freely
        return Plan(family_, scheme_, choice, no_planes(scheme_), None)
    numbers = numbers_of(family_, family_.nominal[None])
    modes = every_mode(scheme_, numbers)
    if not len(modes.values):
        lumped(family_.mechanism)  # says which bodies can move freely
        return Plan(family_, scheme_, choice, no_planes(scheme_), None)
    fitted = None if ranges is None else surface(family_, *(np.asarray(side, dtype=float) for side in ranges))
    starts = _starts(scheme_, dense(scheme_, blocks(scheme_, numbers)[1])[0], modes, choice)
    planes_ = planes(scheme_, numbers, family_.near)
    return Plan(family_ if fitted is None else fitted.family, scheme_, choice, planes_, *starts, fitted)


def _starts(scheme_: Scheme, inertia: Array, modes: Whole, choice: Choice) -> tuple[Start | None, Start | None]:
    """The modes to begin with, as many as make the fewest operations, and the most there is room for; none if that is not less than all."""
    picked = choose(modes.values[None], modes.parts[None], choice)
    values = modes.values
    if not picked.exact[0]:
        return None, None
    needed = int(np.flatnonzero(picked.mask[0])[-1]) + 1
    counts = np.arange(needed + 2, min(_MOST + 1, len(values) // 2))
    if not len(counts):
        return None, None
    few = counts[:7]
    cost = few * (1.0 + few / 30.0) / np.arccosh(2.0 * values[few] / values[needed - 1] - 1.0)
    most = counts[-3:][np.argmax(values[counts[-3:]] / values[counts[-3:] - 1])]
    both = np.stack([modes.shapes, inertia @ modes.shapes])[:, np.argsort(scheme_.coordinates)]
    first, wider = (_start(values, both[..., : int(count)], choice, needed) for count in (few[np.argmin(cost)], most))
    first = replace(first, force=first.force[..., :needed])
    inner = np.arange(needed, most - 1)
    wider = replace(wider, needed=int(inner[np.argmax(values[inner] / values[inner - 1])]), once=first.once[:0])
    return first, wider if most > first.block.shape[-1] else None


def _start(values: Array, both: Array, choice: Choice, needed: int) -> Start:
    """The modes of the lowest values, and M times them (2, n, count), as what to begin with."""
    count = both.shape[-1]
    block, force = (np.ascontiguousarray(each).reshape(-1, 6, count) for each in both)
    edge = float(values[count] / values[count - 1])
    spread = 4.0 * values[count] / values[0] - 2.0  # twice the argument of the polynomial at the lowest mode: its powers are the growth
    degree = max(1, min(_DEGREE, int(np.log(_GROWTH) / np.log(spread))))
    shift = _shift(values[:needed])
    once = np.abs(values[:needed] - shift) < _NEAR * (values[needed - 1] - values[:needed])
    return Start(block, choice, edge, degree, value=_VALUE, needed=needed, once=once, force=force, shift=shift)


def _shift(values: Array) -> float:
    """Amid the wanted eigenvalues, far from each."""
    edges = np.concatenate([[0.0], values])
    between, wide = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges) > _WIDE * edges[1:]
    return float(between[wide][np.argmin(np.abs(between[wide] - 0.5 * (values[0] + values[-1])))])


@one_thread
def platform_modes(plan_: Plan, values: Array, *, slopes: bool = False, method: Method = Method.FASTEST) -> PlatformModes:
    """The platform's modes of designs given by the numbers (b, P) at the plan's addresses, and with `slopes` their derivatives by these.

    Frequencies agree with those of `models.lumped` solved whole within 1e-6 (relative), proved design by design. Numbers that are not
    finite, stiffness that is not positive and outlines that cannot be weighed stop no other design: its `Status` says what is wrong.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = platform_modes(plan(double_triangle(), ("parts.neck.thickness",)), np.array([[1.54e-3], [1.60e-3], [np.nan]]))
    >>> found.frequencies[:2, 5].round(2).tolist(), [Status(number).name for number in found.status]
    ([173.09, 174.3], ['ITERATED', 'ITERATED', 'NOT_FINITE'])
    """
    values = np.asarray(values, dtype=float)
    starts = range(0, max(len(values), 1), _CHUNK)
    return _joined([_apart(plan_, values[start : start + _CHUNK], slopes=slopes, method=method) for start in starts])


def _joined(pieces: list[PlatformModes]) -> PlatformModes:
    columns = [[getattr(piece, field.name) for piece in pieces] for field in fields(PlatformModes)]
    return PlatformModes(*(np.concatenate(column) for column in columns))


def _apart(plan_: Plan, values: Array, *, slopes: bool, method: Method) -> PlatformModes:
    """The designs of one chunk; halves of what cannot be described together, down to the design that cannot be at all."""
    try:
        return _piece(plan_, values, slopes=slopes, method=method)
    except DesignError:
        if len(values) > 1:
            halves = np.array_split(values, 2)
            return _joined([_apart(plan_, half, slopes=slopes, method=method) for half in halves])
    refused = _nothing(plan_, 1, slopes=slopes)
    refused.status[:] = Status.REFUSED
    return refused


def _piece(plan_: Plan, values: Array, *, slopes: bool, method: Method, wide: bool = False) -> PlatformModes:
    """The designs of one chunk; with `wide` by all that can change of bodies."""
    result = _nothing(plan_, len(values), slopes=slopes)
    if not len(values):
        return result
    finite: Array = np.asarray(np.isfinite(values).all(axis=1))
    safe = np.where(finite[:, None], values, plan_.family.nominal)
    with np.errstate(all="ignore"):  # designs far from any sense: told by their status
        if plan_.family.topology.locked:
            result.status[~finite] = Status.NOT_FINITE
            for design in np.flatnonzero(finite):
                _write(plan_, result, np.array([design]), locked_solution(plan_.family, safe[design], plan_.choice, slopes=slopes))
            return result
        stage = stage_of(plan_, safe, slopes=slopes, wide=wide)
        finite = finite & stage.finite
        result.status[~finite] = Status.NOT_FINITE
        left = finite
        if plan_.start is not None:
            found = iterate(plan_, _tame(stage, finite), method)
            good = finite & found.good
            _write(plan_, result, np.flatnonzero(good), found.take(good))
            result.status[good] = Status.ITERATED
            left = finite & ~good
        rest = np.flatnonzero(left)
        for design, solution in zip(rest, wholly(stage.take(rest), plan_.choice), strict=True):
            _write(plan_, result, np.array([design]), solution)
    again = np.flatnonzero(stage.slopes.missed) if stage.slopes is not None else np.zeros(0, dtype=int)
    if len(again):
        wider = _piece(plan_, values[again], slopes=True, method=method, wide=True)
        for field in fields(PlatformModes):
            getattr(result, field.name)[again] = getattr(wider, field.name)
    return result


def iterate(plan_: Plan, stage: Stage, method: Method = Method.FASTEST) -> Solution:
    """The designs of a stage by iteration: from features to eigenvalues and their derivatives.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = plan(double_triangle(), ())
    >>> iterate(found, Stage(found.scheme, numbers_of(found.family, np.zeros((1, 0))))).good.tolist()
    [True]
    """
    if plan_.start is None:
        raise ValueError("this plan has no block to begin with: its designs are solved whole")
    found = _from(plan_, stage, plan_.start, method)
    left = np.flatnonzero(~found.good)
    if plan_.wider is not None and len(left):
        return found.put(left, _from(plan_, stage.take(left), plan_.wider, method))
    return found


def _from(plan_: Plan, stage: Stage, start: Start, method: Method) -> Solution:
    start = replace(start, degree=min(2, start.degree)) if stage.slopes is None else replace(start, angle=_ANGLE)
    library = kernel() if method is Method.FASTEST and plan_.choice.count <= MODES else None
    if library is not None:
        return by_kernel(library, stage, start, _tables(plan_, stage.slopes))
    size = stage.numbers.shape[1]
    portions = [by_iteration(stage.take(slice(first, first + PORTION)), start) for first in range(0, size, PORTION)]
    return Solution(*(np.concatenate([getattr(portion, field.name) for portion in portions]) for field in fields(Solution)))


def _tables(plan_: Plan, slopes: Slopes | None) -> Tables:
    if slopes is None:
        return plan_.tables
    return plan_.slope_tables if slopes.changes is plan_.family.changes else plan_.wide_tables


def _nothing(plan_: Plan, size: int, *, slopes: bool) -> PlatformModes:
    count, variables = plan_.choice.count, len(plan_.family.addresses) if slopes else 0
    shape = (size, variables, count, count)
    return PlatformModes(
        np.full((size, count), np.nan),
        np.full((size, count), np.nan),
        np.full(size, int(Status.SINGULAR)),
        np.full(shape, np.nan),
        np.full(shape[:3], np.nan),
    )


def stage_of(plan_: Plan, values: Array, *, slopes: bool, wide: bool = False) -> Stage:
    """The designs (b, P) in their features, with derivatives where these are asked for: of all that can change of bodies if `wide`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage_of(plan(double_triangle(), ("parts.neck.thickness",)), np.array([[1e-3], [2e-3]]), slopes=True).numbers.shape[1]
    2
    """
    if plan_.surface is None or wide:
        numbers, derivatives = _described(plan_, values, slopes=slopes, wide=wide)
        still = None if derivatives is None else derivatives.still
        return Stage(plan_.scheme, numbers, values.shape[1] if slopes else 0, derivatives, still)
    numbers, derivatives = plan_.surface.numbers(values), plan_.surface.slopes(values) if slopes else None
    outside = np.flatnonzero(~plan_.surface.holds(values))
    if len(outside):
        described, there = _described(plan_, values[outside], slopes=slopes)
        numbers[:, outside] = described[:]
        if derivatives is not None and there is not None:
            derivatives.values[:, outside], derivatives.missed[outside] = there.values[:], there.missed
    return Stage(plan_.scheme, numbers, values.shape[1] if slopes else 0, derivatives)


def _described(plan_: Plan, values: Array, *, slopes: bool, wide: bool = False) -> tuple[Rows, Slopes | None]:
    """The features of designs that are described, and their derivatives where these are asked for."""
    return numbers_and_slopes(plan_.family, values, wide=wide) if slopes else (rows_of(plan_.family, values), None)


def _tame(stage: Stage, finite: Array) -> Stage:
    """Designs that are not finite are replaced by one that is, so that the others can be iterated beside them."""
    if finite.all() or not finite.any():
        return stage
    return stage.take(np.where(finite, np.arange(len(finite)), np.argmax(finite)))


def _write(plan_: Plan, result: PlatformModes, designs: Array, found: Solution) -> None:
    if found.values.shape[1] < plan_.choice.count:
        result.status[designs] = Status.FEW if found.good.all() else Status.SINGULAR
        return
    result.status[designs] = Status.WHOLE
    frequencies = np.sqrt(found.values) / (2.0 * np.pi)
    scale = (1.0 / (8.0 * np.pi**2 * frequencies))[:, None]
    result.frequencies[designs], result.share[designs] = frequencies, found.share
    result.slopes[designs], result.gradient[designs] = found.matrices * scale[..., None], cluster_slopes(found, plan_.choice) * scale
