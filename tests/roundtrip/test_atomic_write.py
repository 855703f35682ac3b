"""Atomic writes: whole or not at all, with the mode of what they replace, under names that no disk finds too long."""

import os
import subprocess
import sys

import pytest

from flexstage.base.finding import DesignError
from flexstage.base.storage.store import (
    PendingFile,
    atomic_write,
    make_temporary_folder,
    move_all,
    remove_leftovers,
    write,
    write_temporary,
)


def test_a_file_keeps_its_mode(tmp_path):
    target = tmp_path / "results.h5"
    target.write_text("before")
    target.chmod(0o640)
    with atomic_write(target) as place:
        place.write_text("after")
    assert (target.read_text(), target.stat().st_mode & 0o777) == ("after", 0o640)


def half_written(target):
    with atomic_write(target) as place:
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
    with atomic_write(target) as place:
        place.write_text("whole")
    assert target.read_text() == "whole"


def test_a_protected_file_is_refused(tmp_path, monkeypatch):
    target = tmp_path / "results.h5"
    target.write_text("before")
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(DesignError, match="write-protected"), atomic_write(target):
        pytest.fail("nothing is to be written")


@pytest.mark.parametrize("name", ["b", "c"])
def test_files_are_put_together_or_not_at_all(tmp_path, name):
    """Whichever of three cannot be put, all are as they were: those that were there, and those that were not."""
    (tmp_path / "a").write_text("old")
    waiting = [write_temporary(tmp_path / each, "new") for each in ("a", "b", "c")]
    (tmp_path / name).mkdir()  # a file cannot be renamed onto a folder
    with pytest.raises(DesignError, match="cannot be written"):
        move_all(waiting)
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted(["a", name])
    assert (tmp_path / "a").read_text() == "old"


def test_only_renames_lie_between_the_first_file_and_the_last(tmp_path, monkeypatch):
    """A kill while files wait for the disk leaves all as they were; one of the renames fails, and those before it are undone."""
    (tmp_path / "a").write_text("old")
    (tmp_path / "c").write_text("old")
    waiting = [write_temporary(tmp_path / each, "new") for each in ("a", "b", "c")]
    steps, fsync, rename = [], os.fsync, PendingFile.rename

    def settled(number):
        steps.append("disk")
        fsync(number)

    def renamed(self):
        steps.append("rename")
        if steps.count("rename") == 3:
            raise DesignError([])
        rename(self)
        assert self.target.read_text() == "new"

    monkeypatch.setattr(os, "fsync", settled)
    monkeypatch.setattr(PendingFile, "rename", renamed)
    with pytest.raises(DesignError):
        move_all(waiting)
    assert steps == ["disk"] * 3 + ["rename"] * 3
    assert {each.name: each.read_text() for each in tmp_path.iterdir()} == {"a": "old", "c": "old"}


LEAVER = """
import os, signal, sys
from pathlib import Path
from flexstage.base.storage.store import atomic_write, make_temporary_folder
make_temporary_folder()
with atomic_write("results.h5") as place:
    place.write_text("half")
    print(flush=True)
    sys.stdin.read() if sys.argv[1] == "lives" else os.kill(os.getpid(), signal.SIGKILL)
"""


def leaver(folder, monkeypatch, how):
    (folder / "temporary").mkdir()
    environment = {**os.environ, "TMPDIR": str(folder / "temporary")}
    monkeypatch.setattr("tempfile.tempdir", str(folder / "temporary"))
    pipe = subprocess.PIPE
    process = subprocess.Popen([sys.executable, "-c", LEAVER, how], cwd=folder, env=environment, stdin=pipe, stdout=pipe)
    process.stdout.readline()
    return process


def left_in(folder):
    return [each for each in (*folder.iterdir(), *(folder / "temporary").iterdir()) if each.name != "temporary"]


def test_what_a_killed_process_left_is_swept(tmp_path, monkeypatch):
    """Parts beside the next output, and folders for temporary files; what others keep under like names stays."""
    process = leaver(tmp_path, monkeypatch, "dies")
    process.communicate()
    assert len(left_in(tmp_path)) == 2
    others = [tmp_path / name for name in (".results.h5.part", ".a.0123abcd.part", "flexstage-notes", "flexstage-00000000-1-abc")]
    for each in others:
        each.mkdir()
    others.append(tmp_path / ".a.00000000-999999999-abc.part")  # of another machine, which alone knows its processes
    others[-1].touch()
    write(tmp_path / "other.toml", "")
    make_temporary_folder().rmdir()
    assert sorted(left_in(tmp_path)) == sorted([*others, tmp_path / "other.toml"])


def test_what_a_living_process_writes_is_left_alone(tmp_path, monkeypatch):
    process = leaver(tmp_path, monkeypatch, "lives")
    there = left_in(tmp_path)
    assert len(there) == 2
    remove_leftovers(tmp_path)
    remove_leftovers(tmp_path / "temporary")
    assert left_in(tmp_path) == there
    for each in there:  # a process that began after its number was used is another one
        os.utime(each, (0, 0))
    remove_leftovers(tmp_path)
    remove_leftovers(tmp_path / "temporary")
    assert left_in(tmp_path) == []
    process.communicate()
