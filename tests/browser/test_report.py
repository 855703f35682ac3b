"""Reports in a browser: nothing is asked for, tables are copied and saved as they stand, a phone scrolls down only, print has pictures."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page

import flexstage as fs
from tests.browser.conftest import Open
from tests.show.stages import reported


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "guide.html"
    path.write_text(reported("parallelogram"), encoding="utf-8")
    return path


def cells(page: Page, table: int) -> list[list[str]]:
    """What the page shows of a table that is not folded away."""
    rows = f"[...document.querySelectorAll('div.table table')].filter(each => each.checkVisibility())[{table}].rows"
    return page.evaluate(f"[...{rows}].map(row => [...row.cells].map(cell => cell.innerText))")


def plain(text: str) -> str:
    return text.replace("\u2212", "-").replace("\n", " ").strip()


def test_a_report_is_whole_and_begins_with_its_verdict(opened: Open, file: Path) -> None:
    page = opened(file, reduced_motion="reduce")  # the fixture fails it where it asks for anything, or errs
    page.locator("[data-flexstage] canvas").wait_for()
    verdict, stage = (page.locator(each).bounding_box() for each in (".headline", "[data-flexstage]"))
    assert verdict is not None
    assert stage is not None
    assert verdict["y"] + verdict["height"] < stage["y"]
    assert stage["y"] + 0.6 * stage["height"] < 800.0
    assert page.evaluate("document.querySelector('[data-flexstage]').flexstage.probe.webgl")


def test_tables_are_saved_as_they_stand(opened: Open, file: Path, tmp_path: Path) -> None:
    page = opened(file, reduced_motion="reduce", accept_downloads=True)
    buttons = page.get_by_role("button", name="CSV")
    assert buttons.count() == page.locator("div.table:visible").count()
    for number in (0, 3):
        with page.expect_download() as asked:
            buttons.nth(number).click()
        asked.value.save_as(tmp_path / "table.csv")
        with (tmp_path / "table.csv").open(encoding="utf-8-sig", newline="") as lines:
            saved = list(csv.reader(lines))
        shown = [[plain(each) for each in row] for row in cells(page, number)]
        assert saved[1:] == shown[1:]
        assert [each.replace("[", "").replace("]", "") for each in saved[0]] == shown[0]


def test_curves_are_read_by_a_cursor_that_peaks_keep(opened: Open, file: Path) -> None:
    page = opened(file, reduced_motion="reduce")
    page.locator("[data-flexstage] canvas").wait_for()
    figure = page.locator("figure[data-reading]").first
    told, picture = figure.locator(".reading"), figure.locator("svg").bounding_box()
    assert picture is not None
    figure.locator("svg").hover(position={"x": 0.4 * picture["width"], "y": 0.3 * picture["height"]})
    assert " Hz" in told.locator("b").inner_text()
    found = fs.analyse(fs.case("parallelogram")).response
    assert found is not None
    highest = float(np.max(np.abs(found.values[:, [each.name for each in found.outputs].index("platform.x"), 0])))
    figure.locator(".point").first.click(force=True)
    page.mouse.move(0.0, 0.0)
    assert told.locator("b").inner_text().startswith(f"peak of x / B: {highest:.3g} µm/µm at ")
    button = told.get_by_role("button")
    mode = button.inner_text().removeprefix("▶ ").partition(",")[0]
    button.click()
    assert page.evaluate("document.querySelector('[data-flexstage]').dataset.motion") == mode


def test_tables_are_copied_for_spreadsheets(opened: Open, file: Path) -> None:
    page = opened(file, reduced_motion="reduce", permissions=["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy").first.click()
    page.get_by_role("button", name="Copied").first.wait_for()
    copied = [line.split("\t") for line in page.evaluate("navigator.clipboard.readText()").splitlines()]
    assert copied[1:] == [[plain(each) for each in row] for row in cells(page, 0)[1:]]


@pytest.mark.parametrize("scripts", [True, False])
def test_a_phone_scrolls_down_only_and_shows_values_beside_names(opened: Open, file: Path, scripts: bool) -> None:
    page = opened(file, width=390, height=844, reduced_motion="reduce", java_script_enabled=scripts)
    boxes = "['th', 'td'].map(tag => document.querySelector('.stacked tbody tr').querySelector(tag).getBoundingClientRect().toJSON())"
    name, value = (
        page.evaluate(boxes)
        if scripts
        else (page.locator(f".stacked tbody tr:first-child {tag}").first.bounding_box() for tag in ("th", "td"))
    )
    assert 0.0 <= name["x"] < 390.0
    assert value["x"] + value["width"] <= 390.0
    assert 0.0 < value["y"] - name["y"] < 40.0
    if scripts:
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        cut = (
            "[...document.querySelectorAll('div.table')].filter(each => each.checkVisibility() && each.scrollWidth > each.clientWidth + 2)"
        )
        assert page.evaluate(f"{cut}.length") > 0
        # No number ends in the middle. The page marks its tables in the first frame it draws, which may follow the event "load".
        page.wait_for_function(f"() => {cut}.every(each => getComputedStyle(each).maskImage !== 'none')")
    else:
        assert page.locator("[data-flexstage] figure svg").is_visible()
        assert page.locator("button").count() == 0


def test_print_has_pictures_in_place_of_what_turns(opened: Open, file: Path) -> None:
    page = opened(file, reduced_motion="reduce")
    page.locator("[data-flexstage] canvas").wait_for()
    assert not page.locator("[data-flexstage] figure svg").is_visible()
    page.emulate_media(media="print", color_scheme="dark")
    assert page.locator("[data-flexstage] figure svg").is_visible()
    assert page.locator("nav, .tools, button").filter(visible=True).count() == 0
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"


def test_no_table_reaches_beyond_the_paper(opened: Open, file: Path) -> None:
    """A4 between its margins has 182 mm, 688 points of a page."""
    page = opened(file, width=688, height=1000, reduced_motion="reduce")
    page.emulate_media(media="print")
    right = page.evaluate("Math.max(...[...document.querySelectorAll('table')].map(each => each.getBoundingClientRect().right))")
    assert right <= 689.0
