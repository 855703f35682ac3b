"""Pictures of the pages: each exists, each is drawn by `make pictures`, none is drawn in vain; links between pages lead somewhere."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import pytest

from tests.docs.pages import pages
from tests.hygiene.source import ROOT, expect_none
from tools.pictures import DRAWN, PICTURES, hinge_errors, standing_alone

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
    assert shown == set(DRAWN) == {path.stem for path in PICTURES.glob("*.svg")}


@pytest.mark.parametrize("name", DRAWN)
def test_pictures_stand_alone(name):
    root = ET.parse(PICTURES / f"{name}.svg").getroot()  # noqa: S314 (our own files)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert "var(" not in (PICTURES / f"{name}.svg").read_text(encoding="utf-8")
    assert root.get("aria-label") == DRAWN[name][1]


def test_the_same_picture_is_drawn_again():
    from flexstage.present.figures.export import to_svg

    name = "hinge-errors"
    assert standing_alone(to_svg(hinge_errors(), name, DRAWN[name][1])) == (PICTURES / f"{name}.svg").read_text(encoding="utf-8")
