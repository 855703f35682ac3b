"""Linear model: the result of every elastic model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, TypeAlias, cast

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, Number
from flexstage.base.sparse import Rows, Sparse, as_csr
from flexstage.mechanism.mechanism import Damping
from flexstage.models.linear.large import Quadratic, Solver

_DENSE = 3000
"""Number of coordinates up to which a sparse model makes dense matrices: all its modes take a minute."""
WIDE = 128
"""Number of coordinates above which each part is assembled only over its own coordinates. Below this number, a full product is faster."""


@dataclass(frozen=True, eq=False)
class Contribution:
    """Contribution of one part to a matrix: `operator`^T `law` `operator`, with `operator` (..., r, n) and `law` (..., r, r)."""

    operator: Array
    law: Array
    loss_factor: Number = 0.0


@dataclass(frozen=True)
class Channel:
    """A named input or output with its unit."""

    name: str
    unit: str


Contributions: TypeAlias = Mapping[str, Contribution]


@dataclass(frozen=True, eq=False)
class LinearModel(InNotebook, CheckedFields):
    """Linear model: M q'' + D q' + K q = B u - M_u u'', y = C q + D_u u, with K and M as sums of named contributions G^T k G.

    - `force` (..., n, m): direct generalised forces of the inputs.
    - `imposed` (..., r, m): for each stiffness contribution, the deformation that inputs impose (the free stroke of a stack): B = force +
      sum G^T k imposed.
    - `output` C (..., p, n) and `feedthrough` D_u (..., p, m).
    - `rigid` (..., n, 6): motion of all coordinates when the stage moves rigidly with the ground, per unit ground twist at the platform's
      reference point; `rigid_output` (..., p, 6): outputs due to this rigid motion.
    - `base_inertia` (..., n, 6): inertial force per unit ground acceleration.
    - `inertial` M_u (..., n, m): inertial forces due to the motions that inputs impose (default: zero).
    - `unknown`: outputs that the model does not determine, i.e. forces of locked DOFs.

    Batch axes come first. An array without batch axes is valid for every design. `viscous` contains damping matrices (..., d, d) [N s/m] of
    parts, by the name of the stiffness contribution. Damping matrices multiply the rates of the first d elastic deformations (G q minus the
    imposed deformation). These dampers act in addition to the model's damping law. Link forces do not include forces of dampers.

    `idle` contains the names of removed coordinates, which have no stiffness (free internal modes). The kept coordinates are M-orthogonal
    to the removed modes, so that frequencies and shapes do not depend on the choice of coordinates. `idle_output` (..., p, k) are the
    outputs of the k free internal modes, `idle_inertia` (..., k, 6) their inertial forces per unit ground acceleration.

    `floating` (n, k) are mass-normalised motions of the platform that have no stiffness and are driven by forces (default: none). If
    floating motions exist, K is singular, and `solve` returns the elastic displacement that has no momentum in the floating motions
    (inertia relief).

    For a large stage, `is_sparse` is true: operators and outputs are sparse (see `flexstage.base.sparse`). `solve` and `momenta` use no
    dense matrix; K and M are assembled only on request.
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("a model", "fs.lumped(stage)")
    coordinates: tuple[str, ...]
    stiffness: Contributions
    inertia: Contributions
    inputs: tuple[Channel, ...]
    force: Array
    imposed: Mapping[str, Array]
    outputs: tuple[Channel, ...]
    output: Array
    feedthrough: Array
    rigid: Array
    rigid_output: Array
    base_inertia: Array
    damping: Damping | None
    idle: tuple[str, ...]
    provenance: str
    inertial: Array | None = None
    idle_output: Array | None = None
    idle_inertia: Array | None = None
    unknown: tuple[str, ...] = ()
    viscous: Mapping[str, Array] = field(default_factory=dict)
    floating: Array | None = None

    @cached_property
    def stiffness_matrix(self) -> Array:
        """K (..., n, n), read-only. Raises `DesignError` for a large sparse model."""
        self._require_dense()
        return _freeze(assemble(self.stiffness, len(self.coordinates)))

    @cached_property
    def inertia_matrix(self) -> Array:
        """M (..., n, n), read-only. Raises `DesignError` for a large sparse model."""
        self._require_dense()
        return _freeze(assemble(self.inertia, len(self.coordinates)))

    def grounded(self, square: Number = 1.0) -> Array:
        """Return K plus springs that give each floating motion the eigenvalue `square` [1/s^2]; other modes are unchanged."""
        if self.floating is None:
            return self.stiffness_matrix
        momentum = self.inertia_matrix @ self.floating
        return self.stiffness_matrix + square * (momentum @ momentum.T)

    def _require_dense(self) -> None:
        size = len(self.coordinates)
        if self.is_sparse and size > _DENSE:
            what = f"too many coordinates for dense matrices (got {size:,}, maximum {_DENSE:,})"
            raise refuse("stage", what, "Compute stiffness, modes, deflection or drift, or analyse parts of the stage")

    @property
    def is_sparse(self) -> bool:
        """Whether operators and outputs are sparse, which is possible only for a single design."""
        return isinstance(self.output, Rows)

    @cached_property
    def solver(self) -> Solver:
        """Solver of K q = f of a sparse model."""
        return Solver(self._quadratic(self.stiffness))

    @cached_property
    def masses(self) -> Quadratic:
        """Mass matrix M of a sparse model."""
        return self._quadratic(self.inertia)

    def _quadratic(self, contributions: Contributions) -> Quadratic:
        operators = (cast("Sparse", item.operator) for item in contributions.values())
        return Quadratic.of(operators, (item.law for item in contributions.values()), len(self.coordinates))

    def solve(self, load: Array) -> Array:
        """Return the displacements K^-1 f (..., n, k) for the forces f = `load` (..., n, k)."""
        if self.is_sparse:
            return self.solver.solve(load)
        if self.floating is None:
            return np.linalg.solve(self.stiffness_matrix, load)
        balanced = load - self.inertia_matrix @ (self.floating @ (self.floating.T @ load))
        return np.linalg.solve(self.grounded(self.scale), balanced)

    @property
    def scale(self) -> float:
        """Typical eigenvalue of the model [1/s^2]: the median of stiffness/inertia over the coordinates."""
        stiff, heavy = (np.real(np.diag(each)) for each in (self.stiffness_matrix, self.inertia_matrix))
        used = (stiff > 0.0) & (heavy > 0.0)
        return float(np.median(stiff[used] / heavy[used])) if used.any() else 1.0

    def follow(self, strains: Mapping[str, Array]) -> Array:
        """Compute the motion (..., n, k) of least strain energy when `strains` (..., r, k) are imposed: -K^-1 sum G^T k strain."""
        if self.is_sparse:
            return self.solver.follow(np.concatenate([strains[name] for name in self.stiffness]))
        forces = (part.operator.mT @ (part.law @ strains[name]) for name, part in self.stiffness.items())
        return self.solve(-sum(forces, np.zeros((len(self.coordinates), 1))))

    def momenta(self, motion: Array) -> Array:
        """Multiply M by a motion (..., n, k)."""
        return self.masses @ motion if self.is_sparse else self.inertia_matrix @ motion

    def seen(self, rows: list[int], motion: Array) -> Array:
        """Compute the outputs (..., p, k) with the indices `rows` for a motion (..., n, k)."""
        return (self.output @ motion)[rows] if self.is_sparse else self.output[..., rows, :] @ motion

    @property
    def designs(self) -> tuple[int, ...]:
        """Shape of the batch axes of K."""
        return () if self.is_sparse else self.stiffness_matrix.shape[:-2]

    @property
    def input_matrix(self) -> Array:
        """Input matrix B (..., n, m): direct forces, and the forces of imposed deformations."""
        return self.force + self._of_imposed(lost=False)

    @property
    def loss_matrix(self) -> Array:
        """Imaginary part of B (..., n, m) under structural damping: it is due to the loss factors of parts with imposed strokes."""
        return self._of_imposed(lost=True)

    def _of_imposed(self, *, lost: bool) -> Array:
        total = np.zeros_like(self.force)
        for name, deformation in self.imposed.items():
            part = self.stiffness[name]
            factor = np.asarray(part.loss_factor)[..., None, None] if lost else 1.0
            total = total + factor * (part.operator.mT @ (part.law @ deformation))
        return total

    def output_index(self, names: tuple[str, ...]) -> list[int]:
        """Return the indices of outputs by name; raises `DesignError` for unknown names."""
        return _places(names, self._output_places, "output")

    @cached_property
    def _output_places(self) -> Mapping[str, int]:
        return {channel.name: index for index, channel in enumerate(self.outputs)}

    def input_index(self, names: tuple[str, ...]) -> list[int]:
        """Return the indices of inputs by name; raises `DesignError` for unknown names."""
        return _places(names, {channel.name: index for index, channel in enumerate(self.inputs)}, "input")

    @property
    def strokes(self) -> tuple[str, ...]:
        """Names of the stroke inputs."""
        return tuple(channel.name for channel in self.inputs if channel.unit == "m")

    @property
    def actuators(self) -> tuple[str, ...]:
        """Names of the actuator inputs (strokes and forces). All other inputs are components of wrenches."""
        return tuple(channel.name for channel in self.inputs if "." not in channel.name)


def _places(names: tuple[str, ...], by_name: Mapping[str, int], kind: str) -> list[int]:
    require(dict.fromkeys(_unknown(name, by_name, kind) for name in names if name not in by_name))
    return [by_name[name] for name in names]


def _unknown(name: str, names: Iterable[str], kind: str) -> Finding:
    """The error for a name without a channel or, if all of its components are unknown, for its point."""
    owner, owners = name.rpartition(".")[0], {each.rpartition(".")[0] for each in names} - {""}
    if not owner or owner in owners:
        return Finding(name, f"unknown {kind}", suggest_nearest(name, names))
    return Finding(owner, "unknown point", suggest_nearest(owner, owners))


def assemble(contributions: Contributions, size: int) -> Array:
    """Assemble contributions to one matrix (..., n, n), symmetric by construction.

    >>> half = Contribution(np.array([[1.0, -1.0]]), np.array([[0.5]]))
    >>> assemble({"a": half, "b": half}, 2).tolist()
    [[1.0, -1.0], [-1.0, 1.0]]
    """
    if not contributions:
        return np.zeros((size, size))
    sparse = any(isinstance(item.operator, Sparse) for item in contributions.values())
    if size > WIDE and not sparse:
        total = _sum_by_columns(contributions, size)
    else:
        total = strain_forces(contributions, {name: item.operator for name, item in contributions.items()})
        total = total if isinstance(total, np.ndarray) else total.toarray()
    return 0.5 * (total + total.mT)


def _sum_by_columns(contributions: Contributions, size: int) -> Array:
    """The sum (..., n, n), each part over the coordinates that strain it."""
    arrays = [each for item in contributions.values() for each in (item.operator, item.law)]
    batch = np.broadcast_shapes(*(each.shape[:-2] for each in arrays))
    total = np.zeros((*batch, size, size), dtype=np.result_type(*arrays))
    for item in contributions.values():
        columns = np.flatnonzero(np.any(item.operator, axis=tuple(range(item.operator.ndim - 1))))
        own = item.operator[..., columns]
        whole = own.ndim == 2 and np.array_equal(own, np.eye(*own.shape))
        total[..., columns[:, None], columns] += item.law if whole else own.mT @ (item.law @ own)
    return total


def strain_forces(contributions: Contributions, strains: Mapping[str, Array]) -> Array:
    """Compute the generalised forces (..., n, k) of the `strains` (..., r, k) of all contributions: the sum of operator^T law strain.

    >>> half = Contribution(np.array([[1.0, -1.0]]), np.array([[0.5]]))
    >>> strain_forces({"a": half, "b": half}, {"a": np.array([[2.0]]), "b": np.array([[4.0]])}).tolist()
    [[3.0], [-3.0]]
    """
    operators = [item.operator for item in contributions.values()]
    forces = [item.law @ strains[name] for name, item in contributions.items()]
    if isinstance(operators[0], Sparse):
        rows = as_csr(cast("list[Sparse]", operators), operators[0].shape[-1]).T
        return rows @ (as_csr(cast("list[Sparse]", forces), rows.shape[0]) if isinstance(forces[0], Sparse) else np.concatenate(forces))
    return _stack(operators).mT @ _stack(forces)


def _freeze(matrix: Array) -> Array:
    """Make a matrix read-only."""
    matrix.flags.writeable = False
    return matrix


def _stack(matrices: list[Array]) -> Array:
    batch = np.broadcast_shapes(*{matrix.shape[:-2] for matrix in matrices})
    return np.concatenate([np.broadcast_to(matrix, (*batch, *matrix.shape[-2:])) if batch else matrix for matrix in matrices], axis=-2)


def label(model: LinearModel, values: Array, rows: tuple[str, ...], columns: tuple[str, ...]) -> Matrix:
    """Return a labelled matrix of `values` from inputs (columns) to outputs (rows), with units from the model's channels.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> label(mapped(double_triangle()), np.eye(1), ("platform.rx",), ("B4",)).unit
    (('rad/m',),)
    """
    row_units = tuple(model.outputs[index].unit for index in model.output_index(rows))
    column_units = tuple(model.inputs[index].unit for index in model.input_index(columns))
    return Matrix(values, rows, columns, ratio_units(row_units, column_units))
