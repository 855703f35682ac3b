"""Misalignment of over-constrained stages: internal loads, and the critical misalignment at which the stage buckles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.analysis.loaded.strained import strain_warnings
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, LowerBoundError, refuse, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array
from flexstage.base.record import INNER
from flexstage.mechanism.assembly.expand import Assembly, copies, expand
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.models.linear.eigen import eigenvalues
from flexstage.models.nonlinear.elements.seat import SEAT, seat
from flexstage.models.nonlinear.elements.strain import Strains, strains
from flexstage.models.nonlinear.equilibrium import State, equilibrium, require_equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.paths.critical_load import NoCriticalLoadError, critical_load, unstable_motions
from flexstage.models.nonlinear.paths.load_path import continue_along
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.models.nonlinear.state import SolverOptions
from flexstage.spatial.frame import COMPONENTS, FORCES, MOTION, TWIST_UNITS, WRENCH, WRENCH_UNITS

_MOST = 0.1
"""Largest misalignment that is computed [rad, or relative to the flexures' length]."""
_FREQUENCIES = 3
_HELD = tuple(f"{SEAT}.{name}" for name in COMPONENTS)


class Misaligned(Result):
    """Result for an instance `copy`, misaligned on the ground along (x, y, z) or about (rx, ry, rz) an axis of the instance's frame.

    The table `along` has a row for each misalignment. Its columns are the misalignment, the load that forces the instance into this
    position, the first frequencies, the largest stress and strain of a flexure, and the number of unstable modes (0: stable). `state`
    contains the equilibria. `loads` are the wrenches on the ends of the flexures at the largest misalignment, each in the frame at the
    flexure's start.

    `critical` is the misalignment at which the first stiffness vanishes [rad, m]; NaN if no stiffness vanishes. `followed` is the largest
    misalignment up to which the stage is known to be stable: `critical`, or the end of the computed path. This path ends at the latest at
    0.1 rad for a rotation, and at 0.1 times the length of the longest flexure for a translation. Stable states beyond `critical` belong to
    another branch and have no values.
    """

    copy: str
    axis: str
    along: Matrix
    loads: Matrix
    critical: float
    followed: float
    strained: Annotated[Strains, INNER]
    state: Annotated[State, INNER]
    provenance: str

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings of strains beyond the limits of the theory."""
        return tuple(strain_warnings(self.strained))


class Misalignments(Result):
    """Critical misalignment of each instance, by axis of the instance's frame; null if no stiffness vanishes.

    `followed` is the misalignment up to which the stage is known to be stable, as in `Misaligned`. `load` is the load that misaligns the
    instance by `size` [rad, m]; `stress` is the largest stress in a flexure [Pa]. `load` and `stress` are null if no equilibrium was found.
    `worst` is the result with the least `followed` or, if all values of `followed` are equal, with the largest stress. `worst` is None if
    no instance is connected to the ground.
    """

    critical: Matrix
    followed: Matrix
    size: float
    load: Matrix
    stress: Matrix
    worst: Misaligned | None

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings of strains beyond the limits of the theory in the worst case."""
        return () if self.worst is None else self.worst.warnings


@check_arguments
def misalign(mechanism: Mechanism, copy: str, axis: str, size: float, *, points: int = 11) -> Misaligned:
    """Compute the internal loads of a stage with one misaligned instance or link on the ground, with large displacements.

    The ends of the instance's links on the ground are fixed to a rigid seat. The seat moves along or about an axis of the instance's frame,
    in equal steps from zero to `size` [m, rad]; `points` is the number of positions. The centre of rotation is the origin of the instance's
    frame or, for a single link, the middle of the link. The weight is included. Only the motion of the seat is prescribed; all other
    motions are free. Raises `DesignError` for unknown names and for instances that are not connected to the ground.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> result = misalign(parallelogram(), "left", "ry", 1e-3, points=3)
    >>> result.along.columns[:2]
    ('ry', 'load')
    """
    forced = _forced(mechanism, copy, axis)
    state = forced.at(size * np.linspace(0.0, 1.0, points))
    critical, followed = forced.limits(float(np.sign(size)) or 1.0)
    strained = strains(state)
    along = _along(forced, state, strained, size * np.linspace(0.0, 1.0, points))
    names = tuple(name for group in forced.model.flexures for name in group.names)
    loads = np.array([state.wrench(name)[-1] for name in names]).reshape(-1, 6)
    return Misaligned(
        copy=copy,
        axis=axis,
        along=along,
        loads=Matrix(loads, names, FORCES, (WRENCH_UNITS,) * len(names)),
        critical=critical,
        followed=followed,
        strained=strained,
        state=state,
        provenance=f"{copy} misaligned in the {forced.model.provenance}",
    )


def misalignments(mechanism: Mechanism, axes: tuple[str, ...] = COMPONENTS[3:], *, size: float = 1e-3) -> Misalignments:
    """Compute the critical misalignment of every instance (or link) on the ground, one at a time, for `axes` of the instance's frame.

    All axes must be rotations, or all translations, because they have the same `size` [rad, m]. Raises `DesignError` as `misalign` does.
    """
    rows = seated(mechanism)
    forced = [_forced(mechanism, copy, axis) for copy in rows for axis in axes]
    values = np.array([(*each.limits(1.0), *_at_size(each, size)) for each in forced]).reshape(len(rows), len(axes), 4)
    motion, load = (tuple(map(of.unit, axes)) for of in (MOTION, WRENCH))
    units = (motion, motion, load, ("Pa",) * len(axes))
    tables = [Matrix(each, rows, axes, (unit,) * len(rows)) for each, unit in zip(np.moveaxis(values, -1, 0), units, strict=True)]
    critical, followed, _, stress = (table.values for table in tables)
    worst = None
    if followed.size:
        ranked = bool(np.isfinite(critical).any() or np.ptp(followed) > 0.0)
        ranks = followed if ranked else -np.nan_to_num(stress)
        row, column = np.unravel_index(int(np.argmin(ranks)), ranks.shape)
        worst = misalign(mechanism, rows[row], axes[column], float(followed[row, column]) if ranked else size)
    return Misalignments(tables[0], tables[1], size, tables[2], tables[3], worst)


def _at_size(forced: _Forced, size: float) -> tuple[float, float]:
    """Load that forces an instance to a misalignment, and the largest stress."""
    state = forced.at(np.array([size]))
    stress = np.max(strains(state).stress, axis=-1, initial=0.0)
    return float((state.reactions @ forced.direction)[0]), float(stress[0]) if bool(state.converged[0]) else np.nan


def seated(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the names of unit instances and single links that are connected to the ground.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> seated(parallelogram())
    ('B', 'left', 'right')
    """
    assembly = expand(mechanism)
    known = [name for name, _, _ in copies(mechanism)]
    results = [name for name in known if any(GROUND in assembly.links[link].joins for link in _links_of(assembly, name))]
    return (*results, *(name for name, link in assembly.links.items() if GROUND in link.joins and name.partition("/")[0] not in known))


@dataclass(frozen=True, eq=False)
class _Forced:
    """Stage on a fixed seat; `direction` (6,) is the seat's motion per unit of misalignment."""

    model: Nonlinear
    direction: Array
    axis: str

    def hold(self, size: Array | float) -> dict[str, Array]:
        """Values of the seat's coordinates for given misalignments."""
        return {name: size * part for name, part in zip(_HELD, self.direction, strict=True)}

    def at(self, sizes: Array) -> State:
        """Equilibria for misalignments (k,) that continue the aligned stage."""
        begin = equilibrium(self.model, hold=self.hold(np.array(0.0)))
        require_equilibrium(begin)
        result = equilibrium(self.model, hold=self.hold(sizes), options=SolverOptions(arcs=0))
        return continue_along(begin, result, sizes)

    def limits(self, sign: float) -> tuple[float, float]:
        """Critical misalignment in one direction (NaN: none), and the largest one known to be stable."""
        most = _MOST * (self.model.size if np.any(self.direction[:3]) else 1.0)
        gain, none = ({name: float(value) for name, value in self.hold(size).items()} for size in (sign, 0.0))
        try:
            result = sign * critical_load(self.model, gain, hold=none, most=most).factor
        except NoCriticalLoadError:
            return np.nan, sign * most
        except LowerBoundError as error:
            return np.nan, sign * error.bound
        return result, result


def _forced(mechanism: Mechanism, copy: str, axis: str) -> _Forced:
    if axis not in COMPONENTS:
        raise refuse(axis, "unknown axis", suggest_nearest(axis, COMPONENTS))
    assembly = expand(mechanism)
    frames = {name: frame for name, _, frame in copies(mechanism)}
    links = _links_of(assembly, copy) if copy in frames else [copy]
    if copy not in frames and copy not in assembly.links:
        raise refuse(copy, "unknown instance or link", suggest_nearest(copy, seated(mechanism)))
    frame = frames.get(copy) or assembly.links[copy].frame
    place = COMPONENTS.index(axis)
    along = np.asarray(frame.rotation)[:, place % 3]
    direction = np.concatenate([along, np.zeros(3)] if place < 3 else [np.zeros(3), along])
    return _Forced(seat(nonlinear(mechanism), links, np.asarray(frame.position)), direction, axis)


def _links_of(assembly: Assembly, copy: str) -> list[str]:
    return [name for name in assembly.links if name.partition("/")[0] == copy]


def _along(forced: _Forced, state: State, strained: Strains, sizes: Array) -> Matrix:
    columns = dict(_columns(forced, state, strained, sizes))
    units = tuple(unit for _, unit in columns.values())
    values = np.stack([each for each, _ in columns.values()], axis=-1)
    return Matrix(values, tuple(str(number + 1) for number in range(len(sizes))), tuple(columns), (units,) * len(sizes))


def _columns(forced: _Forced, state: State, strained: Strains, sizes: Array) -> Iterator[tuple[str, tuple[Array, str]]]:
    place = COMPONENTS.index(forced.axis)
    yield forced.axis, (sizes, TWIST_UNITS[place])
    yield "load", (state.reactions @ forced.direction, WRENCH_UNITS[place])
    frequencies = np.sqrt(eigenvalues(linearise(state, locked=_HELD))) / (2.0 * np.pi)
    yield from ((f"f{place + 1}", (frequencies[..., place], "Hz")) for place in range(min(_FREQUENCIES, frequencies.shape[-1])))
    yield "stress", (np.max(strained.stress, axis=-1, initial=0.0), "Pa")
    yield "strain", (np.max(strained.largest, axis=-1, initial=0.0), "1")
    motions = unstable_motions(state)
    yield "unstable", (np.where(motions < 0, np.nan, motions), "1")
