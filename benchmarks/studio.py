"""The studio: processor time of opening a stage, of a design while a slider moves, and after it rests; messages and bytes.

All times are processor time of the server and all its processes, as the system counts it (hundredths of a second), so they hold on a busy
machine as far as its caches do. A rest is taken apart by where it stands:

- until verdicts: the number written into the text, text read and checked, numbers told; stiffness, lost motion, modes and responses;
  requirements. Nothing of the page's other panes is asked before.
- in view: besides, the picture, strokes and strength, and warnings: all that a page shows as it is opened (Figures in front, no motion).
- with another pane in front: the same without strokes and strength, which are computed when Figures are opened again.
- all: with the motions of the picture too, as where one plays.

What numbers buy is asked by the page beside, in a process of its own, and told by itself.

`python benchmarks/studio.py [LINKS]`: with a number, a stage of about so many links is opened too, and its stages of computation are timed.
"""

from __future__ import annotations

import os

os.environ |= dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # installed programs do not translate their modules at every start

import asyncio
import contextlib
import sys
import tempfile
import time
from collections.abc import AsyncIterator
from pathlib import Path

import psutil
from websockets.asyncio.client import connect

from flexstage.apps.studio import protocol as say
from flexstage.apps.studio.wire import decode, encode
from flexstage.cases.registry import case
from flexstage.mechanism.store import dumps

ADDRESS = "parts.neck.thickness"
DESIGNS, RESTS = 100, 5


class Page:
    """A page that counts what it is told."""

    def __init__(self, connection: object) -> None:
        self.connection, self.told, self.bytes, self.number = connection, {}, 0, 0

    async def until(self, true: object) -> object:
        """The message that is waited for."""
        while True:
            text = await self.connection.recv()
            self.bytes += len(text)
            message = decode(text, say.Said)
            self.told[type(message)] = message
            if true(message):
                return message

    async def ask(self, kind: type, **fields: object) -> object:
        """Ask, and wait for the answer."""
        self.number += 1
        number = self.number
        await self.connection.send(encode(kind(id=number, **fields)))
        return await self.until(lambda message: getattr(message, "to", None) == number)


def spent(studio: psutil.Process) -> float:
    """Processor time of the server and of its processes [s]."""
    return sum(sum(each.cpu_times()[:2]) for each in (studio, *studio.children(recursive=True)))


async def measured(folder: Path, links: int) -> None:
    """Everything, one after another."""
    stage = folder / "stage.toml"
    stage.write_text(dumps(case("double-triangle")), encoding="utf-8")
    async with started(stage) as (_, url):
        await (await opened(url)).until(lambda message: isinstance(message, say.Warnings))  # all modules are translated then
    async with started(stage) as (studio, url):
        await measure(studio, url, stage, links)


@contextlib.asynccontextmanager
async def started(stage: Path) -> AsyncIterator[tuple[psutil.Process, str]]:
    """A studio of a file: its process and its address."""
    command = (sys.executable, "-m", "flexstage", "studio", str(stage), "--no-browser")
    process = await asyncio.create_subprocess_exec(*command, stderr=asyncio.subprocess.PIPE)
    try:
        yield psutil.Process(process.pid), (await process.stderr.readline()).decode().split()[-1]
    finally:
        process.terminate()
        await process.wait()


async def measure(studio: psutil.Process, url: str, stage: Path, links: int) -> None:
    """What the studio at an address costs."""
    page = await opened(url)
    await page.until(lambda message: isinstance(message, say.Figures))
    print(f"until figures, from the command on: {spent(studio):.2f} s")
    await page.until(lambda message: isinstance(message, say.Warnings))
    print(f"until warnings: {spent(studio):.2f} s, {page.bytes} bytes")
    row = next(each for each in page.told[say.State].amounts if each.address == ADDRESS)
    await page.ask(say.Line, line=1)  # the second process has started then
    await page.ask(say.Drag, address=ADDRESS, value=row.value)
    before, sent = spent(studio), page.bytes
    for number in range(DESIGNS):
        await page.ask(say.Drag, address=ADDRESS, value=row.value * (1.0 + 0.002 * number))
    print(f"a design while the slider moves: {1e3 * (spent(studio) - before) / DESIGNS:.2f} ms, {(page.bytes - sent) // DESIGNS} bytes")
    for said, panes in (("in view", ("stage", "reach")), ("another pane in front", ("stage",)), ("all", ("stage", "motions", "reach"))):
        await page.ask(say.Look, panes=panes)
        await asyncio.sleep(1.0)  # what is looked at anew is computed
        rests = [await rest(studio, page, row.value * (1.01 + 0.01 * number + 0.001 * len(said))) for number in range(RESTS)]
        until, whole, size = (sorted(each)[RESTS // 2] for each in zip(*rests, strict=True))
        print(f"after it rests, {said}: until verdicts {1e3 * until:.0f} ms, then to the end {1e3 * whole:.0f} ms, {size} bytes (medians)")
    before = spent(studio)
    await page.ask(say.Derive)
    print(f"what numbers buy, with the start of its process: {1e3 * (spent(studio) - before):.0f} ms")
    await rest(studio, page, row.value)
    between = spent(studio)
    await page.ask(say.Derive)
    print(f"what numbers buy, of the next design: {1e3 * (spent(studio) - between):.0f} ms")
    if links:
        text = stage.read_text(encoding="utf-8").replace("[placements.B1-B3]", f"[placements.B1-B{links // 3}]").replace("B4-B6", "C4-C6")
        begun = time.monotonic()
        await page.ask(say.Edit, text=text, revision=page.told[say.State].revision)
        while say.Warnings not in page.told or page.told[say.Warnings].revision < page.told[say.State].revision:
            message = await page.until(lambda _: True)
            if isinstance(message, (say.Engine, say.Figures, say.Verdicts, say.Reach, say.Scene, say.Warnings)):
                told = f"{message.text}, {message.seconds} s" if isinstance(message, say.Engine) else ""
                print(f"{links} links, {time.monotonic() - begun:.1f} s: {type(message).__name__} {told}")


async def rest(studio: psutil.Process, page: Page, value: float) -> tuple[float, float, int]:
    """Processor time [s] until verdicts, and until all that is looked at is told; bytes."""
    before, sent, page.told = spent(studio), page.bytes, {}
    await page.ask(say.Rest, address=ADDRESS, value=value)
    await page.until(lambda message: isinstance(message, say.Verdicts))
    until = spent(studio) - before
    await page.until(lambda message: isinstance(message, say.Warnings))
    return until, spent(studio) - before, page.bytes - sent


async def opened(url: str) -> Page:
    """A page that is let in."""
    host, token = url.removeprefix("http://").split("/#")
    page = Page(await connect(f"ws://{host}/socket", origin=f"http://{host}", max_size=None, compression=None, proxy=None))
    await page.connection.send(encode(say.Hello(token, say.VERSION)))
    return page


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        asyncio.run(measured(Path(made), int(sys.argv[1]) if len(sys.argv) > 1 else 0))
