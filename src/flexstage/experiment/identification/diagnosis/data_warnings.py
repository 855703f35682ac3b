"""Warnings on the limits of the data for identified modes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.identification.diagnosis.adequacy import Reach, coarse_lines, no_mode_warning, unsearched_band
from flexstage.experiment.identification.evidence import Evidence
from flexstage.experiment.records.unit import derivative_order

_MOST_ELSEWHERE = 0.5


def data_warnings(
    known: Evidence, poles: Array, close: tuple[tuple[int, ...], ...], *, elsewhere: Array, widening: Array, reach: Reach
) -> Iterator[str]:
    """Collect warnings: few or coarse frequency lines, no identified mode, hidden repeated modes, unrecorded forces.

    `poles` (k,) are in Hz; `close` are the indices of close modes by group. `elsewhere` (k,) is the fraction of each mode's motion that the
    recorded inputs do not explain, and `widening` (k,) the inflation factor of the intervals.

    >>> from flexstage.experiment.identification.evidence import evidence
    >>> from flexstage.experiment.example import POLE, one_mode_record
    >>> known, reach = evidence(one_mode_record(), None), Reach(1.0, 26.0)
    >>> next(data_warnings(known, np.array([POLE]), (), elsewhere=np.zeros(1), widening=np.ones(1), reach=reach))[:20]
    'only u was driven: o'
    """
    limits = (unsearched_band(known, reach), coarse_lines(known, poles), None if len(poles) else no_mode_warning(known, reach))
    yield from filter(None, limits)
    outputs, inputs = known.responses.values.shape[1:]
    listed = ", ".join(f"{abs(pole):.4g}" for pole in poles[:8]) + (" ..." if len(poles) > 8 else "")
    if inputs == 1 and len(poles):
        yield (
            f"only {known.responses.inputs[0].name} was driven: one input shows only one combination of repeated modes, so each mode found "
            f"({listed} Hz) may represent several. Add records with other inputs driven."
        )
    if outputs == 1 and len(poles):
        yield (
            f"{known.responses.outputs[0].name} is the only output: shapes cannot be identified, and repeated modes cannot be separated."
        )
    for group in close:
        if inputs > 1 and len(group) >= min(inputs, outputs):
            near = ", ".join(f"{abs(poles[index]):.5g}" for index in group)
            yield f"{min(inputs, outputs)} inputs or outputs cannot show further modes near {near} Hz. Add inputs and outputs."
    systematic = np.flatnonzero(widening > 1.0)
    if len(systematic):
        listed = ", ".join(f"{abs(poles[index]):.5g} Hz (intervals {widening[index]:.2g} times wider)" for index in systematic)
        window = " The window of the responses is unknown; if a window was used, damping is too large." if known.unstated else ""
        yield (
            f"the fit leaves a systematic residual near {listed}. The mode may be nonlinear, close to another, excited by unrecorded "
            f"forces, or changing during the test. Test with a lower amplitude, a longer duration or finer frequency lines.{window}"
        )
    moved = [channel for channel in known.responses.inputs if derivative_order(channel.unit)]
    if moved:
        listed = ", ".join(f"{channel.name} ({channel.unit})" for channel in moved)
        yield (
            f"inputs that are motions: {listed}. The modes are those of the stage with this motion fixed, which is correct only for ground "
            "excitation. Record forces or strokes instead."
        )
    shaken = np.flatnonzero(elsewhere > _MOST_ELSEWHERE)
    if len(shaken):
        listed = ", ".join(f"{abs(poles[index]):.5g} Hz ({1.0 - elsewhere[index]:.0%})" for index in shaken)
        yield (f"recorded inputs explain less than half of the motion in modes at {listed}. Record all excitation, or increase the drive.")
