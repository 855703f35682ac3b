"""Unsaved edits of the studio: whatever was acknowledged is offered after the process was killed, and nothing is left after a save."""

import asyncio
import os
import signal
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import pytest

from flexstage.apps.studio import protocol as say
from flexstage.apps.studio.design.journal import Journal, drafts
from flexstage.apps.studio.server import Studio
from flexstage.base.finding import DesignError
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.store import dumps
from tests.apps.studio_page import opened, served

TEXT = dumps(parallelogram(), {"": "A guide."})
KILLS = 40 if os.environ.get("FLEXSTAGE_TESTS") == "full" else 2


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "studio"


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "guide.toml"
    path.write_bytes(TEXT.encode())
    return path


class Address:
    """Port and token of a studio in another process."""

    def __init__(self, url):
        self.port, self.token = int(url.split(":")[2].split("/")[0]), url.partition("#")[2]


@contextmanager
def started(path, *options):
    """The command `studio` in a process of its own, and its address."""
    words = [sys.executable, "-u", "-P", "-m", "flexstage", "studio", str(path), "--no-browser", *options]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
    try:
        line = next(line for line in process.stdout if "http://" in line)
        yield process, Address(line.split()[-1])
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        process.stdout.close()


def edited(number):
    return TEXT.replace("A guide.", f"Edit {number}.")


async def edit_until_killed(process, address, seconds):
    page = await opened(address)
    await page.until(lambda page: say.State in page.told)
    asyncio.get_running_loop().call_later(seconds, os.killpg, process.pid, signal.SIGKILL)
    found = await page.edit_on(edited)
    await page.close()
    return found


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="signals of POSIX")
def test_no_acknowledged_edit_is_lost_when_the_studio_is_killed(path, cache):
    chance = np.random.default_rng(7)
    acknowledged = 0
    for _ in range(KILLS):
        with started(path) as (process, address):
            known, last = asyncio.run(edit_until_killed(process, address, chance.uniform(0.05, 0.5)))
        for place, draft in drafts(path).items():
            assert draft.text in {edited(number) for number in range(known, last + 1)}
            assert (draft.port, draft.token) == (address.port, address.token)
            place.unlink()
            acknowledged += known
        assert path.read_bytes() == TEXT.encode()
    assert acknowledged > 20


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="signals of POSIX")
def test_unsaved_edits_are_offered_at_the_same_address_and_gone_after_a_save(path, cache):
    """With the pinned design; a page that was open finds the studio again by its old address."""

    async def edit(address):
        page = await opened(address)
        await page.until(lambda page: say.State in page.told)
        await page.ask(say.Pin, name="A", keep=True)
        await page.ask(say.Edit, text=edited(1), revision=page.state.revision)
        await page.close()

    async def take_back(address):
        page = await opened(address)
        await page.until(lambda page: say.State in page.told and page.state.drafts)
        (draft,) = page.state.drafts
        assert (page.state.text, draft.stale) == (TEXT, False)
        await page.ask(say.Edit, text=edited(2), revision=page.state.revision)
        assert len(drafts(path)) == 1, "what is typed before the answer replaces nothing"
        await page.ask(say.Recover, draft=draft.name, keep=True)
        await page.until(lambda page: page.state.text == edited(1))
        assert (page.state.pins, page.state.saved, page.state.drafts) == (("A",), False, ())
        await page.ask(say.Undo)
        await page.until(lambda page: page.state.text == edited(2))
        await page.ask(say.Redo)
        await page.ask(say.Save, over=False)
        await page.close()

    with started(path) as (_, first):
        asyncio.run(edit(first))
    with started(path) as (_, second):
        assert (second.port, second.token) == (first.port, first.token)
        asyncio.run(take_back(second))
        assert not list(cache.iterdir())
    assert path.read_bytes() == edited(1).encode()


def test_a_discarded_draft_is_gone_and_one_that_the_file_has_is_not_offered(path, cache):
    journal = Journal(path)
    for text, digest in ((edited(1), "other"), (TEXT, "other")):
        journal.keep(text, {}, digest)
        (own,) = cache.iterdir()
        own.rename(own.with_name(own.name.replace(f"-{os.getpid()}.json", "-999999999.json")))  # of a process that is not there
        session = Studio(path).session
        assert [each.text for each in session.drafts.values()] == ([edited(1)] if text != TEXT else [])
        if session.drafts:

            async def discard(session=session):
                said = []
                (name,) = session.drafts
                await session.answer(say.Recover(1, name, keep=False), 1, said.append)
                await session.answer(say.Recover(2, name, keep=True), 1, said.append)
                return [type(each) for each in said]

            assert asyncio.run(discard()) == [say.Done, say.Refusal]
            assert session.history.text == TEXT
        assert not list(cache.iterdir())


def test_a_cache_that_cannot_be_written_is_shown_and_the_edit_is_taken(path, tmp_path, monkeypatch):
    (tmp_path / "none").write_text("a file")
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "none" / "cache"))
    with pytest.raises(DesignError, match="cannot be created"):
        Journal(path).keep(edited(1), {}, "")

    async def edit(studio):
        page = await opened(studio)
        await page.until(lambda page: say.State in page.told)
        await page.ask(say.Edit, text=edited(1), revision=page.state.revision)
        await page.until(lambda page: page.state.text == edited(1))
        assert "cannot be created" in page.state.unprotected
        await page.close()

    with served(path) as (studio, do):
        do(edit(studio))
