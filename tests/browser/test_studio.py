"""The studio in a browser, with its real server: one page is loaded, and most checks share it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

import flexstage as fs
from flexstage.models.lumped import lumped
from flexstage.studies.synthesis.specification import load_specification
from tests.apps.studio_page import served as served_studio
from tests.browser.conftest import Watch, browser_path

LEAF = "parts.leaf.thickness"
LOCAL = ("file:", "data:", "blob:", "about:", "http://127.0.0.1:", "ws://127.0.0.1:")
PATIENCE = 120.0  # s: a busy machine is slow, not wrong
EDITOR = "#editor .cm-content"

ServedStage = tuple[str, Path]
Serve = Callable[[str], ServedStage]


SEEN = """() => JSON.stringify([studio.state.value?.problems, studio.tab.value, ...["state", "figures", "verdicts", "reach"].map(
  (each) => studio[each].value?.revision)])"""
"""What the page shows, for the message of a failure."""


def until(page: Page, expression: str, patience: float = PATIENCE) -> object:
    """What an expression comes to be, once it is something. The page's policy forbids strings that the browser would wait for."""
    end = time.monotonic() + patience
    while not (found := page.evaluate(f"() => ({expression})")):
        assert time.monotonic() < end, f"not within {patience:g} s: {expression}; {page.evaluate(SEEN)}"
        page.wait_for_timeout(50)
    return found


def settled(page: Page) -> None:
    """All results are those of the text as it is, and the picture too."""
    until(page, "studio.state.value")
    for each in ("figures", "verdicts"):
        until(page, f"studio.{each}.value?.revision === studio.state.value.revision")
    until(page, "studio.tab.value !== 'figures' || studio.reach.value?.revision === studio.state.value.revision")  # not computed unseen
    until(page, "studio.scene.value && studio.viewer.value")


def slide(page: Page, address: str, share: float) -> None:
    """Takes the slider of a number, moves it in steps to a share of its range and lets it go."""
    page.evaluate(
        """([address, share]) => {
            const slider = document.querySelector(`[data-address="${address}"] input[type=range]`);
            slider.dispatchEvent(new PointerEvent("pointerdown"));
            for (const step of [0.4, 0.45, share]) { slider.value = String(1000 * step); slider.dispatchEvent(new Event("input")); }
            slider.dispatchEvent(new Event("change"));
        }""",
        [address, share],
    )


@pytest.fixture(scope="module")
def serve(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serve]:
    """Starts a studio on a text: its address, and the file."""
    with ExitStack() as stack:

        def start(text: str) -> ServedStage:
            file = tmp_path_factory.mktemp("studio") / "stage.toml"
            file.write_text(text, encoding="utf-8")
            studio, _ = stack.enter_context(served_studio(file))
            return studio.url, file

        yield start


@pytest.fixture(scope="module")
def served(serve: Serve) -> ServedStage:
    return serve(fs.dumps(fs.case("parallelogram")))


@pytest.fixture(scope="module")
def page(browser: Browser, served: ServedStage) -> Iterator[Page]:
    """The studio's page on a guide of two leaves, drawn and settled; no error and no foreign request until its end."""
    watch = Watch(LOCAL)
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    made = watch.over(context.new_page())
    made.goto(served[0])
    settled(made)
    yield made
    context.close()
    assert not watch.errors
    assert not watch.requests


@pytest.fixture(autouse=True)
def _untouched(request: pytest.FixtureRequest) -> Iterator[None]:
    """Every test leaves the text as it found it."""
    yield
    if "page" in request.fixturenames:
        page, (_, file) = request.getfixturevalue("page"), request.getfixturevalue("served")
        undone(page)
        assert page.evaluate("() => studio.state.value.text") == file.read_text(encoding="utf-8")


def undone(page: Page) -> None:
    """Undoes all that is to undo; what is computed then is nobody's business."""
    while page.evaluate("() => studio.state.value.undo"):
        before = page.evaluate("() => studio.state.value.revision")
        page.keyboard.press("Control+z")
        until(page, f"studio.state.value.revision > {before}")


def test_the_token_leaves_the_address_bar_and_figures_stand_there(page: Page) -> None:
    assert "#" not in page.url
    assert "frequency.platform.1" in page.inner_text("#verdicts")
    assert page.locator(".amount").count() > 30
    assert page.locator("#problems .error").count() == 0


def test_figures_after_a_slider_are_the_librarys_and_undo_and_save_keep_the_file_byte_for_byte(page: Page, served: ServedStage) -> None:
    file = served[1]
    original, before = file.read_bytes(), page.evaluate("() => studio.state.value.revision")
    slide(page, LEAF, 0.7)
    until(page, f"studio.state.value.revision > {before}")
    settled(page)
    text = page.evaluate("() => studio.state.value.text")
    frequencies = np.atleast_1d(fs.modes(lumped(fs.loads(text))).frequencies)
    shown = page.evaluate("() => studio.figures.value.modes.map((each) => [each.number, each.frequency])")
    assert len(shown) >= 1
    # the same code on the same text: rounding of one eigenvalue solve
    assert [each for _, each in shown] == pytest.approx([frequencies[number - 1] for number, _ in shown], rel=1e-9)
    assert page.locator(f'[data-address="{LEAF}"].changed .was').inner_text().startswith("was 1 mm")
    page.keyboard.press("Control+s")
    until(page, "studio.state.value.saved")
    assert file.read_bytes() == text.encode() != original
    undone(page)
    page.keyboard.press("Control+s")
    until(page, "studio.state.value.saved")
    assert file.read_bytes() == original


def test_a_click_picks_the_part_that_stands_there_and_shows_its_lines(page: Page) -> None:
    # the middle of the left leaf; the first click may take what stands before it
    x, y = page.evaluate("() => studio.viewer.value.probe.project([-0.025, 0.0325, 0])")
    box = page.locator("#view").bounding_box()
    assert box is not None
    for _ in range(3):
        page.mouse.click(box["x"] + x, box["y"] + y)
        if page.evaluate("() => studio.link.value") == "left":
            break
    until(page, "studio.link.value === 'left' && !document.querySelector('#pane-part').hidden && document.querySelector('#pane-part h3')")
    until(page, "document.querySelector('#pane-part h3').textContent.includes('leaf')")
    until(page, "document.querySelector('#editor').shadowRoot.querySelectorAll('.cm-lit').length > 0")
    assert '"leaf"' in " ".join(page.locator("#editor .cm-lit").all_inner_texts())
    page.keyboard.press("Escape")


def test_a_mode_moves_what_is_drawn(page: Page) -> None:
    page.keyboard.press("0")
    page.wait_for_timeout(100)
    still = page.locator("#view").screenshot()
    page.keyboard.press("1")
    until(page, "studio.viewer.value.probe.motion?.name === '1'")
    page.keyboard.press("Space")
    page.evaluate("() => studio.viewer.value.setPhase(0.25)")
    page.wait_for_timeout(100)
    assert page.locator("#view").screenshot() != still
    assert "mm" in page.inner_text("#motion output")
    page.keyboard.press("Space")
    page.keyboard.press("0")


@pytest.mark.full
def test_jog_reads_gauges_and_says_what_ends_it(page: Page) -> None:
    page.get_by_role("tab", name="Jog").click()
    until(page, "studio.motion.value?.revision === studio.state.value.revision")
    page.evaluate(
        """() => {
            const slider = document.querySelector("#jog .channel input");
            slider.value = slider.max;
            slider.dispatchEvent(new Event("input"));
        }"""
    )
    until(page, "document.querySelector('#jog .beyond').textContent.includes('stroke limit')")
    assert page.locator("#jog .channel.poor").count() > 0
    gauge = page.evaluate("() => studio.motion.value.gauges.values[0][0] * 1.2 * studio.state.value.actuators[0].high")
    assert f"{gauge * 1e6:.3g}" in page.inner_text("#jog .gauges").replace("\u2212", "-")
    page.get_by_role("tab", name="Modes").click()  # the stage is at rest there, as the list says
    until(page, "document.querySelectorAll('.arrows .ideal').length === 0")
    assert {"0", "-0"} >= set(page.evaluate("() => [...document.querySelectorAll('#jog .channel input')].map((each) => each.value)"))


def test_a_mistake_shows_at_its_line_and_the_last_sound_design_stays(page: Page) -> None:
    verdicts = page.inner_text("#verdicts")
    page.locator(EDITOR).click()
    page.keyboard.press("Control+End")
    page.keyboard.type('\n[parts.oops]\nkind = "leaf"')
    until(page, "!studio.state.value.sound")
    line = page.evaluate("() => studio.state.value.problems[0].line")
    lines = page.evaluate("() => studio.state.value.text.split('\\n')")
    assert "oops" in " ".join(lines[line - 2 : line + 1])
    assert f"line {line}" in page.inner_text("#problems")
    assert page.locator("#editor .cm-lint-marker-error").count() >= 1
    assert page.inner_text("#verdicts") == verdicts
    undone(page)
    assert page.locator("#problems .error").count() == 0


def test_a_file_with_an_error_in_its_requirements_opens_with_it_at_its_line(browser: Browser, serve: Serve) -> None:
    """No pane waits for results that never come, and no status is green; the mended text is computed."""
    text = fs.dumps(fs.case("parallelogram"))
    url, _ = serve(text.replace("[requirements]", '[requirements]\n"frequency.platfrm.1" = "at least 3 Hz"'))
    made = browser.new_page()
    made.goto(url)
    until(made, "document.querySelectorAll('#problems .error').length")
    line = 1 + text.splitlines().index("[requirements]") + 1
    assert f"line {line}: requirements.frequency.platfrm.1" in made.inner_text("#problems")
    assert made.locator("#head .good, #text .bar .good").count() == 0
    assert all("the design file has errors" in made.inner_text(each) for each in ("#verdicts", "#pane-figures"))
    made.evaluate("(text) => studio.ask({ kind: 'edit', text, revision: studio.state.value.revision })", text)
    settled(made)
    until(made, "document.querySelector('#engine').classList.contains('good')")
    assert "frequency.platform.1" in made.inner_text("#verdicts")
    made.close()


@pytest.mark.full
def test_two_pages_show_the_same_text_and_one_may_close_in_the_middle(page: Page, served: ServedStage) -> None:
    other = page.context.new_page()
    other.goto(served[0])
    settled(other)
    slide(page, LEAF, 0.55)
    until(other, f"studio.state.value.amounts.some((each) => each.address === '{LEAF}' && each.value !== each.old)")
    slide(other, LEAF, 0.8)
    other.close()
    settled(page)
    undone(page)
    assert page.evaluate("() => studio.connection.state.value") == "open"


@pytest.mark.full
@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1024, 768), (390, 844)])
def test_nothing_is_wider_than_the_window(browser: Browser, served: ServedStage, width: int, height: int, dark: bool) -> None:
    made = browser.new_page(viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light")
    made.goto(served[0])
    settled(made)
    assert made.evaluate("() => document.documentElement.scrollWidth") <= width
    tops = {
        name: made.evaluate(f"() => document.querySelector('#{name}').getBoundingClientRect().top")
        for name in ("verdicts", "stage", "numbers")
    }
    assert width > 760 or tops["numbers"] < tops["verdicts"] < tops["stage"]
    made.close()


@pytest.mark.full
def test_without_webgl_figures_text_and_numbers_live(browser: Browser, served: ServedStage) -> None:
    path = browser_path()
    if path is None:
        pytest.skip("no browser")
    watch = Watch(LOCAL)
    launched = browser.browser_type.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu", "--disable-3d-apis"])
    made = watch.over(launched.new_page())
    made.goto(served[0])
    until(made, "document.body.classList.contains('flat')")
    assert "no WebGL" in made.inner_text("#told")
    assert "stroke.x" in made.inner_text("#verdicts")
    assert made.locator("#editor .cm-line").count() > 5
    launched.close()
    assert not [each for each in watch.errors if "WebGL" not in each]


WIRES = """format = "flexstage 1"
name = "a thousand wires"
max_mode_frequency = "1e5 Hz"

[materials.steel]
like = "SUS420"

[parts.wire]
kind = "rod"
material = "steel"
length = "40 mm"
diameter = "1.5 mm"

[bodies.platform.solids.plate]
shape = "block"
material = "steel"
size = ["300 mm", "300 mm", "10 mm"]
at = ["0 mm", "0 mm", "45 mm"]

[units.wire.links]
wire = { joins = ["ground", "platform"], part = "wire", at = ["0 mm", "0 mm", "0 mm"], along = "x" }

[placements]
W1-W334 = { unit = "wire", polar = { radius = "140 mm", first = "0 deg", facing = "axis", height = "20 mm" } }
V1-V333 = { unit = "wire", polar = { radius = "120 mm", first = "0 deg", facing = "axis", height = "20 mm" } }
X1-X333 = { unit = "wire", polar = { radius = "100 mm", first = "0 deg", facing = "axis", height = "20 mm" } }
"""


@pytest.mark.full
def test_a_stage_of_a_thousand_links_is_drawn_picked_and_turned_and_the_wait_is_told(browser: Browser, serve: Serve) -> None:
    made = browser.new_page(viewport={"width": 1440, "height": 900})
    made.goto(serve(WIRES)[0])
    until(made, "document.querySelector('#engine').textContent !== ''")
    settled(made)
    assert made.evaluate("() => Object.keys(studio.state.value.links).length") == 1000
    x, y = made.evaluate("() => studio.viewer.value.probe.project([0.14, 0, 0.02])")
    before = made.evaluate("() => studio.viewer.value.probe.camera.position")
    box = made.locator("#view").bounding_box()
    assert box is not None
    made.mouse.click(box["x"] + x, box["y"] + y)
    until(made, "studio.link.value?.includes('wire')")
    made.mouse.move(box["x"] + 100, box["y"] + 100)
    made.mouse.down()
    made.mouse.move(box["x"] + 250, box["y"] + 140, steps=4)
    made.mouse.up()
    until(made, f"studio.viewer.value.probe.camera.position[0] !== {before[0]}")
    made.close()


def test_a_stroke_is_computed_plays_and_is_left_with_the_design(page: Page) -> None:
    page.get_by_role("tab", name="Stroke").click()
    page.get_by_role("tab", name="Figures").click()
    (own,) = page.evaluate("() => studio.reach.value.strokes")
    ends = [page.get_by_label(name, exact=True) for name in ("from", "to")]
    assert page.get_by_label("Drive", exact=True).input_value() == "platform.x"
    assert [each.input_value() for each in ends] == [f"{1e6 * own[end]:.4g} um" for end in ("low", "high")]
    ends[0].fill("")
    ends[1].fill("2 mm")
    page.get_by_label("points", exact=True).fill("3")
    page.get_by_role("button", name="compute").click()
    until(page, "studio.viewer.value.probe.motion?.group === 'path'")
    page.get_by_role("button", name="pause", exact=True).last.click()
    seen = []
    for phase in (0.0, 1.0):
        page.evaluate(f"studio.viewer.value.setPhase({phase})")
        seen.append(
            page.evaluate("[studio.viewer.value.picture(), studio.viewer.value.curves.shadowRoot.querySelector('output').textContent]")
        )
    assert [told for _, told in seen] == ["0 mm", "2 mm"]
    assert seen[0][0] != seen[1][0]
    assert "B/" in page.locator("#travel > .beyond").inner_text()  # its stack's hinges are beyond what they bear
    page.get_by_label("to", exact=True).fill("2 Hz")
    page.get_by_role("button", name="compute").click()
    until(page, "document.querySelector('#travel .poor')?.textContent.includes('Hz')")
    page.get_by_role("tab", name="Modes").click()


THICKNESS = "numbers.leaf_thickness"


def drawn(page: Page, address: str, pixels: int, pauses: list[int], *, fine: bool = False) -> str:
    """Drags a slider by pixels, in steps with pauses [ms]; its value in the text, and one more revision."""
    box = page.locator(f'[data-address="{address}"] input[type=range]').bounding_box()
    before = page.evaluate("() => studio.state.value.revision")
    assert box is not None
    x, y = box["x"] + 6, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    if fine:
        page.keyboard.down("Shift")
    for number, pause in enumerate(pauses, start=1):
        page.mouse.move(x + pixels * number / len(pauses), y)
        page.wait_for_timeout(pause)
    assert page.evaluate("() => studio.state.value.revision") == before  # nothing is written before the slider is released
    page.mouse.up()
    page.keyboard.up("Shift")
    until(page, f"studio.figures.value.revision > {before}")
    assert page.evaluate("() => studio.state.value.revision") == before + 1
    return page.evaluate(f"() => studio.state.value.amounts.find((each) => each.address === '{address}').text")


def test_slow_and_fast_drags_end_at_the_same_value_in_one_step_of_undo_within_the_range_that_was_set(page: Page) -> None:
    row = page.locator(f'[data-address="{THICKNESS}"]')
    row.locator(".name").click()
    low, high = row.locator(".ends input").all()
    high.fill("0.5")
    high.press("Enter")
    until(page, "document.querySelector('#notice').textContent.includes('the lower one first')")
    low.fill("0.9 mm")
    high.fill("3")
    high.press("Enter")
    ends = row.locator("input[type=range]").get_attribute("title")
    assert "0.9 mm to 3 mm" in (ends or "")
    found = set[str]()
    for pauses in ([0], [5] * 20, [250, 30, 250]):
        found.add(drawn(page, THICKNESS, 40, pauses))
        assert row.locator("input[type=range]").get_attribute("title") == ends
        page.keyboard.press("Control+z")
        until(page, "!studio.state.value.undo")
    assert len(found) == 1
    assert found != {"1 mm"}
    # with shift a pixel is one step, a thousandth of the range: 2.1 um from the nearest step to 1 mm
    fine = float(drawn(page, THICKNESS, 1, [20], fine=True).removesuffix(" mm"))
    assert fine == pytest.approx(0.9 + 2.1e-3 * (round(0.1 / 2.1e-3) + 1), abs=1e-9)
    row.locator(".name").click()


def test_an_error_in_any_table_is_shown_at_its_line(page: Page) -> None:
    rows = page.evaluate("() => studio.state.value.text.split('\\n')")
    heads = [number for number, row in enumerate(rows) if row.startswith("[")]
    assert len(heads) >= 10
    for number in heads:
        text = "\n".join([*rows[: number + 1], "wrong = true", *rows[number + 1 :]])
        page.evaluate("(text) => studio.ask({ kind: 'edit', text, revision: studio.state.value.revision })", text)
        until(page, f"studio.state.value.problems.length && studio.state.value.text.split('\\n')[{number + 1}] === 'wrong = true'")
        assert f"line {number + 2}:" in page.inner_text("#problems"), rows[number]
        assert page.locator("#head .good, #text .bar .good").count() == 0


def test_the_named_numbers_come_first_and_dependent_ones_show_their_formula(page: Page) -> None:
    assert page.locator("#amounts summary").first.inner_text().startswith("numbers")
    row = page.locator('[data-address="numbers.strut"]')
    assert row.locator(".formula").inner_text() == "= 2*neck_radius + 10 mm + stack_length"
    assert row.locator("input[type=text]").first.input_value() == "54 mm"
    assert row.locator("input[type=range]").is_disabled()


def test_the_effect_of_one_per_cent_has_a_heading_and_sorts(page: Page) -> None:
    until(page, "studio.slopes.value?.revision === studio.state.value.revision")
    head = page.locator("#numbers .effect")
    worst = page.evaluate("() => studio.slopes.value.worst")
    assert head.inner_text() == "effect of 1 %"
    assert f"change of the margin of {worst}" in page.inner_text("#numbers .foot")
    gains = "() => [...document.querySelectorAll('#amounts .buys')].map((each) => Math.abs(Number(each.dataset.gain)))"
    for order in ("descending", "ascending"):
        head.click()
        assert head.get_attribute("aria-sort") == order
        found = page.evaluate(gains)
        assert found == sorted(found, reverse=order == "descending")
        assert max(found) > 0.0
    head.click()
    assert page.locator("#amounts summary").first.inner_text().startswith("numbers")


def test_responses_have_axes_units_and_a_legend_in_words_without_rounding_noise(page: Page) -> None:
    until(page, "document.querySelector('#curves')?.ariaLabel")
    label = page.locator("#curves").get_attribute("aria-label")
    assert label == "Magnitude [m/m, rad/m] and phase [deg] over frequency [Hz]"
    legend = page.inner_text("#response .cursor")
    assert "platform x per stroke of B [m/m]" in legend
    assert "Zero: platform z, platform rotation x, platform rotation y" in legend
    assert page.locator("#response .cursor i").count() == 3


def test_the_constraint_pane_names_the_links_of_each_direction_and_colours_a_redundant_set(page: Page) -> None:
    page.get_by_role("tab", name="Freedom").click()
    until(page, "document.querySelector('#redundant')")
    rows = {each.locator("button").inner_text(): each.inner_text() for each in page.locator("#pane-freedom li").all()}
    assert set(rows) == {*"xyz", "rx", "ry", "rz", "set 1"}
    assert all("constrained by left, right" in rows[name] for name in ("y", "z", "rx", "ry", "rz"))
    assert "left (ry), right (ry)" in rows["set 1"]
    spot = "() => { const { probe } = studio.viewer.value; return probe.pixel(...probe.project([-0.025, 0.0325, 0])); }"
    page.locator("#redundant button").click()
    red, green, blue, _ = page.evaluate(spot)
    assert red > green < blue
    page.locator("#redundant button").click()
    red, green, blue, _ = page.evaluate(spot)
    assert green > red
    page.get_by_role("tab", name="Figures").click()


def test_matrices_have_units_and_no_rounding_noise(page: Page) -> None:
    until(page, "document.querySelector('#pane-figures .matrix')")
    pane = page.locator('#pane-figures [data-group="Stiffness"]')
    assert "fx fy fz over x y z: N/m" in pane.inner_text()
    assert "mx my mz over rx ry rz: N m/rad" in pane.inner_text()
    values = page.evaluate("() => studio.figures.value.stiffness.values")
    scale = np.sqrt(np.abs(values).max(axis=1)[:, None] * np.abs(values).max(axis=0))
    assert np.all((np.abs(values) > 1e-9 * scale) | (np.asarray(values) == 0.0))
    shown = [each.inner_text() for each in pane.locator("tbody tr").first.locator("td").all()]
    assert shown[2:5] == ["0"] * 3


def test_on_a_phone_numbers_come_first(page: Page) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    tops = [
        page.evaluate(f"() => document.querySelector('#{each}').getBoundingClientRect().top") for each in ("numbers", "verdicts", "stage")
    ]
    page.set_viewport_size({"width": 1440, "height": 900})
    assert tops == sorted(tops)


def test_the_distance_between_two_picked_corners_is_that_of_the_design(page: Page) -> None:
    page.keyboard.press("0")
    page.get_by_role("button", name="measure").click()
    box = page.locator("#view").bounding_box()
    assert box is not None
    for corner, inward in (([-0.03, -0.02, 0.0125], 4), ([0.03, -0.02, 0.0125], -4)):
        x, y = page.evaluate("(point) => studio.viewer.value.probe.project(point)", corner)
        page.mouse.click(box["x"] + x + inward, box["y"] + y + 3)
    assert page.inner_text("#measured") == "60 mm x 60, y 0, z 0 mm"
    assert page.locator(".arrows text.measure").text_content() == "60 mm"
    assert page.evaluate("() => studio.link.value") is None
    page.get_by_role("button", name="measure").click()
    assert page.locator(".arrows .measure").count() == 0


def test_a_design_is_begun_from_a_shipped_case_saved_under_another_name_and_opened(browser: Browser, serve: Serve) -> None:
    url, file = serve(fs.dumps(fs.case("parallelogram")))
    made = browser.new_page()
    made.goto(url)
    until(made, "studio.state.value?.name")
    made.locator("#new").click()
    made.get_by_label("shipped case").select_option("leaf-guide")
    made.get_by_label("file name").fill("stage.toml")
    made.get_by_role("button", name="create").click()
    made.get_by_text("stage.toml: file exists. Choose another name.").wait_for()
    made.get_by_label("file name").fill("guide.toml")
    with made.expect_navigation():
        made.get_by_role("button", name="create").click()
    until(made, "window.studio?.state.value?.file === 'guide.toml' && studio.state.value.name === 'leaf guide'")
    made.locator("#save-as").click()
    made.get_by_label("file name").fill("other/guide.toml")
    made.locator("dialog").get_by_role("button", name="save").click()
    made.get_by_text("must be a name that ends in .toml, without a folder").wait_for()
    made.get_by_label("file name").fill("copy.toml")
    made.locator("dialog").get_by_role("button", name="save").click()
    until(made, "studio.state.value.file === 'copy.toml' && studio.state.value.saved")
    assert file.with_name("copy.toml").read_bytes() == file.with_name("guide.toml").read_bytes()
    made.evaluate("() => studio.ask({ kind: 'edit', text: studio.state.value.text + '# mine', revision: studio.state.value.revision })")
    until(made, "!studio.state.value.saved")
    made.locator("#open").click()
    made.get_by_label("file to open").select_option("stage.toml")
    made.locator("dialog").get_by_role("button", name="open").click()
    made.get_by_text("copy.toml: has unsaved changes. Save or discard them first.").wait_for()
    made.get_by_label("discard the unsaved changes").check()
    with made.expect_navigation():
        made.locator("dialog").get_by_role("button", name="open").click()
    until(made, "window.studio?.state.value?.file === 'stage.toml' && !studio.state.value.undo")
    assert "# mine" not in file.with_name("copy.toml").read_text(encoding="utf-8")
    made.close()


def test_a_specification_shows_errors_at_fields_rows_as_pairs_finish_and_an_answer_opens(browser: Browser, serve: Serve) -> None:
    url, file = serve(fs.dumps(fs.case("parallelogram")))
    watch = Watch(LOCAL)
    made = watch.over(browser.new_page(viewport={"width": 1440, "height": 900}))
    made.goto(url)
    until(made, "studio.state.value?.name")
    made.get_by_role("tab", name="Specification").click()
    pane = made.locator("#pane-specification")
    until(made, "document.querySelector('#pane-specification [aria-label=mass]')?.value === '30 g'")
    pane.get_by_label("mass", exact=True).fill("30")
    pane.get_by_label("y", exact=True).fill("5 kg")
    pane.get_by_label("limit").fill("at least 5 mm")
    until(made, "document.querySelectorAll('#pane-specification .fault').length === 3")
    faults = {each: pane.locator("label", has=made.get_by_label(each, exact=True)).locator(".fault").inner_text() for each in ("mass", "y")}
    assert faults["mass"].startswith('unit missing (got "30")')
    assert faults["y"].startswith('must be a displacement (got "5 kg", a mass)')
    pane.get_by_role("button", name="Start design").click()
    made.get_by_text("The specification has errors: correct them first.").wait_for()
    for name, text in {"mass": "40 g", "y": "50 um", "limit": "at least 400 Hz", "like": "PSt 1000/10/150 VS18", "starts": "1"}.items():
        field = pane.get_by_label(name, exact=True)
        field.evaluate("each => { for (let at = each; at; at = at.parentElement) if ('open' in at) at.open = true; }")
        field.fill(text)
    until(made, "!document.querySelector('#pane-specification .fault')")
    pane.get_by_role("button", name="Save as").click()
    made.locator("dialog").get_by_role("button", name="save").click()
    made.locator("dialog").wait_for(state="detached")
    assert load_specification(file.with_name("scanner.toml")).payload.mass == pytest.approx(0.04)

    pane.get_by_label("options").fill("--architecture carriages")
    pane.get_by_role("button", name="Start design").click()
    until(made, "document.querySelector('#pane-specification .pairs tbody button')")
    until(made, "document.querySelector('#pane-specification h4')?.textContent === 'Stages for \"scanner\"'")
    made.evaluate("() => studio.ask({ kind: 'edit', text: studio.state.value.text + '# mine', revision: studio.state.value.revision })")
    until(made, "!studio.state.value.saved")
    pane.get_by_role("button", name="open 1").click()
    made.locator("dialog").get_by_role("button", name="open").click()
    made.get_by_text("stage.toml: has unsaved changes. Save or discard them first.").wait_for()
    made.get_by_label("discard the unsaved changes").check()
    with made.expect_navigation():
        made.locator("dialog").get_by_role("button", name="open").click()
    until(made, "window.studio?.state.value?.file === 'carriages-pst-1000-10-150-vs18.toml'")
    assert made.evaluate("() => studio.state.value.problems") == []
    made.get_by_role("tab", name="Specification").click()
    until(made, "document.querySelector('#pane-specification .pairs tbody button')")
    until(made, "document.querySelector('#pane-specification [aria-label=mass]')?.value === '40 g'")
    made.close()
    watch.require_silence()
