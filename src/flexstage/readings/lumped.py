"""Lumped reading: rigid bodies of six freedoms each, joined by 6x6 links.

K = sum H^T k H with H the relative twist at each link; M from bodies and parts; strokes are imposed deformations of the stacks.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import TypeVar

import numpy as np

from flexstage.base.digest import digest
from flexstage.base.finding import refuse
from flexstage.base.number import Array, Number, first_design
from flexstage.beams.compliance import law
from flexstage.beams.mass import mass
from flexstage.mechanism.expand import Assembly, PlacedLink, expand
from flexstage.mechanism.incidence import Layout, end_twists, layout, twist_at, with_ground
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.mechanism.moving_mass import moving_inertia
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted
from flexstage.readings.linear.channels import (
    Motions,
    absolute,
    gauge_rows,
    imposed_strokes,
    input_channels,
    loaded_places,
    output_channels,
    place_twists,
    seen_places,
)
from flexstage.readings.linear.elimination import eliminate, pivoted
from flexstage.readings.linear.model import Contribution, LinearModel, assembled, gathered
from flexstage.spatial.frame import seen_at

_SINGULAR = 1e-11
_ROUNDING = 1e-12
_STRETCHED: Array = np.eye(6)[0]

_Value = TypeVar("_Value")


class Masses(Enum):
    """Which masses count: all bodies and links, or the platform with its payloads only (the paper's model)."""

    ALL = "all"
    PLATFORM = "platform"


@dataclass(frozen=True, eq=False)
class _Stage:
    """The stage as operators: twists of every link's `ends`, `strains`, rows of `locked` freedoms, `rigid` motion with the ground."""

    assembly: Assembly
    order: Layout
    ends: Mapping[str, tuple[Array, Array]]
    strains: Mapping[str, Contribution]
    locked: tuple[Array, ...]
    rigid: Array

    @property
    def motions(self) -> Motions:
        bodies = {name: self.order.selector(name) for name in self.assembly.bodies}
        return Motions(bodies, lambda body, frame: twist_at(self.assembly, self.order, body, frame))


def lumped(mechanism: Mechanism, masses: Masses = Masses.ALL) -> LinearModel:
    """Read a stage as rigid bodies on 6x6 links.

    Valid for small displacements about the drawn position and frequencies below the first resonance of the parts themselves. Locked
    freedoms of `Restricted` and `Joint` parts are eliminated exactly; freedoms without stiffness that nothing feels are pinned and
    listed in `idle`. Raises `DesignError` for a mechanism (K singular), naming the bodies that can move freely.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(lumped(double_triangle()).coordinates)
    114
    """
    stage = _stage(mechanism)
    size = stage.order.size
    basis, coordinates, idle = _reduced(stage, size)
    inertia = _inertia(mechanism, stage, masses)
    force, imposed = _inputs(stage)
    output, feedthrough = _outputs(stage, imposed)
    return LinearModel(
        coordinates=coordinates,
        stiffness={name: _through(item, basis) for name, item in stage.strains.items()},
        inertia={name: _through(item, basis) for name, item in inertia.items()},
        inputs=input_channels(stage.assembly),
        force=_project(force, basis),
        imposed=imposed,
        outputs=output_channels(stage.assembly),
        output=output if basis is None else output @ basis,
        feedthrough=feedthrough,
        rigid=_rigid_coordinates(stage, coordinates),
        rigid_output=_rigid_output(stage, output),
        base_inertia=_project(_carried(stage, inertia), basis),
        damping=mechanism.damping,
        idle=idle,
        provenance=f"lumped reading of {digest(mechanism, physics=True)[:16]}",
    )


def _stage(mechanism: Mechanism) -> _Stage:
    assembly = expand(mechanism)
    order = layout(assembly)
    laws = _by_part(law, assembly)
    ends = {name: end_twists(assembly, order, link) for name, link in assembly.links.items()}
    strains: dict[str, Contribution] = {}
    locked: list[Array] = []
    for name, link in assembly.links.items():
        operator = ends[name][1] - ends[name][0]
        strains[name] = Contribution(operator, laws[name].stiffness, _loss_factor(link))
        if laws[name].locked:
            locked.append(operator[..., [freedom.index for freedom in laws[name].locked], :])
    return _Stage(assembly, order, ends, strains, tuple(locked), with_ground(assembly, order))


def _by_part(function: Callable[[Part, Material | None], _Value], assembly: Assembly) -> dict[str, _Value]:
    """A value for every link, computed once for all links of one part and material."""
    keys = {name: (id(link.part), id(link.material)) for name, link in assembly.links.items()}
    distinct = {keys[name]: link for name, link in assembly.links.items()}
    values = {key: function(link.part, link.material) for key, link in distinct.items()}
    return {name: values[key] for name, key in keys.items()}


def _loss_factor(link: PlacedLink) -> Number:
    inner = link.part.part if isinstance(link.part, Restricted) else link.part
    holder = link.material if link.material is not None else inner
    value = getattr(holder, "loss_factor", None)
    return 0.0 if value is None else value


def _reduced(stage: _Stage, size: int) -> tuple[Array | None, tuple[str, ...], tuple[str, ...]]:
    """Basis that satisfies the locked freedoms and pins idle ones; `None` when there is nothing to eliminate."""
    names = stage.order.coordinates
    scale = np.array([10.0 if name.rpartition(".")[2].startswith("r") else 1.0 for name in names])
    basis: Array | None = None
    independent = tuple(range(size))
    if stage.locked:
        rows = np.concatenate(np.broadcast_arrays(*stage.locked) if _same(stage.locked) else _spread(stage.locked), axis=-2)
        solution = eliminate(rows, scale, keep=tuple(range(6)))
        basis, independent = solution.basis, solution.independent
    loose = _loose(stage, basis)
    if loose.shape[1] == 0:
        return basis, tuple(names[index] for index in independent), ()
    pinned = _pinned(stage, loose, independent)
    left = [index for index in range(len(independent)) if index not in pinned]
    full = np.eye(size) if basis is None else basis
    return full[..., left], tuple(names[independent[index]] for index in left), tuple(names[independent[index]] for index in pinned)


def _same(arrays: tuple[Array, ...]) -> bool:
    return len({array.shape for array in arrays}) == 1


def _spread(arrays: tuple[Array, ...]) -> list[Array]:
    batch = np.broadcast_shapes(*(array.shape[:-2] for array in arrays))
    return [np.broadcast_to(array, (*batch, *array.shape[-2:])) for array in arrays] if batch else list(arrays)


def _loose(stage: _Stage, basis: Array | None) -> Array:
    """Null space (n, k) of the first design's stiffness in the independent coordinates."""
    first = None if basis is None else np.real(first_design(basis, 2))
    strains = {
        name: Contribution(_without_rounding(np.real(first_design(item.operator, 2)), first), np.real(first_design(item.law, 2)))
        for name, item in stage.strains.items()
    }
    stiffness = assembled(strains, stage.order.size if first is None else first.shape[1])
    diagonal = np.sqrt(np.where(np.diag(stiffness) > 0.0, np.diag(stiffness), 1.0))
    scaled = stiffness / diagonal / diagonal[:, None]
    try:
        pivots = np.diag(np.linalg.cholesky(scaled))
        if np.min(pivots) ** 2 > _SINGULAR:
            return np.zeros((len(diagonal), 0))
    except np.linalg.LinAlgError:
        pass
    values, vectors = np.linalg.eigh(scaled)
    return vectors[:, values < _SINGULAR] / diagonal[:, None]


def _without_rounding(operator: Array, basis: Array | None) -> Array:
    """The operator in the basis without entries that are only rounding: else an idle coordinate would seem to have some stiffness."""
    if basis is None:
        return operator
    product = operator @ basis
    largest = np.max(np.abs(operator), axis=1, keepdims=True) * np.max(np.abs(basis), axis=0)
    return np.where(np.abs(product) > _ROUNDING * largest, product, 0.0)


def _pinned(stage: _Stage, loose: Array, independent: tuple[int, ...]) -> list[int]:
    """Coordinates that pin the loose motions; a loose motion that moves the platform makes the stage a mechanism."""
    platform = [position for position, index in enumerate(independent) if index < 6]
    moved = np.max(np.abs(loose), axis=0, initial=0.0)
    if np.any(np.abs(loose[platform]) > 1e-6 * moved):
        raise refuse(
            "stage",
            f"the stiffness matrix is singular: {loose.shape[1]} motion(s) without any stiffness move the platform, and with it "
            f"{', '.join(_moving(stage, loose, independent))}",
            "Add a link that holds this motion, or check which freedoms the links leave free",
        )
    order = pivoted((loose / moved).T)[2]
    return sorted(int(index) for index in order[: loose.shape[1]])


def _moving(stage: _Stage, loose: Array, independent: tuple[int, ...]) -> list[str]:
    size = np.max(np.abs(loose), axis=1)
    names = [stage.order.coordinates[independent[index]].rpartition(".")[0] for index in np.flatnonzero(size > 0.1 * size.max())]
    return list(dict.fromkeys(names))[:6]


def _through(item: Contribution, basis: Array | None) -> Contribution:
    return item if basis is None else Contribution(item.operator @ basis, item.law, item.loss_factor)


def _project(force: Array, basis: Array | None) -> Array:
    return force if basis is None else _transposed(basis) @ force


def _inertia(mechanism: Mechanism, stage: _Stage, masses: Masses) -> dict[str, Contribution]:
    result: dict[str, Contribution] = {}
    for name, placed in stage.assembly.bodies.items():
        if masses is Masses.PLATFORM and name != PLATFORM:
            continue
        matrix = moving_inertia(mechanism, placed)
        if matrix is not None:
            result[name] = Contribution(stage.order.selector(name), matrix)
    if masses is Masses.ALL:
        for name, matrix in _by_part(mass, stage.assembly).items():
            result[_of_link(name)] = Contribution(np.concatenate(_spread(stage.ends[name]), axis=-2), matrix)
    return result


def _of_link(name: str) -> str:
    return f"{name} (link)"


def _carried(stage: _Stage, inertia: Mapping[str, Contribution]) -> Array:
    """Inertial forces (..., n, 6) on the coordinates when everything, the ground included, is accelerated rigidly."""
    centre = stage.assembly.bodies[PLATFORM].reference
    seen = {name: stage.rigid[..., stage.order.columns(name), :] for name in stage.order.bodies}
    for name, link in stage.assembly.links.items():
        carry = seen_at(link.frame, centre)
        seen[_of_link(name)] = np.concatenate([carry, carry], axis=-2)
    return gathered(inertia, seen) if inertia else np.zeros((stage.order.size, 6))


def _inputs(stage: _Stage) -> tuple[Array, dict[str, Array]]:
    drives = stage.assembly.actuators
    wrenches = [_transposed(rows) for rows in place_twists(loaded_places(stage.assembly), stage.motions)]
    columns = _spread((np.zeros((stage.order.size, len(drives))), *wrenches))
    return np.concatenate(columns, axis=-1), imposed_strokes(stage.assembly, dict.fromkeys(drives.values(), _STRETCHED))


def _outputs(stage: _Stage, imposed: Mapping[str, Array]) -> tuple[Array, Array]:
    rows = [*place_twists(seen_places(stage.assembly), stage.motions), *gauge_rows(stage.assembly, stage.motions)]
    inputs = len(input_channels(stage.assembly))
    passed = [np.zeros((row.shape[-2], inputs)) for row in rows]
    for name, item in stage.strains.items():
        rows.append(item.law @ item.operator)
        passed.append(-item.law @ imposed[name] if name in imposed else np.zeros((6, inputs)))
    return np.concatenate(_spread(tuple(rows)), axis=-2), np.concatenate(_spread(tuple(passed)), axis=-2)


def _rigid_coordinates(stage: _Stage, coordinates: tuple[str, ...]) -> Array:
    places = {name: number for number, name in enumerate(stage.order.coordinates)}
    return stage.rigid[..., [places[name] for name in coordinates], :]


def _rigid_output(stage: _Stage, output: Array) -> Array:
    return np.where(absolute(stage.assembly)[:, None], output @ stage.rigid, 0.0)


def _transposed(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)
