"""The cache of superelements and what goes wrong with it: told, never fatal, never half-written; a run that was stopped resumes."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import time
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.finding import DesignError, Finding
from flexstage.base.processes.progress import Step
from flexstage.base.storage.record_store import to_bytes
from flexstage.base.units.scale import mm
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.solid.fea.jobs import parts as parts_module
from flexstage.solid.fea.jobs.cache import Cache, find, folder_of, keep, key_of, program
from flexstage.solid.fea.jobs.parts import Ways, reduce_parts
from flexstage.solid.fea.jobs.remote import Limits
from flexstage.solid.fea.solver.component import components
from flexstage.solid.results.read import model as solid
from flexstage.solid.results.read import read_solid, solids
from tests.models.small_solids import COARSE, Bomb, propped
from tests.roundtrip.test_superelements import superelement

ELEMENT = superelement(0)
DIGEST = sha256(program().encode()).hexdigest()[:12]


def names(folder: Path) -> list[str]:
    """The files of a cache, marks of sound stages apart."""
    return sorted(path.name for path in folder.iterdir() if path.suffix != ".sound")


def same(one: LinearModel, other: LinearModel) -> bool:
    pairs = zip(one.stiffness.values(), other.stiffness.values(), strict=True)
    return one.coordinates == other.coordinates and all(np.array_equal(a.law, b.law) for a, b in pairs)


def test_what_is_kept_is_found(tmp_path: Path) -> None:
    cache = Cache(tmp_path / "deep" / "down")
    assert find(cache, "key", "lever") is None
    keep(cache, "key", "lever", ELEMENT)
    assert np.array_equal(find(cache, "key", "lever").rigid, ELEMENT.rigid)
    assert names(tmp_path / "deep" / "down") == [f"key-{DIGEST}.superelement"]


def test_the_folder_is_that_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "stated"))
    assert folder_of(Cache(tmp_path)) == tmp_path
    assert folder_of(Cache()) == tmp_path / "stated"
    monkeypatch.delenv("FLEXSTAGE_CACHE")
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert folder_of(Cache()) == tmp_path / "xdg" / "flexstage"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert folder_of(Cache()) == tmp_path / "home" / ".cache" / "flexstage"


def test_keys_are_of_content_and_reduction() -> None:
    short, long = components(propped(6 * mm, 7 * mm))
    assert key_of(short, COARSE) == key_of(replace(short, name="other", place=long.place), COARSE)
    assert key_of(short, COARSE) != key_of(long, COARSE)
    assert key_of(short, COARSE) != key_of(short, replace(COARSE, modes=3))
    assert key_of(short, COARSE) != key_of(short, replace(COARSE, fineness=replace(COARSE.fineness, order=3)))


def test_a_damaged_file_is_told_and_replaced(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    keep(cache, "key", "lever", ELEMENT)
    (path,) = tmp_path.iterdir()
    path.write_bytes(path.read_bytes()[:-100])
    notices: list[Finding] = []
    assert find(cache, "key", "lever", notice=notices.append) is None
    (notice,) = notices
    assert notice.where == "lever"
    assert str(path) in notice.what
    assert "damaged" in notice.what
    keep(cache, "key", "lever", ELEMENT)
    assert find(cache, "key", "lever") is not None


def test_other_versions_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache = Cache(tmp_path)
    keep(cache, "key", "lever", ELEMENT)
    monkeypatch.setattr("flexstage.solid.fea.jobs.cache.program", lambda: "flexstage 99.0")
    assert find(cache, "key", "lever") is None
    keep(cache, "key", "lever", ELEMENT)
    assert find(cache, "key", "lever") is not None
    assert len(names(tmp_path)) == 2


def test_an_unwritable_folder_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    notices: list[Finding] = []
    keep(Cache(tmp_path / "file"), "key", "lever", ELEMENT, notice=notices.append)
    (notice,) = notices
    assert notice.where == "lever"
    assert "could not be stored" in notice.what
    assert "FLEXSTAGE_CACHE" in notice.advice


def test_a_full_disk_is_told_and_nothing_is_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_handle: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    notices: list[Finding] = []
    keep(Cache(tmp_path), "key", "lever", ELEMENT, notice=notices.append)
    (notice,) = notices
    assert "No space left on device" in notice.what
    assert names(tmp_path) == []


@pytest.mark.skipif(sys.platform != "linux" or os.geteuid() != 0, reason="mounts a small disk, which only root may")
def test_a_small_disk_that_is_full_is_told_and_nothing_is_half_written(tmp_path: Path) -> None:
    size = len(to_bytes(ELEMENT, "a", program()))
    command = ["mount", "-t", "tmpfs", "-o", f"size={max(4096, size // 8192 * 4096)}", "tmpfs", str(tmp_path)]
    if subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("this root may not mount")
    try:
        notices: list[Finding] = []
        keep(Cache(tmp_path), "key", "lever", ELEMENT, notice=notices.append)
        (notice,) = notices
        assert "No space left on device" in notice.what
        assert names(tmp_path) == []
    finally:
        subprocess.run(["umount", str(tmp_path)], check=True)


def test_an_interruption_while_writing_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_handle: int) -> None:
        raise KeyboardInterrupt

    cache = Cache(tmp_path)
    keep(cache, "key", "lever", ELEMENT)
    before = names(tmp_path)
    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        keep(cache, "key", "lever", ELEMENT)
    assert names(tmp_path) == before
    assert find(cache, "key", "lever") is not None


def test_the_least_recently_used_go_first(tmp_path: Path) -> None:
    size = len(to_bytes(ELEMENT, "a", program()))
    cache = Cache(tmp_path, limit=2.5 * size)
    for age, key in ((300.0, "a"), (200.0, "b")):
        keep(cache, key, key, ELEMENT)
        then = time.time() - age
        os.utime(tmp_path / f"{key}-{DIGEST}.superelement", (then, then))
    assert find(cache, "a", "a") is not None  # used now: b is the older one
    keep(cache, "c", "c", ELEMENT)
    assert [name[0] for name in names(tmp_path)] == ["a", "c"]


def test_a_reading_that_was_stopped_resumes(tmp_path: Path) -> None:
    stage = propped(6 * mm, 7 * mm, 6 * mm)
    done: list[Step] = []

    def stop(_step: Step) -> None:
        if list(tmp_path.glob("*.superelement")):
            raise KeyboardInterrupt

    ways = Ways(Cache(tmp_path), stop, Limits(workers=1))
    with pytest.raises(KeyboardInterrupt):
        reduce_parts(components(stage), COARSE, ways)
    assert len(names(tmp_path)) == 1
    first = read_solid(stage, COARSE, solids(Ways(Cache(tmp_path), done.append)))
    assert not any("prop 2" in step.text for step in done)  # the longest job is the first
    assert len(names(tmp_path)) == 2  # two of the three are equal
    assert first.placed[0].element.skin is first.placed[2].element.skin
    again = read_solid(stage, COARSE, solids(Ways(Cache(tmp_path), lambda _step: pytest.fail("nothing is left to compute"))))
    assert same(first.model, again.model)


def test_readings_are_complete_whatever_the_cache_is_like(tmp_path: Path) -> None:
    stage = propped(6 * mm)
    plain = solid(stage, COARSE, cache=None)
    cache = Cache(tmp_path / "cache")
    assert same(solid(stage, COARSE, cache=cache), plain)
    (path,) = (tmp_path / "cache").glob("*.superelement")
    path.write_bytes(b"damaged")
    with pytest.warns(UserWarning, match="prop 1: its superelement .* is damaged"):
        assert same(solid(stage, COARSE, cache=cache), plain)
    assert same(solid(stage, COARSE, cache=cache), plain)


def test_the_solver_is_needed_only_for_what_is_not_in_the_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing() -> None:
        raise DesignError(())

    stage = propped(6 * mm)
    monkeypatch.setattr(parts_module, "require_installed", missing)
    with pytest.raises(DesignError):
        solid(stage, COARSE, cache=Cache(tmp_path))
    monkeypatch.undo()
    kept = solid(stage, COARSE, cache=Cache(tmp_path))
    monkeypatch.setattr(parts_module, "require_installed", missing)
    assert same(solid(stage, COARSE, cache=Cache(tmp_path)), kept)


def test_the_others_are_kept_when_one_fails(tmp_path: Path) -> None:
    good, bad = components(propped(6 * mm, 7 * mm))
    with pytest.raises(DesignError, match="prop 2: its process failed"):
        reduce_parts((good, replace(bad, place=Bomb(divmod, 1, 0))), COARSE, Ways(Cache(tmp_path)))
    assert len(names(tmp_path)) == 1


def test_a_pulled_rod_gives_its_length_over_young_and_area(tmp_path: Path) -> None:
    """E A / L, but for the few percent that rigid end faces and few elements add."""
    length, area = 40 * mm, np.pi * (4 * mm) ** 2 / 4
    gain = static_gain(fs.solid.model(propped(length), COARSE, cache=Cache(tmp_path)), ("platform.x",), ("platform.fx",))
    young = propped(length).materials["steel"].young
    assert gain.values.item() * young * area / length == pytest.approx(1.0, rel=0.05)
