"""Statics of the platform: compliance and stiffness, directional stiffness, centre of stiffness."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, first_design
from flexstage.base.record import INNER, Heading, Layout
from flexstage.base.units.quantity import ANGLE, LENGTH, ROTATIONAL_STIFFNESS, SHARE, STIFFNESS
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import displacement
from flexstage.models.linear.undetermined import floats, require_unmoved
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS

_SINGULAR = 1e-11
_ALIKE = 1e-9
_LOCKED = "the model locks degrees of freedom of the platform, along which the stiffness is infinite"


@dataclass(frozen=True, eq=False)
class DirectionalStiffness:
    """Symmetric in-plane stiffness tensor (..., 2, 2) [N/m] with principal values and the angle of the stiffest direction [rad].

    The angle is from x towards y, in [0, pi); NaN for an isotropic tensor (to 1e-9).
    """

    TABLE: ClassVar[Layout] = Layout("Principal stiffnesses in the plane", "stiffest softest angle spread", head="other DOFs")

    tensor: Matrix
    principal: Annotated[Array, STIFFNESS]
    angle: Annotated[Array, ANGLE, Heading("stiffest along", digits=4)]

    @property
    def stiffest(self) -> Annotated[Array, INNER, STIFFNESS]:
        """Larger principal stiffness (...) [N/m]."""
        return self.principal[..., 0]

    @property
    def softest(self) -> Annotated[Array, INNER, STIFFNESS]:
        """Smaller principal stiffness (...) [N/m]."""
        return self.principal[..., 1]

    @property
    def spread(self) -> Annotated[Array, INNER, SHARE, Heading(digits=3)]:
        """Difference of the principal stiffnesses (...), divided by the larger one."""
        return 1.0 - self.softest / self.stiffest

    def along(self, angle: Number) -> Array:
        """Return the stiffness along directions n at `angle` [rad] from x: force divided by displacement along n, 1 / (n^T K^-1 n)."""
        direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        if not self.tensor.values.any(axis=-1).all():  # an axis without stiffness
            return np.zeros(direction.shape[:-1])
        compliance = np.linalg.inv(self.tensor.values)
        return 1.0 / np.einsum("...i,...ij,...j->...", direction, compliance, direction)


class Statics(Result):
    """Static behaviour of the platform at a point.

    `compliance` (..., 6, 6) maps a wrench at `load_point` to the twist at `read_point`; `stiffness` is the inverse of `compliance`. `held`
    is the in-plane stiffness tensor with all other degrees of freedom fixed. `free` is the in-plane stiffness tensor with all other degrees
    of freedom free, as in a push test. `centre` (..., 3) is the centre of stiffness relative to the load point [m].
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("a result of statics", "fs.statics(fs.lumped(stage))")
    load_point: str
    read_point: str
    compliance: Matrix
    stiffness: Matrix
    held: DirectionalStiffness
    free: DirectionalStiffness
    centre: Annotated[Array, LENGTH]
    provenance: str

    @property
    def reasons(self) -> Mapping[str, str]:
        """Reasons for a missing stiffness."""
        locked = (("stiffness", "held", "centre"), self.stiffness), (("free",), self.free.tensor)
        return {name: _LOCKED for names, matrix in locked if np.isnan(matrix.values).any() for name in names}


@check_arguments
def statics(model: LinearModel, *, load_point: str = "platform", read_point: str = "platform") -> Statics:
    """Compute the platform's compliance and stiffness for a load at the point `load_point` and a displacement at the point `read_point`.

    The point `platform` is the platform's reference point. Strokes are fixed, and displacements are small. The compliance is C_read K^-1
    C_load^T. K is the stiffness matrix of the model. C_read and C_load map the coordinates of the model to the twists of `read_point` and
    `load_point`. If the model locks degrees of freedom of the platform, as the mapped model of a guide does, the stiffness along these
    degrees of freedom is infinite. All entries of the stiffness matrix, and tensors derived from this matrix, are then NaN. In a batch, the
    first design determines which degrees of freedom are locked. Along an axis without stiffness, the compliance is infinite.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> (statics(mapped(double_triangle())).held.principal / 1e6).round(3).tolist()  # Eq. 2: 1.5 x 10.30 N/um
    [15.45, 15.45]
    """
    read = tuple(f"{read_point}.{name}" for name in COMPONENTS)
    load = tuple(f"{load_point}.{name}" for name in COMPONENTS)
    wrench = tuple(f"{load_point}.{name}" for name in FORCES)
    floating = floats(model, wrench)
    if model.floating is None or sum(floating) != model.floating.shape[-1] or load_point != read_point:
        require_unmoved(model, wrench)
    force = model.output[..., model.output_index(load), :].mT
    values = model.seen(model.output_index(read), displacement(model, force))
    if any(floating):
        values[floating, :], values[:, floating] = 0.0, 0.0
        values[floating, floating] = np.inf
    inverse = _inverse(values)
    return Statics(
        load_point,
        read_point,
        Matrix(values, read, wrench, ratio_units(TWIST_UNITS, WRENCH_UNITS)),
        Matrix(inverse, wrench, read, ratio_units(WRENCH_UNITS, TWIST_UNITS)),
        held=directional(inverse[..., :2, :2]),
        free=directional(_inverse(values[..., :2, :2])),
        centre=np.full(3, np.nan) if any(floating) else centre_of_stiffness(inverse),
        provenance=model.provenance,
    )


class FreedomStiffness(Result):
    """Stiffness [N/m, N m/rad] of each degree of freedom at a point, with strokes fixed and the other degrees of freedom free or fixed.

    `motions` are the coordinates of the platform's ideal motions, `constraints` the coordinates that links constrain. The free stiffness is
    the result of a push test at the point, and includes the coupling of an ideal motion into other axes.
    """

    point: str
    motions: Matrix
    constraints: Matrix
    provenance: str

    @property
    def reasons(self) -> Mapping[str, str]:
        """Reasons for missing entries."""
        return {name: _LOCKED for name in ("motions", "constraints") if np.isnan(getattr(self, name).values).any()}


@check_arguments
def freedom_stiffness(found: Statics, kinematics: Kinematics) -> FreedomStiffness | None:
    """Compute the stiffness along each ideal motion and along each constraint of a stage with fewer than six ideal motions.

    `found` is the result of `statics` for a point of the platform. Each degree of freedom i has two values of stiffness. If all other
    degrees of freedom are free, the stiffness is 1/C_ii, with the diagonal entry C_ii of the compliance matrix. If all other degrees of
    freedom are fixed, the stiffness is the diagonal entry K_ii of the stiffness matrix. If the model locks degrees of freedom, 1/C_ii is
    NaN for these, and K_ii is NaN for all. Returns None if the stage has six ideal motions, or if the load point of `found` is not its
    read-out point.

    >>> import flexstage as fs
    >>> stage = fs.case("parallelogram")
    >>> fs.freedom_stiffness(fs.statics(fs.lumped(stage)), fs.ideal(stage)).motions.rows
    ('x',)
    """
    if kinematics.mobility == len(COMPONENTS) or found.load_point != found.read_point:
        return None
    values = np.stack([_pushed(found), np.linalg.diagonal(found.stiffness.values)], axis=-1)
    rest = tuple(name for name in COMPONENTS if name not in kinematics.coordinates)
    kinds = (kinematics.coordinates, rest)
    motions, constraints = (by_freedom(values[..., [COMPONENTS.index(name) for name in names], :], names) for names in kinds)
    return FreedomStiffness(found.read_point, motions, constraints, found.provenance)


def by_freedom(values: Array, names: tuple[str, ...]) -> Matrix:
    """Return a table of stiffness (..., n, 2) by named degree of freedom, with the other degrees of freedom free or fixed.

    >>> by_freedom(np.ones((2, 2)), ("z", "rx")).unit
    (('N/m', 'N/m'), ('N m/rad', 'N m/rad'))
    """
    units = tuple((STIFFNESS.si if name in COMPONENTS[:3] else ROTATIONAL_STIFFNESS.si,) * 2 for name in names)
    return Matrix(values, names, ("free", "held"), units)


def _pushed(result: Statics) -> Array:
    """1 / C_ii (..., 6), NaN along locked degrees of freedom."""
    along = np.linalg.diagonal(result.compliance.values)
    if not np.isnan(result.stiffness.values).any():
        return 1.0 / along
    sizes = np.abs(np.real(along)).reshape(*along.shape[:-1], 2, 3)
    moved = (sizes > _SINGULAR * np.max(sizes, axis=-1, keepdims=True)).reshape(along.shape)
    return np.where(moved, 1.0 / np.where(moved, along, 1.0), np.nan)


def _inverse(compliance: Array) -> Array:
    """Inverse of a compliance; NaN for a rank-deficient one."""
    first = np.real(first_design(compliance, 2))
    diagonal = np.diag(first)
    if np.any(loose := np.isinf(diagonal)):
        result = np.zeros(compliance.shape)
        result[np.ix_(~loose, ~loose)] = _inverse(compliance[np.ix_(~loose, ~loose)])
        return result
    scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    if np.linalg.matrix_rank(first / scale / scale[:, None], tol=_SINGULAR) < len(first):
        return np.full(compliance.shape, np.nan)
    return np.linalg.inv(compliance)


def directional(tensor: Array) -> DirectionalStiffness:
    """Compute principal values and axes of an in-plane stiffness tensor (..., 2, 2) [N/m], largest first.

    >>> directional(np.diag([1.0, 4.0])).principal.tolist()
    [4.0, 1.0]
    """
    symmetric = 0.5 * (tensor + tensor.mT)
    failed = np.any(np.isnan(symmetric), axis=(-2, -1), keepdims=True)
    values, vectors = np.linalg.eigh(np.where(failed, 0.0, np.real(symmetric)))
    values, vectors = np.where(failed[..., 0], np.nan, values), np.where(failed, np.nan, vectors)
    stiffest = vectors[..., :, 1]
    angle = np.mod(np.arctan2(stiffest[..., 1], stiffest[..., 0]), np.pi)
    angle = np.where(angle > np.pi - _ALIKE, 0.0, angle)
    angle = np.where(values[..., 1] - values[..., 0] > _ALIKE * np.abs(values[..., 1]), angle, np.nan)
    return DirectionalStiffness(Matrix(symmetric, ("x", "y"), ("x", "y"), "N/m"), values[..., ::-1], angle)


def centre_of_stiffness(stiffness: Array) -> Array:
    """Compute the centre of stiffness (..., 3) relative to the reference: the axial vector of the antisymmetric part of -K_tt^-1 K_tr.

    K_tt and K_tr are the blocks of the stiffness that map translations and rotations to forces. At the centre, the coupling K_tr is
    minimal. If the coupling vanishes at a point c, K_tr at the reference is -K_tt [c]x, with the cross-product matrix [c]x. Loncaric (1987)
    gives another definition of the centre of stiffness.

    >>> from flexstage.spatial.frame import transport
    >>> carry = transport(np.array([0.0, 0.0, -0.025]))
    >>> centre_of_stiffness(carry.T @ np.eye(6) @ carry).round(12).tolist()
    [0.0, 0.0, -0.025]
    """
    coupling = -np.linalg.solve(stiffness[..., :3, :3], stiffness[..., :3, 3:])
    return 0.5 * np.stack(
        [
            coupling[..., 2, 1] - coupling[..., 1, 2],
            coupling[..., 0, 2] - coupling[..., 2, 0],
            coupling[..., 1, 0] - coupling[..., 0, 1],
        ],
        axis=-1,
    )
