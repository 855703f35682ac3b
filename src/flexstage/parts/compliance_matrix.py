"""Parts with a specified 6x6 compliance matrix (given, measured or computed by FEA), and ideal joints."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number, Vector, stack
from flexstage.base.storage.digest import DOCUMENT_ONLY, Description
from flexstage.base.units.quantity import COMPLIANCE_MATRIX, LENGTH, MASS, NOT_NEGATIVE
from flexstage.parts.body import Inertia, across
from flexstage.parts.freedom import Freedom
from flexstage.parts.mass import tensor
from flexstage.parts.material import Material
from flexstage.parts.shape import Elastic
from flexstage.parts.stated import Stated, definite_findings, halves, is_even, mirror_rows, point_masses, turns_into_itself
from flexstage.spatial.frame import rigid_inertia


class Origin(Enum):
    """Source of a compliance matrix."""

    STATED = "stated"
    MEASURED = "measured"
    FEA = "fea"


@dataclass(frozen=True, eq=False)
class ComplianceMatrix(Elastic):
    """Part with a 6x6 compliance matrix about its centre, in its link frame [SI]: rows (x, y, z, rx, ry, rz).

    Entries are in m/N, rad/N (= m/(N m)) and rad/(N m); the matrix is symmetric and positive definite. `free` are the ideal degrees of
    freedom. `replaces` names the drawn part that the matrix replaces. The drawn part supplies the shape for the solid model, and the
    material for drift and structural damping. `mass` is a point mass at the part's centre; half of it belongs to each end. If `centre` (the
    centre of mass) or `inertia` (about the centre of mass) is specified, the mass matrix is that of a rigid solid instead of a point mass.
    `centre` and `inertia` are in the axes of the link frame.
    """

    kind: ClassVar[str] = "compliance_matrix"
    compliance: Annotated[tuple[tuple[Number, ...], ...], COMPLIANCE_MATRIX]
    free: tuple[Freedom, ...]
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    origin: Origin = Origin.STATED
    source: str = field(default="", metadata=DOCUMENT_ONLY)
    replaces: str = ""
    centre: Annotated[Vector, LENGTH] | None = None
    inertia: Inertia | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom of the part."""
        return self.free

    @property
    def mirrored(self) -> ComplianceMatrix:
        """Mirror image in the x-z plane: entries that couple y, rx or rz with x, z or ry change sign."""
        inertia = None if self.inertia is None else self.inertia.mirrored
        centre = None if self.centre is None else across(self.centre)
        return replace(self, compliance=mirror_rows(self.compliance), centre=centre, inertia=inertia)

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors: inertia or centre without a mass, or a compliance that is not symmetric and positive definite."""
        for name in ("centre", "inertia"):
            if getattr(self, name) is not None and np.any(np.real(self.mass) == 0.0):
                yield Finding(name, "specified without a mass", "Specify the mass too")
        yield from definite_findings("compliance", stack(self.compliance))

    def stated(self, material: Material | None = None) -> Stated:  # noqa: ARG002
        """Return the stiffness (inverse of the compliance) and the mass matrix with half of the mass at each end, both about the centre."""
        return Stated(np.linalg.inv(stack(self.compliance)), self.carried)

    @property
    def carried(self) -> Array:
        """Mass matrix (..., 12, 12) for the twists of both ends. Both ends are at the centre, because the part has no length."""
        if self.inertia is None and self.centre is None:
            return point_masses(0.5 * self.mass, 0.5 * self.mass)
        inertia = np.zeros((3, 3)) if self.inertia is None else tensor(self.inertia)
        return halves(rigid_inertia(self.mass, inertia, stack(self.centre or (0.0, 0.0, 0.0)), np.zeros(3)))

    @property
    def is_axisymmetric(self) -> bool:
        """Whether y and z have the same degrees of freedom and compliance, in translation and rotation."""
        return is_even(self.free) and turns_into_itself(stack(self.compliance))


@dataclass(frozen=True, eq=False)
class Joint(Description):
    """Ideal joint without elasticity or mass: only the degrees of freedom in `free` are free. If `free` is empty, the joint is a weld."""

    kind: ClassVar[str] = "joint"
    free: tuple[Freedom, ...] = ()

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom, as specified in `free`."""
        return self.free

    @property
    def mirrored(self) -> Joint:
        """The joint itself, by symmetry."""
        return self
