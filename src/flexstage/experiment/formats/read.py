"""Reading of test files of any format: as a record, or as frequency responses of an analyser."""

from __future__ import annotations

import os
from pathlib import Path

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.storage.files import require_regular
from flexstage.experiment.formats import FORMATS
from flexstage.experiment.formats.format import Format
from flexstage.experiment.formats.table import CSV
from flexstage.experiment.records.options import Kind, Options
from flexstage.experiment.records.record import Record, Responses

_DEFAULT = Options()
_START = 4096
_OTHERS = {
    b"TDSm": "a TDMS file of LabVIEW",
    b"RIFF": "a WAV file",
    b"PK\x03\x04": "a zip archive, e.g. a spreadsheet or an npz file",
    b"\x93NUMPY": "an npy file of numpy",
    b"\x1f\x8b": "compressed by gzip",
    b"%PDF": "a PDF",
    b"\xd0\xcf\x11\xe0": "an old spreadsheet",
}


@check_arguments
def read(path: str | os.PathLike[str], options: Options = _DEFAULT) -> Record | Responses:
    """Read a test file: UFF58 in ASCII or binary, MAT (v4, v5, v7.3), HDF5, CSV, GCS arrays, or a format of another package.

    The format is recognised from the content. Samples stay in the file and are read in blocks on demand, if the format allows it (binary
    UFF, MAT v7.3, HDF5, CSV, GCS). Units and numbers are those in the file. Raises `DesignError` with all errors. If the file contains both
    a record and responses, `options.kind` is required.

    >>> import tempfile
    >>> import numpy as np
    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> from flexstage.experiment.formats.write import write
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(Path(folder) / "a.uff", in_memory([Channel("u1", "V"), Channel("S1", "um")], 2048.0, np.zeros((8, 2))))
    ...     found = read(Path(folder) / "a.uff")
    >>> found.rate, [channel.name for channel in found.inputs]
    (2048.0, ['u1'])
    """
    place = Path(path)
    found = _format(place, _opening(place)).read(place, options)
    wanted = [each for each in found if options.kind in (None, Kind(each.kind))]
    if not wanted:
        held = " and ".join(each.kind for each in found) or "neither a record nor responses"
        raise refuse(str(place), f"it contains {held}, not the requested kind", "Select the other kind of data (option kind)")
    if len(wanted) > 1:
        listed = " and ".join(_describe(each) for each in wanted)
        raise refuse(str(place), f"it contains {listed}", 'Select one (option kind): "record" or "responses"')
    if isinstance(wanted[0], Record) and not wanted[0].length:
        raise refuse(str(place), "one of its channels has no samples", "Export the file again, or omit that channel (option channels)")
    return wanted[0]


def _describe(found: Record | Responses) -> str:
    if isinstance(found, Record):
        return f"a record ({', '.join(found.names[:8])}; {found.length} samples)"
    return f"frequency responses ({len(found.frequencies)} frequencies)"


def _opening(path: Path) -> bytes:
    """First bytes. Raises `DesignError` for a missing, unreadable or empty file."""
    require_regular(path)
    try:
        with path.open("rb") as stream:
            start = stream.read(_START)
    except OSError as error:
        raise refuse(str(path), f"it cannot be read ({error.strerror})", "Specify a readable file") from None
    if not start.strip():
        raise refuse(str(path), "it is empty", "Export it again")
    return start


def _format(path: Path, start: bytes) -> Format:
    """Format of the file; the table format is the last resort."""
    known = FORMATS.all
    claiming = (each for each in known.values() if each is not CSV and each.claims(start, path.suffix.lower()))
    found = next(claiming, None)
    other = next((name for mark, name in _OTHERS.items() if start.startswith(mark)), None)
    if found is None and other is not None:
        raise refuse(str(path), f"it is {other}", f"Export it in a supported format: {', '.join(known)}")
    return found or CSV


read_record = read
"""The function `read`, as named in the package `flexstage`."""
