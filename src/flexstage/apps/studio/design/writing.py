"""Changes of single numbers in the text of a design; all other text is unchanged."""

from __future__ import annotations

import numpy as np

from flexstage.apps.studio.design.reading import design
from flexstage.base.finding import refuse
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.address import get, quantity_of, set_text
from flexstage.mechanism.store import patch

_DIGITS, _EXACT = 6, 12


def write(text: str, file: str, address: str, value: str | float) -> str:
    """Return the text with one number set.

    `value` is a string or a number. A string contains a value with a unit, a formula or a relative change. A number is in SI units, and is
    rounded to six digits. Raises `DesignError` for an unknown address, or if the design would become invalid.
    """
    stated = _tidy(text, file, address, value) if isinstance(value, str) else _shown(text, file, address, value, _DIGITS)
    patched = patch(text, {address: stated}, where=file)
    design(patched, file)
    return patched


def _tidy(text: str, file: str, address: str, value: str) -> str:
    """The user's text; for a change in percent, the resulting number."""
    if not value.strip().endswith("%"):
        return value
    found = set_text(design(text, file), address, value)
    return _shown(text, file, address, float(get(found, address)), _EXACT)


def _shown(text: str, file: str, address: str, value: float, digits: int) -> str:
    if not np.isfinite(value):
        raise refuse(address, "must be finite", "Use a finite value")
    found = design(text, file)
    if get(found, address) is None:
        raise refuse(address, "missing in the design", "Add the number to the text first")
    return show(value, quantity_of(found, address), digits=digits)
