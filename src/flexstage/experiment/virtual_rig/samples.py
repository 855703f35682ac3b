"""Samples of a virtual test, computed on demand."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.virtual_rig.chain import Chain
from flexstage.experiment.virtual_rig.noise import Stream, walk, white
from flexstage.experiment.virtual_rig.plan import Plan

_HELD = 2**24


@dataclass(frozen=True, eq=False)
class Simulated:
    """Simulated samples (n, inputs + outputs) in the record's units, computed in independent blocks that can be read in any order.

    `input_scale` (m,) and `output_scale` convert SI units to the record's units. Short records are cached completely; of long records, only
    the last block is cached.
    """

    plan: Plan
    chain: Chain
    input_scale: Array
    output_scale: float
    source: str = ""
    _kept: dict[int, Array] = field(default_factory=dict[int, Array], repr=False)

    @property
    def length(self) -> int:
        """Number of samples of each channel."""
        return self.plan.length

    @property
    def block(self) -> int:
        """Number of samples per block."""
        return self.chain.size // self.chain.finer

    def read(self, start: int, stop: int) -> Array:
        """Read samples `start` to `stop` (excluded).

        >>> from flexstage.cases.double_triangle import double_triangle
        >>> from flexstage.models.mapped import mapped
        >>> from flexstage.experiment.virtual_rig.rig import rig
        >>> from flexstage.experiment.virtual_rig.setup import RigSetup
        >>> stage = double_triangle()
        >>> samples = rig(stage, mapped(stage), RigSetup(seconds=1.0)).samples
        >>> samples.read(10, 12).shape, bool(np.all(samples.read(10, 12) == samples.read(0, 12)[10:]))
        ((2, 12), True)
        """
        start, stop, _ = slice(start, stop).indices(self.length)
        size = self.block
        numbers = range(start // size, -(-stop // size))
        pieces = [self._block_at(number)[max(0, start - number * size) : stop - number * size] for number in numbers]
        return np.concatenate(pieces) if pieces else np.zeros((0, len(self.plan.actuators) + len(self.plan.gauges)))

    def _block_at(self, number: int) -> Array:
        if number not in self._kept:
            found = self._compute_block(number)
            if self.length * found.shape[1] > _HELD:
                self._kept.clear()
            self._kept[number] = found
        return self._kept[number]

    def _compute_block(self, number: int) -> Array:
        plan, chain, gauges = self.plan, self.chain, len(self.plan.gauges)
        drive = self._transforms(Stream.DRIVE, len(plan.actuators), number)[: len(chain.inputs)]
        read = self._middle_block((chain.outputs @ drive[:, :, None])[:, :, 0])
        if np.any(plan.densities):
            read = read + self._middle_block(self._transforms(Stream.GAUGE, gauges, number) * chain.gauge)
        if np.any(plan.walks):  # variance per step: a minute's variance over its number of samples
            walks = [walk(plan.setup.seed, column, number, self.block) for column in range(gauges)]
            read = read + plan.walks / np.sqrt(60.0 * plan.rate) * np.stack(walks, axis=1)
        scaled, steps = read * self.output_scale, plan.steps * self.output_scale
        coarse = np.where(steps > 0.0, steps, 1.0)
        rounded = np.where(steps > 0.0, np.round(scaled / coarse) * coarse, scaled)
        return np.concatenate([self._middle_block(chain.inputs * drive) * self.input_scale, rounded], axis=1)

    def _transforms(self, stream: Stream, channels: int, number: int) -> Array:
        """Transforms (l, channels) of the white numbers of a block with its two neighbours."""
        seed, size = self.plan.setup.seed, self.chain.size
        every = ([white(seed, stream, channel, each, size) for each in (number - 1, number, number + 1)] for channel in range(channels))
        return np.stack([np.fft.rfft(np.concatenate(each)) for each in every], axis=1)

    def _middle_block(self, spectra: Array) -> Array:
        """Middle block of the transforms over three blocks, at the sampling rate."""
        size = self.chain.size
        return np.fft.irfft(spectra, 3 * size, axis=0)[size : 2 * size : self.chain.finer]
