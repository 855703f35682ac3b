"""Validity of beam theory: the range of each part, the expected model error, and warnings outside the range. Real numbers only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, Number, Table
from flexstage.beams.compliance import compliance, law_of
from flexstage.beams.elasticity import LAWS, HingeDimensions
from flexstage.beams.law import Range
from flexstage.beams.profiled import HIGHEST
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted
from flexstage.parts.profile import Circular, Elliptic, Filleted, Profile
from flexstage.parts.shape import Profiled, Shaped
from flexstage.spatial.frame import COMPONENTS

_POISSON = 0.3
_TOO_SOFT = 0.05
"""Relative excess compliance about z above which wide parts get a warning."""


@dataclass(frozen=True, eq=False)
class Validity(InNotebook):
    """Validity of beam theory for a part: its ranges, relative `errors` of the compliance by component (-0.1: 10 % too low), and warnings.

    If a component has no error, or NaN in a batch, it was not compared with finite elements, and its error is unknown.
    """

    ranges: tuple[Range, ...] = ()
    errors: Mapping[str, Array] = field(default_factory=lambda: Table({}))
    findings: tuple[Finding, ...] = ()


def validity(part: Part, where: str = "part", material: Material | None = None) -> Validity:
    """Estimate the model error of beam theory for a part; `where` names the part in warnings. Without a material, Poisson's ratio is 0.3.

    Compared with three-dimensional finite elements, the estimates are correct within 1 % of the compliance (fillets along y and about z: 2
    %).

    - The error of a notch includes the compliance of its roots in blocks of full height and width. Straight notches, leaves and rods end at
      rigid faces.
    - Along z and about x, the error of a notch is unknown, because the blocks at its ends are much more compliant.
    - The error of a rectangular part that is thicker than wide is unknown.
    - The error of parts with a specified matrix is not estimated.

    >>> from flexstage.parts.notch import Notch
    >>> hinge = validity(Notch("steel", thickness=0.001, width=0.01, profile=Circular(0.005)))
    >>> round(float(hinge.errors["x"]), 2), hinge.findings
    (-0.16, ())
    """
    part_law = None if isinstance(part, Restricted) else law_of(part)
    ranges = () if part_law is None else part_law.ranges(part)
    family = None if part_law is None else part_law.family(part)
    poisson = _POISSON if material is None else material.contraction
    errors = _errors(part, family, poisson) if family and isinstance(part, Shaped) else {}
    findings = (*(each.finding(where) for each in ranges), _plane_strain_finding(where, errors.get("rz"), poisson))
    return Validity(ranges, Table(errors), tuple(finding for finding in findings if finding is not None))


def _plane_strain_finding(where: str, error: Array | None, poisson: Number) -> Finding | None:
    """Warn of a part whose width prevents contraction (plane-strain bending), which beam theory neglects; the worst of a batch."""
    worst = -np.inf if error is None else float(np.max(np.nan_to_num(error, nan=-np.inf)))
    if worst < _TOO_SOFT:
        return None
    limit = 1.0 - float(np.max(_real(poisson))) ** 2
    off = f"beam theory is {100.0 * worst:.2g} % too soft about z (limit: 1 - nu^2 = {limit:.3g})"
    return Finding(
        where,
        f"bends in plane strain due to its width: {off}",
        'Use the plane-strain stiffness, or specify a measured or computed 6x6 compliance matrix (kind = "compliance_matrix")',
    )


def _errors(part: Shaped, family: str, poisson: Number) -> dict[str, Array]:
    """Errors by component, NaN outside the compared range; components without any comparison are omitted."""
    hinge = hinge_dimensions(part, poisson)
    errors = {"rx": np.zeros_like(hinge.thickness)} if family == "bar" and part.throat.warping is None else {}
    with np.errstate(all="ignore"):  # values outside the range may be anything and are masked
        for axis, (law, numbers) in LAWS[family].items():
            index = COMPONENTS.index(axis)
            value = hinge.beam[..., index] / law(hinge, numbers) - 1.0
            errors[axis] = np.where(within(family, axis, hinge), value, np.nan)
    return {axis: errors[axis] for axis in COMPONENTS if axis in errors and not np.all(np.isnan(errors[axis]))}


def hinge_dimensions(part: Shaped, poisson: Number) -> HingeDimensions:
    """Build the dimensions of a part for the fitted laws.

    >>> from flexstage.parts.rod import Rod
    >>> float(hinge_dimensions(Rod("steel", length=0.1, diameter=0.002), 0.3).half)
    0.05
    """
    thickness, width = _real(part.throat.height), _real(part.throat.width)
    along, across = _axes(part.profile if isinstance(part, Profiled) else None)
    unit = Material(young=1.0, poisson=np.real(poisson), density=1.0)
    beam = np.real(np.diagonal(compliance(part, unit), axis1=-2, axis2=-1))
    sizes = (thickness, width, 0.5 * _real(part.span), along, across, _real(poisson))
    thickness, width, half, along, across, ratio, _ = np.broadcast_arrays(*sizes, beam[..., 0])
    return HingeDimensions(thickness, width, half, along, across, ratio, beam)


def _axes(profile: Profile | None) -> tuple[Array, Array]:
    if isinstance(profile, Elliptic):
        return _real(profile.along), _real(profile.across)
    radius = _real(profile.radius) if isinstance(profile, Circular | Filleted) else np.asarray(1.0)
    return radius, radius


def within(family: str, axis: str, hinge: HingeDimensions) -> Array:
    """Return whether the proportions and Poisson's ratio are in the range that was compared with finite elements.

    For bending about z, the range has no limit for thin throats and wide hinges, because beam theory and plane strain are exact there.

    >>> from flexstage.parts.rod import Rod
    >>> bool(within("bar", "x", hinge_dimensions(Rod("steel", length=0.1, diameter=0.002), 0.45)))
    False
    """
    wide, tall = hinge.width / hinge.thickness, hinge.width / hinge.height
    inside = _between(hinge.poisson, 0.2, 0.4) & _between(wide, 1.0)
    if family in {"notch", "fillet"}:
        inside &= _between(hinge.root**2, high=0.65 if axis == "y" else HIGHEST[family])
    if family in {"notch", "fillet"} and axis != "rz":
        inside &= _between(hinge.root**2, 0.015) & _between(wide * hinge.root, high=20.0)
        inside &= _between(tall, high=1.0 if axis == "y" else 3.0 if family == "notch" else 4.5)
    if family == "notch":
        inside &= _between(hinge.flatness, 0.2, 1.4) & _between(hinge.across / hinge.thickness, 1.5 if axis == "y" else 1.0)
    if family == "fillet":
        inside &= _between((hinge.half - hinge.along) / hinge.thickness, high=12.0)
    if family == "toroid":
        inside &= _between(hinge.root**2, 0.015, HIGHEST[family])
    if family in {"bar", "leaf"}:
        share = 0.5 * hinge.width / hinge.half
        inside &= _between(share, high={("bar", "z"): 1.5, ("bar", "rz"): np.inf}.get((family, axis), 3.0))
        inside &= _between(2.0 * hinge.half / hinge.thickness, 3.0 if family == "bar" else 10.0)
    return inside & _between(1.0 / wide, high=0.2) if family == "leaf" else inside


def _between(value: Array, low: float = 0.0, high: float = np.inf) -> Array:
    rounding = 1e-9
    return (value >= low * (1.0 - rounding)) & (value <= high * (1.0 + rounding))


def _real(number: Number) -> Array:
    return np.real(np.asarray(number))
