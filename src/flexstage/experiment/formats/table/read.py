"""CSV files read: as a record left in the file, or as responses over frequency."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.storage.files import Attribute
from flexstage.base.units.dimension import dimension_of
from flexstage.experiment.formats.arrays import Contents, HeldArray, complex_of, read_arrays
from flexstage.experiment.formats.table.layout import Layout, read_layout
from flexstage.experiment.formats.table.values import TableSamples, index_lines
from flexstage.experiment.records.clock import TIME_SCALES, Clock, clocked_record, determine_clock
from flexstage.experiment.records.options import Arrays, FaultTolerance, Kind, Options, matches
from flexstage.experiment.records.record import Channel, Record, Responses, Role
from flexstage.experiment.records.unit import same_dimension, unit_problem

_FLOAT = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
OWN = re.compile(rf"flexstage record; rate (?P<rate>{_FLOAT}) Hz; start (?P<start>{_FLOAT}) s; samples (?P<count>\d+)")
"""The comment that heads records written here: what times of a column do not say to the bit."""
OWN_RESPONSES = re.compile(r"flexstage responses; outputs \d+; inputs \d+; averages (?P<averages>\d+)")
SAYING = {"name": "name: ", "roles": "roles: ", "window": "window: ", "inputs": "inputs: ", "outputs": "outputs: "}
_PART = re.compile(r"(?:(?P<name>.+?)[ _])?(?P<part>re|im|coherence|mag|magnitude|amplitude|gain|phase)", re.IGNORECASE)
_MAGNITUDES = ("mag", "amplitude", "gain")
_RECTANGULAR, _POLAR = ("re", "im"), ("magnitude", "phase")


def is_text(_start: bytes, _suffix: str) -> bool:
    """What no other form claims is tried as a table."""
    return True


def read_table(path: Path, options: Options) -> tuple[Record | Responses, ...]:
    r"""What a CSV file holds: responses where a column is called `frequency` (or as the user says), else a record.

    Its times stand in the column `time`, or the one that is named. Raises `DesignError` where there is none and no rate is stated, for gaps
    between times (passed over where `FaultTolerance.GAPS`), for a last line cut short (left out where `FaultTolerance.TRUNCATED`).

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "a.csv"
    ...     _ = path.write_text("time [s], u1 [V], S1 [um]\n0, 1, 10\n0.5, 2, 20\n1.0, 3, 30\n")
    ...     (found,) = read_table(path, Options())
    ...     found.rate, [channel.unit for channel in found.inputs], found.values.tolist()
    (2.0, ['V'], [[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]])
    """
    layout = read_layout(path)
    samples = _samples(path, layout, options)
    require(_unknown_names(path, layout, options.arrays))
    own = next(filter(None, map(OWN_RESPONSES.match, layout.comments)), None)
    is_stated = options.arrays.frequencies != Arrays().frequencies
    is_record = any(map(OWN.match, layout.comments)) or (not is_stated and _column(layout, options.arrays.time) is not None)
    if own or (not is_record and _column(layout, options.arrays.frequencies) is not None):
        return _responses(path, layout, samples, options, own)
    return (_record(path, layout, samples, options),)


def _unknown_names(path: Path, layout: Layout, arrays: Arrays) -> Iterator[Finding]:
    for meaning, name in arrays.stated():
        if meaning not in ("time", "frequencies"):
            yield Finding(f"{path}: {meaning}={name}", "of a table only time and frequencies are named", "Name channels otherwise (only)")
        elif not any(matches(each, [name]) for each in layout.names):
            yield Finding(f"{path}: {meaning}={name}", "no column is called so", suggest_nearest(name, layout.names))


def _column(layout: Layout, names: tuple[str, ...]) -> int | None:
    """The first column that has one of these names, else the first that has one but for upper and lower case."""
    spelt = (*enumerate(layout.names), *enumerate(map(str.lower, layout.names)))
    return next((number for number, name in spelt if matches(name, names)), None)


def _samples(path: Path, layout: Layout, options: Options) -> TableSamples:
    """All columns; a last line that is cut short is left out where allowed."""
    lines = index_lines(path, layout.start)
    whole = TableSamples(path, layout, lines, tuple(range(len(layout.names))), lines.count)
    own = next(filter(None, map(OWN.match, layout.comments)), None)
    cut = _cut_short(path, layout, lines.end)
    announced = int(own["count"]) if own else None
    if cut is None and (announced is None or (lines.count >= announced and _ends_with_newline(path))):
        return whole
    unsure = lines.count - 1 if cut is not None or not _ends_with_newline(path) else lines.count
    if FaultTolerance.TRUNCATED in options.accept_faults and unsure > 0:
        return replace(whole, length=unsure)
    what = f"it breaks off: {cut}" if cut is not None else f"it breaks off: it has {lines.count} of {announced} samples"
    advice = f'Export it anew, or accept "truncated" to use the {unsure} samples before'
    raise refuse(f"{path}: line {layout.line + lines.count - 1}", what, advice)


def _cut_short(path: Path, layout: Layout, end: int) -> str | None:
    """What is wrong with the last line."""
    with path.open("rb") as stream:
        stream.seek(max(layout.start, end - 100_000))
        last = stream.read(end - stream.tell()).decode(layout.encoding, "replace").splitlines()
    fields = layout.fields(last[-1]) if last else [""] * len(layout.names)
    count = len(fields) if _ends_with_newline(path) or fields[-1] else len(fields) - 1
    return f"its last line has {count} of {len(layout.names)} fields" if count < len(layout.names) else None


def _ends_with_newline(path: Path) -> bool:
    with path.open("rb") as stream:
        stream.seek(-1, 2)
        return stream.read(1) == b"\n"


def _comment(layout: Layout, kind: str) -> str:
    return next((line.removeprefix(SAYING[kind]) for line in layout.comments if line.startswith(SAYING[kind])), "")


def _record(path: Path, layout: Layout, samples: TableSamples, options: Options) -> Record:
    time = _column(layout, options.arrays.time)
    clock = _clock(path, layout, samples, time, options)
    columns = tuple(number for number in range(len(layout.names)) if number != time)
    roles = _roles(layout, len(columns))
    channels = [Channel(layout.names[number], layout.units[number], role) for number, role in zip(columns, roles, strict=True)]
    if not channels:
        raise refuse(str(path), "it has a column of times and no other", "Give at least one channel")
    chosen = replace(samples, columns=columns)
    return clocked_record(channels, chosen, clock, options, name=_comment(layout, "name"), where=str(path))


def _roles(layout: Layout, count: int) -> list[Role]:
    said = [text.strip() for text in _comment(layout, "roles").split(",")]
    known = {role.value: role for role in Role}
    return [known[text] for text in said] if len(said) == count and all(text in known for text in said) else [Role.UNKNOWN] * count


def _clock(path: Path, layout: Layout, samples: TableSamples, time: int | None, options: Options) -> Clock:
    own = next(filter(None, map(OWN.match, layout.comments)), None)
    stated = options.rate or (float(own["rate"]) if own else None)
    if time is None and stated is None:
        what = f"none of its columns is called time: {', '.join(layout.names[:12])}"
        raise refuse(str(path), what, 'Say which has the times (array "time=..."), or state the rate (rate)')
    if time is None or options.rate:
        return Clock(float(stated or 0.0), 0.0, ((0, samples.length),))
    if layout.units[time] not in ("", *TIME_SCALES):
        raise refuse(f"{path}: {layout.names[time]}", f'its unit is "{layout.units[time]}", where a time is expected', "Write s, ms or us")
    scale = TIME_SCALES.get(layout.units[time], 1.0)
    times = replace(samples, columns=(time,))
    return determine_clock(times, options, f"{path}: {layout.names[time]}", scale=scale, stated=stated)


def _responses(
    path: Path, layout: Layout, samples: TableSamples, options: Options, own: re.Match[str] | None
) -> tuple[Record | Responses, ...]:
    """The columns in the form of named arrays: frequencies, then the parts of each response, and coherence or not."""
    at = 0 if own else _column(layout, options.arrays.frequencies)
    unit = layout.units[at or 0]
    if unit not in ("", "Hz", "kHz"):
        raise refuse(f"{path}: {layout.names[at or 0]}", f'its unit is "{unit}", where a frequency is expected', "Write Hz or kHz")
    values = samples.read(0, samples.length)
    chosen = [number for number in range(len(layout.names)) if number != (at or 0) and (own or _is_chosen(layout.names[number], options))]
    others = values[:, chosen] if own else _rectangular(path, layout, chosen, values)
    sides = {side: _side(layout, side) for side in ("outputs", "inputs")} if own else _pairs(path, layout, chosen)
    outputs, inputs = len(sides["outputs"]), len(sides["inputs"])
    parts = others.shape[1] // max(1, outputs * inputs)
    if parts not in (2, 3) or parts * outputs * inputs != others.shape[1]:
        what = f"{others.shape[1]} columns do not hold the responses of {outputs} outputs to {inputs} inputs"
        raise refuse(str(path), what, "Write the file anew")
    columns = others.reshape(-1, outputs, inputs, parts)
    held = [
        HeldArray("frequencies", values[:, at or 0] * (1e3 if unit == "kHz" else 1.0)),
        HeldArray("responses", complex_of(columns[..., 0], columns[..., 1])),
        *([HeldArray("coherence", columns[..., 2])] if parts == 3 else []),
    ]
    said: dict[str, Attribute] = {kind: _comment(layout, kind) for kind in ("name", "window")}
    said |= {f"{side[:-1]}_names": tuple(name for name, _ in pairs) for side, pairs in sides.items()}
    said |= {f"{side[:-1]}_units": tuple(unit for _, unit in pairs) for side, pairs in sides.items()}
    said |= {"averages": float(own["averages"])} if own else {}
    whole = replace(options, kind=Kind.RESPONSES, arrays=Arrays())
    return read_arrays(Contents(str(path), tuple(held), said), whole)


def _is_chosen(name: str, options: Options) -> bool:
    """Whether a column, or the response that it is a part of, is among the channels that count."""
    part = _PART.fullmatch(name)
    return not options.only or matches(name, options.only) or (part is not None and matches(part["name"] or "", options.only))


def _parts(path: Path, layout: Layout, chosen: list[int]) -> tuple[tuple[str, ...], list[str]]:
    """The parts that each response has in its columns, and the names of responses; raises `DesignError` for other columns."""
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
        'Give real and imaginary part of each, "frequency [Hz], S1 re [um/V], S1 im [um/V]", with or without "S1 coherence", or magnitude '
        'and phase, "frequency [Hz], S1 magnitude [um/V], S1 phase [deg]"'
    )
    named = f"; or use only those that are whole (only): {', '.join(whole[:12])}" if all(whole) and whole else ""
    raise refuse(str(path), f"it has frequencies, and beside them {', '.join(names[:12])}", advice + named)


def _pairs(path: Path, layout: Layout, chosen: list[int]) -> dict[str, list[tuple[str, str]]]:
    """Outputs by the names of their columns; the one input is not named. A magnitude in dB is a number."""
    order, outputs = _parts(path, layout, chosen)
    units = ["1" if layout.units[number].lower() == "db" else layout.units[number] for number in chosen[:: len(order)]]
    return {"outputs": list(zip(outputs, units, strict=True)), "inputs": [("input", "1" if any(units) else "")]}


def _rectangular(path: Path, layout: Layout, chosen: list[int], values: Array) -> Array:
    """The columns of responses, magnitudes and phases turned into real and imaginary parts."""
    order, _ = _parts(path, layout, chosen)
    found = values[:, chosen]
    if order[:2] != _POLAR:
        return found
    for first in range(0, len(chosen), len(order)):
        unit, where = layout.units[chosen[first + 1]], f"{path}: {layout.names[chosen[first + 1]]}"
        if unit_problem(unit) is not None or not same_dimension(unit, "rad"):
            raise refuse(where, f'its unit is "{unit}", where an angle is expected', 'Write deg or rad, such as "phase [deg]"')
        size = 10.0 ** (found[:, first] / 20.0) if layout.units[chosen[first]].lower() == "db" else found[:, first]
        turn = np.exp(1j * found[:, first + 1] * float(dimension_of(unit).size))
        found[:, first], found[:, first + 1] = size * np.real(turn), size * np.imag(turn)
    return found


def _side(layout: Layout, side: str) -> list[tuple[str, str]]:
    """Names and units of outputs or inputs, as the comment says them."""
    try:
        return [(str(name), str(unit)) for name, unit in json.loads(_comment(layout, side))]
    except (ValueError, TypeError):
        return []
