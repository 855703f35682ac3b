"""Generic force actuators: a force between two bodies, with a limit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.number import Number
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import FORCE, MASS, NOT_NEGATIVE, POSITIVE
from flexstage.parts.actuator import ForceLimit, ThrustActuator
from flexstage.parts.material import Material
from flexstage.parts.stated import Stated, point_masses


@dataclass(frozen=True, eq=False)
class ForceActuator(ThrustActuator):
    """Force actuator without stiffness, along x between two bodies. A positive force pushes the bodies apart.

    `maximum` is the largest force in either direction [N] (default: unknown). Half of `mass` is on each body.
    """

    kind: ClassVar[str] = "force"
    input = FORCE
    maximum: Annotated[Number, FORCE, POSITIVE] | None = None
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def thrust(self) -> Number:
        """Force per unit of input: 1 N/N, because the input is the force."""
        return 1.0

    def stated(self, material: Material | None = None) -> Stated:  # noqa: ARG002
        """Return a zero stiffness matrix, and the mass matrix with half of the mass on each body."""
        return Stated(np.zeros((6, 6)), point_masses(0.5 * self.mass, 0.5 * self.mass))

    @property
    def limits(self) -> Iterator[ForceLimit]:
        """Limit of the input: `maximum`, both for continuous and for short use."""
        yield ForceLimit("maximum force", self.maximum, self.maximum)
