"""Files that others wrote, read in a process of its own: whatever is wrong with one ends in a finding, and the next file is read."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import h5py
import numpy as np
import psutil
import pytest
import scipy.io

from flexstage.base.finding import DesignError
from flexstage.base.processes.jobs import environment
from flexstage.base.processes.pool import ProcessPool
from flexstage.base.storage import files
from flexstage.base.storage.files import hdf, mat, new_hdf, require_regular
from flexstage.experiment.formats.read import read


def without_checksums(path: Path, version: str = "earliest") -> Path:
    """A file of the older form (superblock 0), or of a newer one."""
    with h5py.File(path, "w", libver=(version, "latest")) as file:
        file["test/u"], file["test/y"] = np.arange(50.0), np.arange(50.0)
        file["test"].attrs["fs"], file["test/y"].attrs["unit"] = 50.0, "um"
    return path


def refusal(path: Path) -> str:
    with pytest.raises(DesignError) as error:
        read(path)
    return str(error.value)


def circling(folder: Path) -> Path:
    """One byte of a group's table: the library follows it for ever, and holds the interpreter's lock meanwhile."""
    path = without_checksums(folder / "circles.h5")
    content = bytearray(path.read_bytes())
    assert content[6168] == 2, "another version of the library: look for another byte"
    content[6168] = 85
    path.write_bytes(content)
    return path


def test_a_file_that_runs_in_circles_is_refused_and_the_next_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sound = without_checksums(tmp_path / "a.h5")
    assert set(hdf(sound).arrays) == {"test/u", "test/y"}
    monkeypatch.setattr(files, "PATIENCE", 1.0)
    assert "it is damaged: reading it took more than 1 s of CPU time" in refusal(circling(tmp_path))
    monkeypatch.setattr(files, "PATIENCE", 60.0)
    np.testing.assert_array_equal(hdf(sound).read("test/u", [(3, 7)]), np.arange(3.0, 7.0))


def test_an_interrupt_ends_the_reading_of_a_file_that_runs_in_circles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hdf(without_checksums(tmp_path / "a.h5"))  # the child is there
    path = circling(tmp_path)
    monkeypatch.setattr(files, "PATIENCE", 1e6)
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        hdf(path)
    assert not [each for each in psutil.Process().children() if any("flexstage.base.processes.jobs" in word for word in each.cmdline())]


def test_a_crash_of_the_library_is_told_by_its_signal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = without_checksums(tmp_path / "a.h5")
    (tmp_path / "h5py.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setattr(files, "POOL", ProcessPool(files.POOL.function))
    assert "the library that reads it crashed (signal 11)" in refusal(path)


def test_the_child_ends_with_its_caller(tmp_path: Path) -> None:
    path = without_checksums(tmp_path / "a.h5")
    text = f"import psutil\nfrom pathlib import Path\nfrom flexstage.base.storage.files import hdf\nhdf(Path({str(path)!r}))\n"
    text += "print(psutil.Process().children()[0].pid)"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True, env=environment())
    psutil.wait_procs([psutil.Process(int(done.stdout))] if psutil.pid_exists(int(done.stdout)) else [], timeout=5.0)
    assert not psutil.pid_exists(int(done.stdout))


@pytest.mark.parametrize("version", ["earliest", "v108", "v110"])
def test_data_in_other_files_are_refused_by_name(version: str, tmp_path: Path) -> None:
    (tmp_path / "secret").write_bytes(np.arange(50.0).tobytes())
    without_checksums(tmp_path / "other.h5")
    ways = {
        "link": lambda file: file.__setitem__("u", h5py.ExternalLink(str(tmp_path / "other.h5"), "/test/u")),
        "storage": lambda file: file.create_dataset("u", (50,), "f8", external=[(str(tmp_path / "secret"), 0, 400)]),
        "virtual": lambda file: file.create_virtual_dataset("u", layout(tmp_path / "other.h5")),
    }
    for name, way in ways.items():
        with h5py.File(tmp_path / f"{name}.h5", "w", libver=(version, "latest")) as file:
            file["fs"] = 50.0
            way(file)
        assert "u: its data are in another file" in refusal(tmp_path / f"{name}.h5")


def layout(path: Path) -> h5py.VirtualLayout:
    found = h5py.VirtualLayout((50,), "f8")
    found[:] = h5py.VirtualSource(str(path), "test/u", (50,))
    return found


def test_memory_is_estimated_before_it_is_taken(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("u", (10**13,), "f4", chunks=(1_000_000,))
    with pytest.raises(DesignError, match=r"u: its numbers need about .* GB of memory, but only .* GB is available.*Read less"):
        hdf(tmp_path / "a.h5").read("u")


def test_types_that_a_file_names_are_no_data(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["kind"] = np.dtype("f4")
        file.create_dataset("u", data=[1.0, 2.0], dtype=file["kind"])
    found = hdf(tmp_path / "a.h5")
    assert list(found.arrays) == ["u"]
    np.testing.assert_array_equal(found.read("u"), [1.0, 2.0])


def test_a_mat_file_pressed_beyond_belief_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scipy.io.savemat(tmp_path / "a.mat", {"u": np.zeros((40_000_000,))}, do_compression=True)
    assert (tmp_path / "a.mat").stat().st_size < 500_000
    monkeypatch.setattr(files, "MEMORY", 500_000_000)
    monkeypatch.setattr(files, "PATIENCE", 1e6)  # it is memory that runs out, however slow the processor
    assert "reading it takes more than" in refusal(tmp_path / "a.mat")


def test_what_is_no_regular_file_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    for path, kind in ((tmp_path / "pipe.csv", "a pipe"), (Path("/dev/zero"), "a device"), (tmp_path, "a folder")):
        with pytest.raises(DesignError, match=rf"not a regular file \(got {kind}\)"):
            require_regular(path)
        assert kind in refusal(path)


def test_structures_of_mat_files_are_flattened(tmp_path: Path) -> None:
    cell = np.empty(2, dtype=object)
    cell[:] = [np.eye(2), "text"]
    inner = {"fs": 50.0, "note": "run 2", "frame": {"u": np.eye(2)}}
    scipy.io.savemat(tmp_path / "a.mat", {"test": inner, "cell": cell, "names": np.array(["a", "bc"], dtype=object)})
    found = dict(mat(tmp_path / "a.mat"))
    assert set(found) == {"test.fs", "test.note", "test.frame.u", "names"}  # a cell of anything but texts is left out
    assert (found["test.note"], found["names"]) == (("run 2",), ("a", "bc"))
    np.testing.assert_array_equal(found["test.frame.u"], np.eye(2))


def test_an_hdf5_file_whose_room_is_not_there_is_not_begun(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"large|space"), new_hdf(tmp_path / "a.h5", 2**62):
        pytest.fail("its room cannot be there")
