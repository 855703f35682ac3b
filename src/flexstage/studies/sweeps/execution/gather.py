"""Pieces of a study gathered into its results file: one HDF5 file that describes itself, written anew as it grows.

What was gathered before and what has come since are written in the order of designs, in one pass: a file with the same designs has the same
bytes, however often it was interrupted on the way.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.storage.files import Hdf, new_hdf
from flexstage.base.storage.store import atomic_write
from flexstage.base.version import __version__
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.evaluate import Piece
from flexstage.studies.sweeps.execution.store import (
    FORMAT,
    columns_of,
    gathered_pieces,
    open_results,
    pending_pieces,
    provenance,
    read_failures,
    read_piece,
    read_stored_failures,
)

_ROWS = 65_536
_TABLES = ("variables", "responses", "failed")
_UNFILLED, _FRAME, _ENTRY = 1_200_000, 100_000, 64
"""What a results file takes at most beside its numbers and reasons [B]: chunks that are not full, its frame, the entry of a failure."""

_ABOUT = (
    "Designs of a study, one a row of variables and responses, in SI by their attributes names, units and of (what they are; variables in "
    "1 may be factors on what the design states). NaN: not computed yet (computed says which pieces are, of piece rows each), or "
    "failed (1 in failed, reasons in failures). study is the study's file, facts what the numbers depend on, made what computed them. "
    "In Python: flexstage.studies.sweeps.execution.store.read_results, then to_xarray() or to_pandas()."
)

Failures = list[tuple[int, str]]


def gather(path: Path, study: Study, size: int) -> None:
    """Write the results file anew, with all pieces of `size` designs so far; then the pieces go.

    Raises `DesignError` where the disk refuses; then file and pieces are as they were.

    >>> import tempfile
    >>> from flexstage.studies.sweeps.example import neck_study
    >>> from flexstage.studies.sweeps.execution.store import read_results
    >>> with tempfile.TemporaryDirectory() as place:
    ...     gather(Path(place, "results.h5"), neck_study(), 256)
    ...     read_results(Path(place, "results.h5")).complete
    False
    """
    pieces = pending_pieces(path)
    if path.exists() and not pieces:
        return
    with atomic_write(path) as place:
        _write(place, path, pieces, study, size)
    _sync(path.parent)  # the new name is on the disk before what it stands for goes
    for each in pieces.values():
        each.unlink(missing_ok=True)


def require_room(path: Path, study: Study) -> None:
    """Raise `DesignError` where the disk has no room for a study's results: the file, beside it the next one, until that is renamed.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> require_room(Path("results.h5").absolute(), neck_study())
    """
    whole = file_size(study)
    there = path.stat().st_size if path.exists() else 0
    missing, free = 2 * whole - min(there, whole), shutil.disk_usage(path.parent).free
    if free < missing:
        what = f"the results need {missing / 1e6:.4g} MB more while they are gathered, {free / 1e6:.4g} MB are free"
        raise refuse(os.fspath(path.parent), what, "Free space and resume (--resume), or name a file elsewhere")


def file_size(study: Study, failures: Failures | None = None) -> int:
    """Size of a study's results file [B] at most, `failures` included.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> file_size(neck_study(2_000_000)) - file_size(neck_study(1_000_000))
    17000000
    """
    numbers = study.plan.designs * (8 * sum(map(len, columns_of(study)[0])) + 1)
    reasons = sum(len(reason.encode()) + _ENTRY for _, reason in failures or [])
    return numbers + min(numbers, _UNFILLED) + reasons + _FRAME + 2 * len(study.text)


def _sync(folder: Path) -> None:
    """Make sure that the names in a folder are on the disk, where the system can tell."""
    if os.name != "posix":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _write(place: Path, path: Path, pieces: dict[int, Path], study: Study, size: int) -> None:
    """The whole file."""
    done = gathered_pieces(path)
    fresh = {start: each for start, each in pieces.items() if not len(done) or not done[start // size]}
    old = open_results(path) if path.exists() else None
    failures: Failures = [] if old is None else read_stored_failures(old)
    failures += [(start + row, reason) for start, each in fresh.items() for row, reason in read_failures(each).items()]
    with new_hdf(place, file_size(study, failures)) as file:
        _frame(file, study, size)
        _fill(file, old, fresh)
        _put_failures(file, sorted(failures))


def _frame(file: Any, study: Study, size: int) -> None:
    """The empty file: names, units and what the study was."""
    import h5py

    names, units = columns_of(study)
    file.attrs["format"] = FORMAT
    file.attrs["study"], file.attrs["version"], file.attrs["about"] = study.text, __version__, _ABOUT
    file.attrs["planned"], file.attrs["piece"] = study.plan.designs, size
    facts = file.create_group("facts", track_order=True)
    for key, value in study.facts.items():
        facts.attrs[key] = value
    count = study.plan.designs
    for number, kind in enumerate(("variables", "responses")):
        data = file.create_dataset(kind, (count, len(names[number])), "f8", fillvalue=np.nan, chunks=_chunks(count, len(names[number])))
        data.attrs["names"], data.attrs["units"] = list(names[number]), list(units[number])
    file["variables"].attrs["address"] = [", ".join(each.addresses) for each in study.variables]
    file["responses"].attrs["measure"] = [f"{each.key} at {each.point}" for each in study.columns.values()]
    file.create_dataset("failed", (count,), "u1", chunks=(min(count, _ROWS),))
    file.create_dataset("computed", (-(-count // size),), "u1")
    kind = np.dtype([("design", "i8"), ("reason", h5py.string_dtype())])
    file.create_dataset("failures", (0,), kind, maxshape=(None,), chunks=(1024,))


def _chunks(count: int, width: int) -> tuple[int, int]:
    return min(count, max(1, _ROWS // width)), width


def _fill(new: Any, old: Hdf | None, pieces: dict[int, Path]) -> None:
    """What is there, block by block: neither file need fit into memory."""
    size, count = int(new.attrs["piece"]), int(new.attrs["planned"])
    done = np.zeros(len(new["computed"]), dtype=bool) if old is None else old.read("computed").astype(bool)
    made = set[str]() if old is None else set(provenance(old))
    step = size * max(1, _ROWS // size)
    for start in range(0, count, step):
        rows = slice(start, min(start + step, count))
        own = [read_piece(pieces[first]) for first in range(start, rows.stop, size) if first in pieces]
        if own or done[start // size : -(-rows.stop // size)].any():
            _write_rows(new, old, rows, own)
        made |= {found.made for found in own}
    done[[start // size for start in pieces]] = True
    new["computed"][:] = done
    new.attrs["made"] = sorted(made)


def _put_failures(new: Any, failures: Failures) -> None:
    new["failures"].resize((len(failures),))
    for first in range(0, len(failures), _ROWS):
        some = failures[first : first + _ROWS]
        new["failures"][first : first + len(some)] = np.array(some, dtype=new["failures"].dtype)


def _write_rows(new: Any, old: Hdf | None, rows: slice, own: list[Piece]) -> None:
    """The designs of some rows: those of the old file, and over them those of the pieces."""
    for name in _TABLES:
        shape = (rows.stop - rows.start, *new[name].shape[1:])
        table = np.full(shape, new[name].fillvalue, dtype=new[name].dtype) if old is None else old.read(name, [(rows.start, rows.stop)])
        for found in own:
            values = _failure_marks(found) if name == "failed" else getattr(found, name)
            table[found.start - rows.start : found.start - rows.start + len(values)] = values
        new[name][rows] = table


def _failure_marks(found: Piece) -> Array:
    marks = np.zeros(len(found.variables), dtype=np.uint8)
    marks[list(found.failures)] = 1
    return marks
