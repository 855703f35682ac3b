"""Tables of modes."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.modes import Modes
from flexstage.base.labelled import NOISE
from flexstage.show.display import align_numbers, percent
from flexstage.show.table import Cell, Column, Mark, Table, batch_note, first_design, make_table

_FURTHER = 3


def mode_table(modes: Modes) -> Table:
    """Frequencies, names, platform shares and planes of the platform's modes and of every mode up to three beyond the last local one.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> mode_table(fs.modes(fs.lumped(double_triangle()))).texts()[3]
    ['3', '126.16', 'z', '87.47 %', 'out of plane', 'platform']
    """
    listed = listed_modes(modes)
    frequencies = align_numbers([float(value) for value in first_design(modes.frequencies, 1)[list(listed)]], 5)
    share = first_design(modes.share, 1)
    rows = [
        (
            Cell(str(index + 1), Mark.STRONG),
            Cell(frequency),
            Cell(modes.names[index]),
            Cell(percent(_zero_if_noise(float(share[index]))), bar=float(share[index])),
            Cell("in plane" if modes.in_plane[index] else "out of plane"),
            _role(modes, index),
        )
        for index, frequency in zip(listed, frequencies, strict=True)
    ]
    heads = [Column("mode"), Column("frequency", "Hz"), "name", Column("platform's share"), "plane", "role"]
    notes = [margin_text(modes), *_partial(modes), *_unlisted(modes, listed), *batch_note(modes.frequencies, 1)]
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
    last = max((*modes.platform, *modes.local), default=-1)
    return tuple(range(min(len(modes.names), last + 1 + _FURTHER)))


def _role(modes: Modes, index: int) -> Cell:
    if index in modes.platform:
        return Cell("platform", Mark.PASS)
    return Cell("local neighbour", Mark.WARN) if index in modes.local else Cell("local", Mark.FAINT)


def margin_text(modes: Modes) -> str:
    """How the platform's modes were told from the others, and by what margin.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> margin_text(fs.modes(fs.lumped(double_triangle())))[:62]
    "The platform's modes are the 6 with the largest share of kinet"
    """
    least = float(np.min(first_design(modes.share, 1)[list(modes.platform)])) if modes.platform else 0.0
    chosen = f"The platform's modes are the {len(modes.platform)} with the largest share of kinetic energy in the platform"
    below = f" below {modes.limit:g} Hz" if np.isfinite(modes.limit) else ""
    return f"{chosen}{below}: at least {percent(least, 3)} each, {percent(modes.margin, 3)} in the next one."


def _partial(modes: Modes) -> list[str]:
    most = f"The lowest {len(modes.names)} modes of {len(modes.coordinates):,} freedoms were computed: the platform's are those among them."
    return [most] if modes.partial else []


def _unlisted(modes: Modes, listed: tuple[int, ...]) -> list[str]:
    rest = len(modes.names) - len(listed)
    return [f"{rest} higher modes were computed and are not listed."] if rest > 0 else []
