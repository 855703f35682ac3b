"""The gallery shows every case, with the numbers of today."""

from __future__ import annotations

import re

import pytest

from flexstage.cases.registry import CASES
from tools.gallery import ALIKE, PAGE, page


def test_every_case_is_shown_or_a_variant():
    shown = re.findall(r"^## (.+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted([*shown, *ALIKE]) == sorted(CASES)


@pytest.mark.full
def test_the_gallery_is_that_of_today():
    assert page() == PAGE.read_text(encoding="utf-8"), "python -m tools.gallery writes it anew"
