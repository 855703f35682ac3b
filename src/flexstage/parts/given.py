"""Parts known by a 6x6 matrix (stated, measured or computed by FEA), and ideal joints."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Annotated, ClassVar

from flexstage.base.digest import DOCUMENT_ONLY, Description
from flexstage.base.number import Number, stack
from flexstage.base.quantity import COMPLIANCE_MATRIX, MASS, NOT_NEGATIVE
from flexstage.parts.freedom import Freedom
from flexstage.parts.shape import Elastic
from flexstage.parts.stated import is_even, mirror_rows, turns_into_itself


class Origin(Enum):
    """Where a given matrix comes from."""

    STATED = "stated"
    MEASURED = "measured"
    FEA = "fea"


@dataclass(frozen=True, eq=False)
class Given(Elastic):
    """A part known by its 6x6 compliance about its centre, in its link frame, SI: rows (x, y, z, rx, ry, rz).

    Entries are m/N, rad/N (= m/(N m)) and rad/(N m); the matrix is symmetric and positive definite. `free` states its intended freedoms.
    `stands_for` names the drawn part that the matrix was computed from, so that the solid model knows the shape,
    and drift and structural damping the material.
    """

    kind: ClassVar[str] = "given"
    compliance: Annotated[tuple[tuple[Number, ...], ...], COMPLIANCE_MATRIX]
    free: tuple[Freedom, ...]
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    origin: Origin = Origin.STATED
    source: str = field(default="", metadata=DOCUMENT_ONLY)
    stands_for: str = ""

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the part is meant to have."""
        return self.free

    @property
    def mirrored(self) -> Given:
        """Its compliance with the entries reversed that tell a motion along y, or a rotation about x or z, with another one."""
        return replace(self, compliance=mirror_rows(self.compliance))

    @property
    def is_round(self) -> bool:
        """Whether freedoms and compliance are the same along and about y and z."""
        return is_even(self.free) and turns_into_itself(stack(self.compliance))


@dataclass(frozen=True, eq=False)
class Joint(Description):
    """An ideal joint without elasticity or mass: the `free` freedoms are free, all others locked exactly. No freedom: a weld."""

    kind: ClassVar[str] = "joint"
    free: tuple[Freedom, ...] = ()

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the joint leaves free."""
        return self.free

    @property
    def mirrored(self) -> Joint:
        """Itself: freedoms have no sign."""
        return self
