"""Hinges computed in processes of their own and kept: what is found is what was computed, and what is damaged is computed anew."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from flexstage.base.finding import DesignError, Finding
from flexstage.base.processes.progress import Step
from flexstage.base.units.scale import mm
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Filleted
from flexstage.parts.rod import Rod
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.geometry import piece
from flexstage.solid.fea.geometry.piece import form_digest
from flexstage.solid.fea.hinges.hinge import hinge_compliance
from flexstage.solid.fea.hinges.hinge_form import HingeForm, HingeSolid
from flexstage.solid.fea.hinges.roots import Roots, own_roots
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.hinge_cache import hinges_from_cache
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.fea.jobs.remote import Limits
from flexstage.solid.fea.meshing.estimate import Accuracy
from tests.stock import STEEL

ROD = Rod("steel", 8 * mm, 3 * mm)
ROUGH = Accuracy(error=0.5, orders=(2, 2), meshes=1)
HELD = Roots(False, False)


def same(one: HingeSolid, other: HingeSolid) -> bool:
    pairs = ((getattr(one, field.name), getattr(other, field.name)) for field in fields(one))
    return all(np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b for a, b in pairs)


def formed(part: Shaped) -> HingeForm:
    return HingeForm(part, STEEL, HELD if isinstance(part, Rod) else own_roots(part))


def kept(part: Shaped, ways: Ways) -> HingeSolid:
    return hinges_from_cache({"prop": formed(part)}, ROUGH, ways)["prop"]


def test_kept_computed_and_plain_hinges_are_the_same(tmp_path: Path) -> None:
    notices: list[Finding] = []
    ways = Ways(Cache(tmp_path), notice=notices.append)
    computed = kept(ROD, ways)
    plain = hinge_compliance(ROD, STEEL, ROUGH, roots=HELD)
    size = np.sqrt(np.diag(plain.compliance))
    assert np.max(np.abs(computed.compliance - plain.compliance) / np.outer(size, size)) < 1e-9  # rounding of another process
    assert computed.freedoms == plain.freedoms
    (path,) = tmp_path.iterdir()
    before = path.read_bytes()
    assert same(kept(ROD, ways), computed)
    assert notices == []
    path.write_bytes(before.replace(b"1", b"2", 1))
    assert same(kept(ROD, ways), computed)
    assert path.read_bytes() == before
    (notice,) = notices
    assert "wrong checksum of its" in notice.what


def test_what_is_refused_there_is_refused_here() -> None:
    bad = Notch("steel", 1 * mm, 6 * mm, Filleted(2 * mm, 3 * mm))
    with pytest.raises(DesignError) as plain:
        hinge_compliance(bad, STEEL, ROUGH)
    with pytest.raises(DesignError) as caught:
        kept(bad, Ways(None))
    assert caught.value.findings == tuple(replace(each, where="prop") for each in plain.value.findings)


def test_hinges_are_computed_side_by_side_each_once(tmp_path: Path) -> None:
    steps: list[Step] = []
    other = Rod("steel", 10 * mm, 3 * mm)
    forms = {"short": formed(ROD), "long": formed(other), "alike": formed(ROD)}
    ways = Ways(Cache(tmp_path), steps.append, Limits(workers=2))
    found = hinges_from_cache(forms, ROUGH, ways)
    assert list(found) == ["short", "long", "alike"]
    assert found["alike"] is found["short"]
    assert found["long"].compliance[0, 0] > 1.1 * found["short"].compliance[0, 0]
    assert any("short: " in step.text and "long: " in step.text for step in steps)
    assert not any("alike" in step.text for step in steps)
    assert steps[-1].fraction == 1.0
    assert len(list(tmp_path.iterdir())) == 2


def test_a_hinge_that_is_done_is_kept_when_another_is_interrupted(tmp_path: Path) -> None:
    def interrupted(_step: Step) -> None:
        if list(tmp_path.glob("*.hinge")):
            raise KeyboardInterrupt

    forms = {"short": formed(ROD), "long": formed(Rod("steel", 10 * mm, 3 * mm))}
    with pytest.raises(KeyboardInterrupt):
        hinges_from_cache(forms, ROUGH, Ways(Cache(tmp_path), interrupted, Limits(workers=1)))
    assert len(list(tmp_path.iterdir())) == 1


def test_too_little_memory_is_told_by_name() -> None:
    with pytest.raises(DesignError, match=r"prop: its coarsest mesh needs about .* GB at order 2 \(0\.001 GB available\)"):
        kept(ROD, Ways(None, limits=Limits(memory=1e6)))


def test_a_shape_that_another_package_offers_counts_with_its_version(monkeypatch: pytest.MonkeyPatch) -> None:
    """A part's own digest knows the package of its class alone; its shape may be of another."""
    found = {form_digest(ROD)}
    for version in ("1.0", "2.0"):
        monkeypatch.setattr(piece, "OFFERED_SHAPES", SimpleNamespace(offer=lambda kind, version=version: f"{kind}s {version}"))
        found.add(form_digest(ROD))
    assert len(found) == 3
