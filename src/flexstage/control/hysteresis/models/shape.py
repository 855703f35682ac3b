"""The major loop of a hysteresis: its branches, stroke and width."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from flexstage.base.number import Array
from flexstage.control.hysteresis.models.protocol import Hysteresis

Range: TypeAlias = tuple[float, float]
"""Lowest and highest input, V."""


@dataclass(frozen=True, eq=False)
class MajorLoop:
    """Settled major loop over a range: outputs (k, axes) of the branches `up` and `down` at ascending inputs `volts` (k,).

    `stroke` (axes,) is the output span between the ends. `width` (axes,) is the largest distance between the branches at the same input,
    divided by `stroke`.
    """

    volts: Array
    up: Array
    down: Array

    @property
    def stroke(self) -> Array:
        """Output span between the ends of the loop (axes,)."""
        return self.up[-1] - self.up[0]

    @property
    def width(self) -> Array:
        """Largest distance (axes,) between the branches at the same input, divided by the stroke."""
        return np.max(self.down - self.up, axis=0) / self.stroke


def major_loop(model: Hysteresis, volts: Range, count: int = 401, cycles: int = 8) -> MajorLoop:
    """Compute the major loop of a hysteresis model between two inputs after `cycles` cycles, at `count` inputs per branch.

    >>> from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
    >>> loop = major_loop(PrandtlIshlinskii([0.0, 100.0], [1e-7, 5e-8]), (0.0, 1000.0))
    >>> (1e6 * loop.stroke).round(6).tolist(), loop.width.round(6).tolist()  # width 5e-8 m/V times 200 V
    ([140.0], [0.071429])
    """
    up = np.linspace(*volts, count)
    once = np.concatenate([up, up[-2::-1]])
    inputs = np.concatenate([once, *[once[1:]] * cycles])
    found = model.run(np.tile(inputs[:, None], (1, model.axes)))[-len(once) :]
    return MajorLoop(up, found[:count], found[: count - 2 : -1])
