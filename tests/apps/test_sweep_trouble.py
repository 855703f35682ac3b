"""The command `sweep` in trouble: full disks, damaged files; what was computed is kept."""

import os
import subprocess
import sys

import h5py
import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.studies.sweeps.execution.run import Run, sweep
from flexstage.studies.sweeps.execution.store import file_size, folder_of, read_results
from flexstage.studies.sweeps.file import loads_study

STUDY = """
format = "flexstage study 1"
case = "parallelogram"
responses.m = "mass"
responses.f = "frequency.platform.1"
sweep = { sampling = "latin hypercube", designs = 700, seed = 3 }
[variables]
young = { address = "materials.aluminium.young", from = "-10 %", to = "10 %" }
"""
RUN = """
import sys, resource
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
from flexstage.apps.cli import run
sys.exit(run(["sweep", sys.argv[1], "-o", sys.argv[3], "--resume", "--workers", "1"]))
"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The results without trouble."""
    path = tmp_path_factory.mktemp("whole") / "r.h5"
    sweep(loads_study(STUDY), path, Run(workers=1))
    return path.read_bytes()


def limited(place, size):
    """The command in a process none of whose files may grow beyond a size; how it ended."""
    (place / "study.toml").write_text(STUDY)
    words = [sys.executable, "-c", RUN, place / "study.toml", str(size), place / "r.h5"]
    return subprocess.run(words, capture_output=True, text=True, check=False)


def test_a_disk_that_takes_no_more_keeps_what_is_there(tmp_path, whole):
    """Pieces fit, the gathered file does not: HDF5 would take the process down."""
    done = limited(tmp_path, 20_000)
    assert done.returncode == 2, done.stderr
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.glob(".*.part"))
    found = sweep(loads_study(STUDY), tmp_path / "r.h5", Run(workers=1, resume=True))
    assert found.complete
    assert (tmp_path / "r.h5").read_bytes() == whole


def test_room_is_asked_for_before_anything_is_computed(tmp_path, monkeypatch):
    study = loads_study(STUDY)
    usage = type("Usage", (), {"free": 2 * file_size(study) - 1})
    monkeypatch.setattr("shutil.disk_usage", lambda _: usage)
    with pytest.raises(DesignError, match=r"MB more are needed to combine the results, but .* MB are free"):
        sweep(study, tmp_path / "r.h5", Run(workers=1))
    assert not list(tmp_path.iterdir())


def test_the_room_asked_for_is_enough(whole):
    assert len(whole) <= file_size(loads_study(STUDY))


@pytest.mark.parametrize("damage", [lambda text: text[: len(text) // 2], lambda _: b"", lambda text: os.urandom(len(text))])
def test_damaged_results_are_refused_and_left(tmp_path, flexstage, whole, damage):
    (tmp_path / "study.toml").write_text(STUDY)
    content = damage(whole)
    (tmp_path / "r.h5").write_bytes(content)
    done = flexstage("sweep", "study.toml", "-o", "r.h5", "--resume")
    assert (done.code, "r.h5: it cannot be read as HDF5" in done.err or "r.h5: truncated file" in done.err) == (2, True), done.err
    assert (tmp_path / "r.h5").read_bytes() == content


DAMAGES = {
    "planned": lambda file: file.attrs.__delitem__("planned"),
    "piece": lambda file: file.attrs.__setitem__("piece", float("nan")),
    "study": lambda file: file.attrs.__setitem__("study", 3.0),
    "computed": lambda file: file.__delitem__("computed"),
    "variables": lambda file: file["variables"].attrs.__setitem__("names", ["a"] * 9),
    "responses": lambda file: file["responses"].attrs.__setitem__("units", ["Hz"] * 9),
    "failures": lambda file: file.move("failed", "failures2") or file.__delitem__("failures"),
    "facts": lambda file: file.__delitem__("facts"),
}


@pytest.mark.parametrize("what", DAMAGES)
def test_results_that_lack_something_are_refused(tmp_path, whole, what):
    (tmp_path / "r.h5").write_bytes(whole)
    with h5py.File(tmp_path / "r.h5", "r+", libver="v110") as file:
        DAMAGES[what](file)
    with pytest.raises(DesignError, match=what):
        read_results(tmp_path / "r.h5")


def test_a_damaged_piece_is_named(tmp_path, flexstage):
    (tmp_path / "study.toml").write_text(STUDY)
    folder = folder_of(tmp_path / "r.h5")
    folder.mkdir()
    (folder / "000000000256.piece").write_bytes(b"none")
    done = flexstage("sweep", "study.toml", "-o", "r.h5", "--resume")
    assert (done.code, "000000000256.piece: not a piece" in done.err) == (2, True), done.err


def test_what_made_results_is_kept(whole, tmp_path):
    (tmp_path / "r.h5").write_bytes(whole)
    (made,) = read_results(tmp_path / "r.h5").made
    assert f"numpy {np.__version__}" in made
    assert "kernel" in made
