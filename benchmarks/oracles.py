"""Modes found by flexstage beside strid, pyOMA-2 and sdypy-EMA, from the same records: errors and time.

Six modes in two close pairs with damping of 1 to 2 %, six inputs at once, 120 s at 2048 Hz; every seed draws other shapes and another
record. 5 seeds a case, or 20 with FLEXSTAGE_TESTS=full. Each package is used as its manual says and helped where it needs it, as told in
tests/elsewhere/identification_peers.py. Rows that say "picked" are told the truth: of all poles of one order those nearest to the true
modes are taken, in frequency and shape; flexstage and pyOMA-2's clusters choose by themselves. "Outputs only" does not see the inputs.
Errors are the worst of the modes found within 1 % of a true one, their median over seeds. Shapes are compared as given, and with
imaginary parts dropped: pyOMA-2's clusters drop them, and the true shapes have none. Modes missed and modes that are not there ("wrong")
are counted over all records. Seconds are those of the processor, the median; our H1 is not in those of whoever gets it. Target: nobody
has a smaller error; where somebody has, it is said.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.elsewhere.identification_peers import EXTRA, PEERS
from tests.elsewhere.identification_scores import ERRORS, OURS, Row, medians, one_record
from tests.models.identification_study import CASES, Case

SEEDS = 20 if os.environ.get("FLEXSTAGE_TESTS") == "full" else 5


def report(case: Case) -> None:
    every = [one_record(case, seed) for seed in range(SEEDS)]
    print(f"\n{case.name}: {SEEDS} records; medians of the worst mode's error")
    heads = "".join(f"{head:>14}" for head in ERRORS)
    print(f"{'':56}{heads}{'missed':>8}{'wrong':>7}{'s':>7}")
    middle = medians(every)
    for row, errors in middle.items():
        scores = [each[row] for each in every]
        package, number, way = row
        numbers = "".join(f"{value:14.5f}" for value in errors[:2]) + "".join(f"{value:14.1e}" for value in errors[2:])
        counts = f"{sum(score.missed for score in scores):8}" + (f"{sum(score.wrong for score in scores):7}" if way.alone else f"{'-':>7}")
        print(f"{package:10}{number:8}{way.text:38}{numbers}{counts}{np.median([score.seconds for score in scores]):7.1f}")
    verdict(middle)


def verdict(middle: dict[Row, np.ndarray]) -> None:
    """Where flexstage has not the least error."""
    others = {row: errors for row, errors in middle.items() if row != OURS}
    for index, what in enumerate(ERRORS):
        better = [
            f"{row[0]} ({row[2].text}), {errors[index] / middle[OURS][index]:.2f} of it"
            for row, errors in others.items()
            if errors[index] < middle[OURS][index]
        ]
        print(f"  {what}: " + (f"flexstage is not the best: {'; '.join(better)}" if better else "flexstage has the least error"))


if __name__ == "__main__":
    absent = sorted({peer.package for peer in PEERS if peer.version is None})
    if absent:
        print(f"Not installed, so not compared: {', '.join(absent)}. They belong to {EXTRA}.")
    if any(peer.version for peer in PEERS):
        for each in CASES:
            report(each)
