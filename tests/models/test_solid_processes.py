"""Reductions in processes of their own: what crashes, hangs, fails or is interrupted there ends as a finding and leaves nothing behind."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from flexstage.base.finding import DesignError, Finding
from flexstage.base.processes import pool as processes
from flexstage.base.processes.jobs import Worker
from flexstage.base.processes.progress import Step
from flexstage.base.storage.record_store import to_bytes
from flexstage.base.units.scale import mm
from flexstage.solid.fea.geometry.cad import cad
from flexstage.solid.fea.jobs.memory import Counts, entries, freedoms, needed
from flexstage.solid.fea.jobs.progress import Stage
from flexstage.solid.fea.jobs.reducing import Reduce, fewest_elements
from flexstage.solid.fea.jobs.remote import Limits, Pool, work_all
from flexstage.solid.fea.solver.superelement import Superelement
from flexstage.spatial.frame import Frame
from tests.models.small_solids import COARSE, Bomb, job, mined, rod

linux = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An own folder for temporary files: empty again, and nobody working in it, after every reduction."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    yield tmp_path
    assert not list(tmp_path.iterdir())
    assert not working_in(tmp_path)


def working_in(folder: Path) -> list[int]:
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words, environment = ((process / name).read_bytes() for name in ("cmdline", "environ"))
        except OSError:
            continue
        if b"flexstage.base.processes.jobs" in words and os.fsencode(f"TMPDIR={folder}\0") in environment + b"\0":
            found.append(int(process.name))
    return found


def until(holds: Callable[[], object]) -> None:
    """Wait until something holds; the time limit of tests is elsewhere."""
    while not holds():
        time.sleep(0.05)


FREE = Limits()


def told(*jobs: Reduce, limits: Limits = FREE) -> tuple[Finding, ...]:
    with pytest.raises(DesignError) as caught:
        work_all(jobs, lambda _job, _data: None, limits)
    return caught.value.findings


def results(*jobs: Reduce, limits: Limits = FREE) -> dict[str, Superelement]:
    found: dict[str, Superelement] = {}

    def take(done: Reduce, element: object) -> None:
        assert isinstance(element, Superelement)
        found[done.name] = element

    work_all(jobs, take, limits)
    return found


def code(text: str) -> Bomb:
    return Bomb(exec, text, {})


FIRST_TIME = """
import time, os, flexstage.solid.fea.meshing.mesh as mesh
plain = mesh.generate_mesh
def attempted(shape, sizes):
    if sizes["grading"] == 0.6:  # the first attempt: the second grades more slowly
        {what}
    return plain(shape, sizes)
mesh.generate_mesh = attempted
"""


def test_a_crash_is_a_finding_and_the_others_are_done(folder: Path) -> None:
    done: list[str] = []
    with pytest.raises(DesignError) as caught:
        work_all([mined("lever", Bomb(ctypes.string_at, 0)), job(rod())], lambda each, _data: done.append(each.name), Limits())
    (finding,) = caught.value.findings
    assert finding.where == "lever"
    assert finding.what == "its process crashed while starting (SIGSEGV)"
    assert done == ["prop 1"]


def test_a_hang_ends_at_the_time_limit(folder: Path) -> None:
    (finding,) = told(mined("lever", Bomb(time.sleep, 1000.0)), limits=Limits(seconds=1.0))
    assert finding.where == "lever"
    assert finding.what == "it was still starting after the 1 s allowed"


def test_an_error_is_told_with_its_last_line(folder: Path) -> None:
    (finding,) = told(mined("lever", Bomb(divmod, 1, 0)))
    assert finding.where == "lever"
    assert "failed while starting (ZeroDivisionError: " in finding.what


@pytest.mark.parametrize(
    ("what", "limits"), [("os.abort()", Limits()), pytest.param("time.sleep(1000.0)", Limits(mesh_seconds=4.0), marks=pytest.mark.full)]
)
def test_a_mesher_that_crashes_or_hangs_is_asked_again_otherwise(folder: Path, what: str, limits: Limits) -> None:
    found = results(mined("lever", code(FIRST_TIME.format(what=what))), limits=limits)
    assert found["lever"].elements > 0


def test_a_mesher_that_always_crashes_is_given_up(folder: Path) -> None:
    text = """
import os, flexstage.solid.fea.meshing.mesh as mesh
tries = []
def attempted(*_):
    tries.append(1)
    return "no" if len(tries) < 7 else os.abort()
mesh.generate_mesh = attempted
"""
    (finding,) = told(mined("lever", code(text)))
    assert finding.what == "its process crashed while meshing (SIGABRT)"
    assert "sliver" in finding.advice


def test_findings_of_the_drawing_come_back_as_they_are(folder: Path) -> None:
    part = rod()
    apart = replace(part, pieces=tuple(replace(piece, frame=Frame(np.eye(3), np.array([1.0, 0.0, 0.0]))) for piece in part.pieces))
    with pytest.raises(DesignError) as caught:
        cad(apart)
    assert told(job(apart)) == caught.value.findings


@pytest.mark.parametrize("workers", [1, 2])
def test_reductions_repeat_bit_by_bit(folder: Path, monkeypatch: pytest.MonkeyPatch, workers: int) -> None:
    """In one process after the other, and side by side: no more processes than workers."""
    outcomes: list[bytes] = []
    started: list[processes.Worker] = []
    plain = processes.Worker
    monkeypatch.setattr(processes, "Worker", lambda *said: started.append(plain(*said)) or started[-1])
    jobs = [job(rod()), job(replace(rod(), name="again"))]
    with Pool() as pool:
        for part in (jobs,) if workers == 2 else ([each] for each in jobs):  # the process stays from run to run
            work_all(part, lambda _job, found: outcomes.append(to_bytes(found, "key")), Limits(workers=workers), pool=pool)
        assert len(pool.idle) == workers
    assert outcomes[0] == outcomes[1]
    assert len(started) == workers
    assert all(each.process.poll() is not None for each in started)


def test_a_process_that_has_ended_is_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    codes: Iterator[int | None] = iter([-9, None])

    def worker(*_: object) -> SimpleNamespace:
        return SimpleNamespace(process=SimpleNamespace(poll=lambda: next(codes)), end=lambda: None, kins=set())

    monkeypatch.setattr(processes, "Worker", worker)
    with Pool() as pool:
        first = pool.worker("kin")
        pool.idle = [first]
        assert pool.worker("kin") is not first
        assert not pool.idle


def test_orders_that_share_a_mesh_repeat_bit_by_bit() -> None:
    from flexstage.solid.fea.meshing import mesh
    from flexstage.solid.fea.solver.reduce import reduce_mesh

    def reduced(order: int) -> bytes:
        way = replace(COARSE, fineness=replace(COARSE.fineness, order=order))
        return to_bytes(reduce_mesh(rod(), mesh.mesh_component(rod(), way.fineness), way), "key")

    made = mesh._straight_mesh.cache_info().misses
    together = [reduced(order) for order in (2, 1, 2)]
    assert mesh._straight_mesh.cache_info().misses <= made + 1
    for order, found in zip((2, 1), together, strict=False):
        mesh._straight_mesh.cache_clear()
        mesh._drawing.cache_clear()
        assert reduced(order) == found


@linux
def test_no_room_on_the_disk_is_a_finding(folder: Path) -> None:
    (finding,) = told(mined("lever", code("open('/dev/full', 'wb', 0).write(b'full')")))
    assert finding.what == f"no space is left in the folder for temporary files, {folder}"


def test_too_little_memory_is_refused_with_what_would_fit(folder: Path) -> None:
    (finding,) = told(
        replace(job(rod()), reduction=replace(COARSE, fineness=replace(COARSE.fineness, order=5))), limits=Limits(memory=2.5e8)
    )
    assert finding.where == "prop 1"
    assert "its reduction at order 5 needs about 0.547 GB (16,383 degrees of freedom)" in finding.what
    assert finding.what.endswith("and 0.25 GB are available")
    assert finding.advice.startswith("Use order 3, about 0.219 GB, or larger elements, Fineness(neck=")


def test_a_mesh_without_end_is_refused_before_it_is_made(folder: Path) -> None:
    endless = replace(COARSE, fineness=replace(COARSE.fineness, neck=0.002))
    seen: list[Step] = []
    with pytest.raises(
        DesignError, match=r"prop 1: its reduction at order 2 needs about .* GB .*, and 4 GB are available\. Use larger"
    ) as caught:
        work_all([replace(job(rod()), reduction=endless)], lambda _job, _data: None, Limits(memory=4e9), seen.append)
    assert len(caught.value.findings) == 1
    assert {step.text for step in seen} <= {"prop 1: starting", "done"}


@pytest.mark.parametrize("neck", [pytest.param(0.5, marks=pytest.mark.full), 1.0, 2.5])
def test_no_mesh_has_fewer_elements_than_expected(neck: float) -> None:
    from flexstage.solid.fea.meshing.mesh import mesh_component

    fineness = replace(COARSE.fineness, neck=neck)
    assert fewest_elements(rod(), fineness) <= mesh_component(rod(), fineness).mesh.ne


@linux
def test_more_memory_than_allowed_is_not_given(folder: Path) -> None:
    text = """
import flexstage.solid.fea.meshing.mesh as mesh
mesh.generate_mesh = lambda *_: bytearray(int(4e9))
"""
    (finding,) = told(mined("lever", code(text)), limits=Limits(memory=1e9))
    assert finding == Finding("lever", "it exceeded its memory while meshing", finding.advice)


def test_what_does_not_fit_together_is_done_one_after_the_other(folder: Path) -> None:
    alone = 1.5 * 2e8
    running: list[set[str]] = []

    def progress(step: Step) -> None:
        assembled = {Stage.FACTORISING, Stage.REDUCING, Stage.PROJECTING}
        running.append({part for part in step.text.split(", ") if any(part.endswith(stage.value) for stage in assembled)})

    done: list[str] = []
    jobs = [job(rod(size * mm)) for size in (6.0, 7.0)]
    jobs = [replace(each, component=replace(each.component, name=name)) for each, name in zip(jobs, ("one", "two"), strict=True)]
    work_all(jobs, lambda each, _data: done.append(each.name), Limits(memory=alone, workers=2), progress)
    assert sorted(done) == ["one", "two"]
    assert max(len(names) for names in running) == 1


def test_a_process_tells_the_memory_it_has() -> None:
    worker, size = Worker(setattr), 50_000_000
    worker.call("block", b"")
    before = worker.resident()
    worker.call("block", b"1" * size)
    assert worker.resident() - before >= size
    worker.end()
    assert worker.resident() == 0.0


@pytest.mark.parametrize(("has", "room"), [(0.0, 5.0), (2.0, 7.0), (6.0, 11.0), (7.0, 11.0)])
def test_memory_that_processes_have_is_not_counted_twice(monkeypatch: pytest.MonkeyPatch, has: float, room: float) -> None:
    """Ten are left on the machine, the one that asks has one already, another was granted six, of which it has some."""

    def child(granted: float, resident: float) -> Any:
        return SimpleNamespace(granted=granted, worker=SimpleNamespace(resident=lambda: resident))

    monkeypatch.setattr(processes, "available", lambda: 10.0)
    run: Any = processes.PoolRun(Pool(), (), 2)
    assert run.room(child(0.0, 1.0), [child(6.0, has)]) == room


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_freedoms_and_entries_are_those_of_the_solver(order: int) -> None:
    from flexstage.solid.fea.meshing.mesh import mesh_component
    from flexstage.solid.fea.solver.field import field, stiffness

    mesh = mesh_component(rod(), COARSE.fineness)
    space = field(mesh, (), order)
    counts = Counts(mesh.mesh.nv, mesh.mesh.nedge, mesh.mesh.nface, mesh.mesh.ne)
    assert freedoms(counts, order) == space.size
    assert entries(counts, order) == stiffness(space).mat.nze
    assert needed(counts, order, 8) < needed(counts, order + 1, 8)


def test_progress_rises_from_stage_to_stage_to_the_end(folder: Path) -> None:
    steps: list[Step] = []
    work_all([job(rod())], lambda _job, _data: None, Limits(), steps.append)
    fractions = [step.fraction for step in steps]
    assert fractions == sorted(fractions)
    assert fractions[0] < 0.05
    assert fractions[-1] == 1.0
    seen = list(dict.fromkeys(step.text.removeprefix("prop 1: ") for step in steps))
    order = [*(stage.value for stage in Stage), "done"]
    assert seen == [name for name in order if name in seen]
    assert all(step.left is None or step.left >= 0.0 for step in steps)


@linux
def test_an_interruption_ends_everything(folder: Path) -> None:
    def interrupt(step: Step) -> None:
        if "starting" not in step.text:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work_all([job(rod()), job(replace(rod(), name="other"))], lambda _job, _data: None, Limits(), interrupt)


SCRIPT = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell runs in the background ignores it, children too
import sys
sys.path.insert(0, {root!r})
from flexstage.solid.fea.jobs.reducing import Reduce, fewest_elements
from flexstage.solid.fea.jobs.remote import Limits, work_all
from tests.models.small_solids import Bomb, job, mined, rod
work_all([{job}], lambda each, found: print(each.name, found.freedoms > 100), Limits())
"""
ROOT = str(Path(__file__).parents[2])


def unguarded(folder: Path, what: str) -> tuple[Path, dict[str, str]]:
    """A script without a guard, in a folder with modules that must not be taken for those of the libraries."""
    (folder / "temporary").mkdir()
    for name in ("numpy", "netgen", "pickle"):
        (folder / f"{name}.py").write_text("raise RuntimeError('the wrong module')")
    (folder / "script").mkdir()
    path = folder / "script" / "script.py"
    path.write_text(SCRIPT.format(root=ROOT, job=what))
    return path, {**os.environ, "TMPDIR": str(folder / "temporary")}


def test_a_bare_script_needs_no_guard_and_its_folder_is_not_searched(tmp_path: Path) -> None:
    script, environment = unguarded(tmp_path, "job(rod())")
    done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.stdout == "prop 1 True\n", done.stderr
    assert not list((tmp_path / "temporary").iterdir())


def test_code_without_a_file_works_as_in_a_notebook(tmp_path: Path) -> None:
    script, environment = unguarded(tmp_path, "job(rod())")
    code = script.read_text()
    done = subprocess.run(
        [sys.executable, "-P", "-"], cwd=tmp_path, input=code, env=environment, capture_output=True, text=True, check=False
    )
    assert done.stdout == "prop 1 True\n", done.stderr


@linux
@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_the_child_ends_with_its_parent(tmp_path: Path, ending: signal.Signals) -> None:
    script, environment = unguarded(tmp_path, "mined('lever', Bomb(eval, '__import__(\"time\").sleep(1000)'))")
    with subprocess.Popen([sys.executable, str(script)], env=environment, stderr=subprocess.DEVNULL) as parent:
        until(lambda: working_in(tmp_path / "temporary"))
        parent.send_signal(ending)
        assert parent.wait() != 0
    until(lambda: not working_in(tmp_path / "temporary"))
    assert not list((tmp_path / "temporary").iterdir())
