"""Responses of a closed loop to its reference, with shifted modes, and filters for known paths."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.controllers.pose_plant import pose_plant
from flexstage.control.systems.closed import Loop, pose_controller
from flexstage.control.systems.system import select

_AT_REST = 1e-4
_TAPER = 0.75
"""Start of the fade-out, relative to the band's end."""


def readings(closed: Loop, frequencies: Array, offset: float = 0.0) -> Array:
    """Compute responses (f, k, k) from the reference to the measured pose, with all mode frequencies raised by a relative `offset`.

    For the reference r, the measured pose is y = (I + P (K_e - K_y))^-1 P (K_e + K_r) r. P is the response of the sampled plant; K_e, K_y
    and K_r are the controller's responses to error, pose and reference. The mode frequencies are raised by scaling the time of the plant;
    the plant's lags therefore become shorter. Hold and delay of a sampled plant are unchanged.
    """
    P = pose_plant(closed.plant, offset).sweep(frequencies)
    back, forward = np.split(pose_controller(closed.controller, closed.plant.coordinates).sweep(frequencies), 2, axis=2)
    return np.linalg.solve(np.eye(P.shape[1]) + P @ back, P @ forward)


def motions(closed: Loop, frequencies: Array) -> Array:
    """Compute responses (f, k, k) from the reference to the true motion relative to the ground."""
    names = closed.plant.coordinates.names
    whole = select(closed.system, [f"reference.{name}" for name in names], [f"relative.{name}" for name in names])
    return whole.sweep(frequencies)


@dataclass(frozen=True)
class Band:
    """Zero-phase low-pass filter: gain 1 up to three quarters of `end` [Hz], then a cosine fade-out to zero at `end`."""

    end: float

    def gains(self, frequencies: Array) -> Array:
        """Compute the filter's gains Q (f,) at `frequencies` (f,) [Hz]."""
        share = np.clip((np.asarray(frequencies) / self.end - _TAPER) / (1.0 - _TAPER), 0.0, 1.0)
        return 0.5 * (1.0 + np.cos(np.pi * share))

    def blend(self, frequencies: Array, respond: Callable[[Array], Array], beyond: float = 1.0) -> Array:
        """Blend responses R within the band with a constant outside: Q R + (1 - Q) `beyond` I (f, k, k), with the filter's gains Q."""
        share = self.gains(frequencies)
        inside = share > 0.0
        responses, share = respond(frequencies[inside]), share[inside, None, None]
        own = beyond * np.eye(responses.shape[-1])
        found = np.broadcast_to(own, (len(frequencies), *own.shape)).astype(complex)
        found[inside] = share * responses + (1.0 - share) * own
        return found


def scaled_norms(values: Array, scale: Array) -> Array:
    """Compute the largest singular values (f,) of matrices (f, k, k), with coordinates scaled to lengths."""
    return np.linalg.norm(values * scale[:, None] / scale, ord=2, axis=(1, 2))


def frequencies_of(path: Array, step: float) -> Array:
    """Return the frequencies [Hz] of a path's transform. A tiny value replaces 0 Hz, at which integrators are singular."""
    found = np.fft.rfftfreq(len(path), step)
    found[0] = _AT_REST * found[1]
    return found


def through(responses: Array, path: Array) -> Array:
    """Filter a path (n, k) by frequency responses (n/2+1, k, k), see `frequencies_of`. The path starts at zero and ends at rest.

    The differences between successive points are transformed, because they end at zero. An inverse model may have poles outside the unit
    circle. The model's response is then the sum of a stable component that runs forward in time and an antistable component that runs
    backward in time (Devasia, Chen & Paden, IEEE Transactions on Automatic Control 41 (1996) 930). Therefore the filtered path starts
    before the original path.
    """
    spectrum = np.fft.rfft(np.diff(path, axis=0, prepend=0.0), axis=0)
    return np.cumsum(np.fft.irfft(np.einsum("fij,fj->fi", responses, spectrum), n=len(path), axis=0), axis=0)
