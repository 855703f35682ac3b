"""Results of studies on disk: pieces written aside as they come, gathered into one HDF5 file that describes itself.

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

import numpy as np

import flexstage
from flexstage.base.aside import aside
from flexstage.base.finding import Finding, refuse
from flexstage.base.number import Array
from flexstage.studies.study.definition import Study
from flexstage.studies.study.evaluate import Piece

FORMAT = "flexstage results 1"
_ABOUT = (
    "Designs of a study, one a row of variables and responses, in SI by their attributes names, units and of (what they are; variables in "
    "1 may be factors on what the design states). NaN: not computed yet (computed says which pieces are, of piece rows each), or "
    "failed (1 in failed, reasons in failures). study is the study's file, facts what the numbers depend on. "
    "In Python: flexstage.studies.study.store.read_results, then to_xarray() or to_pandas()."
)
_ROWS = 65_536
_ATTEMPTS = 20
_PIECES = ".pieces"


@dataclass(frozen=True, eq=False)
class Results:
    """Designs computed so far: `designs` (n,) their numbers, `variables` (n, d), `responses` (n, r) in SI, failures by design number.

    `names` and `units` are those of the variables, then of the responses; `planned` designs in all; `facts` what they depend on; `text` the
    study's file.
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
    """Write a piece aside and rename it into the folder: `<start>.npz`, the designs from `start` on.

    Raises `DesignError` where the disk refuses.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     write_piece(Path(place), Piece(256, np.ones((2, 1)), np.ones((2, 3)), {})).name
    '000000000256.npz'
    """
    target = folder / f"{found.start:012d}.npz"
    rows = np.array(sorted(found.failures), dtype=np.int64)
    reasons = np.array([found.failures[row] for row in sorted(found.failures)], dtype=np.str_)
    with aside(target) as place, place.open("xb") as stream:
        np.savez(stream, variables=found.variables, responses=found.responses, rows=rows, reasons=reasons)
        stream.flush()
        os.fsync(stream.fileno())
    return target


def read_piece(path: Path) -> Piece:
    """Read a piece back.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     found = read_piece(write_piece(Path(place), Piece(256, np.ones((2, 1)), np.ones((2, 3)), {1: "too thin"})))
    >>> found.start, found.responses.shape, found.failures
    (256, (2, 3), {1: 'too thin'})
    """
    with np.load(path) as stored:
        failures = dict(zip(stored["rows"].tolist(), stored["reasons"].tolist(), strict=True))
        return Piece(int(path.stem), stored["variables"], stored["responses"], failures)


def waiting(path: Path) -> dict[int, Path]:
    """Pieces that are not gathered yet, by their first design.

    >>> waiting(Path("nowhere/results.h5"))
    {}
    """
    folder = folder_of(path)
    return {int(each.stem): each for each in sorted(folder.glob("[0-9]*.npz"))} if folder.is_dir() else {}


def gather(path: Path, study: Study, size: int) -> None:
    """Write the results file anew aside, with all pieces of `size` designs so far, and rename it; then the pieces go.

    Raises `DesignError` where the disk refuses; then file and pieces are as they were.

    >>> import tempfile
    >>> from flexstage.studies.study.example import neck_study
    >>> with tempfile.TemporaryDirectory() as place:
    ...     gather(Path(place, "results.h5"), neck_study(), 256)
    ...     read_results(Path(place, "results.h5")).complete
    False
    """
    import h5py

    pieces = waiting(path)
    with aside(path) as place, h5py.File(place, "x", libver="v110") as file:
        _frame(file, study, size)
        if path.exists():
            with _file(path) as old:
                _copy(old, file)
        for start, each in pieces.items():
            _put(file, read_piece(each), start // size)
    for each in pieces.values():
        each.unlink(missing_ok=True)


def _frame(file: Any, study: Study, size: int) -> None:
    """The empty file: names, units and what the study was."""
    names, units = columns_of(study)
    file.attrs["format"] = FORMAT
    file.attrs["study"], file.attrs["version"], file.attrs["about"] = study.text, flexstage.__version__, _ABOUT
    file.attrs["planned"], file.attrs["piece"] = study.plan.designs, size
    facts = file.create_group("facts", track_order=True)
    for key, value in study.facts.items():
        facts.attrs[key.replace("/", "|")] = value
    count = study.plan.designs
    for number, kind in enumerate(("variables", "responses")):
        data = file.create_dataset(kind, (count, len(names[number])), "f8", fillvalue=np.nan, chunks=_chunks(count, len(names[number])))
        data.attrs["names"], data.attrs["units"] = list(names[number]), list(units[number])
    file["variables"].attrs["of"] = [", ".join(each.addresses) for each in study.variables]
    file["responses"].attrs["of"] = [f"{each.key} at {each.point}" for each in study.columns.values()]
    import h5py

    file.create_dataset("failed", (count,), "u1", chunks=(min(count, _ROWS),))
    file.create_dataset("computed", (-(-count // size),), "u1")
    file.create_dataset("failures", (0,), _failure_kind(h5py), maxshape=(None,), chunks=(1024,))


def _failure_kind(h5py: Any) -> Any:
    return np.dtype([("design", "i8"), ("reason", h5py.string_dtype())])


def _chunks(count: int, width: int) -> tuple[int, int]:
    return min(count, max(1, _ROWS // width)), width


def _put(file: Any, found: Piece, number: int) -> None:
    """One piece into its place; one that is there already stays as it is."""
    if file["computed"][number]:
        return
    rows = slice(found.start, found.start + len(found.variables))
    file["variables"][rows], file["responses"][rows] = found.variables, found.responses
    failed = np.zeros(len(found.variables), dtype=np.uint8)
    failed[list(found.failures)] = 1
    file["failed"][rows] = failed
    file["computed"][number] = 1
    _add_failures(file, [(found.start + row, reason) for row, reason in sorted(found.failures.items())])


def _add_failures(file: Any, entries: list[tuple[int, str]]) -> None:
    if entries:
        known = len(file["failures"])
        file["failures"].resize((known + len(entries),))
        file["failures"][known:] = np.array(entries, dtype=file["failures"].dtype)


def _copy(old: Any, new: Any) -> None:
    """What was gathered before, in slices: the file need not fit into memory."""
    for name in ("variables", "responses", "failed", "computed"):
        for start in range(0, len(old[name]), _ROWS):
            new[name][start : start + _ROWS] = old[name][start : start + _ROWS]
    _add_failures(new, sorted((int(design), reason.decode()) for design, reason in old["failures"][:]))


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
    done = np.zeros(-(-designs // size), dtype=bool)
    if path.exists():
        with _file(path) as file:
            done |= file["computed"][:].astype(bool)
    for start in waiting(path):
        done[start // size] = True
    return done


@contextmanager
def _file(path: Path) -> Generator[Any]:
    """The file, open for reading."""
    import h5py

    with h5py.File(path, "r") as file:
        yield file


def read_results(path: str | os.PathLike[str]) -> Results:
    """Read results, complete or not, by their file or the folder of pieces beside it. Raises `DesignError` for files that are none.

    >>> read_results("nowhere/results.h5")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/results.h5: there is no such file. Check the path.
    """
    where = os.fspath(path)
    path = Path(where.rstrip("/").removesuffix(_PIECES))
    if not path.exists():
        raise refuse(where, "there is no such file", "Check the path")
    for _ in range(_ATTEMPTS):  # a piece that is gathered while we look is gone from the folder, and in the file the next time
        pieces = list(waiting(path).values())
        try:
            return _opened(path, pieces)
        except FileNotFoundError:
            continue
    raise refuse(where, "its pieces are gathered faster than they can be read", "Try again")


def _opened(path: Path, pieces: list[Path]) -> Results:
    where = os.fspath(path)
    try:
        with _file(path) as file:
            if file.attrs.get("format") != FORMAT:
                raise refuse(where, "these are no results of a study", f'Its format is to be "{FORMAT}"')
            return _read(file, pieces)
    except FileNotFoundError:
        raise
    except (OSError, KeyError) as error:
        raise refuse(where, f"it cannot be read as results: {error}", "Check the file") from None


def _read(file: Any, pieces: list[Path]) -> Results:
    size, planned = int(file.attrs["piece"]), int(file.attrs["planned"])
    done = file["computed"][:].astype(bool)
    gathered = np.repeat(done, size)[:planned]
    numbers = [np.flatnonzero(gathered)]
    tables = [[file["variables"][:][gathered]], [file["responses"][:][gathered]]]
    failures = {int(design): reason.decode() for design, reason in file["failures"][:]}
    for found in (read_piece(each) for each in pieces if not done[int(each.stem) // size]):
        numbers.append(found.start + np.arange(len(found.variables)))
        tables[0].append(found.variables)
        tables[1].append(found.responses)
        failures |= {found.start + row: reason for row, reason in found.failures.items()}
    designs = np.concatenate(numbers)
    order = np.argsort(designs)
    return Results(
        designs[order],
        np.concatenate(tables[0])[order],
        np.concatenate(tables[1])[order],
        dict(sorted(failures.items())),
        names=_labels(file, "names"),
        units=_labels(file, "units"),
        planned=planned,
        facts={key.replace("|", "/"): str(value) for key, value in file["facts"].attrs.items()},
        text=str(file.attrs["study"]),
    )


def _labels(file: Any, label: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return tuple(file["variables"].attrs[label].tolist()), tuple(file["responses"].attrs[label].tolist())


def differences(path: Path, study: Study) -> Iterator[Finding]:
    """How the study that a results file belongs to differs from this one.

    >>> import tempfile
    >>> from flexstage.studies.study.example import neck_study
    >>> with tempfile.TemporaryDirectory() as place:
    ...     path = Path(place, "results.h5")
    ...     gather(path, neck_study(), 256)
    ...     [each.what.partition(",")[0] for each in differences(path, neck_study(designs=8))]
    ["plan was Plan(sampling=<Sampling.SOBOL: 'sobol'>"]
    """
    with _file(path) as file:
        if file.attrs.get("format") != FORMAT:
            yield Finding(os.fspath(path), "this file holds no results of a study", "Name another file")
            return
        before = {key.replace("|", "/"): str(value) for key, value in file["facts"].attrs.items()}
    now = study.facts
    for key in [*before, *(key for key in now if key not in before)]:
        if before.get(key) != now.get(key):
            what = f"{key} was {before.get(key, 'absent')} and is {now.get(key, 'absent')}"
            yield Finding(os.fspath(path), what, "Resume with the study as it was, or name another file")
