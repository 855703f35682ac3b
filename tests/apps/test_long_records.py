"""Records larger than memory: read in blocks, with a bar that tells how far."""

from __future__ import annotations

import json
import os
import pty
import re
import subprocess
import sys
import threading
import tracemalloc
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from flexstage.experiment.formats.read import read
from flexstage.experiment.pipeline import identification, usable_measurement
from flexstage.experiment.progress import followed
from flexstage.experiment.records import numbers
from flexstage.experiment.records.health import examine
from flexstage.experiment.records.record import Record, Samples
from flexstage.experiment.spectral import cross_spectra as spectra_module
from flexstage.experiment.spectral import lines
from flexstage.experiment.spectral.cross_spectra import Segments, spectra
from flexstage.experiment.spectral.lines import record_lines
from tests.models.long_records import written
from tests.models.synthetic_records import Truth

# The high-water mark of this very program: getrusage would count that of the process it was started from as well.
CHILD = """
import resource, sys
from pathlib import Path
from flexstage.apps.cli import run
code = run(sys.argv[1:])
status = Path("/proc/self/status")
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
if status.exists():
    peak = int(next(line for line in status.read_text().splitlines() if line.startswith("VmHWM")).split()[1])
print(f"peak {peak} kB", file=sys.stderr)
raise SystemExit(code)
"""


def on_a_terminal(folder: Path, *arguments: str) -> tuple[str, str]:
    """What a command writes to stdout, and to stderr on a terminal; it must succeed."""
    main, side = pty.openpty()
    shown: list[bytes] = []

    def listen() -> None:
        try:
            while part := os.read(main, 65536):
                shown.append(part)
        except OSError:  # the other end is closed
            return

    listener = threading.Thread(target=listen)
    listener.start()
    settings = os.environ | {"TERM": "xterm", "COLUMNS": "100"}
    with subprocess.Popen(
        [sys.executable, "-c", CHILD, *arguments], cwd=folder, stdout=subprocess.PIPE, stderr=side, env=settings
    ) as child:
        os.close(side)
        out = child.stdout.read() if child.stdout else b""
    listener.join()
    os.close(main)
    told = b"".join(shown).decode()
    assert child.returncode == 0, told
    return out.decode(), told


def modes_are_found(found: np.ndarray, known: Truth) -> None:
    np.testing.assert_allclose(found, known.frequencies, rtol=1e-4)


@pytest.mark.full
def test_ten_minutes_of_twelve_channels_at_20_khz_take_less_than_a_gigabyte(tmp_path: Path) -> None:
    known = written(tmp_path / "long.h5", seconds=600.0, rate=20_000.0)
    out, told = on_a_terminal(tmp_path, "identify", "long.h5", "--json", "-")
    modes_are_found(np.array([mode["frequency_hz"] for mode in json.loads(out)["modes"]]), known)
    peak = re.search(r"peak (\d+) kB", told)
    assert peak is not None
    assert int(peak[1]) < 1_000_000
    for step in ("checking the record", "spectra", "finding modes", "left"):
        assert step in told


def test_a_command_tells_on_a_terminal_how_far_it_is(tmp_path: Path) -> None:
    known = written(tmp_path / "short.h5", seconds=20.0, rate=2000.0)
    out, told = on_a_terminal(tmp_path, "identify", "short.h5", "--json", "-")
    modes_are_found(np.array([mode["frequency_hz"] for mode in json.loads(out)["modes"]]), known)
    assert "100%" in told
    assert "left" in told


@dataclass
class Counted:
    """Other samples; the most numbers that were asked for at once."""

    samples: Samples
    channels: int
    most: int = 0

    @property
    def length(self) -> int:
        return self.samples.length

    def read(self, start: int, stop: int) -> np.ndarray:
        self.most = max(self.most, (min(stop, self.length) - start) * self.channels)
        return self.samples.read(start, stop)


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> int:
    """Blocks so small that a record of some megabytes is as far beyond them as the long one is beyond the usual ones."""
    monkeypatch.setattr(lines, "BLOCK", 160_000)
    monkeypatch.setattr(spectra_module, "BATCH", 40_000)
    monkeypatch.setattr(numbers, "BLOCK", 4096)
    return 160_000


def opened(path: Path, seconds: float) -> tuple[Record, Truth]:
    known = written(path, seconds=seconds, rate=1000.0)
    found = read(path)
    assert isinstance(found, Record)
    return found, known


def test_never_more_than_a_block_is_read(tmp_path: Path, small_blocks: int) -> None:
    whole, known = opened(tmp_path / "a.h5", 40.0)
    counted, shares = Counted(whole.samples, 12), [0.0]
    with followed(lambda _, share: shares.append(share)):
        seen = identification(usable_measurement([replace(whole, samples=counted)]))
    modes_are_found(seen.found.frequencies, known)
    assert counted.most <= small_blocks < whole.length * 12
    assert shares == sorted(shares)
    assert shares[-1] > 0.99


def test_memory_does_not_grow_with_the_record(tmp_path: Path, small_blocks: int) -> None:
    peaks: list[int] = []
    for seconds in (40.0, 160.0):
        record = opened(tmp_path / f"{seconds:g}.h5", seconds)[0]
        tracemalloc.start()
        examine(record)
        spectra(record, Segments(1.0))
        assert sum(len(block.frequencies) > 0 for block in record_lines(record, tuple(range(6)), 6)) == -(-12_000 * seconds // small_blocks)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0] < 12_000 * 160.0 * 8
