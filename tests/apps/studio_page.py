"""A page of the studio without a browser: it asks, and keeps what it is told."""

import asyncio
import base64
import contextlib
import threading
from contextlib import contextmanager

import numpy as np
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

from flexstage.apps.studio import protocol as say
from flexstage.apps.studio.server import Studio
from flexstage.apps.studio.wire import decode, encode

PATIENCE = 120.0


def array(value: say.Floats) -> np.ndarray:
    """The array that came over the wire."""
    return np.frombuffer(base64.b64decode(value.data), dtype="<f8").reshape(value.shape)


def leaves(base):
    """The messages of a base class."""
    below = base.__subclasses__()
    return [kind for each in below for kind in leaves(each)] if below else [base]


class Page:
    """One window: `told` are the newest pushes by kind, `counts` how many of each there were, `engine` all that the engine did."""

    def __init__(self, connection):
        self.connection = connection
        self.told, self.counts, self.bytes, self.engine = {}, {}, 0, []
        self._number = self.revision = 0
        self._answers = {}
        self._news = asyncio.Event()
        self._listener = asyncio.create_task(self._listen())

    async def _listen(self):
        async for text in _texts(self.connection):
            self.bytes += len(text)
            message = decode(text, say.Said)
            kind = type(message)
            self.counts[kind] = self.counts.get(kind, 0) + 1
            if hasattr(message, "to"):
                self._answers[message.to].set_result(message)
            else:
                self.told[kind] = message
                self.engine += [message.state] if kind is say.Engine else []
            self._news.set()

    def begin(self, kind, **fields):
        """Ask, and wait for the answer later."""
        self._number += 1
        answer = self._answers[self._number] = asyncio.get_running_loop().create_future()
        return asyncio.gather(self.connection.send(encode(kind(id=self._number, **fields))), answer)

    async def ask(self, kind, **fields):
        answer = (await asyncio.wait_for(self.begin(kind, **fields), PATIENCE))[1]
        self.revision = max(self.revision, getattr(answer, "revision", 0))
        return answer

    async def until(self, true):
        """Wait until something holds of the page."""
        async with asyncio.timeout(PATIENCE):
            while not true(self):
                self._news.clear()
                await self._news.wait()

    async def settle(self, last=say.Warnings):
        """Wait until the present text is computed."""
        await self.until(lambda page: say.State in page.told and page.state.revision >= page.revision)
        await self.until(lambda page: last in page.told and page.told[last].revision == page.state.revision)

    @property
    def state(self):
        return self.told[say.State]

    async def close(self):
        await self.connection.close()
        self._listener.cancel()

    async def edit_on(self, text):
        """Edit until the connection ends: the number of the last edit that was acknowledged, and of the last one that was sent."""
        known = number = 0
        with contextlib.suppress(ConnectionClosed):
            while not self._listener.done():
                number += 1
                answer = asyncio.ensure_future(self.begin(say.Edit, text=text(number), revision=self.state.revision))
                await asyncio.wait([answer, self._listener], return_when=asyncio.FIRST_COMPLETED)
                known = number if answer.done() and isinstance(answer.result()[1], say.Done) else known
        return known, number


async def _texts(connection):
    """What is heard until the connection ends, however it does."""
    with contextlib.suppress(ConnectionClosed):
        async for text in connection:
            yield text


async def opened(studio, token=None):
    host = f"127.0.0.1:{studio.port}"
    connection = await connect(f"ws://{host}/socket", origin=f"http://{host}", max_size=None, compression=None)
    await connection.send(encode(say.Hello(studio.token if token is None else token, say.VERSION)))
    return Page(connection)


@contextmanager
def served(path):
    """A studio in a thread of its own, and what runs coroutines there."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever)
    thread.start()

    def do(work):
        return asyncio.run_coroutine_threadsafe(work, loop).result(2 * PATIENCE)

    async def made():
        studio = Studio(path)
        await studio.start()
        return studio

    studio = do(made())
    try:
        yield studio, do
    finally:
        do(studio.stop())
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()
