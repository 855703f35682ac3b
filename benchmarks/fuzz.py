"""Feed readers with altered files and say what came out: read, refused, or something that must not be.

    python benchmarks/fuzz.py --kind designs --count 10000 [--seed 1] [--start 0] [--keep FOLDER]

Kinds: designs, studies, setups, results (of sweeps), tables (CSV), universal (UFF), hdf5 (every superblock), mat; several with commas; all
by default. An input follows from kind, seed and number, so that a run resumes with --start and one input is tried again with --count 1. It
is survived if it is read or refused by a `DesignError` within ten seconds of the processor and two gigabytes. Others are kept, and the
script fails.
"""

from __future__ import annotations

import argparse
import faulthandler
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import psutil

from flexstage.base.finding import DesignError
from tests.roundtrip.fuzzed import KINDS, one_input, tried

SLOWEST, LARGEST = 10.0, 2e9
_STUCK = 600.0
_TOLD = 10_000


class HangError(BaseException):
    """An input took too long."""


def main() -> int:
    parser = argparse.ArgumentParser(description="Fuzz the readers of files.")
    parser.add_argument("--kind", default=",".join(KINDS))
    parser.add_argument("--count", type=int, default=100, help="inputs of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--start", type=int, default=0, help="number of the first input: where a run was stopped")
    parser.add_argument("--keep", type=Path, default=Path("fuzz_inputs"), help="folder for inputs that were not survived")
    options = parser.parse_args()
    if hasattr(signal, "SIGPROF"):
        signal.signal(signal.SIGPROF, _late)
    failed = [name for name in options.kind.split(",") if not survived(name, options)]
    return 1 if failed else 0


def survived(kind: str, options: Any) -> bool:
    """Try the inputs of a kind, tell their counts, and whether all were survived."""
    counts: Counter[str] = Counter()
    slowest, begin = 0.0, time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(options.start, options.start + options.count):
            content = one_input(kind, options.seed, number)
            before = time.perf_counter()
            said = outcome(kind, content, Path(folder))
            slowest = max(slowest, time.perf_counter() - before)
            counts[said] += 1
            if said not in ("read", "refused"):
                keep(options.keep, f"{kind}-{options.seed}-{number}", content, said)
            if (number + 1 - options.start) % _TOLD == 0:
                print(f"{kind}: {number + 1 - options.start} done, resume with --start {number + 1}", file=sys.stderr, flush=True)
    told = ", ".join(f"{count} {name}" for name, count in counts.most_common())
    numbers = f"{options.start} to {options.start + options.count - 1}"
    spent = time.perf_counter() - begin
    print(f"{kind}: {told}; seed {options.seed}, {numbers}; slowest {1e3 * slowest:.0f} ms; {spent:.0f} s", flush=True)
    return not set(counts) - {"read", "refused"}


def outcome(kind: str, content: bytes, folder: Path) -> str:
    """What came of an input."""
    before = time.process_time()
    faulthandler.dump_traceback_later(_STUCK, exit=True)  # within a library, beyond the reach of exceptions
    if hasattr(signal, "SIGPROF"):
        signal.setitimer(signal.ITIMER_PROF, SLOWEST)
    try:
        tried(kind, content, folder)
        said = "read"
    except DesignError as error:
        said = "refused" if error.findings and all(each.where and each.what and each.advice for each in error.findings) else "not told"
    except HangError:
        said = "hang"
    except MemoryError:
        said = "memory"
    except Exception:  # noqa: BLE001 (what must not be)
        traceback.print_exc()
        said = "exception"
    finally:
        if hasattr(signal, "SIGPROF"):
            signal.setitimer(signal.ITIMER_PROF, 0.0)
        faulthandler.cancel_dump_traceback_later()
    if time.process_time() - before > SLOWEST:
        return "hang"
    return "memory" if said in ("read", "refused") and most_memory() > LARGEST else said


def most_memory() -> float:
    """The memory of this process or of its child, whichever has more [B]."""
    own = psutil.Process()
    return max(each.memory_info().rss for each in (own, *(own.children() if _counted() else ())))


_calls = iter(range(sys.maxsize))


def _counted() -> bool:
    """Whether children are looked at: finding them takes longer than most inputs."""
    return next(_calls) % 100 == 0


def keep(folder: Path, name: str, content: bytes, said: str) -> None:
    """Put an input aside, and say so."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content)
    print(f"not survived ({said}): {folder / name}", flush=True)


def _late(_signal: int, _frame: Any) -> None:
    raise HangError


if __name__ == "__main__":
    sys.exit(main())
