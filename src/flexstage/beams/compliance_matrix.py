"""Parts with a specified 6x6 compliance matrix."""

from __future__ import annotations

from flexstage.base.number import Array, stack
from flexstage.beams.law import PartLaw
from flexstage.parts.compliance_matrix import ComplianceMatrix


def specified_compliance(part: ComplianceMatrix) -> Array:
    """Return the specified compliance (..., 6, 6) about the centre.

    >>> specified_compliance(ComplianceMatrix(tuple(tuple(float(i == j) for j in range(6)) for i in range(6)), free=())).trace()
    np.float64(6.0)
    """
    return stack(part.compliance)


MATRIX = PartLaw(compliance=specified_compliance, mass=lambda part: part.carried)
