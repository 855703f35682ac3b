"""docs/validation says what the code computes now; what disagrees is what is recorded."""

from __future__ import annotations

import math
import re

import pytest

from tools.validation import laws
from tools.validation.page import DOCS, chapters, summary, unexpected
from tools.validation.row import Row, Tolerance, Verdict, beam_error, relative

NUMBER = re.compile(r"[+-]?\d+\.?\d*(?:e[+-]?\d+)?")
ROUNDING = 1e-8
"""Numbers as small as this are differences left by rounding: they vary from one machine to the next."""

ELSEWHERE = ("codes", "laws", "records")
"""Pages that change with what is installed, with every new law, and with the last digit of long sums; `make check-all` writes them."""


@pytest.fixture(scope="module")
def found():
    return chapters()


def test_nothing_disagrees_but_what_is_recorded(found):
    assert unexpected(found) == []


def test_the_pages_are_those_of_today(found):
    pages = {f"validation/{chapter.name}.md": chapter.markdown() for chapter in found if chapter.name not in ELSEWHERE}
    pages["validation.md"] = summary(found)
    for name, text in pages.items():
        kept = (DOCS / name).read_text(encoding="utf-8")
        old, new = (_without_versions(each) for each in (kept, text))
        assert _same(old, new), f"docs/{name} is not what the code computes: run make validation\n{_first_difference(old, new)}"


def _without_versions(text):
    """Without what depends on the machine: versions, counts of other codes, and rounding noise as it is printed."""
    machine = ("Computed at", "| [Independent codes]", "| **all**")
    return "\n".join(line.replace("< 1e-12", "+1e-12") for line in text.splitlines() if not line.startswith(machine))


def _same(old, new):
    """Equal words, numbers equal to five digits or both rounding noise."""
    numbers = [[float(each) for each in NUMBER.findall(text)] for text in (old, new)]
    return NUMBER.split(old) == NUMBER.split(new) and all(
        math.isclose(one, other, rel_tol=1e-5, abs_tol=ROUNDING) or max(abs(one), abs(other)) < ROUNDING
        for one, other in zip(*numbers, strict=True)
    )


def _first_difference(old, new):
    pairs = zip(old.splitlines(), new.splitlines(), strict=False)
    return next((f"page: {one}\nnow:  {other}" for one, other in pairs if not _same(one, other)), "they differ in length")


@pytest.mark.parametrize(
    ("row", "verdict"),
    [
        (Row("a", "", "15.45", 15.4549), Verdict.AGREES),
        (Row("a", "", "15.45", 15.4551), Verdict.DISAGREES),
        (Row("a", "", "2e-5", 2.04e-5, tolerance=relative(0.03)), Verdict.AGREES),
        (Row("a", "", "2", 2.1, tolerance=Tolerance(0.2), recorded=True), Verdict.UNEXPECTED),
        (Row("a", "", "2", 2.3, tolerance=Tolerance(0.2), recorded=True), Verdict.RECORDED),
        (Row("a", "", "100", 90.0, tolerance=beam_error(-10.0)), Verdict.AGREES),
        (Row("a", "", "100", 100.0, tolerance=beam_error(-10.0)), Verdict.DISAGREES),
        (Row("a", "", "100", math.nan), Verdict.DISAGREES),
        (Row("a", "", "100", 140.0, least=True), Verdict.AGREES),
        (Row("a", "", "100", 99.9, least=True), Verdict.DISAGREES),
        (Row("a", "", "100", math.nan, least=True), Verdict.DISAGREES),
    ],
)
def test_verdicts(row, verdict):
    assert row.verdict is verdict


def test_laws_are_listed_with_the_examples_that_they_are_tried_on():
    listed = "\n".join(section.markdown() for section in laws.sections())
    assert "whatever the idle ones weigh. | 8 (`make check-all`: 80) |" in listed
    assert "elimination orders any graph | 20 (`make check-all`: 200) |" in listed
