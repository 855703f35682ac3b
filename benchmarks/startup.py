"""`flexstage --help` against the bare interpreter, one process each. Target: under 0.3 s."""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from pathlib import Path

REPEATS = 9
TARGET = 0.3
HELP = [sys.executable, "-c", "from flexstage.apps.cli import main; main()", "--help"]
BARE = [sys.executable, "-c", "pass"]
COMMAND = Path(sys.executable).with_name("flexstage")


def least_times(command: list[str]) -> tuple[float, float]:
    """Least elapsed and least processor time of a process [s]: what other programs take does not count."""
    elapsed, spent = [], []
    for _ in range(REPEATS):
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        elapsed.append(time.perf_counter() - start)
        spent.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(elapsed), min(spent)


def main() -> None:
    bare = least_times(BARE)
    helped = least_times([str(COMMAND), "--help"] if COMMAND.exists() else HELP)
    for name, (elapsed, spent) in {"python -c pass": bare, "flexstage --help": helped}.items():
        print(f"{name:20} {1e3 * elapsed:8.1f} ms elapsed {1e3 * spent:8.1f} ms of a processor")
    print(f"{'ratio':20} {helped[0] / bare[0]:8.1f}    elapsed {helped[1] / bare[1]:8.1f}    of a processor")
    print(f"target {1e3 * TARGET:.0f} ms elapsed: {'met' if helped[0] < TARGET else 'MISSED'}")


if __name__ == "__main__":
    main()
