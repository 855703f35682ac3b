"""Registers: what other packages offer is known, and what is wrong with it is told."""

from importlib.metadata import entry_points

import pytest

from flexstage.base import register
from flexstage.base.finding import DesignError
from flexstage.base.register import Register


@pytest.fixture
def offers(tmp_path, monkeypatch):
    """Two packages that offer entries of a group."""
    for name in ("one", "other"):
        told = tmp_path / f"{name}-1.5.dist-info"
        told.mkdir()
        (told / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.5\n")
        lines = ("[flexstage.trial]", "both = math:pi", "own = math:pi", f"{name} = math:tau", f"bad {name} = nowhere:it")
        (told / "entry_points.txt").write_text("\n".join(lines))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(register, "_installed", entry_points)  # those found before are kept
    return Register("flexstage.trial", {"own": 1.0})


def test_what_one_package_offers_is_known_by_name_and_version(offers):
    assert offers.get("one") == pytest.approx(6.283185307179586)
    assert offers.offer("one") == "one 1.5"
    assert offers.get("nobody") is None
    assert set(offers) == {"own", "both", "one", "other", "bad one", "bad other"}


@pytest.mark.parametrize(("kind", "who"), [("both", "one 1.5"), ("both", "other 1.5"), ("own", "flexstage")])
def test_a_kind_that_is_offered_twice_is_refused_with_who_does(offers, kind, who):
    with pytest.raises(DesignError, match=f"{kind}: several packages provide this kind: .*{who}"):
        offers.get(kind)


def test_an_offer_that_does_not_load_is_told_with_its_package(offers):
    with pytest.raises(DesignError, match=r"one 1\.5 provides this kind, but the kind cannot be loaded: ModuleNotFoundError"):
        offers.get("bad one")
