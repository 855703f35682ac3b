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

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.base.storage.files import Attribute, Hdf, hdf
from flexstage.base.storage.store import atomic_write
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.evaluate import Piece

FORMAT = "flexstage results 1"
_ATTEMPTS = 20
_PIECES = ".pieces"


@dataclass(frozen=True)
class Failure:
    """A design, or copy, without values: its number, and why."""

    design: int
    reason: str


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

    @property
    def failed(self) -> tuple[Failure, ...]:
        """Designs without values."""
        return tuple(Failure(design, reason) for design, reason in self.failures.items())

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
    with _load(path) as stored:
        return Piece(int(path.stem), stored["variables"], stored["responses"], _failures(stored), str(stored["made"]))


def read_failures(path: Path) -> dict[int, str]:
    """The failures alone of a piece: reasons by row.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     read_failures(write_piece(Path(place), Piece(256, np.ones((2, 1)), np.ones((2, 3)), {1: "too thin"})))
    {1: 'too thin'}
    """
    with _load(path) as stored:
        return _failures(stored)


@contextmanager
def _load(path: Path) -> Generator[Any]:
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


def pending_pieces(path: Path) -> dict[int, Path]:
    """Pieces that are not gathered yet, by their first design.

    >>> pending_pieces(Path("nowhere/results.h5"))
    {}
    """
    folder = folder_of(path)
    return {int(each.stem): each for each in sorted(folder.glob("[0-9]*.npz"))} if folder.is_dir() else {}


def columns_of(study: Study) -> tuple[tuple[tuple[str, ...], tuple[str, ...]], tuple[tuple[str, ...], tuple[str, ...]]]:
    """Names, then SI units, of the variables and of the responses.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> columns_of(neck_study())
    ((('neck',), ('tilt',)), (('m',), ('Hz',)))
    """
    names = tuple(each.name for each in study.variables), tuple(study.columns)
    return names, (tuple(each.quantity.si for each in study.variables), tuple(each.quantity.si for each in study.columns.values()))


def done_pieces(path: Path, size: int, designs: int) -> Array:
    """Which pieces (k,) of `size` designs are there already, gathered or waiting.

    >>> done_pieces(Path("nowhere/results.h5"), 256, 1000).tolist()
    [False, False, False, False]
    """
    done = gathered_pieces(path)
    done = done if len(done) else np.zeros(-(-designs // size), dtype=bool)
    for start in pending_pieces(path):
        done[start // size] = True
    return done


def gathered_pieces(path: Path) -> Array:
    """Which pieces (k,) the results file holds; none (0,) where there is no file.

    >>> gathered_pieces(Path("nowhere/results.h5")).tolist()
    []
    """
    if not path.exists():
        return np.zeros(0, dtype=bool)
    return open_results(path).read("computed").astype(bool)


def open_results(path: Path) -> Hdf:
    """The results file, read by the process that reads all HDF5 files; nobody writes to one that is there, so that no lock is needed.

    Raises `FileNotFoundError` for a file that is not there, `DesignError` for one that is none.

    >>> open_results(Path("nowhere/results.h5"))
    Traceback (most recent call last):
        ...
    FileNotFoundError: ...
    """
    path.stat()
    file = hdf(path)
    if file.attributes.get("format") != FORMAT:
        raise refuse(os.fspath(path), "it holds no results of a study", f'Name another file: its format is to be "{FORMAT}"')
    require(_damage_findings(file))
    return file


def _damage_findings(file: Hdf) -> Iterator[Finding]:
    """What results have and this file has not, or not as it should."""
    advice = "It was changed or is damaged: take it away, or name another file"
    attributes = file.attributes
    wrong = [key for key in ("planned", "piece") if not _is_count(attributes.get(key))] + ["study"] * (
        not isinstance(attributes.get("study"), str)
    )
    if wrong:
        yield Finding(os.fspath(file.path), f"its {', '.join(wrong)} cannot be read", advice)
        return
    planned, size = (int(float(str(attributes[key]))) for key in ("planned", "piece"))
    shapes = {name: (planned, len(_labels(file, name, "names"))) for name in ("variables", "responses")}
    for name, shape in {**shapes, "computed": (-(-planned // size),), "failed": (planned,)}.items():
        found = file.arrays.get(name)
        if found is None or found.shape != shape or found.kind not in ("f", "u", "i", "b"):
            yield Finding(f"{file.path}: {name}", f"shape {found.shape if found else 'none'} where {shape} is expected", advice)
    if "failures" not in file.arrays or dict(file.arrays["failures"].columns) != {"design": "i", "reason": "t"}:
        yield Finding(f"{file.path}: failures", "it has no designs and reasons", advice)
    if "facts" not in file.groups:
        yield Finding(f"{file.path}: facts", "they are not there", advice)
    for name in ("variables", "responses"):
        if len(_labels(file, name, "units")) != shapes[name][1]:
            yield Finding(f"{file.path}: {name}", "it has not as many units as names", advice)


def _is_count(value: Attribute | None) -> bool:
    return isinstance(value, float) and 1.0 <= value < 2.0**53 and value.is_integer()


@check_arguments
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
        pieces = list(pending_pieces(target).values())
        try:
            return _read(open_results(target), pieces)
        except FileNotFoundError:
            continue
    raise refuse(where, "its pieces are gathered faster than they can be read", "Try again")


def _read(file: Hdf, pieces: list[Path]) -> Results:
    size, planned = (count_of(file, key) for key in ("piece", "planned"))
    done = file.read("computed").astype(bool)
    more = [found for found in map(read_piece, pieces) if not done[found.start // size]]
    there = np.repeat(done, size)[:planned]
    for found in more:
        there[found.start : found.start + len(found.variables)] = True
    designs = np.flatnonzero(there)
    failures = dict(read_stored_failures(file))
    failures |= {found.start + row: reason for found in more for row, reason in found.failures.items()}
    return Results(
        designs,
        _table(file.read("variables"), [(found.start, found.variables) for found in more], there),
        _table(file.read("responses"), [(found.start, found.responses) for found in more], there),
        dict(sorted(failures.items())),
        names=(_labels(file, "variables", "names"), _labels(file, "responses", "names")),
        units=(_labels(file, "variables", "units"), _labels(file, "responses", "units")),
        planned=planned,
        facts=_facts(file),
        text=str(file.attributes["study"]),
        made=tuple(sorted({*provenance(file), *(found.made for found in more)})),
    )


def count_of(file: Hdf, key: str) -> int:
    """A number of designs that results state: `planned`, or those of a `piece`."""
    return int(float(str(file.attributes[key])))


def provenance(file: Hdf) -> tuple[str, ...]:
    """What computed results, one text each."""
    made = file.attributes.get("made", ())
    return made if isinstance(made, tuple) else (str(made),)


def read_stored_failures(file: Hdf) -> list[tuple[int, str]]:
    """Failures by design number, with their reasons."""
    if not file.arrays["failures"].shape[0]:
        return []
    return list(zip(file.read("failures", column="design").tolist(), file.texts("failures", "reason"), strict=True))


def _facts(file: Hdf) -> dict[str, str]:
    return {key: str(value) for key, value in file.groups["facts"].items()}


def _table(values: Array, more: list[tuple[int, Array]], there: Array) -> Array:
    """All designs that are there, in order of their numbers."""
    for start, rows in more:
        values[start : start + len(rows)] = rows
    return values if there.all() else values[there]


def _labels(file: Hdf, name: str, label: str) -> tuple[str, ...]:
    found = file.arrays[name].attributes.get(label, ()) if name in file.arrays else ()
    return found if isinstance(found, tuple) else (str(found),)


def differences(path: Path, study: Study) -> Iterator[Finding]:
    """How the study that a results file belongs to differs from this one.

    >>> import tempfile
    >>> from flexstage.studies.sweeps.example import neck_study
    >>> from flexstage.studies.sweeps.execution.gather import gather
    >>> with tempfile.TemporaryDirectory() as place:
    ...     path = Path(place, "results.h5")
    ...     gather(path, neck_study(), 256)
    ...     [each.what.partition(",")[0] for each in differences(path, neck_study(designs=8))]
    ['plan was sampling sobol']
    """
    before = _facts(open_results(path))
    now = study.facts
    for key in [*before, *(key for key in now if key not in before)]:
        if before.get(key) != now.get(key):
            what = f"{key} was {before.get(key, 'absent')} and is {now.get(key, 'absent')}"
            yield Finding(os.fspath(path), what, "Resume with the study as it was, or name another file")
