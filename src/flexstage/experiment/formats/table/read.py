"""CSV files read: as a record left in the file, or as responses over frequency."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.experiment.clock import Clock, Told, longest_stretch, settled
from flexstage.experiment.formats.stored import responses_of
from flexstage.experiment.formats.table.layout import Layout, layout_of
from flexstage.experiment.formats.table.values import TableSamples, indexed
from flexstage.experiment.formats.variables import FREQUENCIES, TIMES, Contents, Held, complex_of, plain_name
from flexstage.experiment.options import Allow, Options, assigned, wanted
from flexstage.experiment.record import Channel, Record, Responses, Role

_FLOAT = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
OWN = re.compile(rf"flexstage record; rate (?P<rate>{_FLOAT}) Hz; start (?P<start>{_FLOAT}) s; samples (?P<count>\d+)")
"""The comment that heads records written here: what times of a column do not say to the bit."""
OWN_RESPONSES = re.compile(r"flexstage responses; outputs \d+; inputs \d+; averages (?P<averages>\d+)")
SAYING = {"name": "name: ", "roles": "roles: ", "window": "window: ", "inputs": "inputs: ", "outputs": "outputs: "}
_TIME_SCALES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
_BLOCK = 65_536


def read_table(path: Path, options: Options) -> Record | Responses:
    r"""What a CSV file holds: responses where its first column is frequency, else a record.

    Raises `DesignError` where there is neither a column of times nor a rate (in a comment, or stated), for gaps between times (passed over
    where `Allow.GAPS`), for a last line cut short (left out where `Allow.TRUNCATED`).

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "a.csv"
    ...     _ = path.write_text("time [s], u1 [V], S1 [um]\n0, 1, 10\n0.5, 2, 20\n1.0, 3, 30\n")
    ...     found = read_table(path, Options())
    ...     found.rate, [channel.unit for channel in found.inputs], found.values.tolist()
    (2.0, ['V'], [[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]])
    """
    layout = layout_of(path)
    samples = _samples(path, layout, options)
    own = next(filter(None, map(OWN_RESPONSES.match, layout.comments)), None)
    if own or (FREQUENCIES.fullmatch(plain_name(layout.names[0])) and layout.units[0] in ("Hz", "kHz")):
        return _responses(path, layout, samples, options, own)
    return _record(path, layout, samples, options)


def _samples(path: Path, layout: Layout, options: Options) -> TableSamples:
    """All columns; a last line that is cut short is left out where allowed."""
    lines = indexed(path, layout.start)
    whole = TableSamples(path, layout, lines, tuple(range(len(layout.names))), lines.count)
    own = next(filter(None, map(OWN.match, layout.comments)), None)
    cut = _cut(path, layout, lines.end)
    announced = int(own["count"]) if own else None
    if cut is None and (announced is None or (lines.count >= announced and _terminated(path))):
        return whole
    unsure = lines.count - 1 if cut is not None or not _terminated(path) else lines.count
    if Allow.TRUNCATED in options.allow and unsure > 0:
        return replace(whole, length=unsure)
    what = f"it breaks off: {cut}" if cut is not None else f"it breaks off: it has {lines.count} of {announced} samples"
    advice = f'Export it anew, or allow "truncated" to use the {unsure} samples before'
    raise refuse(f"{path}: line {layout.line + lines.count - 1}", what, advice)


def _cut(path: Path, layout: Layout, end: int) -> str | None:
    """What is wrong with the last line."""
    with path.open("rb") as stream:
        stream.seek(max(layout.start, end - 100_000))
        last = stream.read(end - stream.tell()).decode(layout.encoding, "replace").splitlines()
    fields = layout.fields(last[-1]) if last else [""] * len(layout.names)
    count = len(fields) if _terminated(path) or fields[-1] else len(fields) - 1
    return f"its last line has {count} of {len(layout.names)} fields" if count < len(layout.names) else None


def _terminated(path: Path) -> bool:
    with path.open("rb") as stream:
        stream.seek(-1, 2)
        return stream.read(1) == b"\n"


def _saying(layout: Layout, kind: str) -> str:
    return next((line.removeprefix(SAYING[kind]) for line in layout.comments if line.startswith(SAYING[kind])), "")


def _record(path: Path, layout: Layout, samples: TableSamples, options: Options) -> Record:
    time = next((number for number, name in enumerate(layout.names) if TIMES.fullmatch(plain_name(name))), None)
    clock = _clock(path, layout, samples, time, options)
    columns = tuple(number for number in range(len(layout.names)) if number != time)
    roles = _roles(layout, len(columns))
    channels = [Channel(layout.names[number], layout.units[number], role) for number, role in zip(columns, roles, strict=True)]
    if not channels:
        raise refuse(str(path), "it has a column of times and no other", "Give at least one channel")
    whole = assigned(channels, options, str(path))
    record = Record(whole, clock.rate, replace(samples, columns=columns), clock.start, name=_saying(layout, "name"), source=str(path))
    record = record.select(wanted(record.names, options)) if options.only else record
    return longest_stretch(record, clock)


def _roles(layout: Layout, count: int) -> list[Role]:
    said = [text.strip() for text in _saying(layout, "roles").split(",")]
    known = {role.value: role for role in Role}
    return [known[text] for text in said] if len(said) == count and all(text in known for text in said) else [Role.UNKNOWN] * count


def _clock(path: Path, layout: Layout, samples: TableSamples, time: int | None, options: Options) -> Clock:
    own = next(filter(None, map(OWN.match, layout.comments)), None)
    stated = options.rate or (float(own["rate"]) if own else layout.rate)
    if time is None and stated is None:
        what = f"none of its columns is time ({', '.join(layout.names[:12])}), and no comment states a rate"
        raise refuse(str(path), what, 'Name the column of times "time [s]", or state the rate (rate)')
    if time is None or options.rate:
        return Clock(float(stated or 0.0), 0.0, ((0, samples.length),))
    if layout.units[time] not in ("", *_TIME_SCALES):
        raise refuse(f"{path}: {layout.names[time]}", f'its unit is "{layout.units[time]}", where a time is expected', "Write s, ms or us")
    scale = _TIME_SCALES.get(layout.units[time], 1.0)
    times = replace(samples, columns=(time,))
    told = Told(stated, allow_gaps=Allow.GAPS in options.allow)
    return settled(
        _times(times, scale), lambda number: float(times.read(number, number + 1)[0, 0]) * scale, told, f"{path}: {layout.names[time]}"
    )


def _times(samples: TableSamples, scale: float) -> Iterator[Array]:
    for start in range(0, samples.length, _BLOCK):
        yield samples.read(start, start + _BLOCK)[:, 0] * scale


def _responses(path: Path, layout: Layout, samples: TableSamples, options: Options, own: re.Match[str] | None) -> Responses:
    values = samples.read(0, samples.length)
    lines = Held("frequency", values[:, 0] * (1e3 if layout.units[0] == "kHz" else 1.0))
    if own is None:
        columns = (Held(name, values[:, number]) for number, name in enumerate(layout.names) if number)
        found = responses_of(Contents(str(path), (lines, *columns)), options)
    else:
        found = responses_of(_own_contents(path, layout, (lines, values), own), options)
    if found is None:
        advice = 'Give rising frequencies, and columns of real and imaginary parts: "H_re [um/V]", "H_im [um/V]"'
        raise refuse(str(path), "it has a column of frequencies but no responses", advice)
    return found


def _own_contents(path: Path, layout: Layout, numbers: tuple[Held, Array], own: re.Match[str]) -> Contents:
    """Frequencies, responses and coherence of a file written here, with names and units from its comments."""
    lines, values = numbers
    sides = {side: _side(layout, side) for side in ("outputs", "inputs")}
    outputs, inputs, width = len(sides["outputs"]), len(sides["inputs"]), values.shape[1] - 1
    parts = width // max(1, outputs * inputs)
    if parts not in (2, 3) or parts * outputs * inputs != width:
        raise refuse(str(path), f"{width} columns do not hold the responses of {outputs} outputs to {inputs} inputs", "Write the file anew")
    columns = values[:, 1:].reshape(-1, outputs, inputs, parts)
    held = [lines, Held("responses", complex_of(columns[..., 0], columns[..., 1])), Held("averages", np.array(float(own["averages"])))]
    held += [Held("coherence", columns[..., 2])] if parts == 3 else []
    texts = {f"{side[:-1]}_names": tuple(name for name, _ in pairs) for side, pairs in sides.items()}
    texts |= {f"{side[:-1]}_units": tuple(unit for _, unit in pairs) for side, pairs in sides.items()}
    return Contents(str(path), tuple(held), texts | {kind: (_saying(layout, kind),) for kind in ("name", "window")})


def _side(layout: Layout, side: str) -> list[tuple[str, str]]:
    """Names and units of outputs or inputs, as the comment says them."""
    try:
        return [(str(name), str(unit)) for name, unit in json.loads(_saying(layout, side))]
    except (ValueError, TypeError):
        return []
