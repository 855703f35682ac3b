"""Feed the loader altered designs and noise for some time, and say how many inputs it survived.

    python benchmarks/fuzz_loader.py --seconds 60 [--seed 1]

An input is survived if a description or a `DesignError` comes out, within ten seconds, and if what passes the checks can be expanded.
Otherwise the input stays in `fuzz_loader_input.toml`, and the script fails.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from flexstage.base.finding import DesignError
from flexstage.cases.registry import CASES
from flexstage.mechanism.expand import expand
from flexstage.mechanism.store import dumps, load, tidied
from tests.roundtrip.designs import TEXT
from tests.roundtrip.mutation import mutated, noise

SLOWEST = 10.0


def main() -> int:
    parser = argparse.ArgumentParser(description="Fuzz the loader of design files.")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)  # noqa: S311 (nothing secret)
    designs = [TEXT, *(dumps(tidied(case.build())) for case in CASES.values())]
    path = Path("fuzz_loader_input.toml")
    counts: Counter[str] = Counter()
    slowest, start = 0.0, time.perf_counter()
    while time.perf_counter() - start < options.seconds:
        path.write_bytes(one_input(designs, chance))
        before = time.perf_counter()
        try:
            counts[outcome(path)] += 1
        except BaseException:
            print(f"not survived after {sum(counts.values())} inputs: see {path}")
            raise
        slowest = max(slowest, time.perf_counter() - before)
        if slowest > SLOWEST:
            print(f"not survived: {slowest:.1f} s for one input, see {path}")
            return 1
    path.unlink(missing_ok=True)
    told = ", ".join(f"{count} {name}" for name, count in counts.most_common())
    print(f"{sum(counts.values())} inputs survived in {options.seconds:g} s ({told}); slowest {1e3 * slowest:.0f} ms")
    return 0


def one_input(designs: list[str], chance: random.Random) -> bytes:
    """Noise, or a design altered."""
    if chance.random() < 0.1:
        return noise(chance)
    return mutated(chance.choice(designs), chance).encode("utf-8", "surrogatepass")


def outcome(path: Path) -> str:
    """What came out of the loader."""
    try:
        expand(load(path))
    except DesignError:
        return "refused"
    return "read"


if __name__ == "__main__":
    sys.exit(main())
