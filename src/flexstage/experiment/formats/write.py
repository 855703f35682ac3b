"""Records and responses written to a file in any of the forms that are read."""

from __future__ import annotations

import os
from pathlib import Path

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.experiment.formats import FORMATS
from flexstage.experiment.records.record import Record, Responses


@check_arguments
def write(path: str | os.PathLike[str], what: Record | Responses, form: str = "") -> None:
    """Write a record or responses, in the form named or that of the file's ending, whole or not at all.

    Forms are `uff` (binary), `mat` (version 5), `hdf5`, `csv`, and those that other packages offer. Raises `DesignError`
    for other names and endings, for channel names or units the form cannot hold and where the file cannot be written.

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
        raise refuse(os.fspath(path), f'"{form}" is no form of file', f"Name one of {', '.join(known)}")
    found = known.get(form) or next((each for each in known.values() if place.suffix.lower() in each.suffixes), None)
    if found is None or found.write is None:
        endings = ", ".join(suffix for each in known.values() for suffix in each.suffixes)
        raise refuse(os.fspath(path), "its name does not say the form of file", f"Let it end in {endings}")
    found.write(place, what)


write_record = write
"""`write` under the name it has in `flexstage` itself."""
