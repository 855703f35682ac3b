"""Readings of stages whose outlines do not form solids: refused by name before anything is meshed, whoever asks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.finding import DesignError, Finding
from flexstage.base.units.scale import mm
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.restrict import isolate
from flexstage.solid.fea.geometry import sound
from flexstage.solid.fea.geometry.sound import stage_findings
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.results.read import read_solid, solids
from tests.models.monolithic import monolithic
from tests.models.small_solids import COARSE, propped

Reads = Callable[[Mechanism], object]


def gaping() -> Mechanism:
    """The parallelogram with a leaf that ends 20 um short of its platform, and a lug far away from it."""
    stage = case("parallelogram")
    left = replace(stage.links["left"], at=tuple(np.add(stage.links["left"].at, (0.0, 2e-5, 0.0)).tolist()))
    platform = stage.bodies["platform"]
    far = fs.Block("steel", (20 * mm, 20 * mm, 20 * mm), at=(0.0, 0.0, 300 * mm))
    bodies = {**stage.bodies, "platform": replace(platform, solids={**platform.solids, "far": far})}
    return replace(stage, links={**stage.links, "left": left}, bodies=bodies)


@pytest.mark.parametrize(
    "reads",
    [
        lambda stage: fs.solid.model(stage, COARSE, cache=None),
        lambda stage: monolithic(stage, COARSE),
        lambda stage: read_solid(stage, COARSE, solids()),
    ],
    ids=["solid", "monolithic", "read_solid"],
)
def test_gaps_are_named_before_anything_is_meshed(reads: Reads, monkeypatch: pytest.MonkeyPatch) -> None:
    for reduction in ("tests.models.monolithic.mesh_component", "flexstage.solid.results.read.reduce_parts"):
        monkeypatch.setattr(reduction, lambda *_: pytest.fail("meshed all the same"))
    with pytest.raises(DesignError) as caught:
        reads(gaping())
    assert [finding.where for finding in caught.value.findings] == ["left", "platform"]
    assert "20 um away from platform" in caught.value.findings[0].what


def test_a_unit_alone_is_the_same_whatever_the_others_are() -> None:
    stage = case("double-triangle")
    changed = replace(
        stage, overrides={"vertical/back.thickness": 0.9 * mm, "B5/pivot.thickness": 0.9 * mm, "B1/front.thickness": 1.6 * mm}
    )
    assert isolate(changed, "B2") == isolate(stage, "B2")
    assert isolate(changed, "B1").overrides == {"B1/front.thickness": 1.6 * mm}
    assert isolate(changed, "B5").overrides == {"vertical/back.thickness": 0.9 * mm, "B5/pivot.thickness": 0.9 * mm}


def test_a_sound_stage_is_checked_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache = Cache(tmp_path / "cache")
    assert stage_findings(propped(6 * mm), cache) == ()
    monkeypatch.setattr(sound, "contacts_apart", lambda *_, **__: pytest.fail("checked again"))
    assert stage_findings(propped(6 * mm), cache) == ()
    assert stage_findings(replace(propped(6 * mm), name="renamed"), cache) == ()
    with pytest.raises(pytest.fail.Exception):
        stage_findings(propped(7 * mm), cache)
    with pytest.raises(pytest.fail.Exception):
        stage_findings(propped(6 * mm), None)


def test_findings_are_never_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = (Finding("leaf", "its end face is 20 um away from platform", "Move it"),)
    monkeypatch.setattr(sound, "contacts_apart", lambda *_, **__: [found])
    for _ in range(2):
        assert stage_findings(propped(6 * mm), Cache(tmp_path)) == found
    assert not list(tmp_path.iterdir())


def test_a_cache_that_cannot_be_written_is_no_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(sound, "contacts_apart", lambda *_, **__: [()])
    assert stage_findings(propped(6 * mm), Cache(tmp_path / "file")) == ()


def test_stages_with_imported_solids_are_checked_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Their files may have changed meanwhile."""
    calls: list[Mechanism] = []
    monkeypatch.setattr(sound, "contacts_apart", lambda stages, **_: calls.extend(stages) or [()])
    size, inertia = (10 * mm, 10 * mm, 10 * mm), fs.Inertia(1e-6, 1e-6, 1e-6)
    part = fs.Imported("steel", file="part.step", sha256="0" * 64, size=size, mass=0.1, centre=(0.0, 0.0, 0.0), inertia=inertia)
    stage = propped(6 * mm)
    body = replace(stage.bodies["platform"], mass=None, centre=None, inertia=None, solids={"part": part})
    for _ in range(2):
        stage_findings(replace(stage, bodies={"platform": body}), Cache(tmp_path))
    assert len(calls) == 2
