"""The plant as tuning sees it: between the loops' commands and poses, at many frequencies, with its modes where they may lie."""

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
"""Frequencies evenly in the logarithm, and how many a decade has at least: 2 to 4 % apart."""
_TURNED, _OF_RATE = 0.3, 0.4
"""Highest bandwidth: hold and delay take 0.3 of a turn there, 108 deg, more than laws make up for; at most this share of the rate."""
_OF_HIGHEST = 0.25
"""The same of a continuous loop, over the highest frequency that is looked at: 5 times the plant's last mode."""
_LOWEST, _BELOW_FASTEST = 1e-3, 0.01
"""Lowest frequency over the first mode, and over the highest bandwidth at most; of a free body, whose mode is at 0 Hz, over both."""
_AROUND = 21
"""Frequencies around each mode, at even steps of the turn of its resonance from -1.5 to 1.5 rad."""
_SAME = 0.01
_REPEATED = 0.1
"""Modes closer than 1 % stand out as one; those closer than a tenth of their half width need frequencies once."""
_STANDS_OUT = 2.0
"""How many times the gain eight half widths away that of a mode is which stands out."""


@dataclass(frozen=True, eq=False)
class View:
    """Plants from commands to pose: as modelled (first), and with all modes by the `offsets` off.

    `responses` (v, f, k, n) are those of the loops' poses to strokes, sense P, at `frequencies` (f,) [Hz]. `modes` [Hz] and `ratios` are
    those of the plant's modes.
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
        """Highest bandwidth [Hz] that is worth a trial, by hold and delay; of a continuous loop by the plant's last mode."""
        return _fastest(self.plant)

    @property
    def static(self) -> Array:
        """The loops' own gains (k,) at the lowest frequency."""
        return np.real(self.own[0, 0])

    def at(self, frequency: float) -> Array:
        """The loops' own responses (k,) at one frequency [Hz]."""
        return np.diag(self.loops.sense @ self.systems[0].transfer(np.array([frequency]))[0] @ self.loops.drive)

    def driven_at(self, offset: float, frequencies: Array) -> Array:
        """Responses (f, k, n) of the loops' poses to strokes at frequencies [Hz], with the modes by one of the offsets off."""
        return self.loops.sense @ self.systems[self.offsets.index(offset)].sweep(frequencies)

    @cached_property
    def driven(self) -> Array:
        """Responses (v, f, k, k) of the loops' poses to the loops' commands."""
        return self.responses @ self.loops.drive

    @cached_property
    def own(self) -> Array:
        """The loops' own responses (v, f, k)."""
        return np.einsum("vfkn,nk->vfk", self.responses, self.loops.drive)

    @cached_property
    def kept(self) -> dict[Any, Any]:
        """What is the same at all frequencies of a search, kept by it: responses of notches, observers."""
        return {}

    @cached_property
    def resonances(self) -> tuple[tuple[Resonance, ...], ...]:
        """Modes that stand out, by loop."""
        return tuple(resonances(self, loop) for loop in range(len(self.loops.names)))


def view(plant: Plant, loops: Loops, spread: float, offsets: tuple[float, ...] | None = None) -> View:
    """The plant by its loops; at other `offsets`, the first 0, where they are given.

    A plant whose modes all lie by s above is the same with time running faster: that of samples (1 + s) T apart, called T.

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
    frequencies = _frequencies(plant, offsets)
    responses = np.stack([loops.sense @ system.sweep(frequencies) for system in systems])
    return View(plant, loops, systems, offsets, frequencies, responses, plant.frequencies, plant.ratios)


def first_alike(own: Array, loop: int, tolerance: float) -> Iterator[int]:
    """Loops (v, f, k) before this one with the same response, and the loop itself: a symmetric stage has several."""
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
    """Evenly in the logarithm, and densely around every mode wherever it may lie."""
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
    """A mode that stands out in a loop: its `frequency` [Hz], damping `ratio`, and the loop's `gain` there."""

    frequency: float
    ratio: float
    gain: float


def resonances(seen: View, loop: int) -> tuple[Resonance, ...]:
    """Modes that stand out in a loop, ascending; those closer than 1 % count as one.

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
