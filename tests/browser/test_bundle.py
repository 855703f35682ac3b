"""The shipped bundles are what their sources give, byte for byte, with the packages that the lock file names."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.hygiene.source import ROOT, SRC

WEB = ROOT / "web"
PLACES = (SRC / "show" / "static", SRC / "apps" / "studio" / "static")


def shipped(name: str) -> Path:
    return next(folder / name for folder in PLACES if (folder / name).exists())


def is_installed() -> bool:
    """Whether web/node_modules holds the packages of the lock file, in these versions."""
    here = WEB / "node_modules" / ".package-lock.json"
    if not here.exists():
        return False
    wanted = json.loads((WEB / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    found = json.loads(here.read_text(encoding="utf-8"))["packages"]
    return all(wanted[name]["version"] == each["version"] for name, each in found.items() if name in wanted)


def test_bundles_are_what_their_sources_give(tmp_path: Path) -> None:
    node = shutil.which("node")
    if node is None or not is_installed():
        pytest.skip("node is not on the PATH" if node is None else "web/node_modules does not hold the packages of the lock file: make web")
    done = subprocess.run([node, "build.mjs", str(tmp_path)], cwd=WEB, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    built = sorted(tmp_path.iterdir())
    assert len(built) >= 6
    for each in built:
        assert each.read_bytes() == shipped(each.name).read_bytes(), f"{each.name}: make web"


def test_the_lock_names_no_registry() -> None:
    packages = json.loads((WEB / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    assert all("resolved" not in each for each in packages.values())
    assert all("integrity" in each for name, each in packages.items() if name)


def test_licences_stand_beside_the_bundles() -> None:
    assert "three" in shipped("viewer-licences.txt").read_text(encoding="utf-8")
    assert "three.js authors" in shipped("viewer.js").read_text(encoding="utf-8")[:2000]  # pages that carry the bundle carry it too
    assert shipped("viewer.js").stat().st_size < 800_000
