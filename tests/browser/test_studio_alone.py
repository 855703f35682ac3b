"""The studio's page against a server that the test plays: slow answers, lost connections, other pages' texts."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, Route, WebSocketRoute

from flexstage.apps.studio.forms import form
from flexstage.apps.studio.protocol import (
    VERSION,
    Amount,
    Blank,
    Done,
    Draft,
    Engine,
    Figure,
    Figures,
    Frequencies,
    Jobs,
    JobState,
    Judgement,
    Problem,
    Refusal,
    Scene,
    Slope,
    Slopes,
    Snippet,
    Snippets,
    State,
    Verdicts,
    Welcome,
)
from flexstage.apps.studio.wire import encode
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.store import dumps
from flexstage.show.viewer.data import still_data
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.sweeps.file import loads_study
from tests.browser.conftest import Watch
from tests.hygiene.source import SRC

HOST = "http://127.0.0.1:9"
OWN = SRC / "apps" / "studio" / "static"
FILES = {path.name: path for path in (OWN / "studio.html", OWN / "studio.js", OWN / "studio.css", SRC / "show" / "static" / "viewer.js")}
KINDS = {".html": "text/html", ".js": "text/javascript", ".css": "text/css"}
TEXT = 'format = "flexstage 1"\nname = "one leaf"\n\n[parts.leaf]\nthickness = "0.5 mm"\n'
THICKNESS = "parts.leaf.thickness"


class Server:
    """Answers what the test says, by the kind of a request; keeps all requests."""

    def __init__(self, page: Page) -> None:
        self.heard: list[dict[str, Any]] = []
        self.holds: set[str] = set()
        self.refuses: dict[str, Refusal] = {}
        self.socket: WebSocketRoute | None = None
        page.route(f"{HOST}/**", self._file)
        page.route_web_socket(f"{HOST.replace('http', 'ws')}/**", self._open)

    def _file(self, route: Route) -> None:
        path = FILES.get(Path(route.request.url.partition("#")[0]).name)
        if path is None:
            route.fulfill(body="<!doctype html><p>a report</p>", headers={"content-type": "text/html"})
        else:
            headers = {"content-type": KINDS[path.suffix], "content-security-policy": "default-src 'self'"}
            route.fulfill(body=path.read_bytes(), headers=headers)

    def _open(self, socket: WebSocketRoute) -> None:
        self.socket = socket
        socket.on_message(self._hear)

    def _hear(self, text: str | bytes) -> None:
        said = json.loads(text)
        self.heard.append(said)
        if said["kind"] == "hello":
            self.say(Welcome(1, "0", 1, 1), state(1), verdicts(1))
        elif said["kind"] not in self.holds:
            self.answer(said)

    def answer(self, said: dict[str, Any]) -> None:
        refusal = self.refuses.get(said["kind"])
        job = 1 if said["kind"] == "run" else None
        self.say(replace(Done(1, job) if refusal is None else refusal, to=said["id"]))

    def say(self, *messages: Any) -> None:
        assert self.socket is not None
        for each in messages:
            self.socket.send(encode(each))

    def of(self, kind: str) -> list[dict[str, Any]]:
        return [each for each in self.heard if each["kind"] == kind]


def state(revision: int, text: str = TEXT, *, page: int = 0, problems: tuple[Problem, ...] = (), value: float = 5e-4) -> State:
    amount = Amount(THICKNESS, "parts.leaf", value, f"{1e3 * value:g} mm", "m", "mm", 1e-3, "length", 2e-4, 1e-3, 5e-4, None, 5, "")
    saved = text == TEXT
    return State(
        revision, page, "leaf.toml", "one leaf", text, digest="", saved=saved, sound=not problems, changed=0, undo=True, redo=False,
        problems=problems, warnings=(), amounts=(amount,), actuators=(), axes=(), gauges=(), inputs=(), outputs=(),
        links={"leaf": 4}, paths=(), pins=(), unprotected="", drafts=(),
    )  # fmt: skip


def verdicts(revision: int) -> Verdicts:
    found = Judgement("frequency.1", "at least 50 Hz", "", "Hz", "Hz", 1.0, 50.0, 60.0, 60.0, 0.2, True, "", 6)
    return Verdicts((found,), 1.0, revision=revision)


@pytest.fixture(scope="module")
def page(browser: Browser) -> Iterator[Page]:
    watch = Watch((HOST, HOST.replace("http", "ws")))
    made = watch.over(browser.new_page(viewport={"width": 1440, "height": 900}))
    yield made
    made.close()
    assert not watch.errors
    assert not watch.requests


@pytest.fixture
def server(page: Page) -> Server:
    made = Server(page)
    page.goto("about:blank")
    page.goto(f"{HOST}/studio.html#token=abc")
    until(page, lambda: bool(made.of("look")) and page.locator(f"[data-address='{THICKNESS}']").count() == 1)
    return made


def until(page: Page, holds: Any) -> None:
    for _ in range(400):
        if holds():
            return
        page.wait_for_timeout(25)
    pytest.fail("it did not come within ten seconds")


def drag(page: Page, *places: int) -> None:
    move = """([address, at]) => {
        const slider = document.querySelector(`[data-address='${address}'] input[type=range]`);
        slider.value = String(at);
        slider.dispatchEvent(new Event('input'));
    }"""
    for each in places:
        page.evaluate(move, [THICKNESS, each])


def test_the_first_message_is_the_token_which_leaves_the_address(page: Page, server: Server) -> None:
    assert server.heard[0] == {"kind": "hello", "token": "abc", "version": VERSION}
    assert page.url == f"{HOST}/studio.html"
    assert "frequency.1" in page.inner_text("#verdicts")
    assert "+20 %" in page.inner_text("#verdicts")


def test_what_is_not_drawn_as_it_is_is_said(page: Page, server: Server) -> None:
    notes = ["drawn without holes: platform.block", "no drift: no material is stated"]
    drawn = {**still_data(parallelogram()).document(), "notes": notes}
    server.say(Scene(drawn, revision=1))
    until(page, lambda: page.inner_text("#told") == notes[0])
    server.say(Scene({**drawn, "notes": []}, revision=2))
    until(page, lambda: not page.is_visible("#told"))


def test_frequencies_of_the_drawn_stage_do_not_stand_in_rows_of_the_loaded_one(page: Page, server: Server) -> None:
    """Four loaded modes at rest, three of the drawn stage while a slider moves: no row shows a number of another stage."""
    rows = tuple(Figure(f"frequency.platform.{number}", "frequency", "Hz", "Hz", 1.0, 10.0 * number, None) for number in range(1, 5))
    told = Figures(rows, None, None, (), (), None, (), "", {}, revision=1)
    moved = Frequencies(THICKNESS, 5e-4, (11.5, 21.5, 31.5, None), ())
    shown = "() => [...document.querySelectorAll('#pane-figures [data-figure]')].map((each) => each.textContent)"
    server.say(told, moved)
    until(page, lambda: page.evaluate(shown)[:3] == ["11.5", "21.5", "31.5"])
    server.say(replace(told, loading="Its weight changes frequency 1 by -30 %."))
    until(page, lambda: "30 %" in page.inner_text("#pane-figures"))
    server.say(moved)
    until(page, lambda: "11.5, 21.5, 31.5 Hz" in page.inner_text("#pane-figures"))
    assert page.evaluate(shown) == ["10", "20", "30", "40"]
    assert "Without permanent load" in page.inner_text("#pane-figures")


def test_of_many_moves_the_server_gets_the_first_and_the_newest(page: Page, server: Server) -> None:
    server.holds = {"drag"}
    page.evaluate(f"() => document.querySelector(\"[data-address='{THICKNESS}'] input\").dispatchEvent(new PointerEvent('pointerdown'))")
    drag(page, 400, 450, 500, 550, 600)
    until(page, lambda: len(server.of("drag")) == 1)
    server.answer(server.of("drag")[0])
    until(page, lambda: len(server.of("drag")) == 2)
    # the slider goes from 0.2 mm to 1 mm in 1000 steps
    assert [each["value"] for each in server.of("drag")] == pytest.approx([5.2e-4, 6.8e-4])


def test_a_rest_sends_the_number_in_five_digits(page: Page, server: Server) -> None:
    drag(page, 333)
    until(page, lambda: bool(server.of("rest")))
    assert server.of("rest")[0]["value"] == pytest.approx(4.664e-4, rel=1e-12)


def test_findings_stand_at_their_line_and_a_click_goes_there(page: Page, server: Server) -> None:
    broken = TEXT.replace('"0.5 mm"', '"0.5"')
    server.say(state(2, broken, problems=(Problem(THICKNESS, "found a number without unit.", "Use e.g. 0.5 mm.", 5, None),)))
    until(page, lambda: "line 5" in page.inner_text("#problems"))
    page.locator("#problems button").click()
    assert page.locator("#editor .cm-activeLine").inner_text() == 'thickness = "0.5"'
    assert page.locator("#editor .cm-lint-marker-error").count() == 1
    assert "frequency.1" in page.inner_text("#verdicts")


def test_no_status_is_green_next_to_results_of_another_text(page: Page, server: Server) -> None:
    """While a text has errors, and until the results of the mended one are there."""
    chips = "() => ['engine', 'sound'].map((each) => document.getElementById(each).classList.contains('good'))"
    colours = "() => [...document.querySelectorAll('#verdicts .pill, #verdicts tr b')].map((each) => getComputedStyle(each).color)"
    figures = Figures((), None, None, (), (), None, (), "", {}, revision=1)
    server.say(Engine("ready", "", None), figures, Slopes("frequency.1", (Slope(THICKNESS, "m", 5e-4, {}, 0.01),), {}, revision=1))
    until(page, lambda: page.inner_text("#amounts .buys") == "+1")
    assert page.locator("#amounts.aged").count() == 0
    until(page, lambda: page.evaluate(chips) == [True, True])
    green = page.evaluate(colours)
    server.say(state(2, TEXT + "\n[requirements]", problems=(Problem("requirements.mass", "found a frequency", "Use e.g. 2 kg.", 6, 1),)))
    until(page, lambda: page.evaluate(chips) == [False, False])
    assert page.locator("#amounts.aged").count() == 1
    assert "of an earlier text" in page.inner_text("#numbers .foot")
    assert "1 error: results belong to the last text without errors" in page.inner_text("#text .bar")
    assert not set(green) & set(page.evaluate(colours))
    server.say(state(3))
    until(page, lambda: "error" not in page.inner_text("#text .bar"))
    assert page.evaluate(chips) == [False, False]
    server.say(replace(figures, revision=3), verdicts(3))
    until(page, lambda: page.evaluate(chips) == [True, True])
    assert page.evaluate(colours) == green


@pytest.mark.parametrize("button", ["restore them", "discard them"])
def test_unsaved_changes_of_a_studio_that_ended_are_offered(page: Page, server: Server, button: str) -> None:
    server.say(replace(state(1), drafts=(Draft("a.json", 1.7e9, True),), unprotected="the disk is full"))
    until(page, lambda: "the file was changed since" in page.inner_text("#drafts"))
    assert "the disk is full" in page.inner_text("#changed")
    page.get_by_role("button", name=button).click()
    until(page, lambda: [(each["draft"], each["keep"]) for each in server.of("recover")] == [("a.json", button == "restore them")])
    server.say(state(1))
    until(page, lambda: page.inner_text("#drafts") == "")


def test_what_was_typed_while_the_server_was_away_is_sent_when_it_is_back(page: Page, server: Server) -> None:
    assert server.socket is not None
    server.socket.close(code=1001)
    until(page, lambda: "lost" in page.inner_text("#engine"))
    page.locator("#editor .cm-content").click()
    page.keyboard.press("Control+End")
    page.keyboard.type("# typed meanwhile")
    until(page, lambda: [each["text"] for each in server.of("edit")] == [TEXT + "# typed meanwhile"])


def test_save_waits_for_what_was_typed(page: Page, server: Server) -> None:
    server.holds = {"edit"}
    page.locator("#editor .cm-content").click()
    page.keyboard.press("Control+End")
    page.keyboard.type("# thin")
    page.keyboard.press("Control+s")
    until(page, lambda: bool(server.of("edit")))
    assert server.of("edit")[0]["text"] == TEXT + "# thin"
    assert not server.of("save")
    server.answer(server.of("edit")[0])
    until(page, lambda: bool(server.of("save")))


def test_another_pages_text_is_never_merged_with_what_is_typed(page: Page, server: Server) -> None:
    server.refuses = {"edit": Refusal((Problem("text", "another page changed it", ""),), True)}
    page.locator("#editor .cm-content").click()
    page.keyboard.press("Control+End")
    page.keyboard.type("# mine")
    theirs = TEXT.replace("0.5", "0.7")
    server.say(state(2, theirs, page=2, value=7e-4))
    until(page, lambda: page.get_by_role("button", name="take theirs").count() == 1)
    assert "# mine" in page.inner_text("#editor .cm-content")
    page.get_by_role("button", name="take theirs").click()
    assert "0.7 mm" in page.inner_text("#editor .cm-content")
    assert "# mine" not in page.inner_text("#editor .cm-content")


def test_the_report_that_was_asked_for_opens_over_the_page_and_reaches_nothing_of_it(page: Page, server: Server) -> None:
    page.locator("#commands button", has_text="Report").click()
    until(page, lambda: bool(server.of("run")))
    server.say(
        Jobs(
            (JobState(1, "analyse", "runs", "computes", 0.4, 3.0, (), None), JobState(2, "verify", "runs", "meshes", None, None, (), None))
        )
    )
    until(page, lambda: "3 s left" in page.inner_text("#jobs"))
    page.locator("article.job", has_text="verify").get_by_role("button", name="cancel").click()
    until(page, lambda: [each["job"] for each in server.of("cancel")] == [2])
    assert page.locator("dialog").count() == 0
    server.say(Jobs((JobState(1, "analyse", "done", "done", 1.0, None, ("Verdict: met",), "/report/one.html"),)))
    until(page, lambda: page.locator("dialog iframe").count() == 1)
    assert page.frame_locator("dialog iframe").locator("p").inner_text() == "a report"
    assert page.locator("dialog iframe").get_attribute("sandbox") == "allow-scripts allow-downloads allow-modals"
    page.get_by_role("button", name="close").click()
    until(page, lambda: page.locator("dialog").count() == 0)
    page.get_by_role("button", name="show the report").click()
    assert page.locator("dialog iframe").count() == 1
    page.keyboard.press("Escape")


def test_an_optimum_is_taken_beside_its_job_and_among_the_pins(page: Page, server: Server) -> None:
    server.say(replace(state(1), pins=("optimum",)), Jobs((JobState(1, "optimise", "done", "done", 1.0, None, (), "/report/one.html"),)))
    page.get_by_role("tab", name="Jobs").or_(page.get_by_role("button", name="Jobs")).first.click()
    page.get_by_role("button", name="take the optimum").click()
    until(page, lambda: [each["name"] for each in server.of("recall")] == ["optimum"])
    page.get_by_role("tab", name="Figures").or_(page.get_by_role("button", name="Figures")).first.click()
    page.locator("#pane-figures").get_by_role("button", name="optimum", exact=True).click()
    until(page, lambda: [each["name"] for each in server.of("recall")] == ["optimum"] * 2)


def test_what_is_chosen_of_the_palette_is_asked_with_its_fields(page: Page, server: Server) -> None:
    wire = Snippet("wire", "hinge", "A wire", "[parts.{name}]\n", {"name": "wire", "length": "20 mm"})
    server.holds = {"palette"}
    page.locator("#tabs button", has_text="Build").click()
    until(page, lambda: bool(server.of("palette")))
    server.say(Snippets((wire,), to=server.of("palette")[0]["id"]))
    page.locator("#pane-build summary").click()
    page.locator("#pane-build input").first.fill("thread")
    page.get_by_role("button", name="insert").click()
    until(page, lambda: bool(server.of("insert")))
    assert server.of("insert")[0]["fields"] == {"name": "thread", "length": "20 mm"}


@pytest.mark.parametrize("name", ["Sweep", "Optimise"])
def test_the_study_that_is_offered_can_be_run(page: Page, server: Server, tmp_path: Path, name: str) -> None:
    (tmp_path / "leaf.toml").write_text(dumps(parallelogram()))
    server.holds = {"jobform"}
    page.locator("#commands").get_by_role("button", name=name).click()
    until(page, lambda: bool(server.of("jobform")))
    server.say(Blank(name.lower(), form(name.lower()), to=server.of("jobform")[0]["id"]))
    assert page.get_by_label("seed", exact=True).get_attribute("placeholder") == "default: 0"
    page.get_by_label("seed", exact=True).fill("7")
    page.get_by_label("from", exact=True).last.fill("-5 %")
    page.get_by_role("button", name=f"Start {name.lower()}").click()
    until(page, lambda: bool(server.of("run")))
    study = server.of("run")[0]["study"]
    assert THICKNESS in study
    found = loads_study(study, folder=tmp_path)
    assert found.variables[-1].low == pytest.approx(0.95)
    if name == "Sweep":
        assert found.plan is not None
        assert found.plan.seed == 7
    else:
        assert load_optimisation(found).seed == 7


def test_a_form_of_a_set_up_writes_only_what_was_filled_in(page: Page, server: Server) -> None:
    server.holds = {"jobform"}
    page.locator("#commands").get_by_role("button", name="Loop").click()
    until(page, lambda: bool(server.of("jobform")))
    server.say(Blank("loop", form("loop"), to=server.of("jobform")[0]["id"]))
    page.get_by_label("rate", exact=True).first.fill("5 kHz")
    page.locator("form.run summary", has_text="controller").click()
    page.get_by_label("coordinates", exact=True).select_option("modal")
    page.locator("form.run summary", has_text="trajectory").click()
    page.get_by_label("trajectory", exact=True).select_option("sine")
    page.get_by_label("periods", exact=True).fill("3")
    page.get_by_role("button", name="Start loop").click()
    until(page, lambda: bool(server.of("run")))
    study = tomllib.loads(server.of("run")[0]["study"])
    assert study == {
        "format": "flexstage loop 1",
        "rate": "5 kHz",
        "controller": {"coordinates": "modal"},
        "trajectory": {"kind": "sine", "periods": 3},
    }


def test_options_are_a_form_and_runs_are_compared_by_their_key_figures(page: Page, server: Server) -> None:
    server.holds = {"jobform"}
    page.locator("#commands").get_by_role("button", name="Verify").click()
    until(page, lambda: bool(server.of("jobform")))
    server.say(Blank("verify", form("verify"), to=server.of("jobform")[0]["id"]))
    assert page.get_by_label("--accuracy", exact=True).get_attribute("placeholder") == "default: 1 %"
    page.get_by_label("--accuracy", exact=True).fill("5 %")
    page.get_by_role("button", name="Start verify").click()
    until(page, lambda: [each["options"] for each in server.of("run")] == [["--accuracy", "5 %"]])
    runs = [(1, "verify", 2.1e-5, 100.0), (2, "loop", 1.0, 1.0), (3, "verify", 1.9e-5, None)]
    jobs = [
        JobState(number, command, "done", "done", 1.0, None, (), None, (figure("stroke.x", "m", low), figure("mode 1", "Hz", high)))
        for number, command, low, high in runs
    ]
    server.say(Jobs(tuple(jobs)))
    until(page, lambda: page.locator("article.job").count() == 3)
    tables = page.locator("article.job", has_text="verify").locator("table")
    assert tables.count() == 1
    assert [each.inner_text().split("\t") for each in tables.locator("tr").all()] == [
        ["key figures", "run 1", "run 3"],
        ["stroke.x um", "21", "19"],
        ["mode 1 Hz", "100", "\u2013"],
    ]


def figure(name: str, si: str, value: float | None) -> Figure:
    return Figure(name, "", si, si, 1.0, value, None)


def test_a_lost_connection_is_told_and_taken_up_again(page: Page, server: Server) -> None:
    assert server.socket is not None
    server.say(Engine("computes", "modes", 2.0))
    until(page, lambda: page.inner_text("#engine") == "modes, 2 s")
    server.socket.close(code=1001)
    until(page, lambda: "lost" in page.inner_text("#engine"))
    until(page, lambda: len(server.of("hello")) == 2)
    until(page, lambda: "lost" not in page.inner_text("#engine"))
