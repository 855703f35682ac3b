"""Tables of modes."""

from __future__ import annotations

from flexstage.analysis.dynamics.modes import Modes
from flexstage.models.batch.choice import THRESHOLD
from flexstage.show.display import percent
from flexstage.show.table import Table, batch_note, result_table

PLATFORM_MODES = f"Each platform mode adds a direction in which modes up to it reach {percent(THRESHOLD, 2)} of the platform compliance."
"""Note on the criterion for platform modes."""

_FURTHER = 3


def mode_table(modes: Modes) -> Table | None:
    """Tabulate frequencies, names, energy fractions and planes of modes, up to the third mode above the highest platform or local mode.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> mode_table(fs.modes(fs.lumped(double_triangle()))).texts()[3]
    ['3', '126.16', 'z', '87.47 %', '99.74 %', 'out of plane', 'platform']
    """
    listed = listed_modes(modes)
    notes = [PLATFORM_MODES]
    if modes.partial:
        notes.append(f"Only the lowest {len(modes.names)} modes of {len(modes.coordinates):,} DOFs were computed.")
    if rest := len(modes.names) - len(listed):
        notes.append(f"{rest} higher modes were computed and are not listed.")
    found = tuple(map(modes.mode, listed))
    return result_table(found, notes=[*notes, *batch_note(modes.frequencies, 1)], provenance=modes.provenance)


def listed_modes(modes: Modes) -> tuple[int, ...]:
    """Return the indices of the modes that tables show: up to the third mode above the highest platform or local mode.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(listed_modes(fs.modes(fs.lumped(double_triangle()))))
    15
    """
    last = max((*modes.platform, *modes.local), default=modes.listed)
    return tuple(range(min(len(modes.names), last + 1 + _FURTHER)))
