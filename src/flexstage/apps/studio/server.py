"""The studio's server on the loopback address. It serves the pages, and the socket for pages with the token."""

from __future__ import annotations

import asyncio
import contextlib
import http
import os
import secrets
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from flexstage import show
from flexstage.apps.studio import protocol as say
from flexstage.apps.studio.design.history import Stored
from flexstage.apps.studio.design.journal import Journal
from flexstage.apps.studio.engine import problem
from flexstage.apps.studio.session import Session
from flexstage.apps.studio.wire import decode, encode
from flexstage.base.finding import DesignError, refuse
from flexstage.base.version import __version__

HOST = "127.0.0.1"
LARGEST = 8_000_000
"""Bytes of the largest message of a page: a text of the largest design, with JSON overhead."""
_PATIENCE = 10.0
"""Time limit for a page to send its token [s]."""
_PAGES = 16
_KEPT = (say.Welcome, say.Engine, say.State, say.Scene, say.Figures, say.Verdicts, say.Reach, say.Warnings, say.Jobs)
"""Pushed messages: only the newest of each kind is sent."""
_STUDIO, _SHOW = Path(__file__).with_name("static"), Path(show.__file__).with_name("static")
_SCRIPT, _PLAIN = "text/javascript; charset=utf-8", "text/plain; charset=utf-8"
_FILES: Mapping[str, tuple[Path, str]] = {
    "/": (_STUDIO / "studio.html", "text/html; charset=utf-8"),
    "/studio.js": (_STUDIO / "studio.js", _SCRIPT),
    "/studio.css": (_STUDIO / "studio.css", "text/css; charset=utf-8"),
    "/studio-licences.txt": (_STUDIO / "studio-licences.txt", _PLAIN),
    "/viewer.js": (_SHOW / "viewer.js", _SCRIPT),
    "/viewer-licences.txt": (_SHOW / "viewer-licences.txt", _PLAIN),
}
_POLICY = (
    "default-src 'self'; connect-src 'self' ws://{host}; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_REPORT_POLICY = (
    "sandbox allow-scripts allow-downloads allow-modals; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data: blob:; font-src data:"
)
"""Reports contain their own scripts, and can access neither the studio nor the network."""


class Studio:
    """A server of one design. `url` is the address to open. The token follows the # in the address; browsers do not send it."""

    def __init__(self, path: Path, port: int = 0) -> None:
        self.session = Session(Stored.read(path.resolve()), self._tell_all)
        last = next(iter(self.session.drafts.values()), None)
        self.token = last.token if last else secrets.token_urlsafe(24)
        self._port, self._last_port = port, last.port if last else 0
        self._server: Server | None = None
        self._pages: dict[int, Outbox] = {}
        self._count = 0
        self._work: set[asyncio.Task[Any]] = set()

    @property
    def port(self) -> int:
        """The listening port."""
        return self._port

    @property
    def url(self) -> str:
        """Address of the page with the token."""
        return f"http://{HOST}:{self._port}/#{self.token}"

    async def start(self) -> None:
        """Listen on the port, and begin to compute. Raises `DesignError` if the port is in use."""
        try:
            with contextlib.suppress(OSError):  # pages of a killed studio use this port
                self._server = await self._listen(self._last_port) if self._last_port and not self._port else None
            self._server = self._server or await self._listen(self._port)
        except OSError as error:
            what = f"cannot listen on this port: {os.strerror(error.errno) if error.errno else error}"
            raise refuse(f"--port {self._port}", what, "Choose another port, or remove --port") from None
        self._port = next(iter(self._server.sockets)).getsockname()[1]
        self.session.journal = Journal(self.session.stored.path, self._port, self.token)
        self._start(self.session.open())

    async def _listen(self, port: int) -> Server:
        return await serve(
            self._page,
            HOST,
            port,
            process_request=self._request,
            max_size=LARGEST,
            compression=None,
            server_header=None,
            ping_interval=None,
            open_timeout=_PATIENCE,
        )

    async def stop(self) -> None:
        """End the server, its pages and the session."""
        for each in tuple(self._work):
            each.cancel()
        if self._server is not None:
            self._server.close()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._server.wait_closed(), _PATIENCE)
        await self.session.close()

    # --- GET requests ---

    def _request(self, _: ServerConnection, request: Request) -> Response | None:
        """The answer to a GET: a file of the table, a report, the socket (none), or a refusal."""
        hosts = {f"{HOST}:{self._port}", f"localhost:{self._port}"}
        if request.headers.get_all("Host") not in [[host] for host in hosts]:
            return _answer(http.HTTPStatus.FORBIDDEN, "This server accepts requests of its own computer only.\n")
        path = request.path.partition("?")[0]
        if path == "/socket":
            if request.headers.get_all("Origin") not in [[f"http://{host}"] for host in hosts]:
                return _answer(http.HTTPStatus.FORBIDDEN, "This socket accepts connections of the studio's page only.\n")
            if len(self._pages) >= _PAGES:
                return _answer(http.HTTPStatus.SERVICE_UNAVAILABLE, f"{_PAGES} windows are open; close one.\n")
            return None
        if path.startswith("/report/"):
            return self._report(path.removeprefix("/report/"))
        if path == "/favicon.ico":
            return _answer(http.HTTPStatus.NO_CONTENT, b"")
        if path not in _FILES:
            return _answer(http.HTTPStatus.NOT_FOUND, "Page not found.\n")
        file, kind = _FILES[path]
        policy = _POLICY.format(host=request.headers["Host"])
        return _answer(http.HTTPStatus.OK, file.read_bytes(), kind, policy)

    def _report(self, name: str) -> Response:
        found = self.session.jobs.reports.get(name)
        if found is None or not found.is_file():
            return _answer(http.HTTPStatus.NOT_FOUND, "Report not found.\n")
        return _answer(http.HTTPStatus.OK, found.read_bytes(), "text/html; charset=utf-8", _REPORT_POLICY)

    # --- the socket ---

    async def _page(self, connection: ServerConnection) -> None:
        """Serve one window, from its token to its end."""
        if not await self._is_let_in(connection):
            return
        self._count += 1
        page, outbox = self._count, Outbox()
        self._pages[page] = outbox
        self.session.enter(page)
        writer = asyncio.create_task(outbox.send(connection))
        outbox.put(say.Welcome(say.VERSION, __version__, page, len(self._pages)))
        for message in tuple(self.session.shown.values()):
            outbox.put(message)
        try:
            async for text in connection:
                self._hear(text, page, outbox)
        except ConnectionClosed:
            pass
        finally:
            del self._pages[page]
            self.session.leave(page)
            writer.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionClosed):
                await writer

    async def _is_let_in(self, connection: ServerConnection) -> bool:
        """Whether the first message has the token; else the socket is closed."""
        try:
            first = decode(await asyncio.wait_for(connection.recv(), _PATIENCE))
            if isinstance(first, say.Hello) and secrets.compare_digest(first.token.encode(), self.token.encode()):
                return True
            await connection.close(1008, "wrong token")
        except DesignError:
            await connection.close(1008, "the first message must be hello with the token")
        except (ConnectionClosed, TimeoutError):
            await connection.close(1008, "no token received")
        return False

    def _hear(self, text: str | bytes, page: int, outbox: Outbox) -> None:
        """Start the handling of a page's request."""
        try:
            request = decode(text)
        except DesignError as error:
            outbox.put(say.Refusal((problem(error.findings[0]),)))
            return
        if not isinstance(request, say.Hello):
            self._start(self.session.answer(request, page, outbox.put))

    def _tell_all(self, message: say.Said) -> None:
        for outbox in self._pages.values():
            outbox.put(message)

    def _start(self, work: Any) -> None:
        task = asyncio.create_task(work)
        self._work.add(task)
        task.add_done_callback(self._work.discard)


class Outbox:
    """Messages to a page: all answers, but only the newest pushed message of each kind. A slow page does not delay other pages."""

    def __init__(self) -> None:
        self._waiting: deque[say.Said] = deque()
        self._filled = asyncio.Event()
        self.sent = 0
        """Number of sent bytes."""

    def put(self, message: say.Said) -> None:
        """Queue a message."""
        if isinstance(message, _KEPT):
            kept = [each for each in self._waiting if type(each) is not type(message)]
            if len(kept) < len(self._waiting):
                self._waiting = deque(kept)
        self._waiting.append(message)
        self._filled.set()

    async def send(self, connection: ServerConnection) -> None:
        """Send queued messages, until the page closes."""
        with contextlib.suppress(ConnectionClosed):
            while True:
                await self._filled.wait()
                self._filled.clear()
                while self._waiting:
                    text = encode(self._waiting.popleft())
                    self.sent += len(text)
                    await connection.send(text)


def _answer(
    status: http.HTTPStatus, body: str | bytes, kind: str = "text/plain; charset=utf-8", policy: str = "default-src 'none'"
) -> Response:
    content = body.encode() if isinstance(body, str) else body
    headers = Headers(
        {
            "Content-Type": kind,
            "Content-Length": str(len(content)),
            "Content-Security-Policy": policy,
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cache-Control": "no-store",
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Connection": "close",
        }
    )
    return Response(status.value, status.phrase, headers, content)


async def run(path: Path, port: int, started: Any) -> None:
    """Serve a design until an interruption. `started` is called with the address."""
    studio = Studio(path, port)
    await studio.start()
    try:
        started(studio.url)
        await asyncio.get_running_loop().create_future()
    finally:
        await studio.stop()
