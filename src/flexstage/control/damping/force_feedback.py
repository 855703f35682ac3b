"""Integral force feedback (IFF): a leg extends at a rate proportional to its tension. This damps every mode that strains the leg."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.finding import require
from flexstage.base.number import Array
from flexstage.control.controllers.law import positive_findings
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel


@dataclass(frozen=True)
class ForceFeedback:
    """Integral force feedback: the stroke is G(s) F / k, with the tension F and the axial stiffness k of a leg.

    The law G(s) is g / (s + a) for `order` 1 and g s / (s + a)^2 for `order` 2. `gain` is g [1/s], and `corner` is the corner frequency a /
    (2 pi) [Hz] of the high-pass filter (Preumont, Dufour & Malekian, J. Guid. Control Dyn. 15 (1992) 390; Preumont, Vibration Control of
    Active Structures, 2018, ch. 7 and 8). Without the high-pass filter, the leg would have no static stiffness, and the feedback would
    cancel every command. Order 1 keeps the fraction a / (a + g) of the static stiffness. Order 2 keeps the whole static stiffness, and more
    than half the dynamic stiffness below the angular frequency a^2 / g. `lag` [Hz] is the corner of the sensor's electronics. The `delay`
    [s] is modelled by a second-order Pade approximation. Raises `DesignError` for invalid numbers.
    """

    gain: float
    corner: float
    order: int = 2
    lag: float = np.inf
    delay: float = 0.0

    def __post_init__(self) -> None:
        require(positive_findings("force feedback", {"gain": self.gain, "corner": self.corner, "lag": self.lag}))

    @property
    def numerator(self) -> Array:
        """Numerator of the feedback law G(s) with lag and delay, highest power first."""
        high = np.array([self.gain]) if self.order == 1 else np.array([self.gain, 0.0])
        return np.polymul(high, [1.0, -6.0 / self.delay, 12.0 / self.delay**2]) if self.delay else high

    @property
    def denominator(self) -> Array:
        """Denominator of the feedback law G(s) with lag and delay, highest power first."""
        turning = 2.0 * np.pi * self.corner
        found = np.array([1.0, turning]) if self.order == 1 else np.array([1.0, 2.0 * turning, turning**2])
        if np.isfinite(self.lag):
            found = np.polymul(found, [0.5 / (np.pi * self.lag), 1.0])
        return np.polymul(found, [1.0, 6.0 / self.delay, 12.0 / self.delay**2]) if self.delay else found

    def at(self, rates: Array) -> Array:
        """Compute the feedback law G at complex frequencies s = `rates` [1/s]."""
        return np.polyval(self.numerator, rates) / np.polyval(self.denominator, rates)

    def system(self, stiffness: float, tension: Channel, stroke: Channel) -> System:
        """Return the linear system from tension [N] to stroke [m], in controllable form.

        >>> law = ForceFeedback(gain=600.0, corner=1.0)
        >>> found = law.system(17e6, Channel("T", "N"), Channel("u", "m"))
        >>> bool(np.allclose(found.transfer(np.array([40.0]))[0, 0, 0] * 17e6, law.at(80j * np.pi)))
        True
        """
        A = scipy.linalg.companion(self.denominator)
        top = np.zeros((1, len(A)))
        top[0, len(A) - len(self.numerator) :] = self.numerator / self.denominator[0] / stiffness
        return System(A, np.eye(len(A))[:, :1], top, np.zeros((1, 1)), (tension,), (stroke,))

    @property
    def kept_below(self) -> float:
        """Frequency [Hz] below which a leg keeps over half its stiffness: a^2 / (2 pi g) for order 2; 0 (g > a) or infinite for order 1."""
        turning = 2.0 * np.pi * self.corner
        if self.order == 1:
            return 0.0 if self.gain > turning else np.inf
        return turning**2 / (2.0 * np.pi * self.gain)


def most_damping(frequency: float, zero: float) -> float:
    """Compute the maximum damping ratio of a mode by integral force feedback, (w - z) / (2 z).

    Here w is the mode's angular frequency, and z its angular frequency without the actuators' axial stiffness. The result is valid for one
    leg, or for decoupled legs with equal gains (Preumont 2018, ch. 7). The poles s solve s^3 + g s^2 + w^2 s + g z^2 = 0; the gain of
    maximum damping is g = w (w/z)^(1/2), for which one root is -(w z)^(1/2). A result above 1 means that the mode can be overdamped.

    >>> most_damping(110.0, 100.0)
    0.05
    """
    return (frequency - zero) / (2.0 * zero)


def damping_of_pair(law: ForceFeedback, frequency: float, zero: float) -> complex:
    """Compute the pole [1/s] of an undamped mode with feedback. It is tracked while the gain increases from zero to the gain of `law`.

    The pole is a root s of 1 + G(s) (s^2 + z^2) / (s^2 + w^2) = 0, with the angular frequencies w and z of `most_damping`.

    >>> pole = damping_of_pair(ForceFeedback(2.4 * np.pi * 1.2**0.5, 1e-6, order=1), 1.2, 1.0)
    >>> round(-pole.real / abs(pole), 5)
    0.1
    """
    w, z = 2.0 * np.pi * frequency, 2.0 * np.pi * zero
    pole = 1j * w
    for share in np.geomspace(1e-3, 1.0, 60):
        closed = np.polyadd(np.polymul(law.denominator, [1.0, 0.0, w**2]), share * np.polymul(law.numerator, [1.0, 0.0, z**2]))
        roots = np.roots(closed)
        roots = roots[roots.imag >= 0.0]
        pole = complex(roots[np.argmin(np.abs(roots - pole))])
    return pole
