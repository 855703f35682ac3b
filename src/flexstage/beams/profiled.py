"""Stress concentration and proportions of the profiles of notches and necks."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Number
from flexstage.beams.law import Range, ratio
from flexstage.parts.profile import Circular, Contour, Elliptic, Filleted, Profile, Straight

HIGHEST = {"notch": 0.8, "fillet": 1.0, "toroid": 0.5}
"""Largest thickness over throat radius for which stresses were compared with finite elements."""


def concentration(profile: Profile, thickness: Number) -> Number | None:
    """Compute the notch factor in bending, K_t = (1 + t/(2 R))^(9/20) (Smith, Flexures, 2000), with thickness t and radius R at the throat.

    R is a^2/c for an ellipse with the semi-axes a along and c across the hinge, and the fillet radius for a corner-filleted hinge. A
    straight hinge has K_t = 1, because its corners are not specified.

    For t/(2 R) up to 1, the errors relative to plane-stress finite elements with full-height blocks (tests/elsewhere) are:

    - circular notch: in bending +1 to +2 %, in tension 0 to -13 %;
    - fillets: in bending +3 to +7 %, in tension -2 to -10 %.

    For parabolas, hyperbolas and the tip of a V, R is also the radius at the throat. The factor of a deep notch depends only on thickness
    and radius at the throat (Neuber, Kerbspannungslehre, 1958).

    Returns `None` for power profiles, whose curvature at the throat is zero or infinite, and for free-form tables, for which there is no
    reference.

    >>> from flexstage.parts.profile import Circular
    >>> round(float(concentration(Circular(0.005), 0.001)), 4)
    1.0438
    """
    if isinstance(profile, Straight):
        return 1.0
    if isinstance(profile, Elliptic):
        return (1.0 + thickness * profile.across / (2.0 * profile.along * profile.along)) ** 0.45
    if isinstance(profile, Contour):
        radius = profile.radius_at_throat
        return None if radius is None else (1.0 + thickness / (2.0 * radius)) ** 0.45
    return (1.0 + thickness / (2.0 * profile.radius)) ** 0.45


def proportions(profile: Profile, thickness: Number, family: str) -> tuple[Range, ...]:
    """Return the ratio with a validated range: thickness / throat radius, or length / thickness of a straight profile.

    The result is empty for a `Contour` (V, parabola, table, ...), because it was not compared with finite elements.
    """
    return () if isinstance(profile, Contour) else (_proportion(profile, thickness, family),)


def _proportion(profile: Circular | Elliptic | Filleted | Straight, thickness: Number, family: str) -> Range:
    highest = HIGHEST["fillet" if isinstance(profile, Filleted) else family]
    if isinstance(profile, Circular | Filleted):
        return Range("thickness over radius", ratio(thickness, profile.radius), high=highest)
    if isinstance(profile, Elliptic):
        throat = np.real(np.asarray(profile.along)) ** 2 / np.real(np.asarray(profile.across))
        return Range("thickness over radius at the throat", ratio(thickness, throat), high=highest)
    return Range("length over thickness", ratio(profile.length, thickness), low=3.0)
