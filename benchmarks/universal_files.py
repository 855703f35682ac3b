"""Our reader of universal files beside pyuff: files of instruments, round trips, awkward files, altered ones, a long one.

    python benchmarks/universal_files.py [FOLDER] [--count 1000] [--samples 2000000]

FOLDER holds universal files (`*.uff`, `*.unv`) of other programs; without one their table is left out. It prints the tables of decision
0037. Both readers give the ordinates of every function; "refused" is an exception, with its words where they say what is wrong.
"""

from __future__ import annotations

import argparse
import re
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
import pyuff

from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.experiment.formats.read import read
from flexstage.experiment.formats.uff.read import read_uff
from flexstage.experiment.formats.uff.scan import scan
from flexstage.experiment.formats.uff.write import write_uff
from flexstage.experiment.records.options import Options
from flexstage.experiment.records.record import Channel, Record, in_memory
from tests.roundtrip.fuzzed import one_input
from tests.roundtrip.records import awkward, awkward_record, awkward_responses, write_form

Read = Callable[[Path], list[Array]]
_LONG = 12
_ROWS = 65_536


def ours(path: Path) -> list[Array]:
    """The ordinates of every function, as our reader has them; what breaks off or cannot be read is refused."""
    found, findings = scan(path)
    broken = [each.problem for each in found if each.problem is not None]
    if findings or broken:
        raise DesignError(findings) if findings else ValueError(broken[0])
    read_uff(path, Options(rate=1.0)) if found else None  # what the file says of itself is checked, too
    columns = [each.values.read(0, each.values.length)[:, 0 if each.function.is_even else 1 :] for each in found]
    return [np.ascontiguousarray(column).ravel() for column in columns]


def theirs(path: Path) -> list[Array]:
    """The same by pyuff, complex values as pairs."""
    found = pyuff.UFF(str(path)).read_sets()
    sets = [found] if isinstance(found, dict) else found
    return [np.ascontiguousarray(each["data"]).view(float) for each in sets if each["type"] == 58]


def outcome(read: Read, path: Path) -> list[Array] | str:
    """What a reader gives, or what it says instead."""
    try:
        return read(path)
    except Exception as error:  # noqa: BLE001 pyuff raises plain ones
        return " ".join(str(error).replace(str(path), path.name).split())


def words(found: list[Array] | str, right: list[Array] | None) -> str:
    """An outcome beside what is right, in a cell of a table."""
    if isinstance(found, str):
        return f'refused: "{found[:110]}"'
    if right is None:
        return f"read: {len(found)} functions of {', '.join(str(len(each)) for each in found) or 'none'}"
    if [len(each) for each in found] != [len(each) for each in right]:
        return f"**wrong**: {len(found)} functions of {', '.join(str(len(each)) for each in found) or 'none'} numbers"
    if all(one.tobytes() == other.tobytes() for one, other in zip(found, right, strict=True)):
        return "to the bit"
    pairs = list(zip(found, right, strict=True))
    lost = sum(int(np.count_nonzero(np.isfinite(one) != np.isfinite(other))) for one, other in pairs)
    with np.errstate(all="ignore"):
        off = max(float(np.nanmax(np.abs(one - other) / np.where(other == 0.0, 1.0, np.abs(other)), initial=0.0)) for one, other in pairs)
    return f"within {off:.0e}" if not lost and off < 1e-5 else f"**wrong**: off by {off:.0e}, {lost} numbers lost or made"


def table(title: str, heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    print(f"\n{title}\n\n| {' | '.join(heads)} |\n|{'---|' * len(heads)}")
    print("\n".join(f"| {' | '.join(row)} |" for row in rows))


def instruments(folder: Path) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for path in sorted(each for each in folder.iterdir() if each.suffix in (".uff", ".unv")):
        functions = [each.function for each in scan(path)[0]]
        sets = pyuff.UFF(str(path)).read_sets()
        units = [each["ordinate_axis_units_lab"].strip() for each in ([sets] if isinstance(sets, dict) else sets) if each["type"] == 58]
        mine, other = outcome(ours, path), outcome(theirs, path)
        said = [each.ordinate.unit for each in functions]
        rows.append((path.name, words(mine, None), words(other, mine if isinstance(mine, list) else None), str(said[:1]), str(units[:1])))
    return rows


def by_pyuff(path: Path, record: Record, *, binary: bool) -> None:
    """A record as pyuff writes it."""
    units: dict[str, Any] = {
        "abscissa_spec_data_type": 17,
        "ordinate_spec_data_type": 8,
        "orddenom_spec_data_type": 0,
        "abscissa_axis_units_lab": "s",
    }
    form: dict[str, Any] = {
        "binary": int(binary),
        "abscissa_spacing": 1,
        "abscissa_min": 0.0,
        "abscissa_inc": 1 / record.rate,
        "ref_dir": 0,
        "ref_node": 0,
    }
    times = np.arange(record.length) / record.rate
    sets = [
        pyuff.prepare_58(func_type=1, data=values, x=times, num_pts=len(values), rsp_node=number + 1, rsp_dir=1, **units, **form)
        for number, values in enumerate(record.values.T)
    ]
    pyuff.UFF(str(path)).write_sets(sets)


def by_ours(path: Path, record: Record, *, binary: bool) -> None:
    write_form(path, record, "uff" if binary else "uff-ascii")


def round_trips(folder: Path) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    plain = in_memory(awkward_record().channels, 2048.0, np.random.default_rng(2).standard_normal((500, 6)))
    strange = in_memory([Channel("S1", "um")], 2048.0, np.r_[awkward(0, 400), np.nan, np.inf, -np.inf][:, None])
    for name, record in (("a record of ordinary numbers", plain), ("of awkward ones, NaN and infinity", strange)):
        for binary in (True, False):
            right = list(np.ascontiguousarray(record.values.T))
            for writer, write in (("ours", by_ours), ("pyuff", by_pyuff)):
                path = folder / f"{writer}{binary}{len(rows)}.uff"
                write(path, record, binary=binary)
                form = "binary" if binary else "ASCII"
                rows.append((f"{name}, {form}", writer, words(outcome(ours, path), right), words(outcome(theirs, path), right)))
    for even in (True, False):
        responses, path = awkward_responses(even=even), folder / f"h{even}.uff"
        write_uff(path, responses)
        right = ours(path)
        rows.append(
            (f"responses and coherence, {'even' if even else 'uneven'}, binary", "ours", "to the bit", words(outcome(theirs, path), right))
        )
    return rows


def awkward_files(folder: Path) -> list[tuple[str, ...]]:
    """Files that are sound but unusual, then files that are not: what both make of each."""
    values = np.random.default_rng(1).standard_normal((60, 2))
    record, path = in_memory([Channel("S1", "um"), Channel("S2", "m/s²")], 100.0, values), folder / "awkward.uff"
    write_uff(path, record)
    binary, right = path.read_bytes(), list(np.ascontiguousarray(values.T))
    by_ours(path, record, binary=False)
    text, from_text = path.read_text(), ours(path)
    marked = values.copy()
    marked[10, 0] = np.frombuffer(b"    -1\n ", "<f8")[0]
    write_uff(folder / "marked.uff", in_memory(record.channels, 100.0, marked))
    big = binary.replace(b"58b     1", b"58b     2").replace(values[:, 0].tobytes(), values[:, 0].astype(">f8").tobytes())
    big = big.replace(values[:, 1].tobytes(), values[:, 1].astype(">f8").tobytes())
    cut = text.index("    -1\n", 300)
    short = re.sub(r"\n( +\S+E\S+){4}\n    -1\n", "\n    -1\n", text, count=1)
    cases: dict[str, tuple[bytes, list[Array] | None]] = {
        "values whose bytes spell the mark `    -1`": ((folder / "marked.uff").read_bytes(), list(np.ascontiguousarray(marked.T))),
        "the byte order of other processors": (big, right),
        "exponents with D": (re.sub(r"(\d)E([-+]\d\d)", r"\1D\2", text).encode(), from_text),
        "cut within the last function, binary": (binary[: int(0.8 * len(binary))], None),
        "cut within the last function, ASCII": (text[: int(0.8 * len(text))].encode(), None),
        "cut between two functions": (text[: cut + 7].encode(), None),
        "a line of values left out": (short.encode(), None),
        "a head that announces fewer values": (text.replace(f"{4:10d}{60:10d}", f"{4:10d}{40:10d}", 1).encode(), None),
    }
    rows: list[tuple[str, ...]] = []
    for name, (content, expected) in cases.items():
        path.write_bytes(content)
        rows.append((name, words(outcome(ours, path), expected), words(outcome(theirs, path), expected)))
    return rows


def altered(folder: Path, count: int) -> list[tuple[str, ...]]:
    """Altered files: read alike, read otherwise, refused by one of both."""
    counts, path = Counter[str](), folder / "altered.uff"
    for number in range(count):
        path.write_bytes(one_input("universal", 7, number))
        mine, other = outcome(ours, path), outcome(theirs, path)
        if isinstance(mine, str):
            counts["refused by both" if isinstance(other, str) else "refused by ours, read by pyuff"] += 1
        elif isinstance(other, str):
            counts["read by ours, refused by pyuff"] += 1
        else:
            same = len(mine) == len(other) and all(
                a.shape == b.shape and np.allclose(a, b, rtol=1e-9, equal_nan=True) for a, b in zip(mine, other, strict=True)
            )
            counts["read alike by both" if same else "read otherwise"] += 1
    return [(name, str(number)) for name, number in counts.most_common()]


def long_record(folder: Path, samples: int) -> list[tuple[str, ...]]:
    path = folder / "long.uff"
    write_uff(path, in_memory([Channel(f"S{number}", "um") for number in range(_LONG)], 20_000.0, np.full((samples, _LONG), 1.5)))
    rows = [("size of the file", f"{path.stat().st_size / 1e6:.0f} MB", "the same")]
    told = [
        subprocess.run([sys.executable, __file__, "--mean", who, str(path)], capture_output=True, text=True, check=True)
        for who in ("ours", "pyuff")
    ]
    both = [each.stdout.split() for each in told]
    return [
        *rows,
        *(
            (name, *(each[number] for each in both))
            for number, name in enumerate(("mean of all, seconds", "mean of all, peak memory [MB]"))
        ),
    ]


def mean(who: str, path: Path) -> None:
    """The mean of every channel, once: seconds and peak memory."""
    start = time.process_time()
    if who == "ours":
        record = read(path)
        sum(block.sum(axis=0) for block in record.blocks(_ROWS)) if isinstance(record, Record) else None
    else:
        [each.mean() for each in theirs(path)]
    print(f"{time.process_time() - start:.1f} {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3:.0f}")


def main() -> None:
    parser = argparse.ArgumentParser(description="Universal files: our reader beside pyuff.")
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--count", type=int, default=1000, help="altered files")
    parser.add_argument("--samples", type=int, default=2_000_000, help="of the long record, a channel")
    parser.add_argument("--mean", default="", help=argparse.SUPPRESS)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    if options.mean:
        mean(options.mean, options.folder)
        return
    with tempfile.TemporaryDirectory() as place:
        heads = ("file", "ours", "pyuff", "unit, ours", "unit, pyuff")
        if options.folder is not None:
            table("Files of instruments", heads, instruments(options.folder))
        table("Round trips", ("what", "written by", "read by ours", "read by pyuff"), round_trips(Path(place)))
        table("Awkward and damaged files", ("what", "ours", "pyuff"), awkward_files(Path(place)))
        table(f"{options.count} altered files", ("outcome", "files"), altered(Path(place), options.count))
        table(f"A record of {_LONG} channels", ("", "ours", "pyuff"), long_record(Path(place), options.samples))


if __name__ == "__main__":
    main()
