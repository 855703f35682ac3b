"""Tests of pages, in a browser that is on the machine: none is brought, and without one they are skipped."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Error, Page, sync_playwright

_VARIABLE = "FLEXSTAGE_BROWSER"
_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
# Pictures by software, the same on every machine; nothing that asks the network by itself.
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--disable-quic",
]


def browser_path() -> str | None:
    """The browser that the environment names, else the first of the usual names on the PATH."""
    stated = os.environ.get(_VARIABLE)
    return stated or next((found for name in _NAMES if (found := shutil.which(name))), None)


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """One browser for all tests of pages that a process runs.

    It ends with them: while it lives, no other test of the same thread could run an event loop.
    """
    path = browser_path()
    if path is None:
        pytest.skip(f"no browser: neither {_VARIABLE} names one, nor is any of {', '.join(_NAMES)} on the PATH")
    with sync_playwright() as playwright:
        try:
            launched = playwright.chromium.launch(executable_path=path, args=FLAGS)
        except Error as error:
            pytest.skip(f"{path} does not start: {str(error).splitlines()[0]}")
        yield launched
        launched.close()


HERE = ("file:", "data:", "blob:", "about:", "http://127.0.0.1:", "ws://127.0.0.1:", "http://localhost:", "ws://localhost:")
"""How addresses begin that are no requests: files, data, servers of this machine."""


class Watch:
    """What a page said and asked for; a test that ends with either fails, but for what it takes out itself."""

    def __init__(self, allowed: tuple[str, ...] = HERE) -> None:
        self.errors: list[str] = []
        self.requests: list[str] = []
        self._allowed = allowed

    def over(self, page: Page) -> Page:
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("console", lambda said: self.errors.append(said.text) if said.type == "error" else None)
        page.on("request", lambda asked: None if asked.url.startswith(self._allowed) else self.requests.append(asked.url))
        return page

    def require_silence(self) -> None:
        assert not self.errors
        assert not self.requests


Open = Callable[..., Page]


@pytest.fixture
def watch() -> Iterator[Watch]:
    """Errors and requests of the pages that a test opens: none may be left. Files, data and servers of this machine are no requests."""
    watched = Watch()
    yield watched
    watched.require_silence()


@pytest.fixture
def opened(browser: Browser, watch: Watch) -> Iterator[Open]:
    """Opens a file or an address: `opened(path, width=1200, height=800, dark=False, **context)`."""
    contexts: list[BrowserContext] = []

    def open_page(where: Path | str, *, width: int = 1200, height: int = 800, dark: bool = False, **context: object) -> Page:
        scheme = "dark" if dark else "light"
        made = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, **context)
        contexts.append(made)
        page = watch.over(made.new_page())
        page.goto(where.resolve().as_uri() if isinstance(where, Path) else where)
        return page

    yield open_page
    for each in contexts:
        each.close()
