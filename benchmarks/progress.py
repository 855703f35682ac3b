"""The CPU time that `verify` announces, and the time left that it shows, over the actual ones, from an empty cache.

Stages are shipped cases or files, at an order, or at 1 % if that is 0. Targets: the announced CPU time within a factor of two, and the time
left at nine instants of the whole within the same from the first quarter on.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import re
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from flexstage.base.processes.progress import Step
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import load
from flexstage.show.command.progress import ProgressBar
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.fea.jobs.remote import Pool
from flexstage.solid.results.hinges import hinges
from flexstage.solid.results.plan import verification_plan, work_ahead
from flexstage.solid.results.read import solids
from flexstage.solid.results.resolution import Resolution
from flexstage.solid.results.verification import verify

FACTOR, FROM = 2.0, 0.25
INSTANTS = tuple(number / 10.0 for number in range(1, 10))


def measured(stage: Mechanism, asked: Resolution, folder: Path, note: Callable[[str], None]) -> tuple[float, list[tuple[float, float]]]:
    """Seconds taken, and the estimated time left by the seconds since the start."""
    shown, said = ProgressBar(None), list[tuple[float, float]]()

    def step(step: Step) -> None:
        shown.step(step)
        if shown.left is not None:
            said.append((time.monotonic() - begun, shown.left))

    begun = time.monotonic()
    with Pool() as pool:
        ways = Ways(Cache(folder), step, pool=pool, note=note)
        plan = verification_plan(stage, asked, ways)
        begun, said[:] = time.monotonic(), []
        work_ahead(plan, ways)
        verify(stage, asked, solids(ways), hinges(asked.accuracy, asked.order, ways))
        return time.monotonic() - begun, said


def used() -> float:
    """CPU seconds of this process, its ended processes and the running ones (Linux)."""
    running = (child for task in Path("/proc/self/task").iterdir() for child in (task / "children").read_text().split())
    fields = [Path(f"/proc/{child}/stat").read_text().rsplit(")", 1)[1].split() for child in running]
    return sum(os.times()[:4]) + sum(int(each) for line in fields for each in line[11:13]) / os.sysconf("SC_CLK_TCK")


def announced(lines: list[str]) -> float:
    """CPU seconds announced in all."""
    found = re.findall(r"about ([0-9.]+) (s|minutes|hours) of CPU time", "\n".join(lines))
    return sum(float(number) * {"s": 1.0, "minutes": 60.0, "hours": 3600.0}[unit] for number, unit in found)


def measure(name: str, order: int) -> int:
    """Print the times of a stage and their ratios; how many are beyond the factor."""
    lines, begun = list[str](), list[float]()

    def note(line: str) -> None:
        lines.append(line)
        if line.startswith("to do"):
            begun.append(used())

    stage = load(Path(name)) if name.endswith(".toml") else case(name)
    with tempfile.TemporaryDirectory() as folder:
        taken, said = measured(stage, Resolution(0.01, order or None), Path(folder), note)
    planned, actual = announced(lines), used() - begun[0]
    print(f"{name}: CPU time {planned:.0f} s announced, {actual:.0f} s used: {planned / actual:.2f}; {taken:.0f} s in all")
    near = [min(said, key=lambda each: abs(each[0] - instant * taken)) for instant in INSTANTS]
    ratios = [left / (taken - at) for at, left in near]
    print("  time left, estimated over actual:", *(f"{each:.2f}" for each in ratios), flush=True)
    late = [ratio for instant, ratio in zip(INSTANTS, ratios, strict=True) if instant >= FROM]
    return sum(not 1.0 / FACTOR <= ratio <= FACTOR for ratio in (planned / actual, *late))


def main(order: str = "2", *names: str) -> int:
    """Print the ratios of stages; how many are beyond the factor."""
    missed = sum(measure(name, int(order)) for name in names or ("parallelogram",))
    print(f"{missed} ratios beyond a factor of {FACTOR:g}")
    return missed


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) > 0)
