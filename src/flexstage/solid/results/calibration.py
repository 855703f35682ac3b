"""Calibration of the lumped model: 6x6 compliance matrices of hinges from finite elements replace the matrices from beam theory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, require
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, stack
from flexstage.base.record import INNER, VIEW
from flexstage.beams.compliance import compliance
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.checks.orientation import is_axisymmetric
from flexstage.mechanism.drawn import calibrated_parts
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.mechanism.store import loads
from flexstage.mechanism.store.stand_in import KEPT, ReplacementPart, write_stand_ins
from flexstage.parts.compliance_matrix import ComplianceMatrix, Origin
from flexstage.parts.compound import Compound
from flexstage.solid.fea.geometry.piece import is_mirrored, medium
from flexstage.solid.fea.hinges.hinge_form import LEAVE, NO_ESTIMATE
from flexstage.solid.results.hinges import STANDARD_HINGES, Hinges, SolidHinge, solid_hinges
from flexstage.spatial.frame import COMPONENTS, mirror, spatial_rotation

TAG = "derived FEA"
_DIGITS = 7
_LARGEST_ERROR = 0.1


@dataclass(frozen=True, eq=False)
class Calibration(InNotebook):
    """Result of a calibration: the computed hinges, the `parts` that replace them, and the design file's `text` with these parts."""

    hinges: Mapping[str, SolidHinge]
    parts: Mapping[str, ComplianceMatrix]
    text: Annotated[str, INNER]

    @property
    def over_beam_theory(self) -> Annotated[Mapping[str, Array], VIEW]:
        """Relative differences (6,) between direct compliances by FEA and by beam theory, along and about x, y, z, by name of the part.

        A difference is NaN if FEA cannot separate the compliance from the adjacent blocks; beam theory then provides the compliance.
        """
        return {
            name: np.where(
                hinge.separable,
                np.diag(stack(self.parts[name].compliance)) / np.diag(compliance(hinge.form.part, hinge.form.material)) - 1.0,
                np.nan,
            )
            for name, hinge in self.hinges.items()
        }


@check_arguments
def calibrate(text: str, compute: Hinges = STANDARD_HINGES, *, where: str = "text") -> Calibration:
    """Compute the 6x6 compliance matrix of every distinct hinge in a design file's text, and insert the matrices; comments are kept.

    Raises `DesignError` for hinges that are calibrated already, that have overrides in single instances, or that are members of a compound.
    Also raises `DesignError` if the error of a matrix by FEA is unknown or above 10 %.
    """
    mechanism = loads(text, where=where)
    require(_refuse_calibrated(mechanism))
    require([*_refuse_members(mechanism), *_refuse_overrides(mechanism)])
    found = solid_hinges(mechanism, compute)
    parts = stand_ins(found)
    errors = max(hinge.found.error for hinge in found.values())
    stands = {name: ReplacementPart(part, found[name].links) for name, part in parts.items()}
    return Calibration(found, parts, write_stand_ins(text, stands, f"{TAG} within {100.0 * errors:.2g} %", where=where))


def stand_ins(found: Mapping[str, SolidHinge]) -> dict[str, ComplianceMatrix]:
    """Convert computed hinges to parts with compliance matrices, with the mass and the intended DOFs of the drawn hinges.

    Each matrix has the symmetry of the drawn hinge. For a DOF in which FEA cannot separate the hinge from the adjacent blocks, the matrix
    contains the value of beam theory. Raises `DesignError` if the error of a matrix is unknown or above 10 %.

    >>> stand_ins({})
    {}
    """
    require(_doubt(name, hinge.error) for name, hinge in found.items() if hinge.error is None or hinge.error > _LARGEST_ERROR)
    return {
        name: ComplianceMatrix(
            compliance=tuple(tuple(float(f"{value:.{_DIGITS}g}") for value in row) for row in _symmetrise(hinge)),
            free=hinge.form.part.intended,
            mass=_mass(hinge),
            origin=Origin.FEA,
            source=_source(hinge),
            replaces=hinge.shared + KEPT,
        )
        for name, hinge in found.items()
    }


def _doubt(name: str, error: float | None) -> Finding:
    if error is None:
        return Finding(f"parts.{name}", f"the error of its compliance matrix by FEA is unknown: {NO_ESTIMATE}", LEAVE)
    what = f"the error of its compliance matrix by FEA is {100.0 * error:.2g} % (expected at most 10 %)"
    return Finding(f"parts.{name}", what, "Require a smaller relative error (--accuracy)")


def substitute_parts(mechanism: Mechanism, found: Mapping[str, SolidHinge]) -> Mechanism:
    """Replace the hinges of a stage by their computed compliance matrices, except members of compounds.

    Raises `DesignError` for a link that overrides its shared part.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> substitute_parts(double_triangle(), {}) == double_triangle()
    True
    """
    require(_refuse_overrides(mechanism))
    found = {name: hinge for name, hinge in found.items() if not isinstance(mechanism.parts[hinge.shared], Compound)}
    parts = stand_ins(found)
    kept = {hinge.shared + KEPT: hinge.form.part for hinge in found.values()}
    others = {name: part for name, part in mechanism.parts.items() if name + KEPT not in kept}
    names = {link: name for name, hinge in found.items() for link in hinge.links}
    units = {unit: replace(drawn, links=_rename_parts(drawn.links, names, f"{unit}/")) for unit, drawn in mechanism.units.items()}
    return replace(mechanism, parts={**others, **kept, **parts}, units=units, links=_rename_parts(mechanism.links, names, "links."))


def _rename_parts(links: Mapping[str, Link], names: Mapping[str, str], owner: str) -> dict[str, Link]:
    """Links with the replaced parts."""
    return {name: replace(link, part=names.get(owner + name, link.part)) for name, link in links.items()}


def _refuse_calibrated(mechanism: Mechanism) -> Iterator[Finding]:
    for name in calibrated_parts(mechanism):
        yield Finding(f"parts.{name}", "its compliance matrix is from FEA already", "Calibrate the original design file")


def _refuse_members(mechanism: Mechanism) -> Iterator[Finding]:
    for name in {link.link.part: link for link in expand(mechanism).links.values() if link.of is not None}:
        what = "it consists of several hinges, which cannot be calibrated separately"
        yield Finding(f"parts.{name}", what, "Define the hinges as separate links")


def _refuse_overrides(mechanism: Mechanism) -> Iterator[Finding]:
    for link in expand(mechanism).links.values():
        if link.described.part != mechanism.parts[link.link.part]:
            yield Finding(
                link.name,
                f"overrides its part {link.link.part}, but all links of this part share one compliance matrix",
                "Define a separate part for this link",
            )


_TURN = spatial_rotation(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]))
"""A quarter turn about x."""


def _symmetrise(hinge: SolidHinge) -> Array:
    """The 6x6 with the symmetry of the drawn hinge, which its mesh has only approximately.

    Reflected across y and z a hinge is itself, and across x if its roots are equal; a round one is axially symmetric. Compliances that
    cannot be separated from the stubs are from beam theory.
    """
    matrix, known = np.array(hinge.found.compliance), np.array(hinge.separable)
    matrix[~known] = matrix[:, ~known] = 0.0
    matrix += np.diag(np.where(known, 0.0, np.diag(compliance(hinge.form.part, hinge.form.material))))
    material, own = hinge.form.material, medium(hinge.form.material)
    axes = (0, 1, 2) if hinge.roots == hinge.roots.mirrored else (1, 2)
    mirrors = [mirror(axis) for axis in axes if is_mirrored(own, axis)]
    for symmetry in [*mirrors, *([_TURN] if is_axisymmetric(hinge.form.part) and not material.is_cubic else [])]:
        matrix = 0.5 * (matrix + symmetry @ matrix @ symmetry.T)
    return matrix


def _source(hinge: SolidHinge) -> str:
    found = hinge.found
    kept = [axis for axis, known in zip(COMPONENTS, hinge.separable, strict=True) if not known]
    beam = f"; {', '.join(kept)} by beam theory" if kept else ""
    return f"finite elements of order {found.order}, {found.freedoms} degrees of freedom, error {100.0 * found.error:.2g} %{beam}"


def _mass(hinge: SolidHinge) -> float:
    """Mass of the drawn hinge [kg]: that of a unit translation of both of its ends."""
    both = np.zeros(12)
    both[[0, 6]] = 1.0
    return float(both @ np.real(mass(hinge.form.part, hinge.form.material))[:12, :12] @ both)
