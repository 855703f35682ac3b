"""Actuators with a specified 6x6 stiffness and a free deformation between their faces: amplified piezos, stepping drives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar, Self, TypeAlias

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number, stack
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import (
    ANGLE,
    CAPACITANCE,
    COMPLIANCE_MATRIX,
    DISPLACEMENT,
    FORCE,
    FREQUENCY,
    MASS,
    NOT_NEGATIVE,
    POSITIVE,
    RATIO,
    ROTATIONAL_STIFFNESS,
    STIFFNESS,
    STIFFNESS_MATRIX,
    VOLTAGE,
)
from flexstage.parts.actuator import ChargedActuator, StrokeActuator
from flexstage.parts.body import Inertia
from flexstage.parts.freedom import Freedom
from flexstage.parts.mass import tensor
from flexstage.parts.material import Material
from flexstage.parts.stated import Stated, definite_findings, is_even, mirror_rows, point_masses, turns_into_itself

_Along: TypeAlias = Annotated[Number, STIFFNESS, POSITIVE]
_About: TypeAlias = Annotated[Number, ROTATIONAL_STIFFNESS, POSITIVE]
_Diagonal: TypeAlias = tuple[_Along, _Along, _Along, _About, _About, _About]
_Matrix: TypeAlias = tuple[tuple[Number, ...], ...]
_Shift: TypeAlias = Annotated[Number, DISPLACEMENT]
_Turn: TypeAlias = Annotated[Number, ANGLE]
_Deformation: TypeAlias = tuple[_Shift, _Shift, _Shift, _Turn, _Turn, _Turn]


class BetweenFaces(StrokeActuator):
    """Stroke actuator with the force f = k (dx - s u): 6x6 stiffness k, motion dx between the faces, free deformation s u at stroke u."""

    diagonal: _Diagonal | None
    matrix: _Matrix | None
    compliance: _Matrix | None
    free: tuple[Freedom, ...]
    mass: Number

    @property
    def carried(self) -> Array:
        """Mass matrix (..., 12, 12) for the twists of both faces at the centre; half of the mass is at each face."""
        return point_masses(0.5 * self.mass, 0.5 * self.mass)

    def stated(self, material: Material | None = None) -> Stated:  # noqa: ARG002
        """Return the specified 6x6 stiffness, and half of the mass at each face."""
        return Stated(self.between, self.carried)

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom, as specified."""
        return self.free

    @property
    def between(self) -> Array:
        """Stiffness k (..., 6, 6) [SI] about the centre, for motion of the second face relative to the first."""
        if self.diagonal is not None:
            return stack(self.diagonal)[..., None] * np.eye(6)
        return np.linalg.inv(stack(self.compliance)) if self.matrix is None else stack(self.matrix)

    @property
    def mirrored(self) -> Self:
        """Mirror image in the x-z plane: couplings that are odd in y change sign."""
        stated = {name: rows for name in ("matrix", "compliance") if (rows := getattr(self, name)) is not None}
        return replace(self, **{name: mirror_rows(rows) for name, rows in stated.items()})  # type: ignore[type-var]

    @property
    def blocking_force(self) -> Number:
        """Blocked force along x at full stroke [N]: x component of the product of stiffness and free deformation."""
        return (self.between @ self.free_deformation[..., None])[..., 0, 0] * self.stroke

    @property
    def is_axisymmetric(self) -> bool:
        """Whether stiffness, free deformation and degrees of freedom are axisymmetric."""
        across = np.real(self.free_deformation)[..., [1, 2, 4, 5]]
        return is_even(self.free) and not np.any(across) and turns_into_itself(self.between)

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors of the stiffness: it must be specified exactly once, and be symmetric and positive definite."""
        stated = [name for name in ("diagonal", "matrix", "compliance") if getattr(self, name) is not None]
        if len(stated) != 1:
            result = f"both {' and '.join(stated)} specified" if stated else "6x6 stiffness missing"
            yield Finding("", result, "Specify one of diagonal (six stiffnesses), matrix (6x6 stiffness) or compliance (6x6 compliance)")
            return
        if stated[0] != "diagonal":
            yield from definite_findings(stated[0], stack(getattr(self, stated[0])))


@dataclass(frozen=True, eq=False)
class Amplified(BetweenFaces, ChargedActuator):
    """Amplified piezo actuator: a 6x6 stiffness between two faces, with a free deformation in proportion to the stroke.

    The force is f = k (dx - s u), with the stiffness k, the motion dx between the faces, and the free deformation s u at the stroke u.
    `stroke` is the full free stroke of the output along x. `deformation` is the free deformation (x, y, z, rx, ry, rz) of the second face
    relative to the first at full stroke (default: the stroke along x). The free deformation can describe contracting actuators and
    parasitic motion. Exactly one of `diagonal` (x, y, z, rx, ry, rz), `matrix` and `compliance` specifies the 6x6 stiffness about the
    centre at constant voltage. Half of `mass` and half of `inertia` (about the centre) are at each face. `free` lists the degrees of
    freedom of the ideal model. `resonance` is the resonance frequency with one face fixed and the other face free. It is information only:
    internal modes are not modelled.
    """

    kind: ClassVar[str] = "amplified"
    stroke: Annotated[Number, DISPLACEMENT, POSITIVE]
    deformation: _Deformation | None = None
    diagonal: _Diagonal | None = None
    matrix: Annotated[_Matrix, STIFFNESS_MATRIX] | None = None
    compliance: Annotated[_Matrix, COMPLIANCE_MATRIX] | None = None
    free: tuple[Freedom, ...] = ()
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    inertia: Inertia | None = None
    maximum_load: Annotated[Number, FORCE, POSITIVE] | None = None
    tensile_limit: Annotated[Number, FORCE, NOT_NEGATIVE] | None = None
    preload: Annotated[Number, FORCE, NOT_NEGATIVE] | None = None
    resonance: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    voltage_low: Annotated[Number, VOLTAGE] | None = None
    voltage_high: Annotated[Number, VOLTAGE] | None = None
    bias: Annotated[Number, VOLTAGE] | None = None
    capacitance: Annotated[Number, CAPACITANCE, POSITIVE] | None = None
    loss_factor: Annotated[Number, RATIO, NOT_NEGATIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def mirrored(self) -> Self:
        """Mirror image in the x-z plane: also products of inertia and deformations that are odd in y change sign."""
        signs = (1.0, -1.0, 1.0, -1.0, 1.0, -1.0)
        deformation = self.deformation and tuple(sign * each for sign, each in zip(signs, self.deformation, strict=True))
        return replace(super().mirrored, deformation=deformation, inertia=self.inertia and self.inertia.mirrored)

    @property
    def free_deformation(self) -> Array:
        """Free deformation (..., 6) for a unit stroke: `deformation` divided by `stroke`, or by default a unit translation along x."""
        if self.deformation is None:
            return np.eye(6)[0]
        return stack(self.deformation) / np.asarray(self.stroke)[..., None]

    @property
    def carried(self) -> Array:
        """Mass matrix (..., 12, 12) for the twists of both faces at the centre; half of the mass and of the inertia is at each face.

        >>> Amplified(stroke=1e-4, mass=2.0).carried.diagonal()[:4].tolist()
        [1.0, 1.0, 1.0, 0.0]
        """
        lumps = super().carried
        return lumps if self.inertia is None else lumps + np.kron(np.diag([0.0, 1.0, 0.0, 1.0]), 0.5 * tensor(self.inertia))


@dataclass(frozen=True, eq=False)
class SteppingDrive(BetweenFaces):
    """Stepping drive, self-locking without power, such as an inertia drive, inchworm or screw.

    The stroke is the whole `travel` along x: half of the travel is on each side of the nominal position. `resolution` is the step. Exactly
    one of `diagonal` (x, y, z, rx, ry, rz), `matrix` and `compliance` specifies the 6x6 stiffness of the locked drive about its centre.
    `holding_force` is the force along x at which the drive slips. It is the load limit in tension and compression. Half of `mass` is at
    each face. The model is linear, without backlash or step forces.
    """

    kind: ClassVar[str] = "stepper"
    travel: Annotated[Number, DISPLACEMENT, POSITIVE]
    resolution: Annotated[Number, DISPLACEMENT, POSITIVE] | None = None
    diagonal: _Diagonal | None = None
    matrix: Annotated[_Matrix, STIFFNESS_MATRIX] | None = None
    compliance: Annotated[_Matrix, COMPLIANCE_MATRIX] | None = None
    free: tuple[Freedom, ...] = ()
    holding_force: Annotated[Number, FORCE, POSITIVE] | None = None
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    loss_factor: Annotated[Number, RATIO, NOT_NEGATIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def stroke(self) -> Number:  # type: ignore[override]
        """Full stroke [m]: the travel."""
        return self.travel

    @property
    def step(self) -> Number | None:
        """Smallest step [m]: the resolution."""
        return self.resolution

    @property
    def maximum_load(self) -> Number | None:  # type: ignore[override]
        """Largest compression [N]: the slip force."""
        return self.holding_force

    @property
    def tensile_limit(self) -> Number | None:  # type: ignore[override]
        """Largest tension [N]: the slip force."""
        return self.holding_force

    @property
    def below_zero(self) -> Number:
        """Fraction of the stroke below the nominal position: one half."""
        return 0.5
