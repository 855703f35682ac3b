"""`flexstage --help` against the bare interpreter, one process each. Target: under 0.3 s."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

REPEATS = 9
TARGET = 0.3
HELP = [sys.executable, "-c", "from flexstage.apps.cli import main; main()", "--help"]
BARE = [sys.executable, "-c", "pass"]
COMMAND = Path(sys.executable).with_name("flexstage")


def seconds(command: list[str]) -> float:
    """Least time of a process: what other programs take does not count."""
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
        times.append(time.perf_counter() - start)
    return min(times)


def main() -> None:
    floor = seconds(BARE)
    helped = seconds([str(COMMAND), "--help"] if COMMAND.exists() else HELP)
    print(f"python -c pass               {1e3 * floor:8.1f} ms")
    print(f"flexstage --help             {1e3 * helped:8.1f} ms   {helped / floor:.1f} x the interpreter alone")
    print(f"target {1e3 * TARGET:.0f} ms: {'met' if helped < TARGET else 'MISSED'}")


if __name__ == "__main__":
    main()
