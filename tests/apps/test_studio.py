"""The studio without a browser: what pages ask and are told, on a stage small enough to be computed at once."""

import asyncio
import base64
import contextlib
import json
import os
import random
import signal
import tomllib
import types
from dataclasses import replace
from typing import Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

import flexstage as fs
from flexstage.analysis.assessment.judge import bench_of, judge
from flexstage.analysis.complete import loaded_model
from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.dynamics.response import response
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.loaded.course import DrivePath
from flexstage.analysis.loaded.load_effect import load_effect
from flexstage.analysis.loaded.stroke import stroke
from flexstage.analysis.workspace.workspace import workspace
from flexstage.apps.cli import run
from flexstage.apps.studio import protocol as say
from flexstage.apps.studio import solids
from flexstage.apps.studio.design.palette import insert, snippets
from flexstage.apps.studio.design.reading import design, read
from flexstage.apps.studio.design.writing import write
from flexstage.apps.studio.forms import key_figures, specify
from flexstage.apps.studio.helper import Urgency
from flexstage.apps.studio.questions import Bearing, slopes
from flexstage.apps.studio.results import all_figures, drawn, figures, reach
from flexstage.apps.studio.server import LARGEST
from flexstage.apps.studio.travel import travelled
from flexstage.apps.studio.wire import encode
from flexstage.base.finding import DesignError
from flexstage.base.labelled import quiet
from flexstage.base.units.quantity import LENGTH
from flexstage.base.units.unit import show
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.checks import check
from flexstage.mechanism.geometry.contact import gaps
from flexstage.mechanism.mechanism import StrokePath
from flexstage.mechanism.store import dumps, loads, patch
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.models.nonlinear.stage import nonlinear
from flexstage.models.theory import Model
from flexstage.studies.synthesis.answers import design as find_designs
from flexstage.studies.synthesis.show.tables import answer_tables
from flexstage.studies.synthesis.specification import loads_specification
from tests.analytic.test_load_effect import upright
from tests.apps.studio_page import PATIENCE, array, leaves, opened, served

THICKNESS = "parts.leaf.thickness"
TEXT = dumps(parallelogram(), {"": "A guide.", "parts.leaf": "thin"})


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    path = tmp_path_factory.mktemp("studio") / "guide.toml"
    path.write_bytes(TEXT.encode())
    with served(path) as (studio, do):
        yield studio, do


def on_page(work):
    """A test with a page of its own, which ends with the text of the file."""

    def test(studio):
        async def whole():
            path = studio[0].session.stored.path
            path.write_bytes(TEXT.encode())
            page = await opened(studio[0])
            try:
                await page.ask(say.Reload)
                await page.settle()
                await work(page, studio[0])
            finally:
                await page.close()

        studio[1](whole())

    test.__doc__ = work.__doc__
    return test


def amount(page, address=THICKNESS):
    return next(each for each in page.state.amounts if each.address == address)


@on_page
async def test_figures_at_rest_are_those_of_the_library(page, studio):
    await page.ask(say.Set, address=THICKNESS, text="900 um")
    await page.settle()
    stage = loads(patch(TEXT, {THICKNESS: "0.9 mm"}))
    model = lumped(stage)
    told = page.told[say.Figures]
    stiff, found, lost = statics(model), modes(model), lost_motion(ideal(stage), model)
    assert np.allclose(told.stiffness.values, quiet(stiff.stiffness.values), rtol=1e-9, atol=0.0)
    assert np.allclose([each.frequency for each in told.modes], found.frequencies[: len(told.modes)], rtol=1e-9)
    assert [each.loss for each in told.losses] == pytest.approx([float(each.loss) for each in lost.actuators.values()], rel=1e-9)
    heard = response(model, ("platform",), ("B",))
    assert np.allclose(array(told.frequency), heard.frequencies, rtol=1e-9)
    assert np.allclose(array(told.curves[1].magnitude), np.abs(heard.values[:, 1, 0]), rtol=1e-7, atol=1e-12)
    values = [float(each.value) for each in judge(stage)]
    assert [each.value for each in page.told[say.Verdicts].verdicts] == pytest.approx(values, rel=1e-9)
    assert [each.line for each in page.told[say.Verdicts].verdicts] != [None] * len(values) or not values
    old = next(each for each in told.figures if each.name == "frequency.platform.1")
    assert old.old == pytest.approx(modes(lumped(loads(TEXT))).platform_frequencies[0], rel=1e-9)
    assert (page.state.changed, page.state.saved, amount(page).text, amount(page).old) == (1, False, "0.9 mm", 1e-3)


def test_figures_of_a_stage_whose_weight_is_felt_are_those_of_its_analysis():
    """Two upright leaves under 2.5 kg: 2.27 Hz loaded, 3.18 Hz as drawn."""
    text = dumps(upright(2.5))
    stage = loads(text)
    model = loaded_model(stage, Model.LUMPED)
    told, found, heard = figures(text, "", text, ((), (), None, None)), modes(model), response(model, ("platform",), ("ground.z",))
    assert told.loading == load_effect(stage).text != ""
    assert told.modes[0].frequency == pytest.approx(2.26569, rel=1e-4)
    assert [each.frequency for each in told.modes] == pytest.approx(found.frequencies[: len(told.modes)], rel=1e-9)
    assert np.allclose(told.compliance.values, quiet(statics(model).compliance.values), rtol=1e-9, atol=0.0)
    assert np.allclose(array(told.curves[2].magnitude), np.abs(heard.values[:, 2, 0]), rtol=1e-7, atol=1e-12)
    value = next(each.value for each in told.figures if each.name == "frequency.platform.1")
    assert value == next(each.value for each in all_figures(text, "") if each.name == "frequency.platform.1") == told.modes[0].frequency
    played = next(each for each in drawn(text, "").motions if each.frequency is not None)
    assert played.frequency == told.modes[0].frequency


@on_page
async def test_strain_energy_shares_add_up(page, studio):
    for each in page.told[say.Figures].modes:
        assert sum(each.strain.values()) == pytest.approx(1.0, abs=0.05)
        assert list(each.strain.values()) == sorted(each.strain.values(), reverse=True)


@on_page
async def test_a_mistake_is_told_at_its_line_and_the_last_design_stays(page, studio):
    before, found = page.told[say.Figures], page.state
    wrong = TEXT.replace('thickness = "', 'thickness = "-', 1)
    line = next(number for number, row in enumerate(wrong.splitlines(), start=1) if row.startswith('thickness = "-'))
    await page.ask(say.Edit, text=wrong, revision=found.revision)
    await page.until(lambda page: not page.state.sound)
    (problem,) = page.state.problems
    assert (problem.where, problem.line, problem.column) == (THICKNESS, line, 1)
    assert problem.what == "must be greater than 0 mm (got -1 mm)"
    assert page.state.amounts == found.amounts
    assert page.told[say.Figures].modes == before.modes
    await page.ask(say.Edit, text=TEXT.replace("[parts.leaf]", "[parts.leaf"), revision=page.state.revision)
    await page.until(lambda page: page.state.problems and page.state.problems[0].column > 1)
    assert "not TOML" in page.state.problems[0].what


ERRORS = {
    "requirements.frequency.platfrm.1": ("[requirements]", '"frequency.platfrm.1" = "at least 3 Hz"'),
    "requirements.mass": ("[requirements]", 'mass = "at most 3 Hz"'),
    "requirements.stroke.x": ("[requirements]", '"stroke.x" = "at least 1 um at nowhere"'),
    "paths.out.drive": ("[paths.out]", 'drive = "platform.q"\nto = ["0 mm", "1 mm"]\npoints = 3'),
    "tags": ("[tags]", '"parts.nothing" = "assumed"'),
    "links.extra": ("[links.extra]", 'joins = ["ground", "platform"]\npart = "nothing"\nat = ["0 mm", "0 mm", "0 mm"]'),
}


@pytest.mark.parametrize("where", ERRORS)
def test_an_error_in_any_table_is_shown_at_its_line(studio, where):
    """When it is typed, and when the file is opened with it: the text is not sound, and figures are not of its revision."""
    head, row = ERRORS[where]
    wrong = TEXT.replace(f"{head}\n", f"{head}\n{row}\n", 1) if f"{head}\n" in TEXT else f"{TEXT}\n{head}\n{row}\n"

    def is_shown(page):
        problems = page.state.problems
        rows = page.state.text.splitlines()
        assert not page.state.sound
        assert any(
            each.line and (row.split(" =")[0] in rows[each.line - 1] or rows[each.line - 1] in f"{head}\n{row}") for each in problems
        )

    async def typed(page):
        before = page.told[say.Figures]
        await page.ask(say.Edit, text=wrong, revision=page.state.revision)
        await page.until(lambda page: page.state.text == wrong)
        is_shown(page)
        assert page.told[say.Figures] == before
        assert page.told[say.Figures].revision != page.state.revision

    async def at_first(page):
        await page.until(lambda page: say.State in page.told and page.told[say.Engine].state == "ready")
        is_shown(page)
        assert say.Figures not in page.told
        await page.ask(say.Edit, text=TEXT, revision=page.state.revision)
        await page.settle()
        assert (page.state.sound, page.state.problems, page.told[say.Verdicts].revision) == (True, (), page.state.revision)

    on_page(lambda page, _: typed(page))(studio)
    if where != "requirements.mass":
        return
    path = studio[0].session.stored.path
    path.write_text(wrong, encoding="utf-8")
    with served(path) as (other, do):

        async def opened_first():
            page = await opened(other)
            try:
                await at_first(page)
            finally:
                await page.close()

        do(opened_first())


@on_page
async def test_a_stage_that_its_load_buckles_is_an_error_though_its_text_is_sound(page, studio):
    await page.ask(say.Edit, text=dumps(upright(500.0)), revision=page.state.revision)
    await page.until(lambda page: page.state.name != "guide" and page.state.problems)
    assert not page.state.sound
    assert "position is unstable" in page.state.problems[0].what
    await page.ask(say.Undo)
    await page.settle()
    assert (page.state.sound, page.state.problems) == (True, ())


@on_page
async def test_a_wrong_unit_is_refused_in_the_words_of_the_checks(page, studio):
    for text, words in (
        ("3 kg", 'must be a length (got "3 kg", a mass)'),
        ("0.4", "unit missing"),
        ("-1 mm", "must be greater than 0 mm (got -1 mm)"),
    ):
        said = await page.ask(say.Set, address=THICKNESS, text=text)
        assert isinstance(said, say.Refusal)
        assert words in said.problems[0].what
    said = await page.ask(say.Set, address="parts.leef.thickness", text="1 mm")
    assert isinstance(said, say.Refusal)
    assert page.state.text == TEXT


@on_page
async def test_a_slider_is_answered_by_the_engine_and_the_newest_value_alone(page, studio):
    told, row = await page.ask(say.Drag, address=THICKNESS, value=0.98e-3), amount(page)
    found = list(modes(lumped(loads(patch(TEXT, {THICKNESS: 0.98e-3}))), limit=_limit()).platform_frequencies)
    known = [each for each in told.frequencies if each is not None]
    assert known
    assert known == pytest.approx(found[: len(known)], rel=1e-6)
    values = np.linspace(row.low, row.high, 60).tolist()
    said = [each[1] for each in await asyncio.gather(*(page.begin(say.Drag, address=THICKNESS, value=value) for value in values))]
    answered = [each for each in said if isinstance(each, say.Frequencies)]
    assert isinstance(said[-1], say.Frequencies)
    assert len(answered) < len(values)
    assert page.state.text == TEXT
    await page.ask(say.Rest, address=THICKNESS, value=0.9812345678e-3)
    await page.settle()
    assert amount(page).text == "0.981235 mm"
    assert (await page.ask(say.Drag, address=THICKNESS, value=0.99e-3)).frequencies[0]


def _limit():
    return float(loads(TEXT).max_mode_frequency or np.inf)


@on_page
async def test_undo_gives_every_byte_back_and_saving_too(page, studio):
    path = studio.session.stored.path
    await page.ask(say.Set, address=THICKNESS, text="0.8 mm")
    await page.ask(say.Set, address=THICKNESS, text="+10 %")
    await page.settle()
    assert amount(page).text == "0.88 mm"
    changed = page.state.text
    await page.ask(say.Undo)
    await page.ask(say.Undo)
    await page.settle()
    assert (page.state.text, page.state.saved, page.state.undo, page.state.redo) == (TEXT, True, page.state.undo, True)
    await page.ask(say.Redo)
    await page.ask(say.Redo)
    await page.settle()
    assert page.state.text == changed
    await page.ask(say.Save, over=False)
    assert path.read_bytes() == changed.encode()
    assert "# A guide." in changed
    assert "# thin" in changed


@on_page
async def test_saving_is_refused_where_the_file_changed_on_disk(page, studio):
    path = studio.session.stored.path
    await page.ask(say.Set, address=THICKNESS, text="0.4 mm")
    other = TEXT.replace("A guide.", "Another hand's.")
    path.write_text(other, encoding="utf-8")
    said = await page.ask(say.Save, over=False)
    assert isinstance(said, say.Refusal)
    assert said.stale
    assert path.read_text(encoding="utf-8") == other
    await page.ask(say.Reload)
    await page.settle()
    assert page.state.text == other
    await page.ask(say.Undo)
    await page.ask(say.Save, over=False)
    assert '"0.4 mm"' in path.read_text(encoding="utf-8")


@on_page
async def test_line_ends_and_marks_of_a_file_stay(page, studio):
    path = studio.session.stored.path
    raw = b"\xef\xbb\xbf" + TEXT.replace("\n", "\r\n").encode()
    path.write_bytes(raw)
    await page.ask(say.Reload)
    await page.settle()
    assert page.state.text == TEXT
    await page.ask(say.Edit, text=TEXT.replace("A guide.", "The guide."), revision=page.state.revision)
    await page.ask(say.Save, over=False)
    assert path.read_bytes() == raw.replace(b"A guide.", b"The guide.")


@on_page
async def test_two_windows_see_the_same_and_the_second_one_writes_over_nothing(page, studio):
    other = await opened(studio)
    try:
        await other.settle()
        assert (other.state.text, other.told[say.Figures]) == (page.state.text, page.told[say.Figures])
        assert other.told[say.Scene] == page.told[say.Scene]
        seen = other.state.revision
        await page.ask(say.Edit, text=TEXT.replace("A guide.", "One."), revision=page.state.revision)
        said = await other.ask(say.Edit, text=TEXT.replace("A guide.", "Two."), revision=seen)
        assert isinstance(said, say.Refusal)
        assert said.stale
        await other.until(lambda other: "# One." in other.state.text)
        assert other.state.page == page.told[say.Welcome].page
        said = await page.ask(say.Edit, text=TEXT.replace("A guide.", "Three."), revision=seen)
        assert isinstance(said, say.Done), "a window that types on knows what it typed"
    finally:
        await other.close()


@on_page
async def test_a_window_that_goes_while_it_is_told_takes_nothing_with_it(page, studio):
    for _ in range(3):
        other = await opened(studio)
        await other.until(lambda other: say.Welcome in other.told)
        other.connection.transport.abort()
        await page.ask(say.Set, address=THICKNESS, text="0.4 mm")
        await page.ask(say.Undo)
    await page.settle()
    assert page.state.text == TEXT


@on_page
async def test_a_process_that_dies_is_started_anew(page, studio):
    """Pages are told that it is ready again, however little time it takes then."""
    studio.session._took.update(dict.fromkeys(studio.session._took, (0.0, 1)))
    for process in studio.session.processes:
        os.kill(process, signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)
    await page.ask(say.Edit, text=TEXT.replace("A guide.", "After."), revision=page.state.revision)  # before the death was heard
    await page.settle(say.Figures)
    await page.until(lambda page: page.engine[-1] == "ready")
    assert "ended" in page.engine
    assert page.state.sound
    assert len(page.told[say.Figures].modes) > 3


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="signals of POSIX")
@on_page
async def test_what_is_computed_too_long_of_a_text_that_is_no_more_is_given_up(page, studio):
    """A process that computes is held still meanwhile; a page that waits for it is told, and the next text is computed."""
    model = studio.session._model
    async with studio.session._computing:  # nothing of what was asked before is computed any more
        (process,) = [each for each in studio.session.processes if each == model.process]
        os.kill(process, signal.SIGSTOP)
    await page.ask(say.Edit, text=TEXT.replace('"1 mm"', '"0.95 mm"', 1), revision=page.state.revision)
    async with asyncio.timeout(PATIENCE):
        while model.busy(Urgency.SOON) == 0.0:
            await asyncio.sleep(0.01)
    model._since -= 10.0
    await page.ask(say.Edit, text=TEXT.replace('"1 mm"', '"0.9 mm"', 1), revision=page.state.revision)
    await page.settle(say.Figures)
    await page.until(lambda page: page.told[say.Engine].state == "ready")
    assert model.process != process


@on_page
async def test_what_no_page_shows_is_computed_when_it_is_looked_at(page, studio):
    """With another pane in front and nothing moving, a change gives no strokes and no motions; looking at them does, and nothing else."""
    before = page.counts[say.Reach]
    await page.ask(say.Look, panes=("stage",))
    await page.ask(say.Set, address=THICKNESS, text="0.95 mm")
    await page.settle()
    assert page.counts[say.Reach] == before
    assert page.told[say.Scene].revision == page.state.revision
    assert page.told[say.Scene].data["motions"] == []
    figures = page.counts[say.Figures]
    await page.ask(say.Look, panes=("stage", "motions", "reach"))
    await page.until(lambda page: page.told[say.Reach].revision == page.state.revision and page.told[say.Scene].data["motions"])
    assert page.counts[say.Figures] == figures
    assert len(page.told[say.Scene].data["motions"]) > 10


@pytest.mark.parametrize(("name", "unit"), [("voice-coil-stage", "Pa/A"), ("parallelogram", "Pa/m")])
def test_stress_is_in_the_units_of_its_inputs(name: str, unit: str) -> None:
    stress = Bearing(bench_of(fs.case(name))).per_input
    assert {each for row in stress.unit for each in row} == {unit}


@on_page
async def test_what_is_asked_about_the_stage(page, studio):
    stage = loads(TEXT)
    card = await page.ask(say.Part, link="left")
    assert (card.part_kind, card.shares.keys()) == ("leaf", {"B"})
    assert np.allclose(np.array(card.compliance.values) @ np.array(card.stiffness.values), np.eye(6), atol=1e-9)
    place = await page.ask(say.Line, line=card.lines[0])
    assert "left" in place.links
    assert isinstance(await page.ask(say.Part, link="lift"), say.Refusal)
    motion = await page.ask(say.Jog)
    lost = lost_motion(ideal(stage), lumped(stage))
    assert np.allclose(np.array(motion.platform.values)[:, [motion.platform.columns.index("B")]], lost.gain.values, rtol=1e-9, atol=1e-15)
    assert np.allclose(motion.inputs.values, lost.correction.values, rtol=1e-9)
    small, large = [await page.ask(say.Pose, inputs={"B": value}) for value in (1e-6, 1.0)]
    assert not small.beyond
    assert {"B", "S"} <= large.beyond.keys()
    bound = [motion.rest[name] + 1e-6 * row[0] for name, row in zip(motion.stress.rows, motion.stress.values, strict=True)]
    assert all(small.stress[name] <= value * (1 + 1e-9) for name, value in zip(motion.stress.rows, bound, strict=True))
    free = await page.ask(say.Free)
    assert (free.mobility, [each.name for each in free.free]) == (1, ["x"])
    assert len(free.locked) == 5
    assert free.redundant
    assert isinstance(await page.ask(say.Gaps), say.Clearances)


def test_what_numbers_buy_are_derivatives_of_what_is_shown():
    told = slopes(TEXT, "guide.toml")
    row = next(each for each in told.slopes if each.address == THICKNESS)
    step = 1e-8
    low, high = (modes(lumped(loads(patch(TEXT, {THICKNESS: 1e-3 + way})))) for way in (-step, step))
    moved = (high.platform_frequencies[0] - low.platform_frequencies[0]) / (2 * step)
    assert row.slopes["frequency.platform.1"] == pytest.approx(moved, rel=1e-4)
    sizes = [abs(each.worst or 0.0) for each in told.slopes]
    assert sizes == sorted(sizes, reverse=True)
    low, high = (judge(loads(patch(TEXT, {THICKNESS: 1e-3 * (1.0 + way)}))) for way in (-1e-6, 1e-6))
    margins = [next(float(each.margin) for each in side if each.requirement.key == told.worst) for side in (low, high)]
    assert row.worst == pytest.approx((margins[1] - margins[0]) / 2e-6 * 0.01, rel=1e-4, abs=1e-9)


def test_what_numbers_buy_of_a_platform_mode_above_local_modes():
    """The tilt of tip-tilt is the seventh mode of all: 1 % of each number against central differences."""
    stage = replace(case("tip-tilt"), requirements={"frequency.platform.1": "at least 100 Hz"})
    row = slopes(dumps(stage), "tip-tilt.toml").slopes[0]
    value = get(stage, row.address)
    low, high = (judge(set_value(stage, row.address, value * (1.0 + way)))[0].margin for way in (-1e-5, 1e-5))
    assert row.worst == pytest.approx(float(high - low) / 2e-5 * 0.01, rel=1e-3)


@pytest.mark.full
@on_page
async def test_what_numbers_buy_is_worked_out_beside(page, studio):
    told = await page.ask(say.Derive)
    assert [each.address for each in told.slopes] == [each.address for each in slopes(TEXT, "guide.toml").slopes]


def test_gaps_are_those_that_are_drawn():
    """Lever and pole of the shipped stage: |y| from 21 mm, and up to 20 mm; moved together, they overlap by as much."""
    stage = double_triangle()
    moved = set_value(stage, "units.vertical.bodies.pole.solids.left.at.y", 16.75e-3 + 1.25e-3)
    assert _between(stage, 2e-3) == [pytest.approx(1e-3, rel=1e-9)]
    assert _between(moved, 2e-3) == [pytest.approx(-0.25e-3, rel=1e-9)]
    assert _between(stage, 0.9e-3) == []


def _between(stage, within):
    return [each.distance for each in gaps(stage, within) if {each.first, each.second} == {"B4/lever.left_tip", "B4/pole.left"}]


@on_page
async def test_responses_are_chosen(page, studio):
    said = await page.ask(say.Respond, inputs=("ground.x",), outputs=("S",), low=10.0, high=100.0)
    assert isinstance(said, say.Done)
    (curve,) = page.told[say.Figures].curves
    assert (curve.input, curve.output, array(page.told[say.Figures].frequency)[-1]) == ("ground.x", "S", pytest.approx(100.0))
    assert isinstance(await page.ask(say.Respond, inputs=("nothing",), outputs=("S",), low=None, high=None), say.Refusal)
    await page.ask(say.Respond, inputs=(), outputs=(), low=None, high=None)


@on_page
async def test_designs_are_pinned_and_compared(page, studio):
    await page.ask(say.Set, address=THICKNESS, text="0.4 mm")
    await page.settle()
    await page.ask(say.Pin, name="A", keep=True)
    await page.ask(say.Set, address=THICKNESS, text="1.2 mm")
    await page.settle()
    told = await page.ask(say.Compare)
    assert told.designs == ("file", "A", "now")
    row = [each.name for each in told.figures].index("frequency.platform.1")
    thin, middle, thick = told.values[row][1], told.values[row][0], told.values[row][2]
    assert thin < middle < thick
    await page.ask(say.Recall, name="A")
    await page.settle()
    assert amount(page).text == "0.4 mm"
    await page.ask(say.Pin, name="A", keep=False)
    assert isinstance(await page.ask(say.Recall, name="A"), say.Refusal)


def test_modes_of_finite_elements_stand_beside_those_that_move_like_them(monkeypatch):
    """The stage itself, ten per cent slower, in place of what a verification has left."""
    stage = loads(TEXT)
    model = lumped(stage)
    found = modes(model, limit=_limit())
    slower = replace(found, frequencies=found.frequencies / 1.1)
    monkeypatch.setattr(solids, "fea_modes_from_cache", lambda *_: FeaModes(slower, model, 3, (0.001,)))
    told = solids.solid_modes(TEXT, "guide.toml")
    assert [each.number for each in told.modes] == [index + 1 for index in found.platform]
    assert [each.theory for each in told.modes] == [each.number for each in told.modes]
    assert [each.difference for each in told.modes] == pytest.approx([0.1] * len(told.modes), rel=1e-9)
    assert [each.assurance for each in told.modes] == pytest.approx([1.0] * len(told.modes), rel=1e-9)
    assert [each.error for each in told.modes][:2] == [0.001, None]
    assert {each.motion["group"] for each in told.modes} == {"mode"}
    monkeypatch.setattr(solids, "fea_modes_from_cache", lambda *_: None)
    assert "start Verify to compute them" in solids.solid_modes(TEXT, "guide.toml").missing


def test_a_number_that_is_set_is_what_patch_writes():
    """Comments and spaces stay."""
    text = TEXT.replace('thickness = "', 'thickness =   "', 1).replace("# thin", '# thin; thickness = "9 mm"')
    for value in (0.8125e-3, 1.23456789e-3):
        wrote = write(text, "guide.toml", THICKNESS, value)
        assert wrote == patch(text, {THICKNESS: show(value, LENGTH, digits=6)})
        assert design(wrote, "guide.toml") == loads(wrote)
    assert 'thickness =   "1.23457 mm"' in wrote


@pytest.mark.parametrize("stage", [parallelogram(), double_triangle()])
def test_strokes_stress_and_buckling_at_rest_are_those_of_the_workspace(stage):
    text = dumps(stage)
    whole = workspace(stage, ideal(stage), lumped(stage), lost=lost_motion(ideal(stage), lumped(stage)))
    wanted = [*whole.corrected.symmetric.tolist(), float(whole.stress.min_safety), float(whole.buckling.min_factor)]
    told = reach(text, "", text)
    assert [each.value for each in told.figures] == wanted
    assert ([each.low for each in told.strokes], told.missing) == (whole.corrected.low.tolist(), {})


def test_a_path_counts_from_where_the_stage_rests_and_tells_how_far_it_is():
    """Two upright leaves sag under 2.5 kg: motion counts from there, as that of the command does, and is the same point by point."""
    stage, told = upright(2.5), []
    asked = say.Travel(7, "platform.x", "", "1 mm", 3, (), "")
    found = travelled(dumps(stage), "", asked, told.append)
    assert [each.fraction for each in told] == pytest.approx([0.1, 1.0])
    assert ([each.request for each in told], told[-1].text) == ([7] * 2, "3 of 3 points")
    model = nonlinear(stage)
    wanted = DrivePath("platform.x", np.linspace(0.0, 1e-3, 3), {}, (), 1.0)
    rest = wanted.rest(model)
    whole = stroke(wanted.path(model, rest), rest).along
    curves = {each["name"]: np.frombuffer(base64.b64decode(each["values"]), "<f4") for each in found.motions[0]["course"]["curves"]}
    assert [name for name in whole.columns if name in curves] == [name for name in whole.columns if name != "unstable"]
    for name in ("f1", "f2"):
        assert np.allclose(curves[name], whole.values[:, whole.columns.index(name)], rtol=1e-6)
    assert curves["platform.x"].tolist() == [0.0, 0.5, 1.0]
    assert abs(curves["platform.z"][0]) < 1e-6 * abs(curves["platform.z"][-1])
    assert rest.displacement()[2] < 0.0


def test_a_path_of_the_design_is_brought_as_it_is_stated():
    """Its own drive, ends, points and loads, whatever stands in the form; one that the design does not state is refused."""
    text = dumps(replace(upright(2.5), paths={"out": StrokePath("platform.x", ("-1 mm", "1 mm"), 3, {"platform.y": "1 N"})}))
    assert read(text, "", text).paths == ("out",)
    found = travelled(text, "", say.Travel(7, "platform.z", "", "9 mm", 50, (), "out"), lambda _: None)
    curves = {each["name"]: np.frombuffer(base64.b64decode(each["values"]), "<f4") for each in found.motions[0]["course"]["curves"]}
    assert curves["platform.x"].tolist() == [-1.0, 0.0, 1.0]
    with pytest.raises(DesignError, match=r"paths\.back: unknown path\. Use out"):
        travelled(text, "", say.Travel(7, "platform.z", "", "9 mm", 50, (), "back"), lambda _: None)


@on_page
async def test_what_the_palette_inserts_is_a_design_again(page, studio):
    told = await page.ask(say.Palette)
    assert {"hinge", "actuator", "gauge", "unit", "copies"} <= {each.group for each in told.snippets}
    await page.ask(say.Insert, snippet="wire", fields={"name": "thread"})
    await page.ask(say.Insert, snippet="link", fields={"name": "stay", "part": "thread", "x": "200 mm"})
    await page.settle()
    assert page.state.sound, page.state.problems
    assert "stay" in page.state.links
    assert isinstance(await page.ask(say.Insert, snippet="wire", fields={"name": "thread"}), say.Refusal)
    assert isinstance(await page.ask(say.Insert, snippet="wire", fields={"name": 'a"\n[x'}), say.Refusal)


@pytest.mark.parametrize("snippet", snippets(), ids=lambda each: each.name)
def test_every_snippet_is_sound_as_it_is_offered(snippet):
    """Under a name that is free, and a part that is there."""
    own = {"name": f"own{snippet.name}", "part": "neck", "names": "C1-C3"}
    written = insert(TEXT, snippet.name, {name: own.get(name, text) for name, text in snippet.fields.items()})
    assert check(loads(written)) == ()


def test_strangers_are_refused(studio):
    server, do = studio
    host = f"127.0.0.1:{server.port}"

    async def status(path, **headers):
        try:
            async with connect(f"ws://{host}{path}", additional_headers=headers, origin=headers.pop("Origin", None), proxy=None):
                return 101
        except InvalidStatus as error:
            return error.response.status_code

    async def closed(first):
        connection = await connect(f"ws://{host}/socket", origin=f"http://{host}", proxy=None)
        with contextlib.suppress(ConnectionClosed):
            await connection.send(first)
            while True:
                assert "guide" not in await asyncio.wait_for(connection.recv(), PATIENCE)
        return connection.close_code

    async def all_of_it():
        assert await status("/socket", Origin="http://evil.example") == 403
        assert await status("/socket") == 403
        own = f"Upgrade: websocket\r\nConnection: Upgrade\r\nOrigin: http://{host}\r\nOrigin: http://{host}"
        assert b" 403 " in (await _got(server.port, "/socket", f"{host}\r\n{own}")).split(b"\r\n")[0]
        assert await closed(encode(say.Hello("wrong", say.VERSION))) == 1008
        assert await closed(encode(say.Hello("", say.VERSION)).replace('""', '"\\ud800"')) == 1008
        assert await closed(encode(say.Undo(1))) == 1008
        assert await closed("x" * 10) == 1008
        assert await closed("x" * (LARGEST + 1)) == 1009
        page = await _got(server.port, "/")
        assert b" 200 " in page.split(b"\r\n")[0]
        assert b"Content-Security-Policy: default-src 'self'" in page
        assert server.token.encode() not in page
        assert b" 403 " in (await _got(server.port, "/", "evil.example")).split(b"\r\n")[0]
        assert b" 403 " in (await _got(server.port, "/", f"evil.example:{server.port}")).split(b"\r\n")[0]
        for path in ("/../pyproject.toml", "/protocol.py", "/static/studio.js", "/report/../guide.toml", "/%2e%2e/a", "//studio.js", "//["):
            assert b" 404 " in (await _got(server.port, path)).split(b"\r\n")[0], path

    do(all_of_it())


@on_page
async def test_random_requests_are_answered_and_none_of_them_is_a_failure_of_the_program(page, studio):
    """All kinds but those that start a long computation, with values that their fields may have."""
    chance = random.Random(3)  # noqa: S311 nothing secret
    some = {
        str: [THICKNESS, "left", "platform.x", "B", "", "1 mm", "+10 %", "\0", "x" * 5000],
        int: [0, -1, 7, 2**53 - 1],
        float: [0.0, 1e-3, -1.0, 1e308, -1e308, 5e-324],
    }

    def value(hint):
        origin, inner = get_origin(hint), get_args(hint)
        if origin in (types.UnionType, Union):
            return value(chance.choice(inner))
        if origin is Literal:
            return chance.choice(inner)
        if origin is tuple:
            return tuple(value(inner[0]) for _ in range(chance.randrange(3)))
        if origin is dict:
            return {value(str): value(inner[1]) for _ in range(chance.randrange(3))}
        return chance.choice(some[hint]) if hint in some else chance.random() < 0.5 if hint is bool else None

    kinds = sorted({*leaves(say.Request)} - {say.Hello, say.Run, say.Derive, say.Travel, say.Save}, key=lambda each: each.__name__)
    for _ in range(400 if os.environ.get("FLEXSTAGE_TESTS") == "full" else 40):
        kind = chance.choice(kinds)
        fields = {name: value(hint) for name, hint in get_type_hints(kind).items() if name != "id"}
        said = await page.ask(kind, **fields)
        assert not any("internal error of flexstage" in each.what for each in getattr(said, "problems", ())), (kind, fields, said)
    await page.ask(say.Look, panes=())
    long = await page.ask(say.Run, command="identify", study=None, record="x" * 5000, options=())
    assert isinstance(long, say.Refusal)
    assert "record not found" in long.problems[0].what


@on_page
async def test_nonsense_of_a_page_is_answered(page, studio):
    page._answers[0] = asyncio.get_running_loop().create_future()
    await page.connection.send('{"kind": "nothing"}')
    said = await asyncio.wait_for(page._answers[0], PATIENCE)
    assert "unknown kind" in said.problems[0].what
    said = await page.ask(say.Drag, address="nothing", value=1.0)
    assert said.problems
    said = await page.ask(say.Rest, address=THICKNESS, value=-1.0)
    assert isinstance(said, say.Refusal)
    for low, high in ((0.0, 1.0), (-1e308, 1.0), (2.0, 1.0), (1.0, 1e308)):
        said = await page.ask(say.Respond, inputs=(), outputs=(), low=low, high=high)
        assert "is not a band" in said.problems[0].what


STUDY = """format = "flexstage study 1"
[variables]
t = { address = "parts.leaf.thickness", from = "0.8 mm", to = "1.2 mm" }
[responses]
f = "frequency.platform.1"
[sweep]
sampling = "sobol"
designs = 8
"""
PROGRAM = """
import pathlib, sys, time
words = sys.argv[1:]
study = pathlib.Path(words[1]).read_text()
design = next(line for line in study.splitlines() if line.startswith("design")).split('"')[1]
assert '"0.8 mm"' in pathlib.Path(words[1]).with_name(design).read_text()
print("progress 0.2500 3.0 a quarter", file=sys.stderr, flush=True)
print(f"read {pathlib.Path(words[1]).with_name(design)}, {words[1]}", flush=True)
print(f"Wrote {words[words.index('--report') + 1]}", flush=True)
while "--wait" in words:
    time.sleep(0.1)
pathlib.Path(words[words.index("--report") + 1]).write_text(f"<html>{design}</html>")
"""


@on_page
async def test_a_job_tells_its_progress_and_opens_its_report(page, studio):
    """A program in the place of the command line, which takes what that takes."""
    jobs = studio.session.jobs
    jobs.program, real = ("-c", PROGRAM), jobs.program
    try:
        await page.ask(say.Set, address=THICKNESS, text="0.8 mm")
        first = await page.ask(say.Run, command="sweep", study=STUDY, record=None, options=())
        second = await page.ask(say.Run, command="sweep", study=STUDY, record=None, options=("--wait",))
        third = await page.ask(say.Run, command="sweep", study=STUDY, record=None, options=())
        await page.ask(say.Cancel, job=third.job)
        await page.until(lambda page: _job(page, second).state == "runs" and _job(page, second).fraction)
        assert (_job(page, second).text, _job(page, second).left) == ("a quarter", 3.0)
        await page.ask(say.Cancel, job=second.job)
        await page.until(lambda page: _job(page, first).report)
        assert [_job(page, each).state for each in (first, second, third)] == ["done", "cancelled", "cancelled"]
        file = studio.session.stored.path.name
        assert _job(page, first).said == (f"read {file}, study",)  # by the user's names, without files of the studio's own
        answer = await _got(studio.port, _job(page, first).report)
        assert b"Content-Security-Policy: sandbox" in answer
        assert answer.endswith(f"<html>{file}</html>".encode())
        for _ in range(100):  # a job that is ended cleans up by itself
            if not list(jobs_folder(studio).glob(".*studio*")):
                break
            await asyncio.sleep(0.05)
        assert not list(jobs_folder(studio).glob(".*studio*"))
    finally:
        jobs.program = real


SET_UP = """
import pathlib, sys
words = sys.argv[1:]
print(pathlib.Path(words[words.index("--setup") + 1]).read_text())
if "--record" in words:
    print("on", words[words.index("--record") + 1])
pathlib.Path(words[words.index("--report") + 1]).write_text("")
"""


@on_page
async def test_a_loop_has_the_set_up_that_was_written(page, studio):
    jobs = studio.session.jobs
    jobs.program, real = ("-c", SET_UP), jobs.program
    try:
        said = await page.ask(say.Run, command="loop", study='format = "flexstage loop 1"', record=None, options=())
        await page.until(lambda page: _job(page, said).report)
        assert _job(page, said).said == ('format = "flexstage loop 1"',)
        record = jobs_folder(studio) / "test.csv"
        record.write_text("")
        measured = await page.ask(say.Run, command="loop", study='format = "flexstage loop 1"', record="test.csv", options=())
        await page.until(lambda page: _job(page, measured).report)
        assert _job(page, measured).said == ('format = "flexstage loop 1"', f"on {record}")
    finally:
        jobs.program = real


def _job(page, said):
    return page.told[say.Jobs].jobs[said.job - 1]


def jobs_folder(studio):
    return studio.session.stored.path.parent


@on_page
async def test_jobs_that_cannot_be_are_refused(page, studio):
    for fields in (
        {"command": "identify", "study": None, "record": "nowhere.uff", "options": ()},
        {"command": "loop", "study": None, "record": "nowhere.uff", "options": ()},
        {"command": "sweep", "study": None, "record": None, "options": ()},
        {"command": "design", "study": None, "record": None, "options": ()},
        {"command": "loop", "study": None, "record": None, "options": ("--json=/tmp/x",)},
        {"command": "loop", "study": None, "record": None, "options": ("--hardware=x.c",)},
    ):
        assert isinstance(await page.ask(say.Run, **fields), say.Refusal)
    assert isinstance(await page.ask(say.Cancel, job=99), say.Refusal)


LIMITED = ("analyse", "loop") if os.environ.get("FLEXSTAGE_TESTS") != "full" else ("analyse", "loop", "sweep", "optimise", "verify")


@pytest.mark.parametrize("command", LIMITED)
def test_key_figures_are_those_of_the_result(command, tmp_path):
    (tmp_path / "guide.toml").write_text(TEXT)
    base = STUDY.partition("[sweep]")[0].replace("[variables]", 'design = "guide.toml"\n[variables]')
    (tmp_path / "study.toml").write_text(base + ('[optimise]\nmaximise = "f"' if command == "optimise" else "[sweep]\ndesigns = 8"))
    study, document = command in ("sweep", "optimise"), tmp_path / "result.json"
    extra = {"loop": ["--quick"], "verify": ["--accuracy", "5 %"], "sweep": ["-o", str(tmp_path / "r.h5")]}.get(command, [])
    assert run([command, str(tmp_path / ("study.toml" if study else "guide.toml")), *extra, "--json", str(document)]) == 0
    found = {each.name: (each.value, each.si) for each in key_figures(json.loads(document.read_text()))}
    assert all(value is None or np.isfinite(value) for value, _ in found.values())
    if command == "analyse":
        expected = {each.requirement.key: float(each.value) for each in judge(loads(TEXT))}
        assert {name: value for name, (value, _) in found.items()} == pytest.approx(expected)
        assert found["frequency.platform.1"][1] == "Hz"
    elif command == "loop":
        assert {"bandwidth x", "gain margin x", "phase margin x", "peak sensitivity", "positioning noise relative.x"} == found.keys()
        assert 0.0 < found["phase margin x"][0] < 90.0
    else:
        assert found


SPECIFICATION = """# ours
format = "flexstage specification 1"
name = "scanner"
motion = { x = "20 um" }  # both directions
payload.mass = "30 g"
box.size = ["200 mm", "200 mm", "40 mm"]
requirements.frequency = "at least 500 Hz"
requirements.drift.z = "at most 1 um/K"
"""
VALUES = """format = "flexstage specification 1"
name = "scanner"
payload = { mass = "40 g", height = "2 mm" }
box = { size = ["200 mm", "200 mm", "40 mm"] }
requirements = { frequency = "at least 500 Hz", "drift.z" = "at most 2 um/K" }
motion = { x = "20 um", y = "20 um" }
make = { step = "1 um" }
together = true
"""


@on_page
async def test_a_specification_keeps_its_comments_and_has_all_errors_by_address(page, studio):
    assert loads_specification(specify("", "", "").text) is not None
    found = await page.ask(say.Specify, text=SPECIFICATION, file="", values="")
    assert (found.text, found.problems) == (SPECIFICATION, ())
    assert found.values["requirements"] == {"frequency": "at least 500 Hz", "drift.z": "at most 1 um/K"}
    changed = await page.ask(say.Specify, text=SPECIFICATION, file="", values=VALUES)
    assert changed.values == tomllib.loads(VALUES)
    assert "# ours" in changed.text
    assert "# both directions" in changed.text
    again = await page.ask(say.Specify, text="", file="", values="")
    assert again.text == changed.text  # a page that is loaded again begins with the last one
    wrong = await page.ask(say.Specify, text=SPECIFICATION, file="", values=VALUES.replace('"20 um"', '"20"').replace("mass", "weight"))
    assert {each.where for each in wrong.problems} == {"motion.x", "motion.y", "payload", "payload.weight"}
    torn = await page.ask(say.Specify, text="x = ", file="", values="")
    assert torn.values is None
    assert [each.where for each in torn.problems] == ["specification"]


@on_page
async def test_a_specification_is_saved_and_is_no_design(page, studio):
    folder = jobs_folder(studio)
    await page.ask(say.SaveSpecification, text=SPECIFICATION, file="spec.toml", over=False)
    assert (folder / "spec.toml").read_text() == SPECIFICATION
    for file, over in (("spec.toml", False), (studio.session.stored.path.name, True), ("../spec.toml", True)):
        assert isinstance(await page.ask(say.SaveSpecification, text="", file=file, over=over), say.Refusal)
    await page.ask(say.SaveSpecification, text=VALUES, file="spec.toml", over=True)
    assert (await page.ask(say.Specify, text="", file="spec.toml", values="")).text == VALUES
    listed = await page.ask(say.Browse)
    assert "spec.toml" in listed.files
    assert listed.specifications == ("spec.toml",)


DESIGN = """
import json, pathlib, sys, time
words = sys.argv[1:]
design = pathlib.Path(words[words.index("--answer") + 1]).read_text()
assert "20 um" in pathlib.Path(words[1]).read_text()
say = lambda **part: print("result", json.dumps(part), file=sys.stderr, flush=True)
row = {"architecture": "guide", "goal": "", "file": "", "design": ""}
say(pair={**row, "actuator": "small", "reason": "too weak"})
say(pair={**row, "actuator": "large", "goal": "1 kHz", "reason": "", "file": "guide-large", "design": design})
print("result {", file=sys.stderr, flush=True)
while "--wait" in words:
    time.sleep(0.1)
say(pair={**row, "actuator": "large", "goal": "2 kHz", "reason": "", "file": "guide-large", "design": design})
say(tables=[("Stages", [["", "architecture"], ["1", "guide"]], ["A note."])])
"""


@on_page
async def test_pairs_of_a_design_appear_as_they_finish_stay_after_a_stop_and_open(page, studio):
    """A program in the place of the command line, which writes its lines."""
    jobs, path = studio.session.jobs, studio.session.stored.path
    answer = path.with_name("other.toml")
    answer.write_text(TEXT.replace("A guide.", "An answer."))
    jobs.program, real = ("-c", DESIGN), jobs.program
    options = ("--answer", str(answer))
    try:
        stopped = await page.ask(say.Run, command="design", study=SPECIFICATION, record=None, options=(*options, "--wait"))
        await page.until(lambda page: len(_job(page, stopped).pairs) == 2)
        assert _job(page, stopped).state == "runs"
        await page.ask(say.Cancel, job=stopped.job)
        ended = await page.ask(say.Run, command="design", study=SPECIFICATION, record=None, options=options)
        await page.until(lambda page: _job(page, ended).state == "done")
    finally:
        jobs.program = real
    rows = [(each.actuator, each.goal, each.reason) for each in _job(page, stopped).pairs]
    assert rows == [("small", "", "too weak"), ("large", "1 kHz", "")]
    assert [(each.actuator, each.goal) for each in _job(page, ended).pairs] == [("small", ""), ("large", "2 kHz")]
    assert _job(page, ended).tables == (say.ResultTable("Stages", (("", "architecture"), ("1", "guide")), ("A note.",)),)
    asked = {"file": "new.toml", "case": "", "job": stopped.job, "pair": "guide with large"}
    await page.ask(say.Set, address=THICKNESS, text="0.8 mm")
    for fields in ({"discard": False}, {"discard": True, "pair": "guide with small"}, {"discard": True, "file": "other.toml"}):
        assert isinstance(await page.ask(say.Open, **asked | fields), say.Refusal)
    assert not path.with_name("new.toml").exists()
    assert '"0.8 mm"' in page.state.text
    await page.ask(say.Open, **asked, discard=True)
    assert studio.session.stored.path.name == "new.toml"
    assert studio.session.stored.text == answer.read_text()
    late = await opened(studio)
    await late.until(lambda page: say.Jobs in page.told)  # a page that is loaded again shows the rows
    await late.close()
    await page.ask(say.Open, file=path.name, case="", discard=True, job=None, pair="")


@pytest.mark.full
@on_page
async def test_the_tables_of_a_design_job_are_those_of_the_command(page, studio):
    spec = SPECIFICATION.replace("requirements.drift", "# requirements.drift")
    said = await page.ask(say.Run, command="design", study=spec, record=None, options=("--architecture", "guide", "--workers", "1"))
    await page.until(lambda page: _job(page, said).state in ("done", "failed"))
    expected = list(answer_tables(find_designs(loads_specification(spec), ("guide",))))
    found = _job(page, said)
    assert [(each.title, [list(row) for row in each.rows], each.notes) for each in found.tables] == [
        (each.title, each.texts(), each.notes) for each in expected
    ]
    assert found.report
    assert {(each.architecture, each.actuator) for each in found.pairs if each.file} == {
        (row[1], row[2]) for row in found.tables[0].rows[1:]
    }


@pytest.mark.full
@on_page
async def test_a_sweep_of_the_text_that_is_not_saved(page, studio):
    await page.ask(say.Set, address=THICKNESS, text="0.8 mm")
    said = await page.ask(say.Run, command="sweep", study=STUDY, record=None, options=())
    await page.until(lambda page: say.Jobs in page.told and _job(page, said).state in ("done", "failed"))
    assert _job(page, said).state == "done", _job(page, said)
    assert b"<html" in await _got(studio.port, _job(page, said).report)


@on_page
async def test_what_takes_long_is_told_before(page, studio):
    await page.settle()
    await asyncio.gather(*studio.session._work)
    studio.session._took["figures"] = (4.0, len(page.state.links))
    heard = []
    tell, studio.session._tell = studio.session._tell, lambda message: (heard.append(message), tell(message))
    await page.ask(say.Set, address=THICKNESS, text="0.8 mm")
    await page.settle()
    studio.session._tell = tell
    (told,) = (each for each in heard if isinstance(each, say.Engine) and each.state == "computes")
    assert told.seconds == 4.0
    assert heard.index(told) < next(place for place, each in enumerate(heard) if isinstance(each, say.Figures))


def test_what_cannot_be_opened_is_refused(studio, tmp_path, capsys):
    port = str(studio[0].port)
    (tmp_path / "wrong.toml").write_text("x = ")
    for words, told in (
        ((tmp_path / "nowhere.toml",), "file not found"),
        ((tmp_path,), "not a file but a folder"),
        ((tmp_path / "wrong.toml", "--port", port), f"--port {port}: cannot listen on this port: Address already in use"),
    ):
        assert run(["studio", "--no-browser", *map(str, words)]) == 2
        assert told in capsys.readouterr().err


async def _got(port, path, host=None):
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(f"GET {path} HTTP/1.1\r\nHost: {host or f'127.0.0.1:{port}'}\r\n\r\n".encode())
    answer = await asyncio.wait_for(reader.read(), PATIENCE)
    writer.close()
    return answer
