"""Frequencies for a moving slider, from the batch engine."""

from __future__ import annotations

import numpy as np

from flexstage.apps.studio.design.reading import design
from flexstage.base.session import SESSION
from flexstage.models.batch.engine import Plan, plan, platform_modes


def drag(text: str, file: str, address: str, value: float) -> tuple[float | None, ...]:
    """Return the platform frequencies [Hz] of the design with the number at `address` set to `value`."""
    found = platform_modes(_plan(text, file, address), np.array([[value]])).frequencies[0]
    return tuple(None if np.isnan(each) else float(each) for each in found)


@SESSION.keep(4)
def _plan(text: str, file: str, address: str) -> Plan:
    return plan(design(text, file), (address,))
