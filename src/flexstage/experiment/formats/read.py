"""Files of tests read, whatever their form: as a record, or as the frequency responses an analyser stored."""

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
    b"PK\x03\x04": "a zip archive, as spreadsheets and npz files are",
    b"\x93NUMPY": "an npy file of numpy",
    b"\x1f\x8b": "compressed by gzip",
    b"%PDF": "a PDF",
    b"\xd0\xcf\x11\xe0": "an old spreadsheet",
}


@check_arguments
def read(path: str | os.PathLike[str], options: Options = _DEFAULT) -> Record | Responses:
    """Read a file of a test: UFF58 in ASCII or binary, MAT (v4, v5, v7.3), HDF5, CSV, GCS arrays, or a form that another package offers.

    Which it is its content says. Samples stay in the file where its form allows (binary and regular ASCII UFF, MAT v7.3, HDF5, CSV) and are
    read in blocks as they are needed. Units and numbers are those of the file. Raises `DesignError` with all that keeps the file from being
    read, and where it holds a record and responses both and `options.kind` does not say which is meant.

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
        raise refuse(str(place), f"it holds {held}, not what is asked for", "Ask for the other kind (kind)")
    if len(wanted) > 1:
        listed = " and ".join(_describe(each) for each in wanted)
        raise refuse(str(place), f"it holds {listed}", 'Say which is meant (kind): "record" or "responses"')
    if isinstance(wanted[0], Record) and not wanted[0].length:
        raise refuse(str(place), "one of its channels has no samples", "Export the file anew, or leave that channel out (only)")
    return wanted[0]


def _describe(found: Record | Responses) -> str:
    if isinstance(found, Record):
        return f"a record ({', '.join(found.names[:8])}; {found.length} samples)"
    return f"frequency responses ({len(found.frequencies)} frequencies)"


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


def _format(path: Path, start: bytes) -> Format:
    """The form that claims the file; tables are what no other does."""
    known = FORMATS.all
    claiming = (each for each in known.values() if each is not CSV and each.claims(start, path.suffix.lower()))
    found = next(claiming, None)
    other = next((name for mark, name in _OTHERS.items() if start.startswith(mark)), None)
    if found is None and other is not None:
        raise refuse(str(path), f"it is {other}", f"Export one of the forms that are known: {', '.join(known)}")
    return found or CSV


read_record = read
"""`read` under the name it has in `flexstage` itself."""
