"""The command `sweep`: results that survive being killed, whoever computes them; studies that cannot be."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.sweeps.execution.run import PIECE, Run, require_memory, sweep
from flexstage.studies.sweeps.execution.store import folder_of, read_results
from flexstage.studies.sweeps.file import load_study, loads_study
from flexstage.studies.tolerances.file import loads_tolerance
from tests.conftest import FULL

DESIGNS = 20 * PIECE if FULL else 5 * PIECE
KILLS = 20 if FULL else 2
KEYS = ("young", "density", "poisson", "expansion", "yield_stress", "loss_factor")
STUDY = f"""
format = "flexstage study 1"
case = "parallelogram"
responses.f = "frequency.1"
sweep = {{ sampling = "latin hypercube", designs = {DESIGNS}, seed = 3 }}
[variables]
young = {{ address = "materials.aluminium.young", from = "-10 %", to = "10 %" }}
"""
RUN = """
import sys
from flexstage.studies.sweeps.file import load_study
from flexstage.studies.sweeps.execution.run import Run, sweep
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
    assert (again.code, "file exists already" in again.err) == (2, True)
    study_file.write_text(short.replace("-10 %", "-20 %"))
    other = flexstage("sweep", "study.toml", "-o", "r.h5", "--resume")
    assert (other.code, "variables.young was" in other.err) == (2, True)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"-10 %"', '"10 %"', "the range is empty"),
        ("materials.aluminium.young", "materials.aluminum.young", "aluminium"),
        ('"frequency.1"', '"frequncy.1"', 'unknown measure "frequncy.1"'),
        ('"frequency.1"', '"safety.B"', "unknown measure"),
        ("latin hypercube", "latin", "latin hypercube"),
        ("seed = 3", "sed = 3", "unknown key"),
        ('"10 %"', '"80 GPa"', "only one end of the range is relative"),
        ('case = "parallelogram"', 'design = "none.toml"', "file not found"),
        ("responses.f", "responses.young", 'responses.young: column "young" exists already, from variables.young'),
        ("young = {", "design = {", 'variables.design: column "design" exists already, from the number of a design'),
        ("young = {", '"a\\u0000b" = {', "variables.a\\x00b: the name is empty, or contains control characters"),
        ("young = {", '"a\\u202eb" = {', "variables.a\\u202eb: the name is empty, or contains control characters"),
        (
            "flexstage study 1",
            "flexstage 1",
            'error: study.toml:2: format: unknown format (got "flexstage 1", a design file, expected a study file)',
        ),
    ],
)
def test_bad_studies_are_told(study_file, tmp_path, flexstage, old, new, message):
    text = study_file.read_text()
    assert old in text
    study_file.write_text(text.replace(old, new, 1))
    done = flexstage("sweep", "study.toml", "-o", "r.h5")
    assert (done.code, message in " ".join(done.err.split())) == (2, True), done.err
    assert not (tmp_path / "r.h5").exists()


SCATTERED = """
format = "flexstage study 1"
case = "parallelogram"
responses."NAME" = "mass"
scatter.wire = { address = "leaf.thickness", normal = "4 um" }
"""


def test_columns_of_all_studies_have_names_of_their_own():
    """Copies of a tolerance study, objectives that are one measure, and a study made in Python."""
    copy = loads_tolerance(SCATTERED.replace("NAME", "m")).variables[0].name
    with pytest.raises(DesignError, match=f'responses.{copy}: column "{copy}" exists already'):
        loads_tolerance(SCATTERED.replace("NAME", copy))
    text = f'{STUDY}\n[optimise]\nmaximise = ["f"]\nminimise = ["g"]'.replace("responses.f", 'responses.g = "frequency.1"\nresponses.f')
    with pytest.raises(DesignError, match='"g" is the same measure as the objective "f"'):
        load_optimisation(loads_study(text))
    study = loads_study(STUDY)
    with pytest.raises(DesignError, match=r'responses\.young: column "young" exists already, from variables\.young'):
        sweep(replace(study, responses={"young": study.responses["f"]}), "nowhere.h5")


def test_names_with_any_sign_are_kept(tmp_path):
    """A study whose names look like paths of files and of HDF5 is resumed, and its columns are found by them."""
    names = ["a/b", "a|b", "../c", ".", "x" * 300, "\u00e9\u4e2d"]
    varied = "\n".join(
        f'"{name}" = {{ address = "materials.aluminium.{key}", from = "-10 %", to = "10 %" }}'
        for name, key in zip(names, KEYS, strict=True)
    )
    text = f'format = "flexstage study 1"\ncase = "parallelogram"\nresponses."f/|." = "mass"\nsweep.designs = 4\n[variables]\n{varied}'
    study = loads_study(text)
    once = sweep(study, tmp_path / "r.h5", Run(workers=1))
    again = sweep(study, tmp_path / "r.h5", Run(workers=1, resume=True))
    assert once.names == again.names == (tuple(names), ("f/|.",))
    assert again.facts == study.facts
    assert len(set(again.column("a/b"))) == 4


def test_memory_is_asked_for_before_anything_is_computed(monkeypatch, tmp_path):
    """What is advised to fit does."""
    study = loads_study(STUDY)
    many = replace(study, plan=replace(study.plan, count=10**6), responses={f"f{number}": study.responses["f"] for number in range(999)})
    monkeypatch.setattr("flexstage.base.processes.memory.available", lambda: 1e9)
    with pytest.raises(DesignError, match="1,000,000 designs in 1000 columns need about 32 GB of memory") as refused:
        sweep(many, tmp_path / "r.h5")
    advice = refused.value.findings[0].advice
    assert advice.startswith("Use at most ")
    fits = int(advice.split()[3].replace(",", ""))
    require_memory(replace(many, plan=replace(many.plan, count=fits)))
    with pytest.raises(DesignError, match="GB"):
        require_memory(replace(many, plan=replace(many.plan, count=fits + 1)))
    assert list(tmp_path.iterdir()) == []
