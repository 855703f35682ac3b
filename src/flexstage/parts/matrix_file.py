"""Files of stiffness and mass matrices from finite-element codes: MAT, NPZ and Matrix Market, with size limits."""

from __future__ import annotations

import contextlib
import hashlib
import zipfile
import zlib
from collections.abc import Callable, Generator, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import scipy

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.processes.memory import gigabytes, require_memory
from flexstage.base.storage.files import hdf, mat, require_regular
from flexstage.parts.superelement import Superelement

MatrixLike: TypeAlias = Any
"""Dense array, or sparse array of scipy."""
LARGEST_DENSE = 4000
"""Largest accepted number of rows of a dense matrix."""
_COPIES = 8
_LEAST_ENTRY = 2
"""Least bytes per entry of a text file: a digit and a space."""
_HDF = b"\x89HDF\r\n\x1a\n"
_HEAD = 512
_CHUNK = 2**20


def read_matrices(part: Superelement) -> tuple[MatrixLike, ...]:
    """Read stiffness, mass and optional damping from a superelement's files: real matrices of any shape, in the files' units.

    Raises `DesignError` for an unspecified, missing, damaged or too large file, a wrong digest, an unknown array, and complex numbers.
    """
    require(_statement_findings(part))
    for path in map(Path, part.files):
        require_regular(path)
    require(_version_findings(part))
    if not part.file:
        paths = tuple(map(Path, part.files))
        require(_size_findings(*((path, *_market_head(path)) for path in paths)))
        return tuple(_matrix_market(path) for path in paths)
    path = Path(part.file)
    names = tuple(name for name in (part.arrays.stiffness, part.arrays.mass, part.arrays.damping) if name)
    result = _READERS[path.suffix.lower()](path, names)
    require(_missing_findings(path, names, result))
    return tuple(_plain(path, name, result[name]) for name in names)


def digest_of(paths: tuple[str, ...]) -> str:
    """Return the SHA-256 of the concatenated bytes of files.

    >>> digest_of(())[:8]
    'e3b0c442'
    """
    state = hashlib.sha256()
    for path in map(Path, paths):
        require_regular(path)
        with path.open("rb") as stream:
            while chunk := stream.read(_CHUNK):
                state.update(chunk)
    return state.hexdigest()


def _statement_findings(part: Superelement) -> Iterator[Finding]:
    stated = [key for key in ("file", "stiffness_file", "mass_file", "damping_file") if getattr(part, key)]
    if stated not in (["file"], ["stiffness_file", "mass_file"], ["stiffness_file", "mass_file", "damping_file"]):
        what = f"wrong combination of file, stiffness_file, mass_file and damping_file (got {' and '.join(stated) or 'none'})"
        yield Finding("file", what, "Specify file (MAT or NPZ), or stiffness_file and mass_file (Matrix Market)")
    for key in stated:
        path = getattr(part, key)
        known = tuple(_READERS) if key == "file" else (".mtx",)
        if Path(path).suffix.lower() not in known:
            advice = "Use file for MAT and NPZ, stiffness_file and mass_file for Matrix Market"
            yield Finding(key, f"{path} does not end in {' or '.join(known)}", advice)


def _version_findings(part: Superelement) -> Iterator[Finding]:
    result = digest_of(part.files)
    named = " and ".join(Path(path).name for path in part.files)
    if not part.sha256:
        yield Finding("sha256", f"digest of {named} missing", f'To accept the current version, add sha256 = "{result}"')
    elif result != part.sha256.lower():
        what = f"wrong digest of {named} (got sha256 {result[:12]}..., expected {part.sha256[:12]}...)"
        yield Finding("sha256", what, f'Restore the expected version, or accept this version with sha256 = "{result}"')


def _missing_findings(path: Path, names: tuple[str, ...], result: Mapping[str, MatrixLike]) -> Iterator[Finding]:
    for key, name in zip(("stiffness", "mass", "damping"), names, strict=False):
        if name not in result:
            there = ", ".join(list(result)[:8]) or "no array of numbers"
            yield Finding(f"arrays.{key}", f'{path.name} has no array "{name}"; it has {there}', f'Use e.g. arrays = {{ {key} = "..." }}')


def _plain(path: Path, name: str, matrix: MatrixLike) -> MatrixLike:
    """The matrix in floats; refuses numbers of another kind."""
    kind = matrix.dtype.kind
    if kind == "c" and not np.any(np.imag(matrix.data if scipy.sparse.issparse(matrix) else matrix)):
        return _plain(path, name, matrix.real)
    if kind not in "fiu":
        what = f"wrong kind of {name} (got {'complex numbers' if kind == 'c' else f'values of kind {matrix.dtype}'}, expected real numbers)"
        raise refuse(str(path), what, "Export the real stiffness and mass; use loss_factor for material damping")
    return matrix.astype(float)


def _npz(path: Path, names: tuple[str, ...]) -> dict[str, MatrixLike]:
    advice = "Write it with numpy.savez(file, K=..., M=...), with numeric arrays only"
    try:
        with zipfile.ZipFile(path) as archive:
            sizes = {info.filename.removesuffix(".npy"): info.file_size for info in archive.infolist()}
        for name in names:
            _require_room(path, name, sizes.get(name, 0))
        with np.load(path, allow_pickle=False) as result:
            return {name: result[name] if name in names else np.zeros(0) for name in result.files}
    except (zipfile.BadZipFile, zlib.error, ValueError, OSError, EOFError, KeyError, NotImplementedError, MemoryError) as error:
        if isinstance(error, DesignError):
            raise
        raise refuse(str(path), f"it cannot be read as an NPZ file ({' '.join(str(error).split())[:200]})", advice) from None


def _mat(path: Path, names: tuple[str, ...]) -> dict[str, MatrixLike]:
    with path.open("rb") as stream:
        start = stream.read(_HEAD + len(_HDF))
    if not start.startswith(b"MATLAB 7.3") and _HDF not in (start[:8], start[_HEAD:]):
        return {name: value for name, value in mat(path) if not isinstance(value, tuple)}
    held = hdf(path)
    sparse = [name for name in names if "MATLAB_sparse" in held.groups.get(name, {})]
    if sparse:
        raise refuse(
            str(path), f"{' and '.join(sparse)} is sparse, unsupported in version 7.3", "In MATLAB, save full(K), or save with -v7"
        )
    return {name: held.read(name).T if name in names else np.zeros(0) for name, each in held.arrays.items() if each.kind in "fiuc"}


_READERS: Mapping[str, Callable[[Path, tuple[str, ...]], dict[str, MatrixLike]]] = {".mat": _mat, ".npz": _npz}


_MARKET = "Write it with scipy.io.mmwrite or the finite-element code: real or integer entries, general or symmetric"


@contextlib.contextmanager
def _read_as_market(path: Path) -> Generator[None]:
    try:
        yield
    except (ValueError, OSError, OverflowError, MemoryError) as error:
        if isinstance(error, DesignError):
            raise
        what = f"it cannot be read as a Matrix Market file ({' '.join(str(error).split())[:200]})"
        raise refuse(str(path), what, _MARKET) from None


def _market_head(path: Path) -> tuple[int, int, int]:
    """Rows, columns and entries in the header of a Matrix Market file, checked against its size and the memory."""
    with _read_as_market(path):
        rows, columns, entries, form, kind, symmetry = scipy.io.mminfo(str(path))
    if kind not in ("real", "integer", "double"):
        raise refuse(str(path), f"wrong kind of entries (got {kind}, expected real)", _MARKET)
    size = path.stat().st_size
    if entries * _LEAST_ENTRY > 2 * size:
        raise refuse(str(path), f"truncated file ({entries} entries in its header, {size} bytes)", "Copy or export it again")
    _require_room(path, "its entries", 8 * rows * columns if form == "array" else 24 * entries)
    return rows, columns, entries if symmetry == "general" else 2 * entries


def _size_findings(stiffness: tuple[Path, int, int, int], *others: tuple[Path, int, int, int]) -> Iterator[Finding]:
    """Errors of inconsistent sizes, before memory allocation."""
    path, rows, columns, entries = stiffness
    if rows != columns or entries < rows:
        what = f"invalid stiffness (got {rows} x {columns} with {entries} entries at most, expected a square matrix without zero rows)"
        yield Finding(str(path), what, "Export the whole matrix over ports and internal coordinates")
    for other, *size, _ in others:
        if size != [rows, columns]:
            what = f"wrong size (got {' x '.join(map(str, size))}, expected {rows} x {columns}, like the stiffness in {path.name})"
            yield Finding(str(other), what, "Export all matrices over the same coordinates")


def _matrix_market(path: Path) -> MatrixLike:
    with _read_as_market(path):
        result = scipy.io.mmread(str(path))
    whole = result.tocsc() if scipy.sparse.issparse(result) else result
    return _plain(path, "entries", whole.toarray() if scipy.sparse.issparse(whole) and max(whole.shape) <= LARGEST_DENSE else whole)


def _require_room(path: Path, what: str, size: float) -> None:
    def fits(there: float) -> str:
        return f"Reduce the model in the finite-element code (Craig-Bampton, Guyan) to matrices of at most {gigabytes(there / _COPIES)}"

    require_memory(str(path), what, _COPIES * size, fits)
