"""Files written aside: whole or not at all, with the mode of what they replace, under names that no disk finds too long."""

import pytest

from flexstage.base.aside import aside
from flexstage.base.finding import DesignError


def test_a_file_keeps_its_mode(tmp_path):
    target = tmp_path / "results.h5"
    target.write_text("before")
    target.chmod(0o640)
    with aside(target) as place:
        place.write_text("after")
    assert (target.read_text(), target.stat().st_mode & 0o777) == ("after", 0o640)


def half_written(target):
    with aside(target) as place:
        place.write_text("half")
        raise OSError(28, "disk is full")


def test_what_fails_leaves_the_file_as_it_was(tmp_path):
    target = tmp_path / "results.h5"
    target.write_text("before")
    with pytest.raises(DesignError, match="disk is full"):
        half_written(target)
    assert [each.name for each in tmp_path.iterdir()] == ["results.h5"]
    assert target.read_text() == "before"


def test_long_names_are_written(tmp_path):
    target = tmp_path / f"{250 * 'a'}.h5"
    with aside(target) as place:
        place.write_text("whole")
    assert target.read_text() == "whole"


def test_a_protected_file_is_refused(tmp_path, monkeypatch):
    target = tmp_path / "results.h5"
    target.write_text("before")
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(DesignError, match="write-protected"), aside(target):
        pytest.fail("nothing is to be written")
