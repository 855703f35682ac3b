"""What a closed loop makes of its reference, with its modes where they may lie; its inverse over a known path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.controllers.pose_plant import pose_plant
from flexstage.control.plant_models.plants import Plant
from flexstage.control.systems.closed import Loop, pose_controller
from flexstage.control.systems.system import System, select

_AT_REST = 1e-4
_TAPER = 0.75
"""From this share of its end on, a band fades out."""


def readings(plant: Plant, control: System, frequencies: Array, offset: float = 0.0) -> Array:
    """Responses (f, k, k) from reference to the pose that the gauges tell, all modes by a relative `offset` higher.

    y = (I + P (K_e - K_y))^-1 P (K_e + K_r) r of the sampled plant P and the controller's K from error, pose and reference. Modes that lie
    higher are time that runs faster, lags and delays with it.
    """
    P = pose_plant(plant, offset).sweep(frequencies)
    back, forward = np.split(pose_controller(control, plant.coordinates).sweep(frequencies), 2, axis=2)
    return np.linalg.solve(np.eye(P.shape[1]) + P @ back, P @ forward)


def motions(closed: Loop, frequencies: Array) -> Array:
    """Responses (f, k, k) from reference to the true motion against the ground."""
    names = closed.plant.coordinates.names
    whole = select(closed.system, [f"reference.{name}" for name in names], [f"relative.{name}" for name in names])
    return whole.sweep(frequencies)


@dataclass(frozen=True)
class Band:
    """Frequencies up to `end` [Hz], whole up to three quarters of it, then fading as a cosine; without phase."""

    end: float

    def gains(self, frequencies: Array) -> Array:
        """Q (f,), from 1 to 0."""
        share = np.clip((np.asarray(frequencies) / self.end - _TAPER) / (1.0 - _TAPER), 0.0, 1.0)
        return 0.5 * (1.0 + np.cos(np.pi * share))

    def blend(self, frequencies: Array, respond: Callable[[Array], Array], beyond: float = 1.0) -> Array:
        """Q R + (1 - Q) I `beyond` (f, k, k): responses R within the band; beyond it unchanged (1) or nothing (0)."""
        share = self.gains(frequencies)
        inside = share > 0.0
        responses, share = respond(frequencies[inside]), share[inside, None, None]
        own = beyond * np.eye(responses.shape[-1])
        found = np.broadcast_to(own, (len(frequencies), *own.shape)).astype(complex)
        found[inside] = share * responses + (1.0 - share) * own
        return found


def scaled_norms(values: Array, scale: Array) -> Array:
    """Largest singular values (f,) of matrices (f, k, k), coordinates taken as lengths."""
    return np.linalg.norm(values * scale[:, None] / scale, ord=2, axis=(1, 2))


def frequencies_of(path: Array, step: float) -> Array:
    """Frequencies [Hz] of a path's transform; instead of 0, where integrators have no number, next to nothing."""
    found = np.fft.rfftfreq(len(path), step)
    found[0] = _AT_REST * found[1]
    return found


def through(responses: Array, path: Array) -> Array:
    """A path (n, k), from nothing to rest, through responses (n/2+1, k, k) at the frequencies of its transform.

    What is transformed are its differences, which end in nothing. Of an inverse whose poles lie outside the unit circle too, the
    answer on the circle is the stable part forward and the antistable part backward in time (Devasia, Chen & Paden, IEEE Trans. Autom.
    Control 41 (1996) 930): it begins before the path does.
    """
    spectrum = np.fft.rfft(np.diff(path, axis=0, prepend=0.0), axis=0)
    return np.cumsum(np.fft.irfft(np.einsum("fij,fj->fi", responses, spectrum), n=len(path), axis=0), axis=0)
