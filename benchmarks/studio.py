"""The studio: processor time of opening a stage, of a design while a slider moves, and after it rests; messages and bytes.

`python benchmarks/studio.py [LINKS]`: with a number, a stage of about so many links is opened too, and its stages of computation are timed.
"""

from __future__ import annotations

import os

os.environ |= dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import asyncio
import sys
import tempfile
import time
from pathlib import Path

import psutil
from websockets.asyncio.client import connect

from flexstage.apps.studio import protocol as say
from flexstage.apps.studio.wire import decode_said, encode
from flexstage.cases.registry import case
from flexstage.mechanism.store import dumps

ADDRESS = "parts.neck.thickness"
DESIGNS = 100


class Page:
    """A page that counts what it is told."""

    def __init__(self, connection: object) -> None:
        self.connection, self.told, self.bytes, self.number = connection, {}, 0, 0

    async def until(self, true: object) -> object:
        """The message that is waited for."""
        while True:
            text = await self.connection.recv()
            self.bytes += len(text)
            message = decode_said(text)
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
    command = (sys.executable, "-m", "flexstage", "studio", str(stage), "--no-browser")
    process = await asyncio.create_subprocess_exec(*command, stderr=asyncio.subprocess.PIPE)
    try:
        line = (await process.stderr.readline()).decode()
        await measure(psutil.Process(process.pid), line.split()[-1], stage, links)
    finally:
        process.terminate()
        await process.wait()


async def measure(studio: psutil.Process, url: str, stage: Path, links: int) -> None:
    """What the studio at an address costs."""
    page = await opened(url)
    await page.until(lambda message: isinstance(message, say.Figures))
    print(f"until figures, from the command on: {spent(studio):.2f} s")
    await page.until(lambda message: isinstance(message, say.Cautions))
    print(f"until cautions: {spent(studio):.2f} s, {page.bytes} bytes")
    row = next(each for each in page.told[say.State].amounts if each.address == ADDRESS)
    await page.ask(say.Line, line=1)  # the second process has started then
    await page.ask(say.Drag, address=ADDRESS, value=row.value)
    before = spent(studio)
    await page.ask(say.Grip, address=ADDRESS, low=row.low, high=row.high)
    while not (await page.ask(say.Drag, address=ADDRESS, value=row.value)).fitted:
        await asyncio.sleep(0.02)
    print(f"a plan fitted over a slider's range: {1e3 * (spent(studio) - before):.0f} ms")
    before, sent = spent(studio), page.bytes
    for number in range(DESIGNS):
        await page.ask(say.Drag, address=ADDRESS, value=row.value * (1.0 + 0.002 * number))
    print(f"a design while the slider moves: {1e3 * (spent(studio) - before) / DESIGNS:.2f} ms, {(page.bytes - sent) // DESIGNS} bytes")
    for number in range(3):
        before, sent, page.told = spent(studio), page.bytes, {}
        await page.ask(say.Rest, address=ADDRESS, value=row.value * (1.01 + 0.01 * number))
        await page.until(lambda message: isinstance(message, say.Cautions))
        parts = [page.told[each].milliseconds for each in (say.Figures, say.Verdicts, say.Reach)]
        figures, verdicts, reach = (f"{each:.0f}" for each in parts)
        print(
            f"after it rests: figures {figures}, verdicts {verdicts}, reach {reach} ms; all with text, geometry and cautions"
            f" {1e3 * (spent(studio) - before):.0f} ms, {page.bytes - sent} bytes"
        )
    if links:
        text = stage.read_text(encoding="utf-8").replace("[place.B1-B3]", f"[place.B1-B{links // 3}]").replace("B4-B6", "C4-C6")
        begun = time.monotonic()
        await page.ask(say.Edit, text=text, revision=page.told[say.State].revision)
        while say.Cautions not in page.told or page.told[say.Cautions].revision < page.told[say.State].revision:
            message = await page.until(lambda _: True)
            if isinstance(message, (say.Engine, say.Figures, say.Verdicts, say.Reach, say.Scene, say.Cautions)):
                told = f"{message.text}, {message.seconds} s" if isinstance(message, say.Engine) else ""
                print(f"{links} links, {time.monotonic() - begun:.1f} s: {type(message).__name__} {told}")


async def opened(url: str) -> Page:
    """A page that is let in."""
    host, token = url.removeprefix("http://").split("/#")
    page = Page(await connect(f"ws://{host}/socket", origin=f"http://{host}", max_size=None, compression=None, proxy=None))
    await page.connection.send(encode(say.Hello(token, say.VERSION)))
    return page


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        asyncio.run(measured(Path(made), int(sys.argv[1]) if len(sys.argv) > 1 else 0))
