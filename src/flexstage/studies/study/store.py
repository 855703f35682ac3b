"""Results of studies on disk: pieces written as they come, gathered into one HDF5 file that describes itself.

`results.h5` holds what has been gathered; `results.h5.pieces/` the pieces since. Whatever is renamed is whole, so that the reader, which
opens both, finds every computed design exactly once at any moment.
"""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from flexstage.base.finding import Finding, refuse
from flexstage.base.number import Array
from flexstage.base.store import atomic_write
from flexstage.readings.measured.hdf_sound import require_sound
from flexstage.studies.study.definition import Study
from flexstage.studies.study.evaluate import Piece

FORMAT = "flexstage results 1"
_ATTEMPTS = 20
_PIECES = ".pieces"


@dataclass(frozen=True, eq=False)
class Results:
    """Designs computed so far: `designs` (n,) their numbers, `variables` (n, d), `responses` (n, r) in SI, failures by design number.

    `names` and `units` are those of the variables, then of the responses; `planned` designs in all; `facts` what they depend on; `text` the
    study's file; `made` by which versions of what they were computed, one text each.
    """

    designs: Array
    variables: Array
    responses: Array
    failures: Mapping[int, str]
    names: tuple[tuple[str, ...], tuple[str, ...]]
    units: tuple[tuple[str, ...], tuple[str, ...]]
    planned: int
    facts: Mapping[str, str]
    text: str
    made: tuple[str, ...] = ()

    @property
    def complete(self) -> bool:
        """Whether every planned design is there."""
        return len(self.designs) == self.planned

    def column(self, name: str) -> Array:
        """Values (n,) of a variable or a response by name."""
        for names, values in zip(self.names, (self.variables, self.responses), strict=True):
            if name in names:
                return values[:, names.index(name)]
        raise refuse(name, "the results have no column of this name", f"They have {', '.join(sum(self.names, ()))}")

    def to_xarray(self) -> Any:
        """The results as an xarray dataset over the design number, units in the attributes (extra `tables`)."""
        import xarray

        named = [(name, unit) for names, units in zip(self.names, self.units, strict=True) for name, unit in zip(names, units, strict=True)]
        data = {name: ("design", self.column(name), {"units": unit}) for name, unit in named}
        return xarray.Dataset(data, coords={"design": self.designs}, attrs={"study": self.text})

    def to_pandas(self) -> Any:
        """The results as a pandas frame, one row a design (extra `tables`)."""
        import pandas

        return pandas.DataFrame({name: self.column(name) for names in self.names for name in names}, index=pandas.Index(self.designs))


def folder_of(path: Path) -> Path:
    """Where the pieces of a results file wait to be gathered.

    >>> folder_of(Path("a/results.h5")).as_posix()
    'a/results.h5.pieces'
    """
    return path.with_name(f"{path.name}{_PIECES}")


def write_piece(folder: Path, found: Piece) -> Path:
    """Write a piece into the folder: `<start>.npz`, the designs from `start` on.

    Raises `DesignError` where the disk refuses.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     write_piece(Path(place), Piece(256, np.ones((2, 1)), np.ones((2, 3)), {})).name
    '000000000256.npz'
    """
    target = folder / f"{found.start:012d}.npz"
    rows = np.array(sorted(found.failures), dtype=np.int64)
    reasons = np.array([found.failures[row] for row in sorted(found.failures)], dtype=np.str_)
    with atomic_write(target) as place, place.open("xb") as stream:
        np.savez(stream, variables=found.variables, responses=found.responses, rows=rows, reasons=reasons, made=np.array(found.made))
    return target


def read_piece(path: Path) -> Piece:
    """Read a piece back.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     found = read_piece(write_piece(Path(place), Piece(256, np.ones((2, 1)), np.ones((2, 3)), {1: "too thin"})))
    >>> found.start, found.responses.shape, found.failures
    (256, (2, 3), {1: 'too thin'})
    """
    with _loaded(path) as stored:
        return Piece(int(path.stem), stored["variables"], stored["responses"], _failures(stored), str(stored["made"]))


def read_failures(path: Path) -> dict[int, str]:
    """The failures alone of a piece: reasons by row.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     read_failures(write_piece(Path(place), Piece(256, np.ones((2, 1)), np.ones((2, 3)), {1: "too thin"})))
    {1: 'too thin'}
    """
    with _loaded(path) as stored:
        return _failures(stored)


@contextmanager
def _loaded(path: Path) -> Generator[Any]:
    """A piece's arrays. Raises `FileNotFoundError` where it is gone, `DesignError` for what is none."""
    try:
        with np.load(path) as stored:
            yield stored
    except FileNotFoundError:
        raise
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):
        raise refuse(os.fspath(path), "it is no piece of results, or damaged", "Take it away and resume: it is computed again") from None


def _failures(stored: Any) -> dict[int, str]:
    return dict(zip(stored["rows"].tolist(), stored["reasons"].tolist(), strict=True))


def waiting(path: Path) -> dict[int, Path]:
    """Pieces that are not gathered yet, by their first design.

    >>> waiting(Path("nowhere/results.h5"))
    {}
    """
    folder = folder_of(path)
    return {int(each.stem): each for each in sorted(folder.glob("[0-9]*.npz"))} if folder.is_dir() else {}


def columns_of(study: Study) -> tuple[tuple[tuple[str, ...], tuple[str, ...]], tuple[tuple[str, ...], tuple[str, ...]]]:
    """Names, then SI units, of the variables and of the responses.

    >>> from flexstage.studies.study.example import neck_study
    >>> columns_of(neck_study())
    ((('neck',), ('tilt',)), (('m',), ('Hz',)))
    """
    names = tuple(each.name for each in study.variables), tuple(study.columns)
    return names, (tuple(each.quantity.si for each in study.variables), tuple(each.quantity.si for each in study.columns.values()))


def computed(path: Path, size: int, designs: int) -> Array:
    """Which pieces (k,) of `size` designs are there already, gathered or waiting.

    >>> computed(Path("nowhere/results.h5"), 256, 1000).tolist()
    [False, False, False, False]
    """
    done = gathered(path)
    done = done if len(done) else np.zeros(-(-designs // size), dtype=bool)
    for start in waiting(path):
        done[start // size] = True
    return done


def gathered(path: Path) -> Array:
    """Which pieces (k,) the results file holds; none (0,) where there is no file.

    >>> gathered(Path("nowhere/results.h5")).tolist()
    []
    """
    if not path.exists():
        return np.zeros(0, dtype=bool)
    with opened(path) as file:
        return np.asarray(file["computed"][:], dtype=bool)


@contextmanager
def opened(path: Path) -> Generator[Any]:
    """The results file, open for reading; nobody writes to one that is there, so that no lock is needed.

    Raises `FileNotFoundError` for a file that is not there, `DesignError` for one that is none.

    >>> with opened(Path("nowhere/results.h5")):
    ...     pass
    Traceback (most recent call last):
        ...
    FileNotFoundError: ...
    """
    import h5py

    where = os.fspath(path)
    require_sound(path)
    try:
        with h5py.File(path, "r", locking=False) as file:
            if file.attrs.get("format") != FORMAT:
                raise refuse(where, "it holds no results of a study", f'Name another file: its format is to be "{FORMAT}"')
            yield file
    except FileNotFoundError:
        raise
    except (OSError, KeyError) as error:
        what = " ".join(str(error.args[-1] if error.args else error).split())
        raise refuse(where, f"it cannot be read as results of a study ({what})", "Take it away, or name another file") from None


def read_results(path: str | os.PathLike[str]) -> Results:
    """Read results, complete or not, by their file or the folder of pieces beside it. Raises `DesignError` for files that are none.

    >>> read_results("nowhere/results.h5")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/results.h5: there is no such file. Check the path.
    """
    where = os.fspath(path)
    target = Path(where.rstrip("/").removesuffix(_PIECES))
    if not target.exists():
        raise refuse(where, "there is no such file", "Check the path")
    for _ in range(_ATTEMPTS):  # a piece that is gathered while we look is gone from the folder, and in the file the next time
        pieces = list(waiting(target).values())
        try:
            with opened(target) as file:
                return _read(file, pieces)
        except FileNotFoundError:
            continue
    raise refuse(where, "its pieces are gathered faster than they can be read", "Try again")


def _read(file: Any, pieces: list[Path]) -> Results:
    size, planned = int(file.attrs["piece"]), int(file.attrs["planned"])
    done = file["computed"][:].astype(bool)
    more = [found for found in map(read_piece, pieces) if not done[found.start // size]]
    there = np.repeat(done, size)[:planned]
    for found in more:
        there[found.start : found.start + len(found.variables)] = True
    designs = np.flatnonzero(there)
    failures = {int(design): reason.decode() for design, reason in file["failures"][:]}
    failures |= {found.start + row: reason for found in more for row, reason in found.failures.items()}
    return Results(
        designs,
        _table(file["variables"], [(found.start, found.variables) for found in more], there),
        _table(file["responses"], [(found.start, found.responses) for found in more], there),
        dict(sorted(failures.items())),
        names=_labels(file, "names"),
        units=_labels(file, "units"),
        planned=planned,
        facts={key.replace("|", "/"): str(value) for key, value in file["facts"].attrs.items()},
        text=str(file.attrs["study"]),
        made=tuple(sorted({*(str(each) for each in file.attrs["made"]), *(found.made for found in more)})),
    )


def _table(data: Any, more: list[tuple[int, Array]], there: Array) -> Array:
    """All designs that are there, in order of their numbers."""
    values = np.asarray(data[:])
    for start, rows in more:
        values[start : start + len(rows)] = rows
    return values if there.all() else values[there]


def _labels(file: Any, label: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return tuple(file["variables"].attrs[label].tolist()), tuple(file["responses"].attrs[label].tolist())


def differences(path: Path, study: Study) -> Iterator[Finding]:
    """How the study that a results file belongs to differs from this one.

    >>> import tempfile
    >>> from flexstage.studies.study.example import neck_study
    >>> from flexstage.studies.study.gather import gather
    >>> with tempfile.TemporaryDirectory() as place:
    ...     path = Path(place, "results.h5")
    ...     gather(path, neck_study(), 256)
    ...     [each.what.partition(",")[0] for each in differences(path, neck_study(designs=8))]
    ['plan was sampling sobol']
    """
    with opened(path) as file:
        before = {key.replace("|", "/"): str(value) for key, value in file["facts"].attrs.items()}
    now = study.facts
    for key in [*before, *(key for key in now if key not in before)]:
        if before.get(key) != now.get(key):
            what = f"{key} was {before.get(key, 'absent')} and is {now.get(key, 'absent')}"
            yield Finding(os.fspath(path), what, "Resume with the study as it was, or name another file")
