"""Results of studies on disk. Pieces are written one by one, then combined in one self-describing HDF5 file.

`results.h5` contains the combined pieces. The folder `results.h5.pieces/` contains the later pieces. Only complete files are renamed, so
that a reader of both finds every computed design exactly once at any time. Files with the same designs have the same bytes, regardless of
interruptions.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.base.storage.files import Attribute, Hdf, hdf, new_hdf
from flexstage.base.storage.record_store import RecordStore
from flexstage.base.storage.store import atomic_write
from flexstage.base.version import __version__
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.evaluate import Piece

FORMAT = "flexstage results 1"
_ATTEMPTS = 20
_PIECES, _PIECE = ".pieces", ".piece"
_FRAME, _ENTRY = 100_000, 64
"""Size [B] of a results file without numbers, and of the entry of a failure without its reason."""

_ABOUT = (
    "Designs of a study, one in each row of variables and responses, in SI units. Attributes: `names`, `units`, `of` (address or measure). "
    "A variable with unit 1 may multiply values of the design. NaN: not computed (mask `computed`, one entry for each `piece` rows) "
    "or failed (mask `failed`, reasons in `failures`). study: the study's file; facts: inputs of the numbers; made: versions of programs. "
    "In Python: flexstage.studies.sweeps.execution.store.read_results, then to_xarray() or to_pandas()."
)


@dataclass(frozen=True)
class Failure:
    """A failed design or sample, which has no values: its number and the reason."""

    design: int
    reason: str


@dataclass(frozen=True, eq=False)
class Results:
    """Designs computed so far: their numbers `designs` (n,), `variables` (n, d) and `responses` (n, r) in SI.

    `failures` contains the reasons for failures by design number. `names` and `units` each contain the entries of the variables, then those
    of the responses. `planned` is the number of all designs; `facts` are the inputs of the study. `text` is the study's file; `made`
    contains the versions of the programs.
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
        """Whether every planned design is computed."""
        return len(self.designs) == self.planned

    @property
    def failed(self) -> tuple[Failure, ...]:
        """Failed designs, which have no values."""
        return tuple(Failure(design, reason) for design, reason in self.failures.items())

    def column(self, name: str) -> Array:
        """Return values (n,) of a variable or a response by name."""
        for names, values in zip(self.names, (self.variables, self.responses), strict=True):
            if name in names:
                return values[:, names.index(name)]
        raise refuse(name, "unknown column", f"Use one of {', '.join(sum(self.names, ()))}")

    def to_xarray(self) -> Any:
        """Convert the results to an xarray dataset of dimension `design`, with units in the attributes. Requires the extra `tables`."""
        import xarray

        named = [(name, unit) for names, units in zip(self.names, self.units, strict=True) for name, unit in zip(names, units, strict=True)]
        data = {name: ("design", self.column(name), {"units": unit}) for name, unit in named}
        return xarray.Dataset(data, coords={"design": self.designs}, attrs={"study": self.text})

    def to_pandas(self) -> Any:
        """Convert the results to a pandas data frame, with one row per design. Requires the extra `tables`."""
        import pandas

        return pandas.DataFrame({name: self.column(name) for names in self.names for name in names}, index=pandas.Index(self.designs))


def folder_of(path: Path) -> Path:
    """Return the folder of pieces of a results file.

    >>> folder_of(Path("a/results.h5")).as_posix()
    'a/results.h5.pieces'
    """
    return path.with_name(f"{path.name}{_PIECES}")


def write_piece(folder: Path, found: Piece) -> Path:
    """Write a piece, with the designs from number `start`, into the folder as `<start>.piece`.

    Raises `DesignError` if the file cannot be written.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     write_piece(Path(place), Piece(256, np.ones((2, 1)), np.ones((2, 3)), {})).name
    '000000000256.piece'
    """
    return _pieces_in(folder).keep(f"{found.start:012d}", found)


def read_piece(path: Path) -> Piece:
    """Read a piece from its file.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     found = read_piece(write_piece(Path(place), Piece(256, np.ones((2, 1)), np.ones((2, 3)), {1: "too thin"})))
    >>> found.start, found.responses.shape, found.failures
    (256, (2, 3), {1: 'too thin'})
    """
    try:
        return _pieces_in(path.parent).find(path.stem)
    except FileNotFoundError:
        raise
    except (OSError, ValueError):
        raise refuse(os.fspath(path), "not a piece of results, or damaged", "Remove the file and resume") from None


def _pieces_in(folder: Path) -> RecordStore:
    return RecordStore(folder, _PIECE, (Piece,))


def pending_pieces(path: Path) -> dict[int, Path]:
    """Find the pieces that are not yet combined, by the number of their first design.

    >>> pending_pieces(Path("nowhere/results.h5"))
    {}
    """
    return {int(each.stem): each for each in sorted(folder_of(path).glob(f"[0-9]*{_PIECE}"))}


def columns_of(study: Study) -> tuple[tuple[tuple[str, ...], tuple[str, ...]], tuple[tuple[str, ...], tuple[str, ...]]]:
    """Return names and SI units of the variables, then of the responses.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> columns_of(neck_study())
    ((('neck',), ('tilt',)), (('m',), ('Hz',)))
    """
    names = tuple(each.name for each in study.variables), tuple(study.columns)
    return names, (tuple(each.quantity.si for each in study.variables), tuple(each.quantity.si for each in study.columns.values()))


def open_results(path: Path) -> Hdf:
    """Open a results file. All HDF5 files are read in one separate process. Existing files are never changed, so that no lock is needed.

    Raises `FileNotFoundError` for a missing file, and `DesignError` for an invalid file.

    >>> open_results(Path("nowhere/results.h5"))
    Traceback (most recent call last):
        ...
    FileNotFoundError: ...
    """
    path.stat()
    file = hdf(path)
    if file.attributes.get("format") != FORMAT:
        raise refuse(os.fspath(path), "contains no results of a study", f'Use a file of the format "{FORMAT}"')
    require(_damage_findings(file))
    return file


def _damage_findings(file: Hdf) -> Iterator[Finding]:
    """Missing or invalid parts of a results file."""
    advice = "Remove the damaged file, or choose another"
    attributes = file.attributes
    wrong = [key for key in ("planned", "piece") if not _is_count(attributes.get(key))] + ["study"] * (
        not isinstance(attributes.get("study"), str)
    )
    if wrong:
        yield Finding(os.fspath(file.path), f"its {', '.join(wrong)} cannot be read", advice)
        return
    planned, size = (_count(file, key) for key in ("planned", "piece"))
    shapes = {name: (planned, len(_labels(file, name, "names"))) for name in ("variables", "responses")}
    for name, shape in {**shapes, "computed": (-(-planned // size),), "failed": (planned,)}.items():
        found = file.arrays.get(name)
        if found is None or found.shape != shape or found.kind not in ("f", "u", "i", "b"):
            yield Finding(f"{file.path}: {name}", f"wrong shape (got {found.shape if found else 'none'}, expected {shape})", advice)
    if "failures" not in file.arrays or dict(file.arrays["failures"].columns) != {"design": "i", "reason": "t"}:
        yield Finding(f"{file.path}: failures", "designs and reasons missing", advice)
    if "facts" not in file.groups:
        yield Finding(f"{file.path}: facts", "missing", advice)
    for name in ("variables", "responses"):
        if len(_labels(file, name, "units")) != shapes[name][1]:
            yield Finding(f"{file.path}: {name}", "number of units differs from number of names", advice)


def _is_count(value: Attribute | None) -> bool:
    return isinstance(value, float) and 1.0 <= value < 2.0**53 and value.is_integer()


@check_arguments
def read_results(path: str | os.PathLike[str]) -> Results:
    """Read a results file, complete or partial, and its pieces that are not yet combined. Raises `DesignError` for invalid files.

    >>> read_results("nowhere/results.h5")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/results.h5: file not found. Check the path.
    """
    where = os.fspath(path)
    target = Path(where.rstrip("/").removesuffix(_PIECES))
    if not target.exists():
        raise refuse(where, "file not found", "Check the path")
    for _ in range(_ATTEMPTS):  # a piece combined meanwhile is in the file at the next attempt
        pieces = list(pending_pieces(target).values())
        try:
            return _read(open_results(target), pieces)
        except FileNotFoundError:
            continue
    raise refuse(where, "its pieces changed during reading", "Try again")


@dataclass(frozen=True, eq=False)
class _Stored:
    """All planned designs, NaN if not computed; mask (k,) of `computed` pieces of `size` designs; failures by design number."""

    size: int
    variables: Array
    responses: Array
    computed: Array
    failures: dict[int, str]
    made: set[str]

    def add(self, pieces: Iterable[Piece]) -> None:
        """Add the missing pieces."""
        for each in pieces:
            if not self.computed[each.start // self.size]:
                rows = slice(each.start, each.start + len(each.variables))
                self.variables[rows], self.responses[rows] = each.variables, each.responses
                self.computed[each.start // self.size] = True
                self.failures.update((each.start + row, reason) for row, reason in each.failures.items())
                self.made.add(each.made)


def _stored(file: Hdf) -> _Stored:
    variables, responses = (file.read(name) for name in ("variables", "responses"))
    failures = dict[int, str]()
    if file.arrays["failures"].shape[0]:
        failures = dict(zip(file.read("failures", column="design").tolist(), file.texts("failures", "reason"), strict=True))
    made = file.attributes.get("made", ())
    computed = file.read("computed").astype(bool)
    return _Stored(_count(file, "piece"), variables, responses, computed, failures, set(made if isinstance(made, tuple) else (str(made),)))


def _empty(study: Study, size: int) -> _Stored:
    designs = study.plan.designs
    variables, responses = (np.full((designs, len(names)), np.nan) for names in columns_of(study)[0])
    return _Stored(size, variables, responses, np.zeros(-(-designs // size), dtype=bool), {}, set())


def _read(file: Hdf, pieces: Iterable[Path]) -> Results:
    stored, planned = _stored(file), _count(file, "planned")
    stored.add(map(read_piece, pieces))
    there = np.repeat(stored.computed, stored.size)[:planned]
    return Results(
        np.flatnonzero(there),
        stored.variables[there],
        stored.responses[there],
        dict(sorted(stored.failures.items())),
        names=(_labels(file, "variables", "names"), _labels(file, "responses", "names")),
        units=(_labels(file, "variables", "units"), _labels(file, "responses", "units")),
        planned=planned,
        facts=_facts(file),
        text=str(file.attributes["study"]),
        made=tuple(sorted(stored.made)),
    )


def gather(path: Path, study: Study, size: int) -> Array:
    """Write the results file with all pieces of `size` designs, and remove the pieces.

    Returns a mask (k,) of the planned pieces, which is true for pieces in the file. Raises `DesignError` if the file cannot be written;
    file and pieces are then unchanged.

    >>> import tempfile
    >>> from flexstage.studies.sweeps.example import neck_study
    >>> with tempfile.TemporaryDirectory() as place:
    ...     gather(Path(place, "results.h5"), neck_study(), 256).tolist()
    ...     read_results(Path(place, "results.h5")).complete
    [False]
    False
    """
    pieces = pending_pieces(path)
    if path.exists() and not pieces:
        return open_results(path).read("computed").astype(bool)
    stored = _stored(open_results(path)) if path.exists() else _empty(study, size)
    stored.add(map(read_piece, pieces.values()))
    reasons = sum(len(reason.encode()) + _ENTRY for reason in stored.failures.values())
    with atomic_write(path) as place, new_hdf(place, file_size(study) + reasons) as file:
        _write(file, stored, study)
    for each in pieces.values():
        each.unlink(missing_ok=True)
    return stored.computed


def _write(file: Any, stored: _Stored, study: Study) -> None:
    """The complete file: numbers with names and units, and the study."""
    import h5py

    names, units = columns_of(study)
    whole = {"format": FORMAT, "study": study.text, "version": __version__, "about": _ABOUT}
    file.attrs.update({**whole, "planned": study.plan.designs, "piece": stored.size, "made": sorted(stored.made)})
    file.create_group("facts", track_order=True).attrs.update(study.facts)
    about = {
        "address": [", ".join(each.addresses) for each in study.variables],
        "measure": [f"{each.key} at {each.point}" for each in study.columns.values()],
    }
    tables = zip(("variables", "responses"), (stored.variables, stored.responses), names, units, about.items(), strict=True)
    for name, values, columns, own, (key, texts) in tables:
        data = file.create_dataset(name, values.shape, "f8", fillvalue=np.nan)
        if stored.computed.any():
            data[:] = values
        data.attrs.update({"names": columns, "units": own, key: texts})
    failed = np.zeros(study.plan.designs, dtype=np.uint8)
    failed[list(stored.failures)] = 1
    file["failed"], file["computed"] = failed, stored.computed.astype(np.uint8)
    kind = np.dtype([("design", "i8"), ("reason", h5py.string_dtype())])
    file["failures"] = np.array(sorted(stored.failures.items()), dtype=kind)


def require_room(path: Path, study: Study) -> None:
    """Raise `DesignError` if the disk has no space for a study's results: the file, and the pieces that are not yet combined.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> require_room(Path("results.h5").absolute(), neck_study())
    """
    whole = file_size(study)
    there = path.stat().st_size if path.exists() else 0
    missing, free = 2 * whole - min(there, whole), shutil.disk_usage(path.parent).free
    if free < missing:
        what = f"{missing / 1e6:.4g} MB more are needed to combine the results, but {free / 1e6:.4g} MB are free"
        raise refuse(os.fspath(path.parent), what, "Free space and continue with --resume, or choose a file on another disk")


def file_size(study: Study) -> int:
    """Compute the maximum size of a study's results file [B], without the reasons for failures.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> file_size(neck_study(2_000_000)) - file_size(neck_study(1_000_000))
    17000000
    """
    return study.plan.designs * (8 * sum(map(len, columns_of(study)[0])) + 1) + _FRAME + 2 * len(study.text)


def _count(file: Hdf, key: str) -> int:
    return int(float(str(file.attributes[key])))


def _facts(file: Hdf) -> dict[str, str]:
    return {key: str(value) for key, value in file.groups["facts"].items()}


def _labels(file: Hdf, name: str, label: str) -> tuple[str, ...]:
    found = file.arrays[name].attributes.get(label, ()) if name in file.arrays else ()
    return found if isinstance(found, tuple) else (str(found),)


def differences(path: Path, study: Study, size: int) -> Iterator[Finding]:
    """Compare the study and the piece size of a results file with this `study` and `size`. Yields one finding for each difference.

    >>> import tempfile
    >>> from flexstage.studies.sweeps.example import neck_study
    >>> with tempfile.TemporaryDirectory() as place:
    ...     path = Path(place, "results.h5")
    ...     done = gather(path, neck_study(), 256)
    ...     [each.what.partition(",")[0] for each in differences(path, neck_study(designs=8), 256)]
    ['plan was sampling sobol']
    """
    file = open_results(path)
    before = {**_facts(file), "piece": str(_count(file, "piece"))}
    now = {**study.facts, "piece": str(size)}
    for key in dict.fromkeys((*before, *now)):
        if before.get(key) != now.get(key):
            what = f"{key} was {before.get(key, 'absent')} and is {now.get(key, 'absent')}"
            yield Finding(os.fspath(path), what, "Resume with the original study, or choose another file")
