"""The studio's picture of the documentation, taken of the running page; `python -m tools.studio_picture` writes it."""

from __future__ import annotations

import io
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

from flexstage.cases.registry import case
from flexstage.mechanism.store import dumps
from tests.browser.conftest import FLAGS, browser_path

TARGET = Path(__file__).resolve().parents[1] / "docs" / "pictures" / "studio.png"
_READY = (
    "() => studio.reach.value && studio.scene.value && studio.slopes.value && document.querySelector('#engine').textContent === 'ready'"
)
_PATIENCE = 240


def main() -> None:
    """Open the shipped stage and take the picture."""
    with tempfile.TemporaryDirectory() as folder:
        stage = Path(folder) / "stage.toml"
        stage.write_text(dumps(case("double-triangle")), encoding="utf-8")
        command = (sys.executable, "-m", "flexstage", "studio", str(stage), "--no-browser")
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
            try:
                found = re.search(r"http://\S+", server.stderr.readline() if server.stderr else "")
                if found:
                    take(found.group())
            finally:
                server.terminate()


def take(url: str) -> None:
    """The picture of a studio at an address."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(url)
        wait(page)
        taken = Image.open(io.BytesIO(page.screenshot()))
        taken.convert("P", palette=Image.Palette.ADAPTIVE, colors=256).save(TARGET, optimize=True)
        browser.close()


def wait(page: Page) -> None:
    """Until everything is there."""
    for _ in range(_PATIENCE):
        if page.evaluate(_READY):
            return
        page.wait_for_timeout(500)
    sys.exit("The studio did not come to rest")


if __name__ == "__main__":
    main()
