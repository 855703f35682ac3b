"""A sweep of many designs: how fast, in how much memory, and whether it survives being killed.

Six platform frequencies of the shipped stage over eight variables, by the command as users run it, twice: once unbroken, and once killed
with SIGKILL at random moments (the whole group of processes, or the parent alone so that its workers are orphans), and resumed each
time, while a reader opens the results again and again. Both must end with the same bytes. The floors are measured in the same run: the
dense path as it reads a piece of designs, and the engine alone, without description, checks, files and processes.

    python benchmarks/studies.py --designs 1000000 --kills 20
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import contextlib
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Generator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from flexstage.base.number import Table
from flexstage.base.processes.jobs import cores, environment
from flexstage.models.batch.engine import platform_modes
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.engine import Engine, engine_of
from flexstage.studies.sweeps.execution.evaluate import piece
from flexstage.studies.sweeps.execution.run import piece_size
from flexstage.studies.sweeps.execution.store import folder_of, gather, read_results, write_piece
from flexstage.studies.sweeps.file import load_study

STUDY = """
format = "flexstage study 1"
name = "six frequencies"
case = "double-triangle"
sweep = {{ sampling = "latin hypercube", designs = {designs}, seed = 1 }}
[variables]
neck = {{ address = "parts.neck.thickness", from = "1.4 mm", to = "1.7 mm" }}
plate = {{ address = "bodies.platform.solids.plate.size.z", from = "-10 %", to = "+10 %" }}
notch = {{ address = "parts.lever_notch.thickness", from = "0.8 mm", to = "1.2 mm" }}
foot = {{ address = "parts.foot_notch.thickness", from = "-10 %", to = "+10 %" }}
pole = {{ address = "parts.pole_neck.thickness", from = "-10 %", to = "+10 %" }}
young = {{ address = "materials.steel.young", from = "-5 %", to = "+5 %" }}
density = {{ address = "materials.steel.density", from = "-2 %", to = "+2 %" }}
radius = {{ address = ["placements.B1-B3.pattern.radius", "placements.B4-B6.pattern.radius"], from = "-5 %", to = "+5 %" }}
[responses]
f1 = "frequency.platform.1"
f2 = "frequency.platform.2"
f3 = "frequency.platform.3"
f4 = "frequency.platform.4"
f5 = "frequency.platform.5"
f6 = "frequency.platform.6"
"""
DENSE, ALONE, PAUSE = 64, 16_384, 0.1
GIGABYTE = 1e9


@dataclass
class Seen:
    """What the reader found: how often it opened the results, and what was wrong."""

    opened: int = 0
    count: int = 0
    wrong: list[str] = field(default_factory=list)


def sweep(study: Path, results: Path, workers: int) -> subprocess.Popen[bytes]:
    """The command, in a group of its own."""
    call = "from flexstage.apps.cli import main; main()"
    words = [sys.executable, "-P", "-c", call, "sweep", study, "-o", results, "--resume", "--workers", str(workers)]
    return subprocess.Popen(
        list(map(str, words)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment(), start_new_session=True
    )


def resident(group: int) -> int:
    """Memory [B] of all processes of a group; nothing where the system does not tell."""
    total = 0
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, ProcessLookupError, ValueError):
            if os.getpgid(int(entry.name)) == group:
                total += int((entry / "statm").read_text().split()[1]) * resource.getpagesize()
    return total


def unbroken(study: Path, results: Path, workers: int) -> tuple[float, float, int]:
    """Seconds of an unbroken run, CPU seconds of all its processes, and the largest sum of their memories [B]."""
    before, start, peak = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic(), 0
    process = sweep(study, results, workers)
    while process.poll() is None:
        peak = max(peak, resident(process.pid))
        time.sleep(PAUSE)
    took, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if process.returncode:
        raise SystemExit(f"the sweep failed: {process.stderr.read().decode()}")
    return took, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, peak


def killed(study: Path, results: Path, how: tuple[int, int, float], told: Seen) -> int:
    """Run, kill and resume until so many kills have been survived or nothing is left; how often it was killed."""
    workers, kills, seconds = how
    chance, startup, survived, before = np.random.default_rng(0), 3.0, 0, 0.0
    while survived < kills and before < 1.0:
        process = sweep(study, results, workers)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(chance.uniform(0.0, startup + 1.8 * seconds * (1.0 - before) / (kills - survived + 1)))
        if process.poll() is not None:
            break
        if chance.random() < 0.5:
            os.kill(process.pid, signal.SIGKILL)  # its workers find out by themselves
        else:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        survived += 1
        if results.exists():
            found = read_results(results)
            sound = len(np.unique(found.designs)) == len(found.designs) and np.isfinite(found.responses).all()
            told.wrong += [] if sound and len(found.designs) >= told.count else [f"after kill {survived}"]
            told.count = max(told.count, len(found.designs))
            before = len(found.designs) / found.planned
    return survived


@contextlib.contextmanager
def reader(results: Path, told: Seen) -> Generator[None]:
    """A thread that opens the results all the time."""
    ended = threading.Event()

    def watch() -> None:
        while not ended.wait(PAUSE):
            if not results.exists():
                continue
            try:
                found = read_results(results)
                told.opened += 1
                told.wrong += [] if np.all(np.diff(found.designs) > 0) else ["a design twice"]
            except Exception as error:  # noqa: BLE001 whatever it is
                told.wrong.append(repr(error))

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def floors(study: Study) -> tuple[float, float, float]:
    """CPU seconds: a design by dense matrices, a design by the engine alone, and making the engine once."""
    start = time.process_time()
    engine = engine_of(study)
    fitting = time.process_time() - start
    values = study.sample(0, min(ALONE, study.plan.designs))
    platform_modes(engine.plan, values[:DENSE])
    start = time.process_time()
    piece(study, 0, DENSE, Engine(Table({})))
    dense = (time.process_time() - start) / DENSE
    start = time.process_time()
    platform_modes(engine.plan, values)
    return dense, (time.process_time() - start) / len(values), fitting


def rewriting(study: Study, results: Path) -> float:
    """Seconds that gathering the whole file once more takes."""
    folder = folder_of(results)
    folder.mkdir()
    write_piece(folder, piece(study, 0, piece_size(study)))
    start = time.monotonic()
    gather(results, study, piece_size(study))
    took = time.monotonic() - start
    folder.rmdir()
    return took


def report(study: Study, place: Path, kills: int, workers: int) -> None:
    """Measure and print everything."""
    designs, whole, broken, told = study.plan.designs, place / "whole.h5", place / "broken.h5", Seen()
    dense, alone, fitting = floors(study)
    took, cpu, peak = unbroken(place / "study.toml", whole, workers)
    print(f"{designs} designs, {len(study.variables)} variables, {len(study.columns)} platform frequencies, {workers} workers")
    print(f"  unbroken run            {took:9.1f} s  {designs / took:9.0f} designs/s in all")
    print(f"  CPU time of it          {cpu:9.1f} s  {designs / cpu:9.0f} designs/s a core, {1e6 * cpu / designs:.1f} us a design")
    print(f"  the engine alone                     {1.0 / alone:9.0f} designs/s a core, {1e6 * alone:.1f} us a design")
    print(f"  dense matrices                       {1.0 / dense:9.0f} designs/s a core, {1e6 * dense:.1f} us a design")
    print(f"  over dense matrices     {dense * designs / cpu:9.1f} times; making the engine took {fitting:.1f} s of CPU time, once")
    print(f"  memory of all processes {peak / 1e6:9.0f} MB at most" + ("" if designs < 1_000_000 else ", target 2000 MB"))
    bytes_before = whole.read_bytes()
    again = rewriting(study, whole)
    size = len(bytes_before) / 1e6
    print(f"  results file            {size:9.1f} MB; gathering it once more takes {again:.2f} s, {again / took:.1%} of the run")
    start = time.monotonic()
    with reader(broken, told):
        survived = killed(place / "study.toml", broken, (workers, kills, took), told)
        last = sweep(place / "study.toml", broken, workers)
        code = last.wait()
    same = code == 0 and broken.read_bytes() == bytes_before == whole.read_bytes()
    every = bool(gather(broken, study, piece_size(study)).all()) and len(read_results(broken).designs) == designs
    print(f"  kills survived          {survived:9d} of {kills}, in {time.monotonic() - start:.0f} s")
    print(f"  opened while it ran     {told.opened:9d} times, {len(told.wrong)} of them wrong {told.wrong[:3] or ''}")
    print(f"  every design once       {'yes' if every else 'NO':>9}; the same bytes as unbroken: {'yes' if same else 'NO'}")
    if not (same and every) or told.wrong or survived < kills:
        raise SystemExit(1)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--designs", type=int, default=100_000)
    options.add_argument("--kills", type=int, default=5)
    options.add_argument("--workers", type=int, default=cores())
    asked = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "study.toml")
        path.write_text(STUDY.format(designs=asked.designs))
        report(load_study(path), Path(folder), asked.kills, asked.workers)


if __name__ == "__main__":
    main()
