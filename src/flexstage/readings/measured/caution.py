"""What the evidence cannot tell of modes, in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.readings.measured.adequacy import Reach, not_searched, nothing_found, too_coarse
from flexstage.readings.measured.evidence import Evidence

_MOST_ELSEWHERE = 0.5


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes found: `poles` (k,) in Hz, which lie `close` together, and the share (k,) of motion from `elsewhere`."""

    poles: Array
    close: tuple[tuple[int, ...], ...]
    elsewhere: Array


def warnings(known: Evidence, modes: Modes, reach: Reach) -> tuple[str, ...]:
    """Cautions about modes found: few or coarse lines, none found, repeated ones that few channels cannot show, forces from elsewhere.

    >>> from flexstage.readings.measured.evidence import evidence
    >>> from flexstage.readings.measured.example import POLE, one_mode_record
    >>> warnings(evidence(one_mode_record(), None), Modes(np.array([POLE]), (), np.zeros(1)), Reach(1.0, 26.0))[0][:20]
    'only u was driven: o'
    """
    poles, close = modes.poles, modes.close
    limits = (not_searched(known, reach), too_coarse(known, poles), None if len(poles) else nothing_found(known, reach))
    found = [each for each in limits if each is not None]
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
    shaken = np.flatnonzero(modes.elsewhere > _MOST_ELSEWHERE)
    if len(shaken):
        listed = ", ".join(f"{abs(poles[index]):.5g} Hz ({1.0 - modes.elsewhere[index]:.0%})" for index in shaken)
        found.append(
            f"recorded inputs explain less than half of the motion in a mode: of {listed}. Record what else drives, or drive more."
        )
    return tuple(found)
