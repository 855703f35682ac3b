"""Adequacy of a record: line spacing relative to resonance widths, and searched band relative to the requested band."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.experiment.identification.evidence import Evidence
from flexstage.experiment.spectral.lines import in_band

_BEYOND_CHANCE = 1.5
_FEWEST = 8


@dataclass(frozen=True)
class Reach:
    """Band searched for modes, from `low` to `high` in Hz (both zero if no band is searched), and the requested band, `asked`."""

    low: float
    high: float
    asked: tuple[float, float] | None = None


def line_distance(known: Evidence) -> float:
    """Return the spacing in Hz of the frequency lines of the responses from which candidates are identified.

    >>> from flexstage.experiment.identification.evidence import evidence
    >>> from flexstage.experiment.example import one_mode_record
    >>> round(line_distance(evidence(one_mode_record(), None)), 3)
    0.374
    """
    return float(known.responses.frequencies[1] - known.responses.frequencies[0])


def few_lines(known: Evidence, band: tuple[float, float], count: int) -> list[Finding]:
    """Check that a band has at least the eight lines that a polynomial of order 2 with one input requires.

    >>> from flexstage.experiment.identification.evidence import evidence
    >>> from flexstage.experiment.example import one_mode_record
    >>> print(few_lines(evidence(one_mode_record(), None), (10.0, 10.5), 1)[0])
    record: too few lines from 10 to 10.5 Hz, 0.374 Hz apart (got 1, expected 8). Request a wider band, or record longer.
    """
    if count >= _FEWEST:
        return []
    what = f"too few lines from {band[0]:.4g} to {band[1]:.4g} Hz, {line_distance(known):.3g} Hz apart (got {count}, expected {_FEWEST})"
    return [Finding(known.where, what, "Request a wider band, or record longer")]


def coarse_lines(known: Evidence, poles: Array) -> str | None:
    """Warn if the line spacing exceeds the width of the narrowest mode; `poles` are in Hz.

    Candidates are poles of responses at frequency lines: a mode closer than one line spacing to another mode may be missed. A line spacing
    equal to the half-power bandwidth B = 2 zeta f requires a record of about n / B seconds for n averages.

    >>> from flexstage.experiment.identification.evidence import evidence
    >>> from flexstage.experiment.example import one_mode_record
    >>> short, long = (evidence(one_mode_record(seconds=seconds), None) for seconds in (16.0, 64.0))
    >>> coarse_lines(short, np.array([-0.2 + 10.0j]))[:88]
    'frequency lines too coarse (got a spacing of 1.49 Hz, the mode at 10 Hz is 0.4 Hz wide):'
    >>> coarse_lines(long, np.array([-0.2 + 10.0j])) is None
    True
    """
    widths = -2.0 * np.real(poles)
    distances = known.apart(np.abs(poles)) if known.stored else np.full(len(poles), line_distance(known))
    if not np.any(distances > widths):
        return None
    narrowest = int(np.argmin(widths / distances))
    apart = float(distances[narrowest])
    return (
        f"frequency lines too coarse (got a spacing of {apart:.3g} Hz, the mode at {abs(poles[narrowest]):.4g} Hz is "
        f"{widths[narrowest]:.3g} Hz wide): close modes may be missing. {_advise_length(known, widths[narrowest])}"
    )


def unsearched_band(known: Evidence, reach: Reach) -> str | None:
    """Warn if part of the requested band is not searched.

    >>> from flexstage.experiment.identification.evidence import evidence
    >>> from flexstage.experiment.example import one_mode_record
    >>> unsearched_band(evidence(one_mode_record(), None), Reach(2.0, 26.88, (0.5, 20.0)))
    'modes from 0.5 to 20 Hz are requested; the search covers only 2 to 20 Hz. Record longer.'
    """
    first, last = reach.asked or (np.inf, -np.inf)
    if reach.low <= 1.001 * first and reach.high >= 0.999 * last:
        return None
    low, high = max(reach.low, first), min(reach.high, last)
    could = f"the search covers only {low:.4g} to {high:.4g} Hz" if low < high else "the record covers no part of this band"
    needed = [word for word, missing in (("longer", reach.low > first), ("faster", known.band[1] < last)) if missing]
    return f"modes from {first:g} to {last:g} Hz are requested; {could}. Record {' and '.join(needed) or 'longer'}."


def no_mode_warning(known: Evidence, reach: Reach) -> str:
    """Explain a result without modes: noise only, no resonance, or too short a record.

    >>> from flexstage.experiment.identification.evidence import evidence
    >>> from flexstage.experiment.example import one_mode_record
    >>> no_mode_warning(evidence(one_mode_record(), None), Reach(1.0, 26.0))[:55]
    'no mode can be identified, although inputs explain 85.5'
    """
    middle = float(np.sqrt(reach.low * reach.high))
    apart = line_distance(known)
    seen = (
        f"Modes narrower than the line spacing of {apart:.3g} Hz may be missing: at {middle:.3g} Hz, modes with a damping ratio below "
        f"{apart / (2.0 * middle):.2g}. {_advise_length(known, None)}"
        if middle > 0.0
        else f"Too few frequency lines to search for modes. {_advise_length(known, None)}"
    )
    if known.coherence is None:
        return f"no mode exceeds the noise. {seen}"
    mean = float(np.mean(known.coherence[in_band(known.responses.frequencies, known.band)]))
    chance = known.responses.values.shape[2] / max(known.averages, 1.0)
    told = f"inputs explain {mean:.1%} of the outputs' power on average"
    if mean > _BEYOND_CHANCE * chance:
        return f"no mode can be identified, although {told} ({chance:.1%} is expected by chance). {seen}"
    return f"no mode exceeds the noise: {told}; {chance:.1%} is expected by chance. {seen}"


def _advise_length(known: Evidence, wanted: float | None) -> str:
    """Advice: record length for a line spacing of `wanted` Hz with the same averages."""
    if known.coherence is None:
        return "Measure with a finer line spacing." if wanted is None else f"Measure with a line spacing of {wanted:.2g} Hz."
    lasts = 1.0 / known.resolution
    if wanted is None:
        return f"Record for more than {lasts:.3g} s."
    return f"Record for at least {_round_up(lasts * line_distance(known) / wanted):.3g} s (got {lasts:.3g} s)."


def _round_up(value: float) -> float:
    """Round up to two digits."""
    unit = 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(np.ceil(value / unit) * unit)
