"""Records and responses written to a file in any of the forms that are read."""

from __future__ import annotations

import os
from enum import Enum
from pathlib import Path

from flexstage.base.finding import refuse
from flexstage.experiment.formats.hdf import write_hdf
from flexstage.experiment.formats.mat import write_mat
from flexstage.experiment.formats.table.write import write_table
from flexstage.experiment.formats.uff.write import write_uff
from flexstage.experiment.record import Record, Responses


class Form(Enum):
    """A form of file."""

    UFF = "uff"
    """Universal file, binary: to the bit."""
    UFF_ASCII = "uff-ascii"
    """Universal file, ASCII: 13 digits."""
    MAT = "mat"
    """MAT file of version 5: to the bit, up to 2 GB."""
    MAT_73 = "mat-7.3"
    """MAT file of version 7.3: to the bit, of any size."""
    HDF5 = "hdf5"
    """HDF5 file: to the bit, of any size."""
    CSV = "csv"
    """CSV file: to the bit, large."""


_SUFFIXES = {
    **dict.fromkeys((".uff", ".unv", ".58", ".ufb"), Form.UFF),
    **dict.fromkeys((".h5", ".hdf5", ".hdf"), Form.HDF5),
    **dict.fromkeys((".csv", ".txt"), Form.CSV),
    ".mat": Form.MAT,
}
_VERSION_5_HOLDS = 2**31 - 1


def form_of(path: str | os.PathLike[str], what: Record | Responses) -> Form:
    """The form a file's name asks for; MAT files too large for version 5 are of version 7.3. Raises `DesignError` for other names.

    >>> from flexstage.experiment.record import Channel, in_memory
    >>> import numpy as np
    >>> form_of("test.h5", in_memory([Channel("S1", "um")], 1.0, np.zeros((2, 1))))
    <Form.HDF5: 'hdf5'>
    """
    form = _SUFFIXES.get(Path(path).suffix.lower())
    if form is None:
        raise refuse(os.fspath(path), "its name does not say the form of file", f"Let it end in {', '.join(_SUFFIXES)}")
    large = isinstance(what, Record) and 8 * what.length * len(what.channels) > _VERSION_5_HOLDS
    return Form.MAT_73 if form is Form.MAT and large else form


def write(path: str | os.PathLike[str], what: Record | Responses, form: Form | None = None) -> None:
    """Write a record or responses, in the form named or that of the file's name, whole or not at all.

    Raises `DesignError` for channel names or units the form cannot hold and where the file cannot be written.

    >>> import tempfile
    >>> import numpy as np
    >>> from flexstage.experiment.formats.read import read
    >>> from flexstage.experiment.record import Channel, in_memory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(Path(folder) / "a.csv", in_memory([Channel("S1", "um")], 3.0, np.array([[0.1], [0.2]])))
    ...     read(Path(folder) / "a.csv").values.tolist()
    [[0.1], [0.2]]
    """
    form = form or form_of(path, what)
    if form in (Form.UFF, Form.UFF_ASCII):
        write_uff(path, what, binary=form is Form.UFF)
    elif form in (Form.MAT, Form.MAT_73):
        write_mat(path, what, version_73=form is Form.MAT_73)
    elif form is Form.HDF5:
        write_hdf(path, what)
    else:
        write_table(path, what)


write_record = write
"""`write` under the name it has in `flexstage` itself."""
