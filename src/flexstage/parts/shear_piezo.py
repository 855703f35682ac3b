"""Shear piezo actuators: stacks of plates along x with shear displacement along y."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import (
    CAPACITANCE,
    DISPLACEMENT,
    FORCE,
    FREQUENCY,
    LENGTH,
    MASS,
    NOT_NEGATIVE,
    POSITIVE,
    RATIO,
    STIFFNESS,
    VOLTAGE,
)
from flexstage.parts.actuator import ChargedActuator
from flexstage.parts.material import Material
from flexstage.parts.section import rectangle_torsion
from flexstage.parts.stated import Stated, point_masses


@dataclass(frozen=True, eq=False)
class ShearPiezo(ChargedActuator):
    """Shear piezo actuator: a block of plates along x. The stroke u moves the block's second face along y relative to the first face.

    The block has `length` L along x, `width` along y and `depth` along z. `stiffness` k is the stiffness along y while the faces remain
    parallel; `axial_stiffness` k_a is the stiffness along x. `axial_stiffness` and `stiffness` determine Young's modulus E = k_a L / A and
    the shear compliance 1/k - L^3 / (12 E I_z), with the section's area A and its second moment of area I_z about z. The other stiffness
    terms are those of a uniform block. The blocked force is the product of stroke and stiffness. Half of `mass` is at each face.
    """

    kind: ClassVar[str] = "shear_piezo"
    stroke: Annotated[Number, DISPLACEMENT, POSITIVE]
    stiffness: Annotated[Number, STIFFNESS, POSITIVE]
    axial_stiffness: Annotated[Number, STIFFNESS, POSITIVE]
    length: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]
    depth: Annotated[Number, LENGTH, POSITIVE]
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
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
    def free_deformation(self) -> Array:
        """Free deformation (6,) per unit of stroke: a unit translation along y."""
        return np.eye(6)[1]

    @property
    def blocking_force(self) -> Number:
        """Blocked force along y [N]: product of stroke and stiffness."""
        return self.stroke * self.stiffness

    @property
    def is_axisymmetric(self) -> bool:
        """False: the stroke is perpendicular to the axis."""
        return False

    @property
    def bending(self) -> tuple[Number, Number]:
        """Bending rigidities E I about y and z [N m^2], with Young's modulus E = k_a L / A."""
        rigidity = self.axial_stiffness * self.length / 12.0
        return rigidity * self.depth**2, rigidity * self.width**2

    @property
    def shear_compliance(self) -> Number:
        """Shear compliance along y [m/N]: total compliance minus the bending compliance, both between parallel faces."""
        return 1.0 / self.stiffness - self.length**3 / (12.0 * self.bending[1])

    @property
    def compliance(self) -> Array:
        """Compliance (..., 6, 6) about the centre: a diagonal matrix.

        The entries are 1/k_a along x, 1/k along y, S + L^3 / (12 E I_y) along z, L/(G J) about x, and L/(E I_y) and L/(E I_z) about y and
        z. G J, E I_y and E I_z are the torsional and bending rigidities. The shear modulus G follows from the shear compliance S = L / (k_s
        G A) with k_s = 5/6 (parabolic shear stress). Torsion is Saint-Venant torsion. Both faces remain plane.
        """
        about_y, about_z = self.bending
        shear = self.shear_compliance
        modulus = 1.2 * self.length / (shear * (self.width * self.depth))
        across = shear + self.length**3 / (12.0 * about_y)
        turns = (self.length / (modulus * rectangle_torsion(self.width, self.depth)), self.length / about_y, self.length / about_z)
        diagonal = np.stack(np.broadcast_arrays(1.0 / self.axial_stiffness, 1.0 / self.stiffness, across, *turns), axis=-1)
        return diagonal[..., None] * np.eye(6)

    def stated(self, material: Material | None = None) -> Stated:  # noqa: ARG002
        """Return the stiffness matrix (inverse of the compliance), and the mass matrix with half of the mass at each face."""
        return Stated(np.linalg.inv(self.compliance), point_masses(0.5 * self.mass, 0.5 * self.mass))

    @property
    def faults(self) -> Iterator[Finding]:
        """Error if the bending compliance along y exceeds the total compliance."""
        if np.any(np.real(self.shear_compliance) <= 0.0):
            what = "too large for a block of these dimensions and axial stiffness: its bending compliance exceeds the total compliance"
            yield Finding("stiffness", what, "Check length, width and both stiffnesses")
