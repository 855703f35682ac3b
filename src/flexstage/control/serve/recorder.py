"""Data recorder: tables filled after a trigger."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flexstage.base.number import Array
from flexstage.control.simulation.result import Series

TABLES, POINTS = 8, 262_144
"""Number of tables, and total number of points in all tables."""
NOTHING, TARGET, POSITION, ERROR, VOLTAGE = 0, 1, 2, 3, 16
"""Record options: the recorded quantity of a table."""


@dataclass
class Recorder:
    """Tables of recorded points. Each table has a source (index of an axis or actuator) and an option. `rate` is in samples per point."""

    sources: list[int]
    options: list[int]
    rate: int = 1
    points: list[Array] = field(default_factory=lambda: [np.empty(0)] * TABLES)
    _left: int = 0
    _skip: int = 0

    def start(self) -> None:
        """Empty all tables, and start recording at the next sample."""
        self.points = [np.empty(0)] * TABLES
        self._left, self._skip = POINTS // TABLES, 0

    def empty(self, table: int) -> None:
        """Delete a table's points."""
        self.points[table] = np.empty(0)

    def take(self, found: Series, scale: float, volts: Array) -> None:
        """Record points from the simulated samples `found`; `scale` converts SI units to the units of the axes."""
        if not self._left:
            return
        rows = slice(self._skip, self._skip + self._left * self.rate, self.rate)
        signals = {
            TARGET: found.reference * scale,
            POSITION: found.pose * scale,
            ERROR: (found.reference - found.pose) * scale,
            VOLTAGE: volts,
        }
        taken = len(range(*rows.indices(len(volts))))
        for table, (source, option) in enumerate(zip(self.sources, self.options, strict=True)):
            if option != NOTHING:
                self.points[table] = np.concatenate([self.points[table], signals[option][rows, source]])
        self._left -= taken
        self._skip = (self._skip - len(volts)) % self.rate if taken else self._skip - len(volts)
