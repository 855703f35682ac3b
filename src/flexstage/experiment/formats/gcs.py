"""GCS arrays: ASCII files with a header of `# ` lines, written by the data recorders of Physik Instrumente controllers."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from flexstage.base.finding import refuse
from flexstage.experiment.formats.format import Format
from flexstage.experiment.formats.table.layout import Layout
from flexstage.experiment.formats.table.read import complete_rows, read_record
from flexstage.experiment.records.options import Options, number_names
from flexstage.experiment.records.record import Record, Responses, Role

_HEAD = 1 << 18
_ENTRY = re.compile(r"#\s*(?P<key>[A-Z_]+\d*)\s*=\s*(?P<value>.*?)\s*")
_MARKS = (b"END_HEADER", b"NDATA", b"SAMPLE_TIME", b"SEPARATOR")
_SEPARATORS = {32: None, 9: "\t", 44: ",", 59: ";"}
_DRIVEN = ("commanded", "target", "control ", "open-loop", "voltage of output", "output voltage", "ddl output", "motor output")
_SEEN = ("actual position", "current position", "real position", "position of", "sensor")


def is_gcs(start: bytes, _suffix: str) -> bool:
    r"""Recognise a GCS array from the keys DIM and SAMPLE_TIME in its header.

    >>> is_gcs(b"# VERSION = 1 \n# SEPARATOR = 32 \n# DIM = 2 \n# SAMPLE_TIME = 0.0002 \n", ".dat"), is_gcs(b"# time, u1\n", ".dat")
    (True, False)
    """
    return start.lstrip().startswith(b"#") and re.search(rb"#\s*DIM\s*=", start) is not None and any(mark in start for mark in _MARKS)


def read_gcs(path: Path, options: Options) -> tuple[Record | Responses, ...]:
    r"""Read the record of a GCS array: NAME0, NAME1, ... name its columns, and SAMPLE_TIME [s] is the time step of its lines.

    The header (`# KEY = value` up to `# END_HEADER`) follows PI's general command set, as read by PI's library (PIPython, `getgcsheader`).
    SEPARATOR is the code of the column separator, DIM the number of columns, NDATA the number of lines. The header has no units: the user
    specifies them. Columns of commanded and control values are inputs; columns of positions and sensors are outputs. Other columns are
    classified by their names. Raises `DesignError` for a header without sampling time (if no rate is specified) and for a header that names
    more columns than DIM. A truncated file is accepted only with `FaultTolerance.TRUNCATED`.

    >>> import tempfile
    >>> head = "# SEPARATOR = 32\n# DIM = 2\n# SAMPLE_TIME = 0.5\n# NDATA = 2\n# NAME0 = Target Position of axis 1\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "a.dat").write_text(head + "# NAME1 = Actual Position of axis 1\n# END_HEADER\n1.0 2.0 \n3.0 4.0 \n")
    ...     (found,) = read_gcs(Path(folder) / "a.dat", Options())
    ...     found.rate, [channel.name for channel in found.outputs], found.values.tolist()
    (2.0, ['Actual Position of axis 1'], [[1.0, 2.0], [3.0, 4.0]])
    """
    lines, start = _header(path)
    said = {found["key"]: found["value"] for line in lines if (found := _ENTRY.fullmatch(line.strip()))}
    width = _whole(path, said, "DIM")
    names = number_names(said.get(f"NAME{number}") or f"column {number + 1}" for number in range(width))
    beyond = [key for key in said if re.fullmatch(r"NAME\d+", key) and int(key[4:]) >= width]
    if beyond:
        raise refuse(str(path), f"its header has {', '.join(beyond)}, but its DIM is {width}", "Save the recorded data again")
    layout = Layout(names, ("",) * width, _separator(path, said), ".", start, len(lines) + 1, "latin-1", ())
    samples = complete_rows(path, layout, options, _whole(path, said, "NDATA") if "NDATA" in said else None, closed=False)
    about = {"name": _remark(lines), "roles": tuple(_role(name).value for name in names), "rate": options.rate or _rate(path, said)}
    return read_record(samples, about, options, None)


def _header(path: Path) -> tuple[list[str], int]:
    """Lines of the header, and the byte offset of the numbers."""
    with path.open("rb") as stream:
        raw = stream.read(_HEAD).splitlines(keepends=True)
    count = next((number for number, line in enumerate(raw) if line.strip() and not line.lstrip().startswith(b"#")), len(raw))
    ended = next((number + 1 for number, line in enumerate(raw[:count]) if b"END_HEADER" in line), count)
    return [line.decode("latin-1").strip() for line in raw[:ended]], sum(map(len, raw[:ended]))


def _whole(path: Path, said: Mapping[str, str], key: str) -> int:
    text = said.get(key, "")
    if text.isdecimal() and 0 < int(text) < 10**9:
        return int(text)
    raise refuse(
        f"{path}: {key}", f'wrong value in the header (got "{text}", expected a number of 1 or more)', "Save the recorded data again"
    )


def _separator(path: Path, said: Mapping[str, str]) -> str | None:
    text = said.get("SEPARATOR", "32")
    if text.isdecimal() and int(text) in _SEPARATORS:
        return _SEPARATORS[int(text)]
    known = ", ".join(map(str, _SEPARATORS))
    raise refuse(f"{path}: SEPARATOR", f'unknown separator code (got "{text}", expected one of {known})', "Save it with blanks (32)")


def _rate(path: Path, said: Mapping[str, str]) -> float:
    text = said.get("SAMPLE_TIME", "")
    try:
        step = float(text)
    except ValueError:
        step = 0.0
    if 0.0 < step < float("inf"):
        return 1.0 / step
    found = f'got "{text}"' if text else "missing"
    raise refuse(f"{path}: SAMPLE_TIME", f"the header has no valid time step ({found})", "Specify the rate (option rate)")


def _role(name: str) -> Role:
    """Role of a recorded quantity, from the controllers' terms."""
    plain = name.lower()
    return Role.INPUT if plain.startswith(_DRIVEN) else Role.OUTPUT if plain.startswith(_SEEN) else Role.UNKNOWN


def _remark(lines: list[str]) -> str:
    return next((line.partition("REM")[2].strip() for line in lines if re.match(r"#\s*REM\b", line)), "")


GCS = Format((".dat",), is_gcs, read_gcs)
"""GCS array of a data recorder; read only."""
