"""The command `sweep`: results that survive being killed, whoever computes them; studies that cannot be."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from flexstage.studies.study.file import load_study
from flexstage.studies.study.run import PIECE, Run, sweep
from flexstage.studies.study.store import folder_of, read_results
from tests.conftest import FULL

DESIGNS = 20 * PIECE if FULL else 5 * PIECE
KILLS = 20 if FULL else 2
STUDY = f"""
format = "flexstage study 1"
case = "parallelogram"
responses.f = "frequency.1"
sweep = {{ sampling = "latin hypercube", designs = {DESIGNS}, seed = 3 }}
[variables]
young = {{ of = "materials.aluminium.young", from = "-10 %", to = "10 %" }}
"""
RUN = """
import sys
from flexstage.studies.study.file import load_study
from flexstage.studies.study.run import Run, sweep
sweep(load_study(sys.argv[1]), sys.argv[2], Run(workers=2, resume=True), lambda done, of: print(done, flush=True))
"""


@pytest.fixture
def study_file(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def killed(study, results, after):
    """Run in a process of its own, killed once `after` more pieces are there; whether it was killed."""
    process = subprocess.Popen([sys.executable, "-c", RUN, study, results], stdout=subprocess.PIPE, text=True, start_new_session=True)
    with process:
        for count, _ in enumerate(process.stdout):
            if count >= after:
                os.killpg(process.pid, signal.SIGKILL)
                break
    return process.returncode == -signal.SIGKILL


def test_killed_and_resumed_gives_the_same_file(study_file, tmp_path):
    whole, broken = tmp_path / "whole.h5", tmp_path / "broken.h5"
    sweep(load_study(study_file), whole, Run(workers=1))
    for number in range(KILLS):
        if not killed(study_file, broken, after=1 + number % 2):
            break
        found = read_results(broken)
        assert len(np.unique(found.designs)) == len(found.designs)
        assert np.all(np.isfinite(found.responses))
    found = sweep(load_study(study_file), broken, Run(workers=2, resume=True))
    np.testing.assert_array_equal(found.designs, np.arange(DESIGNS))
    assert whole.read_bytes() == broken.read_bytes()
    assert not folder_of(broken).exists()


def test_the_reader_finds_every_piece_once_while_it_runs(study_file, tmp_path):
    results = tmp_path / "results.h5"
    command = [sys.executable, "-c", RUN, study_file, results]
    seen = [0]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        while process.poll() is None:
            if results.exists():
                found = read_results(results)
                assert len(np.unique(found.designs)) == len(found.designs) >= seen[-1]
                seen.append(len(found.designs))
            time.sleep(0.02)
    assert read_results(results).complete


def test_sweep_shows_and_writes(study_file, tmp_path, flexstage):
    short = study_file.read_text().replace(f"designs = {DESIGNS}", "designs = 40")
    study_file.write_text(short)
    (tmp_path / "random.py").write_text("raise SystemExit('a file of the user')")  # lies where the processes are started
    done = flexstage("sweep", "study.toml", "-o", "r.h5", "--report", "r.html", "--json", "r.json")
    assert done.code == 0, done.err
    assert "frequency.1" in done.out
    assert (tmp_path / "r.html").read_text().startswith("<!doctype html>")
    again = flexstage("sweep", "study.toml", "-o", "r.h5")
    assert (again.code, "results are there already" in again.err) == (2, True)
    study_file.write_text(short.replace("-10 %", "-20 %"))
    other = flexstage("sweep", "study.toml", "-o", "r.h5", "--resume")
    assert (other.code, "variables.young was" in other.err) == (2, True)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"-10 %"', '"10 %"', "its range is empty"),
        ("materials.aluminium.young", "materials.aluminum.young", "aluminium"),
        ('"frequency.1"', '"frequncy.1"', 'there is no measure called "frequncy.1"'),
        ('"frequency.1"', '"safety.B"', "there is no measure"),
        ("latin hypercube", "latin", "latin hypercube"),
        ("seed = 3", "sed = 3", "nothing of this name is known here"),
        ('"10 %"', '"80 GPa"', "one end is relative"),
        ('case = "parallelogram"', 'design = "none.toml"', "there is no such file"),
        ("flexstage study 1", "flexstage 1", "Begin the file with"),
    ],
)
def test_bad_studies_are_told(study_file, tmp_path, flexstage, old, new, message):
    text = study_file.read_text()
    assert old in text
    study_file.write_text(text.replace(old, new, 1))
    done = flexstage("sweep", "study.toml", "-o", "r.h5")
    assert (done.code, message in " ".join(done.err.split())) == (2, True), done.err
    assert not (tmp_path / "r.h5").exists()
