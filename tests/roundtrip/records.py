"""Records and responses whose numbers, names and units need care."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.formats.write import write
from flexstage.experiment.records.record import Channel, InMemory, Record, Responses, Role

NAMES = ("u1", "B4/pivot.mz", "S1", "förder weg", 'gauge "a", left', "x [mm]")
UNITS = ("V", "N m", "um", "nm", "", "m/s^2")
ROLES = (Role.INPUT, Role.INPUT, Role.OUTPUT, Role.OUTPUT, Role.UNKNOWN, Role.OUTPUT)


def awkward(seed: int, *shape: int) -> Array:
    """Numbers over the whole range of doubles, signed zeros and the smallest one among them."""
    draw = np.random.default_rng(seed)
    values = draw.standard_normal(shape) * 10.0 ** draw.integers(-300, 300, shape)
    special = [0.0, -0.0, 5e-324, 1.7976931348623157e308, -1.0 / 3.0]
    values.ravel()[: min(5, values.size)] = special[: min(5, values.size)]
    return values


def awkward_record(seed: int = 0, length: int = 1000, rate: float = 2048.0 / 3.0, start: float = -0.1) -> Record:
    channels = tuple(Channel(name, unit, role) for name, unit, role in zip(NAMES, UNITS, ROLES, strict=True))
    return Record(channels, rate, InMemory(awkward(seed, length, len(channels))), start, name="stage 1, run 2")


def awkward_responses(seed: int = 0, *, even: bool = True, coherence: bool = True) -> Responses:
    draw = np.random.default_rng(seed)
    frequencies = 3.0 + 0.3125 * np.arange(40) if even else np.cumsum(0.1 + draw.random(40))
    outputs = tuple(Channel(name, unit, Role.OUTPUT) for name, unit in zip(NAMES[2:], UNITS[2:], strict=True))
    inputs = tuple(Channel(name, unit, Role.INPUT) for name, unit in zip(NAMES[:2], UNITS[:2], strict=True))
    values = np.ascontiguousarray(awkward(seed, 40, 4, 4)).view(complex)
    shares = draw.random((40, 4, 2)) if coherence else None
    return Responses(frequencies, outputs, inputs, values, shares, window="hann", averages=12, name="analyser")


def bits(values: Array) -> bytes:
    return np.ascontiguousarray(values).tobytes()


def write_form(path: Path, what: Record | Responses, form: str = "") -> None:
    """Write a file, in `uff-ascii` too: the binary universal file that is written here, its numbers printed as the format says."""
    if form != "uff-ascii":
        write(path, what, form)
        return
    write(path, what, "uff")
    rest, printed = path.read_bytes(), b""
    while rest:
        *lines, rest = rest.split(b"\n", 13)
        size, count, is_even = int(lines[1][31:43]), int(lines[8][10:20]), bool(int(lines[8][20:30]))
        numbers = np.frombuffer(rest[:size], "<f8").reshape(max(1, count) if count else 0, -1)
        printed += b"\n".join([lines[0], f"{58:6d}".ljust(80).encode(), *lines[2:], _printed(numbers, is_even=is_even)])
        printed, rest = printed + rest[size : size + 7], rest[size + 7 :]
    path.write_bytes(printed)


def _printed(numbers: Array, *, is_even: bool) -> bytes:
    """Four numbers a line; with frequencies of 6 digits one complex value a line, or two real ones."""
    if is_even:
        words, each = [f"{number:20.12E}" for number in numbers.ravel().tolist()], 4
    else:
        form, each = "{:13.5E}" + "{:20.12E}" * (numbers.shape[1] - 1), 3 - (numbers.shape[1] - 1)
        words = [form.format(*line) for line in numbers.tolist()]
    return "".join("".join(words[begin : begin + each]) + "\n" for begin in range(0, len(words), each)).encode()


def write_version_73(path: Path, values: dict[str, Any]) -> Path:
    """A MAT file as MATLAB itself stores it in version 7.3: arrays, texts, tuples of texts as cells, dictionaries as structures."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in values.items():
            _as_matlab(file, name, value)
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon".ljust(124) + b"\x00\x02IM")
    return path


def _as_matlab(file: h5py.File | h5py.Group, name: str, value: Any) -> h5py.Dataset | None:
    if isinstance(value, dict):
        for key, each in value.items():
            _as_matlab(file.require_group(name), key, each)
        return None
    if isinstance(value, tuple):
        references = file.file.require_group("#refs#")
        own = [_as_matlab(references, f"{name}{number}", each) for number, each in enumerate(value)]
        found = file.create_dataset(name, (len(value), 1), dtype=h5py.ref_dtype)
        for number, each in enumerate(own):
            found[number, 0] = each.ref if each is not None else None
        found.attrs["MATLAB_class"] = np.bytes_("cell")
        return found
    if isinstance(value, str):
        found = file.create_dataset(name, data=np.array([[ord(each)] for each in value], np.uint16))
        found.attrs["MATLAB_class"] = np.bytes_("char")
        return found
    array = np.atleast_2d(np.asarray(value)).T
    if np.iscomplexobj(array):
        pairs = np.zeros(array.shape, [("real", "<f8"), ("imag", "<f8")])
        pairs["real"], pairs["imag"] = array.real, array.imag
        array = pairs
    found = file.create_dataset(name, data=array)
    found.attrs["MATLAB_class"] = np.bytes_("double")
    return found
