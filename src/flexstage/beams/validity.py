"""Where beam theory holds: the range of each part, the error to expect, and advice outside the range. Real numbers only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number, Table
from flexstage.beams.compliance import compliance
from flexstage.beams.elasticity import AXES, LAWS, Slot
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Part
from flexstage.parts.profile import Circular, Elliptic, Filleted, Profile, Straight, length
from flexstage.parts.rod import Rod

_CALIBRATE = 'State a measured or computed 6x6 (kind = "given"), or count on a larger error than the one stated'
_POISSON = 0.3
_HIGHEST = {"notch": 0.8, "fillet": 1.0, "toroid": 0.5}
"""The largest thickness over radius that was compared."""
_Bounds = tuple[float, float]


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

    A component that is not among the errors, or not a number in a batch, was not compared with elasticity or cannot be told.
    """

    ranges: tuple[Range, ...] = ()
    errors: Mapping[str, Array] = field(default_factory=lambda: Table({}))
    findings: tuple[Finding, ...] = ()


def validity(part: Part, where: str = "part", material: Material | None = None) -> Validity:
    """What to expect of beam theory for a part; `where` names it in the findings. Poisson's ratio is 0.3 unless a material is given.

    The errors are right within 1 % of the compliance against three-dimensional elements: notches with their roots, grown on blocks of their
    full height and width; straight ones, leaves and rods between rigid faces. Along z and about x a notch has none: beside the blocks it
    grows on, there is too little of its own to tell. Parts that are stated have no error here.

    >>> hinge = validity(Notch("steel", thickness=0.001, width=0.01, profile=Circular(0.005)))
    >>> round(float(hinge.errors["x"]), 2), hinge.findings
    (-0.16, ())
    """
    ranges = _ranges(part)
    findings = (each.finding(where) for each in ranges)
    errors = _errors(part, _POISSON if material is None else material.poisson) if isinstance(part, Notch | Neck | Leaf | Rod) else {}
    return Validity(ranges, Table(errors), tuple(finding for finding in findings if finding is not None))


def _ranges(part: Part) -> tuple[Range, ...]:
    if isinstance(part, Notch):
        return Range("width over thickness", _ratio(part.width, part.thickness), low=1.0), _shape(part)
    if isinstance(part, Neck):
        return (_shape(part),)
    if isinstance(part, Leaf):
        thin = Range("thickness over width", _ratio(part.thickness, part.width), high=0.2)
        return thin, Range("length over thickness", _ratio(part.length, part.thickness), low=10.0)
    if isinstance(part, Rod):
        return (Range("length over diameter", _ratio(part.length, part.diameter), low=5.0),)
    return ()


def _shape(part: Notch | Neck) -> Range:
    profile = part.profile
    highest = _HIGHEST[
        "fillet" if isinstance(profile, Filleted) else "toroid" if isinstance(part, Neck) and part.width is None else "notch"
    ]
    if isinstance(profile, Circular | Filleted):
        return Range("thickness over radius", _ratio(part.thickness, profile.radius), high=highest)
    if isinstance(profile, Elliptic):
        throat = _real(profile.along) ** 2 / _real(profile.across)
        return Range("thickness over radius at the throat", _ratio(part.thickness, throat), high=highest)
    return Range("length over thickness", _ratio(profile.length, part.thickness), low=3.0)


def _errors(part: Notch | Neck | Leaf | Rod, poisson: Number) -> dict[str, Array]:
    """By component, NaN outside what was compared; components that are nowhere known are left out."""
    family = family_of(part)
    if family is None:
        return {}
    slot = slot_of(part, poisson)
    found = {"rx": np.zeros_like(slot.thickness)} if family == "bar" and _is_round(part) else {}
    with np.errstate(all="ignore"):  # outside the range anything may come out, and nothing of it is told
        for axis, (law, numbers) in LAWS[family].items():
            index = AXES.index(axis)
            value = slot.beam[..., index] / law(slot, numbers) - 1.0
            found[axis] = np.where(within(family, axis, slot), value, np.nan)
    return {axis: found[axis] for axis in AXES if axis in found and not np.all(np.isnan(found[axis]))}


def family_of(part: Notch | Neck | Leaf | Rod) -> str | None:
    """The family of laws that a part belongs to; `None` where none was fitted.

    >>> family_of(Rod("steel", length=0.1, diameter=0.002))
    'bar'
    """
    if isinstance(part, Leaf):
        return "leaf"
    if isinstance(part, Rod) or isinstance(part.profile, Straight):
        return "bar"
    if isinstance(part, Notch):
        return "fillet" if isinstance(part.profile, Filleted) else "notch"
    return "toroid" if part.width is None and isinstance(part.profile, Circular) else None


def _is_round(part: Notch | Neck | Leaf | Rod) -> bool:
    return isinstance(part, Rod) or (isinstance(part, Neck) and part.width is None)


def slot_of(part: Notch | Neck | Leaf | Rod, poisson: Number) -> Slot:
    """A part by the numbers that the laws ask for.

    >>> float(slot_of(Rod("steel", length=0.1, diameter=0.002), 0.3).half)
    0.05
    """
    thickness = _real(part.diameter if isinstance(part, Rod) else part.thickness)
    width = thickness if isinstance(part, Rod) or part.width is None else _real(part.width)
    long = part.length if isinstance(part, Leaf | Rod) else length(part.profile)
    profile = None if isinstance(part, Leaf | Rod) else part.profile
    along, across = _axes(profile)
    unit = Material(young=1.0, poisson=np.real(poisson), density=1.0)
    beam = np.real(np.diagonal(compliance(part, unit), axis1=-2, axis2=-1))
    sizes = (thickness, width, 0.5 * _real(long), along, across, _real(poisson))
    thickness, width, half, along, across, ratio, _ = np.broadcast_arrays(*sizes, beam[..., 0])
    return Slot(thickness, width, half, along, across, ratio, beam)


def _axes(profile: Profile | None) -> tuple[Array, Array]:
    if isinstance(profile, Elliptic):
        return _real(profile.along), _real(profile.across)
    radius = _real(profile.radius) if isinstance(profile, Circular | Filleted) else np.asarray(1.0)
    return radius, radius


def within(family: str, axis: str, slot: Slot) -> Array:
    """Where a law was compared with elements: its proportions, and Poisson's ratio.

    >>> bool(within("bar", "x", slot_of(Rod("steel", length=0.1, diameter=0.002), 0.45)))
    False
    """
    inside = _between(slot.poisson, (0.2, 0.4))
    wide, tall = slot.width / slot.thickness, slot.width / slot.height
    if family in {"notch", "fillet"}:
        inside &= _between(slot.root**2, (0.015, _HIGHEST[family])) & _between(wide, (1.0, np.inf))
        inside &= _between(tall, (0.0, 1.0 if axis == "y" else 4.5)) & _between(wide * slot.root, (0.0, 20.0))
    if family == "notch":
        inside &= _between(slot.flatness, (0.2, 1.6)) & _between(slot.across / slot.thickness, (1.0, np.inf))
    if family == "fillet":
        inside &= _between((slot.half - slot.along) / slot.thickness, (0.0, 12.0))
    if family == "toroid":
        inside &= _between(slot.root**2, (0.015, _HIGHEST[family]))
    if family in {"bar", "leaf"}:
        share = 0.5 * slot.width / slot.half
        inside &= _between(share, (0.0, 1.5 if family == "bar" and axis == "z" else 3.0))
        inside &= _between(2.0 * slot.half / slot.thickness, (3.0 if family == "bar" else 10.0, np.inf))
    return inside & _between(1.0 / wide, (0.0, 0.2)) if family == "leaf" else inside


def _between(value: Array, bounds: _Bounds) -> Array:
    rounding = 1e-9
    return (value >= bounds[0] * (1.0 - rounding)) & (value <= bounds[1] * (1.0 + rounding))


def _ratio(top: Number, bottom: Number) -> Array:
    return _real(top) / _real(bottom)


def _real(number: Number) -> Array:
    return np.real(np.asarray(number))
