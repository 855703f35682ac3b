"""Files of tests read, whatever their form: as a record, or as the frequency responses an analyser stored."""

from __future__ import annotations

import os
from pathlib import Path

from flexstage.base.files import require_regular
from flexstage.base.finding import DesignError, refuse
from flexstage.experiment.formats.hdf import hdf_contents
from flexstage.experiment.formats.mat import is_version_73, mat_contents
from flexstage.experiment.formats.stored import responses_of
from flexstage.experiment.formats.table.read import read_table
from flexstage.experiment.formats.uff.read import read_uff
from flexstage.experiment.formats.variables import Contents, record_of
from flexstage.experiment.options import Kind, Options
from flexstage.experiment.record import Record, Responses

_DEFAULT = Options()
_HDF5 = b"\x89HDF\r\n\x1a\n"
_START = 4096
_FORMS = "Records are universal files (data set 58), MAT, HDF5 and CSV files"
_OTHERS = {
    b"TDSm": "a TDMS file of LabVIEW",
    b"RIFF": "a WAV file",
    b"PK\x03\x04": "a zip archive, as spreadsheets and npz files are",
    b"\x93NUMPY": "an npy file of numpy",
    b"\x1f\x8b": "compressed by gzip",
    b"%PDF": "a PDF",
    b"\xd0\xcf\x11\xe0": "an old spreadsheet",
}


def read(path: str | os.PathLike[str], options: Options = _DEFAULT) -> Record | Responses:
    """Read a file of a test: UFF58 in ASCII or binary, MAT (v4, v5, v7.3), HDF5 or CSV, told by its content.

    Samples stay in the file where its form allows (binary and regular ASCII UFF, MAT v7.3, HDF5, CSV) and are read in blocks as they are
    needed. Units and numbers are those of the file. Raises `DesignError` with all that keeps the file from being read, and where it holds a
    record and responses both and `options.kind` does not say which is meant.

    >>> import tempfile
    >>> import numpy as np
    >>> from flexstage.experiment.record import Channel, in_memory
    >>> from flexstage.experiment.formats.write import write
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(Path(folder) / "a.uff", in_memory([Channel("u1", "V"), Channel("S1", "um")], 2048.0, np.zeros((8, 2))))
    ...     found = read(Path(folder) / "a.uff")
    >>> found.rate, [channel.name for channel in found.inputs]
    (2048.0, ['u1'])
    """
    place = Path(path)
    start = _opening(place)
    if start.startswith(b"MATLAB") or is_version_73(start) or (place.suffix.lower() == ".mat" and not start.startswith(_HDF5)):
        return _told_apart(mat_contents(place), options)
    if start.startswith(_HDF5):
        return _told_apart(hdf_contents(place), options)
    for mark, name in _OTHERS.items():
        if start.startswith(mark):
            raise refuse(str(place), f"it is {name}", f"{_FORMS}: export one of them")
    if _is_uff(start):
        return _only_one(place, read_uff(place, options), options)
    return _wanted(place, read_table(place, options), options)


def _opening(path: Path) -> bytes:
    """The first bytes. Raises `DesignError` where there is no file, none that can be read, or an empty one."""
    require_regular(path)
    try:
        with path.open("rb") as stream:
            start = stream.read(_START)
    except OSError as error:
        raise refuse(str(path), f"it cannot be read ({error.strerror})", "Name a file that can be read") from None
    if not start.strip():
        raise refuse(str(path), "it is empty", "Export it anew")
    return start


def _is_uff(start: bytes) -> bool:
    lines = [line.strip() for line in start.lstrip().split(b"\n")[:2]]
    return lines[0] == b"-1" and len(lines) > 1 and lines[1][:2].isdigit()


def _told_apart(contents: Contents, options: Options) -> Record | Responses:
    """The record or the responses of a file's arrays; the error of one is told only where there is not the other."""
    found: list[Record | Responses | None] = []
    errors: list[DesignError] = []
    for kind, reader in ((Kind.RECORD, record_of), (Kind.RESPONSES, responses_of)):
        if options.kind in (None, kind):
            try:
                found.append(reader(contents, options))
            except DesignError as error:
                errors.append(error)
    if errors and not any(found):
        raise DesignError([finding for error in errors for finding in error.findings])
    if not any(found):
        raise _nothing(contents, options)
    record = next((each for each in found if isinstance(each, Record)), None)
    responses = next((each for each in found if isinstance(each, Responses)), None)
    return _only_one(Path(contents.where), (record, responses), options)


def _nothing(contents: Contents, options: Options) -> DesignError:
    arrays = ", ".join(f"{each.name} {each.shape}" for each in contents.variables[:12]) or "none"
    wanted = {None: "a record or responses", Kind.RECORD: "a record", Kind.RESPONSES: "frequency responses"}[options.kind]
    advice = 'A record has channels and times ("time"), a step ("dt") or a rate ("fs"); responses are complex, with frequencies ("f")'
    return refuse(
        contents.where, f"{wanted} cannot be told from its arrays: {arrays}", f"{advice}. Rename or add what is missing, or state the rate"
    )


def _only_one(path: Path, both: tuple[Record | None, Responses | None], options: Options) -> Record | Responses:
    record, responses = both
    if record is not None and responses is not None:
        channels, size = ", ".join(record.names[:8]), len(responses.frequencies)
        what = f"it holds a record ({channels}; {record.length} samples) and frequency responses ({size} frequencies)"
        raise refuse(str(path), what, 'Say which is meant (kind): "record" or "responses"')
    found = record if record is not None else responses
    if found is None:
        raise refuse(str(path), f"it holds no {options.kind.value if options.kind else 'record'}", "Ask for the other kind")
    return found


def _wanted(path: Path, found: Record | Responses, options: Options) -> Record | Responses:
    kind = Kind.RECORD if isinstance(found, Record) else Kind.RESPONSES
    if options.kind not in (None, kind):
        raise refuse(str(path), f"it holds a {kind.value}, not what is asked for ({options.kind.value})", f'Ask for "{kind.value}"')
    return found


read_record = read
"""`read` under the name it has in `flexstage` itself."""
