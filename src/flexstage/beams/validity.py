"""Where beam theory holds: the range of each part, the error to expect, and advice outside the range. Real numbers only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number, Table
from flexstage.beams.closed_forms import wu_zhou_axial, wu_zhou_rotation
from flexstage.beams.compliance import compliance
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Part
from flexstage.parts.profile import Circular, Elliptic, Filleted, length
from flexstage.parts.rod import Rod

_UNIT = Material(young=1.0, poisson=0.3, density=1.0)
_CALIBRATE = 'State a measured or computed 6x6 (kind = "given"), or count on a larger error than the one stated'

# Error of the compliance by beam theory against converged finite elements, hinge and root, nu = 0.3. Zero is the thin limit.
_RATIO = (0.0, 0.05, 0.10, 0.20, 0.40, 0.50, 0.80)  # t/R, reference B1: plane stress
_NOTCH_RZ = (0.0, -0.0195, -0.0380, -0.0717, -0.1264, -0.1486, -0.1992)
_NOTCH_X = (0.0, -0.1004, -0.1300, -0.1621, -0.1911, -0.1981, -0.2059)
_NOTCH_Y = (0.0, -0.0467, -0.0718, -0.0940, -0.0902, -0.0778, -0.0272)
_TORSION_RATIO = (0.0, 0.2, 0.5, 1.0)  # t/R, 3-D elements of wide notches with full-height blocks (tests/elsewhere)
_NOTCH_RX = (0.0, -0.08, -0.18, -0.20)
_TOROID_RATIO = (0.0, 0.05, 0.10, 0.20, 0.50)  # t/R, reference B4: axisymmetric
_TOROID_RZ = (0.0, -0.0083, -0.0170, -0.0342, -0.0829)
_TOROID_X = (0.0, -0.0284, -0.0509, -0.0858, -0.1476)
_LEAF_RATIO = (0.0, 0.1, 0.2, 0.5, 2.0)  # b/L, reference B6: plate
_LEAF_RX = (0.0, 0.0022, 0.0042, 0.0122, 0.0595)


@dataclass(frozen=True, eq=False)
class Range:
    """A ratio of dimensions, such as t/R, and the interval in which beam theory was compared with elasticity."""

    name: str
    value: Array
    low: float = 0.0
    high: float = float("inf")

    def finding(self, where: str) -> Finding | None:
        """Advice if a design lies outside, telling the first one; else `None`."""
        values = np.atleast_1d(self.value).ravel()
        outside = np.flatnonzero((values < self.low) | (values > self.high))
        if not outside.size:
            return None
        value = values[outside[0]]
        bound, side = (self.low, "below") if value < self.low else (self.high, "above")
        place = where if values.size == 1 else f"{where}[{outside[0]}]"
        return Finding(place, f"{self.name} = {value:.3g} is {side} {bound:g}, the limit of what beam theory was compared with", _CALIBRATE)


@dataclass(frozen=True, eq=False)
class Validity:
    """Ranges of a part, the signed relative `errors` to expect of its compliance by component (-0.1: 10 % too stiff), and `findings`.

    A component that is not among the errors was not compared with elasticity.
    """

    ranges: tuple[Range, ...] = ()
    errors: Mapping[str, Array] = field(default_factory=lambda: Table({}))
    findings: tuple[Finding, ...] = ()


def validity(part: Part, where: str = "part") -> Validity:
    """What to expect of beam theory for a part; `where` names it in the findings.

    Circular notches by the tables of reference B1; fillets and ellipses add to their own the root compliance of the circle of equal t/R
    (B2, B3: right within 1 % of the compliance); toroids by B4; leaves by B6. Parts that are stated have no error here.

    >>> hinge = validity(Notch("steel", thickness=0.001, width=0.01, profile=Circular(0.005)))
    >>> round(float(hinge.errors["rz"]), 4), hinge.findings
    (-0.0717, ())
    """
    ranges, errors = _known(part)
    findings = (each.finding(where) for each in ranges)
    return Validity(ranges, Table(errors), tuple(finding for finding in findings if finding is not None))


def _known(part: Part) -> tuple[tuple[Range, ...], dict[str, Array]]:
    if isinstance(part, Notch):
        slender = Range("width over thickness", _ratio(part.width, part.thickness), low=1.0)
        return (slender, _shape(part)), _notch_errors(part)
    if isinstance(part, Neck):
        return (_shape(part),), _neck_errors(part)
    if isinstance(part, Leaf):
        thin = Range("thickness over width", _ratio(part.thickness, part.width), high=0.2)
        return (thin, Range("length over thickness", _ratio(part.length, part.thickness), low=10.0)), _leaf_errors(part)
    if isinstance(part, Rod):
        return (Range("length over diameter", _ratio(part.length, part.diameter), low=5.0),), {}
    return (), {}


def _shape(part: Notch | Neck) -> Range:
    profile = part.profile
    if isinstance(profile, Circular | Filleted):
        return Range("thickness over radius", _ratio(part.thickness, profile.radius), high=_highest(part))
    if isinstance(profile, Elliptic):
        return Range("thickness over radius at the throat", _throat_ratio(part.thickness, profile), high=_highest(part))
    return Range("length over thickness", _ratio(profile.length, part.thickness), low=3.0)


def _highest(part: Notch | Neck) -> float:
    if isinstance(part.profile, Filleted):
        return 1.0
    return _TOROID_RATIO[-1] if isinstance(part, Neck) and part.width is None else _RATIO[-1]


def _notch_errors(part: Notch) -> dict[str, Array]:
    profile = part.profile
    if isinstance(profile, Circular):
        ratio = _ratio(part.thickness, profile.radius)
        axial = np.interp(ratio, _RATIO, _NOTCH_X)
        return {
            "x": axial,
            "y": np.interp(ratio, _RATIO, _NOTCH_Y),
            "rx": np.interp(ratio, _TORSION_RATIO, _NOTCH_RX),
            "ry": axial,
            "rz": np.interp(ratio, _RATIO, _NOTCH_RZ),
        }
    if isinstance(profile, Filleted):
        return _root_errors(part, _ratio(part.thickness, profile.radius), profile.radius, 1.0)
    if isinstance(profile, Elliptic):
        radius = profile.along * profile.along / profile.across
        return _root_errors(part, _throat_ratio(part.thickness, profile), radius, _ratio(profile.across, profile.along))
    return {}


def _root_errors(part: Notch, ratio: Array, radius: Number, flatness: Number) -> dict[str, Array]:
    """Errors -d / (C + d): d is the root compliance of the circular notch of equal t/R; axially it shrinks with the flatness c/a."""
    size = (part.width, part.thickness, radius)
    axial = flatness * _root(np.interp(ratio, _RATIO, _NOTCH_X)) * _real(wu_zhou_axial(1.0, *size))
    turning = _root(np.interp(ratio, _RATIO, _NOTCH_RZ)) * _real(wu_zhou_rotation(1.0, *size))
    matrix = np.real(compliance(part, _UNIT))
    errors = {
        "x": -axial / (matrix[..., 0, 0] + axial),
        "rz": -turning / (matrix[..., 5, 5] + turning),
    }
    if isinstance(part.profile, Filleted):
        lateral = turning * (0.5 * _real(length(part.profile)) - 0.7 * _real(part.profile.radius)) ** 2
        errors["y"] = -lateral / (matrix[..., 1, 1] + lateral)
    return errors


def _neck_errors(part: Neck) -> dict[str, Array]:
    if part.width is not None or not isinstance(part.profile, Circular):
        return {}
    ratio = _ratio(part.thickness, part.profile.radius)
    turning = np.interp(ratio, _TOROID_RATIO, _TOROID_RZ)
    return {"x": np.interp(ratio, _TOROID_RATIO, _TOROID_X), "ry": turning, "rz": turning}


def _leaf_errors(part: Leaf) -> dict[str, Array]:
    ratio = _ratio(part.width, part.length)
    plate = np.full_like(ratio, 0.001)
    return {"y": plate, "rx": np.interp(ratio, _LEAF_RATIO, _LEAF_RX), "rz": plate}


def _root(error: Array) -> Array:
    return -error / (1.0 + error)


def _throat_ratio(thickness: Number, profile: Elliptic) -> Array:
    return _real(thickness) * _real(profile.across) / _real(profile.along) ** 2


def _ratio(top: Number, bottom: Number) -> Array:
    return _real(top) / _real(bottom)


def _real(number: Number) -> Array:
    return np.real(np.asarray(number))
