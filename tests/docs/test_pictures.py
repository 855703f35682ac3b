"""Pictures of the pages: each exists, each is drawn by `make pictures`, none is drawn in vain; links between pages lead somewhere."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import pytest

from tests.analytic import test_paros_weisbord, test_smith_toroid
from tests.analytic.hinges import PERCENT_DIGIT
from tests.docs.pages import pages
from tests.hygiene.source import ROOT, expect_none
from tools.pictures import DRAWN, PICTURES, RASTER, neck_errors, notch_errors

TAKEN = {"studio"}
"""Taken of a running page by tools/studio_picture.py, which needs a browser."""
MEASURED = {"growth"}
"""Drawn of what benchmarks/growth.py measures, which takes half an hour."""
LINK = re.compile(r"!?\[[^\]]*\]\((?!https?:|#)([^)#\s]+)[^)]*\)")


def _targets():
    for page in pages():
        path = ROOT / page
        for target in LINK.findall(re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)):
            yield page, (path.parent / target).resolve()


def test_links_and_pictures_exist():
    expect_none((f"{page}: {target.name}" for page, target in _targets() if not target.exists()), "mend the link")


def test_pictures_are_drawn_and_shown():
    shown = {target.stem for _, target in _targets() if target.parent == PICTURES}
    assert shown == {*DRAWN, *RASTER, *TAKEN, *MEASURED}
    assert {path.stem for path in PICTURES.glob("*.svg")} == {*DRAWN, *MEASURED}
    assert {path.stem for path in PICTURES.glob("*.png")} == {*RASTER, *TAKEN}


@pytest.mark.parametrize("name", DRAWN)
def test_pictures_stand_alone(name):
    root = ET.parse(PICTURES / f"{name}.svg").getroot()  # noqa: S314 (our own files)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert "var(" not in (PICTURES / f"{name}.svg").read_text(encoding="utf-8")
    assert root.get("aria-label") == DRAWN[name][1]


def test_the_drawn_errors_are_those_of_the_reference():
    """Columns of the tables that the finite elements' authority states, to their last digit."""
    full, simplified, schotborgh, x, y = (test_paros_weisbord.TABLE[0].index(value) for value in (-1.95, -1.33, -2.64, -10.04, -4.67))
    rz, smith, axial = (test_smith_toroid.TABLE[0].index(value) for value in (-0.83, -0.46, -2.84))
    drawn = [*notch_errors().values(), *neck_errors().values()]
    tables = [test_paros_weisbord.TABLE] * 5 + [test_smith_toroid.TABLE] * 3
    columns = [x, full, y, simplified, schotborgh, axial, rz, smith]
    for points, table, column in zip(drawn, tables, columns, strict=True):
        for (ratio, value), row in zip(points, table, strict=True):
            assert ratio == row[0]
            assert value == pytest.approx(row[column], abs=PERCENT_DIGIT)
