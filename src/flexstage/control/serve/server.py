"""Virtual controller on a loopback socket: it answers clients, and synchronises simulated time with the clock."""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import time
from collections.abc import Callable
from dataclasses import dataclass

from flexstage.base.finding import refuse
from flexstage.base.processes.threads import one_thread
from flexstage.control.serve.controller import StageController
from flexstage.control.serve.gcs import LONGEST, Session

HOST = "127.0.0.1"
PORT = 50_000
"""Default TCP port."""
CLIENTS = 16
_CHUNK = 200
"""Samples per simulation block; clients are served in between."""
_LATEST = 1.0
"""Largest lag [s] that the simulation recovers."""
_TURN = 500
"""Lines of one client answered before the others are served."""
_SINGLE = b"\x05\x07\x09\x18"
_READ = 65_536
_HTTP = re.compile(rb"\s*(?:GET|HEAD|POST|PUT|PATCH|DELETE|CONNECT|OPTIONS|TRACE|PRI)\s|.*\sHTTP/\d", re.IGNORECASE)
"""HTTP requests of any version, also without the version if the line is too long."""


@dataclass
class Pace:
    """Lag [s] of simulated time behind the clock: `offset` is the clock time at zero simulated time, `most` is the largest lag.

    `lost` is the total time that was not simulated.
    """

    offset: float
    most: float = 0.0
    lost: float = 0.0

    def behind(self, clock: float, seconds: float) -> float:
        """Return the lag [s] behind the clock. A lag of more than a second counts as lost time, which is not simulated.

        >>> pace = Pace(offset=100.0)
        >>> round(pace.behind(100.25, 0.125), 3), round(pace.behind(102.125, 0.125), 3), round(pace.behind(102.25, 0.125), 3)
        (0.125, 0.0, 0.125)
        >>> pace.most, pace.lost
        (2.0, 2.0)
        """
        late = clock - self.offset - seconds
        self.most = max(self.most, late)
        if late <= _LATEST:
            return late
        self.lost += late
        self.offset += late
        return 0.0


class ServedStage:
    """Stage controlled by clients. If not `paced`, the simulation runs as fast as possible while a client is connected."""

    def __init__(self, stage: StageController, port: int = PORT, *, paced: bool = True) -> None:
        self.stage, self.port = stage, port
        self.pace = Pace(time.perf_counter() - stage.seconds) if paced else None
        """Pace of the simulation; None if the simulation runs as fast as possible."""
        self._server: asyncio.Server | None = None
        self._tasks: set[asyncio.Task[None]] = set()
        self._clients: set[asyncio.Task[None]] = set()

    async def start(self) -> None:
        """Listen for clients, and start simulated time. Raises `DesignError` if the port is in use."""
        try:
            self._server = await asyncio.start_server(self._client, HOST, self.port, limit=_READ)
        except OSError as error:
            what = f"cannot listen: {os.strerror(error.errno) if error.errno else error}"
            raise refuse(f"--port {self.port}", what, "Use another port, or 0 for any free port") from None
        self.port = self._server.sockets[0].getsockname()[1]
        self._tasks.add(asyncio.create_task(self._race() if self.pace is None else self._follow(self.pace)))

    async def stop(self) -> None:
        """Stop the server and all clients."""
        for each in (*self._clients, *self._tasks):
            each.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await each
        if self._server is not None:
            self._server.close()

    # --- time ---

    async def _follow(self, pace: Pace) -> None:
        """Synchronise simulated time with the clock."""
        pace.offset = time.perf_counter() - self.stage.seconds
        while True:
            behind = int(pace.behind(time.perf_counter(), self.stage.seconds) / self.stage.step)
            self._advance(min(behind, _CHUNK))
            await asyncio.sleep(0.0 if behind > _CHUNK else 0.001)

    async def _race(self) -> None:
        while True:
            if self._clients:
                self._advance(_CHUNK)
            await asyncio.sleep(0.0 if self._clients else 0.01)

    @one_thread
    def _advance(self, count: int) -> None:
        self.stage.advance(count)

    # --- clients ---

    async def _client(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve one client, from its first line to its end."""
        task = asyncio.current_task()
        if task is None or len(self._clients) >= CLIENTS:
            writer.close()
            return
        self._clients.add(task)
        try:
            await self._talk(reader, writer)
        except (ConnectionError, asyncio.CancelledError):
            pass
        finally:
            self._clients.discard(task)
            writer.close()

    async def _talk(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        session, lines = Session(self.stage), _Lines()
        while received := await reader.read(_READ):
            found = lines.split(received)
            for start in range(0, len(found), _TURN):
                turn = found[start : start + _TURN]
                if any(map(_HTTP.match, turn)):  # refuse pages of a browser
                    return
                size = 0
                for line in turn:
                    answer = session.hear(line)
                    writer.write(answer)
                    await writer.drain()  # wait for slow clients
                    size += len(answer)
                    if size > _READ:  # after long answers, serve the other clients
                        size = 0
                        await asyncio.sleep(0.0)
                await asyncio.sleep(0.0)


class _Lines:
    """Received text split into lines; single-character commands are lines. The remainder of an overlong line is dropped."""

    def __init__(self) -> None:
        self._rest = b""
        self._is_dropping = False

    def split(self, received: bytes) -> list[bytes]:
        """Return the complete lines."""
        for each in _SINGLE:
            if each in received:
                received = received.replace(bytes([each]), b"\n" + bytes([each]) + b"\n")
        *found, rest = received.replace(b"\r", b"").split(b"\n")
        if found:
            found[0] = b"" if self._is_dropping else self._rest + found[0]
            self._rest, self._is_dropping = rest, False
        elif not self._is_dropping:
            self._rest += rest
        if len(self._rest) > LONGEST:
            found.append(self._rest)  # answered as too long, once
            self._rest, self._is_dropping = b"", True
        return found


async def run(stage: StageController, port: int, started: Callable[[int], None], *, paced: bool) -> Pace | None:
    """Serve a stage until interrupted, and call `started` with the port. Returns the pace, or None if not `paced` by the clock."""
    served = ServedStage(stage, port, paced=paced)
    await served.start()
    try:
        started(served.port)
        await asyncio.get_running_loop().create_future()
    except asyncio.CancelledError:
        pass
    finally:
        await served.stop()
    return served.pace
