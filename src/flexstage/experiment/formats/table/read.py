"""Reading of CSV files: as a record that stays in the file, or as responses over frequency."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.storage.files import Attribute
from flexstage.base.units.dimension import dimension_of
from flexstage.experiment.formats.arrays import RECORD_FORM, RESPONSES_FORM, Contents, Variable, complex_of, held_array, read_arrays
from flexstage.experiment.formats.table.layout import Layout, read_layout, split_fields
from flexstage.experiment.formats.table.values import TableSamples, index_table
from flexstage.experiment.records.options import Arrays, FaultTolerance, Kind, Options, matches
from flexstage.experiment.records.record import Record, Responses
from flexstage.experiment.records.unit import same_dimension, unit_problem

OWN = "flexstage "
"""First word of the comment in files written by flexstage, followed by a JSON object of the attributes."""
_PART = re.compile(r"(?:(?P<name>.+?)[ _])?(?P<part>re|im|coherence|mag|magnitude|amplitude|gain|phase)", re.IGNORECASE)
_MAGNITUDES = ("mag", "amplitude", "gain")
_RECTANGULAR, _POLAR = ("re", "im"), ("magnitude", "phase")


def is_text(_start: bytes, _suffix: str) -> bool:
    """Accept every file: CSV is the format of files that no other format recognises."""
    return True


def read_table(path: Path, options: Options) -> tuple[Record | Responses, ...]:
    r"""Read a CSV file. It contains responses if a column is named `frequency` or assigned as frequencies, else a record.

    Times are in the column `time`, or in the assigned column. Raises `DesignError` if both times and rate are missing. Gaps between times
    are accepted only with `FaultTolerance.GAPS`, a truncated last line only with `FaultTolerance.TRUNCATED`, which omits it.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "a.csv"
    ...     _ = path.write_text("time [s], u1 [V], S1 [um]\n0, 1, 10\n0.5, 2, 20\n1.0, 3, 30\n")
    ...     (found,) = read_table(path, Options())
    ...     found.rate, [channel.unit for channel in found.inputs], found.values.tolist()
    (2.0, ['V'], [[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]])
    """
    layout, arrays = read_layout(path), options.arrays
    said = _said(layout)
    own = Contents(str(path), (), said)
    length = own.number({}, "length")
    samples = complete_rows(path, layout, options, None if length is None else int(length), closed=True)
    require(_unknown_names(path, layout, arrays))
    time, lines = _column(layout, arrays.time), _column(layout, arrays.frequencies)
    is_stated = arrays.frequencies != Arrays().frequencies
    of_responses = replace(options, kind=Kind.RESPONSES, arrays=Arrays())
    if own.text("format") == RESPONSES_FORM:
        return read_arrays(_own_responses(own, layout, samples), of_responses)
    if lines is not None and own.text("format") != RECORD_FORM and (is_stated or time is None):
        return read_arrays(_responses(path, layout, samples, options, lines), of_responses)
    if time is None and not options.rate and "rate" not in said:
        what = f"no column contains times (columns: {', '.join(layout.names[:12])})"
        raise refuse(str(path), what, 'Assign the times (option array "time=..."), or specify the rate (option rate)')
    return read_record(samples, said, options, time)


def read_record(samples: TableSamples, said: Mapping[str, Attribute], options: Options, time: int | None) -> tuple[Record | Responses, ...]:
    """Build a record from a table: column number `time` contains the times, all others are channels; `said` are the file's attributes."""
    layout = samples.layout
    columns = tuple(number for number in range(len(layout.names)) if number != time)
    texts: dict[str, Attribute] = {kind: tuple(getattr(layout, kind)[number] for number in columns) for kind in ("names", "units")}
    roles = said.get("roles", ())
    said = said if isinstance(roles, tuple) and len(roles) == len(columns) else {**said, "roles": ()}  # columns may have been added
    variables = [_columns("samples", samples, columns, texts)]
    if time is not None:
        variables.append(_columns(layout.names[time], samples, (time,), {"units": layout.units[time]}))
    arrays = Arrays(time=() if time is None else (layout.names[time],))
    return read_arrays(Contents(str(samples.path), tuple(variables), said), replace(options, kind=Kind.RECORD, arrays=arrays))


def _columns(name: str, samples: TableSamples, columns: tuple[int, ...], attributes: Mapping[str, Attribute]) -> Variable:
    chosen = replace(samples, columns=columns)
    return Variable(name, (samples.length, len(columns)), lambda spans: chosen.read(*spans[0]), attributes=attributes)


def _said(layout: Layout) -> dict[str, Attribute]:
    """Attributes in the comment of a file written here; unexpected types are ignored, since files are edited by hand."""
    try:
        found = json.loads(next((line.removeprefix(OWN) for line in layout.comments if line.startswith(OWN)), "{}"))
    except ValueError:
        return {}
    listed = {name: tuple(value) if isinstance(value, list) else value for name, value in found.items()} if isinstance(found, dict) else {}
    return {name: value for name, value in listed.items() if _is_attribute(value)}


def _is_attribute(value: Any) -> TypeGuard[Attribute]:
    if isinstance(value, tuple):
        return all(isinstance(each, str) for each in value)
    return isinstance(value, str) or (isinstance(value, float) and math.isfinite(value))


def _unknown_names(path: Path, layout: Layout, arrays: Arrays) -> Iterator[Finding]:
    for meaning, name in arrays.stated():
        if meaning not in ("time", "frequencies"):
            yield Finding(
                f"{path}: {meaning}={name}",
                "in a table, only time and frequencies can be assigned",
                "Select other columns as channels (option channels)",
            )
        elif not any(matches(each, [name]) for each in layout.names):
            yield Finding(f"{path}: {meaning}={name}", "unknown column", suggest_nearest(name, layout.names))


def _column(layout: Layout, names: tuple[str, ...]) -> int | None:
    """First column with one of these names, else the first that differs only in case."""
    spelt = (*enumerate(layout.names), *enumerate(map(str.lower, layout.names)))
    return next((number for number, name in spelt if matches(name, names)), None)


def complete_rows(path: Path, layout: Layout, options: Options, announced: int | None, *, closed: bool) -> TableSamples:
    """Read all columns of a table, and check that it has the `announced` number of lines.

    A truncated file is read without its last line if the options accept this fault. If `closed` is true, the last line must end with a line
    feed, because its last number may otherwise be truncated.
    """
    whole = index_table(path, layout)
    ends = _ends_with_newline(path)
    if announced is not None and whole.length > announced:
        what = f"too many lines of numbers (got {whole.length}, expected {announced} from its header)"
        raise refuse(f"{path}:{layout.line + announced}", what, "Save each record in its own file")
    cut = _cut_short(path, layout, whole.end)
    if cut is None and (announced is None or (whole.length == announced and (ends or not closed))):
        return whole
    unsure = whole.length - 1 if cut is not None or not ends or not closed else whole.length
    if FaultTolerance.TRUNCATED in options.accept_faults and unsure > 0:
        return replace(whole, length=unsure)
    what = f"it is truncated: {cut}" if cut is not None else f"it is truncated: it has {whole.length} of {announced} samples"
    advice = f'Export it again, or accept "truncated" to use the first {max(0, unsure)} samples'
    raise refuse(f"{path}:{layout.line + whole.length - 1}", what, advice)


def _cut_short(path: Path, layout: Layout, end: int) -> str | None:
    """Fault of the last line."""
    with path.open("rb") as stream:
        stream.seek(max(layout.start, end - 100_000))
        last = stream.read(end - stream.tell()).decode(layout.encoding, "replace").splitlines()
    fields = split_fields(last[-1], layout.delimiter) if last else [""] * len(layout.names)
    count = len(fields) if _ends_with_newline(path) or fields[-1] else len(fields) - 1
    return f"its last line has {count} of {len(layout.names)} fields" if count < len(layout.names) else None


def _ends_with_newline(path: Path) -> bool:
    with path.open("rb") as stream:
        stream.seek(-1, 2)
        return stream.read(1) == b"\n"


def _own_responses(own: Contents, layout: Layout, samples: TableSamples) -> Contents:
    """Responses of a file written here: its frequencies, then the parts of each output's response to each input."""
    values = samples.read(0, samples.length)
    outputs, inputs = (len(own.texts(f"{side}_names")) for side in ("output", "input"))
    parts = (len(layout.names) - 1) // max(1, outputs * inputs)
    if parts not in (2, 3) or parts * outputs * inputs != len(layout.names) - 1:
        what = f"wrong number of response columns (got {len(layout.names) - 1} for {outputs} outputs and {inputs} inputs)"
        raise refuse(own.where, what, "Export the file again")
    return _contents(own.where, values[:, 0], values[:, 1:].reshape(-1, outputs, inputs, parts), own.said)


def _contents(where: str, frequencies: Array, parts: Array, said: Mapping[str, Attribute]) -> Contents:
    """Response arrays from their parts (f, outputs, inputs, 2 or 3): real, imaginary, optional coherence."""
    arrays = {"frequencies": frequencies, "responses": complex_of(parts[..., 0], parts[..., 1])}
    arrays |= {"coherence": parts[..., 2]} if parts.shape[-1] == 3 else {}
    return Contents(where, tuple(held_array(name, values) for name, values in arrays.items()), said)


def _responses(path: Path, layout: Layout, samples: TableSamples, options: Options, lines: int) -> Contents:
    """Responses in the columns, by name, with one unnamed input. A magnitude in dB is dimensionless."""
    unit = layout.units[lines]
    if unit not in ("", "Hz", "kHz"):
        raise refuse(f"{path}: {layout.names[lines]}", f'wrong unit (got "{unit}", expected a frequency)', "Use Hz or kHz")
    values = samples.read(0, samples.length)
    chosen = [number for number in range(len(layout.names)) if number != lines and _is_chosen(layout.names[number], options)]
    order, outputs = _parts(path, layout, chosen)
    parts = _rectangular(path, layout, chosen, values[:, chosen], order).reshape(-1, len(outputs), 1, len(order))
    units = tuple("1" if layout.units[number].lower() == "db" else layout.units[number] for number in chosen[:: len(order)])
    said: dict[str, Attribute] = {"output_names": tuple(outputs), "output_units": units, "input_units": ("1" if any(units) else "",)}
    return _contents(str(path), values[:, lines] * (1e3 if unit == "kHz" else 1.0), parts, said)


def _is_chosen(name: str, options: Options) -> bool:
    """Whether a column, or the response of that part, is selected."""
    part = _PART.fullmatch(name)
    return not options.only or matches(name, options.only) or (part is not None and matches(part["name"] or "", options.only))


def _parts(path: Path, layout: Layout, chosen: list[int]) -> tuple[tuple[str, ...], list[str]]:
    """Parts of each response by column, and the names of responses; raises `DesignError` for other columns."""
    names = [layout.names[number] for number in chosen]
    found = [_PART.fullmatch(name) for name in names]
    words = tuple(each["part"].lower() if each else "" for each in found)
    endings = tuple("magnitude" if each in _MAGNITUDES else each for each in words)
    order = (*(_POLAR if "magnitude" in endings else _RECTANGULAR), *(["coherence"] if "coherence" in endings else []))
    if endings and endings == order * (len(endings) // len(order)):
        return order, [each["name"] or "output" for each in found if each][:: len(order)]
    owners = [each["name"] or "" if each else name for each, name in zip(found, names, strict=True)]
    partial = {name for name in owners if tuple(ending for own, ending in zip(owners, endings, strict=True) if own == name) != order}
    whole = [name for name in dict.fromkeys(owners) if name not in partial]
    advice = (
        'Write real and imaginary part of each response, "frequency [Hz], S1 re [um/V], S1 im [um/V]", with or without "S1 coherence", or '
        'magnitude and phase, "frequency [Hz], S1 magnitude [um/V], S1 phase [deg]"'
    )
    named = f"; or select the complete ones (option channels): {', '.join(whole[:12])}" if all(whole) and whole else ""
    raise refuse(str(path), f"its columns do not form complete responses (columns: {', '.join(names[:12])})", advice + named)


def _rectangular(path: Path, layout: Layout, chosen: list[int], found: Array, order: tuple[str, ...]) -> Array:
    """Response columns, magnitudes and phases converted to real and imaginary parts."""
    if order[:2] != _POLAR:
        return found
    for first in range(0, len(chosen), len(order)):
        unit, where = layout.units[chosen[first + 1]], f"{path}: {layout.names[chosen[first + 1]]}"
        if unit_problem(unit) is not None or not same_dimension(unit, "rad"):
            raise refuse(where, f'wrong unit (got "{unit}", expected an angle)', 'Use deg or rad, e.g. "phase [deg]"')
        size = 10.0 ** (found[:, first] / 20.0) if layout.units[chosen[first]].lower() == "db" else found[:, first]
        turn = np.exp(1j * found[:, first + 1] * float(dimension_of(unit).size))
        found[:, first], found[:, first + 1] = size * np.real(turn), size * np.imag(turn)
    return found
