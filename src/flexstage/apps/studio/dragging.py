"""Frequencies while a slider moves: by the batch engine, whose plan is fitted over the slider's range beforehand."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from flexstage.apps.studio.design.reading import design
from flexstage.models.batch.engine import Plan, plan, platform_modes


def fit(text: str, file: str, address: str, low: float, high: float) -> bool:
    """Fit a plan over a range, and try it once: the first design of a plan takes longer."""
    found = _fitted(text, file, address, low, high)
    platform_modes(found, np.array([[0.5 * (low + high)]]))
    return found.surface is not None


def drag(text: str, file: str, address: str, value: float, ends: tuple[float, float] | None) -> tuple[float | None, ...]:
    """The platform's frequencies [Hz] of the design with a number of that value; with `ends` by the plan that was fitted between them."""
    found = _plain(text, file, address) if ends is None else _fitted(text, file, address, *ends)
    return tuple(None if np.isnan(each) else float(each) for each in platform_modes(found, np.array([[value]])).frequencies[0])


@lru_cache(maxsize=4)
def _fitted(text: str, file: str, address: str, low: float, high: float) -> Plan:
    return plan(design(text, file), (address,), ranges=(np.array([low]), np.array([high])))


@lru_cache(maxsize=4)
def _plain(text: str, file: str, address: str) -> Plan:
    return plan(design(text, file), (address,))
