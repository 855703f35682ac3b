"""Trajectories from tables: poses at given times."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.lazy import LazyModule
from flexstage.base.number import Array
from flexstage.experiment.records.record import Channel, Record
from flexstage.experiment.records.unit import in_si, plain_unit
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

if TYPE_CHECKING:
    from flexstage.experiment.formats.table import layout as layouts
    from flexstage.experiment.formats.table import values as tabled
else:  # slow import: all record formats
    layouts, tabled = LazyModule("flexstage.experiment.formats.table.layout"), LazyModule("flexstage.experiment.formats.table.values")


@dataclass(frozen=True, eq=False)
class Table:
    """Piecewise linear poses `values` (n, c) [m, rad] at increasing `times` (n,) [s]; constant before the first and after the last time.

    In findings, `source` names the origin of the table. Raises `DesignError` for times that do not increase, values that are not finite,
    and shapes that do not match.

    >>> way = Table(np.array([0.0, 1.0, 3.0]), np.array([[0.0], [2e-6], [0.0]]), ("x",))
    >>> way.at(np.array([0.5, 2.0, 5.0])).ravel().tolist()
    [1e-06, 1e-06, 0.0]
    """

    times: Array
    values: Array
    coordinates: tuple[str, ...]
    source: str = "trajectory"

    def __post_init__(self) -> None:
        require(_findings(self))

    @property
    def duration(self) -> float:
        """Last time [s]."""
        return float(self.times[-1])

    def at(self, times: Array) -> Array:
        """Compute poses (n, c) [m, rad] at `times` (n,) [s]."""
        return np.stack([np.interp(times, self.times, column) for column in self.values.T], axis=-1)


def _findings(table: Table) -> list[Finding]:
    fits = table.values.shape == (len(table.times), len(table.coordinates)) and len(table.times) > 1
    if not fits:
        what = f"wrong shape (got {table.values.shape}, expected {len(table.times)} times, {len(table.coordinates)} coordinates)"
        return [Finding(table.source, what, "Use one row per time, at least two, and one column per coordinate")]
    found = []
    for row in np.flatnonzero(~(np.diff(table.times) > 0.0))[:1]:
        what = f"times must increase (got {table.times[row + 1]:g} s in row {row + 2} after {table.times[row]:g} s)"
        found.append(Finding(table.source, what, "Sort the rows by time, and remove repeated times"))
    for row, column in np.argwhere(~np.isfinite(table.values))[:1]:
        found.append(
            Finding(f"{table.source}: {table.coordinates[column]}", f"the value in row {row + 1} is not finite", "Correct the value")
        )
    return found


def from_file(path: str | os.PathLike[str]) -> Table:
    r"""Read a CSV table of times and coordinates with units, `time [s], x [um], rz [urad]`; the times may be unevenly spaced.

    Raises `DesignError` for an unreadable file, and for missing times or coordinates.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "a.csv").write_text("time [ms], x [um]\n0, 0\n100, 2\n400, 0\n")
    ...     way = from_file(Path(folder) / "a.csv")
    >>> way.times.tolist(), way.values.ravel().tolist()
    ([0.0, 0.1, 0.4], [0.0, 2e-06, 0.0])
    """
    place = Path(path)
    layout = layouts.read_layout(place)
    samples = tabled.index_table(place, layout)
    channels = tuple(Channel(name, plain_unit(unit)) for name, unit in zip(layout.names, layout.units, strict=True))
    if channels[0].name.lower() not in ("time", "t"):
        raise refuse(
            str(place), f'wrong first column (got "{channels[0].name}", expected times)', 'Start with times, e.g. "time [s], x [um]"'
        )
    whole = Record(channels, 1.0, samples, source=str(place))
    named = tuple(name for name in whole.names if name in COMPONENTS)
    if not named:
        raise refuse(str(place), f"no column is a coordinate (got {', '.join(whole.names)})", f"Name the columns {', '.join(COMPONENTS)}")
    stated = whole.select((whole.names[0], *named))
    chosen = in_si(stated)
    wanted = dict(zip((whole.names[0], *COMPONENTS), ("s", *TWIST_UNITS), strict=True))
    require(
        Finding(
            f"{place}: {after.name}",
            f'wrong unit (got "{before.unit}", expected {wanted[after.name]})',
            f'Use e.g. "{after.name} [u{wanted[after.name]}]"',
        )
        for before, after in zip(stated.channels, chosen.channels, strict=True)
        if after.unit != wanted[after.name]
    )
    return Table(chosen.values[:, 0], chosen.values[:, 1:], named, str(place))
