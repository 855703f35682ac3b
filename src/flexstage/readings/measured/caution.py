"""What the evidence cannot tell of modes, in words."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.readings.measured.evidence import Evidence


def warnings(known: Evidence, poles: Array, close: tuple[tuple[int, ...], ...]) -> tuple[str, ...]:
    """Cautions about modes found at `poles` (Hz): none found at all, repeated ones that so few inputs or outputs cannot show.

    >>> from flexstage.readings.measured.evidence import evidence
    >>> from flexstage.readings.measured.example import POLE, one_mode_record
    >>> warnings(evidence(one_mode_record(), None), np.array([POLE]), ())[0][:20]
    'only u was driven: o'
    """
    found: list[str] = []
    if not len(poles):
        found.append(_nothing(known))
    outputs, inputs = known.responses.values.shape[1:]
    listed = ", ".join(f"{abs(pole):.4g}" for pole in poles[:8]) + (" ..." if len(poles) > 8 else "")
    if inputs == 1 and len(poles):
        found.append(
            f"only {known.responses.inputs[0].name} was driven: of a repeated pair it shows one combination only, so that each mode found "
            f"({listed} Hz) may stand for several. Add records with other inputs driven."
        )
    if outputs == 1 and len(poles):
        found.append(f"{known.responses.outputs[0].name} is the only output: shapes cannot be told, nor repeated modes apart.")
    for group in close:
        if inputs > 1 and len(group) >= min(inputs, outputs):
            near = ", ".join(f"{abs(poles[index]):.5g}" for index in group)
            found.append(f"as many modes as inputs or outputs lie together ({near} Hz): there may be more. Add inputs and outputs.")
    return tuple(found)


def _nothing(known: Evidence) -> str:
    if known.coherence is None:
        return "no mode stands out of the noise."
    low, high = known.band
    inside = (known.responses.frequencies >= low) & (known.responses.frequencies <= high)
    mean = float(np.mean(known.coherence[inside]))
    chance = known.responses.values.shape[2] / max(known.averages, 1.0)
    return (
        f"no mode stands out of the noise: inputs explain {mean:.1%} of the outputs' power on the mean, and would explain {chance:.1%} of "
        "noise that has nothing to do with them."
    )
