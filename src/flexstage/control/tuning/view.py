"""Plant for tuning: from the loops' commands to their poses, at many frequencies, for several mode shifts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.control.controllers.loops import Loops
from flexstage.control.controllers.pose_plant import pose_plant
from flexstage.control.plant_models.plants import Plant
from flexstage.control.systems.system import System

_PLAIN, _PER_DECADE = 400, 60
"""Number of logarithmically spaced frequencies, and minimum per decade: 2 to 4 % apart."""
_TURNED, _OF_RATE = 0.3, 0.4
"""Highest bandwidth: a phase lag of hold and delay of 0.3 turns, 108 deg, beyond the lead of laws; at most this fraction of the rate."""
_OF_HIGHEST = 0.25
"""Highest bandwidth of a continuous loop, relative to the highest frequency: 5 times the plant's last mode."""
_LOWEST, _BELOW_FASTEST = 1e-3, 0.01
"""Lowest frequency relative to the first mode, and its maximum relative to the highest bandwidth."""
_AROUND = 21
"""Number of frequencies around each mode, at even steps of its resonance phase from -1.5 to 1.5 rad."""
_SAME = 0.01
_REPEATED = 0.1
"""Modes closer than 1 % count as one; those closer than a tenth of their half width need frequencies once."""
_STANDS_OUT = 2.0
"""Minimum gain of a significant mode, relative to the gain eight half widths away."""


@dataclass(frozen=True, eq=False)
class View:
    """Plants from commands to pose: the nominal plant first, then plants with all modes shifted by `offsets`.

    `responses` (v, f, k, n) are the frequency responses from n strokes to the poses of k loops at `frequencies` (f,) [Hz]. They are
    computed only for the first v offsets, which are within the spread. `modes` [Hz] and `ratios` are the frequencies and damping ratios of
    the plant's modes.
    """

    plant: Plant
    loops: Loops
    systems: tuple[System, ...]
    offsets: tuple[float, ...]
    frequencies: Array
    responses: Array
    modes: Array
    ratios: Array

    @property
    def step(self) -> float | None:
        """Time between samples [s]; None for a continuous loop."""
        return self.systems[0].step

    @property
    def fastest(self) -> float:
        """Highest bandwidth [Hz] to try. The limit is due to hold and delay or, in a continuous loop, to the plant's last mode."""
        return _fastest(self.plant)

    @property
    def static(self) -> Array:
        """Gain (k,) from the command to the pose of each loop at the lowest frequency."""
        return np.real(self.own[0, 0])

    def at(self, frequency: float) -> Array:
        """Compute the responses (k,) of the loops of the nominal plant at one frequency [Hz]."""
        return np.diag(self.loops.sense @ self.systems[0].transfer(np.array([frequency]))[0] @ self.loops.drive)

    def driven_at(self, offset: float, frequencies: Array) -> Array:
        """Compute responses (f, k, n) from n strokes to the poses of k loops at frequencies (f,) [Hz], with modes shifted by `offset`."""
        return self.loops.sense @ self.systems[self.offsets.index(offset)].sweep(frequencies)

    @cached_property
    def driven(self) -> Array:
        """Responses (v, f, k, k) from the commands to the poses of k loops, for v offsets at f frequencies."""
        return self.responses @ self.loops.drive

    @cached_property
    def own(self) -> Array:
        """Responses (v, f, k) from the command to the pose of each of k loops, for v offsets at f frequencies."""
        return np.einsum("vfkn,nk->vfk", self.responses, self.loops.drive)

    @cached_property
    def kept(self) -> dict[Any, Any]:
        """Cache of search data that do not depend on the tried crossover: responses of notches, observers."""
        return {}

    @cached_property
    def resonances(self) -> tuple[tuple[Resonance, ...], ...]:
        """Significant modes, by loop."""
        return tuple(resonances(self, loop) for loop in range(len(self.loops.names)))


def view(plant: Plant, loops: Loops, spread: float, offsets: tuple[float, ...] | None = None) -> View:
    """Compute the `View` of a plant for its loops; `offsets` are relative mode shifts, in ascending magnitude.

    Frequency responses are computed only for offsets within the `spread`. A relative shift s of all modes is equivalent to another time
    scale: the plant is sampled at intervals (1 + s) times as long.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> found = view(plant, platform_loops(plant.coordinates), 0.02)
    >>> found.offsets, found.responses.shape[0], found.static.round(2).tolist()
    ((0.0, -0.02, 0.02), 3, [0.99])
    """
    if offsets is None:
        offsets = (0.0, -spread, spread) if spread else (0.0,)
    systems = tuple(pose_plant(plant, offset) for offset in offsets)
    near = [offset for offset in offsets if abs(offset) <= spread]
    frequencies = _frequencies(plant, tuple(near))
    responses = np.stack([loops.sense @ system.sweep(frequencies) for system, _ in zip(systems, near, strict=False)])
    return View(plant, loops, systems, offsets, frequencies, responses, plant.frequencies, plant.ratios)


def first_alike(own: Array, loop: int, tolerance: float) -> Iterator[int]:
    """Yield the indices of all earlier loops whose responses in `own` (v, f, k) equal those of `loop`, then the index `loop`."""
    largest = np.max(np.abs(own[..., loop]))
    yield from (other for other in range(loop) if np.max(np.abs(own[..., other] - own[..., loop])) < tolerance * largest)
    yield loop


def _fastest(plant: Plant) -> float:
    step = plant.hardware.step
    if step is None:
        return _OF_HIGHEST * _highest(plant)
    return min(_TURNED / (plant.hardware.delay + 0.5 * step), _OF_RATE / step)


def _highest(plant: Plant) -> float:
    return 20.0 * float(plant.frequencies[-1]) if plant.hardware.rate is None else 0.5 * plant.hardware.rate


def _frequencies(plant: Plant, offsets: tuple[float, ...]) -> Array:
    """Frequencies spaced logarithmically, and densely around every mode for all shifts."""
    highest, slow = _highest(plant), _BELOW_FASTEST * _fastest(plant)
    lowest = min(slow, _LOWEST * float(plant.frequencies[0] or slow))
    plain = np.geomspace(lowest, highest, max(_PLAIN, int(_PER_DECADE * np.log10(highest / lowest))))
    around = np.tan(np.linspace(-1.5, 1.5, _AROUND))
    single = np.append(True, np.diff(plant.frequencies) > _REPEATED * plant.ratios[1:] * plant.frequencies[1:])
    places = [
        mode * (1.0 + offset) * (1.0 + ratio * around)
        for offset in offsets
        for mode, ratio in zip(plant.frequencies[single], plant.ratios[single], strict=True)
    ]
    every = np.unique(np.concatenate([plain, *places]))
    return every[(every > 0.0) & (every < highest)]


@dataclass(frozen=True)
class Resonance:
    """Significant mode of a loop: its `frequency` [Hz], damping `ratio`, and the `gain` from command to pose at this frequency."""

    frequency: float
    ratio: float
    gain: float


def resonances(seen: View, loop: int) -> tuple[Resonance, ...]:
    """Find the significant modes of a loop, ascending; modes closer than 1 % count as one mode.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> [round(each.gain) for each in resonances(view(plant, platform_loops(plant.coordinates), 0.0), 0)]  # near 1/(2 zeta), zeta = 1 %
    [41]
    """
    gains = np.abs(seen.own[0, :, loop])
    found: list[Resonance] = []
    for frequency, ratio in zip(seen.modes, seen.ratios, strict=True):
        if seen.step is not None and frequency >= 0.5 / seen.step:
            continue
        own, *sides = np.interp(frequency * (1.0 + np.array([0.0, -8.0, 8.0]) * ratio), seen.frequencies, gains)
        if own > _STANDS_OUT * max(sides) and not (found and frequency < found[-1].frequency * (1.0 + _SAME)):
            found.append(Resonance(float(frequency), float(ratio), float(own)))
    return tuple(found)
