"""Performance bounds of actuators that hold for every mechanism, with any levers and guides.

Notation: X are displacements of the motions in both directions [m, rad]; M are the smallest masses [kg] or moments of inertia [kg m^2] of
the payload along the motions, whatever other motions accompany them. Bounds are exact upper limits, not estimates.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass


def stroke_energy(stroke: float, stiffness: float, count: int = 1) -> float:
    """Return the elastic energy U = n k (s/2)^2 [J] of n = `count` actuators of full stroke s [m] and stiffness k [N/m].

    >>> round(stroke_energy(150e-6, 17e6, 6), 3)
    0.574
    """
    return count * stiffness * (0.5 * stroke) ** 2


def stiffness_bound(energy: float, displacement: float, negative_stiffness: float = 0.0) -> float:
    """Return the largest stiffness K [N/m, N m/rad] along a motion of +-X that is driven by actuators with imposed stroke.

    The bound is K X^2 <= U (1 + N/K) with the stroke energy U; N >= 0 is the negative part of the passive stiffness along the motion.
    Proof: the stiffness is K = G'kG + P, with the ratios G of strokes to displacements, the stiffnesses k of the actuators and a passive
    part P >= -N (' is the transpose). Strokes u displace the stage by x: K x = G'k u. Hence x'Kx = (k^1/2 G x)'(k^1/2 u) is at most
    (x'G'kGx)^1/2 (u'ku)^1/2 <= (x'Kx + N x'x)^1/2 U^1/2. The largest K is the positive root of K^2 = (U/X^2) (K + N).

    >>> round(stiffness_bound(0.025, 1e-3))
    25000
    >>> round(stiffness_bound(0.025, 100e-6, 5e6) * 100e-6**2, 3)  # a stack of 10 N/um with a spring of -5 N/um
    0.05
    """
    most = energy / displacement**2
    return 0.5 * (most + math.sqrt(most * (most + 4.0 * negative_stiffness)))


def frequency_bound(energy: float, displacements: Mapping[str, float], masses: Mapping[str, float]) -> float:
    """Return the highest first natural frequency [Hz] of a stage that reaches all displacements together.

    Averaged over the corners of the required displacements, the energies of the motions j add up: sum K_j X_j^2 <= U, with the stiffnesses
    K_j, the displacements X_j and the stroke energy U. By Rayleigh's quotient, (2 pi f)^2 M_j <= K_j for the first frequency f and the
    masses M_j, therefore (2 pi f)^2 <= U / sum M_j X_j^2. Springs of negative stiffness are excluded.

    >>> round(frequency_bound(2 * stroke_energy(1e-3, 0.35e6), {"x": 0.5e-3, "y": 0.5e-3}, {"x": 1.0, "y": 1.0}), 1)
    94.2
    """
    return math.sqrt(energy / _weighted(displacements, masses)) / (2.0 * math.pi)


def displacement_factor(energy: float, displacements: Mapping[str, float], masses: Mapping[str, float], frequency: float) -> float:
    """Return the largest factor on all displacements for which the frequency [Hz] is still within its bound.

    >>> both = {"x": 0.5e-3, "y": 0.5e-3}, {"x": 1.0, "y": 1.0}
    >>> round(0.5e-3 * displacement_factor(2 * stroke_energy(1e-3, 0.35e6), *both, 500.0) * 1e6, 1)
    94.2
    """
    return math.sqrt(energy / _weighted(displacements, masses)) / (2.0 * math.pi * frequency)


def required_energy(displacements: Mapping[str, float], masses: Mapping[str, float], frequency: float) -> float:
    """Return the smallest stroke energy U [J] of actuators that allows this first natural frequency [Hz].

    >>> round(required_energy({"x": 0.5e-3}, {"x": 1.0}, 500.0), 2)
    2.47
    """
    return (2.0 * math.pi * frequency) ** 2 * _weighted(displacements, masses)


def _weighted(displacements: Mapping[str, float], masses: Mapping[str, float]) -> float:
    return sum(masses[axis] * value**2 for axis, value in displacements.items())


@dataclass(frozen=True)
class ForceSource:
    """An actuator with continuous force [N], moving mass [kg] and full travel [m]. `count` such actuators act along the motion."""

    force: float
    mass: float
    travel: float = math.inf
    count: int = 1


def force_frequency_bound(source: ForceSource, displacement: float, mass: float) -> float:
    """Return the highest natural frequency [Hz] of a motion of +-X that is driven by continuous forces through the best levers.

    For n actuators of force F, moving mass m and travel T, the ratio of actuator motion to stage motion is g <= T/(2X). For the payload's
    mass M and the total stiffness K, the forces require K X <= n F g, and the frequency f requires (2 pi f)^2 (M + n m g^2) <= K. The bound
    includes springs of negative stiffness. The best lever ratio is sqrt(M/(n m)), but at most T/(2X). g = 1 is direct drive.

    >>> coil = ForceSource(force=73.9, mass=0.18, travel=26e-3)
    >>> round(force_frequency_bound(coil, 0.5e-3, 1.0), 1)
    66.4
    """
    most = source.travel / (2.0 * displacement)
    ratio = min(math.sqrt(mass / (source.count * source.mass)) if source.mass > 0.0 else most, most)
    if math.isinf(ratio):
        return math.inf
    moving = mass + source.count * source.mass * ratio**2
    return math.sqrt(source.count * source.force * ratio / (displacement * moving)) / (2.0 * math.pi)


def leaf_length(thickness: float, displacement: float, young: float, poisson: float, stress: float) -> float:
    """Return the smallest length [m] of a wide guided leaf for a displacement of its end [m] at an allowable stress [Pa].

    The bending stress is 3 E t d / ((1 - nu^2) L^2), with Young's modulus E, thickness t, displacement d, Poisson's ratio nu and length L.

    >>> round(leaf_length(0.5e-3, 1e-3, 200e9, 0.3, 500e6) * 1e3, 1)
    25.7
    """
    return math.sqrt(3.0 * young * thickness * displacement / ((1.0 - poisson**2) * stress))


def efficiency(frequency: float, energy: float, displacements: Mapping[str, float], masses: Mapping[str, float]) -> float:
    """Return the fraction (at most 1) of the actuators' stroke energy that a stage with this first natural frequency [Hz] uses.

    >>> round(efficiency(50.0, 2 * stroke_energy(1e-3, 0.35e6), {"x": 0.5e-3, "y": 0.5e-3}, {"x": 1.0, "y": 1.0}), 3)
    0.282
    """
    return required_energy(displacements, masses, frequency) / energy
