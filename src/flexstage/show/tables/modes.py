"""Tables of modes."""

from __future__ import annotations

from flexstage.analysis.dynamics.modes import Modes
from flexstage.base.labelled import NOISE
from flexstage.models.batch.choice import THRESHOLD
from flexstage.show.display import align_numbers, percent
from flexstage.show.table import Cell, Column, Mark, Table, batch_note, first_design, make_table

PLATFORM_MODES = (
    f"With a platform mode, one more direction of the platform has {percent(THRESHOLD, 2)} of its compliance from the modes so far."
)
"""Which modes are the platform's."""

_FURTHER = 3


def mode_table(modes: Modes) -> Table:
    """Frequencies, names, shares and planes of the platform's modes and of every mode up to three beyond the last local one.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> mode_table(fs.modes(fs.lumped(double_triangle()))).texts()[3]
    ['3', '126.16', 'z', '87.47 %', '99.74 %', 'out of plane', 'platform']
    """
    listed = listed_modes(modes)
    frequencies = align_numbers([float(value) for value in first_design(modes.frequencies, 1)[list(listed)]], 5)
    shares = first_design(modes.share, 1), first_design(modes.compliance_share, 1)
    rows = [
        (
            Cell(str(index + 1), Mark.STRONG),
            Cell(frequency),
            Cell(modes.names[index]),
            *(Cell(percent(_zero_if_noise(float(share[index]))), bar=float(share[index])) for share in shares),
            Cell("in plane" if modes.in_plane[index] else "out of plane"),
            _role(modes, index),
        )
        for index, frequency in zip(listed, frequencies, strict=True)
    ]
    heads = [Column("mode"), Column("frequency", "Hz"), "name", Column("platform's share"), Column("compliance share"), "plane", "role"]
    notes = [PLATFORM_MODES, *_partial(modes), *_unlisted(modes, listed), *batch_note(modes.frequencies, 1)]
    return make_table("Modes", heads, rows, notes=notes, provenance=modes.provenance)


def _zero_if_noise(share: float) -> float:
    """A share without rounding noise."""
    return share if share > NOISE else 0.0


def listed_modes(modes: Modes) -> tuple[int, ...]:
    """Indices of the modes that tables show.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(listed_modes(fs.modes(fs.lumped(double_triangle()))))
    15
    """
    last = max((*modes.platform, *modes.local), default=modes.listed)
    return tuple(range(min(len(modes.names), last + 1 + _FURTHER)))


def _role(modes: Modes, index: int) -> Cell:
    if index in modes.platform:
        return Cell("platform", Mark.PASS)
    return Cell("local neighbour", Mark.WARN) if index in modes.local else Cell("local", Mark.FAINT)


def _partial(modes: Modes) -> list[str]:
    most = f"The lowest {len(modes.names)} modes of {len(modes.coordinates):,} freedoms were computed: the platform's are those among them."
    return [most] if modes.partial else []


def _unlisted(modes: Modes, listed: tuple[int, ...]) -> list[str]:
    rest = len(modes.names) - len(listed)
    return [f"{rest} higher modes were computed and are not listed."] if rest > 0 else []
