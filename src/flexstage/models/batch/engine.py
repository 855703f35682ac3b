"""Platform frequencies of many designs at once.

The iteration of the designs (`family`) is in C (`kernel`). It starts from the modes of the nominal design, and uses the elimination order
of the bodies (`graph`). Designs without a proven result are solved by dense matrices (`dense`). If there is no kernel, all designs are
solved by dense matrices.

Every design is computed individually: its result does not depend on other designs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Array
from flexstage.base.processes.threads import one_thread
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.batch.choice import Choice, choose
from flexstage.models.batch.dense import AllModes, modes_of_designs, platform_values
from flexstage.models.batch.family import Family, describe, family, numbers_of
from flexstage.models.batch.graph import eliminate_bodies
from flexstage.models.batch.kernel import MODES, Start, kernel, kernel_tables, solve_designs
from flexstage.models.batch.surface import Surface, surface
from flexstage.models.lumped import lumped

_CHUNK, _PORTION = 512, 32
"""Designs described at once, and designs solved by dense matrices at once: as many as the processor cache holds."""
_MOST = 16
"""Maximum number of vectors of a block."""
_WIDE = 0.02
"""Relative gap of eigenvalues that can contain a shift."""


class Status(IntEnum):
    """Solution status of a design."""

    ITERATED = 0
    """Solved by iteration, with a proof that the result is correct."""
    WHOLE = 1
    """Solved by dense matrices."""
    NONE = 2
    """No result: fewer platform frequencies than requested, or an invalid design. To get the reason, solve this design alone."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Data computed once for a family of designs.

    - `tables`: topology for the kernel.
    - `starts`: start values of the iteration, first for the required modes, then for additional modes, which are needed if modes cross. If
      `starts` is empty, all designs are solved by dense matrices.
    - `surface`: the polynomial fit of the kernel's input over specified ranges.
    """

    family: Family
    choice: Choice
    tables: Mapping[str, Array]
    starts: tuple[Start, ...] = ()
    surface: Surface | None = None


@dataclass(frozen=True, eq=False)
class PlatformModes:
    """Ascending `frequencies` (b, k) [Hz] of the platform modes of b designs, NaN if absent, and `status` (b,)."""

    frequencies: Array
    status: Array


Ranges = tuple[Array, Array]
"""Minimum and maximum values (P,) of the P numbers that vary."""


@one_thread
def plan(mechanism: Mechanism, addresses: tuple[str, ...], choice: Choice | None = None, ranges: Ranges | None = None) -> Plan:
    """Plan a family of designs that differ in the numbers at the `addresses`.

    If `ranges` are specified, the kernel's input is fitted once by polynomials, which takes seconds. The fit is used if its error is at
    most 1e-10. Within the ranges, computing the input of a design is then faster than solving the design. Without a fit, or outside the
    ranges, the input is computed from the description.

    Raises `DesignError` for unknown addresses, and for a mechanism whose nominal stiffness is singular.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> result = plan(double_triangle(), ("parts.neck.thickness",))
    >>> len(result.family.topology.bodies), [start.needed for start in result.starts]
    (19, [6, 12])
    """
    return plan_family(family(mechanism, addresses), choice, ranges)


def plan_family(family_: Family, choice: Choice | None = None, ranges: Ranges | None = None) -> Plan:
    """Plan a family of designs of any description; see `plan`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(plan_family(family(double_triangle(), ("parts.neck.thickness",))).starts)
    2
    """
    choice = choice or Choice()
    if family_.mechanism.elastic_bodies:
        raise refuse("elastic_bodies", "not supported for several designs", "Remove elastic_bodies, or compute the designs one by one")
    model = lumped(family_.mechanism)  # raises `DesignError` for free motions of bodies
    if family_.topology.locked:
        return Plan(family_, choice, {})
    (modes,) = modes_of_designs(model, 1, choice.cluster)
    graph = eliminate_bodies(family_.topology)
    forces = (model.inertia_matrix @ modes.shapes).reshape(len(graph.order), 6, -1)[list(graph.order)]
    starts = tuple(_starts(modes, forces.reshape(modes.shapes.shape), choice))
    fitted = surface(family_, *ranges) if ranges is not None and starts else None
    return Plan(family_, choice, kernel_tables(family_.topology, graph), starts, fitted)


def _starts(modes: AllModes, forces: Array, choice: Choice) -> list[Start]:
    """Starts with the modes that are needed, and with as many as there is room for; none if that is not fewer than all."""
    picked, values = choose(modes.values[None], modes.parts[None], choice), modes.values
    if not picked.exact[0] or choice.count > MODES:
        return []
    needed = int(np.flatnonzero(picked.mask[0])[-1]) + 1
    counts = np.arange(needed + 2, min(_MOST + 1, len(values) // 2))
    if not len(counts):
        return []
    most = int(counts[-3:][np.argmax(values[counts[-3:]] / values[counts[-3:] - 1])])
    inner, shift = np.arange(needed, most - 1), _shift(values[:needed])
    wider = int(inner[np.argmax(values[inner] / values[inner - 1])])
    return [Start(forces[:, :needed], shift, needed), Start(forces[:, :most], shift, wider)]


def _shift(values: Array) -> float:
    """A shift between the requested eigenvalues, far from each."""
    edges = np.concatenate([[0.0], values])
    between, wide = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges) > _WIDE * edges[1:]
    return float(between[wide][np.argmin(np.abs(between[wide] - 0.5 * (values[0] + values[-1])))])


@one_thread
def platform_modes(plan_: Plan, values: Array) -> PlatformModes:
    """Compute the platform frequencies of designs given by the numbers (b, P) at the plan's addresses.

    The frequencies agree with the dense solution of `models.lumped` within a relative error of 1e-6. This accuracy is proven for each
    design.

    An invalid design has the status `NONE` and does not affect the other designs. A design is invalid if it has non-finite numbers, a
    stiffness that is not positive, or outlines without a mass.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> result = platform_modes(plan(double_triangle(), ("parts.neck.thickness",)), np.array([[1.54e-3], [1.60e-3], [np.nan]]))
    >>> result.frequencies[:2, 5].round(2).tolist(), Status(result.status[2]).name
    ([173.09, 174.3], 'NONE')
    """
    values = np.asarray(values, dtype=float)
    squares, status = np.full((len(values), plan_.choice.count), np.nan), np.full(len(values), int(Status.NONE))
    sound = np.flatnonzero(np.isfinite(values).all(axis=1))
    with np.errstate(all="ignore"):  # nonsensical designs have no frequencies
        for start in range(0, len(sound), _CHUNK):
            _solve(plan_, values, sound[start : start + _CHUNK], squares, status)
    return PlatformModes(np.sqrt(squares) / (2.0 * np.pi), status)


def _solve(plan_: Plan, values: Array, designs: Array, squares: Array, status: Array) -> None:
    """Write eigenvalues and status of some designs; bisect designs that cannot be described together, down to the invalid one."""
    try:
        left = _iterate(plan_, values, designs, squares, status)
        size = 1 if plan_.family.topology.locked else _PORTION
        for start in range(0, len(left), size):
            portion = left[start : start + size]
            model = lumped(describe(plan_.family, values[portion]))
            for design, modes in zip(portion, modes_of_designs(model, len(portion), plan_.choice.cluster), strict=True):
                result = platform_values(modes, plan_.choice)
                if len(result) == plan_.choice.count:
                    squares[design], status[design] = result, Status.WHOLE
    except DesignError:
        for half in np.array_split(designs, 2) if len(designs) > 1 else ():
            _solve(plan_, values, half, squares, status)


def _iterate(plan_: Plan, values: Array, designs: Array, squares: Array, status: Array) -> Array:
    """Write the proven results of some designs, and return the other designs."""
    library = kernel()
    if library is None or not plan_.starts:
        return designs
    numbers = _numbers(plan_, values[designs])
    left = np.flatnonzero(np.isfinite(numbers).all(axis=0))
    for start in plan_.starts:
        if not len(left):
            break
        result, good = solve_designs(library, plan_.tables, numbers[:, left], start, plan_.choice)
        squares[designs[left[good]]], status[designs[left[good]]] = result[good], Status.ITERATED
        left = left[~good]
    return designs[left]


def _numbers(plan_: Plan, values: Array) -> Array:
    """The numbers of designs, by the fit within its ranges."""
    if plan_.surface is None:
        return numbers_of(plan_.family, values)
    result, outside = plan_.surface.numbers(values), np.flatnonzero(~plan_.surface.holds(values))
    if len(outside):
        result[:, outside] = numbers_of(plan_.family, values[outside])
    return result
