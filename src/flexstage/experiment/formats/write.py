"""Writing of records and responses in any supported format."""

from __future__ import annotations

import os
from pathlib import Path

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.experiment.formats import FORMATS
from flexstage.experiment.records.record import Record, Responses


@check_arguments
def write(path: str | os.PathLike[str], what: Record | Responses, form: str = "") -> None:
    """Write a record or responses, completely or not at all, in the format `form` (default: the format for the ending of the file name).

    Formats are `uff` (binary), `mat` (version 5), `hdf5`, `csv`, and those of other packages. Raises `DesignError` for unknown names and
    endings, for channel names or units that the format does not support, and if the file cannot be written.

    >>> import tempfile
    >>> import numpy as np
    >>> from flexstage.experiment.formats.read import read
    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(Path(folder) / "a.csv", in_memory([Channel("S1", "um")], 3.0, np.array([[0.1], [0.2]])))
    ...     read(Path(folder) / "a.csv").values.tolist()
    [[0.1], [0.2]]
    """
    place = Path(path)
    known = {name: each for name, each in FORMATS.all.items() if each.write is not None}
    if form and form not in known:
        raise refuse(os.fspath(path), f'unknown file format "{form}"', f"Use one of {', '.join(known)}")
    found = known.get(form) or next((each for each in known.values() if place.suffix.lower() in each.suffixes), None)
    if found is None or found.write is None:
        endings = ", ".join(suffix for each in known.values() for suffix in each.suffixes)
        raise refuse(os.fspath(path), "unknown file ending", f"Use {endings}")
    found.write(place, what)


write_record = write
"""The function `write`, as named in the package `flexstage`."""
