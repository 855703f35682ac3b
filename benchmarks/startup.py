"""What people wait for, one process each: `flexstage --help` against the bare interpreter, and the longer commands on the shipped stage.

Seconds are CPU time where the machine has other work as well. Targets of CPU time: `--help` 0.25 s, the help of a command 1 s.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

REPEATS = 9
TARGET, HELP_TARGET = 0.25, 1.0
HELP = [sys.executable, "-c", "from flexstage.apps.cli import main; main()", "--help"]
BARE = [sys.executable, "-c", "pass"]
COMMAND = Path(sys.executable).with_name("flexstage")
LONGER = {
    **{f"{command} --help": HELP_TARGET for command in ("analyse", "modes", "verify", "identify", "loop", "serve", "sweep", "studio")},
    "analyse stage.toml": 1.0,
    "analyse stage.toml --report report.html": 3.0,
    "loop stage.toml": 12.0,
    "loop stage.toml --controller lqg": 12.0,
    "identify record.h5": 5.0,
}
"""Commands, and the processor time [s] that each aims at; the record has twelve channels and lasts 60 s."""
MADE = ("new stage.toml", "rig stage.toml --seconds 60 -o record.h5", "rig stage.toml --seconds 320 -o long.h5")
LONG = (
    "identify long.h5",
    "compare stage.toml --record long.h5",
    "update stage.toml --record long.h5 --parameters neck.thickness,steel.density -o updated.toml",
)
"""Commands on one record of 655,360 samples a channel: each may take `MOST` times as much of a processor as the first."""
MOST, ROUNDS = 1.1, 5


def least_times(command: list[str], folder: str | None = None, repeats: int = REPEATS) -> tuple[float, float]:
    """Least elapsed and least processor time of a process [s]: what other programs take does not count."""
    elapsed, spent = [], []
    for _ in range(repeats):
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        elapsed.append(time.perf_counter() - start)
        spent.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(elapsed), min(spent)


def main() -> None:
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # installed programs do not translate their modules at every start
    bare = least_times(BARE)
    helped = least_times([str(COMMAND), "--help"] if COMMAND.exists() else HELP)
    for name, (elapsed, spent) in {"python -c pass": bare, "flexstage --help": helped}.items():
        print(f"{name:20} {1e3 * elapsed:8.1f} ms elapsed {1e3 * spent:8.1f} ms of a processor")
    print(f"{'ratio':20} {helped[0] / bare[0]:8.1f}    elapsed {helped[1] / bare[1]:8.1f}    of a processor")
    print(f"target {1e3 * TARGET:.0f} ms of a processor: {'met' if helped[1] < TARGET else 'MISSED'}")
    longer()


def longer() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for words in MADE:
            least_times(running(words), folder, 1)
        for words, aim in LONGER.items():
            elapsed, spent = least_times(running(words), folder, 2)
            verdict = "met" if spent < aim else "MISSED"
            print(f"{words:40} {elapsed:8.2f} s elapsed {spent:8.2f} s of a processor   aim {aim:g} s: {verdict}")
        beside(folder)


def beside(folder: str) -> None:
    """Least processor times on the long record, taken in turn: the clock of a machine drifts by more than what is looked for."""
    rounds = [[least_times(running(words), folder, 1)[1] for words in LONG] for _ in range(ROUNDS)]
    least = [min(times) for times in zip(*rounds, strict=True)]
    for words, spent in zip(LONG, least, strict=True):
        ratio = spent / least[0]
        verdict = "met" if ratio <= MOST else "MISSED"
        print(f"{words[:40]:40} {spent:8.2f} s of a processor {ratio:8.2f} times identify   aim {MOST:g}: {verdict}")


def running(words: str) -> list[str]:
    return [*HELP[:-1], *words.split()]


if __name__ == "__main__":
    main()
