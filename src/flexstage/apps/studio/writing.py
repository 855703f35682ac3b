"""Changes of a design's text: single numbers written into it, everything else left as it is."""

from __future__ import annotations

import contextlib
import re

import numpy as np

from flexstage.apps.studio.engine import Written
from flexstage.apps.studio.reading import design
from flexstage.base.finding import DesignError, refuse
from flexstage.base.unit import show
from flexstage.mechanism.address import get, quantity_of, set_text
from flexstage.mechanism.store import patch
from flexstage.mechanism.store.lines import line_numbers, line_of

_DIGITS, _EXACT = 6, 12


def write(text: str, file: str, address: str, value: str | float) -> str:
    """The text with a number set: a text in any unit of its quantity, a formula or a change; or an SI number, to six digits.

    Raises `DesignError` in the checks' words where that is no such number, or where the design would not be one any more.
    """
    return written(text, file, address, value).text


def written(text: str, file: str, address: str, value: str | float) -> Written:
    """The same, with what was set."""
    stated = _tidy(text, file, address, value) if isinstance(value, str) else _shown(text, file, address, value, _DIGITS)
    quick = "" if isinstance(value, str) else _in_its_line(text, address, stated)
    with contextlib.suppress(DesignError):
        if quick and design(quick, file) == set_text(design(text, file), address, stated):
            return Written(quick, stated)
    patched = patch(text, {address: stated}, where=file)
    is_followed = design(patched, file) == set_text(design(text, file), address, stated)
    return Written(patched, stated if is_followed else "")


def _in_its_line(text: str, address: str, stated: str) -> str:
    """The text with another value between the quotes behind its key; nothing where its line is not so. It may be another value's.

    It is what `patch` writes of a value in its shown unit, sooner; that finds its way in any layout and takes out tags.
    """
    line = line_of(address, line_numbers(text))
    rows = text.split("\n")
    key = re.escape(address.rpartition(".")[2])
    quoted = [] if line is None else list(re.finditer(rf'(?<![\w."-]){key} *= *"([^"\\]*)"', rows[line - 1]))
    if line is None or len(quoted) != 1 or '"' in stated or "\\" in stated:
        return ""
    start, end = quoted[0].span(1)
    rows[line - 1] = rows[line - 1][:start] + stated + rows[line - 1][end:]
    return "\n".join(rows)


def _tidy(text: str, file: str, address: str, value: str) -> str:
    """What a person wrote; of a change in percent the number that it comes to."""
    if not value.strip().endswith("%"):
        return value
    found = set_text(design(text, file), address, value)
    return _shown(text, file, address, float(get(found, address)), _EXACT)


def _shown(text: str, file: str, address: str, value: float, digits: int) -> str:
    if not np.isfinite(value):
        raise refuse(address, "it is not finite", "Give it a value")
    found = design(text, file)
    if get(found, address) is None:
        raise refuse(address, "the description does not state it", "Write it into the text first")
    return show(value, quantity_of(found, address), digits=digits)
