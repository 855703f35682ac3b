"""The viewer alone in a page of its own: it moves, it is picked as it is seen, and without WebGL the page lives on."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

import flexstage as fs
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import expand
from flexstage.show.viewer.data import StageData, stage_data, still_data
from flexstage.show.viewer.fragment import element, fragment
from flexstage.show.viewer.view import View
from tests.browser.conftest import Open, Watch
from tests.show.zoo import many

PLACE = "document.querySelector('[data-flexstage]')"
QUIET = "const viewer = document.querySelector('[data-flexstage]').flexstage, probe = viewer.probe;"


@cache
def bridge() -> StageData:
    return stage_data(fs.case("bridge"))


@cache
def parallelogram() -> StageData:
    return stage_data(fs.case("parallelogram"))


def shown(page: Page) -> Page:
    """The page once its viewer has drawn."""
    for _ in range(200):
        if page.evaluate(f"() => {PLACE}.flexstage && ({PLACE}.flexstage.probe.frames > 0 || !{PLACE}.flexstage.alive)"):
            return page
        page.wait_for_timeout(50)
    pytest.fail("the viewer has drawn nothing in ten seconds")


def asked(page: Page, code: str, *arguments: object) -> Any:
    return page.evaluate(f"(given) => {{ {QUIET} {code} }}", list(arguments))


@pytest.fixture(scope="module")
def sheet(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """One page with a viewer, small and still: in software, a page costs more than what is asked of it."""
    watched = Watch()
    context = browser.new_context(viewport={"width": 420, "height": 560}, reduced_motion="reduce")
    page = watched.over(context.new_page())
    page.goto(View(parallelogram()).save(tmp_path_factory.mktemp("viewer") / "stage.html").as_uri())
    yield shown(page)
    context.close()
    watched.require_silence()


def put(page: Page, data: StageData, motion: str = "") -> Page:
    """The page with another stage in its viewer, all else as it begins, held where the motion is farthest out."""
    group, _, name = motion.partition(" ")
    begin = """
        viewer.replace(JSON.parse(given[0])); viewer.select(null); viewer.setColours(null); viewer.isolate(null); viewer.section(null);
        viewer.showStress(false); viewer.showGhost(null); viewer.ghostPlatform(false); viewer.setAmplitude(0.05);
        viewer.setMotion(given[1]); viewer.setPlaying(false); viewer.setPhase(0.25); viewer.look('iso'); scrollTo(0, 0);
        viewer.element.shadowRoot.activeElement?.blur();
    """
    asked(page, begin, data.text(), {"group": group, "name": name} if motion else None)
    return page


def middle(data: StageData, name: str, twists: Array | None = None, factor: float = 0.0) -> list[float]:
    """The middle of a part's vertices where a motion takes them."""
    own = data.mesh.part == [thing.name for thing in data.things].index(name)
    moved = data.mesh.points if twists is None else data.mesh.points + factor * data.mesh.displacement(twists)
    return moved[own].mean(axis=0).tolist()


def test_a_mode_moves_the_picture_and_what_is_picked_is_what_is_seen(sheet: Page) -> None:
    data = parallelogram()
    page = put(sheet, data, "axis x")
    motion = next(each for each in data.motions if each.name == "x")
    look = "viewer.look(given[0]); return given[1].map((point) => probe.partsAt(...probe.project(point)));"
    for phase in (0.0, 0.75):
        factor = float(asked(page, "viewer.setAmplitude(0.08); viewer.setPhase(given[0]); return probe.factor;", phase))
        # Where what has moved is now: solids and links alike, each in the middle of itself, which is within it.
        for name in ("B/pzt", "B/tip.plate", "platform.block"):
            there = middle(data, name, motion.twists, factor)
            assert name in asked(page, look, "front", [there])[0], (phase, name)
    assert factor < 0.0


def test_a_leaf_bends_on_the_graphics_card_as_in_python(sheet: Page) -> None:
    """Seen on edge, a quarter and three quarters along it; a leaf that merely leaned would be elsewhere by more than its thickness."""
    data = parallelogram()
    page = put(sheet, data, "axis x")
    motion, mesh = next(each for each in data.motions if each.name == "x"), data.mesh
    factor = float(asked(page, "viewer.setAmplitude(0.2); viewer.setPhase(0.25); viewer.look('top'); return probe.factor;"))
    share = mesh.stations[mesh.station, 0]
    moved = mesh.points + factor * mesh.displacement(motion.twists)
    look = "return given[0].map((point) => probe.partsAt(...probe.project(point)));"
    for name in ("left", "right"):
        own = mesh.part == [thing.name for thing in data.things].index(name)
        first, last = (moved[own & (share == end)].mean(axis=0) for end in (0.0, 1.0))
        for place in (0.25, 0.75):
            bent = moved[own & (np.abs(share - place) < 1e-6)].mean(axis=0)
            leaning = (1.0 - place) * first + place * last
            found = asked(page, look, [bent.tolist(), leaning.tolist()])
            assert name in found[0]
            assert name not in found[1]


def test_pixels_move_with_the_phase_and_stand_still_at_rest(sheet: Page) -> None:
    page = put(sheet, parallelogram(), "axis x")
    grid = "const all = []; for (let x = 60; x < 400; x += 80) for (let y = 60; y < 300; y += 70) all.push(probe.pixel(x, y)); return all;"
    pictures = [asked(page, f"viewer.setPhase({phase}); {grid}") for phase in (0.25, 0.75, 0.25)]
    assert pictures[0] == pictures[2]
    assert pictures[0] != pictures[1]
    asked(page, "viewer.setMotion(null);")
    rest = [asked(page, f"viewer.setPhase({phase}); {grid}") for phase in (0.25, 0.75)]
    assert rest[0] == rest[1]
    assert any(pixel[3] for pixel in rest[0])


def test_keys_play_modes_and_a_click_picks_first_what_is_near_then_what_is_behind(sheet: Page) -> None:
    data = bridge()
    page = put(sheet, data)
    stage = page.locator(".stage")
    stage.focus()
    for key, name in (("2", "2"), ("1", "1")):
        page.keyboard.press(key)
        assert asked(page, "return probe.motion;") == {"group": "mode", "name": name}
    page.keyboard.press("Space")
    before = asked(
        page, "const was = document.querySelector('[data-flexstage]').shadowRoot.querySelector('.words').textContent; return was;"
    )
    page.keyboard.press("]")
    after = asked(page, "return document.querySelector('[data-flexstage]').shadowRoot.querySelector('.words').textContent;")
    assert "mm" in before
    assert before != after
    page.keyboard.press("0")
    assert asked(page, "return probe.motion;") is None
    asked(page, "viewer.onPick((picked) => (window.told ??= []).push(picked && picked.part.name));")
    there = asked(page, "viewer.look('top'); return probe.project(given[0]);", middle(data, data.things[data.links[0]].name))
    behind = asked(page, "return probe.partsAt(...given[0]);", there)
    assert len(behind) >= 1
    for _ in range(len(behind) + 1):
        stage.click(position={"x": there[0], "y": there[1]})
    told = page.evaluate("() => window.told")
    assert told == [*behind, behind[0]]
    assert page.locator(".card strong").inner_text() == behind[0]
    page.keyboard.press("Escape")
    assert asked(page, "return probe.picked;") is None


def test_links_take_the_colour_of_their_energy_and_units_stand_alone(sheet: Page) -> None:
    data = parallelogram()
    page = put(sheet, data, "mode 1")
    there = middle(data, "B/pzt")
    look = "viewer.setMotion(given[1]); viewer.setPhase(0); viewer.look('iso'); const at = probe.project(given[0]);"
    key = {"group": "mode", "name": "1"}
    own = asked(page, f"{look} return probe.pixel(...at);", there, key)
    painted = asked(page, f"{look} viewer.showEnergy(true); return probe.pixel(...at);", there, key)
    coloured = asked(
        page, f"{look} viewer.showEnergy(false); viewer.setColours({{'B/pzt': [0, 0, 1]}}); return probe.pixel(...at);", there, key
    )
    assert own != painted
    assert coloured[2] > coloured[0]
    assert asked(page, "viewer.isolate('B'); return probe.partsAt(...probe.project(given[0]));", middle(data, "platform.block")) == []
    assert "B/pzt" in asked(page, "return probe.partsAt(...probe.project(given[0]));", there)
    assert (
        asked(
            page,
            "viewer.isolate(null); viewer.section('y', 1); viewer.look('front'); return probe.partsAt(...probe.project(given[0]));",
            there,
        )
        == []
    )


def test_links_take_the_colour_of_their_stress_where_a_motion_has_one(sheet: Page) -> None:
    data = parallelogram()
    page = put(sheet, data)
    there = middle(data, "left")
    look = "viewer.setMotion(given[1]); viewer.setPhase(0); viewer.look('top'); const at = probe.project(given[0]);"
    colours = {}
    for name in ("stroke B", "mode 1"):
        group, _, own = name.partition(" ")
        key = {"group": group, "name": own}
        plain = asked(page, f"{look} viewer.showStress(false); return probe.pixel(...at);", there, key)
        colours[name] = plain != asked(page, f"{look} viewer.showStress(true); return probe.pixel(...at);", there, key)
    assert colours == {"stroke B": True, "mode 1": False}


def test_another_design_keeps_the_camera_the_part_and_the_motion(sheet: Page) -> None:
    page = put(sheet, parallelogram(), "axis x")
    asked(page, "viewer.select('B/front'); viewer.look('top');")
    was = asked(page, "return [probe.camera, probe.picked, probe.motion];")
    asked(page, "viewer.showGhost(JSON.parse(given[0])); viewer.replace(JSON.parse(given[0]));", parallelogram().text())
    assert asked(page, "return [probe.camera, probe.picked, probe.motion];") == was
    asked(page, "viewer.replace(JSON.parse(given[0])); viewer.fit();", bridge().text())
    assert asked(page, "return [probe.picked, probe.motion?.name ?? null];") == [None, None]
    assert asked(page, "return viewer.picture().length;") > 1000


def test_the_wheel_is_the_pages_until_the_picture_has_the_focus(sheet: Page) -> None:
    page = put(sheet, parallelogram())
    page.evaluate("() => document.body.style.height = '3000px'")
    stage = page.locator(".stage")
    zoom = asked(page, "return probe.camera.zoom;")
    stage.hover()
    page.mouse.wheel(0, 100)
    for _ in range(100):
        if page.evaluate("() => scrollY") > 0:
            break
        page.wait_for_timeout(20)
    assert page.evaluate("() => scrollY") > 0
    assert asked(page, "return probe.camera.zoom;") == zoom
    page.evaluate("() => scrollTo(0, 0)")
    stage.click(position={"x": 5, "y": 5})
    page.mouse.wheel(0, -100)
    for _ in range(100):
        if asked(page, "return probe.camera.zoom;") > zoom:
            break
        page.wait_for_timeout(20)
    assert asked(page, "return probe.camera.zoom;") > zoom
    assert page.evaluate("() => scrollY") == 0


def test_without_webgl_the_page_lives_and_its_picture_stays(opened: Open, tmp_path: Path) -> None:
    path = tmp_path / "stage.html"
    blind = "<script>HTMLCanvasElement.prototype.getContext = () => null</script>"
    path.write_text(
        f"<!doctype html><meta charset='utf-8'>{blind}{fragment(bridge(), instead='<p id=picture>a picture</p>')}", encoding="utf-8"
    )
    page = shown(opened(path))
    assert page.locator("#picture").is_visible()
    assert "WebGL" in page.locator("[data-flexstage]").inner_text()
    assert asked(page, "viewer.setMotion({group: 'mode', name: '1'}); viewer.fit(); return viewer.alive;") is False


def test_viewers_of_one_page_share_data_and_bundle_and_fit_a_phone(opened: Open, tmp_path: Path) -> None:
    path = tmp_path / "stage.html"
    policy = "<meta http-equiv='Content-Security-Policy' content=\"default-src 'none'; script-src 'unsafe-inline'\">"
    viewport = "<meta name='viewport' content='width=device-width'>"
    both = element("stage", motion="mode 2") + fragment(bridge(), motion="mode 1")
    path.write_text(f"<!doctype html><meta charset='utf-8'>{policy}{viewport}{both}", encoding="utf-8")
    page = shown(opened(path, width=390, height=1600, dark=True, has_touch=True, device_scale_factor=2))
    names = "[...document.querySelectorAll('[data-flexstage]')].map((each) => each.flexstage?.probe.motion?.name)"
    assert page.evaluate(f"() => {names}") == ["2", "1"]
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 390
    assert page.locator("[data-flexstage]").first.evaluate("(each) => each.classList.contains('dark')")
    before = asked(page, "return probe.camera.position;")
    box = page.locator(".stage").first.bounding_box()
    assert box is not None
    page.touchscreen.tap(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    assert asked(page, "return probe.camera.position;") == before
    assert page.locator("[data-flexstage]").first.locator("canvas").evaluate("(each) => each.width") > 390


@pytest.mark.parametrize("count", [30, pytest.param(1000, marks=pytest.mark.full)])
def test_many_links_are_drawn_picked_and_turned(sheet: Page, count: int) -> None:
    """Tables, not uniforms: bodies and parts are as many as 16 bits count."""
    data = still_data(many(count))
    page = put(sheet, data)
    names = list(expand(many(count)).links)
    side = int(np.ceil(np.sqrt(count)))
    for name in (names[0], names[side - 1]):
        there = middle(data, name)
        assert asked(page, "viewer.look('front'); return probe.partAt(...probe.project(given[0]));", there) == name
    twists = np.zeros((len(data.bodies), 6), dtype=np.float32)
    twists[1, 0] = 1e-3
    moved = asked(page, "viewer.setPose(new Float32Array(given[0]), 8); return probe.factor;", twists.ravel().tolist())
    assert moved == 8.0
    there = middle(data, "platform.plate", twists.astype(float), 8.0)
    assert "platform.plate" in asked(page, "viewer.look('top'); return probe.partsAt(...probe.project(given[0]));", there)


def test_a_path_plays_and_its_cursor_follows(opened: Open, tmp_path: Path) -> None:
    stage = fs.case("parallelogram")
    path = fs.load_path(fs.nonlinear(stage), "platform.x", np.linspace(0.0, 3e-3, 3), weight=0.0)
    page = shown(opened(fs.animate(stage, path).save(tmp_path / "path.html"), reduced_motion="reduce"))
    viewer = f"{PLACE}.flexstage"
    figures = f"{viewer}.curves.shadowRoot"
    seen = []
    for phase in (0.0, 0.5, 1.0):
        page.evaluate(f"{viewer}.setPhase({phase})")
        assert float(page.evaluate(f"{figures}.querySelector('.cursor').getAttribute('x1')")) == pytest.approx(100.0 * phase)
        seen.append((page.evaluate(f"{viewer}.picture()"), page.evaluate(f"{figures}.querySelector('output').textContent")))
    assert len({picture for picture, _ in seen}) == 3
    assert [value for _, value in seen] == ["0 mm", "1.5 mm", "3 mm"]
    assert page.evaluate(f"{viewer}.setPhase(0.2), {viewer}.setPlaying(true)") is None
    for _ in range(100):
        if page.evaluate(f"{viewer}.probe.phase > 0.21"):
            return
        page.wait_for_timeout(50)
    pytest.fail("it does not play")
