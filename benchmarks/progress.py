"""The time left that `verify` tells, over what was left indeed: the parallelogram at order two from an empty cache.

The announced work and the ratio at nine instants of the whole are printed. Target: within a factor of two from the first quarter on.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import sys
import tempfile
import time
from pathlib import Path

from flexstage.base.processes.progress import Step
from flexstage.cases.registry import case
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


def told(name: str, order: int, folder: Path) -> tuple[float, list[tuple[float, float]]]:
    """Seconds taken, and the time left as it was told, by the seconds since the start."""
    shown, said = ProgressBar(None), list[tuple[float, float]]()

    def step(step: Step) -> None:
        shown.step(step)
        if shown.left is not None:
            said.append((time.monotonic() - begun, shown.left))

    stage, asked = case(name), Resolution(0.01, order)
    begun = time.monotonic()
    with Pool() as pool:
        ways = Ways(Cache(folder), step, pool=pool, note=print)
        plan = verification_plan(stage, asked, ways)
        begun, said[:] = time.monotonic(), []
        work_ahead(plan, ways)
        verify(stage, asked, solids(ways), hinges(0.01, order, ways))
        return time.monotonic() - begun, said


def main(name: str = "parallelogram", order: str = "2") -> int:
    """Print the ratios; how many instants from the first quarter on are beyond the factor."""
    with tempfile.TemporaryDirectory() as folder:
        taken, said = told(name, int(order), Path(folder))
    print(f"{name}, order {order}: {taken:.0f} s")
    missed = 0
    for instant in INSTANTS:
        at, left = min(said, key=lambda each: abs(each[0] - instant * taken))
        ratio = left / (taken - at)
        beyond = instant >= FROM and not 1.0 / FACTOR <= ratio <= FACTOR
        missed += beyond
        print(f"  after {instant:4.0%}: told {left:5.0f} s, left {taken - at:5.0f} s: {ratio:.2f}{'  beyond' if beyond else ''}")
    print(f"{missed} of {len([each for each in INSTANTS if each >= FROM])} instants beyond a factor of {FACTOR:g}")
    return missed


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) > 0)
