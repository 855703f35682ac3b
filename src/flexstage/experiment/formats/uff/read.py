"""Reading of universal files: time histories as one record, frequency response functions as responses."""

from __future__ import annotations

import itertools
import math
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Array
from flexstage.base.storage.files import Attribute
from flexstage.experiment.formats.arrays import Contents, complex_of, held_array, read_arrays, side_by_side
from flexstage.experiment.formats.uff.function import COHERENCE, KINDS
from flexstage.experiment.formats.uff.scan import DataSet, scan
from flexstage.experiment.records.clock import Clock, determine_clock, longest_stretch
from flexstage.experiment.records.options import Arrays, FaultTolerance, Kind, Options, assign, matches, number_names, select_names
from flexstage.experiment.records.record import Channel, Record, Responses, Role, changed_samples

_FLOAT = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
OWN = re.compile(rf"flexstage (?P<role>input|output|unknown); rate (?P<rate>{_FLOAT}) Hz; start (?P<start>{_FLOAT}) s")
"""Fifth text line of functions written by flexstage: header fields in full precision, used if they round to the header's values."""
OWN_RESPONSE = re.compile(rf"flexstage response; first (?P<first>{_FLOAT}) Hz; step (?P<step>{_FLOAT}) Hz; averages (?P<averages>\d+)")
COUNTED = re.compile(r"(?P<text>.*?)(?:; )?function (?P<number>\d+) of (?P<count>\d+)")
"""Fourth text line of functions written by flexstage: the number of the function, for which the format has no field."""


def is_uff(start: bytes, _suffix: str) -> bool:
    r"""Recognise the start of universal files.

    >>> is_uff(b"    -1\n    58\n", ".uff"), is_uff(b"time,u1\n", ".uff")
    (True, False)
    """
    lines = [line.strip() for line in start.lstrip().split(b"\n")[:2]]
    return lines[0] == b"-1" and len(lines) > 1 and lines[1][:2].isdigit()


def read_uff(path: Path, options: Options) -> tuple[Record | Responses, ...]:
    """Read a universal file: its time histories, its frequency responses, or both, according to `options.kind`.

    Raises `DesignError` with all faults: different lengths or rates, and functions that are neither time histories nor responses. Truncated
    functions are also faults, unless `FaultTolerance.TRUNCATED` allows partial use.
    """
    where, stated = str(path), options.arrays.stated()
    require(
        Finding(f"{where}: {meaning}={name}", "universal files have no named arrays", "Omit this assignment") for meaning, name in stated
    )
    found, findings = scan(path)
    truncated = [Finding(_where(where, each), each.problem, _ADVICE) for each in found if each.problem is not None]
    require(
        [*findings, *([*truncated, *_missing_functions(where, found)] if FaultTolerance.TRUNCATED not in options.accept_faults else ())]
    )
    histories = [each for each in found if each.function.is_time]
    responses = [each for each in found if each.function.is_response]
    if not histories and not responses:
        raise _nothing(where, found)
    coherences = [each for each in found if each.function.kind == COHERENCE]
    record = (_record(where, histories, options),) if histories and options.kind is not Kind.RESPONSES else ()
    return (*record, *(_responses(where, responses, coherences, options) if responses and options.kind is not Kind.RECORD else ()))


_ADVICE = 'Export the file again, or accept "truncated" to use the available part'


def _missing_functions(where: str, found: list[DataSet]) -> Iterable[Finding]:
    """Findings for missing functions of files written here, truncated between two functions."""
    told = [COUNTED.fullmatch(each.function.texts[3]) for each in found if each.function.texts[4].startswith("flexstage ")]
    stated = max((int(each["count"]) for each in told if each), default=0)
    if len(found) < stated:
        yield Finding(where, f"it is truncated: it has {len(found)} of the {stated} functions that were written", _ADVICE)


def _where(where: str, found: DataSet) -> str:
    return f"{where}:{found.line}: {_name(found)}"


def _nothing(where: str, found: list[DataSet]) -> DesignError:
    if not found:
        return refuse(where, "it has no function at nodal degrees of freedom (data set 58)", "Export time histories or responses")
    counts = Counter(KINDS.get(each.function.kind, f"function of type {each.function.kind}") for each in found)
    listed = ", ".join(f"{count} x {kind}" for kind, count in counts.items())
    what = f"it contains only {listed}, but no time histories or frequency response functions"
    return refuse(where, what, "Modes follow from phases between channels: export the time histories, or frequency response functions")


def _name(found: DataSet) -> str:
    function = found.function
    return function.texts[0] if function.texts[4].startswith("flexstage ") and function.texts[0] else function.output_name


def _record(where: str, histories: list[DataSet], options: Options) -> Record:
    names = _history_names(histories)
    pairs = list(zip(names, histories, strict=True))
    whole = assign((Channel(name, each.function.ordinate.unit, _role(each)) for name, each in pairs), options, where)
    chosen = [(name, each) for name, each in pairs if name in select_names(names, options)]
    clock = _common_clock(where, chosen, options)
    samples = side_by_side([changed_samples(each.values, lambda block: block[:, -1:]) for _, each in chosen])
    channels = tuple(channel for channel in whole if channel.name in dict(chosen))
    return longest_stretch(Record(channels, clock.rate, samples, clock.start, name=_title(chosen[0][1]), source=where), clock)


def _history_names(histories: list[DataSet]) -> tuple[str, ...]:
    """Names of the entities if unique, else with nodes and directions."""
    entities = [each.function.response[0] for each in histories]
    if all(entities) and len(set(entities)) == len(entities) and not any(OWN.match(each.function.texts[4]) for each in histories):
        return tuple(entities)
    return number_names(_name(each) for each in histories)


def _title(found: DataSet) -> str:
    texts = found.function.texts
    return texts[1] if OWN.match(texts[4]) else texts[0]


def _role(found: DataSet) -> Role:
    own = OWN.match(found.function.texts[4])
    return Role(own["role"]) if own else found.function.role


def _common_clock(where: str, chosen: list[tuple[str, DataSet]], options: Options) -> Clock:
    """Common sampling of all channels. Raises `DesignError` for different lengths, rates or starts."""
    require(_lengths(where, chosen) if FaultTolerance.TRUNCATED not in options.accept_faults else ())
    clocks = {name: _clock(where, name, each, options) for name, each in (chosen if not options.rate else chosen[:1])}
    first = next(iter(clocks.values()))
    require(_clock_findings(where, clocks))
    return replace(first, rate=options.rate or first.rate)


def _lengths(where: str, chosen: list[tuple[str, DataSet]]) -> Iterable[Finding]:
    lengths = Counter(each.values.length for _, each in chosen)
    usual = max(lengths, key=lambda length: (lengths[length], length))
    advice = "Export all channels over the same time, or select matching ones (option channels)"
    for name, each in chosen:
        if each.values.length != usual:
            yield Finding(f"{where}: {name}", f"it has {each.values.length} samples, others have {usual}", advice)


def _clock_findings(where: str, clocks: dict[str, Clock]) -> Iterable[Finding]:
    known, first = next(iter(clocks.items()))
    for name, clock in clocks.items():
        if abs(clock.rate / first.rate - 1.0) > 1e-6 or abs(clock.start - first.start) * first.rate > 0.01:
            what = f"it is sampled at {clock.rate:g} Hz from {clock.start:g} s, {known} at {first.rate:g} Hz from {first.start:g} s"
            yield Finding(f"{where}: {name}", what, "Select channels with the same sampling (option channels)")


def _clock(where: str, name: str, found: DataSet, options: Options) -> Clock:
    function = found.function
    if function.is_even:
        own = OWN.match(function.texts[4])
        if own and refines(own["start"], function.first) and refines(own["rate"], function.step, inverse=True):
            return Clock(float(own["rate"]), float(own["start"]))
        return Clock(function.rate, function.first)
    if options.rate:
        return Clock(options.rate)
    return determine_clock(found.values, options, f"{where}: {name}")


def refines(text: str, field: float, *, inverse: bool = False) -> bool:
    """Return whether a full-precision number rounds to a printed field of six digits; with `inverse`, its reciprocal is compared.

    >>> refines("2048.0", 4.88281e-04, inverse=True), refines("100.0", 0.02, inverse=True), refines("0", 0.02, inverse=True)
    (True, False, False)
    """
    number = float(text)
    if inverse:
        number = 1.0 / number if number else math.inf
    return float(f"{number:.5e}") == field


def _responses(where: str, found: list[DataSet], coherences: list[DataSet], options: Options) -> tuple[Record | Responses, ...]:
    """Responses as arrays of the documented form. A unit of the ratio only is assigned to the output; the input has none."""
    table = _table(where, found, options)
    outputs, inputs = _complete(where, table, options)
    rows = [[table[output, input_] for input_ in inputs] for output in outputs]
    first = rows[0][0].function
    own = OWN_RESPONSE.match(first.texts[4])
    above, below = ([row[0].function.ordinate.unit for row in rows], [each.function.denominator.unit for each in rows[0]])
    ratio = not any(below) and any("/" in unit for unit in above)
    said: dict[str, Attribute] = {
        "output_names": outputs,
        "output_units": tuple(above),
        "input_names": inputs,
        "input_units": ("1",) * len(inputs) if ratio else tuple(below),
        "window": _text(first.texts[3]) if own else "",
        "averages": float(own["averages"]) if own else 0.0,
        "name": first.texts[2] if own else first.texts[0],
    }
    arrays = {"frequencies": _frequencies(where, list(itertools.chain(*rows))), "responses": _matrix(rows)}
    if (shares := _coherence(where, coherences, table, rows, options)) is not None:
        arrays["coherence"] = np.real(_matrix(shares))
    contents = Contents(where, tuple(held_array(name, values) for name, values in arrays.items()), said)
    return read_arrays(contents, replace(options, kind=Kind.RESPONSES, arrays=Arrays()))


def _matrix(rows: list[list[DataSet]]) -> Array:
    """Complex values (f, outputs, inputs)."""
    return np.moveaxis(np.array([[_complex(each) for each in row] for row in rows]), 2, 0)


def _text(line: str) -> str:
    """Line of text without the count of functions."""
    told = COUNTED.fullmatch(line)
    return told["text"] if told else line


def _complete(where: str, table: dict[tuple[str, str], DataSet], options: Options) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of outputs and inputs with a complete set of responses."""
    outputs, inputs = (tuple(dict.fromkeys(pair[side] for pair in table)) for side in (0, 1))
    missing = {output: [input_ for input_ in inputs if (output, input_) not in table] for output in outputs}
    if FaultTolerance.INCOMPLETE not in options.accept_faults:
        advice = 'Measure them, select complete channels (options inputs, outputs), or accept "incomplete" to omit this output'
        require(
            Finding(f"{where}: {output}", f"its responses to {', '.join(lack)} are missing", advice)
            for output, lack in missing.items()
            if lack
        )
    complete = tuple(output for output, lack in missing.items() if not lack)
    if not complete:
        raise refuse(where, "no output has responses to all inputs", "Select the inputs (option inputs)")
    return complete, inputs


def _pair(found: DataSet) -> tuple[str, str]:
    function = found.function
    if OWN_RESPONSE.match(function.texts[4]):
        return function.texts[0], function.texts[1]
    return function.output_name, function.input_name


def _table(where: str, found: list[DataSet], options: Options) -> dict[tuple[str, str], DataSet]:
    """Responses by names of output and input, as selected. Raises `DesignError` for duplicates."""
    table: dict[tuple[str, str], DataSet] = {}
    findings: list[Finding] = []
    for each in found:
        output, input_ = pair = _pair(each)
        if (options.outputs and not matches(output, options.outputs)) or (options.inputs and not matches(input_, options.inputs)):
            continue
        if pair in table:
            what = f"duplicate response of {output} to {input_} (first in line {table[pair].line})"
            findings.append(Finding(f"{where}:{each.line}", what, "Export each response once, with nodes and directions"))
        table[pair] = each
    if not table:
        names = ", ".join(f"{output} to {input_}" for output, input_ in dict.fromkeys(map(_pair, found)))
        findings.append(Finding(where, f"no response between the requested channels; available: {names}", "Check the names"))
    require(findings)
    return table


def _complex(found: DataSet) -> Array:
    columns = found.values.read(0, found.values.length)[:, -2 if found.function.is_complex else -1 :]
    return complex_of(columns[:, 0], columns[:, 1]) if found.function.is_complex else columns[:, 0].astype(complex)


def _frequencies(where: str, found: list[DataSet]) -> Array:
    """Common frequencies of all responses."""
    axes = [_axis(each) for each in found]
    advice = "Export all responses over the same frequencies, or select matching ones (options inputs, outputs)"
    require(
        Finding(_where(where, each), f"its frequencies differ from those of {_name(found[0])}", advice)
        for each, axis in zip(found, axes, strict=True)
        if len(axis) != len(axes[0]) or not np.allclose(axis, axes[0], rtol=1e-6, atol=0.0)
    )
    return axes[0]


def _axis(found: DataSet) -> Array:
    function, numbers = found.function, np.arange(found.values.length)
    own = OWN_RESPONSE.match(function.texts[4])
    if own and function.is_even and refines(own["first"], function.first) and refines(own["step"], function.step):
        return float(own["first"]) + float(own["step"]) * numbers
    if function.is_even:
        return function.first + numbers / function.rate
    return found.values.read(0, found.values.length)[:, 0]


def _coherence(
    where: str, found: list[DataSet], table: dict[tuple[str, str], DataSet], rows: list[list[DataSet]], options: Options
) -> list[list[DataSet]] | None:
    """Coherence of every response; `None` if several are missing. Raises `DesignError` if only the last is missing."""
    stored = {_pair(each): each for each in found if each.values.length == rows[0][0].values.length}
    lack = [_pair(each) for each in itertools.chain(*rows) if _pair(each) not in stored]
    if lack and lack == list(table)[-1:] and len(table) > 1 and FaultTolerance.INCOMPLETE not in options.accept_faults:
        what = f"only the last response, of {lack[0][0]} to {lack[0][1]}, has no coherence: the file may be truncated"
        raise refuse(where, what, 'Export the file again, or accept "incomplete" to omit coherence')
    return None if lack else [[stored[_pair(each)] for each in row] for row in rows]
