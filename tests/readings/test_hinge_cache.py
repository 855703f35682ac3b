"""Hinges computed in processes of their own and kept: what is found is what was computed, and what is damaged is computed anew."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from flexstage.base.finding import DesignError, Finding
from flexstage.base.scale import mm
from flexstage.cases.stock import STEEL
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Filleted
from flexstage.parts.rod import Rod
from flexstage.readings.solid.cache import Cache
from flexstage.readings.solid.estimate import Accuracy
from flexstage.readings.solid.hinge import HingeSolid, hinge_compliance
from flexstage.readings.solid.hinge_cache import kept_hinge
from flexstage.readings.solid.parts import Ways

ROD = Rod("steel", 8 * mm, 3 * mm)
ROUGH = Accuracy(error=0.5, orders=(2, 3), meshes=1)


def same(one: HingeSolid, other: HingeSolid) -> bool:
    pairs = ((getattr(one, field.name), getattr(other, field.name)) for field in fields(one))
    return all(np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b for a, b in pairs)


def test_kept_computed_and_plain_hinges_are_the_same(tmp_path: Path) -> None:
    ways, notices = Ways(Cache(tmp_path)), list[Finding]()
    computed = kept_hinge(ROD, STEEL, ROUGH, ways, notices.append)
    plain = hinge_compliance(ROD, STEEL, ROUGH)
    size = np.sqrt(np.diag(plain.compliance))
    assert np.max(np.abs(computed.compliance - plain.compliance) / np.outer(size, size)) < 1e-9  # rounding of another process
    assert computed.freedoms == plain.freedoms
    (path,) = tmp_path.iterdir()
    kept = path.read_bytes()
    assert same(kept_hinge(ROD, STEEL, ROUGH, ways, notices.append), computed)
    assert notices == []
    path.write_bytes(kept.replace(b"1", b"2", 1))
    assert same(kept_hinge(ROD, STEEL, ROUGH, ways, notices.append), computed)
    assert path.read_bytes() == kept
    (notice,) = notices
    assert "cannot be read (it does not have the checksum it states)" in notice.what


def test_what_is_refused_there_is_refused_here() -> None:
    bad = Notch("steel", 1 * mm, 6 * mm, Filleted(2 * mm, 3 * mm))
    with pytest.raises(DesignError) as plain:
        hinge_compliance(bad, STEEL, ROUGH)
    with pytest.raises(DesignError) as caught:
        kept_hinge(bad, STEEL, ROUGH, Ways(None))
    assert caught.value.findings == plain.value.findings
