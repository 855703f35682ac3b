"""The report: one file that stands alone, escapes, repeats itself to the byte and stays small."""

from __future__ import annotations

import base64
import hashlib
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections import Counter
from html.parser import HTMLParser
from importlib import resources

import pytest

from flexstage.analysis.complete import Model, analyse
from flexstage.base.storage.digest import digest
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.figures.style import THEME
from flexstage.show.report import report
from tests.show.stages import HOSTILE, NAMES, analysed, hostile, reported

LARGEST = 2_000_000
SCRIPT = re.compile(r"(<script(?: type=\"application/json\" id=\"[a-z]+\")?>)(.*?)</script>", re.DOTALL)
"""What the page runs, and the data of its viewers."""
SVG = re.compile(r"<svg.*?</svg>", re.DOTALL)
LOADS = re.compile(
    r"""(?:src|href|data|action)\s*=\s*(?:["'](?!\#|data:image/png;)|(?![\s"']))|@import|url\((?!["']?\#)|https?://|<(?:script\s+src|link|iframe|object|img)\b"""
)
VOID = {"meta", "br", "hr"}
OWN_SCRIPTS = ['<script type="application/json" id="stage">', "<script>", "<script>"]


class Balance(HTMLParser):
    """Checks that tags close in order, and collects identifiers."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.names: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names += [value or "" for name, value in attrs if name == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:  # noqa: ARG002  the parser's signature
        self.names += [value or "" for name, value in attrs if name == "id"]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


QUICK = ("double-triangle", "parallelogram", "xy-stage-floating")
"""Six axes, one axis, and a stage that its strokes do not determine: the others' reports have no other sections. They are made in full."""


@pytest.mark.parametrize(
    ("name", "model"),
    [
        *(pytest.param(name, Model.LUMPED, marks=() if name in QUICK else pytest.mark.full) for name in NAMES),
        pytest.param("double-triangle", Model.IDEAL, marks=pytest.mark.full),
        ("xy-stage-floating", Model.IDEAL),
    ],
)
def test_every_case_has_a_report_that_stands_alone(name: str, model: Model) -> None:
    page = reported(name, model)
    assert LOADS.findall(SCRIPT.sub("", page)) == []
    assert len(page.encode()) < LARGEST
    found = Balance()
    found.feed(page)
    assert found.open == []
    assert [name for name, count in Counter(found.names).items() if count > 1] == []
    pictures = SVG.findall(SCRIPT.sub("", page))
    assert len(pictures) >= 5
    for picture in pictures:
        root = ET.fromstring(picture.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1))  # noqa: S314  our own text
        assert root.attrib["aria-label"]


@pytest.mark.full
def test_mapped_reading_has_a_report() -> None:
    page = reported("double-triangle", Model.MAPPED)
    assert "110.91" in page
    assert "not stated" not in page


def test_references_inside_the_page_lead_somewhere() -> None:
    page = reported("double-triangle")
    names = set(re.findall(r' id="([^"]+)"', page))
    wanted = set(re.findall(r'href="#([^"]+)"', page)) | set(re.findall(r"url\(#([^)]+)\)", page))
    assert wanted <= names


def test_markup_of_users_is_text() -> None:
    stage = hostile()
    page = report(analyse(stage))
    assert re.findall(r"<script[^>]*>", page) == OWN_SCRIPTS
    assert "&lt;script&gt;" in page
    assert "<i>$" not in page
    assert "&lt;i&gt;$_" in page
    assert HOSTILE not in page


def test_the_same_analysis_gives_the_same_bytes_and_leaves_settings_of_matplotlib_alone() -> None:
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    assert report(analysed("parallelogram")) == reported("parallelogram")
    assert dict(mpl.rcParams) == before


def test_another_process_gives_the_same_bytes() -> None:
    code = (
        "import sys; from flexstage.cases.registry import case; from flexstage.show.report import report; "
        "from flexstage.analysis.complete import analyse; sys.stdout.buffer.write(report(analyse(case('parallelogram'))).encode())"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "7"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, env=environment)
    assert done.stdout.decode() == reported("parallelogram")


def test_no_date_and_no_path_inside() -> None:
    page = re.sub(r"<path[^>]*>", "", reported("double-triangle"))  # steps of lines may look like dates
    assert not re.search(r"\b20[12]\d-\d\d-\d\d\b", page)
    assert os.getcwd() not in page  # noqa: PTH109


def test_verdicts_come_first_and_failures_before_the_rest() -> None:
    stage = case("parallelogram")
    changed = {"stroke.x": "at least 10 um", "frequency.platform.1": "at least 5 kHz"}
    page = report(analyse(_required(stage, changed)))
    failed = page.index('<p class="headline fail">1 of 2 requirements are met. Not met: frequency.platform.1 (')
    assert failed < page.index("<h2>The stage</h2>") < page.index("<h2>Requirements</h2>")
    assert page.index('class="strong">frequency.platform.1') < page.index('class="strong">stroke.x')


def test_the_page_begins_with_what_it_comes_to_and_ends_with_what_it_was_made_from() -> None:
    page = reported("double-triangle")
    titles = re.findall(r"<h2>([^<]+)</h2>", page)
    assert [each for each in titles if each != "Warnings"][:3] == ["The stage", "Requirements", "Summary"]
    assert titles[-1] == "Made from"
    assert page.index('class="headline pass">All 8 requirements are met') < page.index("<svg ") < page.index("<table")
    assert page.index(digest(case("double-triangle"), physics=True)[:16]) > page.rindex("</table>")


def test_the_value_stands_beside_the_name_of_its_requirement() -> None:
    row = re.search(r'<tr><th scope="row" class="strong">frequency.platform.1</th><td[^>]*>([^<]+)</td>', reported("double-triangle"))
    assert row is not None
    assert row[1] == "106.01 Hz"


def test_printed_modes_are_told_apart_and_played_by_the_viewer() -> None:
    page = reported("double-triangle")
    told = re.findall(r'<figure data-play="mode (\d+)">.*?<figcaption>([^<]+)</figcaption>', page)
    assert [number for number, _ in told] == ["1", "2", "3", "4", "5", "6"]
    assert told[2][1] == "3: z, 126.16 Hz; kinetic energy: platform 87.5 %, B4 3.5 %, B5 3.5 %, B6 3.5 %"
    arrows = [re.findall(r">(r?[xyz])</text>", picture) for picture in re.findall(r'<svg[^>]*aria-label="\d: .*?</svg>', page, re.DOTALL)]
    assert [names[-1] for names in arrows] == ["rx", "ry", "z", "rz", "ry", "rx"]  # the names before are those of the axes


def test_the_policy_of_the_page_allows_its_own_script_alone() -> None:
    page = reported("parallelogram")
    run = [text for tag, text in SCRIPT.findall(page) if tag == "<script>"]
    said = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(each.encode()).digest()).decode()}'" for each in run)
    assert f"default-src 'none'; script-src {said};" in page


def _required(stage: Mechanism, requirements: dict[str, str]) -> Mechanism:
    from dataclasses import replace

    return replace(stage, requirements=requirements)


def test_every_colour_that_figures_take_from_the_page_is_there_in_light_and_dark() -> None:
    """A colour of the light page on the dark one cannot be read."""
    style = resources.files("flexstage.show").joinpath("static/report.css").read_text(encoding="utf-8")
    assert {name: len(re.findall(rf"--{name}: ", style)) >= 2 for name in THEME.values()} == dict.fromkeys(THEME.values(), True)
