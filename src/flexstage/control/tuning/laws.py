"""Laws of single loops with a given gain crossover: one family for each kind, from slow and well damped to fast."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from flexstage.control.controllers.family import Family, Place, tracking_gain, warped
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.resonant import IntegralResonant, resonant_law

_PI_ANGLES = np.radians(np.arange(0.0, 81.0, 16.0))
"""From integral control to nearly proportional control: six laws."""
_PID_ANGLES = np.radians(np.arange(20.0, 161.0, 20.0))
"""Zeros of PID from 5.7 times the crossover down to 0.18 of it."""
_DAMPINGS = (0.02, 0.04, 0.07, 0.12, 0.2, 0.35)
_FEEDTHROUGHS, _CORNERS = (1.07, 1.3), (0.25, 0.5, 1.0)
"""For integral resonant control: damping ratios of the first resonance; feed-through over static gain, corner over resonance."""
_FILTER = 10.0
_BELOW = 0.4
"""The derivative filter is at ten times the crossover, with a phase loss of 5.7 deg, but at most 0.4 of the rate for Tustin's rule."""


def pi_laws(place: Place, step: float | None) -> list[PI]:
    """Compute sampled PI laws with an open-loop gain of 1 at the crossover.

    The gains are k_p = sin(a)/|g| and k_i = w cos(a)/|g| for several angles a, with the plant's response g at the crossover w [1/s].

    >>> [round(found.integral, 6) for found in pi_laws(Place(1.0 / (2.0 * np.pi), -0.5j, 1.0, None), 1e-4)][:1]
    [2.0]
    """
    size, turning = 1.0 / abs(place.gain), warped(place.frequency, step)
    return [PI(size * float(np.sin(angle)), size * turning * float(np.cos(angle))) for angle in _PI_ANGLES]


def pid_laws(place: Place, step: float | None) -> list[PID]:
    """Compute PI laws, and PID laws with a double zero at w/tan(a/2) for several angles a and the crossover w [1/s].

    The derivative filter is at ten times the crossover, but at most 0.4 of the sampling rate.
    """
    corner = _FILTER * place.frequency if step is None else min(_FILTER * place.frequency, _BELOW / step)
    without = [PID(each.proportional, each.integral, 0.0, corner) for each in pi_laws(place, step)]
    return [*without, *(_pid(place, warped(place.frequency, step), float(angle), corner) for angle in _PID_ANGLES)]


def _pid(place: Place, turning: float, angle: float, corner: float) -> PID:
    inverse = float(np.tan(0.5 * angle)) / turning
    unit = PID(2.0 * inverse, 1.0, inverse**2, corner)
    s = 1j * turning
    gain = 1.0 / abs(place.gain * (unit.proportional + 1.0 / s + unit.derivative * s / (1.0 + s / (2.0 * np.pi * corner))))
    return PID(unit.proportional * gain, gain, unit.derivative * gain, corner)


def resonant_laws(place: Place, step: float | None) -> list[IntegralResonant]:
    """Compute laws of several dampings, feed-throughs and corners.

    The tracking gain k solves |k/(j w) - Q| = 1/|g| at the crossover w [1/s]; Q is the response of the law's inner feedback, and g
    the response of the plant.
    """
    found: list[IntegralResonant] = []
    turning = warped(place.frequency, step)
    if place.resonance is None or not place.static > 0.0:
        return found
    corner = 2.0 * np.pi * place.resonance
    shapes = [resonant_law(place.resonance, damping, place.static) for damping in _DAMPINGS]
    shapes += [
        IntegralResonant(ratio * corner / (share * place.static), share * place.static) for share in _FEEDTHROUGHS for ratio in _CORNERS
    ]
    for each in shapes:
        pole = each.gain * each.feedthrough
        if step is not None and pole >= np.pi / step:
            continue
        tracking = tracking_gain(place, turning, each.gain / (1j * turning + pole))
        if tracking is not None:
            found.append(IntegralResonant(each.gain, each.feedthrough, tracking))
    return found


PI_FAMILY = Family("PI", pi_laws)
PID_FAMILY = Family("PID", pid_laws, others="LQG", steps=(1.14, 2.0))
"""A loop with phase lead may have its crossover between modes, in narrow ranges."""
RESONANT_FAMILY = Family("integral resonant control", resonant_laws, notched=False, others="PI with notches, or LQG")
LQG_FAMILY = Family("LQG", lambda _, __: (), others="less gauge noise", steps=(1.6, 4.0))
"""LQG is tuned by its weights; the bandwidths tried are farther apart, because each design takes long."""
FAMILIES: Mapping[str, Family] = MappingProxyType({"pi": PI_FAMILY, "pid": PID_FAMILY, "resonant": RESONANT_FAMILY, "lqg": LQG_FAMILY})
"""Families by their names in set-up files; `CONTROLLERS` contains all other families."""
