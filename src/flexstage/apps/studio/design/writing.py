"""Changes of a design's text: single numbers written into it, everything else left as it is."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from flexstage.apps.studio.design.answers import Written
from flexstage.apps.studio.design.reading import design, keep
from flexstage.base.finding import DesignError, refuse
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.address import get, quantity_of, set_text
from flexstage.mechanism.checks import require_valid
from flexstage.mechanism.grammar.formulas import NUMBERS
from flexstage.mechanism.store import patch
from flexstage.mechanism.store.file import parse_toml
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
        if quick and _is_another(text, quick, file, address, stated):
            return Written(quick, stated)
    patched = patch(text, {address: stated}, where=file)
    is_followed = design(patched, file) == set_text(design(text, file), address, stated)
    return Written(patched, stated if is_followed else "")


def _is_another(text: str, quick: str, file: str, address: str, stated: str) -> bool:
    """Whether a text is the design of another one with a number set. Raises `DesignError` where it is none.

    Where both say the same but for this value, nothing is worked out of it and no tag is lost with it, it is not read number by number.
    """
    before = design(text, file)
    after = set_text(before, address, stated)
    steps = tuple(address.split("."))
    is_plain = steps[0] != NUMBERS and len(after.tags) == len(before.tags)
    if not is_plain or not _differ_alone(parse_toml(text, file), parse_toml(quick, file), steps, stated):
        return design(quick, file) == after
    keep(quick, file, lambda: require_valid(after))
    return True


def _differ_alone(before: Any, after: Any, steps: tuple[str, ...], stated: str) -> bool:
    """Whether two trees differ by one value alone, and which the other one has."""
    if not steps:
        return bool(after == stated)
    if isinstance(before, list) and isinstance(after, list) and steps[0] in _PLACES:
        before, after = (dict(zip(_PLACES, each, strict=False)) for each in (before, after))
    key, rest = steps[0], steps[1:]
    if not isinstance(before, dict) or not isinstance(after, dict) or key not in before or before.keys() != after.keys():
        return False
    return _differ_alone(before[key], after[key], rest, stated) and all(before[name] == after[name] for name in before if name != key)


_QUOTED = r'"([^"\\]*)"'
_PLACES = "xyz"


def _in_its_line(text: str, address: str, stated: str) -> str:
    """The text with another value between the quotes behind its key, or in the list there; nothing where its line is not so.

    It may be another value's. It is what `patch` writes of a value in its shown unit, sooner; that finds its way in any layout and takes
    out tags.
    """
    line = line_of(address, line_numbers(text))
    spans = [] if line is None else list(_spans(text.split("\n")[line - 1], address.split(".")))
    if line is None or len(spans) != 1 or '"' in stated or "\\" in stated:
        return ""
    rows, (start, end) = text.split("\n"), spans[0]
    rows[line - 1] = rows[line - 1][:start] + stated + rows[line - 1][end:]
    return "\n".join(rows)


def _spans(row: str, steps: list[str]) -> Iterator[tuple[int, int]]:
    """Where a value may stand in a row: behind its key, or at its place in the list of three behind the key of that."""
    if steps[-1] not in _PLACES:
        yield from (found.span(1) for found in re.finditer(rf"{_key(steps[-1])}{_QUOTED}", row))
    elif len(steps) > 1:
        three = " *, *".join([_QUOTED] * 3)
        yield from (found.span(1 + _PLACES.index(steps[-1])) for found in re.finditer(rf"{_key(steps[-2])}\[ *{three} *\]", row))


def _key(name: str) -> str:
    return rf'(?<![\w."-]){re.escape(name)} *= *'


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
